"""Formats of thermal images; :mod:`lightflyer.lab.thermal_image` reads them all."""
