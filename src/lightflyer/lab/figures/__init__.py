"""Figures of measurements, one module each."""
