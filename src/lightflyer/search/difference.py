"""What a measurement of the difference of a film's accommodation coefficients is worth."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.film.section import FACES

ACCURACY = 0.01
"""Standard uncertainty of the measured difference [1]: what runs of both faces on one bench reach
with rows that scatter by 0.3 %."""

_DEGREE = 3  # of the polynomial that the output's mean is in the measured difference
_DRAWS = 8  # of the measurement's error for each design


@dataclass(frozen=True)
class MeasuredDifference:
    r"""What a measurement of :math:`\alpha_\mathrm{top}-\alpha_\mathrm{bottom}` would tell."""

    top: str  #: Dotted name of the top face's coefficient
    bottom: str  #: Dotted name of the bottom face's
    known: float  #: Standard deviation of the difference by the inputs [1]
    removed: float  #: Share of the output's variance that the measurement would remove [1]
    accuracy: float = ACCURACY  #: Standard uncertainty of the measurement [1]

    def spread_after(self, spread: float) -> float:
        """Standard deviation of the output after the measurement, from that before."""
        return spread * float(np.sqrt(1.0 - self.removed))

    def summary(self, spread: float) -> dict[str, Any]:
        """As a JSON object; ``spread``: standard deviation of the output."""
        return {
            "top": self.top,
            "bottom": self.bottom,
            "accuracy": self.accuracy,
            "standard_deviation_of_difference": self.known,
            "share_of_variance_removed": self.removed,
            "standard_deviation_after": self.spread_after(spread),
        }


def measured_differences(
    output: np.ndarray, inputs: Mapping[str, np.ndarray], seed: int
) -> tuple[MeasuredDifference, ...]:
    r"""Worth of measuring the difference of each film of which both coefficients are uncertain.

    Parameters
    ----------
    output : array, shape (n,)
        Of designs that are drawn from the inputs' joint distribution.
    inputs : mapping of str to array, shape (n,)
        The designs' inputs by dotted name.
    seed : int
        Of the measurement's errors.

    Returns
    -------
    tuple of MeasuredDifference

    Notes
    -----
    A measured difference :math:`d` leaves :math:`\mathrm E[\mathrm{Var}(q\,|\,d)]` of the output's
    variance on average, so that :math:`\mathrm{Var}[\mathrm E(q\,|\,d)]` is removed. The mean
    :math:`\mathrm E(q\,|\,d)` is a cubic, fitted to the designs with a drawn error in each
    :math:`d`.
    """
    found = []
    for top in inputs:
        bottom = f"{top.removesuffix(FACES[0])}{FACES[1]}"
        if not top.endswith(FACES[0]) or bottom not in inputs:
            continue
        difference = inputs[top] - inputs[bottom]
        errors = ACCURACY * np.random.default_rng(seed).normal(size=(_DRAWS, difference.size))
        measured, told = (difference + errors).ravel(), np.tile(output, _DRAWS)
        removed = 0.0
        if told.std():
            fitted = np.polynomial.Polynomial.fit(measured, told, _DEGREE)(measured)
            removed = float(np.clip(1.0 - np.var(told - fitted) / np.var(told), 0.0, 1.0))
        found.append(MeasuredDifference(top, bottom, float(difference.std()), removed))
    return tuple(found)
