"""Measured numbers with their intervals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import optimize, stats

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import require_record

CONFIDENCE = 0.95  # Confidence of every interval of the lab bench

NORMAL_FACTOR = float(stats.norm.ppf(0.5 + 0.5 * CONFIDENCE))
"""Half width of a normal distribution's 95 % interval over its standard deviation [1]."""


_NEGLIGIBLE = 1e-12  # of the variance between estimates


@dataclass(frozen=True)
class Estimate(ShortRepr):
    """A measured number."""

    value: float
    #: Ends of the 95 % interval; infinite where the data set no bound
    interval: tuple[float, float]
    unit: str = ""  #: Unit of value, interval and uncertainty; ``""`` for a pure number
    uncertainty: float | None = None  #: Standard uncertainty, if the interval has one

    @classmethod
    def normal(
        cls, value: float, uncertainty: float, unit: str = "", freedom: float = math.inf
    ) -> "Estimate":
        """An estimate with a symmetric interval."""
        half = student_factor(freedom) * uncertainty
        return cls(float(value), (float(value - half), float(value + half)), unit, uncertainty)

    @classmethod
    def covering(cls, value: float, half: float, unit: str = "") -> "Estimate":
        """An estimate whose uncertainty carries its 95 % interval on."""
        # The standard error of few repeats is too small to be used as that of a normal
        # distribution: two repeats need 12.7 of them in place of 1.96. The uncertainty here is that
        # of the normal distribution with the same 95 % interval.
        value, half = float(value), float(half)
        return cls(value, (value - half, value + half), unit, half / NORMAL_FACTOR)

    @classmethod
    def of_draws(cls, value: float, draws: np.ndarray, unit: str = "") -> "Estimate":
        """An estimate with the percentile interval of draws."""
        low, high = map(float, central_interval(draws))
        return cls(value, (min(low, value), max(high, value)), unit, float(draws.std(ddof=1)))

    def clipped(self, low: float, high: float) -> "Estimate":
        """The estimate within what is possible; its uncertainty is unchanged."""
        value, *ends = np.clip([self.value, *self.interval], low, high).tolist()
        return Estimate(value, (ends[0], ends[1]), self.unit, self.uncertainty)

    def to_json(self) -> dict[str, Any]:
        """JSON object of value, interval, uncertainty and unit; what is unknown is null."""
        low, high, spread = (
            float(one) if one is not None and math.isfinite(one) else None
            for one in (*self.interval, self.uncertainty)
        )
        return {
            "value": float(self.value),
            "interval_95": [low, high],
            "standard_uncertainty": spread,
            "unit": self.unit,
        }

    def interval_text(self, digits: int = 4) -> str:
        """The 95 % interval, as tables show it."""
        low, high = self.interval
        return f"{low:.{digits}g} to {high:.{digits}g}"

    def __str__(self) -> str:
        return f"{self.value:.4g} ({self.interval_text()}) {self.unit}".rstrip()


def central_interval(draws: np.ndarray, axis: int = -1) -> np.ndarray:
    """Central 95 % interval of draws, shape (2, ...); lower and upper ends."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    return np.asarray(np.quantile(draws, [tail, 1.0 - tail], axis=axis))


def student_factor(freedom: float) -> float:
    """Half width of the 95 % interval over the standard uncertainty."""
    return float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, freedom))


def weighted_mean(estimates: Sequence[Estimate], *, common: float = 0.0) -> Estimate:
    r"""Mean of estimates of one quantity, including the variance between them.

    Parameters
    ----------
    estimates : sequence of Estimate
        In the same unit, with standard uncertainties whose errors are independent of each other.
    common : float
        Standard uncertainty of an error that all estimates share, such as that of one gauge, in
        their unit. It is not part of their own uncertainties, and does not average out.

    Returns
    -------
    Estimate
        Its uncertainty is that of the normal distribution with the same 95 % interval.

    Raises
    ------
    ParameterError
        If there is no estimate, or the uncertainty of one of several is missing or zero.

    Notes
    -----
    Estimates are weighted by :math:`w_i=1/(u_i^2+\tau^2)`. Here :math:`\tau^2`, the variance
    between them beyond their own uncertainties, is the one for which
    :math:`Q=\sum w_i(y_i-\bar y)^2` is :math:`k-1` (Paule and Mandel), or zero where they agree.
    The half width is Student's factor for :math:`k-1` degrees of freedom times
    :math:`\sqrt{Q/((k-1)\sum w_i)}` (Hartung and Knapp), but never less than the one of the stated
    uncertainties, :math:`1.96/\sqrt{\sum w_i}`: a few estimates may agree by chance. Where they
    vary by no more than their uncertainties, the interval is wider than it need be. That of two is
    wide in any case: Student's factor is 12.7.

    References
    ----------
    [PauleMandel1982]_, [HartungKnapp2001]_, [Roever2015]_.

    Examples
    --------
    >>> print(weighted_mean([Estimate.normal(one, 0.03) for one in (0.86, 0.92, 0.75, 0.81)]))
    0.835 (0.7199 to 0.9501)
    """
    for one in estimates:
        require_record("an estimate", (Estimate,), one)
    if len(estimates) == 1:
        one = estimates[0]
        if not common:
            return one
        low, high = (math.hypot(end - one.value, NORMAL_FACTOR * common) for end in one.interval)
        uncertainty = None if one.uncertainty is None else math.hypot(one.uncertainty, common)
        return Estimate(one.value, (one.value - low, one.value + high), one.unit, uncertainty)
    if not estimates or not all(one.uncertainty for one in estimates):
        raise ParameterError("a weighted mean needs estimates with uncertainties above zero")
    values = np.array([one.value for one in estimates])
    variances = np.array([one.uncertainty for one in estimates], float) ** 2
    weights = 1.0 / (variances + _variance_between(values, variances))
    mean = float(weights @ values / weights.sum())
    freedom = len(values) - 1
    scatter = float(weights @ (values - mean) ** 2) / freedom
    factor = max(student_factor(freedom) * math.sqrt(scatter), NORMAL_FACTOR)
    half = math.hypot(factor / math.sqrt(weights.sum()), NORMAL_FACTOR * common)
    return Estimate.covering(mean, half, estimates[0].unit)


def _variance_between(values: np.ndarray, variances: np.ndarray) -> float:
    """Variance between estimates beyond their own variances, by Paule and Mandel."""

    def excess(between: float) -> float:
        weights = 1.0 / (variances + between)
        mean = weights @ values / weights.sum()
        return float(weights @ (values - mean) ** 2) - (len(values) - 1)

    highest = float(values.var(ddof=1))  # where the excess is not positive but by rounding
    if excess(0.0) <= 0.0:
        return 0.0
    if excess(highest) >= 0.0:
        return highest
    return float(optimize.brentq(excess, 0.0, highest, xtol=_NEGLIGIBLE * highest))
