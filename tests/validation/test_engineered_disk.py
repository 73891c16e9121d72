"""The disk of Keith (2010): its force turns where the air is as warm as radiation keeps it."""

import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf

SIGMA = 5.670374419e-8
SUN, ALBEDO, FROM_BELOW = 1361.0, 0.29, 240.0


def air(altitude):
    """Temperature of the US Standard Atmosphere 1976 from 20 km to 71 km [K]."""
    geopotential = 6356.766e3 * altitude / (6356.766e3 + altitude) / 1e3
    heights = [20.0, 32.0, 47.0, 51.0, 71.0]
    return np.interp(geopotential, heights, [216.65, 228.65, 270.65, 270.65, 214.65])


@pytest.mark.parametrize("model", [lf.Kinetic(), lf.FreeMolecular()], ids=["kinetic", "free"])
@pytest.mark.parametrize(("absorptance", "emittance"), [(0.1, 0.8), (0.05, 0.8), (0.05, 0.5)])
def test_it_is_pressed_down_where_air_is_warmer_than_radiation_keeps_it(
    model, absorptance, emittance
):
    gained = absorptance * SUN * (1.0 + ALBEDO) + emittance * FROM_BELOW
    balance = (gained / (2.0 * emittance * SIGMA)) ** 0.25
    film = lf.FilmProperties(
        0.15e-3, absorptance, emittance, emittance, tac_top=0.8, tac_bottom=0.95
    )
    disk, earth = lf.Disk(film, radius=5e-6), lf.Earth()
    for low, high in ((25e3, 48e3), (50e3, 70e3)):
        turn = brentq(lambda z: float(lf.lift(disk, earth.state(z), model)), low, high)
        assert turn == pytest.approx(brentq(lambda z: air(z) - balance, low, high), abs=500.0)
    assert lf.lift(disk, earth.state(49e3), model) < -disk.mass * 9.6
