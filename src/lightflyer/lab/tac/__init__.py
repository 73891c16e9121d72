"""Thermal accommodation coefficients from the power of a heater."""
