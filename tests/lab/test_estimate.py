import numpy as np
import pytest
from scipy import optimize, stats

import lightflyer as lf
from lightflyer.lab.estimate import Estimate, weighted_mean

Z = 1.959964


def by_hand(values, uncertainties):
    """Paule and Mandel's variance from the defining equation, then Hartung and Knapp's interval."""
    values, variances = np.array(values), np.array(uncertainties) ** 2

    def mean_of(between):
        return np.average(values, weights=1.0 / (variances + between))

    def chi_square(between):
        return np.sum((values - mean_of(between)) ** 2 / (variances + between))

    freedom = len(values) - 1
    between = 0.0
    if chi_square(0.0) > freedom:
        between = optimize.bisect(lambda t: chi_square(t) - freedom, 0.0, 100.0, xtol=1e-14)
    error = np.sqrt(1.0 / np.sum(1.0 / (variances + between)))
    factor = stats.t.ppf(0.975, freedom) * np.sqrt(chi_square(between) / freedom)
    return mean_of(between), error * max(factor, Z)


@pytest.mark.parametrize(
    ("values", "uncertainties"),
    [
        ((0.9, 0.8), (0.03, 0.04)),
        ((0.9, 0.8, 0.86), (0.03, 0.04, 0.001)),
        ((0.86, 0.92, 0.75, 0.81, 0.83), (0.03, 0.02, 0.05, 0.04, 0.1)),
        ((1.0, 7.0, -3.0), (1e-6, 1e-6, 1e-6)),
        ((0.8, 0.8001), (0.03, 0.04)),  # agreement by chance is no precision
    ],
)
def test_weighted_mean_as_defined(values, uncertainties):
    found = weighted_mean(
        [Estimate.normal(*one) for one in zip(values, uncertainties, strict=True)]
    )
    mean, half = by_hand(values, uncertainties)
    assert found.value == pytest.approx(mean, rel=1e-7)
    assert found.interval[1] - found.value == pytest.approx(half, rel=1e-6)
    assert found.uncertainty == pytest.approx(half / Z, rel=1e-6)


def test_a_shared_error_does_not_average_out():
    many = [Estimate.normal(0.8, 0.01)] * 100
    assert weighted_mean(many).uncertainty == pytest.approx(0.001)
    assert weighted_mean(many, common=0.02).uncertainty == pytest.approx(np.hypot(0.001, 0.02))
    alone = weighted_mean(many[:1], common=0.02)
    assert alone.uncertainty == pytest.approx(np.hypot(0.01, 0.02))
    assert alone.interval[1] - 0.8 == pytest.approx(Z * np.hypot(0.01, 0.02), rel=1e-6)


def test_estimates_without_uncertainty_have_no_weights():
    for estimates in ([], [Estimate(1.0, (0.0, 2.0)), Estimate.normal(1.0, 0.1)],
                      [Estimate.normal(1.0, 0.0), Estimate.normal(2.0, 0.1)]):  # fmt: skip
        with pytest.raises(lf.ParameterError, match="uncertainties above zero"):
            weighted_mean(estimates)
