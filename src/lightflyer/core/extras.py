"""What other packages add: optional dependencies, and plug-ins."""

import importlib
import importlib.metadata
import pickle
import sys
import warnings
from functools import cache
from typing import Any

from lightflyer.core.errors import MissingExtraError, PluginWarning

ENTRY_POINTS = "lightflyer"  # Group of the entry points of plug-ins

# An entry that names a module declares whatever that module defines or registers when it is
# imported. One that names something in a module, "module:function", is a command.


_BY_XARRAY = ("dask", "pint")  # libraries that xarray loads wherever they are installed


def hide_libraries() -> None:
    """Let xarray load no library that takes long and is not asked for."""
    for name in _BY_XARRAY:
        sys.modules.setdefault(name, None)  # type: ignore[arg-type]


def _show_libraries() -> None:
    for name in _BY_XARRAY:
        if sys.modules.get(name, sys) is None:
            del sys.modules[name]


def extra(module: str, what: str, extra_name: str) -> Any:
    """Import a module of an optional dependency."""
    _show_libraries()
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise MissingExtraError(
            f"{what} needs {package}: pip install 'lightflyer[{extra_name}]'"
        ) from error


def version_of(package: str) -> str:
    """Version of a package, or that it is not installed."""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def plugins() -> importlib.metadata.EntryPoints:
    """All plug-ins that are installed; none is imported."""
    return importlib.metadata.entry_points(group=ENTRY_POINTS)


@cache
def _waiting() -> list[importlib.metadata.EntryPoint]:
    """Plug-ins that are still to be imported."""
    return [entry for entry in plugins() if not entry.attr]


def load_plugins() -> None:
    """Import every plug-in that is no command, once; look nothing up by name before."""
    while _waiting():
        load_plugin(_waiting().pop(0))  # first removed: its module may come here again


def load_plugin(entry: importlib.metadata.EntryPoint) -> Any:
    """What an entry names; a warning and None where its author made a mistake."""
    _show_libraries()
    try:
        return entry.load()
    except Exception as error:
        reason = " ".join(str(error).split())
        warnings.warn(
            f"plug-in {entry.name} ({entry.value}) cannot be imported and is left out: "
            f"{type(error).__name__}: {reason}",
            PluginWarning,
            stacklevel=2,
        )


def dumps(value: Any) -> bytes:
    """Pickle an object, of a script or notebook too; :func:`pickle.loads` reads it elsewhere."""
    try:
        import cloudpickle
    except ImportError:
        return pickle.dumps(value)
    found: bytes = cloudpickle.dumps(value)
    return found
