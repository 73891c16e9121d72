"""What a payload needs: mass and power of its parts, solar cells, a radio link."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
