"""Force models: how the gas heats, cools and pushes a flyer. One model a file."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
