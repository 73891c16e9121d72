"""Raw measurements to numbers with intervals: one module a measurement."""
