"""Fit a model to measured levitation points: force coefficients, film properties, any number."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
