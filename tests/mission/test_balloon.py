"""Balloons come to rest in missions, where drag alone would let them change at any speed."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, RegularGridInterpolator

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.designs import as_design


@pytest.fixture(scope="module")
def setup(tmp_path_factory):
    """The template, in the same light at all times."""
    path = tmp_path_factory.mktemp("balloon") / "flyer.toml"
    path.write_text(templates()["balloon"].read(), encoding="utf-8")
    return as_design(path).setup


def flown(setup, altitude, hours):
    release = lf.Release(altitude, latitude=10.0, longitude=0.0, time="2026-06-21T12:00Z")
    return lf.fly(
        setup.flyer, setup.environment, setup.model, release=release, duration=f"{hours} h"
    )


@pytest.mark.parametrize(("radius", "payload"), [(2.5, 0.0), (2.9, 1.7), (20.0, 10.0)])
def test_it_floats_for_days_where_the_verdict_lets_it_rest(setup, radius, payload):
    flyer = dataclasses.replace(setup.flyer, radius=radius, payload=payload)
    changed = dataclasses.replace(setup, flyer=flyer)
    flight = flown(changed, 8e3, 30)
    assert "still aloft" in flight.attrs["end"]
    rest = lf.predict(changed).verdict.rest.coordinate
    assert float(flight.altitude[-1]) == pytest.approx(rest, abs=0.1)
    late = flight.altitude.values[flight.altitude.values.size // 2 :]
    np.testing.assert_allclose(late, rest, atol=0.1)


def test_the_way_is_that_of_a_body_with_inertia(setup):
    """Newton's second law with the masses of film, payload, gas within and gas that is moved."""
    flyer, environment, model = setup.flyer, setup.environment, setup.model
    heights, speeds = np.linspace(14e3, 20.5e3, 131), np.linspace(-30.0, 30.0, 241)
    state = environment.state(heights)
    net = np.asarray(lf.lift(flyer, state, model)) - float(flyer.mass) * np.asarray(state.gravity)
    density = np.asarray(state.gas.density(state.pressure, state.temperature))
    volume = 4.0 / 3.0 * np.pi * float(flyer.radius) ** 3
    mass = float(flyer.mass) + 1.5 * density * volume
    excess = np.asarray(lf.equilibrium(flyer, state, model).temperature) / state.temperature - 1.0
    column = environment.state(heights[:, None])
    with lf.float64():
        drag = np.asarray(flyer.drag(column, (excess[:, None],), np.abs(speeds))) * np.sign(speeds)
    force, inertia = CubicSpline(heights, net), CubicSpline(heights, mass)
    resistance = RegularGridInterpolator(
        (heights, speeds), drag, method="cubic", bounds_error=False
    )

    def rate(_, y):
        return [y[1], (force(y[0]) - resistance((y[0], y[1]))) / inertia(y[0])]

    truth = solve_ivp(
        rate, (0.0, 6 * 3600.0), [15e3, 0.0], "Radau", rtol=1e-8, atol=1e-5, max_step=20.0,
        dense_output=True,
    )  # fmt: skip
    flight = flown(setup, 15e3, 6)
    elapsed = (flight.time.values - flight.time.values[0]) / np.timedelta64(1, "s")
    climbing = (elapsed > 300.0) & (flight.altitude.values < 19e3)
    assert climbing.sum() >= 3
    np.testing.assert_allclose(
        flight.altitude.values[climbing], truth.sol(elapsed[climbing])[0], atol=30.0
    )
    swings = truth.sol(np.linspace(5.0, 6.0, 721) * 3600.0)[0]
    assert float(flight.altitude[-1]) == pytest.approx(np.mean(swings), abs=3.0)
