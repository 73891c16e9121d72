"""The values that a study gives to a number, distributions and samples of several together."""

import abc
import math
import warnings
from collections.abc import Callable, Container, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError, ParameterError, ParameterWarning
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.design.design import AbstractDesign, Field
from lightflyer.environment.section import warn_of_kilometres
from lightflyer.numerics.correlation import Correlations
from lightflyer.uncertainty.inputs import correlate

SAMPLE = "sample"  # Dimension along which all distributions are drawn together

_LOST = 0.01  # share that is impossible, from which a warning says so
SAMPLES = 1024  # of distributions, unless stated otherwise
MOST_SAMPLES = 10_000_000
"""Most numbers along one dimension of a study: unlike its results they are kept in memory."""


@dataclass(frozen=True)
class Distribution(abc.ABC):
    """Distribution of one number."""

    field: Field

    @abc.abstractmethod
    def quantile(self, share: np.ndarray) -> np.ndarray:
        """Values below which given shares of all values lie; in the unit of the field."""


@dataclass(frozen=True)
class Normal(Distribution):
    """Normal distribution, truncated to possible values."""

    mean: float  # Before truncation, in the unit of the field
    standard_deviation: float

    def _ends(self) -> tuple[float, float]:
        """Ends of what is possible, in standard deviations from the mean."""
        possible = self.field.quantity
        low, high = (
            (end - self.mean) / self.standard_deviation
            for end in (possible.lowest, possible.highest)
        )
        return low, high

    def impossible(self) -> float:
        """Share of the distribution before truncation that is not possible."""
        from scipy.special import ndtr

        low, high = self._ends()
        return float(ndtr(low) + ndtr(-high))

    def quantile(self, share: np.ndarray) -> np.ndarray:
        from scipy.stats import truncnorm

        possible, (low, high) = self.field.quantity, self._ends()
        values = truncnorm.ppf(share, low, high, loc=self.mean, scale=self.standard_deviation)
        # the ends of an open range are limits, not values
        inside = np.nextafter(possible.lowest, np.inf) if possible.open_below else possible.lowest
        return np.clip(values, inside, possible.highest)


@dataclass(frozen=True)
class Uniform(Distribution):
    """Uniform distribution."""

    low: float  # In the unit of the field
    high: float  # In the unit of the field

    def quantile(self, share: np.ndarray) -> np.ndarray:
        return self.low + share * (self.high - self.low)


@dataclass(frozen=True)
class LogUniform(Distribution):
    """Distribution whose logarithm is uniform."""

    low: float  # Positive, in the unit of the field
    high: float  # Positive, in the unit of the field

    def quantile(self, share: np.ndarray) -> np.ndarray:
        return self.low * (self.high / self.low) ** share


def stated_distributions(design: AbstractDesign, given: Container[str] = ()) -> list[Distribution]:
    """A design's own uncertainties, as normal distributions."""
    found: list[Distribution] = []
    for name, spread in design.uncertainties.items():
        value = design.number(name)
        if name in design.fields and name not in given and value is not None and spread > 0.0:
            found.append(Normal(design.field(name), value, spread))
    return found


def _sobol(points: int, count: int, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    power = math.ceil(math.log2(points)) if points > 1 else 0
    return qmc.Sobol(count, rng=seed).random_base2(power)[:points]


def _latin_hypercube(points: int, count: int, seed: int) -> np.ndarray:
    from scipy.stats import qmc

    return qmc.LatinHypercube(count, rng=seed).random(points)


def _random(points: int, count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).random((points, count))


METHODS = {"sobol": _sobol, "latin-hypercube": _latin_hypercube, "random": _random}
"""Ways of drawing samples, by their names in a study file."""


def draw_samples(
    distributions: Sequence[Distribution],
    points: int,
    method: str,
    seed: int,
    correlations: Correlations | None = None,
) -> dict[str, np.ndarray]:
    """Samples of all distributions together, shape (points,); values by dotted name."""
    count = len(distributions)
    if points * count > MOST_SAMPLES:
        raise ConfigurationError(
            f"points = {points} samples of {count} numbers do not fit into memory; at most "
            f"{MOST_SAMPLES // count}, or sweep a range instead"
        )
    for one in distributions:
        lost = one.impossible() if isinstance(one, Normal) else 0.0
        if lost > _LOST:
            warnings.warn(
                f"{one.field.name}: {100.0 * lost:.0f} % of the distribution is impossible; "
                "samples are of the rest",
                ParameterWarning,
                stacklevel=2,
            )
    names = [distribution.field.name for distribution in distributions]
    shares = correlate(METHODS[method](points, count, seed), names, correlations or {})
    return {
        distribution.field.name: distribution.quantile(shares[:, number])
        for number, distribution in enumerate(distributions)
    }


_ALTITUDE = "altitude"  # the coordinate of planets
_RANGE = ("from", "to", "points", "scale")
_SCALES = ("linear", "log")
_EXAMPLE = '{ from = "1 cm", to = "5 cm", points = 9 }'


@dataclass(frozen=True, eq=False)
class StudyAxis:
    """Values of one number, a dimension of their own; a single value is no dimension."""

    field: Field
    values: np.ndarray  # shape (n,); in the unit of the field
    single: bool = False  # Whether it is one value, given as such


def read_entry(entry: Any, field: Field) -> StudyAxis | Distribution:
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
        return StudyAxis(field, np.array([entry], float), single=True)
    measured = field.quantity.read(entry)
    if measured.uncertainty:
        return Normal(field, measured.value, measured.uncertainty)
    return StudyAxis(field, np.array([measured.value]), single=True)


def require(field: Field, values: np.ndarray) -> None:
    """Raise unless all values of a number are possible; ``values``: in the unit of the field."""
    try:
        field.quantity.check(field.name, values)
    except ParameterError as error:
        raise ConfigurationError(f"{error} {field.quantity.unit}".rstrip()) from None


def _axis(field: Field, values: np.ndarray) -> StudyAxis:
    if not values.size:
        raise ConfigurationError("is an empty list; give at least one value")
    if np.unique(values).size < values.size:
        raise ConfigurationError("has a repeated value")
    return StudyAxis(field, values)


def _range(entry: Mapping[str, Any], field: Field) -> StudyAxis:
    _require_keys(entry, _RANGE, ("from", "to", "points"), "a range")
    points = entry["points"]
    if isinstance(points, bool) or not isinstance(points, int) or points < 2:
        raise ConfigurationError(f"points = {points} must be a whole number of at least 2")
    if points > MOST_SAMPLES:
        raise ConfigurationError(f"points = {points} must be at most {MOST_SAMPLES}")
    low, high, logarithmic = read_ends(entry, field)
    spaced = np.geomspace if logarithmic else np.linspace
    return StudyAxis(field, spaced(low, high, points))


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
