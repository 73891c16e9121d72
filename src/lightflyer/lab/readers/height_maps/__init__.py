"""Formats of height maps, one a module; :mod:`lightflyer.lab.readers.height_map` reads all."""
