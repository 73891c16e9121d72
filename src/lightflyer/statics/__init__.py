"""From flyer, surroundings and force model to temperature, lift, levitation and bands."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
