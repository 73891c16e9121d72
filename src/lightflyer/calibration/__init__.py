"""Fit a model to measured levitation points: force coefficients, film properties, any number."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
