"""Public reports of uncertainties: covariances, means and indices by closed formulas."""

import numpy as np
import pytest
from SALib.test_functions import Ishigami
from scipy.stats import norm, qmc

from lightflyer.lab.estimate import Estimate, weighted_mean
from lightflyer.search.sobol_estimates import REPLICATES, indices_with_intervals
from lightflyer.uncertainty.inputs import correlate


def drawn(values, spreads, correlations, count=1 << 15):
    """Normal draws of correlated numbers."""
    names = tuple(values)
    shares = qmc.Sobol(len(names), seed=3).random(count)
    shares = correlate(shares, names, correlations)
    return {
        name: values[name] + spreads[name] * norm.ppf(share)
        for name, share in zip(names, shares.T, strict=True)
    }


@pytest.mark.parametrize("third", [False, True])
def test_a_further_correlated_number_changes_nothing(third):
    """https://github.com/lmfit/uncertainties/issues/95: masses of neutron and proton, and a rate.

    The spread of the difference is u √(2(1 - r)).
    """
    values, spreads = {"p": 1.672621898e-27, "n": 1.674927471e-27}, {"p": 2.1e-35, "n": 2.1e-35}
    correlations = {("p", "n"): 0.9992}
    if third:
        values, spreads = values | {"w": 5.8789238e10}, spreads | {"w": 3.4e3}
        correlations |= {("p", "w"): -0.0004, ("n", "w"): -0.0004}
    found = drawn(dict.fromkeys(values, 0.0), spreads, correlations)
    spread = np.std(found["n"] - found["p"])
    assert spread == pytest.approx(2.1e-35 * np.sqrt(2.0 * (1.0 - 0.9992)), rel=0.02)


def test_errors_in_common_add_up():
    """https://github.com/lmfit/uncertainties/issues/29: 0.2 and 0.4 of one source make 0.6."""
    found = drawn({"y": 10.0, "z": 10.0}, {"y": 0.2, "z": 0.4}, {("y", "z"): 1.0})
    assert np.std(found["y"] + found["z"]) == pytest.approx(0.6, rel=1e-3)
    assert np.std(found["y"] / found["z"]) == pytest.approx(0.02, rel=0.02)


def test_a_square_is_no_product_of_two_draws():
    """https://github.com/eggzec/mcerp/issues/24: x² of a spread √0.1 is 0.1 on average."""
    x = drawn({"x": 1e-6}, {"x": np.sqrt(0.1)}, {})["x"]
    assert np.mean(x**2) == pytest.approx(0.1, rel=0.01)
    assert np.std(x**2) == pytest.approx(np.sqrt(2.0) * 0.1, rel=0.02)


def test_a_number_that_occurs_twice():
    """https://github.com/lmfit/uncertainties/issues/141: 6V/S of the same lengths, by slopes."""
    found = drawn({"l": 8.0, "c": 11.0, "a": 5.0}, {"l": 0.02, "c": 0.002, "a": 0.0015}, {})
    length, c, a = found["l"], found["c"], found["a"]
    diameter = 6.0 * a * length / (2.0 * a + c * length)
    whole = 2.0 * 5.0 + 11.0 * 8.0
    slopes = np.array([12.0 * 25.0, -6.0 * 5.0 * 64.0, 6.0 * 64.0 * 11.0]) / whole**2
    assert np.std(diameter) == pytest.approx(
        np.hypot.reduce(slopes * [0.02, 0.002, 0.0015]), rel=0.01
    )


@pytest.mark.parametrize("scatter", [0.0, 1.0])
def test_a_mean_says_more_than_each(scatter):
    """https://github.com/stcorp/harp/issues/302: the mean of more had a larger uncertainty.

    https://github.com/scipp/scipp/pull/3919: 1/√Σ(1/u²), unless values scatter by more.
    """
    spreads = np.array([0.1, 0.2, 0.1, 0.4])
    values = 5.0 + scatter * np.array([1.0, -1.0, -0.5, 0.5])
    found = weighted_mean([Estimate.normal(*one) for one in zip(values, spreads, strict=True)])
    stated = 1.0 / np.sqrt(np.sum(spreads**-2.0))
    if scatter:
        assert found.uncertainty > np.std(values, ddof=1) / 2.5
    else:
        assert found.value == pytest.approx(5.0, rel=1e-12)
        assert found.uncertainty == pytest.approx(stated, rel=1e-3)


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
