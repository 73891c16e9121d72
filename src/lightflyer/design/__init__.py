"""Designs, their operating points and outputs: the vocabulary of all that follows."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
