"""A force model that does not know of walls says so where walls are given."""

from dataclasses import replace

import jax
import pytest

import lightflyer as lf
from lightflyer.array.namespace import float64
from lightflyer.design.diagnostics import diagnose
from lightflyer.design.setup import Setup
from lightflyer.force.free_molecular import FreeMolecular, LinearFreeMolecular

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
DISK = lf.Disk(FILM, 0.01)
MODELS = [lf.Lu2023(), lf.Kinetic(), FreeMolecular(), LinearFreeMolecular()]


def name(model):
    return type(model).__name__


@pytest.mark.parametrize("model", MODELS, ids=name)
def test_what_a_model_declares_is_what_it_does(model):
    chamber = lf.Chamber(radius=0.04)

    def loss(distance):
        state = replace(chamber.state(3.0), wall_distance=distance)
        return model.heat_loss(DISK, state, (0.3,))[0]

    with float64():
        slope = float(jax.grad(loss)(0.04))
    assert (slope != 0.0) == type(model).feels_walls


@pytest.mark.parametrize("model", MODELS, ids=name)
def test_it_is_said(model):
    state = lf.Chamber(radius=0.04).state(3.0)
    said = [
        text
        for text in diagnose(Setup(DISK, lf.Chamber(), model), state, 320.0)
        if text.startswith("the walls around the flyer have no effect")
    ]
    assert bool(said) != type(model).feels_walls
