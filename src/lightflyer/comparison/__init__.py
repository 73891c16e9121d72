"""Comparison of several flyers: side by side over altitude or pressure."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
