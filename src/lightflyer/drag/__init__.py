"""Drag of bodies that move through gas, from free molecules to dense gas, as plain functions."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
