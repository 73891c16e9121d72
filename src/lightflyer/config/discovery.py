"""Finding the alternatives of a flyer file's sections: by importing the modules that declare them.

A new flyer, environment or force model is one new module in its room. A package of somebody else's
adds its own by an entry point of the group ``"lightflyer"`` that names its module; one that fails
to import is a warning.
"""

import importlib
import importlib.metadata
import pkgutil
import warnings
from functools import cache

from lightflyer.core.errors import PluginWarning

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
        for module in pkgutil.walk_packages(package.__path__, f"{room}."):
            if not module.name.endswith(_FIGURES):
                importlib.import_module(module.name)
    for entry in importlib.metadata.entry_points(group=ENTRY_POINTS):
        _load(entry)


def _load(entry: importlib.metadata.EntryPoint) -> None:
    """Import a plug-in; its author's mistakes must not stop anybody else's work."""
    try:
        entry.load()
    except Exception as error:
        reason = " ".join(str(error).split())
        warnings.warn(
            f"plug-in {entry.name} ({entry.value}) cannot be imported and is left out: "
            f"{type(error).__name__}: {reason}",
            PluginWarning,
            stacklevel=2,
        )
