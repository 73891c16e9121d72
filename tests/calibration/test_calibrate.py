"""Calibration, against finite differences of the model, SciPy's minimiser and known truths."""

import re
from importlib import resources
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
import pytest
from scipy import stats
from scipy.optimize import minimize_scalar

import lightflyer as lf
from lightflyer.calibration import Points
from lightflyer.calibration.inputs import target_of
from lightflyer.core.quantity import Coefficient, Conductivity, Length, Mass

TRUTH = np.array([0.4, 3.0])
PRESSURE = np.tile(np.geomspace(1.5, 25.0, 7), 2)
DIAMETER = np.repeat([0.02, 0.03], 7)
SAMPLES = ["synthetic 2 cm"] * 7 + ["synthetic 3 cm"] * 7
CHAMBER = lf.Chamber()
MADE_WITH = {
    "c_fm": 0.4,
    "c_cont": 3.0,
    "emittance": 0.08,
    "absorptance": 0.75,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}


def log_light(pressure=PRESSURE, diameter=DIAMETER, chamber=CHAMBER, **numbers):
    """Log-irradiance to levitate of samples; synthetic, like all data here."""
    numbers = MADE_WITH | numbers
    emittance = numbers.pop("emittance")
    model = lf.Lu2023(numbers.pop("c_fm"), numbers.pop("c_cont"))
    film = lf.FilmProperties(1e-3, emittance_top=emittance, emittance_bottom=emittance, **numbers)
    disk = lf.Disk(film, 0.5 * diameter)
    return np.log(lf.levitate(disk, chamber.state(pressure), model).irradiance)


@pytest.fixture(scope="module")
def setup(film):
    return lf.Setup(lf.Disk(film, 0.01), CHAMBER, lf.Lu2023(0.5, 2.0))


@pytest.fixture(scope="module")
def exact():
    return np.exp(log_light())


@pytest.fixture(scope="module")
def noisy(exact):
    return exact * np.exp(0.05 * np.random.default_rng(7).standard_normal(exact.size))


def points(irradiance, **more):
    numbers = {"pressure": PRESSURE, "irradiance": irradiance, "diameter": DIAMETER, **more}
    return Points("synthetic.csv", SAMPLES, numbers)


def test_recovers_what_exact_points_were_made_with(setup, exact):
    fit = lf.calibrate(setup, points=points(exact))
    assert fit.names == ["c_fm", "c_cont"]
    assert fit.values == pytest.approx(TRUTH, rel=1e-7)
    assert np.abs(fit.residuals).max() < 1e-7
    assert fit.setup.model.c_cont == fit.values[1]
    assert fit.setup.flyer == setup.flyer


def test_fits_film_properties_of_one_sample(setup, exact):
    one = np.array(SAMPLES) == "synthetic 2 cm"
    hotter = np.where(one, np.exp(log_light(emittance=0.12)), exact)
    fit = lf.calibrate(
        setup, points=points(hotter), free=["c_fm", "c_cont", "emittance[synthetic 2 cm]"]
    )
    assert fit.values == pytest.approx([*TRUTH, 0.12], rel=1e-6)
    assert not any("is only where the fit starts" in text for text in fit.warnings)
    sized = lf.calibrate(setup, points=points(exact), free=["diameter[synthetic 2 cm]"], **EXACT)
    said = "diameter[synthetic 2 cm] is fitted: its column in synthetic.csv is only where the"
    assert any(text.startswith(said) for text in sized.warnings)
    # what belongs to one sample alone is not the setup's
    assert fit.setup.flyer.film.emittance_top == 0.08


def test_takes_the_path_of_a_file(noisy):
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as path:
        fit = lf.calibrate(path, points=points(noisy), free=["c_fm"])
        chamber = lf.read_flyer_file(path).build().environment
    # the file's other coefficient is the paper's
    made = log_light(c_fm=fit.values[0], c_cont=3.0, chamber=chamber)
    assert fit.residuals == pytest.approx(np.log(noisy) - made, abs=1e-9)


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


def unevenness(jacobian, residuals, covariance):
    """Root of the ratio of HC3's variances to the usual ones, at least one, by leaving points out.

    HC3 is (n / (n - 1) times, and but for a shift of the mean) the jackknife: each point's removal
    moves the parameters by its residual over one minus its leverage.
    """
    inverse = np.linalg.inv(jacobian.T @ jacobian)
    moves = []
    for left_out in range(len(residuals)):
        rest = np.arange(len(residuals)) != left_out
        moves.append(np.linalg.lstsq(jacobian[rest], residuals[rest], rcond=None)[0])
    full = inverse @ jacobian.T @ residuals
    variance = np.sum((np.array(moves) - full) ** 2, axis=0)
    return np.sqrt(np.maximum(variance / np.diag(covariance), 1.0))


@pytest.mark.parametrize("free", [("c_fm", "c_cont"), ("tac_top", "emittance", "absorptance")])
def test_covariance_is_that_of_finite_differences(setup, noisy, free):
    fit = lf.calibrate(setup.flyer, CHAMBER, lf.Lu2023(*TRUTH), points=points(noisy), free=free)
    fitted = dict(zip(free, fit.values, strict=True))
    jacobian = derivatives(free, MADE_WITH | fitted)
    # least squares: the residuals are orthogonal to all derivatives
    assert np.abs(jacobian.T @ fit.residuals).max() < 1e-5
    variance = np.sum(fit.residuals**2) / (len(SAMPLES) - len(free))
    covariance = variance * np.linalg.inv(jacobian.T @ jacobian)
    wider = unevenness(jacobian, fit.residuals, covariance)
    covariance = covariance * np.outer(wider, wider)
    scale = np.sqrt(np.diag(covariance))
    in_logarithms = fit.covariance / np.outer(fit.values, fit.values)
    assert in_logarithms == pytest.approx(covariance, rel=1e-5, abs=1e-5 * scale.min() ** 2)
    assert fit.scatter == pytest.approx(np.sqrt(variance), rel=1e-9)


def test_stated_uncertainties_set_covariance_and_intervals(setup, noisy):
    found, wide = (
        lf.calibrate(setup, points=points(noisy, irradiance_uncertainty=u * noisy), **EXACT)
        for u in (0.04, 0.5)
    )
    assert not found.estimated_scatter
    assert wide.values == pytest.approx(found.values, rel=1e-6)
    assert wide.covariance == pytest.approx((0.5 / 0.04) ** 2 * found.covariance, rel=1e-4)
    assert "may be too wide" in " ".join(wide.warnings)
    # close to linear, so profile intervals are about 1.96 standard uncertainties each way
    half = 0.5 * (found.intervals[:, 1] - found.intervals[:, 0])
    assert half == pytest.approx(1.96 * found.standard_uncertainties, rel=0.02)
    assert np.all(found.intervals[:, 0] < found.values)


def test_uncertain_pressure_counts_by_the_slope_of_the_curve(setup, exact):
    data = points(exact, pressure_uncertainty=0.05 * PRESSURE, irradiance_uncertainty=0.01 * exact)
    fit = lf.calibrate(setup, points=data)
    fitted = dict(zip(fit.names, fit.values, strict=True))
    above, below = (log_light(PRESSURE * np.exp(d), **fitted) for d in (1e-4, -1e-4))
    slope = (above - below) / 2e-4
    assert fit.uncertainty == pytest.approx(np.hypot(0.01, 0.05 * slope), rel=1e-5)
    assert fit.uncertainty.max() > 3.0 * fit.uncertainty.min()


@pytest.mark.parametrize("stated", [False, True], ids=["estimated scatter", "stated uncertainty"])
def test_intervals_end_where_the_profile_reaches_its_threshold(setup, noisy, stated):
    uncertainty = {"irradiance_uncertainty": 0.05 * noisy} if stated else {}
    fit = lf.calibrate(setup, points=points(noisy, **uncertainty))
    spread = 0.05 if stated else np.sqrt(np.sum(fit.residuals**2) / 12)

    def cost(c_fm, c_cont):
        return np.sum(((np.log(noisy) - log_light(c_fm=c_fm, c_cont=c_cont)) / spread) ** 2)

    threshold = stats.chi2.ppf(0.95, 1) if stated else stats.f.ppf(0.95, 1, 12)
    wider = 1.0
    if not stated:
        jacobian = derivatives(fit.names, MADE_WITH | dict(zip(fit.names, fit.values, strict=True)))
        covariance = spread**2 * np.linalg.inv(jacobian.T @ jacobian)
        wider = unevenness(jacobian, fit.residuals, covariance)[0]
    best = fit.values[0]
    for end in best * (fit.intervals[0] / best) ** (1.0 / wider):
        profile = minimize_scalar(lambda c_cont, end=end: cost(end, c_cont), bounds=(1.5, 6.0))
        assert profile.fun - cost(*fit.values) == pytest.approx(threshold, rel=1e-3)


EXACT = {"pressure_accuracy": 0.0, "irradiance_accuracy": 0.0}


def uncertain(setup, spreads, correlations=None):
    names = {f"flyer.film.{name}": spread for name, spread in spreads.items()}
    pairs = {
        tuple(f"flyer.film.{name}" for name in pair): value
        for pair, value in (correlations or {}).items()
    }
    return lf.design.ObjectDesign(setup, names, pairs)


@pytest.mark.parametrize("correlation", [0.0, 0.8])
def test_total_interval_of_a_coefficient_is_that_of_one_over_the_difference(
    setup, exact, correlation
):
    """The force is a coefficient times the difference of the TACs, in thin gas exactly.

    With free molecules alone the quantiles of one over a normal difference are known.
    """
    pressure = np.geomspace(1.5, 6.0, 7)
    data = {"tac_top": 0.03, "tac_bottom": 0.03}
    design = uncertain(setup, data, {("tac_top", "tac_bottom"): correlation})
    light = np.exp(log_light(pressure, 0.02, c_cont=1e5))
    points = Points("thin", ["one"] * 7, {"pressure": pressure, "irradiance": light})
    thin = lf.design.ObjectDesign(
        lf.Setup(setup.flyer, CHAMBER, lf.Lu2023(0.5, 1e5)),
        design.uncertainties,
        design.correlations,
    )
    fit = lf.calibrate(thin, points=points, free=["c_fm"], **EXACT)
    spread = 0.03 * np.sqrt(2.0 - 2.0 * correlation)
    expected = 0.04 / (0.1 + 1.96 * spread * np.array([1.0, -1.0]))
    # the mean TAC, which also cools, leaves a difference
    assert fit.total_intervals[0] == pytest.approx(expected, rel=0.07)
    assert set(fit.contributions) == {"flyer.film.tac_top", "flyer.film.tac_bottom"}
    assert fit.summary()["parameters"]["c_fm"]["interval_95"][1] < 0.41


def test_slopes_by_inputs_are_those_of_refits(setup, noisy):
    spreads = {"emittance_top": 0.01, "areal_density": 5e-5}
    design = uncertain(setup, spreads)
    fit = lf.calibrate(design, points=points(noisy), **EXACT)
    for name, spread in spreads.items():
        value = getattr(setup.flyer.film, name) + 0.05 * spread
        moved = lf.design.ObjectDesign(setup).build({f"flyer.film.{name}": value})
        refit = lf.calibrate(moved, points=points(noisy), **EXACT)
        slope = np.log(refit.values / fit.values) / 0.05
        # to first order residuals count as zero
        shares = fit.contributions[f"flyer.film.{name}"]
        assert shares == pytest.approx(np.abs(slope), rel=0.05, abs=1e-4)
    # the points' scatter and all inputs together
    variance = sum(share**2 for share in fit.contributions.values())
    added = np.diag(fit.total_covariance - fit.covariance) / fit.values**2
    assert added == pytest.approx(variance, rel=1e-9)
    by_inputs = 1.96 * np.sqrt(variance)
    ends, total = (np.log(one.T / fit.values) for one in (fit.intervals, fit.total_intervals))
    assert np.abs(total) == pytest.approx(np.hypot(ends, by_inputs), rel=0.06)


def test_instruments_move_all_points_together(setup, exact):
    """A meter that reads 5 % high is the same as points that are 5 % too high."""
    known, factor = points(exact), np.exp(1.96 * 0.05)
    meter = lf.calibrate(setup, points=known, pressure_accuracy=0.0, irradiance_accuracy=0.05)
    brighter = lf.calibrate(setup, points=points(exact * factor), **EXACT)
    assert meter.total_intervals[0, 0] == pytest.approx(brighter.values[0], rel=1e-3)
    gauge = lf.calibrate(setup, points=known, pressure_accuracy=0.05, irradiance_accuracy=0.0)
    denser = lf.calibrate(setup, points=points(exact, pressure=PRESSURE * factor), **EXACT)
    assert gauge.total_intervals[1, 1] == pytest.approx(denser.values[1], rel=1e-3)


def test_uncertainties_of_samples_stand_in_columns(setup, exact):
    spread = np.where(np.array(SAMPLES) == "synthetic 2 cm", 0.02, 0.0)
    numbers = {"emittance": np.full(14, 0.08), "emittance_uncertainty": spread}
    fit = lf.calibrate(setup, points=points(exact, **numbers), free=["c_fm"], **EXACT)
    assert list(fit.contributions) == ["emittance[synthetic 2 cm]"]
    numbers["emittance_uncertainty"] = np.full(14, 0.02)
    whole = lf.calibrate(setup, points=points(exact, **numbers), free=["c_fm"], **EXACT)
    assert len(whole.contributions) == 2


def test_what_vanishes_within_the_inputs_has_no_upper_bound(setup, exact):
    design = uncertain(setup, {"tac_top": 0.05, "tac_bottom": 0.05})
    fit = lf.calibrate(design, points=points(exact), **EXACT)
    assert fit.total_intervals[0, 1] == np.inf
    assert fit.intervals[0, 1] < 0.41
    said = " ".join(fit.warnings)
    assert "c_fm has no upper bound: within their ±, flyer.film.tac_top and" in said
    summary = fit.summary()
    assert summary["parameters"]["c_fm"]["total_interval_95"][1] is None
    assert summary["warnings"] == list(fit.warnings)


def test_points_in_thin_gas_do_not_determine_the_continuum(setup):
    pressure = np.geomspace(1.2, 2.0, 8)
    light = np.exp(log_light(pressure, 0.02, c_cont=30.0))
    light = light * np.exp(0.03 * np.random.default_rng(2).standard_normal(8))
    thin = Points("thin", ["one"] * 8, {"pressure": pressure, "irradiance": light})
    fit = lf.calibrate(setup, points=thin, **EXACT)
    assert fit.intervals[1, 1] == np.inf
    assert "c_cont has no upper bound: the points do not determine it there" in fit.warnings


def test_coefficients_that_are_fitted_have_no_scatter_of_the_papers(setup, exact):
    design = lf.design.ObjectDesign(
        lf.Setup(setup.flyer, setup.environment, lf.Lu2023(force_error=0.0)),
        {"force.force_error": 1.0},
    )
    inputs = lf.calibrate(design, points=points(exact), free=["c_fm"]).problem.inputs.names
    assert "force.force_error" not in inputs
    film = lf.calibrate(design, points=points(exact), free=["absorptance"]).problem.inputs.names
    assert "force.force_error" in film


def test_two_points_with_nothing_to_spare(setup):
    """An end of an interval far away once overflowed."""
    numbers = {
        "pressure": np.array([4.0, 2.93]),
        "irradiance": np.array([1510.0, 1890.0]),
        "irradiance_uncertainty": np.array([40.0, 50.0]),
        "diameter": np.array([0.02, 0.03]),
    }
    fit = lf.calibrate(setup, points=Points("two", ["a", "b"], numbers))
    assert np.all(fit.intervals[:, 0] < fit.values)
    assert "as many parameters as points" in " ".join(fit.warnings)
    assert fit.summary()["reduced_chi_squared"] is None


@pytest.mark.parametrize("copies", [1, 30])
def test_residuals_in_an_arc_are_said_and_more_points_do_not_narrow_the_interval(setup, copies):
    pressure = np.geomspace(1.5, 25.0, 14 * copies)
    arc = 0.3 * np.cos(1.5 * np.pi * np.linspace(-1.0, 1.0, pressure.size))
    light = np.exp(log_light(pressure, 0.02) + arc)
    lot = Points("arc", ["one"] * light.size, {"pressure": pressure, "irradiance": light})
    fit = lf.calibrate(setup, points=lot, **EXACT)
    assert "the model does not fit them; intervals are wider" in " ".join(fit.warnings)
    low, high = fit.intervals[0]
    assert low < 0.4 < high
    assert 0.1 < np.log(high / low) < 1.5


def test_a_parameter_that_ran_to_its_end_for_want_of_points_stops(setup):
    pressure = np.geomspace(1.2, 1.3, 6)
    light = np.exp(log_light(pressure, 0.02)) * [0.7, 1.3, 0.8, 1.2, 0.6, 1.4]
    lot = Points("few", ["one"] * 6, {"pressure": pressure, "irradiance": light})
    with pytest.raises(lf.ParameterError, match=r"do not determine tac_bottom: 1\.3 ± "):
        lf.calibrate(setup, points=lot, free=["tac_top", "tac_bottom"], **EXACT)


def test_numbers_of_a_wrong_unit_are_said(setup, exact):
    fit = lf.calibrate(setup, points=points(1e-3 * exact), **EXACT)  # kW taken for W
    said = " ".join(fit.warnings)
    assert "synthetic 2 cm: irradiance = " in said
    assert re.search(r"c_cont = \S+ is unlikely, 0.3 to 30 is usual: .*check the units", said)


def test_parameters_that_can_hardly_be_told_apart(film):
    """The profile has several minima; looking twice at one place once found different ones."""
    numbers = {
        "pressure": np.array([3.0, 4.0, 5.0, 8.0]),
        "irradiance": np.array([1000.0, 1100.0, 1200.0, 1400.0]),
    }
    lot = Points("few", ["one"] * 4, numbers)
    chamber = lf.Chamber(temperature=293.0)
    free = ["tac_bottom", "tac_top"]
    fit = lf.calibrate(lf.Disk(film, 0.01), chamber, lf.Lu2023(), points=lot, free=free)
    assert np.all(fit.intervals[:, 0] <= fit.values)
    assert np.all(fit.values <= fit.intervals[:, 1])


def test_stated_errors_far_below_the_scatter(setup, exact, noisy):
    small = points(noisy, irradiance_uncertainty=0.002 * noisy)
    fit = lf.calibrate(setup, points=small, **EXACT)
    assert fit.reduced_chi_squared > 100.0
    assert fit.chi_squared_probability < 1e-6
    assert "times as much as their stated uncertainties say" in " ".join(fit.warnings)
    scaled = lf.calibrate(setup, points=small, scale_errors=True, **EXACT)
    grown = fit.reduced_chi_squared * fit.covariance
    assert scaled.covariance == pytest.approx(grown, rel=1e-4)
    half = 0.5 * np.log(scaled.intervals[:, 1] / scaled.intervals[:, 0]) * scaled.values
    student = stats.t.ppf(0.975, 12)
    assert half == pytest.approx(student * np.sqrt(np.diag(grown)), rel=0.02)
    assert scaled.error_scale == pytest.approx(np.sqrt(fit.reduced_chi_squared), rel=1e-6)
    assert any("had to be scaled by" in text for text in scaled.warnings)


def test_steps_of_the_light(setup, exact):
    """Noted at the first step above the light that suffices; half a step is taken off."""
    pressure = np.geomspace(1.5, 25.0, 40)
    light = np.exp(log_light(pressure, 0.02))
    noted = 100.0 * np.ceil(light / 100.0)
    lot = Points("steps", ["one"] * 40, {"pressure": pressure, "irradiance": noted})
    plain = lf.calibrate(setup, points=lot, **EXACT)
    assert "lie on steps of 100 W/m^2" in " ".join(plain.warnings)
    stepped = lf.calibrate(setup, points=lot.with_step(100.0), **EXACT)
    assert not any("lie on steps" in text for text in stepped.warnings)
    assert abs(np.log(stepped.values[0] / 0.4)) < 0.3 * abs(np.log(plain.values[0] / 0.4))
    low, high = stepped.intervals[0]
    assert low < 0.4 < high
    for step in (-1.0, 2000.0, np.nan):
        with pytest.raises(lf.ParameterError, match="steps: step = "):
            lot.with_step(step)


class Slow(lf.AbstractForceModel):
    """A model of a user's own: free molecules, weakened by one coefficient."""

    flyers: ClassVar = (lf.Disk,)
    weakness: Coefficient
    reach: Length

    def heat_loss(self, flyer, state, unknowns):
        return lf.FreeMolecular().heat_loss(flyer, state, unknowns)

    def force(self, flyer, state, unknowns):
        free = lf.FreeMolecular().force(flyer, state, unknowns)
        return free * self.weakness / (1.0 + state.pressure * flyer.radius / self.reach)


def test_a_users_own_model(film):
    flyer, pressure = lf.Disk(film, 0.01), np.geomspace(0.2, 2.0, 9)
    light = lf.levitate(flyer, CHAMBER.state(pressure), Slow(0.8, 0.02)).irradiance
    data = Points("own", ["disk"] * 9, {"pressure": pressure, "irradiance": light})
    fit = lf.calibrate(flyer, CHAMBER, Slow(0.7, 0.03), points=data, free=["weakness", "reach"])
    assert fit.values == pytest.approx([0.8, 0.02], rel=1e-6)
    assert fit.setup.model.weakness == pytest.approx(0.8, rel=1e-6)


class Plates(lf.AbstractFlyer):
    """A flyer of a user's own: two plates, of which the lower absorbs the light."""

    nodes: ClassVar = ("top", "bottom")
    radius: Length
    conductance: Conductivity
    payload: Mass = 0.0
    attitude: lf.environment.Attitude | None = None

    @property
    def area(self):
        return jnp.pi * self.radius**2

    @property
    def own_mass(self):
        return 1e-3 * self.area

    def beam_areas(self, state):
        return 0.1 * self.area, 0.6 * self.area

    def heat_gains(self, state):
        return 0.0 * state.temperature, 0.0 * state.temperature

    def heat_losses(self, state, unknowns):
        top, bottom = unknowns
        exchanged = self.conductance * self.area * state.temperature * (bottom - top)
        return -exchanged, exchanged

    def describe(self):
        return "two plates"


class Push(lf.AbstractForceModel):
    flyers: ClassVar = (Plates,)

    def heat_loss(self, flyer, state, unknowns):
        return tuple(30.0 * flyer.area * state.pressure * excess for excess in unknowns)

    def force(self, flyer, state, unknowns):
        top, bottom = unknowns
        return 0.25 * flyer.area * state.pressure * (bottom - top)


def test_a_flyer_of_two_temperatures():
    diameter, pressure = np.repeat([0.02, 0.03], 4), np.tile(np.geomspace(0.5, 5.0, 4), 2)
    # both balances are linear: what light makes of the difference of the temperatures
    split = (0.6 - 0.1) / (30.0 * pressure + 2 * 0.3 * CHAMBER.temperature)
    light = 1e-3 * 9.80665 / (0.25 * pressure * split)
    numbers = {"pressure": pressure, "irradiance": light, "diameter": diameter}
    data = Points("own", ["plates"] * 8, numbers)
    fit = lf.calibrate(Plates(0.01, 0.2), CHAMBER, Push(), points=data, free=["flyer.conductance"])
    assert fit.values == pytest.approx([0.3], rel=1e-6)


def test_payload_counts(setup):
    heavier = lf.Setup(lf.Disk(setup.flyer.film, 0.01, payload=1e-7), CHAMBER, setup.model)
    disk = lf.Disk(setup.flyer.film, 0.5 * DIAMETER, payload=1e-7)
    light = lf.levitate(disk, CHAMBER.state(PRESSURE), lf.Lu2023(*TRUTH)).irradiance
    assert lf.calibrate(heavier, points=points(light)).values == pytest.approx(TRUTH, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "fields", "factor", "value"),
    [
        ("c_fm", ["force.c_fm"], 1.0, 0.5),
        ("film.tac_top", ["flyer.film.tac_top"], 1.0, 0.8),
        ("diameter", ["flyer.radius"], 0.5, 0.02),
        ("flyer.diameter", ["flyer.radius"], 0.5, 0.02),
        ("emittance", ["flyer.film.emittance_top", "flyer.film.emittance_bottom"], 1.0, 0.07),
    ],
)
def test_names_of_numbers(name, fields, factor, value):
    """An object has a radius and two emittances; points have a diameter and one emittance."""
    film = lf.FilmProperties(1e-3, 0.75, 0.06, 0.08, tac_top=0.8, tac_bottom=0.9)
    design = lf.design.ObjectDesign(lf.Setup(lf.Disk(film, 0.01), CHAMBER, lf.Lu2023(0.5, 2.0)))
    target = target_of(design, name)
    assert list(target.fields) == fields
    assert (target.factor, target.value) == (factor, pytest.approx(value))


def test_a_layered_film_starts_from_what_its_layers_give(flyer_file, setup, exact):
    layers = '[{material = "Ge", thickness = "20 nm"}, {material = "PET", thickness = "500 nm"}]'
    path = flyer_file(
        'areal_density = "1.0 g/m^2"\nabsorptance = 0.75            # for the incoming light\n',
        f'layers = {layers}\nextrapolation = "hold"\n',
    )
    text = path.read_text(encoding="utf-8").replace('"earth"\natmosphere = "lu2023"', '"chamber"')
    text = text.replace('incidence = "0 deg"', f'temperature = "{CHAMBER.temperature} K"')
    path.write_text(text, encoding="utf-8")
    design = lf.read_flyer_file(path).design()
    film = design.setup.flyer.film
    assert target_of(design, "absorptance").value == film.absorptance
    assert film.areal_density == pytest.approx(20e-9 * 5323.0 + 500e-9 * 1390.0, rel=0.02)
    with pytest.raises(lf.ParameterError, match="too costly to fit"):
        lf.calibrate(design, points=points(exact), free=["film.layers.0.thickness"])
    other = lf.Setup(lf.Disk(film, 0.01), CHAMBER, lf.Lu2023())
    by_file, by_objects = (
        lf.calibrate(what, points=points(exact), free="absorptance") for what in (design, other)
    )
    assert by_file.values == pytest.approx(by_objects.values, rel=1e-6)


def test_one_emittance_where_the_file_gives_two(flyer_file):
    path = flyer_file("emittance = 0.08", "emittance_top = 0.06\nemittance_bottom = 0.08")
    target = target_of(lf.read_flyer_file(path).design(), "emittance")
    assert target.fields == ("film.emittance",)
    assert target.value == pytest.approx(0.07)


@pytest.mark.parametrize(
    ("free", "says"),
    [
        (["c_fn"], 'c_fn is not a number of the design; did you mean "c_fm"?'),
        (["pressure"], "pressure is the coordinate of the points"),
        ([], "no parameters to fit"),
        (["c_fm", "c_fm"], "fitted twice"),
        (["c_fm", "force.c_fm[synthetic 2 cm]"], "fitted twice"),
        (["emittance", "film.emittance_top"], "both"),
        (["payload"], "payload is 0 in the design"),
        (["diameter"], 'several; fit it sample by sample, such as "diameter[synthetic 2 cm]"'),
        (["gravity", "temperature", "emittance[gold]"], 'synthetic.csv has no sample "gold"'),
        (["c_fm", "c_cont", "tac_top", "tac_bottom"], "cannot tell"),
    ],
)
def test_clear_errors(setup, exact, free, says):
    with pytest.raises(lf.ParameterError) as raised:
        lf.calibrate(setup, points=points(exact), free=free)
    assert says in str(raised.value)
    assert "\n" not in str(raised.value)


THIRD = np.arange(14) == 3


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ({"conductance": np.ones(14)}, "conductance is not a number of the design"),
        ({"pressure": np.where(THIRD, 1e-6, PRESSURE)},
         r"no irradiance levitates synthetic 2 cm at 1e-06 Pa \(1 of 14 points\)"),
        ({"irradiance_uncertainty": np.where(THIRD, 0.0, 1.0)}, "point 4 has no uncertainty"),
    ],
)  # fmt: skip
def test_points_of_no_use(setup, exact, more, says):
    with pytest.raises(lf.ParameterError, match=says):
        lf.calibrate(setup, points=points(exact, **more))


def test_designs_and_points_that_do_not_go_together(setup, exact):
    with pytest.raises(lf.ParameterError, match="coordinate of this environment is altitude"):
        lf.calibrate(setup.flyer, lf.Earth(), setup.model, points=points(exact))
    few = Points("few.csv", SAMPLES[:2], {"pressure": PRESSURE[:2], "irradiance": exact[:2]})
    with pytest.raises(lf.ParameterError, match=r"few.csv: 2 points cannot determine 2 parameters"):
        lf.calibrate(setup, points=few)
    walls = lf.Setup(setup.flyer, lf.Chamber(radius=0.2), setup.model)
    with pytest.raises(lf.ParameterError, match=r'"radius" is ambiguous: flyer.radius, '):
        lf.calibrate(walls, points=points(exact), free=["radius"])
    # a column describes the flyer
    assert lf.calibrate(walls, points=points(exact)).values == pytest.approx(TRUTH, rel=1e-6)
