"""Gases: transport properties, and the lengths and speeds made of them."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
