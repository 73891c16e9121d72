"""Flyers as structures: films that curl, plates that sag, shells that buckle; plain functions."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
