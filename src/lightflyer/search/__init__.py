"""The best design, and which uncertain number matters most."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
