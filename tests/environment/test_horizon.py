"""Edges of light against brute force: disks behind edges, rays through air, a round ground."""

import jax
import numpy as np
import pytest
from scipy import integrate

import lightflyer as lf
from lightflyer.environment import (
    EARTH_LIMB,
    Limb,
)
from lightflyer.environment.horizon import (
    facing_share,
    horizon_depression,
    lit_ground,
    visible_share,
)

RADIUS = 6_371_008.8
SUN = np.radians(0.267)


def points_of_a_disk(count=1200):
    """Points spread evenly over the unit disk, as their distances from a diameter."""
    x, y = np.meshgrid(*(np.linspace(-1.0, 1.0, count + 1)[1:] - 1.0 / count,) * 2)
    return y[x**2 + y**2 < 1.0]


@pytest.fixture(scope="module")
def disk_points():
    return points_of_a_disk()


def test_the_sun_sets_as_a_disk(disk_points):
    for elevation in (-1.2, -0.9, -0.3, 0.0, 0.5, 0.99, 1.5):
        expected = np.mean(elevation + disk_points > 0.0)
        assert visible_share(elevation * SUN, SUN) == pytest.approx(expected, abs=1e-3)
        facing = np.mean(np.maximum(elevation + disk_points, 0.0)) * SUN
        assert facing_share(elevation * SUN, SUN) == pytest.approx(facing, abs=1e-4 * SUN)
    # a quarter of the disk's height: acos(1/2) of a circle's segment
    segment = (np.pi / 3.0 - np.sqrt(3.0) / 4.0) / np.pi
    assert visible_share(-0.5 * SUN, SUN) == pytest.approx(segment, rel=1e-12)
    assert facing_share(0.5, SUN) == pytest.approx(0.5, rel=1e-15)
    assert facing_share(-0.5, SUN) == 0.0


def test_light_changes_smoothly_as_the_sun_sets():
    """The slope of the one is the other, also at the edges, and changes no faster than they do."""
    elevation = SUN * np.array([-1.0, -0.7, 0.2, 1.0, 3.0])
    with lf.float64():
        slope = jax.vmap(jax.grad(facing_share), (0, None))(elevation, SUN)
        setting = jax.vmap(jax.grad(visible_share), (0, None))(elevation, SUN)
    np.testing.assert_allclose(slope, visible_share(elevation, SUN), atol=1e-7)
    # the chord of the disk along the horizon
    chord = 2.0 / np.pi / SUN * np.sqrt(np.maximum(1.0 - (elevation / SUN) ** 2, 0.0))
    np.testing.assert_allclose(setting, chord, atol=1e-5)


def bent_ray(limb, altitude):
    """Depression at a flyer, and bending, of the ray that grazes the limb, traced in the air."""

    def index_less_one(height):
        return limb.refractivity * np.exp((limb.height - height) / limb.scale_height)

    def slopes(along, ray):
        height, angle, _ = ray  # angle to the local horizontal, and how far round the planet
        distance = RADIUS + height
        refracts = index_less_one(height)
        bends = refracts / limb.scale_height / (1.0 + refracts) * np.cos(angle)
        return [np.sin(angle), np.cos(angle) / distance - bends, np.cos(angle) / distance]

    def reaches(along, ray):
        return ray[0] - altitude

    reaches.terminal = True
    start = [limb.height, 0.0, 0.0]
    to_flyer = integrate.solve_ivp(
        slopes, (0.0, 3e6), start, events=reaches, rtol=1e-11, atol=1e-9
    ).y[:, -1]
    to_space = integrate.solve_ivp(slopes, (0.0, 3e6), start, rtol=1e-11, atol=1e-9).y[:, -1]
    bending = sum(around - angle for _, angle, around in (to_flyer, to_space))
    return to_flyer[1], bending


@pytest.mark.parametrize("altitude", [35e3, 50e3, 75e3, 100e3])
def test_the_horizon_is_that_of_a_traced_ray(altitude):
    dip, bending = bent_ray(EARTH_LIMB, altitude)
    found = np.degrees(horizon_depression(EARTH_LIMB, altitude, RADIUS))
    assert 0.0 < bending < np.radians(0.12)
    assert found == pytest.approx(np.degrees(dip + bending), abs=0.015)


def test_without_air_the_horizon_is_geometry():
    bare = Limb(0.0, 0.0, 8e3)
    found = horizon_depression(bare, np.array([20e3, 70e3]), RADIUS)
    np.testing.assert_allclose(
        found, np.arccos(RADIUS / (RADIUS + np.array([20e3, 70e3]))), rtol=2e-4
    )
    # below the limb the horizon is level, and it passes there smoothly
    depression = horizon_depression(EARTH_LIMB, np.linspace(0.0, 50e3, 1001), RADIUS)
    assert 0.0 < depression[0] < np.radians(0.12)
    assert np.all(np.diff(depression) > 0.0)
    higher = EARTH_LIMB.at(30e3)
    assert higher.refractivity == pytest.approx(2.01e-5 * np.exp(-10.0 / 6.38))
    with pytest.raises(lf.ParameterError, match="refractivity"):
        Limb(15e3, -1e-5)


def ground_in_the_sun(zenith, view):
    """Mean cosine over the ground in sight, ring by ring from the edge to the nadir."""

    def ring(share):  # of the view factor within the ring
        nadir = np.arcsin(np.sqrt(share))
        psi = np.arcsin(np.sin(nadir) / np.sqrt(view)) - nadir
        phi = (np.arange(720) + 0.5) * np.pi / 720
        cosine = np.cos(zenith) * np.cos(psi) + np.sin(zenith) * np.sin(psi) * np.cos(phi)
        return np.mean(np.maximum(cosine, 0.0))

    edges = view * (1.0 - np.linspace(1.0, 0.0, 400) ** 2)
    middles = 0.5 * (edges[1:] + edges[:-1])
    return sum(np.diff(edges) * [ring(share) for share in middles]) / view


@pytest.mark.parametrize("degrees", [0.0, 60.0, 85.0, 90.0, 94.0, 97.0])
@pytest.mark.parametrize("altitude", [20e3, 75e3])
def test_ground_is_lit_to_the_terminator_and_past_local_sunset(degrees, altitude):
    zenith, view = np.radians(degrees), (RADIUS / (RADIUS + altitude)) ** 2
    assert lit_ground(zenith, view) == pytest.approx(ground_in_the_sun(zenith, view), abs=6e-5)


def test_lit_ground_at_the_ends():
    assert lit_ground(np.array([0.3, 2.0]), 1.0) == pytest.approx([np.cos(0.3), 0.0], abs=1e-12)
    assert lit_ground(np.pi, 0.97) == 0.0
    with lf.float64():
        slopes = jax.vmap(jax.grad(lit_ground), (0, None))(np.array([0.0, 1.0, 1.6, 3.1]), 0.978)
    zenith = np.array([1e-3, 1.0, 1.6, 3.1])
    change = (lit_ground(zenith + 1e-5, 0.978) - lit_ground(zenith - 1e-5, 0.978)) / 2e-5
    np.testing.assert_allclose(slopes, change, rtol=1e-4, atol=2e-3)


def test_the_limbs_air_is_that_of_the_standard():
    """Refractivity of air, 2.77e-4 at sea level, goes with density; its scale height is RT/g."""
    state, ground = lf.Earth().state(EARTH_LIMB.height), lf.Earth().state(0.0)
    thinner = (state.pressure / state.temperature) / (ground.pressure / ground.temperature)
    assert EARTH_LIMB.refractivity == pytest.approx(2.77e-4 * thinner, rel=0.02)
    scale = state.gas.specific_gas_constant * state.temperature / state.gravity
    assert EARTH_LIMB.scale_height == pytest.approx(scale, rel=0.02)
    # a denser air bends as astronomers know it: twice the refraction at the horizon, 34′
    sea = Limb(0.0, 2.77e-4, 8.4e3)
    dip = np.arccos((1.0 + 2.77e-4) * RADIUS / (RADIUS + 100e3))
    bending = np.degrees(horizon_depression(sea, 100e3, RADIUS) - dip)
    assert bending == pytest.approx(2.0 * 34.0 / 60.0, rel=0.05)
