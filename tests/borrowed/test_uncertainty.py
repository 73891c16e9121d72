"""Public reports of uncertainties: indices by closed formulas.

Tests of other rooms have the cases of https://github.com/lmfit/uncertainties/issues/29, 95 and 141
and https://github.com/eggzec/mcerp/issues/24 (`uncertainty/test_correlation.py`), and of
https://github.com/stcorp/harp/issues/302 and https://github.com/scipp/scipp/pull/3919
(`lab/test_estimate.py`).
"""

import numpy as np
from SALib.test_functions import Ishigami
from scipy.stats import qmc

from lightflyer.search.sobol_estimates import REPLICATES, indices_with_intervals


def test_indices_of_a_known_function():
    """https://github.com/SALib/SALib/issues/102, 135: an index of nothing was below zero.

    Ishigami's function has the first indices 0.3139, 0.4424 and 0, the total ones 0.5576, 0.4424
    and 0.2437; a negative estimate lies within its interval of zero.
    """
    base, count = 1 << 12, 3
    rows = []
    for seed in range(REPLICATES):
        points = np.pi * (2.0 * qmc.Sobol(2 * count, seed=seed).random(base // REPLICATES) - 1.0)
        for first, last in zip(points[:, :count], points[:, count:], strict=True):
            mixed = np.tile(first, (count, 1))
            mixed[np.arange(count), np.arange(count)] = last
            rows += [first, *mixed, last]
    found, half = indices_with_intervals(Ishigami.evaluate(np.array(rows)), count, count)
    expected = [[0.3139, 0.4424, 0.0], [0.5576, 0.4424, 0.2437]]
    assert np.all(np.abs(found - expected) < np.maximum(1.5 * half, 0.01))
    assert np.all(half < 0.08)
