"""Prediction of one flyer: bands, tables, figures."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
