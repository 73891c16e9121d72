"""Precision, root-finding, splines and grids."""
