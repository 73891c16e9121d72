"""Optional dependencies, imported when first needed."""

import importlib
from typing import Any

from lightflyer.core.errors import MissingExtraError


def extra(module: str, what: str, extra_name: str) -> Any:
    """Import a module of an optional dependency.

    Parameters
    ----------
    module : str
        Such as ``"lmfit"`` or ``"skmisc.loess"``.
    what : str
        Beginning of the message: what needs the module.
    extra_name : str
        Extra of the package that installs it.

    Returns
    -------
    module

    Raises
    ------
    MissingExtraError
        If it is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise MissingExtraError(
            f"{what} needs {package}: pip install 'lightflyer[{extra_name}]'"
        ) from error
