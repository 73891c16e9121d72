"""Surroundings of a flyer: gas state, gravity, light and heat radiation, wind."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
