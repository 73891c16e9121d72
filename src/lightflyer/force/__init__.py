"""Force models: how the gas heats, cools and pushes a flyer. One model a file."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
