"""Roughness of a surface from a map of its height."""
