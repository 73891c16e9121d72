"""Free thicknesses: films on the coarse grid beside full ones, optima beside other optimisers."""

import jax
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import lightflyer as lf
from lightflyer.film.family import Family, padded_thickness
from lightflyer.foundation.precision import float64
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.optimiser import find_optimum
from lightflyer.search.problem import as_problem

LAYERS = [
    {"material": "Al2O3", "thickness": "20 nm"},
    {"material": "PET", "thickness": "500 nm"},
    {"material": "Ge", "thickness": "15 nm"},
]
MYLAR, GERMANIUM = "film.layers.1.thickness", "film.layers.2.thickness"
WITHIN = {"from": "3 nm", "to": "40 nm", "scale": "log"}
ALTITUDE = 75e3


@pytest.fixture(scope="module")
def flyer():
    film = {"layers": LAYERS, "tac_top": 0.79, "tac_bottom": 0.90}  # without ±
    return lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film)


@pytest.fixture(scope="module")
def function(flyer):
    over = {GERMANIUM: WITHIN, MYLAR: {"from": "500 nm", "to": "800 nm"}, "altitude": "75 km"}
    return ObjectiveFunction(as_problem(flyer, None, None, maximise="payload", over=over, starts=2))


@pytest.fixture(scope="module")
def best(function):
    return find_optimum(function)


@pytest.fixture(scope="module")
def film(flyer):
    return flyer.film.film()


@pytest.fixture(scope="module")
def family(film):
    return Family.of(film, layers=5)


def exact_payload(flyer, thickness, name=GERMANIUM):
    """Payload with the film computed in full, by no part of the search."""
    setup = flyer.design().build({name: float(thickness)})
    return float(lf.payload(setup.flyer, setup.environment.state(ALTITUDE), setup.model))


def test_the_coarse_grid_is_near_the_full_one(film, family):
    """Also with layers that are not there."""
    thickness = padded_thickness(film.thickness, 5)
    with float64():
        found = jax.jit(lambda one: one.properties(thickness, 0.3))(family)
    light = lf.film.light_shares(film, incidence=0.3)
    below = lf.film.light_shares(film, side="bottom", diffuse=True)
    assert float(found["absorptance"]) == pytest.approx(light.absorptance.value, rel=3e-3)
    assert float(found["transmittance"]) == pytest.approx(light.transmittance.value, rel=3e-3)
    assert float(found["absorptance_bottom"]) == pytest.approx(below.absorptance.value, rel=3e-3)
    for side in ("top", "bottom"):
        curve = lf.film.emittance_curve(film, side)
        temperatures = np.array([200.0, 300.0, 450.0])
        with float64():
            coarse, full = found[f"emittance_{side}"](temperatures), curve(temperatures)
        np.testing.assert_allclose(coarse, full, rtol=4e-3)


def test_an_optimum_is_that_of_films_computed_in_full(flyer, best):
    """Beside SciPy's bounded search, which knows neither the coarse grid nor gradients."""
    found = minimize_scalar(
        lambda thickness: -exact_payload(flyer, thickness * 1e-9),
        bounds=(3.0, 40.0), method="bounded", options={"xatol": 1e-2},
    )  # fmt: skip
    assert best.value == pytest.approx(-found.fun, rel=1e-6)
    assert best.value == pytest.approx(exact_payload(flyer, best.design[GERMANIUM]), rel=1e-12)
    assert best.design[GERMANIUM] == pytest.approx(found.x * 1e-9, rel=5e-3)
    assert best.active_bounds == {MYLAR: "low"}
    assert best.agreeing == best.starts


def test_what_is_said_is_of_the_best_film(flyer, best):
    """Bounds that missing data leave are those of the optimum, not of the flyer file's film."""
    said = flyer.design().warnings_for(best.design)
    assert set(said) <= set(best.warnings)
    assert not set(flyer.design().warnings) & set(best.warnings)


def test_what_errors_of_a_thickness_cost(flyer, best):
    """Beside films computed in full with the thickness off, and their mean to second order."""
    effect = best.as_made.effects[GERMANIUM]
    thickness = best.design[GERMANIUM]
    assert effect.assumed
    assert effect.spread == pytest.approx(0.05 * thickness)
    sides = [exact_payload(flyer, thickness + sign * effect.spread) for sign in (-1.0, 1.0)]
    for change, side in zip((effect.less, effect.more), sides, strict=True):
        assert change == pytest.approx(side - best.value, rel=0.02)
    # the error of the mylar's thickness counts most: the worst 5 % are beyond 1.645 of its σ
    mylar = best.as_made.effects[MYLAR]
    slope, bend = 0.5 * (mylar.more - mylar.less), mylar.more + mylar.less
    low = 1.645 * slope + 0.5 * 1.645**2 * bend
    assert best.as_made.low - best.value == pytest.approx(low, rel=0.05)
    lost = 0.5 * (bend + effect.less + effect.more)  # a second derivative is a mean loss
    assert best.as_made.mean - best.value == pytest.approx(lost, abs=0.03 * abs(slope))


def test_gradients_are_those_of_differences(function):
    point, step = np.array([0.4, 0.3]), 1e-5
    _, slopes = function.scores_and_jacobian(point)
    moved = function.scores_of_many(
        np.concatenate([point + step * np.eye(2), point - step * np.eye(2)])
    )[:, 0]
    np.testing.assert_allclose(slopes[0], (moved[:2] - moved[2:]) / (2.0 * step), rtol=1e-6)


def test_a_robust_objective_is_that_of_films_with_errors(flyer):
    """The mean over errors of the thickness, by Gauss-Hermite quadrature of full films."""
    over = {GERMANIUM: WITHIN | {"uncertainty": "10 %"}, "altitude": "75 km"}
    robust = as_problem(flyer, None, None, points=256, maximise="payload", over=over,
                        uncertainty={"of": "mean"})  # fmt: skip
    function, thickness = ObjectiveFunction(robust), 14e-9
    point = np.array([robust.bounds[0].fraction(thickness)])
    function.match(point)
    nodes, weights = np.polynomial.hermite_e.hermegauss(5)
    made = [exact_payload(flyer, thickness * (1.0 + 0.1 * node)) for node in nodes]
    expected = np.dot(weights, made) / weights.sum()
    found = float(function.outputs_at(point)["payload"])
    loss = exact_payload(flyer, thickness) - expected
    assert loss > 1e-3 * expected
    assert exact_payload(flyer, thickness) - found == pytest.approx(loss, rel=0.05)


MISTAKES = [
    ({"uncertainty": "-5 %"}, "must be positive"),
    ({"uncertainty": "2 kg"}, "of the wrong kind"),
    ({"uncertainty": "2 nm"}, "at most 30 % of the number"),
    ({"points": 3}, "points is not part of a range"),
]


@pytest.mark.parametrize(("entry", "message"), MISTAKES)
def test_mistakes_are_said(flyer, entry, message):
    over = {GERMANIUM: WITHIN | entry, "altitude": "75 km"}
    with pytest.raises(lf.ConfigurationError, match=message):
        as_problem(flyer, None, None, maximise="payload", over=over)


def test_films_that_are_not_simple_are_refused():
    rough = [LAYERS[0], LAYERS[1], LAYERS[2] | {"roughness": "3 nm"}]
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film={"layers": rough})
    with pytest.raises(lf.ConfigurationError, match="knows only smooth, coherent layers"):
        as_problem(flyer, None, None, maximise="payload",
                   over={GERMANIUM: WITHIN, "altitude": "75 km"})  # fmt: skip
