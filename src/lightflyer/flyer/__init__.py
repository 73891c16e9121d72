"""What flies: one shape a file."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
