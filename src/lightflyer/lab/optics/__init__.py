"""Thicknesses, mixtures and optical constants of a film from its spectra."""
