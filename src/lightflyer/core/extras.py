"""Optional dependencies, imported when first needed."""

import importlib
from typing import Any

from lightflyer.core.errors import MissingExtraError


def extra(module: str, what: str, extra_name: str) -> Any:
    """Import a module of an optional dependency."""
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        raise MissingExtraError(
            f"{what} needs {package}: pip install 'lightflyer[{extra_name}]'"
        ) from error
