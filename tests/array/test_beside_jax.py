"""Results of NumPy beside those of JAX, on random designs of every kind in random places."""

from pathlib import Path

import numpy as np
import pytest
import tomli_w

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.array.namespace import number, within
from lightflyer.array.transformations import compiled
from lightflyer.config.flyer_file import FlyerFile, models_for
from lightflyer.config.reader import design_of_text
from lightflyer.core.quantity import impossible_as_nan
from lightflyer.design.tables import tabulate
from lightflyer.explorer.grammar import templates
from lightflyer.uncertainty.inputs import draw, uncertain_inputs

KINDS = {name: one.document for name, one in templates().items() if name != "mission"}
FLYERS = {name: type(FlyerFile(**document).flyer) for name, document in KINDS.items()}
DEFAULTS = {(FLYERS[name], document["force"]["model"]) for name, document in KINDS.items()}
MODELS = {
    (flyer, model): (kind, model)  # by one kind of several with such a flyer
    for kind, flyer in FLYERS.items()
    for model in models_for(flyer)
    if (flyer, model) not in DEFAULTS
}
WITH_LESS = {"earth": "layers", "sandwich": "ligaments"}  # flyers that another kind has, with more
COUNT = 24
SOLVED = 2e-11
"""Relative difference of two solutions: searches end at 1e-12, and a payload is the small
difference of lift and weight."""

pytestmark = [
    pytest.mark.slow,
    # of numbers that depend on each other wholly
    pytest.mark.filterwarnings("ignore:covariance is not symmetric:RuntimeWarning"),
]


def draws(document, rng):
    """Setups with random numbers, and places."""
    design = design_of_text(tomli_w.dumps(document), Path("flyer.toml"))
    inputs = uncertain_inputs(design)
    low, high = design.setup.searched
    scale = np.geomspace if design.setup.environment.coordinate.logarithmic else np.linspace
    coordinate = rng.permutation(scale(low, high, COUNT))[:, None]
    with impossible_as_nan():
        setup = (
            design.setup if inputs is None else inputs.build(draw(inputs, COUNT, 1).T[..., None])
        )
        return tree.map_leaves(number, setup), coordinate


def require_same(function, *args):
    with within():
        ours = function(*args)
    theirs = compiled(function)(*args)
    assert np.isfinite(tree.leaves(ours)[0]).any()
    for one, other in zip(tree.leaves(ours), tree.leaves(theirs), strict=True):
        np.testing.assert_allclose(one, other, rtol=SOLVED)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in WITH_LESS])
def test_every_output_of_every_kind(kind, rng):
    def outcome(setup, coordinate):
        irradiance = setup.environment.state(coordinate).radiation.irradiance
        found = tabulate(setup, coordinate, irradiance)
        return [values for name, values in found.items() if "residual" not in name]

    require_same(outcome, *draws(KINDS[kind], rng))


def equilibrium_and_lift(setup, coordinate):
    state = setup.environment.state(coordinate)
    found = lf.equilibrium(setup.flyer, state, setup.model, throw=False)
    return found.unknowns, setup.model.force(setup.flyer, state, found.unknowns)


@pytest.mark.parametrize(("kind", "model"), MODELS.values())
def test_every_other_force_model(kind, model, rng):
    document = KINDS[kind] | {"force": KINDS[kind]["force"] | {"model": model}}
    setup, coordinate = draws(document, rng)
    try:
        setup.model.require_gas(setup.environment.state(coordinate).gas)
    except lf.ParameterError as error:
        pytest.skip(str(error))
    require_same(equilibrium_and_lift, setup, coordinate)


@pytest.mark.parametrize(
    "environment",
    [
        lf.lu2023_earth(),
        lf.Chamber(gas=lf.gas.ARGON),
    ],
    ids=["lu2023", "argon"],
)
def test_further_environments(environment, rng):
    setup, _ = draws(KINDS["earth"], rng)
    low, high = environment.coordinate.searched
    coordinate = rng.uniform(low, high, (COUNT, 1))
    found = lf.Setup(setup.flyer, environment, lf.Kinetic())
    require_same(equilibrium_and_lift, found, coordinate)
