"""Formats of thermal images; :mod:`lightflyer.lab.thermography.thermal_image` reads them all."""
