"""Drag of bodies that move through gas, from free molecules to dense gas, as plain functions."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
