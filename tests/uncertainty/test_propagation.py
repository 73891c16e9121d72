import dataclasses
from importlib import resources
from pathlib import Path
from typing import Literal

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.stats

import lightflyer as lf
from lightflyer.array.transformations import compiled
from lightflyer.cli.commands.init import templates
from lightflyer.config.designs import as_design
from lightflyer.config.reader import design_of_text
from lightflyer.core.quantity import Fraction
from lightflyer.design.design import ObjectDesign
from lightflyer.design.tables import tabulate
from lightflyer.environment.earth import Lu2023Section
from lightflyer.film.properties import MeasuredFilmSection
from lightflyer.force.lu2023 import Lu2023ForceSection
from lightflyer.uncertainty import targets
from lightflyer.uncertainty.inputs import draw, draw_possible, uncertain_inputs
from lightflyer.uncertainty.targets import derivatives

from ..conftest import FILM

EARTH = {"atmosphere": "lu2023", "altitude_min": "55 km", "altitude_max": "90 km"}
CHAMBER = {"kind": "chamber", "temperature": "295 K", "pressure_min": "0.5 Pa",
           "pressure_max": "50 Pa"}  # fmt: skip


def configure(environment=EARTH, diameter="2 cm", **film):
    return lf.FlyerFile(
        flyer={"diameter": diameter},
        film={**FILM, **film},
        environment=environment,
        force={"model": "lu2023", "force_error": 0},
    )


def propagate(configuration, samples=0, at=(), seed=0):
    prediction = lf.predict(configuration, at=at)
    return lf.propagate(configuration, prediction=prediction, samples=samples, seed=seed)


def test_nothing_without_uncertainties():
    assert propagate(configure()) is None


@pytest.fixture(scope="module")
def small():
    """Uncertainties small enough for the model to be linear."""
    small = {
        "emittance": "0.08 ± 0.0005",
        "tac_top": "0.8 ± 0.0004",
        "tac_bottom": "0.9 ± 0.0004",
        "tac_correlation": 0.5,
        "highest_temperature": "400 K",
    }
    return configure(**small)


@pytest.fixture(scope="module")
def both(small):
    return propagate(small, samples=400, at=[72e3])


def test_monte_carlo_agrees_where_the_model_is_linear(both):
    results = both.summary()["results"]
    assert {"altitude_band_km.lower", "minimum_irradiance.value_w_m2", "best.payload_mg",
            "at[0].temperature_k"} <= set(results)  # fmt: skip
    for name, result in results.items():
        spread = result["first_order"]["standard_uncertainty"]
        # 400 samples know a standard deviation to 3.5 %, so this is four of those
        assert np.std(both.sampled[name]) == pytest.approx(spread, rel=0.15), name
        offset = result["monte_carlo"]["median"] - result["value"]
        grid = 2e-4 * abs(result["value"])  # samples are tabulated every 300 m
        assert abs(offset) < 0.3 * spread + grid, name
        assert result["monte_carlo"]["share_of_samples"] == 1.0


def test_first_order_is_that_of_repeated_predictions():
    """One uncertain input: the spread is the result's slope times the input's spread."""
    spread = 0.01
    limit = {"highest_temperature": "520 K"}
    uncertain = propagate(configure(emittance=f"0.08 ± {spread}", **limit))
    step = 1e-3  # optima are flat: their place needs a step that moves it well
    low, high = (
        lf.predict(configure(emittance=0.08 + sign * step, **limit), at=[]).summary()
        for sign in (-1, 1)
    )

    def slope(read):
        return abs(read(high) - read(low)) / (2.0 * step)

    for name, read in {
        "altitude_band_km.lower": lambda s: s["altitude_band_km"][0],
        "altitude_band_km.upper": lambda s: s["altitude_band_km"][1],
        "minimum_irradiance.value_w_m2": lambda s: s["minimum_irradiance"]["value_w_m2"],
        "minimum_irradiance.altitude_km": lambda s: s["minimum_irradiance"]["altitude_km"],
        "minimum_irradiance.temperature_k": lambda s: s["minimum_irradiance"]["temperature_k"],
        "best.payload_mg": lambda s: s["best"]["payload_mg"],
        "best.temperature_k": lambda s: s["best"]["temperature_k"],
        "verdict.longest_night_h": lambda s: s["verdict"]["longest_night_h"],
        "verdict.strongest_light_w_m2": lambda s: s["verdict"]["strongest_light_w_m2"],
    }.items():
        expected = spread * slope(read)
        assert uncertain.first_order[name] == pytest.approx(expected, rel=5e-3), name


def test_bands_of_light_to_first_order_are_even_in_its_logarithm():
    """Ends at 1.96 standard deviations, by differences of the model."""
    spread, step = 0.02, 1e-4
    found = propagate(configure(emittance=f"0.08 ± {spread}"))
    setup = found.prediction.setup
    state = setup.environment.state(found.coordinate)
    light = lf.levitate(setup.flyer, state, setup.model).irradiance
    flies = light < 2e3
    state = setup.environment.state(found.coordinate[flies])

    def logarithm(emittance):
        film = dataclasses.replace(
            setup.flyer.film, emittance_top=emittance, emittance_bottom=emittance
        )
        disk = dataclasses.replace(setup.flyer, film=film)
        return np.log(lf.levitate(disk, state, setup.model).irradiance)

    half = 1.959964 * spread * (logarithm(0.08 + step) - logarithm(0.08 - step)) / (2.0 * step)
    assert half.max() > 0.1
    for end, sign in ((found.high, 1.0), (found.low, -1.0)):
        band, expected = end["levitation_irradiance"][flies], light[flies] * np.exp(sign * half)
        known = np.isfinite(band)  # not beyond the model's range
        assert known.sum() > 10
        np.testing.assert_allclose(band[known], expected[known], rtol=1e-5)


def test_correlated_tacs_leave_their_difference_certain():
    tac = {"tac_top": "0.8 ± 0.03", "tac_bottom": "0.9 ± 0.03"}
    spread = {
        correlation: propagate(configure(**tac, tac_correlation=correlation)).first_order[
            "best.payload_mg"
        ]
        for correlation in (0.0, 1.0)
    }
    # Δα = 0.10 ± 0.04 alone moves the lift by 40 % of 0.50 mg
    assert spread[0.0] == pytest.approx(0.2, rel=0.1)
    assert spread[1.0] < 0.1 * spread[0.0]


def test_chamber():
    uncertain = configure(CHAMBER, emittance="0.08 ± 0.002")
    found = propagate(uncertain, samples=100, at=[3.0])
    results = found.summary()["results"]
    for name in ("optimum.pressure_pa", "optimum.irradiance_w_m2", "at[0].temperature_k"):
        spread = results[name]["first_order"]["standard_uncertainty"]
        assert np.std(found.sampled[name]) == pytest.approx(spread, rel=0.3), name
    assert np.all(found.low["temperature"] < found.high["temperature"])


def test_samples_over_mars_whose_atmosphere_is_a_table():
    mars = {"kind": "mars", "dust_optical_depth": 0.0}
    uncertain = configure({**mars, "surface_pressure": "610 Pa ± 60 Pa"})
    found = propagate(uncertain, samples=100)
    drawn = draw(uncertain_inputs(uncertain.design()), 100, 0)[:, 0]
    for sample in (0, int(np.argmax(drawn))):
        truth = lf.predict(
            configure({**mars, "surface_pressure": f"{drawn[sample]:.17g} Pa"})
        ).summary()
        for name, expected in {
            "altitude_band_km.lower": truth["altitude_band_km"][0],
            "best.payload_mg": truth["best"]["payload_mg"],
        }.items():
            assert found.sampled[name][sample] == pytest.approx(expected, rel=1e-7), name


def test_best_at_an_end_of_the_range_stays_there():
    # pushed down by the light, it does best on the ground, where there is no force
    dark = {"atmosphere": "us1976", "albedo": 0.0, "surroundings": "gas"}
    found = propagate(configure(dark, tac_bottom="0.75 ± 0.01"))
    assert found.nominal["best.altitude_km"] == 0.0
    assert found.first_order["best.altitude_km"] == 0.0
    assert np.isfinite(list(found.first_order.values())).all()


def test_the_seed_decides(small, both):
    inputs = uncertain_inputs(small.design())
    assert np.array_equal(draw(inputs, 5, 1), draw(inputs, 5, 1))
    assert not np.array_equal(draw(inputs, 5, 1), draw(inputs, 5, 2))
    drawn = draw(inputs, 20_000, 3)
    assert np.cov(drawn.T) == pytest.approx(inputs.covariance, rel=0.05, abs=5e-9)


def test_numbers_of_very_different_size_keep_their_spreads():
    """A Poisson's ratio beside moduli in pascals, which both membranes share."""
    text = templates()["ligaments"].read()
    inputs = uncertain_inputs(design_of_text(text, Path("ligaments.toml")))
    assert inputs.spreads.max() > 1e15 * inputs.spreads.min()
    drawn = draw(inputs, 5000, 0)
    np.testing.assert_allclose(drawn.std(axis=0), inputs.spreads, rtol=0.05)
    np.testing.assert_allclose(np.corrcoef(drawn.T), inputs.correlation, atol=0.06)


def test_inputs_know_units_faces_and_ranges():
    uncertain = configure(
        {**EARTH, "incidence": "30 ± 1 deg"}, diameter="2 ± 0.01 cm", emittance="0.08 ± 0.01"
    )
    inputs = uncertain_inputs(uncertain.design())
    assert inputs.names == ["flyer.diameter", "film.emittance", "environment.incidence"]
    moved = inputs.setup_of(inputs.values + np.diag([1e-3, 1e-2, 1.0]))
    film, light = moved.flyer.film, moved.environment.radiation
    np.testing.assert_allclose(moved.flyer.radius[:, 0], [0.0105, 0.01, 0.01])
    np.testing.assert_allclose(film.emittance_top[:, 0], [0.08, 0.09, 0.08])
    np.testing.assert_allclose(film.emittance_bottom[:, 0], [0.08, 0.09, 0.08])
    np.testing.assert_allclose(light.zenith_angle[:, 0], np.radians([30.0, 30.0, 31.0]))
    assert np.array_equal(inputs.ranges[1], [0.0, 1.0])


class Wrinkled(lf.flyer.DiskSection):
    """A user's own section, whose build is not linear: wrinkles take area from the disk."""

    shape: Literal["wrinkled"]
    wrinkle: Fraction = lf.Measured(0.0)

    def build(self, film, incidence):
        disk = super().build(film, incidence)
        return dataclasses.replace(disk, radius=disk.radius * (1.0 - self.wrinkle.value**2))


def test_a_build_that_is_not_linear_is_followed():
    flyer = {"shape": "wrinkled", "diameter": "2 cm", "wrinkle": "0.3 ± 0.1"}
    sections = {
        "flyer": Wrinkled(**flyer),
        "film": MeasuredFilmSection(**FILM),
        "environment": Lu2023Section(**EARTH),
        "force": Lu2023ForceSection(force_error=0.0),
    }
    file = lf.FlyerFile.model_construct(**sections)
    inputs = uncertain_inputs(file.design())
    samples = np.array([[0.1], [0.5]])
    radii = np.ravel(inputs.setup_of(samples).flyer.radius)
    np.testing.assert_allclose(radii, 0.01 * (1.0 - samples[:, 0] ** 2), rtol=1e-14)


def test_objects_with_uncertainties_give_what_the_file_gives():
    told = configure(tac_bottom="0.9 ± 0.02", tac_top="0.8 ± 0.02", tac_correlation=0.5)
    names = ("flyer.film.tac_top", "flyer.film.tac_bottom")
    setup = told.build()
    design = lf.design.ObjectDesign(setup, dict.fromkeys(names, 0.02), {names: 0.5})
    ours = lf.propagate(design, samples=100)
    theirs = lf.propagate(told, samples=100)
    assert ours.tac_correlation == theirs.tac_correlation == 0.5
    for name, value in theirs.first_order.items():
        assert ours.first_order[name] == pytest.approx(value, rel=1e-9), name
    with pytest.raises(lf.ConfigurationError, match="did you mean"):
        lf.design.ObjectDesign(setup, {"flyer.film.tac_botom": 0.02})


def strong(model, tac_bottom):
    """A disk that lifts hundreds of times its weight, so that its band is wide."""
    film = lf.FilmProperties(2e-5, 0.9, 0.08, 0.08, tac_top=0.6, tac_bottom=tac_bottom)
    environment = lf.Earth(radiation=lf.environment.Radiation())
    return lf.Setup(lf.Disk(film, 0.01), environment, model)


def test_samples_of_a_large_margin_are_those_of_repeated_predictions():
    model = lf.Lu2023()
    design = ObjectDesign(strong(model, 0.95), {"flyer.film.tac_bottom": 0.02})
    found = lf.propagate(design, samples=100)
    (lower, upper), group = found.prediction.bands[0], "altitude_band_km"
    assert found.coordinate[0] < lower < upper < found.coordinate[-1]
    drawn = draw(uncertain_inputs(design), 100, 0)[:, 0]
    for sample in np.argsort(drawn)[[0, 50, -1]]:
        truth = lf.predict(strong(model, drawn[sample]), at=[]).summary()
        for name, expected in {
            f"{group}.lower": truth[group][0],
            f"{group}.upper": truth[group][1],
            "best.altitude_km": truth["best"]["altitude_km"],
            "minimum_irradiance.altitude_km": truth["minimum_irradiance"]["altitude_km"],
            "verdict.longest_night_h": truth["verdict"]["longest_night_h"],
        }.items():
            assert found.sampled[name][sample] == pytest.approx(expected, abs=0.005), name
        payload = truth["best"]["payload_mg"]
        assert found.sampled["best.payload_mg"][sample] == pytest.approx(payload, rel=1e-4)


def test_an_edge_is_at_an_end_only_where_that_is_searched_to():
    setup = dataclasses.replace(strong(lf.Lu2023(), 0.95), search_range=(20e3, 110.95e3))
    design = ObjectDesign(setup, {"flyer.film.tac_bottom": 0.02})
    found = lf.propagate(design, samples=200, over=np.linspace(70e3, 80e3, 5))
    upper = found.sampled["altitude_band_km.upper"]
    assert found.nominal["altitude_band_km.upper"] == pytest.approx(110.764, abs=1e-3)
    assert upper.max() == pytest.approx(110.95, rel=1e-12)
    beyond = np.mean(upper > 110.9499)
    assert beyond == pytest.approx(scipy.stats.norm.sf(0.186 / 0.35), abs=0.1)
    assert upper.min() < 110.2  # outside of the coordinates whose bands were asked for


def absorbing(value, spread, **film):
    """A disk whose absorptance is uncertain, as a file and as objects."""
    design = configure(absorptance=f"{value} ± {spread}", **film).design()
    return design, ObjectDesign(design.setup, {"flyer.film.absorptance": spread})


@pytest.mark.parametrize(("one", "transmittance"), [(0, 0.05), (1, 0.05), (0, 0.0)])
def test_draws_that_are_impossible_are_drawn_again_and_counted(one, transmittance):
    value, spread, count = 0.9, 0.06, 500
    limit = 1.0 - transmittance  # absorbed and transmitted light together
    inputs = uncertain_inputs(absorbing(value, spread, transmittance=transmittance)[one])
    samples, refused, why = draw_possible(inputs, count, seed=3)
    cut = scipy.stats.truncnorm((0.0 - value) / spread, (limit - value) / spread, value, spread)
    assert samples.max() < limit
    assert scipy.stats.kstest(samples[:, 0], cut.cdf).pvalue > 0.01
    beyond = scipy.stats.norm.sf(limit, value, spread)
    assert refused == pytest.approx(beyond, abs=4.0 * np.sqrt(beyond / count))
    assert "absorptance" in why


def test_possible_draws_are_as_they_come():
    inputs = uncertain_inputs(absorbing(0.5, 0.01)[0])
    samples, refused, why = draw_possible(inputs, 200, seed=3)
    plain = np.random.default_rng(3).multivariate_normal([0.5], [[1e-4]], 200)
    np.testing.assert_array_equal(samples, plain)
    assert (refused, why) == (0.0, "")


def test_samples_without_a_solution_are_counted(both, monkeypatch):
    design = ObjectDesign(both.prediction.setup, {"flyer.film.absorptance": 0.03})
    tabulate = targets.tabulate_samples

    def with_gaps(inputs, samples, coordinate, names):
        table = tabulate(inputs, samples, coordinate, names)
        found = {name: values.copy() for name, values in table.items()}
        if "levitation_irradiance" in found:
            found["levitation_irradiance"].flat[:1] = np.nan
        return found

    monkeypatch.setattr("lightflyer.uncertainty.propagation.tabulate_samples", with_gaps)
    found = lf.propagate(design, prediction=both.prediction, samples=100)
    assert any("Monte Carlo balances missed their tolerance" in text for text in found.warnings)
    monkeypatch.undo()
    found = lf.propagate(design, prediction=both.prediction, samples=100)
    assert not any("missed their tolerance" in text for text in found.warnings)


GERMANIUM = {"material": "Ge", "thickness": "20 ± 2 nm"}


def layered(*layers):
    """A disk whose film is computed from its layers."""
    film = {"layers": layers, "tac_top": 0.8, "tac_bottom": 0.9}
    return lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})


@pytest.mark.parametrize("file", [configure(absorptance="0.75 ± 0.01"), layered(GERMANIUM)])
def test_places_that_are_not_asked_cost_nothing_and_are_unknown(file):
    inputs = uncertain_inputs(file.design())
    samples, places = draw(inputs, 100, seed=0), np.linspace(60e3, 80e3, 3)
    whole = targets.tabulate_samples(inputs, samples, places, ("lift_over_weight",))
    some = np.full((100, 3), np.nan)
    some[7, 1], some[9] = places[1], places
    found = targets.tabulate_samples(inputs, samples, some, ("lift_over_weight",))
    asked = ~np.isnan(some)
    lifts = found["lift_over_weight"]
    np.testing.assert_allclose(lifts[asked], whole["lift_over_weight"][asked], rtol=1e-12)
    assert np.isnan(lifts[~asked]).all()
    nothing = np.full((100, 1), np.nan)
    found = targets.tabulate_samples(inputs, samples, nothing, ("lift_over_weight",))
    assert np.isnan(found["lift_over_weight"]).all()


def test_a_layers_change_on_a_coarse_grid_is_that_of_films_on_the_fine_one():
    file = layered(GERMANIUM, {"material": "PET", "thickness": "500 nm"})
    name = "film.layers.0.thickness"
    change = uncertain_inputs(file.design()).changes[name]
    thin, middle, thick = (
        np.array(file.design().precompute({name: thickness})["film"].emittance_top.at_nodes)
        for thickness in (18e-9, 20e-9, 22e-9)
    )
    nodes = change.slope["film"].emittance_top.at_nodes, change.bend["film"].emittance_top.at_nodes
    # of the derivatives, where the film radiates
    np.testing.assert_allclose(nodes[0] * 4e-9, thick - thin, rtol=0.01)
    np.testing.assert_allclose(nodes[1] * 8e-18, thick + thin - 2.0 * middle, rtol=0.05)


@pytest.mark.parametrize("kind", ["layers", "mars", "sandwich", 0, 1])
def test_first_order_is_that_of_exact_derivatives(kind):
    """Differences of converged solutions beside JAX, also at an end of an input's range."""
    if kind in (0, 1):
        told = configure(absorptance=f"{kind} ± 0.1", tac_top="0.8 ± 0.02").design()
    else:
        told = as_design(resources.files("lightflyer") / "data" / f"flyer-{kind}.toml")
    inputs, setup = uncertain_inputs(told), told.setup
    away_from_kinks = inputs.values + 0.1 * inputs.spreads * (kind not in (0, 1))
    inputs = dataclasses.replace(inputs, values=away_from_kinks)
    places = {"pressure": [1.0, 30.0]}.get(setup.environment.coordinate.name, [70e3, 80e3])
    if kind == "mars":
        places = [50e3, 60e3]
    # the light of levitation takes as long to compile as all else
    names = ("lift", "temperature", "payload")
    if kind in ("mars", "sandwich", 0, 1):
        names += ("levitation_irradiance",)

    def outputs(values, coordinate):
        moved = inputs.build(values)
        light = moved.environment.radiation.irradiance
        table = tabulate(moved, coordinate, light + jnp.zeros_like(coordinate), names)
        return jnp.stack([table[name] for name in names])

    def in_each(values, coordinate):  # each row moves in an input of its own
        whole = jnp.repeat(values[:, None, None], values.size, 1)
        places = jnp.broadcast_to(coordinate, (values.size, coordinate.size))
        moves = (jnp.eye(values.size)[..., None],)
        return jax.jvp(lambda values: outputs(values, places), (whole,), moves)[1]

    exact = compiled(in_each)(inputs.values, np.array(places))
    slopes = derivatives(inputs, np.array(places))
    for row, name in enumerate(names):
        ours = slopes.change[name][:-1] * inputs.spreads[:, None]
        theirs = exact[row] * inputs.spreads[:, None]
        known = np.isfinite(theirs) & np.isfinite(ours)
        if not known.any():  # what absorbs no light needs endlessly much
            assert kind == 0
            assert name == "levitation_irradiance"
            continue
        size = np.max(np.abs(theirs[known]))
        # one-sided differences are off by the curvature
        rtol = 1e-3 if kind in (0, 1) else 1e-4
        np.testing.assert_allclose(ours[known], theirs[known], rtol=rtol, atol=1e-6 * size)
