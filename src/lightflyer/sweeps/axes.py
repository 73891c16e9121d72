"""The values that a study gives to a field: one, a list, a range, or a distribution."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.flight.fields import Field
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterError
from lightflyer.foundation.quantity import Quantity
from lightflyer.foundation.units import Measured
from lightflyer.uncertainty.correlation import correlate

SAMPLE = "sample"
"""Dimension along which all distributions are drawn together."""

METHODS = ("sobol", "latin-hypercube", "random")
"""Ways of drawing samples."""

MOST_SAMPLES = 10_000_000
"""Numbers along one dimension of a study: they are kept whole, unlike its results."""

_DISTRIBUTIONS = {
    "normal": ("mean", "standard_deviation"),
    "uniform": ("from", "to"),
    "log-uniform": ("from", "to"),
}
_RANGE = ("from", "to", "points", "scale")
_SCALES = ("linear", "log")
_EXAMPLE = '{ from = "1 cm", to = "5 cm", points = 9 }'


@dataclass(frozen=True, eq=False)
class Axis:
    """Values of one field, a dimension of their own; one value alone is no dimension.

    Attributes
    ----------
    field : Field
    values : array, shape (n,)
        In the unit of the field.
    single : bool
        Whether it is one value, given as such.
    """

    field: Field
    values: np.ndarray
    single: bool = False


@dataclass(frozen=True)
class Distribution:
    """Values of one field by chance.

    Attributes
    ----------
    field : Field
    kind : str
        ``"normal"``, cut off where a value is impossible, ``"uniform"`` or ``"log-uniform"``.
    first, second : float
        Mean and standard deviation, or the ends, in the unit of the field.
    """

    field: Field
    kind: str
    first: float
    second: float

    def quantile(self, share: np.ndarray) -> np.ndarray:
        """Values below which the given shares of all values lie.

        Parameters
        ----------
        share : array, shape (...)
            Between 0 and 1.

        Returns
        -------
        array, shape (...)
        """
        if self.kind == "uniform":
            return self.first + share * (self.second - self.first)
        if self.kind == "log-uniform":
            return self.first * (self.second / self.first) ** share
        from scipy.stats import truncnorm

        possible = self.field.quantity
        low, high = (
            (end - self.first) / self.second for end in (possible.lowest, possible.highest)
        )
        values = truncnorm.ppf(share, low, high, loc=self.first, scale=self.second)
        # the ends of an open range are limits, not values
        inside = np.nextafter(possible.lowest, np.inf) if possible.open_below else possible.lowest
        return np.clip(values, inside, possible.highest)


def read_entry(entry: Any, field: Field) -> Axis | Distribution:
    """What a study says of a field.

    Parameters
    ----------
    entry : object
        A quantity, a list of them, a range ``{from, to, points, scale}``, a distribution
        ``{distribution, ...}``, a text with ±, or an array in the unit of the field.
    field : Field

    Returns
    -------
    Axis or Distribution

    Raises
    ------
    ConfigurationError
        Saying what is wrong and what is allowed.
    """
    quantity = field.quantity
    if isinstance(entry, np.ndarray):
        return _array_axis(entry, field)
    if isinstance(entry, list | tuple) and not isinstance(entry, Measured):
        return _list_axis(entry, field)
    if isinstance(entry, Mapping):
        if "distribution" in entry:
            return _distribution(entry, field)
        return _range(entry, field)
    measured = quantity.read(entry)
    if measured.uncertainty:
        return Distribution(field, "normal", measured.value, measured.uncertainty)
    return Axis(field, np.array([measured.value]), single=True)


def require(field: Field, values: np.ndarray) -> None:
    """Raise unless all values of a field are possible.

    Parameters
    ----------
    field : Field
    values : array, shape (...)
        In the unit of the field.

    Raises
    ------
    ConfigurationError
        Naming the first that is not, and what is allowed.
    """
    allowed = field.quantity
    ends = (allowed.lowest, allowed.highest)
    try:
        require_range(field.name, values, *ends, open_below=allowed.open_below)
    except ParameterError as error:
        raise ConfigurationError(f"{error} {allowed.unit}".rstrip()) from None


def _array_axis(values: np.ndarray, field: Field) -> Axis:
    if values.ndim != 1:
        raise ConfigurationError(f"has {values.ndim} dimensions; give values along one")
    require(field, values)
    return _axis(field, values.astype(float))


def _list_axis(entries: Sequence[Any], field: Field) -> Axis:
    return _axis(field, np.array([field.quantity.read(entry).value for entry in entries]))


def _axis(field: Field, values: np.ndarray) -> Axis:
    if not values.size:
        raise ConfigurationError("is an empty list; give at least one value")
    if np.unique(values).size < values.size:
        raise ConfigurationError("holds a value twice")
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
    """Ends of a range, and whether its scale is logarithmic.

    Parameters
    ----------
    entry : dict
        With ``from``, ``to`` and perhaps ``scale``.
    field : Field
    known : sequence of str
        Keys that the entry may have.

    Returns
    -------
    low, high : float
        In the unit of the field.
    logarithmic : bool

    Raises
    ------
    ConfigurationError
        Saying what is wrong and what is allowed.
    """
    _require_keys(entry, known, ("from", "to"), "a range")
    low, high = _ends(entry, field.quantity)
    scale = entry.get("scale", "linear")
    if scale not in _SCALES:
        raise ConfigurationError(f'scale = "{scale}" is unknown; there are: {", ".join(_SCALES)}')
    if scale == "log":
        _require_positive_ends(low, high)
    return low, high, scale == "log"


def _ends(entry: Mapping[str, Any], quantity: Quantity) -> tuple[float, float]:
    low, high = (quantity.read(entry[name]).value for name in ("from", "to"))
    if low == high:
        raise ConfigurationError(f"is an empty range: from and to are both {entry['from']}")
    if low > high:
        raise ConfigurationError(f"is an empty range: {entry['from']} is above {entry['to']}")
    return low, high


def _require_positive_ends(low: float, high: float) -> None:
    if low <= 0.0 or high <= 0.0:
        raise ConfigurationError("reaches zero, which no logarithmic scale does")


def _distribution(entry: Mapping[str, Any], field: Field) -> Distribution:
    kind = entry["distribution"]
    if kind not in _DISTRIBUTIONS:
        known = ", ".join(_DISTRIBUTIONS)
        raise ConfigurationError(f'distribution = "{kind}" is unknown; there are: {known}')
    needed = _DISTRIBUTIONS[kind]
    _require_keys(entry, ("distribution", *needed), needed, f"a {kind} distribution")
    if kind != "normal":
        low, high = _ends(entry, field.quantity)
        if kind == "log-uniform":
            _require_positive_ends(low, high)
        return Distribution(field, kind, low, high)
    mean = field.quantity.read(entry["mean"]).value
    # a spread is a difference: any size, and without the offset of a temperature scale
    spread = Quantity(field.quantity.unit).read(entry["standard_deviation"]).value
    if not (spread > 0.0 and math.isfinite(spread)):
        raise ConfigurationError("standard_deviation must be positive")
    return Distribution(field, kind, mean, spread)


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
        raise ConfigurationError(f"needs {', '.join(missing)}: a range is such as {_EXAMPLE}")


def draw(
    distributions: Sequence[Distribution],
    points: int,
    method: str,
    seed: int,
    tac_correlation: float = 0.0,
) -> dict[str, np.ndarray]:
    """Samples of all distributions together.

    Parameters
    ----------
    distributions : sequence of Distribution
    points : int
        Samples; for ``"sobol"`` a power of two keeps its balance.
    method : str
        Of :data:`METHODS`.
    seed : int
    tac_correlation : float
        Of the errors of the faces' accommodation coefficients.

    Returns
    -------
    dict of str to array, shape (points,)
        Values by dotted name.

    Raises
    ------
    ConfigurationError
        If there are too many to be held.
    """
    count = len(distributions)
    if points * count > MOST_SAMPLES:
        raise ConfigurationError(
            f"points = {points} of {count} fields are too many to be held: at most "
            f"{MOST_SAMPLES // count}; a range costs nothing"
        )
    from scipy.stats import qmc

    if method == "sobol":
        power = math.ceil(math.log2(points)) if points > 1 else 0
        shares = qmc.Sobol(count, rng=seed).random_base2(power)[:points]
    elif method == "latin-hypercube":
        shares = qmc.LatinHypercube(count, rng=seed).random(points)
    else:
        shares = np.random.default_rng(seed).random((points, count))
    names = [distribution.field.name for distribution in distributions]
    shares = correlate(shares, names, tac_correlation)
    return {
        distribution.field.name: distribution.quantile(shares[:, number])
        for number, distribution in enumerate(distributions)
    }
