"""Optima beside fine grids and SciPy's global search, and what is said about them."""

import dataclasses

import numpy as np
import pytest
from scipy.optimize import differential_evolution

import lightflyer as lf
from lightflyer.search.objectives import Landscape
from lightflyer.search.optimiser import optimise, pareto
from lightflyer.search.problem import make_problem
from lightflyer.sweeps.sections import OptimiseSection, SamplingSection

FILM = {
    "areal_density": "1 g/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}
DIAMETER = {"from": "0.5 cm", "to": "5 cm", "scale": "log"}
ALTITUDE = {"from": "60 km", "to": "90 km"}


@pytest.fixture(scope="module")
def flyer():
    return lf.FlyerFile(flyer={"diameter": "2 cm"}, film=FILM, environment={"atmosphere": "lu2023"})


def problem(flyer, points=64, **section):
    return make_problem(
        flyer, OptimiseSection.model_validate(section), SamplingSection(points=points)
    )


@pytest.fixture(scope="module")
def payload(flyer):
    asked = problem(flyer, maximise="payload", over={"flyer.diameter": DIAMETER,
                                                     "altitude": ALTITUDE})  # fmt: skip
    return optimise(asked)


@pytest.fixture(scope="module")
def cool(flyer):
    """As heavy a payload as a disk below 330 K carries."""
    over = {"flyer.diameter": DIAMETER, "altitude": ALTITUDE}
    limits = {"temperature": {"at_most": "330 K"}, "areal_density": {"at_least": "0.8 g/m^2"}}
    over |= {"film.areal_density": {"from": "0.5 g/m^2", "to": "2 g/m^2"}}
    return optimise(problem(flyer, maximise="payload", over=over, constraints=limits))


def grid(flyer, outputs, **ranges):
    """A fine grid by the package's plain functions."""
    axes = np.meshgrid(*ranges.values(), indexing="ij", sparse=False)
    values = dict(zip(ranges, axes, strict=True))
    film = lf.FilmProperties(values.get("areal_density", 1e-3), 0.75, 0.08, 0.08, 0.8, 0.9)
    disk = lf.Disk(film, 0.5 * values["diameter"])
    state = lf.lu2023_earth().state(values["altitude"])
    return [getattr(lf, name)(disk, state, lf.Lu2023()) for name in outputs]


def test_the_heaviest_payload_is_that_of_a_fine_grid(flyer, payload):
    (found,) = grid(
        flyer,
        ["payload"],
        diameter=np.geomspace(0.02, 0.05, 400),
        altitude=np.linspace(70e3, 80e3, 500),
    )
    assert payload.value == pytest.approx(found.max(), rel=1e-4)
    assert payload.value >= found.max()
    assert payload.value == pytest.approx(0.3e-6, rel=0.2)  # the paper: 0.21 mg, see physics
    assert payload.agreeing == payload.starts
    assert not payload.active_bounds


def test_the_coolest_is_that_of_a_fine_grid(flyer, cool):
    def best(**ranges):
        payloads, balance = grid(
            flyer, ["payload", "equilibrium"], areal_density=np.array([0.8e-3, 0.9e-3]), **ranges
        )
        return np.where(balance.temperature <= 330.0, payloads, -np.inf).max()

    coarse = best(diameter=np.geomspace(0.005, 0.05, 150), altitude=np.linspace(55e3, 90e3, 200))
    fine = best(
        diameter=cool.design["flyer.diameter"] * np.linspace(0.98, 1.02, 300),
        altitude=cool.design["altitude"] + np.linspace(-300.0, 300.0, 400),
    )
    assert coarse <= fine
    assert cool.value == pytest.approx(fine, rel=1e-4)
    assert cool.outputs["temperature"] == pytest.approx(330.0, abs=1e-3)
    assert cool.design["film.areal_density"] == pytest.approx(0.8e-3, rel=1e-6)
    assert set(cool.active_constraints) == {"temperature", "areal_density"}


def test_the_least_irradiance_is_that_of_a_fine_grid_and_at_a_bound(flyer):
    over = {"flyer.diameter": DIAMETER, "altitude": ALTITUDE}
    found = optimise(problem(flyer, minimise="levitation_irradiance", over=over))
    (levitation,) = grid(
        flyer, ["levitate"], diameter=np.array([0.005]), altitude=np.linspace(60e3, 80e3, 20001)
    )
    assert found.value == pytest.approx(levitation.irradiance.min(), rel=1e-6)
    assert found.active_bounds == {"flyer.diameter": "low"}
    assert found.agreeing > 1


def test_scipys_differential_evolution_finds_nothing_better(cool):
    landscape = Landscape(cool.problem)

    def lost(places):
        gains = landscape.many(places.T)
        return -gains[:, 0] + 1e-3 * np.maximum(-gains[:, 1:], 0.0).sum(axis=1)

    found = differential_evolution(
        lost, [(0.0, 1.0)] * 3, rng=3, vectorized=True, updating="deferred", polish=False,
        maxiter=150, tol=1e-10,
    )  # fmt: skip
    assert -found.fun == pytest.approx(cool.value, rel=1e-4)


def test_multipliers_are_what_a_looser_limit_gains(flyer, cool):
    over = {
        "flyer.diameter": DIAMETER,
        "altitude": ALTITUDE,
        "film.areal_density": {"from": "0.5 g/m^2", "to": "2 g/m^2"},
    }
    limits = {"temperature": {"at_most": "330.5 K"}, "areal_density": {"at_least": "0.8 g/m^2"}}
    looser = optimise(problem(flyer, maximise="payload", over=over, constraints=limits))
    # the multiplier is the gain for each unit by which the limit is loosened
    gained = (looser.value - cool.value) / 0.5
    assert cool.active_constraints["temperature"] == pytest.approx(gained, rel=0.02)


def test_elasticities_are_those_of_the_optimum_itself(flyer, cool):
    """Against the optimum of a flyer file with 0.01 % more of one number."""
    film = flyer.film.model_copy(update={"tac_bottom": lf.Measured(1.0001 * 0.9)})
    changed = flyer.model_copy(update={"film": film})
    moved = optimise(dataclasses.replace(cool.problem, configuration=changed))
    slope = (moved.value / cool.value - 1.0) / 1e-4
    assert cool.elasticities["film.tac_bottom"] == pytest.approx(slope, rel=5e-3)


def test_a_quantile_and_the_mean_are_those_of_the_samples(flyer):
    over = {
        "flyer.diameter": DIAMETER,
        "altitude": ALTITUDE,
        "film.tac_top": "0.80 ± 0.01",
        "film.tac_bottom": "0.90 ± 0.01",
    }
    likely = {"probability_of_flying": {"at_least": 0.5}}
    diameter, altitude = 0.02, 73.5e3
    for asked in ({"of": "mean"}, {"of": "quantile", "quantile": 0.1}):
        landscape = Landscape(
            problem(flyer, maximise="payload", over=over, uncertainty=asked, constraints=likely)
        )
        bounds = landscape.problem.bounds
        place = np.array([bounds[0].way(diameter), bounds[1].way(altitude)])
        found = landscape.named(place)
        samples = landscape.problem.samples
        film = lf.FilmProperties(
            1e-3, 0.75, 0.08, 0.08, samples["film.tac_top"], samples["film.tac_bottom"]
        )
        state = lf.lu2023_earth().state(altitude)
        each = lf.payload(lf.Disk(film, 0.5 * diameter), state, lf.Lu2023())
        expected = np.mean(each) if asked["of"] == "mean" else np.quantile(each, 0.1)
        assert float(found["payload"]) == pytest.approx(float(expected), rel=1e-9)
        # a kernel estimate of the share, so that it has a derivative
        share = float(np.mean(each > 0.0))
        assert float(found["probability_of_flying"]) == pytest.approx(share, abs=0.05)


def test_the_flyer_files_own_uncertainties_are_used(flyer):
    film = FILM | {"tac_top": "0.80 ± 0.01", "emittance": "0.08 ± 0.01"}
    uncertain = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film)
    asked = problem(uncertain, maximise="payload", over={"altitude": ALTITUDE},
                    uncertainty={"of": "mean"})  # fmt: skip
    assert set(asked.samples) == {"film.tac_top", "film.emittance"}
    with pytest.raises(lf.ConfigurationError, match="nothing is uncertain"):
        problem(flyer, maximise="payload", over={"altitude": ALTITUDE},
                uncertainty={"of": "mean"})  # fmt: skip


def test_what_cannot_be_kept_is_said(flyer):
    asked = problem(
        flyer,
        maximise="payload",
        over={"altitude": ALTITUDE},
        constraints={"temperature": {"at_most": "200 K"}},
    )
    with pytest.raises(lf.LightflyerError, match="no design keeps the constraints"):
        optimise(asked)


def test_a_front_is_bounded_by_the_optima_of_its_objectives(flyer, payload):
    over = {"flyer.diameter": DIAMETER, "altitude": ALTITUDE}
    asked = problem(flyer, maximise="payload", minimise="levitation_irradiance", over=over)
    front = pareto(asked, population=50, generations=40)
    carried, light = front.objectives["payload"], front.objectives["levitation_irradiance"]
    better = (carried[:, None] >= carried) & (light[:, None] <= light)
    np.fill_diagonal(better, val=False)
    assert not better.any()
    assert carried.max() == pytest.approx(payload.value, rel=0.02)
    limits = {"levitation_irradiance": {"at_most": "800 W/m^2"}}
    limited = optimise(problem(flyer, maximise="payload", over=over, constraints=limits))
    assert np.interp(800.0, np.sort(light), np.sort(carried)) == pytest.approx(
        limited.value, rel=0.02
    )


MISTAKES = [
    ({"over": {"altitude": ALTITUDE}}, "needs maximise or minimise"),
    ({"maximise": "payload"}, "needs .optimise.over."),
    ({"maximise": "paylod", "over": {"altitude": ALTITUDE}}, 'did you mean "payload"'),
    ({"maximise": "payload", "over": {"flyer.diameter": DIAMETER}}, '"payload" needs altitude'),
    (
        {"maximise": "payload", "over": {"altitude": ALTITUDE | {"points": 3}}},
        "points is not part of a range",
    ),
    ({"maximise": "payload", "over": {"altitude": ["60 km", "70 km"]}}, "is a list"),
    (
        {"maximise": "payload", "over": {"altitude": ALTITUDE}, "constraints": {"lift": 3}},
        "is not such as",
    ),
    (
        {
            "maximise": "payload",
            "over": {"altitude": ALTITUDE},
            "constraints": {"temperature": {"at_most": "4 kg"}},
        },
        'temperature: at_most: "4 kg": unit "kg" is of the wrong kind',
    ),
    (
        {"maximise": "probability_of_flying", "over": {"altitude": ALTITUDE}},
        "probability_of_flying needs",
    ),
]


@pytest.mark.parametrize(("section", "message"), MISTAKES)
def test_mistakes_are_said(flyer, section, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        problem(flyer, **section)
