"""Numbers that are uncertain: their distributions, and samples of several together."""

import abc
import math
import warnings
from collections.abc import Container, Sequence
from dataclasses import dataclass

import numpy as np

from lightflyer.core.errors import ConfigurationError, ParameterWarning
from lightflyer.design.design import AbstractDesign, Field
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
