"""From flyer, surroundings and force model to temperature, lift, levitation and bands."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
