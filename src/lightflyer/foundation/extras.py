"""The lab bench's optional dependencies, imported when first needed."""

import importlib
from typing import Any

from lightflyer.foundation.errors import MissingExtraError


def extra(module: str, purpose: str) -> Any:
    """Import a module that the extra ``lab`` brings.

    Parameters
    ----------
    module : str
    purpose : str
        What needs it, for the message.

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
            f"{purpose} needs {package}: pip install 'lightflyer[lab]'"
        ) from error
