"""Optima beside fine grids and SciPy's optimisers, and their sensitivities."""

import numpy as np
import numpy_model
import pytest
from scipy.optimize import brentq, differential_evolution, minimize, minimize_scalar

import lightflyer as lf
from lightflyer.files.result_text import as_text
from lightflyer.search import optimiser
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.problem import as_problem
from lightflyer.search.text import design_parts

from ..conftest import FILM

DIAMETER = {"from": "0.5 cm", "to": "5 cm", "scale": "log"}
ALTITUDE = {"from": "60 km", "to": "90 km"}


LAYERED = {
    "layers": [
        {"material": "PET", "thickness": "500 nm"},
        {"material": "Ge", "thickness": "20 nm"},
    ]
}


def problem(flyer, points=64, **asked):
    return as_problem(flyer, None, None, points=points, **asked)


@pytest.fixture(scope="module")
def payload(flyer):
    over = {"flyer.diameter": DIAMETER, "altitude": ALTITUDE}
    return lf.optimise(flyer, maximise="payload", over=over, beyond_range=True)


COOL = {
    "beyond_range": True,  # the model's equations are what is compared here, wherever they hold
    "maximise": "payload",
    "over": {
        "flyer.diameter": DIAMETER,
        "altitude": ALTITUDE,
        "film.areal_density": {"from": "0.5 g/m^2", "to": "2 g/m^2"},
    },
    "constraints": {
        "temperature": {"at_most": "330 K"},
        "areal_density": {"at_least": "0.8 g/m^2"},
    },
}


@pytest.fixture(scope="module")
def cool(flyer):
    """The heaviest payload that a disk below 330 K carries."""
    return lf.optimise(flyer, **COOL)


def disk_of(diameter, altitude, areal_density=1e-3, tac_bottom=0.9):
    """Payload and temperature of a disk by the equations in plain NumPy."""
    air = lf.environment.Lu2023Atmosphere()
    pressure, cold = float(air.pressure(altitude)), float(air.temperature(altitude))
    radius = 0.5 * diameter
    area = np.pi * radius**2

    def imbalance(hot):
        lost = numpy_model.lost_power(hot, cold, pressure, radius, 0.5 * (0.8 + tac_bottom), 0.08)
        return lost / (0.75 * 1360.0 * area) - 1.0

    hot = brentq(imbalance, cold + 1e-6, 3000.0, xtol=1e-10, rtol=1e-14)
    lift = numpy_model.force(hot, cold, pressure, radius, 0.8, tac_bottom)
    return lift / numpy_model.GRAVITY - area * areal_density, hot


def heaviest_below(temperature, tac_bottom=0.9):
    """Largest payload of a disk of 0.8 g/m² at a temperature, its diameter and its altitude."""

    def diameter_at(altitude):
        return brentq(
            lambda d: disk_of(d, altitude, 0.8e-3, tac_bottom)[1] - temperature, 5e-3, 5e-2,
            xtol=1e-12, rtol=1e-14,
        )  # fmt: skip

    found = minimize_scalar(
        lambda altitude: -disk_of(diameter_at(altitude), altitude, 0.8e-3, tac_bottom)[0] * 1e7,
        bounds=(67e3, 70e3), method="bounded", options={"xatol": 1e-4},
    )  # fmt: skip
    return -found.fun * 1e-7, diameter_at(found.x), found.x


def test_the_heaviest_payload_is_scipys(payload):
    found = minimize(
        lambda x: -1e7 * disk_of(np.exp(x[0]), 1e3 * x[1])[0], [np.log(0.03), 73.0],
        method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-14},
    )  # fmt: skip
    assert payload.value == pytest.approx(-1e-7 * found.fun, rel=1e-9)
    assert payload.design["flyer.diameter"] == pytest.approx(np.exp(found.x[0]), rel=1e-4)
    assert payload.design["altitude"] == pytest.approx(1e3 * found.x[1], rel=1e-5)
    assert payload.agreeing == payload.starts
    assert not payload.active_bounds


def test_the_coolest_is_scipys_on_both_limits(cool):
    value, diameter, altitude = heaviest_below(330.0)
    assert cool.value == pytest.approx(value, rel=1e-6)
    assert cool.design["flyer.diameter"] == pytest.approx(diameter, rel=1e-4)
    assert cool.design["altitude"] == pytest.approx(altitude, rel=1e-5)
    assert cool.outputs["temperature"] == pytest.approx(330.0, abs=1e-3)
    assert cool.design["film.areal_density"] == pytest.approx(0.8e-3, rel=1e-6)
    assert set(cool.active_constraints) == {"temperature", "areal_density"}


def test_multipliers_and_elasticities_are_slopes_of_scipys_optimum(cool):
    above, below = (heaviest_below(330.0 + shift)[0] for shift in (0.1, -0.1))
    assert cool.active_constraints["temperature"] == pytest.approx((above - below) / 0.2, rel=1e-4)
    above, below = (heaviest_below(330.0, 0.9 * share)[0] for share in (1.0001, 0.9999))
    slope = (above - below) / (2e-4 * cool.value)
    assert cool.elasticities["film.tac_bottom"] == pytest.approx(slope, rel=1e-4)
    sizes = [abs(size) for size in cool.elasticities.values()]
    assert sizes == pytest.approx(sorted(sizes, reverse=True), rel=1e-5)
    same = ["environment.irradiance", "film.absorptance"]  # both scale the light
    first, second = (cool.elasticities[name] for name in same)
    assert first == pytest.approx(second, rel=1e-9)
    assert [name for name in cool.elasticities if name in same] == same  # whatever the rounding


def test_scipys_differential_evolution_finds_nothing_better(cool):
    function = ObjectiveFunction(cool.problem)

    def loss(points):
        scores = function.scores_of_many(points.T)
        return -1e7 * scores[:, 0] + 1e4 * np.maximum(-scores[:, 1:], 0.0).sum(axis=1)

    found = differential_evolution(
        loss, [(0.0, 1.0)] * 3, rng=3, vectorized=True, updating="deferred", polish=False,
        maxiter=300, tol=1e-12,
    )  # fmt: skip
    assert -1e-7 * found.fun == pytest.approx(cool.value, rel=1e-5)
    assert -1e-7 * found.fun <= cool.value * (1.0 + 1e-6)


def grid(outputs, diameter, altitude):
    """A fine grid by the package's plain functions."""
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, 0.9)
    diameter, altitude = np.meshgrid(diameter, altitude, indexing="ij")
    state = lf.lu2023_earth().state(altitude)
    return [
        getattr(lf, name)(lf.Disk(film, 0.5 * diameter), state, lf.Lu2023()) for name in outputs
    ]


def test_the_least_irradiance_is_at_a_bound(flyer):
    found = lf.optimise(
        flyer,
        minimise="levitation_irradiance",
        over={"flyer.diameter": DIAMETER, "altitude": ALTITUDE},
        beyond_range=True,
    )
    assert "the diameter [m] is 0.005" in found.warnings[0]
    (levitation,) = grid(["levitate"], np.array([0.005]), np.linspace(60e3, 80e3, 20001))
    assert found.value == pytest.approx(levitation.irradiance.min(), rel=1e-6)
    assert found.active_bounds == {"flyer.diameter": "low"}
    assert found.agreeing > 1


def test_a_front_is_that_of_a_fine_grid(flyer, payload):
    front = lf.pareto(
        flyer,
        maximise="payload",
        minimise="levitation_irradiance",
        over={"flyer.diameter": DIAMETER, "altitude": ALTITUDE},
        population=50,
        generations=40,
    )
    carried, light = front.objectives["payload"], front.objectives["levitation_irradiance"]
    better = (carried[:, None] >= carried) & (light[:, None] <= light)
    np.fill_diagonal(better, val=False)
    assert not better.any()
    assert carried.max() == pytest.approx(payload.value, rel=0.01)
    masses, levitation = grid(
        ["payload", "levitate"], np.geomspace(0.005, 0.05, 100), np.linspace(60e3, 90e3, 200)
    )
    for limit in (800.0, 1000.0):
        most = masses[levitation.irradiance <= limit].max()
        assert np.interp(limit, np.sort(light), np.sort(carried)) == pytest.approx(most, rel=0.02)


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
        asked_problem = problem(
            flyer, maximise="payload", over=over, uncertainty=asked, constraints=likely
        )
        bounds, samples = asked_problem.bounds, asked_problem.samples
        point = np.array([bounds[0].fraction(diameter), bounds[1].fraction(altitude)])
        found = ObjectiveFunction(asked_problem).outputs_at(point)
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
    uncertain = lf.FlyerFile(
        flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023", "force_error": 0}
    )
    asked = {"maximise": "payload", "over": {"altitude": ALTITUDE}, "uncertainty": {"of": "mean"}}
    assert set(problem(uncertain, **asked).samples) == {"film.tac_top", "film.emittance"}
    with pytest.raises(lf.ConfigurationError, match="no number is uncertain"):
        problem(flyer, **asked)


def test_limits_that_cannot_be_kept_are_reported(flyer):
    with pytest.raises(
        lf.LightflyerError, match="constraints; the best violates that of temperature"
    ):
        lf.optimise(
            flyer,
            maximise="payload",
            over={"altitude": ALTITUDE},
            constraints={"temperature": {"at_most": "200 K"}},
        )


ASKED = {"maximise": "payload", "over": {"altitude": ALTITUDE}}
MISTAKES = [
    ({"maximise": None}, "needs maximise or minimise"),
    ({"over": None}, "needs over with at least one free number"),
    ({"maximise": "paylod"}, 'did you mean "payload"'),
    ({"over": {"flyer.diameter": DIAMETER}}, '"payload" needs altitude'),
    ({"over": {"altitude": ALTITUDE | {"points": 3}}}, "points is not part of a range"),
    ({"over": {"altitude": ["60 km", "70 km"]}}, "is a list"),
    ({"constraints": {"lift": 3}}, "is not a limit"),
    (
        {"constraints": {"temperature": {"at_most": "4 kg"}}},
        'temperature: at_most: "4 kg": unit "kg" is of the wrong kind',
    ),
    ({"maximise": "probability_of_flying"}, "probability_of_flying needs"),
]


@pytest.mark.parametrize(("section", "message"), MISTAKES)
def test_mistakes_are_said(flyer, section, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        problem(flyer, **{key: one for key, one in (ASKED | section).items() if one is not None})


def test_what_else_cannot_be_asked(flyer, payload):
    porous = [LAYERED["layers"][0], {"material": "Ge", "thickness": "20 nm", "porosity": 0.1}]
    layered = lf.FlyerFile(flyer={"diameter": "2 cm"}, film={"layers": porous, "tac_bottom": 0.9})
    pores = {"film.layers.1.porosity": {"from": 0.1, "to": 0.5}, "altitude": "70 km"}
    with pytest.raises(lf.ConfigurationError, match="porosity changes the index of a layer"):
        problem(layered, maximise="payload", over=pores)
    with pytest.raises(lf.ParameterError, match="already states"):
        lf.optimise(payload.problem, maximise="payload")
    both = {"maximise": "payload", "minimise": "temperature", "over": {"altitude": ALTITUDE}}
    with pytest.raises(lf.ConfigurationError, match="several objectives"):
        lf.optimise(flyer, **both)
    with pytest.raises(lf.ConfigurationError, match=r"starts = 0: must be at least 1"):
        lf.optimise(flyer, **both, starts=0)


@pytest.mark.parametrize("asked", [{"maximise": "payload"}, {"minimise": "temperature"}])
def test_a_free_number_without_effect_is_refused(flyer, asked):
    over = {"flyer.payload": {"from": "0 mg", "to": "1 mg"}, "altitude": ALTITUDE}
    said = f"flyer.payload is free and has no effect on {next(iter(asked.values()))}"
    with pytest.raises(lf.ConfigurationError, match=said):
        lf.optimise(flyer, over=over, beyond_range=True, **asked)
    with pytest.raises(lf.ConfigurationError, match="no effect on payload or relative_payload"):
        lf.search.pareto(flyer, maximise=["payload", "relative_payload"], over=over)


def test_what_is_out_of_range_is_said_beside_what_is_within():
    """The fit of lu2023 holds for 2 to 4 cm, and no mylar bears 700 K."""
    over = {"flyer.diameter": {"from": "2 cm", "to": "30 cm"}, "altitude": ALTITUDE}
    wide = {"maximise": "payload", "over": over, "starts": 2}
    film = FILM | {"areal_density": "0.1 g/m^2"}
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})
    best = lf.optimise(flyer, **wide)
    assert any("the diameter [m]" in text for text in best.warnings)
    assert best.summary()["warnings"] == list(best.warnings)
    (within,) = best.rivals
    assert within.words == "the best of 512 designs within the force model's range"
    assert 0.02 <= within.design["flyer.diameter"] <= 0.05
    assert within.value < best.value
    there = lf.sweep(
        flyer, over={name: f"{value} m" for name, value in within.design.items()},
        outputs=["payload"],
    )  # fmt: skip
    assert float(there.payload) == pytest.approx(within.value, rel=1e-9)
    assert "within the force model's range: payload" in str(best).replace("\n", " ")
    assert not lf.optimise(flyer, **wide, beyond_range=True).rivals


def test_one_best_payload_is_told_and_another_only_with_the_limit_that_forbids_it(
    flyer, payload, cool
):
    assert "carr" not in as_text(design_parts(payload))
    altitude = {"from": "60 km", "to": "90 km", "points": 3001}
    over = {name: f"{value} m" for name, value in cool.design.items() if name == "flyer.diameter"}
    over |= {"film.areal_density": f"{cool.design['film.areal_density']} kg/m^2"}
    there = lf.sweep(flyer, over=over | {"altitude": altitude}, outputs=["payload", "temperature"])
    there = there.squeeze()
    best = there.isel(altitude=int(there.payload.argmax("altitude")))
    told = " ".join(as_text(design_parts(cool)).split())
    assert float(best.payload) > 1.1 * cool.value
    assert (
        "Without the study's limit of temperature it would carry up to "
        f"{float(best.payload) * 1e6:.3g} mg: at {float(best.altitude) / 1e3:.3g} km and "
        f"{float(best.temperature):.0f} K."
    ) in told


def test_a_film_gets_no_hotter_than_it_bears():
    film = FILM | {"highest_temperature": "370 K"}
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})
    over = {"altitude": {"from": "65 km", "to": "90 km"}}
    hot = lf.optimise(flyer, maximise="lift_over_weight", over=over, starts=2, beyond_range=True)
    cool = lf.optimise(flyer, maximise="lift_over_weight", over=over, starts=2)
    assert any("its film withstands 370 K" in text for text in hot.warnings)
    assert cool.outputs["temperature"] == pytest.approx(370.0, rel=1e-6)
    assert cool.value < hot.value
    (rival,) = cool.rivals
    assert rival.words == "whatever the film withstands"
    assert rival.value == pytest.approx(hot.value, rel=1e-6)
    assert rival.design["altitude"] == pytest.approx(hot.design["altitude"], rel=1e-4)
    assert all("does not lift its weight" in text for text in cool.warnings)


@pytest.fixture
def few_looked_at(monkeypatch):
    """A search begins with a few designs, and looks for no rivals."""
    monkeypatch.setattr(optimiser, "SCREENED", 32)
    monkeypatch.setattr(optimiser, "rivals_of", lambda *_: ())


@pytest.mark.usefixtures("few_looked_at")
def test_a_search_answers_though_no_film_is_cool_enough():
    """Empty disks of any size come to rest hotter than 520 K; laden ones need not."""
    film = FILM | {"highest_temperature": "520 K"}
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "free-molecular"})
    over = {"flyer.diameter": {"from": "0.5 cm", "to": "2 cm"}}
    found = lf.optimise(flyer, maximise="highest_altitude", over=over, starts=1)
    assert any("as cool as it must be" in text for text in found.warnings)
    (limit,) = found.problem.constraints
    assert (limit.name, limit.of_film) == ("rest_temperature", True)
    assert 520.0 < found.outputs["rest_temperature"] < 700.0
    assert found.outputs["rest_temperature"] == pytest.approx(
        found.prediction.verdict.rest.values["temperature"], rel=1e-6
    )
    afloat = problem(flyer, maximise="afloat_payload", over=over)
    assert [part.name for part in afloat.constraints] == ["afloat_temperature"]
    assert not problem(flyer, maximise="usable_payload", over=over).constraints
    limits = {"temperature": {"at_least": "400 K", "at_most": "390 K"}}
    with pytest.raises(lf.ConfigurationError, match="at_least is above at_most"):
        problem(flyer, maximise="payload", over={"altitude": ALTITUDE}, constraints=limits)


@pytest.mark.usefixtures("few_looked_at")
def test_a_quantile_is_taken_on_the_worse_side():
    """Of 95 % of the samples the temperature is below the limit, not of 5 %."""
    film = FILM | {"absorptance": "0.75 ± 0.02", "emittance": "0.08 ± 0.004"}
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})
    asked = problem(
        flyer,
        points=512,
        maximise="payload",
        over={"altitude": {"from": "66 km", "to": "80 km"}},
        constraints={"temperature": {"at_most": "400 K"}},
        uncertainty={"of": "quantile", "quantile": 0.05},
        starts=2,
    )
    best = lf.optimise(asked)
    hot = lf.sweep(
        flyer,
        over={"altitude": f"{best.design['altitude']} m", "film.absorptance": "0.75 ± 0.02",
              "film.emittance": "0.08 ± 0.004"},
        outputs=["temperature"],
        points=2048,
    ).temperature.values  # fmt: skip
    assert np.mean(hot < 400.0) == pytest.approx(0.95, abs=0.01)


def test_a_best_design_that_does_not_fly_is_named(flyer):
    film = FILM | {"tac_top": 0.9, "tac_bottom": 0.9}
    grounded = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, force={"model": "lu2023"})
    asked = {"maximise": "payload", "over": {"altitude": ALTITUDE}, "beyond_range": True}
    words = "the best design does not lift its weight"
    assert any(words in text for text in lf.optimise(grounded, **asked).warnings)
    assert not any(words in text for text in lf.optimise(flyer, **asked).warnings)


def test_optical_data_that_end_refuse_no_design():
    """Every film of layers lacks some: the result has the warning."""
    layers = [
        {"material": "PET", "thickness": "500 nm"},
        {"material": "Ge", "thickness": "12 nm"},
    ]
    layered = lf.FlyerFile(
        flyer={"diameter": "2 cm"}, film={"layers": layers}, force={"model": "lu2023"}
    )
    found = lf.optimise(layered, maximise="payload", over={"altitude": ALTITUDE})
    assert any("is computed from data for" in text for text in found.warnings)
    assert found.value > 0.0
