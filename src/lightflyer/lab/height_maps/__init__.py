"""Formats of height maps, one module each; :mod:`lightflyer.lab.height_map` reads them all."""
