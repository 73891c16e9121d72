"""Finding the alternatives of a flyer file's sections: by importing the modules that declare them.

A new flyer, environment or force model is one new module in its room. A package of somebody else's
adds its own by an entry point of the group ``"lightflyer"`` that names its module.
"""

import importlib
import importlib.metadata
import pkgutil
from functools import cache

_ROOMS = (
    "lightflyer.film",
    "lightflyer.environment",
    "lightflyer.flyer",
    "lightflyer.force",
)
_FIGURES = "figures"  # how such names end: they draw on demand, and import matplotlib

ENTRY_POINTS = "lightflyer"
"""Group of entry points by which other packages declare alternatives."""


@cache
def discover() -> None:
    """Import every module that may declare an alternative of a section."""
    for room in _ROOMS:
        package = importlib.import_module(room)
        for module in pkgutil.iter_modules(package.__path__):
            if not module.ispkg and not module.name.endswith(_FIGURES):
                importlib.import_module(f"{room}.{module.name}")
    for entry in importlib.metadata.entry_points(group=ENTRY_POINTS):
        entry.load()
