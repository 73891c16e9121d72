"""Force on a heated vane over pressure, beside the kinetic equation."""
