"""Sinking speed and settling time."""

import math

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.core.errors import ParameterError
from lightflyer.drag import disk as disk_module

ALTITUDES = np.array([50e3, 60e3, 70e3, 80e3])


@pytest.fixture
def black(film):
    """As in the table of an independent calculation: complete accommodation, 2 cm, 1 g/m²."""
    whole = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=1.0, tac_bottom=1.0)
    return lf.Disk(whole, radius=0.01)


def by_hand(state, radius=0.01, areal_density=1e-3):
    """Speed from the two limits in series and the published inertia, in plain Python."""
    pressure, temperature = float(state.pressure), float(state.temperature)
    gas_constant = float(state.gas.specific_gas_constant)
    viscosity = float(state.gas.viscosity(temperature))
    molecules = math.sqrt(2.0 * gas_constant * temperature)
    area = math.pi * radius**2

    def excess(speed):
        thin = pressure * area * speed / molecules * (4.0 + math.pi) / math.sqrt(math.pi)
        reynolds = 2.0 * radius * speed * pressure / (gas_constant * temperature * viscosity)
        place = math.log10(reynolds)
        increase = (
            10.0 ** (-0.883 + 0.906 * place - 0.025 * place**2)
            if reynolds < 1.5
            else 0.138 * reynolds**0.792
        )
        dense = 16.0 * viscosity * radius * speed * (1.0 + increase)
        weight = areal_density * area * float(state.gravity)
        return 1.0 / (1.0 / thin + 1.0 / dense) - weight

    return brentq(excess, 1e-3, 100.0)


def test_speed_of_an_independent_calculation(black, monkeypatch):
    """0.98, 1.16, 1.44 and 2.17 m/s were worked out apart from this package."""
    earth = lf.Earth()
    monkeypatch.setattr(disk_module, "dense_share", lambda *_: 1.0)
    speeds = np.array([by_hand(earth.state(altitude)) for altitude in ALTITUDES])
    np.testing.assert_allclose(speeds, [0.98, 1.16, 1.44, 2.17], rtol=0.015)
    state = earth.state(ALTITUDES)
    with jax.disable_jit():  # nothing of this law may stay compiled
        drag = black.drag(state, (0.0,), speeds)
    np.testing.assert_allclose(drag, lf.statics.weight(black, state), rtol=6e-3)


def test_drag_balances_weight(disk):
    state = lf.Earth().state(ALTITUDES)
    speed = lf.statics.sinking_speed(disk, state)
    with lf.float64():
        drag = disk.drag(state, (0.0,), speed)
    np.testing.assert_allclose(drag, lf.statics.weight(disk, state), rtol=1e-10)


def test_climbs_in_sunlight_and_sinks_in_the_dark(disk):
    state = lf.lu2023_earth().state(72e3)
    model = lf.Lu2023()
    up = lf.statics.sinking_speed(disk, state, model)
    down = lf.statics.sinking_speed(disk, lf.statics.in_the_dark(state), model)
    assert up < 0.0 < down
    balance = lf.equilibrium(disk, state, model)
    with lf.float64():
        drag = disk.drag(state, balance.unknowns, -up)
    missing = lf.lift(disk, state, model) - lf.statics.weight(disk, state)
    assert drag / missing == pytest.approx(1.0, rel=1e-9)


def test_derivative_of_the_speed(disk, require_derivatives):
    def speed(x):
        flyer = lf.Disk(disk.film, radius=x[0])
        return lf.statics.sinking_speed(flyer, lf.Earth().state(60e3))[None]

    require_derivatives(speed, np.array([0.01]), rtol=1e-5, atol=1e-9)


def test_time_of_a_descent(disk):
    earth = lf.Earth()
    time = lf.statics.settling_time(disk, earth, start=75e3, end=60e3)
    grid = np.linspace(60e3, 75e3, 301)
    speeds = lf.statics.sinking_speed(disk, earth.state(grid))
    fall = solve_ivp(
        lambda _, z: -np.interp(z, grid, speeds), (0.0, time), [75e3], rtol=1e-8, max_step=100.0
    )
    assert fall.y[0, -1] == pytest.approx(60e3, abs=5.0)
    with pytest.raises(ParameterError, match="not above"):
        lf.statics.settling_time(disk, earth, start=50e3, end=60e3)


def test_a_tilted_flyer_glides(disk):
    tilted = lf.Disk(disk.film, 0.01, attitude=lf.environment.Attitude(tilt=0.3))
    with pytest.raises(ParameterError, match="level"):
        lf.statics.sinking_speed(tilted, lf.Earth().state(60e3))
