import numpy as np
import pytest
from scipy import stats

import lightflyer as lf
from lightflyer.numerics.correlation import correlation_matrix
from lightflyer.uncertainty.inputs import correlate, correlated_groups

NAMES = ["a", "b", "c", "d"]


def test_groups_are_connected_by_way_of_others():
    correlations = {("c", "a"): 0.5, ("d", "c"): 0.2, ("a", "elsewhere"): 0.9}
    assert correlated_groups(NAMES, correlations) == (("a", "c", "d"), ("b",))
    assert correlated_groups(NAMES, {}) == (("a",), ("b",), ("c",), ("d",))


def test_draws_are_those_of_scipys_multivariate_normal(rng):
    correlations = {("c", "a"): 0.7, ("d", "c"): -0.4}
    shares = correlate(rng.random((200_000, 4)), NAMES, correlations)
    found = np.corrcoef(stats.norm.ppf(shares).T)
    np.testing.assert_allclose(found, correlation_matrix(NAMES, correlations), atol=0.01)
    law = stats.multivariate_normal(cov=correlation_matrix(NAMES, correlations))
    at = np.array([0.3, 0.6, 0.4, 0.8])
    below = np.mean((shares < at).all(axis=1))
    assert below == pytest.approx(law.cdf(stats.norm.ppf(at)), abs=0.005)


@pytest.mark.parametrize("rho", [0.9, -0.5, 1.0, -1.0])
def test_a_pair_is_the_closed_form(rng, rho):
    shares = rng.random((1000, 3))
    found = correlate(shares, ["a", "b", "c"], {("a", "c"): rho})
    z = stats.norm.ppf(shares)
    expected = stats.norm.cdf(rho * z[:, 0] + np.sqrt(1.0 - rho**2) * z[:, 2])
    np.testing.assert_array_equal(found[:, :2], shares[:, :2])
    np.testing.assert_allclose(found[:, 2], expected, rtol=1e-12)


def test_correlations_that_contradict_each_other_are_refused(rng):
    same = {("a", "b"): 1.0, ("b", "c"): 1.0, ("a", "c"): 1.0}
    np.testing.assert_allclose(
        correlate(rng.random((9, 3)), "abc", same).std(axis=1), 0.0, atol=1e-12
    )
    for contradiction in (same | {("a", "c"): 0.5}, dict.fromkeys(same, -0.6)):
        with pytest.raises(lf.ParameterError, match=r"no joint distribution .* a, b, c"):
            correlate(rng.random((9, 4)), NAMES, contradiction)
