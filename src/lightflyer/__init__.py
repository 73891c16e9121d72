"""Design, test and fly photophoretic light-flyers.

The public names are listed in ``__init__.pyi`` and loaded when first used, so that importing
the package, as the command line does, costs nothing.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = "0.2.0"
