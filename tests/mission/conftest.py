"""A sky that is easily turned, and a disk whose drag is a closed form."""

import dataclasses
from typing import Any

import ambiance
import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.array.namespace import xp
from lightflyer.environment import EARTH_PLANET, EnvironmentState, Planet, Wind
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.mission.areas import directions, unit_vector

DAY = 86_400.0


class ClosedFormDisk(lf.Disk):
    """Free molecules and slow flow in series, with the inertial factor of a disk or without it."""

    inertia: Any = 1.0

    def drag(self, state, unknowns, speed, direction="broadside"):
        thermal = xp.sqrt(2.0 * state.gas.specific_gas_constant * state.temperature)
        viscosity = state.gas.viscosity(state.temperature)
        density = state.gas.density(state.pressure, state.temperature)
        faces = 4.0 / np.sqrt(np.pi) + np.sqrt(np.pi)
        free = self.area * state.pressure / thermal * faces
        if direction == "edgewise":
            slow = 32.0 / 3.0 * viscosity * self.radius
        else:
            reynolds = 2.0 * self.radius * density * xp.abs(speed) / viscosity
            factor = 1.0 + self.inertia * (inertial_factor(reynolds, xp) - 1.0)
            slow = 16.0 * viscosity * self.radius * factor
        return speed * free * slow / (free + slow)


def inertial_factor(reynolds, xp):
    """Clift, Grace and Weber's drag of a disk over that of slow flow."""
    safe = xp.maximum(reynolds, 1e-12)
    power = -0.883 + 0.906 * xp.log10(safe) - 0.025 * xp.log10(safe) ** 2
    middle = xp.where(reynolds < 0.01, 0.0, 10.0**power)
    return 1.0 + xp.where(reynolds < 1.5, middle, 0.138 * safe**0.792)


class IsothermalAir(AbstractEnvironment):
    """Air of one temperature under the sky of Earth, or under a given light."""

    radiation: Any
    gas: Any = lf.gas.US1976_AIR
    sky: Any = None
    wind: Any = None

    @property
    def coordinate(self):
        return lf.Earth().coordinate

    @property
    def planet(self):
        return EARTH_PLANET

    def state(self, coordinate, place=None):
        view = (6.371e6 / (6.371e6 + coordinate)) ** 2
        pressure = 5.0 * xp.exp((70e3 - coordinate) / 6500.0)
        light = self.radiation.with_ground_view(view)
        if self.sky is not None:
            light = self.sky.radiation(coordinate, place)
        wind = None if self.wind is None else self.wind.velocity(coordinate, place)
        return EnvironmentState(pressure, 220.0, 9.6, self.gas, light, wind=wind)


class TurningSky(AbstractEnvironment):
    """A round Earth under a sun that circles about any axis, with air that turns about another."""

    base: AbstractEnvironment
    planet_radius: Any
    axis: Any
    sun: Any
    air: Any
    irradiance: Any

    @property
    def radiation(self):
        return self.base.radiation

    @property
    def coordinate(self):
        return self.base.coordinate

    @property
    def planet(self):
        return Planet("round", self.planet_radius, 0.0)

    def state(self, coordinate, place=None):
        state = self.base.state(coordinate)
        angle = -2.0 * np.pi * xp.asarray(place.time / DAY)[..., None]
        along = (self.axis @ self.sun) * self.axis
        across = np.cross(self.axis, self.sun)
        sun = along + xp.cos(angle) * (self.sun - along) + xp.sin(angle) * across
        up = unit_vector(place.latitude, place.longitude)
        east, north = directions(place.latitude, place.longitude)
        height = xp.sum(up * sun, axis=-1)
        zenith = xp.arctan2(xp.linalg.norm(xp.cross(up, sun), axis=-1), height)
        azimuth = xp.arctan2(xp.sum(sun * east, axis=-1), xp.sum(sun * north, axis=-1))
        dip = xp.sqrt(1.0 - state.radiation.ground_view)
        share = xp.clip((height + dip) / 0.01 + 0.5, 0.0, 1.0)
        light = self.irradiance * share**2 * (3.0 - 2.0 * share)
        radiation = dataclasses.replace(
            state.radiation, irradiance=light, zenith_angle=zenith, azimuth=azimuth
        )
        moving = xp.cross(self.air, up)
        wind = Wind(xp.sum(moving * east, axis=-1), xp.sum(moving * north, axis=-1), 0.0 * height)
        return EnvironmentState(
            state.pressure, state.temperature, state.gravity, state.gas, radiation, wind=wind
        )


def turning_sky(irradiance=1361.0, turn=None):
    """A sky with sun and air turned together.

    The air turns about a tilted axis, so that a flight that begins on the equator passes places
    of all kinds.
    """
    parts = {
        "axis": np.array([0.0, 0.0, 1.0]),
        "sun": np.array([0.92, 0.0, 0.39]),
        "air": np.array([30.0, 0.0, 30.0]),
    }
    if turn is not None:
        parts = {name: turn @ part for name, part in parts.items()}
    light = lf.environment.sunlight(0.0)
    base = lf.Earth(gas=lf.gas.US1976_AIR, radiation=light)
    return TurningSky(base, 6.371e6, irradiance=irradiance, **parts)


@pytest.fixture(scope="session")
def sky():
    return turning_sky


@pytest.fixture(scope="session")
def isothermal_air():
    return IsothermalAir(lf.environment.sunlight(), sky=lf.environment.Daylight())


@pytest.fixture(scope="session")
def lit_air():
    """Air of one temperature under a sun that stands still, with a wind."""
    return lambda wind=None: IsothermalAir(lf.environment.sunlight(zenith_angle=0.3), wind=wind)


@pytest.fixture(scope="session")
def closed_form_disk():
    def make(diameter, tac_top=0.8, tac_bottom=0.9, emittance=0.08, inertia=1.0):
        film = lf.FilmProperties(
            1e-3, 0.75, emittance, emittance, tac_top=tac_top, tac_bottom=tac_bottom
        )
        return ClosedFormDisk(film, radius=0.5 * diameter, inertia=inertia)

    return make


@pytest.fixture(scope="session")
def fall_speed():
    """Speed at which a disk of 1 g/m² sinks in the dark, in another package's atmosphere [m/s]."""
    heights = np.linspace(0.0, 80e3, 8001)
    air = ambiance.Atmosphere(heights)
    # straight in their logarithms over 10 m, to 3e-7
    known = np.log([air.pressure, air.temperature, air.density, air.dynamic_viscosity,
                    air.grav_accel])  # fmt: skip
    faces = 4.0 / np.sqrt(np.pi) + np.sqrt(np.pi)

    def speed(altitude, radius=0.005, heavier=0.0):
        here = np.exp([np.interp(altitude, heights, row) for row in known])
        pressure, temperature, density, viscosity, gravity = here
        weight = np.pi * radius**2 * 1e-3 * (1.0 + heavier) * gravity
        thermal = np.sqrt(2.0 * 287.0529 * temperature)

        def excess(fall):
            free = np.pi * radius**2 * pressure * fall / thermal * faces
            factor = inertial_factor(2.0 * radius * density * fall / viscosity, np)
            slow = 16.0 * viscosity * radius * fall * factor
            return 1.0 / (1.0 / free + 1.0 / slow) - weight

        return brentq(excess, 1e-4, 100.0, xtol=1e-12)

    return speed
