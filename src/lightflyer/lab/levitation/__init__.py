"""Optimal pressure and minimum irradiance from levitation points."""
