"""Emissivity from temperatures, thermal images included."""
