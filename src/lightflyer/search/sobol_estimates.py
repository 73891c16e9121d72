"""Estimates of Sobol indices with intervals that know how the samples were drawn."""

import warnings

import numpy as np
from scipy import stats

REPLICATES = 8  # Scrambled Sobol sequences, of which a study's samples consist

_UPPER_END = 0.975  # of a 95 % interval


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
