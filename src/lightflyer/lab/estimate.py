"""Measured numbers with their intervals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
"""Confidence of every interval of the lab bench."""


@dataclass(frozen=True)
class Estimate:
    """A measured number.

    Attributes
    ----------
    value : float
    interval : tuple of float
        Ends of the 95 % interval; infinite where the data set no bound.
    unit : str
        Unit of value, interval and uncertainty; ``""`` for a pure number.
    uncertainty : float or None
        Standard uncertainty, if the interval has one.
    """

    value: float
    interval: tuple[float, float]
    unit: str = ""
    uncertainty: float | None = None

    @classmethod
    def normal(
        cls, value: float, uncertainty: float, unit: str = "", freedom: float = math.inf
    ) -> "Estimate":
        """An estimate with a symmetric interval.

        Parameters
        ----------
        value, uncertainty : float
            Estimate and its standard uncertainty.
        unit : str
        freedom : float
            Degrees of freedom of the uncertainty, for Student's factor.

        Returns
        -------
        Estimate
        """
        half = float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, freedom)) * uncertainty
        return cls(float(value), (float(value - half), float(value + half)), unit, uncertainty)

    def to_json(self) -> dict[str, Any]:
        """JSON object of value, interval and unit; an infinite end is null."""
        ends = [end if math.isfinite(end) else None for end in map(float, self.interval)]
        return {"value": float(self.value), "interval_95": ends, "unit": self.unit}

    def __str__(self) -> str:
        low, high = self.interval
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.value:.4g} ({low:.4g} to {high:.4g}){unit}"


def central_interval(draws: np.ndarray, axis: int = -1) -> np.ndarray:
    """Central 95 % interval of draws.

    Parameters
    ----------
    draws : array
    axis : int
        Axis of the draws.

    Returns
    -------
    array, shape (2, ...)
        Lower and upper ends.
    """
    tail = 0.5 * (1.0 - CONFIDENCE)
    return np.asarray(np.quantile(draws, [tail, 1.0 - tail], axis=axis))


def weighted_mean(estimates: Sequence[Estimate]) -> Estimate:
    r"""Mean of independent estimates of one quantity, including the variance between them.

    Parameters
    ----------
    estimates : sequence of Estimate
        With standard uncertainties, in the same unit.

    Returns
    -------
    Estimate

    Notes
    -----
    Estimates are weighted by :math:`1/(u_i^2+\tau^2)`. Here :math:`\tau^2` is the variance between
    them beyond their own uncertainties; it is zero where they agree.

    References
    ----------
    [DerSimonian1986]_.
    """
    if len(estimates) == 1:
        return estimates[0]
    values = np.array([one.value for one in estimates])
    variances = np.array([one.uncertainty for one in estimates], float) ** 2
    weights = 1.0 / variances
    mean = float(weights @ values / weights.sum())
    excess = float(weights @ (values - mean) ** 2) - (len(values) - 1)
    between = excess / (weights.sum() - weights @ weights / weights.sum())
    weights = 1.0 / (variances + max(between, 0.0))
    mean = float(weights @ values / weights.sum())
    return Estimate.normal(mean, float(weights.sum() ** -0.5), estimates[0].unit)
