"""Flyers as structures: films that curl, plates that sag, shells that buckle; plain functions."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
