"""Emissivity from infrared spectra."""
