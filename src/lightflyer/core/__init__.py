"""What everybody stands on: errors, types, constants, quantities with units, checks, progress."""

import difflib
from collections.abc import Callable, Iterable
from typing import Any

import lazy_loader


def attach(package: str, file: str) -> tuple[Callable[[str], Any], Callable[[], Any], Any]:
    """What a package with a stub loads names by when they are first used; see ``lazy_loader``."""
    find, names, every = lazy_loader.attach_stub(package, file)

    def found(name: str) -> Any:
        try:
            return find(name)
        except AttributeError as error:
            if name in every or name.startswith("__"):  # a fault within, or a question of Python's
                raise
            raise unknown(package, name, every) from error

    return found, names, every


def unknown(package: str, name: str, every: Iterable[str]) -> AttributeError:
    """The error of a name that a package does not have, with the nearest one."""
    known = {one.lower(): one for one in every}
    near = difflib.get_close_matches(name.lower(), known, n=1, cutoff=0.6)
    hint = f"; did you mean {package}.{known[near[0]]}?" if near else ""
    return AttributeError(f"{package} has no {name}{hint}")


__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, submodules=["quantity"])
