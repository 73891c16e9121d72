import importlib

import numpy as np
import pytest

import lightflyer as lf

# the package's name "calibrate" is the function
module = importlib.import_module("lightflyer.calibration.calibration")

TRUTH = np.array([0.4, 3.0])
PRESSURE = np.tile(np.geomspace(1.5, 25.0, 7), 2)
DIAMETER = np.repeat([0.02, 0.03], 7)
SAMPLES = ["synthetic 2 cm"] * 7 + ["synthetic 3 cm"] * 7


@pytest.fixture
def setup():
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    return lf.Setup(lf.Disk(film, 0.01), lf.Chamber(), lf.Lu2023(0.5, 2.0), (None, None))


@pytest.fixture
def exact(setup):
    """Irradiance to levitate with the true coefficients; synthetic, like all data here."""
    disk = lf.Disk(setup.flyer.film, 0.5 * DIAMETER)
    return lf.levitate(disk, setup.environment.state(PRESSURE), lf.Lu2023(*TRUTH)).irradiance


def points(irradiance, **more):
    numbers = {"pressure": PRESSURE, "irradiance": irradiance, "diameter": DIAMETER, **more}
    return lf.Points("synthetic.csv", SAMPLES, numbers)


def test_recovers_what_exact_points_were_made_with(setup, exact):
    fit = lf.calibrate(points(exact), setup)
    assert fit.names == ["c_fm", "c_cont"]
    assert fit.values == pytest.approx(TRUTH, rel=1e-7)
    assert np.abs(fit.residuals).max() < 1e-7


def test_frees_film_properties_of_one_sample(setup, exact):
    hotter = exact.copy()
    one = np.array(SAMPLES) == "synthetic 2 cm"
    film = lf.FilmProperties(1e-3, 0.75, 0.12, 0.12, tac_top=0.8, tac_bottom=0.9)
    state = setup.environment.state(PRESSURE[one])
    hotter[one] = lf.levitate(lf.Disk(film, 0.01), state, lf.Lu2023(*TRUTH)).irradiance
    fit = lf.calibrate(points(hotter), setup, ["c_fm", "c_cont", "emittance[synthetic 2 cm]"])
    assert fit.values == pytest.approx([*TRUTH, 0.12], rel=1e-6)


def test_stated_uncertainties_set_covariance_and_intervals(setup, exact, rng_seeded):
    noisy = exact * np.exp(0.04 * rng_seeded.standard_normal(exact.size))
    single = lf.calibrate(points(noisy, irradiance_uncertainty=0.04 * noisy), setup)
    double = lf.calibrate(points(noisy, irradiance_uncertainty=0.08 * noisy), setup)
    assert not single.estimated_scatter
    assert double.values == pytest.approx(single.values, rel=1e-6)
    assert double.covariance == pytest.approx(4.0 * single.covariance, rel=1e-4)
    # close to linear, so profile intervals are about 1.96 standard uncertainties each way
    half = 0.5 * (single.intervals[:, 1] - single.intervals[:, 0])
    assert half == pytest.approx(1.96 * single.standard_uncertainties, rel=0.02)
    assert np.all(single.intervals[:, 0] < single.values)


def test_uncertain_pressure_counts_by_the_slope_of_the_curve(setup, exact):
    data = points(exact, pressure_uncertainty=0.05 * PRESSURE, irradiance_uncertainty=0.01 * exact)
    fit = lf.calibrate(data, setup)
    steep, flat = fit.uncertainty.max(), fit.uncertainty.min()
    assert flat >= 0.01
    assert steep > 3.0 * flat


def test_intervals_end_where_the_profile_says(setup, exact, rng_seeded):
    noisy = exact * np.exp(0.05 * rng_seeded.standard_normal(exact.size))
    data = points(noisy)
    fit = lf.calibrate(data, setup)
    problem, _, start, bounds = module._set_up(data, setup, module.DEFAULT_FREE)
    search = module._Fit(problem, np.log(noisy), bounds)
    best, cost = search.solve(start)
    limit = cost + module._threshold(cost / 12, 12, estimated=True)
    for end in fit.intervals[0]:
        assert search.solve(best, 0, np.log(end))[1] == pytest.approx(limit, rel=1e-3)


def test_intervals_cover_the_truth_as_often_as_they_claim(setup, exact):
    """A profile interval holds the truth exactly where its cost there is below the limit."""
    generator = np.random.default_rng(2023)
    held = np.zeros(2)
    experiments = 200
    problem, _, start, bounds = module._set_up(points(exact), setup, module.DEFAULT_FREE)
    for _ in range(experiments):
        noise = 0.05 * generator.standard_normal(exact.size)
        search = module._Fit(problem, np.log(exact) + noise, bounds)
        best, cost = search.solve(start)
        freedom = exact.size - 2
        limit = cost + module._threshold(cost / freedom, freedom, estimated=True)
        for number in range(2):
            held[number] += search.solve(best, number, np.log(TRUTH[number]))[1] <= limit
    share = held / experiments
    assert np.all((share >= 0.92) & (share <= 0.98)), share


def test_jacobian_is_that_of_finite_differences(setup, exact):
    names = [*module.FITTABLE]
    problem, _, start, _ = module._set_up(points(exact), setup, names)
    _, jacobian, slope = module._log_irradiance(start, problem)
    for number in range(len(names)):
        step = np.where(np.arange(len(names)) == number, 1e-5, 0.0)
        above = module._log_irradiance(start + step, problem)[0]
        below = module._log_irradiance(start - step, problem)[0]
        assert jacobian[:, number] == pytest.approx((above - below) / 2e-5, rel=1e-5, abs=1e-7)
    assert slope[0] < 0.0 < slope[6]


@pytest.mark.parametrize(
    ("free", "says"),
    [
        (["c_fn"], '"c_fn" cannot be fitted'),
        ([], "nothing is free"),
        (["c_fm", "c_fm"], "fitted twice"),
        (["c_fm", "c_fm[synthetic 2 cm]"], "fitted twice"),
        (["emittance[gold]"], 'no sample "gold"'),
        (["c_fm", "c_cont", "tac_top", "tac_bottom"], "cannot tell"),
    ],
)
def test_clear_errors(setup, exact, free, says):
    with pytest.raises(lf.ParameterError, match=says.replace("[", r"\[")):
        lf.calibrate(points(exact), setup, free)


def test_fewer_points_than_parameters(setup, exact):
    few = lf.Points("few.csv", SAMPLES[:2], {"pressure": PRESSURE[:2], "irradiance": exact[:2]})
    with pytest.raises(lf.ParameterError, match=r"few.csv: 2 points cannot fix 2 parameters"):
        lf.calibrate(few, setup)


def test_points_out_of_reach(setup, exact):
    thin = lf.Points("thin.csv", ["a"] * 4, {"pressure": np.full(4, 0.05), "irradiance": exact[:4]})
    with pytest.raises(lf.ParameterError, match="no irradiance levitates a"):
        lf.calibrate(thin, setup)


@pytest.fixture
def rng_seeded():
    return np.random.default_rng(7)
