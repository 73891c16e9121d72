import sys

import numpy as np
import numpy_model
import pytest
from scipy import stats
from scipy.optimize import least_squares

import lightflyer as lf
from lightflyer.force import PRINTED, REPORTED
from lightflyer.foundation.table import Table
from lightflyer.gas import LU2023_AIR
from lightflyer.lab import tac, tac_problem
from lightflyer.lab.tac_data import TacRun

TRUTH = (0.75, 1.22, 4.09)  # the paper's fit to platinum
DIAMETER = 24e-3


def independent_run(count, noise=0.0, rng=None, reported=False, tac_=TRUTH[0]):
    """A run from the equations of ``numpy_model``, which shares no code with the package."""
    _, ratio, offset = TRUTH
    pressure = np.geomspace(1e-4, 200.0, count)
    heater, ambient = np.full(count, 323.0), np.full(count, 295.0)
    area = np.pi * DIAMETER**2 / 4.0
    gas = numpy_model.lost_power(
        heater, ambient, pressure, DIAMETER / 2.0, tac_, 0.0, reported=reported
    )
    power = ratio * (gas + offset * area * (heater - ambient))
    if rng is not None:
        power = power * (1.0 + noise * rng.normal(size=count))
    table = Table("synthetic", np.arange(count) + 2, {})
    return TacRun(table, pressure, power, heater, ambient)


OPTIONS = {"diameter": DIAMETER, "gas": LU2023_AIR}


@pytest.mark.parametrize("reading", ["printed", "reported"])
def test_recovers_the_truth_without_noise(reading):
    run = independent_run(40, reported=reading == "reported")
    chosen = PRINTED if reading == "printed" else REPORTED
    fit = tac.fit_tac(run, reading=chosen, **OPTIONS)
    # gravity in the Rayleigh number is 9.8 there, the standard's here
    np.testing.assert_allclose([one.value for one in fit.estimates().values()], TRUTH, rtol=2e-4)


def test_equals_plain_scipy(rng):
    fit = tac.fit_tac(independent_run(60, 0.01, rng), **OPTIONS)

    def residuals(parameters):
        alpha, ratio, offset = parameters
        gas = 1.0 / (1.0 / (alpha * fit.free_molecular) + 1.0 / fit.continuum)
        return (ratio * (gas + offset) - fit.conductance) * fit.weight

    plain = least_squares(residuals, (1.0, 1.0, 1.0), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    found = [one.value for one in fit.estimates().values()]
    np.testing.assert_allclose(found, plain.x, rtol=1e-6)
    covariance = np.linalg.inv(plain.jac.T @ plain.jac) * 2.0 * plain.cost / (60 - 3)
    np.testing.assert_allclose(fit.covariance, covariance, rtol=1e-4)
    # an end of a profile interval costs Fisher's point more than the best fit
    for number, end in ((0, fit.tac.interval[0]), (2, fit.offset.interval[1])):
        free = [index for index in range(3) if index != number]

        def held(part, number=number, end=end, free=free):
            whole = np.full(3, end)
            whole[free] = part
            return residuals(whole)

        raised = least_squares(held, plain.x[free], xtol=1e-15, ftol=1e-15, gtol=1e-15).cost
        threshold = stats.f.ppf(0.95, 1, 57) / 57
        assert raised / plain.cost - 1.0 == pytest.approx(threshold, rel=2e-3)


def test_intervals_cover_the_truth(rng):
    count, inside = 200, np.zeros((2, 3))
    clean = independent_run(40)
    for _ in range(count):
        power = clean.power * (1.0 + 0.01 * rng.normal(size=40))
        run = TacRun(clean.table, clean.pressure, power, clean.heater_temperature,
                         clean.ambient_temperature)  # fmt: skip
        fit = tac.fit_tac(run, **OPTIONS)
        for number, (name, truth) in enumerate(zip(tac_problem.PARAMETERS, TRUTH, strict=True)):
            low, high = fit.estimates()[name].interval
            inside[0, number] += low <= truth <= high
            low, high = fit.covariance_intervals[name]
            inside[1, number] += low <= truth <= high
    assert np.all((inside / count >= 0.92) & (inside / count <= 0.98)), inside / count


def test_profile_is_asymmetric_where_the_plateau_is_missing(rng):
    run = independent_run(40, 0.01, rng)
    low = run.pressure < 8.0
    part = TacRun(Table("part", np.arange(low.sum()), {}), run.pressure[low], run.power[low],
                      run.heater_temperature[low], run.ambient_temperature[low])  # fmt: skip
    fit = tac.fit_tac(part, **OPTIONS)
    below, above = fit.tac.value - fit.tac.interval[0], fit.tac.interval[1] - fit.tac.value
    assert max(below, above) > 1.05 * min(below, above)
    low, high = fit.covariance_intervals["tac"]
    assert fit.tac.value - low == pytest.approx(high - fit.tac.value)


def test_radiation_apart_from_the_offset():
    run = independent_run(40)
    whole, apart = tac.fit_tac(run, **OPTIONS), tac.fit_tac(run, emissivity=0.1, **OPTIONS)
    radiated = 2 * 5.670374419e-8 * 0.1 * (323.0**4 - 295.0**4) / (323.0 - 295.0)
    assert apart.tac.value == pytest.approx(whole.tac.value, rel=1e-9)
    assert apart.offset.value == pytest.approx(whole.offset.value - radiated, rel=1e-9)


def test_groups_of_very_many_rows_have_the_profile_of_all(rng, monkeypatch):
    run = independent_run(2000, 0.02, rng)
    whole = tac.fit_tac(run, **OPTIONS)
    monkeypatch.setattr(tac_problem, "_GROUPS", 200)
    grouped = tac.fit_tac(run, **OPTIONS)
    assert grouped.tac.value == pytest.approx(whole.tac.value, rel=1e-7)
    width = whole.tac.interval[1] - whole.tac.interval[0]
    np.testing.assert_allclose(grouped.tac.interval, whole.tac.interval, atol=0.01 * width)


def test_rows_off_the_temperature_are_dropped():
    run = independent_run(40)
    heater = run.heater_temperature.copy()
    heater[:3] -= 5.0
    run = TacRun(run.table, run.pressure, run.power, heater, run.ambient_temperature)
    fit = tac.fit_tac(run, **OPTIONS)
    assert (fit.rows_used, fit.rows_dropped) == (37, 3)
    assert fit.tac.value == pytest.approx(0.75, rel=1e-3)
    with pytest.raises(lf.ConfigurationError, match=r"synthetic:\d+: the heater's temperature"):
        tac.fit_tac(
            TacRun(run.table, run.pressure, run.power, np.linspace(300, 350, 40),
                       run.ambient_temperature), **OPTIONS)  # fmt: skip


def test_constant_pressure_is_refused(rng):
    run = independent_run(20, 0.01, rng)
    flat = TacRun(run.table, np.full(20, 3.0), run.power, run.heater_temperature,
                      run.ambient_temperature)  # fmt: skip
    with pytest.raises(lf.ConfigurationError, match="do not determine"):
        tac.fit_tac(flat, **OPTIONS)


def test_heater_power_inverts():
    pressure = np.geomspace(1e-3, 100.0, 12)
    heater, ambient = np.full(12, 323.0), np.full(12, 295.0)
    power = tac.heater_power(pressure, heater, ambient, *TRUTH)
    fit = tac.fit_tac(TacRun(Table("x", np.arange(12), {}), pressure, power, heater, ambient))
    np.testing.assert_allclose([one.value for one in fit.estimates().values()], TRUTH, rtol=1e-8)


def test_missing_extra_is_named(monkeypatch, rng):
    monkeypatch.setitem(sys.modules, "lmfit", None)
    with pytest.raises(lf.MissingExtraError, match=r"needs lmfit: pip install 'lightflyer\[lab\]'"):
        tac.fit_tac(independent_run(40, 0.01, rng), **OPTIONS)
