"""In what the surroundings and the force models of compared flyers differ."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from lightflyer.array.records import Module, ShortRepr
from lightflyer.core.quantity import Quantity, quantities_of
from lightflyer.core.units import scale_and_offset
from lightflyer.design.design import digest
from lightflyer.design.setup import Setup

_RADIATION = "radiation"
_RANGE = "searched"


@dataclass(frozen=True)
class Difference(ShortRepr):
    """Something in which flyers differ.

    Attributes
    ----------
    what : str
        Such as ``"light"`` or ``"atmosphere"``.
    values : dict of str to str
        What it is for each flyer, by the flyer's name.
    """

    what: str
    values: dict[str, str]

    def __str__(self) -> str:
        groups: dict[str, list[str]] = {}
        for name, value in self.values.items():
            groups.setdefault(value, []).append(name)
        told = "; ".join(f"{value} ({', '.join(names)})" for value, names in groups.items())
        return f"{self.what}: {told}"


def differing_surroundings(setups: Mapping[str, Setup]) -> tuple[Difference, ...]:
    """In what the surroundings of flyers differ; ``setups``: by the flyer's name."""
    surroundings = {name: setup.environment for name, setup in setups.items()}
    light = tuple(_describe({name: found.assumptions() for name, found in surroundings.items()}))
    skipped = (_RADIATION,) if light else ()
    rest = _differences("", surroundings, Quantity(), skipped)
    searched = {name: _range_of(setup) for name, setup in setups.items()}
    return (*light, *rest, *_if_different(_RANGE, searched))


def differing_models(setups: Mapping[str, Setup]) -> tuple[Difference, ...]:
    """In what the force models of flyers differ; see :func:`differing_surroundings`."""
    models = {name: setup.model for name, setup in setups.items()}
    return tuple(_differences("force model", models, Quantity()))


def _describe(texts: Mapping[str, Sequence[str]]) -> Iterator[Difference]:
    """Differences between descriptions whose texts begin with what they are about."""
    told = {
        name: dict(text.partition(": ")[::2] for text in described)
        for name, described in texts.items()
    }
    for topic in dict.fromkeys(topic for described in told.values() for topic in described):
        values = {name: described.get(topic, "none") for name, described in told.items()}
        yield from _if_different(topic, values)


def _if_different(what: str, values: dict[str, str]) -> Iterator[Difference]:
    if len(set(values.values())) > 1:
        yield Difference(what, values)


def _differences(
    what: str, parts: Mapping[str, Any], quantity: Quantity, skipped: tuple[str, ...] = ()
) -> Iterator[Difference]:
    """Differences between objects, field by field as far down as they are of one kind."""
    first = next(iter(parts.values()))
    if isinstance(first, Module) and len({type(part) for part in parts.values()}) == 1:
        known = quantities_of(type(first))
        for field in fields(first):
            if field.name in skipped:
                continue
            values = {name: getattr(part, field.name) for name, part in parts.items()}
            words = f"{what} {field.name.replace('_', ' ')}".lstrip()
            yield from _differences(words, values, known.get(field.name, Quantity()))
        return
    yield from _if_different(
        what or "surroundings", {name: _text(part, quantity) for name, part in parts.items()}
    )


def _text(value: Any, quantity: Quantity) -> str:
    if isinstance(value, Module):
        return type(value).__name__
    if value is None:
        return "not given"
    if isinstance(value, str | bool):
        return str(value)
    try:
        numbers = np.asarray(value, float)
    except (TypeError, ValueError):
        return str(value)
    if numbers.ndim:
        return f"{numbers.size} numbers ({digest(numbers)})"
    return f"{float(numbers):.9g} {quantity.unit}".rstrip()


def _range_of(setup: Setup) -> str:
    where = setup.environment.coordinate
    factor, _ = scale_and_offset(where.unit, where.shown_unit)
    low, high = (f"{float(end) * factor:g} {where.shown_unit}" for end in setup.searched)
    return f"{low} to {high}"
