"""Coefficients of smooth functions through kinetic tables; studies/kinetic_fits makes them."""

import dataclasses
import json
from functools import cache
from importlib import resources
from typing import Any, TypeVar

from lightflyer.core.errors import ParameterError

Fit = TypeVar("Fit")

GASES = ("monatomic", "diatomic")
"""Kinds of molecules of which there are tables."""


def fitted(kind: type[Fit], name: str, gas: str, **given: Any) -> Fit:
    """A fit by its name, for a gas; ``given``: fields that have a place of their own."""
    if gas not in GASES:
        raise ParameterError(f"gas = {gas!r} is not one of {', '.join(GASES)}")
    content = _shipped()[name][gas]
    found: Fit = _made(kind, {**content, **given} if given else content)
    return found


@cache
def _shipped() -> dict[str, dict[str, Any]]:
    file = resources.files("lightflyer") / "data" / "kinetic_fits.json"
    found: dict[str, dict[str, Any]] = json.loads(file.read_text(encoding="utf-8"))
    return found


def _made(kind: Any, content: Any) -> Any:
    """A dataclass of its fields, a tuple of a list."""
    if isinstance(content, dict):
        kinds = {one.name: one.type for one in dataclasses.fields(kind)}
        return kind(**{name: _made(kinds[name], one) for name, one in content.items()})
    if isinstance(content, list):
        parts = tuple(_made(None, one) for one in content)
        return kind(*parts) if hasattr(kind, "_fields") else parts
    return content
