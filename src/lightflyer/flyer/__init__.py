"""What shape it has."""
