"""Python's warnings about a design, gathered for the page that asked.

A library warns a whole process. While the server runs, what it says about parameters is kept for
the request in whose thread it is said.
"""

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from lightflyer.core.errors import ParameterWarning

_HERE = threading.local()


@contextmanager
def keeping_warnings() -> Iterator[None]:
    """Gather warnings about parameters for as long as the server runs."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", ParameterWarning)
        usual = warnings.showwarning

        def show(message: Warning | str, *rest: Any, **named: Any) -> None:
            gathered = getattr(_HERE, "gathered", None)
            if gathered is None:
                usual(message, *rest, **named)
            elif str(message) not in gathered:
                gathered.append(str(message))

        warnings.showwarning = show
        yield


@contextmanager
def gathering_warnings() -> Iterator[list[str]]:
    """Texts of the warnings that come up in this thread within the block."""
    before = getattr(_HERE, "gathered", None)
    found: list[str] = []
    _HERE.gathered = found
    try:
        yield found
    finally:
        _HERE.gathered = before
