"""What one flyer will do."""
