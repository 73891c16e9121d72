from itertools import permutations

import numpy as np
import pytest

from lightflyer.numerics.residuals import LEAST_PROBABILITY, alike_points, runs_probability


@pytest.mark.parametrize(("above", "below"), [(3, 4), (2, 6), (4, 4)])
def test_probability_of_runs_is_that_of_all_orders(above, below):
    orders = [np.array(one) for one in set(permutations([1.0] * above + [-1.0] * below))]
    counts = np.array([1 + np.sum(one[1:] != one[:-1]) for one in orders])
    for one, count in zip(orders, counts, strict=True):
        assert runs_probability(one) == pytest.approx(np.mean(counts <= count))


def test_residuals_of_one_sign_tell_nothing():
    assert runs_probability(np.ones(9)) == 1.0


@pytest.mark.parametrize("count", [14, 60, 3000])
def test_independent_residuals_are_rarely_called_alike(rng, count):
    called = [alike_points(rng.normal(size=count)) > 1.0 for _ in range(400)]
    assert np.mean(called) < 3.0 * LEAST_PROBABILITY


@pytest.mark.parametrize("count", [300, 30_000])
def test_an_arc_counts_as_few_points_however_many_there_are(rng, count):
    arc = 0.5 * np.sin(np.linspace(0.0, 3.0 * np.pi, count))
    independent = count / alike_points(arc + rng.normal(size=count))
    assert 5.0 < independent < 120.0


def test_the_mean_of_averages_scatters_as_many_alike_points_say(rng):
    window = 12
    white = rng.normal(size=(200, 2400 + window - 1))
    sums = np.cumsum(np.pad(white, ((0, 0), (1, 0))), axis=1)
    averaged = (sums[:, window:] - sums[:, :-window]) / window
    found = np.median([alike_points(one) for one in averaged])
    assert found == pytest.approx(2400 * averaged.mean(axis=1).var() / averaged.var(), rel=0.5)
