"""What a payload needs: mass and power of its parts, solar cells, a radio link."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
