"""What samples tell of an output: Sobol indices with intervals, and the worth of a measurement."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from lightflyer.film.properties import FACES

REPLICATES = 8  # Scrambled Sobol sequences, of which a study's samples consist

_UPPER_END = 0.975  # of a 95 % interval

ACCURACY = 0.01
"""Standard uncertainty of the measured difference [1]: what runs of both faces on one bench reach
with rows that scatter by 0.3 %."""

_DEGREE = 3  # of the polynomial that the output's mean is in the measured difference
_DRAWS = 8  # of the measurement's error for each design


def indices_with_intervals(
    values: np.ndarray, groups: int, count: int
) -> tuple[np.ndarray, np.ndarray]:
    r"""First and total indices, and the half widths of their 95 % intervals, shape (2, count)."""
    # The points are :data:`REPLICATES` Sobol sequences, each scrambled by itself, so that the
    # scatter among them is that of the estimate; a bootstrap of single points would overstate it,
    # for the points of a sequence avoid each other. A jackknife that leaves out one sequence at a
    # time gives the standard error, and Student's distribution the interval.
    from SALib.analyze import sobol as analysis

    base = values.size // (groups + 2)
    replicates = min(REPLICATES, base)
    centred = (values - values.mean()) / (values.std() or 1.0)
    first, last, mixed, _ = analysis.separate_output_values(centred, groups, base, False)

    def indices(kept: np.ndarray) -> np.ndarray:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of an output that does not vary: its indices are zero
            return np.array(
                [
                    [
                        estimate(first[kept], mixed[kept, group], last[kept])
                        for group in range(count)
                    ]
                    for estimate in (analysis.first_order, analysis.total_order)
                ]
            ).reshape(2, count)

    whole = indices(np.full(base, fill_value=True))
    if replicates < 2:
        return whole, np.full((2, count), np.inf)
    member = np.arange(base) * replicates // base
    without = np.array([indices(member != left_out) for left_out in range(replicates)])
    variance = (replicates - 1) * without.var(axis=0)
    return whole, stats.t.ppf(_UPPER_END, replicates - 1) * np.sqrt(variance)


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
