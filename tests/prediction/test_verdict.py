"""Verdicts, against roots that SciPy finds on the functions of one place."""

import dataclasses
from functools import cache
from pathlib import Path

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.array.namespace import float64, within
from lightflyer.cli.commands.init import templates
from lightflyer.config.reader import design_of_text
from lightflyer.design.tables import evaluate
from lightflyer.prediction.text import _with_band, verdict_lines


@cache
def setup_of(kind):
    return design_of_text(templates()[kind].read(), Path(f"{kind}.toml")).setup


@cache
def predicted(kind):
    return lf.predict(setup_of(kind))


class Truth:
    """A setup at one place in some light."""

    def __init__(self, setup):
        self.setup = setup
        self.light = float(setup.environment.radiation.irradiance)

    def state(self, place, light):
        state = self.setup.environment.state(place)
        return tree.replace_at(lambda state: state.radiation.irradiance, state, np.float64(light))

    def lift(self, place, light=None):
        state = self.state(place, light or self.light)
        force = lf.lift(self.setup.flyer, state, self.setup.model)
        return float(force / lf.statics.weight(self.setup.flyer, state)) - 1.0

    def temperature(self, place, light=None):
        state = self.state(place, light or self.light)
        return float(lf.equilibrium(self.setup.flyer, state, self.setup.model).temperature)

    def payload(self, place):
        state = self.state(place, self.light)
        return float(lf.payload(self.setup.flyer, state, self.setup.model))

    def rest(self, low, high, light=None):
        return brentq(lambda place: self.lift(place, light), low, high, xtol=1e-3)


def bearing(setup, kelvin):
    """The setup with a film that bears a temperature."""
    film = dataclasses.replace(setup.flyer.film, highest_temperature=kelvin)
    return dataclasses.replace(setup, flyer=dataclasses.replace(setup.flyer, film=film))


@pytest.mark.parametrize(
    ("kind", "near", "shown"),
    [
        ("earth", (81e3, 90e3), ("75.5 km to 85.1 km", "573 K", "78.2 km", "1061 W/m²")),
        ("mars", (57e3, 75e3), ("47.7 km to 66.8 km", "421 K", "1081 W/m²")),
    ],
)
def test_rest_limit_and_light_are_roots(kind, near, shown):
    prediction, truth = predicted(kind), Truth(setup_of(kind))
    verdict, highest = prediction.verdict, 520.0
    assert verdict.highest_temperature == highest
    rest = truth.rest(*near)
    assert verdict.rest.coordinate == pytest.approx(rest, abs=0.1)
    assert verdict.rest.values["temperature"] == pytest.approx(truth.temperature(rest), abs=1e-3)
    assert verdict.survives == (truth.temperature(rest) < highest)

    def too_hot(light):
        return truth.temperature(truth.rest(near[0], 105e3, light), light) - highest

    strongest = brentq(too_hot, 1000.0, 1300.0, xtol=1e-3)
    assert verdict.strongest_light == pytest.approx(strongest, abs=0.05)
    ((low, high),) = verdict.usable
    assert low == verdict.lowest_release == prediction.bands[0][0]
    if verdict.survives:
        assert verdict.limit == "lift"
        assert verdict.best is prediction.best
    else:
        assert verdict.limit == "film"
        passed = brentq(lambda place: truth.temperature(place) - highest, 75e3, 85e3)
        assert high == pytest.approx(passed, abs=0.1)
        assert verdict.best.coordinate == pytest.approx(passed, abs=0.1)
        assert verdict.best.values["payload"] == pytest.approx(truth.payload(passed), rel=1e-4)
    lines = list(verdict_lines(prediction))
    assert len(lines) <= 6
    assert max(map(len, lines)) <= 80
    assert all(number in " ".join(lines) for number in shown)


def laden(setup, kilograms):
    return dataclasses.replace(setup, flyer=dataclasses.replace(setup.flyer, payload=kilograms))


def test_a_payload_keeps_a_disk_low_enough_for_its_film():
    """A disk of 5 mm melts at rest with 0.025 mg aboard, and not with 0.026 mg."""
    setup = setup_of("laden")
    empty = laden(setup, 0.0)
    verdict, truth = lf.predict(empty).verdict, Truth(empty)
    assert (verdict.survives, verdict.carries_afloat) == (False, True)
    passed = brentq(lambda place: truth.temperature(place) - 520.0, 77e3, 85e3)
    assert verdict.ballast[0] == pytest.approx(truth.payload(passed), rel=1e-4)
    assert verdict.ballast[1] == verdict.best.values["payload"]
    for share, survives in ((0.99, False), (1.01, True)):
        found = lf.predict(laden(setup, share * verdict.ballast[0])).verdict
        assert (found.survives, found.ballast is None) == (survives, survives)
    assert not lf.predict(laden(setup, 1.01 * verdict.ballast[1])).bands
    text = " ".join(str(lf.predict(empty)).split())
    assert "in up to 945.8 W/m², or with a payload of 0.0254 mg or more." in text
    assert "Afloat at 75.4 km it carries up to 0.0373 mg" in text


SWEPT = ("rest_temperature", "usable_lowest_altitude", "usable_highest_altitude", "usable_payload",
         "longest_night", "afloat_payload", "afloat_temperature")  # fmt: skip


@pytest.mark.parametrize("kind", ["earth", "laden", "mars"])
def test_sweeps_have_the_verdict(kind):
    """The search with derivatives finds what the search of predictions finds."""
    setup = setup_of(kind)
    verdict, best = predicted(kind).verdict, predicted(kind).best.values
    expected = (
        verdict.rest.values["temperature"], *verdict.usable[0], verdict.best.values["payload"],
        verdict.longest_night, best["payload"], best["temperature"],
    )  # fmt: skip
    with within():
        found, converged = evaluate(setup, SWEPT)
    assert converged
    for name, value in zip(SWEPT, expected, strict=True):
        assert float(found[name]) == pytest.approx(value, rel=1e-6), name
    places = np.array([0.5, 0.999, 1.001, 1.5]) * verdict.usable[0][1]
    with within():
        here, _ = evaluate(setup, ("usable",), places)
    inside = (places > verdict.usable[0][0]) & (places < verdict.usable[0][1])
    assert here["usable"].tolist() == inside.tolist()


def test_the_longest_night_is_that_of_a_descent():
    """Truth: SciPy's integration of the speed at which the flyer sinks without light."""
    setup = setup_of("earth")
    verdict = predicted("earth").verdict

    def speed(_, altitude):
        dark = lf.statics.in_the_dark(setup.environment.state(altitude[0]))
        return [-lf.statics.sinking_speed(setup.flyer, dark, setup.model)]

    def arrived(_, altitude):
        return altitude[0] - verdict.lowest_release

    arrived.terminal = True
    start = [verdict.rest.coordinate]
    descent = solve_ivp(speed, (0.0, 1e5), start, events=arrived, rtol=1e-8, max_step=600.0)
    assert verdict.longest_night == pytest.approx(descent.t[-1], rel=1e-5)
    assert predicted("balloon").verdict.longest_night is None  # its band begins below the search


@pytest.mark.slow
def test_the_verdict_of_sweeps_is_that_of_jax_and_has_derivatives(compiled):
    """By central differences, of an atmosphere and a model that compile soon."""
    disk = setup_of("earth").flyer

    def outputs(absorptance):
        film = dataclasses.replace(disk.film, absorptance=absorptance)
        flyer = dataclasses.replace(disk, film=film)
        return evaluate(lf.Setup(flyer, lf.lu2023_earth(), lf.FreeMolecular()), SWEPT)[0]

    step = 1e-3
    with within():
        above, here, below = (outputs(0.75 + change) for change in (step, 0.0, -step))
    with float64():
        values, slopes = compiled(lambda x: jax.jvp(outputs, (x,), (1.0,)))(0.75)
    for name in SWEPT:
        assert values[name] == pytest.approx(here[name], rel=1e-10), name
        slope = (above[name] - below[name]) / (2.0 * step)
        assert slopes[name] == pytest.approx(slope, rel=1e-3), name


def test_a_film_that_no_light_spares():
    verdict = lf.predict(bearing(setup_of("mars"), 200.0)).verdict
    assert (verdict.limit, verdict.usable, verdict.best) == ("film", [], None)
    assert (verdict.survives, verdict.strongest_light) == (False, 0.0)


def test_a_film_that_every_light_spares_within_the_search():
    setup = dataclasses.replace(setup_of("mars"), search_range=(40e3, 67e3))
    prediction = lf.predict(setup)
    assert (prediction.verdict.survives, prediction.verdict.strongest_light) == (True, np.inf)
    assert prediction.summary()["verdict"]["strongest_light_w_m2"] is None


def test_the_hotter_a_film_may_be_the_stronger_the_light():
    setup = setup_of("mars")
    limits = (300.0, 400.0, 500.0, 1000.0, 2000.0, 4900.0)
    found = [lf.predict(bearing(setup, limit)).verdict.strongest_light for limit in limits]
    assert np.all(np.diff(found) > 0.0)
    assert np.isfinite(found).all()


def test_without_flight_or_limit(disk):
    earth = lf.lu2023_earth()
    heavy = dataclasses.replace(disk, payload=1e-3)
    prediction = lf.predict(heavy, earth, lf.Lu2023())
    assert prediction.verdict.limit == "light"
    free = lf.predict(disk, earth, lf.Lu2023())
    most = f"; it carries at most {1e6 * free.best.values['payload']:.3f}"[:-2]
    assert "It does not fly: " in str(prediction)
    assert most in str(prediction).replace("\n", " ")
    assert free.verdict.usable == free.bands
    assert (free.verdict.survives, free.verdict.strongest_light) == (None, None)
    assert "its film's limit is not stated" in " ".join(str(free).split())


def test_a_chamber_has_a_film_limit_and_no_place_of_rest(disk):
    chamber = lf.Chamber(radiation=lf.environment.Radiation(1500.0))
    setup = bearing(lf.Setup(disk, chamber, lf.Lu2023()), 480.0)
    prediction, truth = lf.predict(setup), Truth(setup)
    verdict = prediction.verdict
    ((low, high),) = prediction.bands
    passed = brentq(lambda pressure: truth.temperature(pressure) - 480.0, low, high)
    np.testing.assert_allclose(verdict.usable, [(passed, high)], rtol=1e-5)
    assert verdict.rest is verdict.lowest_release is verdict.survives is None
    # the rows beyond the limit are marked, and no others
    found = lf.predict(setup, at=[0.9 * passed, 1.1 * passed])
    marked = [line.strip()[0] == "*" for line in str(found).splitlines() if "e+" not in line]
    assert sum(marked) == 2  # the row, and what its mark means


def test_a_range_that_ends_within_the_band_is_open():
    balloon = predicted("balloon")
    assert balloon.verdict.lowest_release is None
    assert balloon.verdict.rest.coordinate == balloon.bands[0][1]
    assert "from below 1.0 km to 19.5 km" in str(balloon)
    setup = dataclasses.replace(setup_of("mars"), search_range=(50e3, 60e3))
    cut = lf.predict(setup)
    assert (cut.verdict.rest, cut.verdict.strongest_light) == (None, None)
    assert "from below 50.0 km to above 60.0 km" in str(cut)


def test_random_designs_have_a_possible_verdict(rng):
    environments = [lf.lu2023_earth(), lf.Mars(), lf.Chamber()]
    limits = set()
    for number in range(30):
        density, absorptance, emittance = rng.uniform((2e-4, 0.3, 0.03), (2e-3, 0.95, 0.5))
        film = lf.FilmProperties(
            density, absorptance, emittance, emittance, tac_top=0.75, tac_bottom=0.95,
            highest_temperature=rng.uniform(250.0, 900.0),
        )  # fmt: skip
        disk = lf.Disk(film, radius=10.0 ** rng.uniform(-3.5, -1.0))
        prediction = lf.predict(disk, environments[number % 3], lf.Lu2023())
        verdict, highest = prediction.verdict, float(film.highest_temperature)
        limits.add((number % 3, verdict.limit))
        assert (verdict.limit == "light") == (not prediction.bands)
        for low, high in verdict.usable:
            assert any(start <= low <= high <= end for start, end in prediction.bands)
        if verdict.best is not None:
            assert verdict.best.values["temperature"] <= highest * (1.0 + 1e-6)
            assert 0.0 <= verdict.best.values["payload"] <= prediction.best.values["payload"]
        if verdict.rest is not None:
            assert verdict.rest.values["lift_over_weight"] == pytest.approx(1.0, abs=1e-4)
            assert verdict.survives == (verdict.strongest_light >= prediction.available)
        lines = list(verdict_lines(prediction))
        assert len(lines) <= 6
        assert max(map(len, lines)) <= 160  # two lines of a terminal
    assert limits >= {(place, limit) for place in range(2) for limit in ("light", "film", "lift")}


def test_a_flyer_of_two_films_survives_what_both_bear():
    films = [
        lf.FilmProperties(
            3e-4, absorptance, 0.1, 0.1, tac_top=0.8, tac_bottom=0.8,
            transmittance=0.9 - absorptance, highest_temperature=limit,
        )
        for absorptance, limit in ((0.02, 450.0), (0.6, 480.0))
    ]  # fmt: skip
    sandwich = lf.Sandwich(*films, 0.01, 1e-4, 0.5, 5e-5, 1e-4, 1.8)
    assert sandwich.highest_temperature == 450.0
    verdict = lf.predict(sandwich, lf.Earth(), lf.Schafer2025()).verdict
    assert verdict.highest_temperature == 450.0
    place = verdict.usable[-1][1]
    state = lf.Earth().state(place)
    hottest = lf.equilibrium(sandwich, state, lf.Schafer2025()).temperature
    assert hottest == pytest.approx(450.0, abs=1e-3)


def test_the_verdict_says_what_the_force_model_covers():
    """Truth: the ratio of temperatures, which lu2023 was fitted up to, and SciPy's root."""
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.75, tac_bottom=0.95)
    disk, earth, model = lf.Disk(film, 0.01), lf.Earth(), lf.Lu2023()

    def beyond(altitude):
        state = earth.state(altitude)
        return float(lf.equilibrium(disk, state, model).temperature / state.temperature) - 1.8

    prediction = lf.predict(disk, earth, model)
    ((low, high),), (covered,) = prediction.bands, prediction.verdict.covered
    assert covered[0] == low
    assert covered[1] == pytest.approx(brentq(beyond, low, high), abs=5.0)
    best = prediction.verdict.best_covered
    assert low < covered[1] < prediction.best.coordinate
    assert best.coordinate == covered[1]
    assert best.values["payload"] < prediction.best.values["payload"]
    assert "which covers it from" in str(prediction)
    assert "~" in str(prediction)
    known = lf.predict(disk, earth, lf.Lu2023(c_fm=0.41))  # of those who fitted them
    assert known.verdict.covered == known.bands
    assert known.verdict.best_covered is None


@pytest.mark.parametrize(
    ("value", "told"),
    [(0.04408, "0.04 mg"), (0.62, "0.6 mg"), (0.0, "0.0 mg"), (-0.021, "-0.02 mg")],
)
def test_a_small_value_in_a_wide_band_keeps_its_first_digit(value, told):
    assert _with_band(value, (-0.4, 0.5), ".3g", "mg") == f"{told} (-0.4 to 0.5)"
