import lmfit
import numpy as np
import numpy_model
import pytest
from scipy import stats
from scipy.optimize import least_squares

import lightflyer as lf
from lightflyer.files.table import Table
from lightflyer.gas import AIR, LU2023_AIR
from lightflyer.lab.estimate import student_factor
from lightflyer.lab.result import joint_warnings
from lightflyer.lab.tac import fit as tac
from lightflyer.lab.tac import intervals, preparation
from lightflyer.lab.tac import problem as tac_problem
from lightflyer.lab.tac.data import EXACT, TacAccuracy, TacRun, unstated_accuracies
from lightflyer.lab.tac.fit import TacRuns
from lightflyer.lab.tac.preparation import Bench, make_problem, misfit_warnings, rows_off_the_curve
from lightflyer.lab.tac.problem import HEAT_LAWS, KINETIC_LAW, KineticLaw

TRUTH = (0.75, 1.22, 4.09)  # the paper's fit to platinum
DIAMETER = 24e-3
OPTIONS = {"diameter": DIAMETER, "gas": LU2023_AIR, "law": HEAT_LAWS["printed"]}


def run_of(pressure, power, heater=323.0, ambient=295.0):
    """A run at constant temperatures."""
    count = len(pressure)
    table = Table("synthetic", np.arange(count) + 2, {})
    return TacRun(table, pressure, power, np.full(count, heater), np.full(count, ambient))


def independent_run(count, noise=0.0, rng=None, reported=False, lowest=1e-4, highest=200.0):
    """A run from the equations of ``numpy_model``, which shares no code with the package."""
    alpha, ratio, offset = TRUTH
    pressure = np.geomspace(lowest, highest, count)
    heater, ambient = np.full(count, 323.0), np.full(count, 295.0)
    area = np.pi * DIAMETER**2 / 4.0
    gas = numpy_model.lost_power(
        heater, ambient, pressure, DIAMETER / 2.0, alpha, 0.0, reported=reported
    )
    power = ratio * (gas + offset * area * (heater - ambient))
    if rng is not None:
        power = power * (1.0 + noise * rng.normal(size=count))
    return run_of(pressure, power)


@pytest.fixture(autouse=True)
def one_law(request, monkeypatch):
    """Coefficients by other laws are asked for by a fixture only: they take longest."""
    if "other_laws" not in request.fixturenames:
        monkeypatch.setattr(preparation, "HEAT_LAWS", {})


@pytest.fixture
def other_laws():
    """Coefficients by other laws are fitted too."""


@pytest.fixture
def exact_law(monkeypatch):
    """No error of the law's shape."""
    monkeypatch.setattr(intervals, "LAW_ERROR", 0.0)


def values_of(fit):
    return [one.value for one in fit.estimates().values()]


@pytest.mark.parametrize("accuracy", [EXACT, TacAccuracy()])
@pytest.mark.parametrize("reading", ["printed", "reported"])
def test_recovers_the_truth_without_noise(reading, accuracy):
    run = independent_run(40, reported=reading == "reported")
    law = HEAT_LAWS[reading]
    fit = tac.fit_tac(run, diameter=DIAMETER, gas=LU2023_AIR, law=law, accuracy=accuracy)
    # gravity in the Rayleigh number is 9.8 there, the standard's here
    np.testing.assert_allclose(values_of(fit), TRUTH, rtol=5e-4)


def test_kinetic_law_is_the_kinetic_model():
    pressure = np.geomspace(1e-3, 9.0, 40)
    heater, ambient = np.full(40, 323.0), np.full(40, 295.0)
    limits = KINETIC_LAW.limits(pressure, ambient, heater, DIAMETER, AIR)
    for alpha in (0.6, 0.75, 1.0):
        film = lf.FilmProperties(1.0, 0.5, 0.5, 0.5, tac_top=alpha, tac_bottom=alpha)
        state = lf.Chamber(temperature=295.0).state(pressure)
        model = lf.Kinetic(wall="maxwell")
        (lost,) = model.heat_loss(lf.Disk(film, DIAMETER / 2), state, (28.0 / 295.0,))
        found = limits.conductance(alpha) * 0.25 * np.pi * DIAMETER**2 * 28.0
        np.testing.assert_allclose(found, lost, rtol=1e-4)  # a parabola in the TAC


def test_kinetic_law_ends_in_conduction():
    """8rκΔT of an isothermal disk, both faces, with the standard atmosphere's conductivity."""
    pressure = np.full(1, 2000.0)
    limits = KINETIC_LAW.limits(pressure, np.full(1, 295.0), np.full(1, 323.0), DIAMETER, AIR)
    mean = 309.0
    conductivity = 2.64638e-3 * mean**1.5 / (mean + 245.4 * 10.0 ** (-12.0 / mean))
    conducted = 8.0 * (DIAMETER / 2) * conductivity / (0.25 * np.pi * DIAMETER**2)
    assert limits.continuum(0.8)[0] == pytest.approx(conducted, rel=0.01)


def test_walls_take_more_heat_in_dense_gas_only():
    pressure = np.array([1e-4, 1e-2, 10.0])
    same = (pressure, np.full(3, 295.0), np.full(3, 323.0), DIAMETER, AIR)
    opened, closed = (law.limits(*same) for law in (KINETIC_LAW, KineticLaw(5.0 * DIAMETER)))
    ratio = closed.conductance(0.8) / opened.conductance(0.8)
    np.testing.assert_allclose(ratio[:2], 1.0, rtol=1e-3)
    assert 1.02 < ratio[2] < 1.1
    assert np.all(closed.continuum(0.8) < 2.0 * opened.continuum(0.8))


def test_equals_plain_scipy(rng):
    fit = tac.fit_tac(independent_run(60, 0.01, rng), accuracy=EXACT, **OPTIONS)

    def residuals(parameters):
        alpha, ratio, offset = parameters
        gas = 1.0 / (
            1.0 / (alpha * fit.limits.free_molecular) + 1.0 / fit.limits.continuum(fit.tac.value)
        )
        return (ratio * (gas + offset) - fit.conductance) * fit.weight

    plain = least_squares(residuals, (1.0, 1.0, 1.0), xtol=1e-15, ftol=1e-15, gtol=1e-15)
    np.testing.assert_allclose(values_of(fit), plain.x, rtol=1e-6)
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


ACCURACY = TacAccuracy(
    gauge=0.05, gauge_zero=0.02, power=0.01, temperature=1.0, diameter=2e-4, plateau=0.04
)


def test_total_intervals_equal_lmfit_with_common_errors_as_parameters(exact_law, rng):
    """The whole problem written out here and handed to lmfit, its profiles included."""
    fit = tac.fit_tac(independent_run(30, 0.02, rng), accuracy=ACCURACY, **OPTIONS)
    limits, pressure = fit.limits, fit.pressure
    # 0.05 % of the law itself, the same within each of the run's decades of pressure
    row_error = np.hypot(fit.scatter, 5e-4 * np.sqrt(30 / np.log10(200.0 / 1e-4)))
    common = ("gauge", "zero", "power", "temperature", "diameter", "plateau")

    def residuals(given):
        one = {name: value - (name in common) for name, value in given.valuesdict().items()}
        read = np.exp(0.05 * one["gauge"])
        thin = one["tac"] * limits.free_molecular * (read + 0.02 * one["zero"] / pressure)
        wider = 2e-4 / DIAMETER * one["diameter"]
        dense = limits.continuum(0.8) * np.exp(
            limits.slope * 0.05 * one["gauge"] + 0.04 * one["plateau"] - wider
        )
        amplitude = np.exp(0.01 * one["power"] + one["temperature"] / 28.0 + 2.0 * wider)
        model = one["ratio"] * amplitude * (1.0 / (1.0 / thin + 1.0 / dense) + one["offset"])
        rows = (model - fit.conductance) * fit.weight / row_error
        return np.concatenate([rows, list(one.values())[3:]])

    # about one, not zero, for the sake of lmfit's finite differences
    start = lmfit.create_params(tac=0.8, ratio=1.2, offset=4.0, **dict.fromkeys(common, 1.0))
    minimizer = lmfit.Minimizer(residuals, start, scale_covar=False)
    found = minimizer.leastsq()
    np.testing.assert_allclose(
        values_of(fit), [found.params[name].value for name in ("tac", "ratio", "offset")], rtol=2e-4
    )
    np.testing.assert_allclose(fit.covariance, found.covar[:3, :3], rtol=3e-3)
    share = fit.statistical["tac"].uncertainty / fit.tac.uncertainty
    sigma = student_factor(27 / share**4)

    def probability(best, other):
        return stats.norm.cdf(np.sqrt(max(other.chisqr - best.chisqr, 0.0)) / sigma)

    wanted = stats.norm.cdf(1.0)
    ends = lmfit.conf_interval(
        minimizer, found, p_names=["tac"], sigmas=[wanted], prob_func=probability
    )["tac"]
    np.testing.assert_allclose(fit.tac.interval, (ends[0][1], ends[-1][1]), rtol=2e-3)


def test_errors_that_are_held_do_what_those_that_are_fitted_do():
    problem = make_problem(independent_run(12), np.ones(12, bool), Bench(**OPTIONS))
    common = {name: 0.3 + place for place, name in enumerate(problem.errors)}
    whole = problem.residuals([*TRUTH, *common.values()])[:12]
    np.testing.assert_allclose(problem.held(common).residuals(TRUTH), whole, rtol=1e-9)


def test_many_rows_do_not_measure_the_gauge(rng):
    """The curve's shape tells the gauge's error only as well as the law's shape is known."""
    fit = tac.fit_tac(independent_run(12_000, 0.01, rng), **OPTIONS)
    assert fit.statistical["tac"].uncertainty < 0.002
    assert fit.tac.uncertainty > 0.06 * fit.tac.value


def shifted(run, pressure=1.0, zero=0.0, power=1.0):
    """The run as other instruments would have read it."""
    return TacRun(
        run.table, run.pressure * pressure + zero, run.power * power, run.heater_temperature,
        run.ambient_temperature,
    )  # fmt: skip


def test_gauge_error_is_within_the_interval(rng):
    run = shifted(independent_run(60, 0.01, rng), pressure=1.09)
    assert not _covers(tac.fit_tac(run, accuracy=EXACT, **OPTIONS).tac, TRUTH[0])
    total = tac.fit_tac(run, accuracy=TacAccuracy(), **OPTIONS)
    assert _covers(total.tac, TRUTH[0])
    assert not _covers(total.statistical["tac"], TRUTH[0])


def _covers(estimate, truth):
    low, high = estimate.interval
    return low <= truth <= high


def test_only_the_slope_is_free_of_the_plateau(exact_law, rng):
    """α and δ are told apart by the plateau alone: its error is theirs, not their product's."""
    run = independent_run(60, 0.005, rng)
    sure, unsure = (
        tac.fit_tac(run, accuracy=TacAccuracy(0.0, 0.0, 0.0, 0.0, 0.0, plateau), **OPTIONS)
        for plateau in (0.0, 0.2)
    )
    assert sure.tac.uncertainty < 0.02 < 0.12 < unsure.tac.uncertainty
    assert unsure.slope.uncertainty < 1.3 * sure.slope.uncertainty
    assert unsure.correlation[0, 1] < -0.95
    low, high = unsure.slope.interval
    assert low < TRUTH[0] * TRUTH[1] < high


def test_profile_is_asymmetric_where_the_plateau_is_missing(rng):
    run = independent_run(40, 0.01, rng, highest=8.0)
    fit = tac.fit_tac(run, accuracy=EXACT, **OPTIONS)
    below, above = fit.tac.value - fit.tac.interval[0], fit.tac.interval[1] - fit.tac.value
    assert max(below, above) > 1.05 * min(below, above)
    low, high = fit.covariance_intervals["tac"]
    assert fit.tac.value / low == pytest.approx(high / fit.tac.value)


def test_radiation_apart_from_the_offset():
    run = independent_run(40)
    whole, apart = tac.fit_tac(run, **OPTIONS), tac.fit_tac(run, emissivity=0.1, **OPTIONS)
    radiated = 2 * 5.670374419e-8 * 0.1 * (323.0**4 - 295.0**4) / (323.0 - 295.0)
    assert apart.tac.value == pytest.approx(whole.tac.value, rel=1e-9)
    assert apart.offset.value == pytest.approx(whole.offset.value - radiated, rel=1e-7)


def test_groups_of_very_many_rows_have_the_profile_of_all(rng, monkeypatch):
    run = independent_run(2000, 0.02, rng)
    whole = tac.fit_tac(run, **OPTIONS)
    monkeypatch.setattr(tac_problem, "_GROUPS", 200)
    grouped = tac.fit_tac(run, **OPTIONS)
    for one, other in ((whole.tac, grouped.tac), *zip(
        whole.statistical.values(), grouped.statistical.values(), strict=True
    )):  # fmt: skip
        width = one.interval[1] - one.interval[0]
        assert other.value == pytest.approx(one.value, abs=0.02 * width)
        np.testing.assert_allclose(other.interval, one.interval, atol=0.03 * width)


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


@pytest.mark.parametrize("factor", [101.0, 0.01, 1.3])
@pytest.mark.parametrize("count", [12, 60])
def test_rows_off_the_curve_are_left_out_and_named(rng, factor, count):
    clean = independent_run(count, 0.01, rng)
    power = clean.power.copy()
    power[5] *= factor
    fit = tac.fit_tac(shifted(clean, power=power / clean.power), **OPTIONS)
    assert fit.lines_off_curve == [7]
    assert fit.warnings[0] == "synthetic:7: left out, off the curve of all other rows"
    assert fit.rows_used == count - 1
    without = np.delete(np.arange(count), 5)
    again = tac.fit_tac(run_of(clean.pressure[without], clean.power[without]), **OPTIONS)
    assert fit.tac.value == pytest.approx(again.tac.value, rel=1e-6)


def test_no_row_of_a_good_run_is_off_the_curve(rng):
    bench = Bench(**OPTIONS)
    for noise in 3 * (0.0, 0.01, 0.05):
        run = independent_run(30, noise, rng)
        problem = make_problem(run, np.ones(30, bool), bench)
        assert not rows_off_the_curve(problem, run.table.lines).any()


def test_few_scattered_rows_are_not_called_off_the_curve(rng):
    """Some of so few rows are far off in units of their median deviation, by chance."""
    bench = Bench(**OPTIONS)
    for _ in range(60):
        run = independent_run(8, 0.05, rng, lowest=0.1)
        problem = make_problem(run, np.ones(8, bool), bench)
        assert not rows_off_the_curve(problem, run.table.lines).any()


def test_many_wild_rows_are_refused(rng):
    run = independent_run(30, 0.01, rng)
    wild = np.where(np.arange(30) % 3 == 0, 1e3 * rng.random(30), 1.0)
    with pytest.raises(lf.ConfigurationError, match=r"synthetic:\d+: \d+ of 30 rows, this one"):
        tac.fit_tac(shifted(run, power=wild), **OPTIONS)


@pytest.mark.parametrize(
    ("temperatures", "change", "options", "says"),
    [
        ((50.0, 20.0), {}, {}, r"synthetic:2: heater_temperature = 50 K is not between 80 and 15"),
        ((596.0, 568.0), {}, {}, r"synthetic:2: ambient_temperature = 568 K is not between 80 and"),
        ((), {"power": 1e3}, {}, r"synthetic: area ratio \d+ is impossible"),
        ((), {"power": 1e-3}, {}, r"synthetic: area ratio 0\.00\d+ is impossible"),
        ((), {"pressure": 0.2}, {}, r"coefficient 3.* is impossible"),
        ((), {}, {"emissivity": 1.0}, r"offset -.* is impossible"),
    ],
)
def test_impossible_runs_are_refused(temperatures, change, options, says):
    run = independent_run(40)
    run = shifted(run_of(run.pressure, run.power, *temperatures), **change)
    with pytest.raises(lf.ConfigurationError, match=says):
        tac.fit_tac(run, **OPTIONS, **options)


@pytest.mark.parametrize(
    ("ambient", "pressure", "says"),
    [
        (267.6, 1.0, "ambient_temperature 267.6 K is un"),  # 22 °F taken for 22 °C
        (295.0, 0.7, "above 1, which no surface has, but 1 is within"),
        (295.0, 0.5, "above 1, beyond its uncertainty"),
        (295.0, 133.3, "technical surfaces in air"),  # Torr taken for Pa
        (295.0, 1.0, ""),
    ],
)
def test_what_is_unlikely_is_said(rng, ambient, pressure, says):
    run = independent_run(60, 0.005, rng)
    run = shifted(run_of(run.pressure, run.power, 323.0, ambient), pressure=pressure)
    found = [one for one in tac.fit_tac(run, **OPTIONS).warnings if says in one]
    assert bool(found) == bool(says)


def test_scatter_that_leaves_a_coefficient_undetermined(rng):
    fit = tac.fit_tac(independent_run(8, 0.2, rng, lowest=0.1), **OPTIONS)
    assert "scatter by 0." in fit.undetermined


def test_narrow_range_is_cut_and_says_what_would_determine(rng):
    narrow = tac.fit_tac(independent_run(20, 0.02, rng, lowest=1.0, highest=2.5), **OPTIONS)
    low, high = narrow.tac.interval
    assert 0.0 <= low < high <= 2.0
    assert narrow.undetermined in narrow.warnings
    assert any("bound it to what is possible, 0 to 2" in text for text in narrow.warnings)
    words = narrow.undetermined.split()
    first, last = (float(words[words.index("from") + step]) for step in (1, 3))
    wide = tac.fit_tac(independent_run(20, 0.02, rng, lowest=first, highest=last), **OPTIONS)
    assert wide.undetermined is None
    assert not any("cut" in text for text in wide.warnings)


@pytest.mark.usefixtures("other_laws")
def test_other_readings_are_told():
    fit = tac.fit_tac(independent_run(40), **OPTIONS)
    assert fit.reading == "printed"
    assert fit.by_reading["reported"] == pytest.approx(2.0 * 0.75, rel=0.1)
    own = tac.fit_tac(independent_run(40), diameter=DIAMETER, gas=LU2023_AIR)
    assert fit.by_reading["kinetic"] == pytest.approx(own.tac.value, rel=1e-6)
    assert any("the reading printed gives a coefficient +" in text for text in fit.warnings)
    assert not any("reading" in text for text in own.warnings)


@pytest.mark.usefixtures("other_laws")
def test_mean_of_runs_keeps_what_they_have_in_common(rng):
    fits = [tac.fit_tac(independent_run(60, 0.01, rng), **OPTIONS) for _ in range(4)]
    common = np.sqrt(fits[0].tac.uncertainty ** 2 - fits[0].statistical["tac"].uncertainty ** 2)
    mean = TacRuns(fits).mean()
    assert mean.uncertainty > 0.95 * common
    assert mean.uncertainty < 1.15 * fits[0].tac.uncertainty
    assert TacRuns(fits).summary()["warnings"][0].startswith("synthetic: the reading printed")


def test_constant_pressure_is_refused(rng):
    run = independent_run(20, 0.01, rng)
    with pytest.raises(lf.ConfigurationError, match="do not determine"):
        tac.fit_tac(run_of(np.full(20, 3.0), np.mean(run.power) + 1e-3 * rng.random(20)), **OPTIONS)


def test_the_power_of_the_law_gives_its_coefficients():
    pressure = np.geomspace(1e-3, 100.0, 12)
    heater, ambient = np.full(12, 323.0), np.full(12, 295.0)
    alpha, ratio, offset = TRUTH
    limits = KINETIC_LAW.limits(pressure, ambient, heater, DIAMETER, AIR)
    power = 28.0 * ratio * (limits.conductance(alpha) + offset) * np.pi * DIAMETER**2 / 4.0
    fit = tac.fit_tac(run_of(pressure, power), accuracy=EXACT)
    np.testing.assert_allclose(values_of(fit), TRUTH, rtol=1e-8)


def test_impossible_accuracy_is_refused():
    with pytest.raises(lf.ParameterError, match="gauge = 5 is not between 0 and 1"):
        TacAccuracy(gauge=5.0)
    with pytest.raises(lf.ParameterError, match="temperature"):
        TacAccuracy(temperature=-1.0)


def sherman_run(count, rng, noise=0.01):
    """A run by the mean of both resistances, free-molecular and continuum, as Sherman has it."""
    pressure, per_mole = np.geomspace(1e-3, 100.0, count), 8.314462618 / 0.0289652
    alpha, ratio, offset = TRUTH
    thin = alpha * 6.0 * np.sqrt(per_mole / (2.0 * np.pi * 295.0)) * pressure  # both faces
    dense = 8.0 * 0.02655 / (np.pi * 0.5 * DIAMETER)
    conductance = ratio * (thin * dense / (thin + dense) + offset)
    power = conductance * np.pi * DIAMETER**2 / 4.0 * (323.0 - 295.0)
    return run_of(pressure, power * (1.0 + noise * rng.normal(size=count)))


def test_another_law_is_said_and_more_rows_do_not_narrow_the_interval(rng):
    fits = [tac.fit_tac(sherman_run(count, rng), diameter=DIAMETER) for count in (1_000, 10_000)]
    few, many = (fit.tac.interval for fit in fits)
    for fit in fits:
        assert fit.tac.interval[0] < TRUTH[0] < fit.tac.interval[1]
        assert any("the law does not fit them" in text for text in fit.warnings)
        assert max(map(abs, fit.common_errors.values())) < 1.0
    assert many[1] - many[0] > 0.9 * (few[1] - few[0])


def test_intervals_of_another_law_are_alike_by_profile_and_by_covariance(rng):
    fit = tac.fit_tac(sherman_run(4_000, rng, 0.002), diameter=DIAMETER, accuracy=EXACT)
    assert fit.alike > 4.0
    for row, name in enumerate(("area_ratio", "offset"), 1):
        by_covariance, whole = fit.covariance_intervals[name], fit.estimates()[name].interval
        assert np.ptp(by_covariance) == pytest.approx(np.ptp(whole), rel=0.1)
        spread = np.sqrt(fit.covariance[row, row])
        assert 2.0 * 1.96 * spread == pytest.approx(np.ptp(whole), rel=0.1)


@pytest.mark.parametrize("decades", [0.35, 0.5, 0.7])
def test_a_law_that_is_off_by_a_bend_is_as_uncertain_over_less_than_a_decade(decades, rng):
    """Over a shorter range the bend of its error shrinks as that by which the coefficient tells."""
    spreads = []
    for width in (1.0, decades):
        pressure = 2.5 * 10.0 ** np.linspace(-0.5 * width, 0.5 * width, 60)
        same = np.full(60, 323.0), np.full(60, 295.0)
        power = tac.heater_power(pressure, *same, *TRUTH) * (1.0 + 1e-5 * rng.normal(size=60))
        exact = TacAccuracy(1e-4, 1e-6, 1e-5, 1e-4, 1e-8, 1e-4)
        spreads.append(tac.fit_tac(run_of(pressure, power), accuracy=exact).tac.uncertainty)
    assert spreads[1] == pytest.approx(spreads[0], rel=0.2)


def test_an_instrument_that_is_off_by_more_than_stated_is_said():
    values = {"tac": 2.5, "gauge": -0.4, "plateau": 2.71}
    (text,) = misfit_warnings(1.0, 60, values)
    assert text.startswith("the fit wants errors of plateau +2.7 stated standard uncertainties")


def test_unstated_accuracies_in_words():
    stated = ["gauge", "gauge_zero", "power", "diameter", "plateau"]
    said = unstated_accuracies(stated)
    assert said == ["no accuracy of the temperature difference is stated; ± 1 K is assumed"]


def test_a_warning_of_all_files_is_said_once():
    found = [("a.csv", ["no accuracy"]), ("b.csv", ["no accuracy", "skewed"])]
    assert joint_warnings(found) == ["b.csv: skewed", "no accuracy"]
