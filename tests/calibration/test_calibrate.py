"""Calibration, against finite differences of the model, SciPy's minimiser and known truths."""

from importlib import resources
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
import pytest
from scipy import stats
from scipy.optimize import minimize_scalar

import lightflyer as lf
from lightflyer.calibration import Points
from lightflyer.foundation.quantity import Coefficient, Length

TRUTH = np.array([0.4, 3.0])
PRESSURE = np.tile(np.geomspace(1.5, 25.0, 7), 2)
DIAMETER = np.repeat([0.02, 0.03], 7)
SAMPLES = ["synthetic 2 cm"] * 7 + ["synthetic 3 cm"] * 7
CHAMBER = lf.Chamber()
FIELDS = {"c_fm": 0.5, "c_cont": 2.0, "tac_top": 0.8, "tac_bottom": 0.9, "absorptance": 0.75}


def log_light(c_fm=0.4, c_cont=3.0, pressure=PRESSURE, diameter=DIAMETER, **film):
    """Log-irradiance to levitate of samples; synthetic, like all data here."""
    numbers = {"emittance": 0.08, "absorptance": 0.75, "tac_top": 0.8, "tac_bottom": 0.9} | film
    emittance = numbers.pop("emittance")
    film = lf.FilmProperties(1e-3, emittance_top=emittance, emittance_bottom=emittance, **numbers)
    state, model = CHAMBER.state(pressure), lf.Lu2023(c_fm, c_cont)
    return np.log(lf.levitate(lf.Disk(film, 0.5 * diameter), state, model).irradiance)


@pytest.fixture(scope="module")
def setup():
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    return lf.Setup(lf.Disk(film, 0.01), CHAMBER, lf.Lu2023(0.5, 2.0))


@pytest.fixture(scope="module")
def exact():
    return np.exp(log_light(*TRUTH))


@pytest.fixture(scope="module")
def noisy(exact):
    return exact * np.exp(0.05 * np.random.default_rng(7).standard_normal(exact.size))


def points(irradiance, **more):
    numbers = {"pressure": PRESSURE, "irradiance": irradiance, "diameter": DIAMETER, **more}
    return Points("synthetic.csv", SAMPLES, numbers)


def test_recovers_what_exact_points_were_made_with(setup, exact):
    fit = lf.calibrate(points(exact), setup)
    assert fit.names == ["c_fm", "c_cont"]
    assert fit.values == pytest.approx(TRUTH, rel=1e-7)
    assert np.abs(fit.residuals).max() < 1e-7
    assert fit.setup.model.c_cont == fit.values[1]
    assert fit.setup.flyer == setup.flyer


def test_fits_film_properties_of_one_sample(setup, exact):
    one = np.array(SAMPLES) == "synthetic 2 cm"
    hotter = np.where(one, np.exp(log_light(*TRUTH, emittance=0.12)), exact)
    fit = lf.calibrate(points(hotter), setup, free=["c_fm", "c_cont", "emittance[synthetic 2 cm]"])
    assert fit.values == pytest.approx([*TRUTH, 0.12], rel=1e-6)
    # what belongs to one sample alone is not the setup's
    assert fit.setup.flyer.film.emittance_top == 0.08


@pytest.mark.parametrize(
    "what",
    ["setup", "objects", "file", "path", "design"],
)
def test_takes_whatever_makes_a_design(what, setup, noisy):
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as path:
        file = lf.read_flyer_file(path)
        design = {
            "setup": (setup,),
            "objects": (setup.flyer, setup.environment, setup.model),
            "file": (file,),
            "path": (path,),
            "design": (lf.flight.ObjectDesign(setup),),
        }[what]
        fit = lf.calibrate(points(noisy), *design, free=["c_fm", "emittance"])
    # the file's coefficients are the paper's
    c_cont = 3.0 if what in ("file", "path") else 2.0
    residuals = np.log(noisy) - log_light(fit.values[0], c_cont, emittance=fit.values[1])
    assert fit.residuals == pytest.approx(residuals, abs=1e-9)


def derivatives(free, values):
    """Derivatives of log-irradiance by log-parameters, by finite differences of the model."""
    columns = []
    for name in free:
        step = 1e-4
        above, below = (
            log_light(**values | {name: values[name] * np.exp(sign * step)}) for sign in (1, -1)
        )
        columns.append((above - below) / (2 * step))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize(
    "free",
    [
        ("c_fm", "c_cont"),
        ("tac_top", "emittance", "absorptance"),
        ("tac_bottom", "emittance"),
    ],
)
def test_covariance_is_that_of_finite_differences(setup, noisy, free):
    fit = lf.calibrate(points(noisy), setup, free=free)
    fitted = dict(zip(free, fit.values, strict=True))
    jacobian = derivatives(free, FIELDS | {"emittance": 0.08} | fitted)
    # least squares: the residuals are orthogonal to all derivatives
    assert np.abs(jacobian.T @ fit.residuals).max() < 1e-5
    variance = np.sum(fit.residuals**2) / (len(SAMPLES) - len(free))
    covariance = variance * np.linalg.inv(jacobian.T @ jacobian)
    scale = np.sqrt(np.diag(covariance))
    in_logarithms = fit.covariance / np.outer(fit.values, fit.values)
    assert in_logarithms == pytest.approx(covariance, rel=1e-5, abs=1e-5 * scale.min() ** 2)
    assert fit.scatter == pytest.approx(np.sqrt(variance), rel=1e-9)


def test_stated_uncertainties_set_covariance_and_intervals(setup, noisy):
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
    above, below = (log_light(*fit.values, pressure=PRESSURE * np.exp(d)) for d in (1e-4, -1e-4))
    slope = (above - below) / 2e-4
    assert fit.uncertainty == pytest.approx(np.hypot(0.01, 0.05 * slope), rel=1e-5)
    assert fit.uncertainty.max() > 3.0 * fit.uncertainty.min()


@pytest.mark.parametrize("stated", [False, True], ids=["estimated scatter", "stated uncertainty"])
def test_intervals_end_where_the_profile_reaches_its_threshold(setup, noisy, stated):
    fit = lf.calibrate(points(noisy, **({"irradiance_uncertainty": 0.05 * noisy} * stated)), setup)
    spread = 0.05 if stated else np.sqrt(np.sum(fit.residuals**2) / 12)

    def cost(c_fm, c_cont):
        return np.sum(((np.log(noisy) - log_light(c_fm, c_cont)) / spread) ** 2)

    threshold = stats.chi2.ppf(0.95, 1) if stated else stats.f.ppf(0.95, 1, 12)
    for end in fit.intervals[0]:
        profile = minimize_scalar(lambda c_cont, end=end: cost(end, c_cont), bounds=(1.5, 6.0))
        assert profile.fun - cost(*fit.values) == pytest.approx(threshold, rel=1e-3)


def test_intervals_cover_the_truth_as_often_as_they_claim(setup):
    """Of few points, so that the threshold for an estimated scatter matters.

    With that of stated uncertainties the intervals would hold the truth in 86 % of the
    experiments.
    """
    generator = np.random.default_rng(2023)
    pressure = np.geomspace(1.5, 25.0, 5)
    exact = log_light(pressure=pressure, diameter=0.02)
    held = []
    for _ in range(120):
        light = np.exp(exact + 0.03 * generator.standard_normal(pressure.size))
        data = Points("synthetic", ["one"] * 5, {"pressure": pressure, "irradiance": light})
        low, high = lf.calibrate(data, setup).intervals.T
        held.append((low <= TRUTH) & (high >= TRUTH))
    share = np.mean(held, axis=0)
    assert np.all((share >= 0.91) & (share <= 0.99)), share  # two standard errors each way


class Slow(lf.AbstractForceModel):
    """A model of a user's own: free molecules, weakened by one coefficient."""

    flyers: ClassVar = (lf.Disk,)
    weakness: Coefficient = 0.5
    reach: Length = 1e-2

    def heat_loss(self, flyer, state, unknowns):
        return lf.FreeMolecular().heat_loss(flyer, state, unknowns)

    def force(self, flyer, state, unknowns):
        free = lf.FreeMolecular().force(flyer, state, unknowns)
        return free * self.weakness / (1.0 + state.pressure * flyer.radius / self.reach)


def test_a_users_own_model():
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    flyer, pressure = lf.Disk(film, 0.01), np.geomspace(0.2, 2.0, 9)
    light = lf.levitate(flyer, CHAMBER.state(pressure), Slow(0.8, 0.02)).irradiance
    data = Points("own", ["disk"] * 9, {"pressure": pressure, "irradiance": light})
    fit = lf.calibrate(data, flyer, CHAMBER, Slow(), free=["weakness", "reach"])
    assert fit.values == pytest.approx([0.8, 0.02], rel=1e-6)
    assert fit.setup.model.weakness == pytest.approx(0.8, rel=1e-6)


def test_a_flyer_of_two_temperatures_by_full_names():
    films = {
        name: lf.FilmProperties(5e-4, absorptance, 0.1, 0.1, 0.9, 0.9, transmittance=passing)
        for name, absorptance, passing in (("top", 0.1, 0.8), ("bottom", 0.7, 0.1))
    }
    ...
