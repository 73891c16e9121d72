"""Temperature, pressure and composition over altitude."""
