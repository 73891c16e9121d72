"""Finding the alternatives of a flyer file's sections: by importing the modules that declare them.

A new flyer, environment or force model is one new module in its room, or one of a plug-in.
"""

import importlib
import pkgutil
from functools import cache

from lightflyer.core.extras import load_plugins

_ROOMS = (
    "lightflyer.film",
    "lightflyer.environment",
    "lightflyer.flyer",
    "lightflyer.force",
)
_FIGURES = "figures"  # how such names end: they draw on demand, and import matplotlib


@cache
def discover() -> None:
    """Import every module that may declare an alternative of a section."""
    for room in _ROOMS:
        package = importlib.import_module(room)
        for module in pkgutil.walk_packages(package.__path__, f"{room}."):
            if not module.name.endswith(_FIGURES):
                importlib.import_module(module.name)
    load_plugins()
