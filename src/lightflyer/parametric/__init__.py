"""Many designs at once: studies, how they are computed and stored, and what is read from them."""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
