"""Force coefficients and film properties from levitation points."""
