"""What a film is made of: materials, layers, spectra, and what follows from them."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
