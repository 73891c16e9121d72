"""Lab bench: numbers with intervals from raw measurements, one module per measurement."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
