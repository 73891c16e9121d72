"""A disk between floor, lid and side wall, or with a local heat balance."""
