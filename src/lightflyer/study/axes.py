"""The values that a study gives to a number: one, a list, a range, or a distribution."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.design.design import Field
from lightflyer.environment.section import warn_of_kilometres
from lightflyer.study.distributions import (
    MOST_SAMPLES,
    Distribution,
    LogUniform,
    Normal,
    Uniform,
)

_ALTITUDE = "altitude"  # the coordinate of planets
_RANGE = ("from", "to", "points", "scale")
_SCALES = ("linear", "log")
_EXAMPLE = '{ from = "1 cm", to = "5 cm", points = 9 }'


@dataclass(frozen=True, eq=False)
class Axis:
    """Values of one number, a dimension of their own; a single value is no dimension."""

    field: Field
    values: np.ndarray  # shape (n,); in the unit of the field
    single: bool = False  # Whether it is one value, given as such


def read_entry(entry: Any, field: Field) -> Axis | Distribution:
    """What a study says about a number."""
    if hasattr(entry, "to_numpy") or hasattr(entry, "magnitude"):
        entry = np.asarray(field.quantity.number(field.name, entry))
    if isinstance(entry, np.ndarray) and entry.ndim:
        if entry.ndim != 1:
            raise ConfigurationError(f"has {entry.ndim} dimensions; give values along one")
        if entry.dtype.kind not in "fiu":
            raise ConfigurationError(f"must be an array of real numbers, not of {entry.dtype}")
        require(field, entry)
        if field.name == _ALTITUDE:
            warn_of_kilometres(entry)
        return _axis(field, entry.astype(float))
    if isinstance(entry, list | tuple) and not isinstance(entry, Measured):
        return _axis(field, np.array([field.quantity.read(one).value for one in entry]))
    if isinstance(entry, Mapping):
        return (_distribution if "distribution" in entry else _range)(entry, field)
    if isinstance(entry, np.ndarray | np.number):
        # as from other arrays: in the unit of the field
        require(field, np.asarray(entry))
        return Axis(field, np.array([entry], float), single=True)
    measured = field.quantity.read(entry)
    if measured.uncertainty:
        return Normal(field, measured.value, measured.uncertainty)
    return Axis(field, np.array([measured.value]), single=True)


def require(field: Field, values: np.ndarray) -> None:
    """Raise unless all values of a number are possible; ``values``: in the unit of the field."""
    try:
        field.quantity.check(field.name, values)
    except ParameterError as error:
        raise ConfigurationError(f"{error} {field.quantity.unit}".rstrip()) from None


def _axis(field: Field, values: np.ndarray) -> Axis:
    if not values.size:
        raise ConfigurationError("is an empty list; give at least one value")
    if np.unique(values).size < values.size:
        raise ConfigurationError("has a repeated value")
    return Axis(field, values)


def _range(entry: Mapping[str, Any], field: Field) -> Axis:
    _require_keys(entry, _RANGE, ("from", "to", "points"), "a range")
    points = entry["points"]
    if isinstance(points, bool) or not isinstance(points, int) or points < 2:
        raise ConfigurationError(f"points = {points} must be a whole number of at least 2")
    if points > MOST_SAMPLES:
        raise ConfigurationError(f"points = {points} must be at most {MOST_SAMPLES}")
    low, high, logarithmic = read_ends(entry, field)
    spaced = np.geomspace if logarithmic else np.linspace
    return Axis(field, spaced(low, high, points))


def read_ends(
    entry: Mapping[str, Any], field: Field, known: Sequence[str] = _RANGE
) -> tuple[float, float, bool]:
    """Ends of a range, and whether its scale is logarithmic."""
    _require_keys(entry, known, ("from", "to"), "a range")
    low, high = _ends(entry, field.quantity)
    scale = entry.get("scale", "linear")
    if scale not in _SCALES:
        raise ConfigurationError(f'scale = "{scale}" is unknown; choose from {", ".join(_SCALES)}')
    if scale == "log":
        _require_positive(low)
    return low, high, scale == "log"


def _ends(entry: Mapping[str, Any], quantity: Quantity) -> tuple[float, float]:
    low, high = (quantity.read(entry[name]).value for name in ("from", "to"))
    if low == high:
        raise ConfigurationError(f"is an empty range: from and to are both {entry['from']}")
    if low > high:
        raise ConfigurationError(f"is an empty range: {entry['from']} is above {entry['to']}")
    return low, high


def _require_positive(low: float) -> None:
    if low <= 0.0:
        raise ConfigurationError("reaches zero, where a logarithmic scale ends")


def _normal(entry: Mapping[str, Any], field: Field) -> Normal:
    mean = field.quantity.read(entry["mean"]).value
    # a spread is a difference: any size, and without the offset of a temperature scale
    spread = Quantity(field.quantity.unit).read(entry["standard_deviation"]).value
    if not (spread > 0.0 and math.isfinite(spread)):
        raise ConfigurationError("standard_deviation must be positive")
    return Normal(field, mean, spread)


def _uniform(entry: Mapping[str, Any], field: Field) -> Uniform:
    return Uniform(field, *_ends(entry, field.quantity))


def _log_uniform(entry: Mapping[str, Any], field: Field) -> LogUniform:
    low, high = _ends(entry, field.quantity)
    _require_positive(low)
    return LogUniform(field, low, high)


_Reader = Callable[[Mapping[str, Any], Field], Distribution]
_DISTRIBUTIONS: dict[str, tuple[_Reader, tuple[str, str]]] = {
    "normal": (_normal, ("mean", "standard_deviation")),
    "uniform": (_uniform, ("from", "to")),
    "log-uniform": (_log_uniform, ("from", "to")),
}


def _distribution(entry: Mapping[str, Any], field: Field) -> Distribution:
    kind = entry["distribution"]
    if kind not in _DISTRIBUTIONS:
        known = ", ".join(_DISTRIBUTIONS)
        raise ConfigurationError(f'distribution = "{kind}" is unknown; choose from {known}')
    read, needed = _DISTRIBUTIONS[kind]
    _require_keys(entry, ("distribution", *needed), needed, f"a {kind} distribution")
    return read(entry, field)


def _require_keys(
    entry: Mapping[str, Any], known: Sequence[str], needed: Sequence[str], what: str
) -> None:
    unknown = [key for key in entry if key not in known]
    if unknown:
        raise ConfigurationError(
            f"{unknown[0]} is not part of {what}, which takes {', '.join(known)}"
        )
    missing = [key for key in needed if key not in entry]
    if missing:
        hint = f", such as {_EXAMPLE}" if "distribution" not in entry else ""
        raise ConfigurationError(f"needs {', '.join(missing)}{hint}")
