"""Free thicknesses and stacks of layers, beside films computed in full and other optimisers."""

import itertools
import json

import jax
import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import lightflyer as lf
from lightflyer.array.namespace import xp
from lightflyer.cli.commands.studies import _write_flyer
from lightflyer.film.optics.thickness_surrogate import ThicknessSurrogate
from lightflyer.search import local_search, objectives, optimiser
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.problem import as_problem

pytestmark = pytest.mark.slow

FLYER = """
[flyer]
diameter = "2 cm"
[film]
layers = [
  {material = "Al2O3", thickness = "20 nm"},   # is replaced
  {material = "PET", thickness = "500 nm"},
  {material = "Ge", thickness = "15 nm"},
]
tac_top = 0.79    # without ±
tac_bottom = 0.90
[force]
model = "lu2023"  # has the films in question fly
force_error = 0
"""
STUDY = """
flyer = "flyer.toml"
[optimise]
maximise = "payload"
starts = 1
[optimise.over]
altitude = "75 km"
[optimise.stacks]
most_layers = 2
materials = [
  {material = "PET", from = "500 nm", to = "800 nm", carrier = true, uncertainty = "2 %"},
  {material = "Ge", from = "3 nm", to = "40 nm"},
  {material = "Cr", from = "3 nm", to = "40 nm"},
]
"""
GERMANIUM = "film.layers.2.thickness"
WITHIN = {"from": "3 nm", "to": "40 nm", "scale": "log"}
CARRIER, COATING = "film.layers.0.thickness", "film.layers.1.thickness"
ALTITUDE = 75e3


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("stacks")
    (path / "flyer.toml").write_text(FLYER, encoding="utf-8")
    (path / "study.toml").write_text(STUDY, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def flyer(folder):
    return lf.read_flyer_file(folder / "flyer.toml")


@pytest.fixture(scope="module")
def best(folder):
    with pytest.MonkeyPatch.context() as patch:  # few films to begin with
        patch.setattr(local_search, "POINTS", 16)
        patch.setattr(local_search, "_STARTS", 1)
        patch.setattr(optimiser, "SCREENED_FILMS", 32)
        patch.setattr(objectives, "SAMPLES", 128)
        return lf.optimise(lf.search.read_problem(folder / "study.toml"))


@pytest.fixture(scope="module")
def film(flyer):
    return flyer.film.film()


@pytest.fixture(scope="module")
def family(film):
    return ThicknessSurrogate.of(film)


def payload_of(design, values):
    """Payload with the film computed in full, by no part of the search."""
    setup = design.build(values)
    return float(lf.payload(setup.flyer, setup.environment.state(ALTITUDE), setup.model))


@pytest.fixture(scope="module")
def averages(family):
    """Absorptances, transmittance and emittances at 300 K of thicknesses."""

    def computed(thickness):
        found = family.properties(thickness, 0.3)
        heat = [found[f"emittance_{side}"](300.0) for side in ("top", "bottom")]
        light = [found[name] for name in ("absorptance", "absorptance_bottom", "transmittance")]
        return xp.stack([*light, *heat])

    return computed


def test_the_coarse_grid_is_near_the_full_one(film, averages):
    light = lf.film.light_shares(film, incidence=0.3)
    below = lf.film.light_shares(film, side="bottom", diffuse=True).absorptance.value
    heat = [lf.film.emittance(film, 300.0, side=side).value for side in ("top", "bottom")]
    expected = [light.absorptance.value, below, light.transmittance.value, *heat]
    np.testing.assert_allclose(averages(film.thickness), expected, rtol=4e-3)


def test_gradients_of_averages_are_those_of_differences(film, averages, compiled):
    thickness = np.asarray(film.thickness)

    def slopes(directions):
        return jax.vmap(lambda row: jax.jvp(averages, (thickness,), (row,))[1])(directions)

    found = compiled(slopes)(np.eye(3))
    for row, step in zip(found, 1e-5 * np.diag(thickness), strict=True):
        change = averages(thickness + step) - averages(thickness - step)
        np.testing.assert_allclose(row, change / (2.0 * step.sum()), rtol=1e-6, atol=1e-1)


def test_the_best_stack_is_that_of_all_searched_one_by_one(best):
    """Germanium or chromium below mylar: SciPy's search over each; above or none, none flies."""
    ranked = {stack.materials: stack for stack in best.ranking.stacks}
    coated = [pair for pair in itertools.permutations(("PET", "Ge", "Cr"), 2) if "PET" in pair]
    assert set(ranked) == {("PET",), *coated}
    film = {"tac_top": 0.79, "tac_bottom": 0.90}
    values = {}
    for stack in (("PET", "Ge"), ("PET", "Cr")):
        layers = [{"material": one, "thickness": "500 nm" if one == "PET" else "10 nm"}
                  for one in stack]  # fmt: skip
        one = lf.FlyerFile(
            flyer={"diameter": "2 cm"},
            film=film | {"layers": layers},
            force={"model": "lu2023", "force_error": 0},
        ).design()
        name = f"film.layers.{0 if stack[1] == 'PET' else 1}.thickness"
        found = minimize_scalar(
            lambda size, one=one, name=name: -payload_of(one, {name: size * 1e-9}),
            bounds=(3.0, 40.0), method="bounded", options={"xatol": 0.1},
        )  # fmt: skip
        values[stack] = -found.fun
        assert ranked[stack].in_full
        assert ranked[stack].value == pytest.approx(-found.fun, rel=1e-4)
        thickness = ranked[stack].thickness
        assert thickness[stack.index("PET")] == pytest.approx(500e-9)
        assert thickness[1 - stack.index("PET")] == pytest.approx(found.x * 1e-9, rel=0.02)
    assert best.ranking.stacks[0].materials == max(values, key=values.get) == ("PET", "Cr")
    assert best.value == pytest.approx(max(values.values()), rel=1e-4)
    assert best.active_bounds == {CARRIER: "low"}
    assert any("whatever its surface is" in text for text in best.warnings)


def test_the_optimum_is_that_of_the_film_computed_in_full(best):
    assert best.value == pytest.approx(payload_of(best.problem.design, best.design), rel=1e-11)
    assert best.outputs["payload"] == best.value
    assert best.agreeing == best.starts


def test_the_written_flyer_flies_as_the_search_says(folder, best):
    path = folder / "best.toml"
    _write_flyer(path, folder / "study.toml", best)
    text = path.read_text(encoding="utf-8")
    assert '{material = "Cr", thickness = ' in text
    assert "Al2O3" not in text
    design = lf.config.reader.read_design(path)
    assert payload_of(design, {}) == pytest.approx(best.value, rel=1e-10)


def test_what_is_said_is_of_the_best_film(flyer, best):
    """Bounds that missing data leave are those of the optimum, not of the flyer file's film."""
    said = best.problem.design.warnings_for(best.design)
    assert said
    assert set(said) <= set(best.warnings)
    assert not set(flyer.design().warnings) & set(best.warnings)
    assert json.loads(json.dumps(best.summary()))["ranking"]["allowed"] == 5


def test_what_errors_of_a_thickness_cost(best):
    """Beside films computed in full with the thickness off, and their mean to second order."""
    coating, carrier = (best.as_made.effects[name] for name in (COATING, CARRIER))
    thickness = best.design[COATING]
    assert coating.assumed
    assert not carrier.assumed
    assert coating.spread == pytest.approx(0.05 * thickness)
    sides = [
        payload_of(best.problem.design, best.design | {COATING: thickness + sign * coating.spread})
        for sign in (-1.0, 1.0)
    ]
    for change, side in zip((coating.less, coating.more), sides, strict=True):
        assert change == pytest.approx(side - best.value, rel=0.02)
    # the error of the mylar's thickness counts most: the worst 5 % are beyond 1.645 of its σ
    slope, bend = 0.5 * (carrier.more - carrier.less), carrier.more + carrier.less
    low = 1.645 * slope + 0.5 * 1.645**2 * bend
    assert best.as_made.low - best.value == pytest.approx(low, rel=0.05)
    lost = 0.5 * (bend + coating.less + coating.more)  # a second derivative is a mean loss
    assert best.as_made.mean - best.value == pytest.approx(lost, abs=0.03 * abs(slope))


def test_a_robust_objective_is_that_of_films_with_errors(flyer):
    """The mean over errors of the thickness, by Gauss-Hermite quadrature of full films."""
    over = {GERMANIUM: WITHIN | {"uncertainty": "10 %"}, "altitude": "75 km"}
    robust = as_problem(flyer, None, None, points=128, maximise="payload", over=over,
                        uncertainty={"of": "mean"})  # fmt: skip
    function, thickness, design = ObjectiveFunction(robust), 14e-9, flyer.design()
    point = np.array([robust.bounds[0].fraction(thickness)])
    function.match(point)
    nodes, weights = np.polynomial.hermite_e.hermegauss(5)
    made = [payload_of(design, {GERMANIUM: thickness * (1.0 + 0.1 * node)}) for node in nodes]
    expected = np.dot(weights, made) / weights.sum()
    loss = made[2] - expected
    assert loss > 1e-3 * expected
    found = float(function.scores_of_many(point[None])[0, 0])
    assert made[2] - found == pytest.approx(loss, rel=0.05)


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
    layers = [
        {"material": "PET", "thickness": "500 nm"},
        {"material": "Ge", "thickness": "20 nm", "roughness": "3 nm"},
    ]
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film={"layers": layers})
    over = {"film.layers.1.thickness": WITHIN, "altitude": "75 km"}
    with pytest.raises(lf.ConfigurationError, match="knows only smooth, coherent layers"):
        as_problem(flyer, None, None, maximise="payload", over=over)


PET = {"material": "PET", "from": "500 nm", "to": "1 um", "carrier": True}
STACKS_MISTAKES = [
    ({"materials": []}, "materials"),
    ({"materials": [PET | {"carrier": False}]}, "needs a material with carrier = true"),
    ({"materials": [PET | {"carrier": "yes"}]}, "PET: carrier = yes must be true or false"),
    ({"materials": [PET | {"from": "2 um"}]}, "PET has an empty range"),
    ({"materials": [PET | {"thick": 3}]}, "thick is unknown; choose from"),
    ({"materials": [{"material": "PET", "from": "1 nm"}]}, "PET: needs to, such as"),
    ({"materials": [PET, PET]}, "has PET twice"),
    ({"materials": [PET | {"material": "Gee"}]}, 'material "Gee" is unknown'),
    ({"materials": [PET, PET | {"material": "SWCNT"}]}, "SWCNT needs its density"),
    ({"materials": [PET], "film": "flyer.top"}, '"flyer.top" is no film of layers: film'),
    ({"materials": [PET], "most_layers": 40}, "most_layers"),
    ({"materials": [PET], "most": 4}, "most is unknown; choose from"),
    ({"materials": [PET | {"uncertainty": "50 %"}]}, "PET: .*at most 30 % of the number"),
]


@pytest.mark.parametrize(("stacks", "message"), STACKS_MISTAKES)
def test_mistakes_in_stacks_are_said(flyer, stacks, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        as_problem(flyer, None, None, maximise="payload", over={"altitude": "75 km"}, stacks=stacks)


def test_what_a_flyer_file_says_of_one_film_is_refused():
    film = {"layers": [{"material": "PET", "thickness": "500 nm"}], "absorptance": 0.75}
    flyer = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film)
    asked = {"maximise": "payload", "over": {"altitude": "75 km"}, "stacks": {"materials": [PET]}}
    with pytest.raises(lf.ConfigurationError, match="absorptance in the flyer file is of one film"):
        as_problem(flyer, None, None, **asked)
    bare = lf.FlyerFile(flyer={"diameter": "2 cm"}, film={"layers": film["layers"]})
    chromium = {"material": "Cr", "from": "5 nm", "to": "1 um", "carrier": True}
    with pytest.raises(lf.ConfigurationError, match="whose both faces have a known TAC"):
        as_problem(bare, None, None, **(asked | {"stacks": {"materials": [chromium]}}))
