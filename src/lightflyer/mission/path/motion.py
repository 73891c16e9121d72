r"""Forces on a flyer that moves through the air, and the velocity at which they are in balance.

A flyer is in thermal equilibrium with what surrounds it and falls or climbs at the speed at which
the gas holds it. Both take less than a second, the way through a scale height many minutes. With
the unit vector :math:`n` of the top face's normal, tilted by :math:`\beta` from the vertical, and
:math:`t` perpendicular to it in the plane of the tilt, pointing down the slope,

.. math::
    D_n(v_n) = F - (W - B)\cos\beta, \qquad D_t(v_t) = (W - B)\sin\beta

for the velocity relative to the air, the photophoretic force :math:`F`, the weight :math:`W`, the
buoyancy :math:`B` and the drag :math:`D` broadside and edgewise. The two directions are taken to be
independent of each other, which is exact for slow motion, and the force and the heat balance to be
those of a flyer at rest.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.design.setup import Setup
from lightflyer.drag.disk import Direction
from lightflyer.environment.base import AbstractEnvironment, EnvironmentState, Place, Wind
from lightflyer.environment.planet import Planet
from lightflyer.environment.radiation import Attitude
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.mission.areas import latitude_and_longitude
from lightflyer.mission.path.air import Waves, WindError
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Moment
from lightflyer.mission.path.integration import TerminationReason
from lightflyer.numerics.rootfind import RootOutcome, find_power_root, implicit_root
from lightflyer.statics.balance import Equilibrium, equilibrium
from lightflyer.statics.equations import weight

_SLOW = 1e-3  # Speed at which drag is taken to be proportional to it, for the first guess [m/s]

_SLOWEST, _FASTEST = 1e-4, 10.0
"""Bracket of the speed, over that of a drag proportional to it [1]."""


SETTLING = 20.0
"""Time in which a balloon comes to a balance that is near [s]. With inertia it swings about it,
with a period of minutes, which is left out."""

INERTIA = 0.1
"""Square of the speed over R T, up to which a flyer is in balance: the time that it takes to come
there over that in which it falls through a scale height of the gas."""

_BLEND = 4  # how sharply the way to a balance that is near takes over from a steady speed


class Surroundings(Module):
    """A flyer as it lies at one moment, and what is around it."""

    flyer: AbstractFlyer  # With its attitude of the moment
    state: EnvironmentState
    wind: Wind  # With its error, if one is assumed [m/s]
    share: Numeric | None = None  # Of the light, which the flyer lets in [1]; None for all
    drag: Numeric | None = None  # Over what the flyer's law has [1]; None for the law's

    @property
    def lit(self) -> EnvironmentState:
        """The state with the light that the flyer lets in."""
        if self.share is None:
            return self.state
        return replace(self.state, radiation=self.state.radiation.dimmed(self.share))


class Forces(Module):
    """Forces on a flyer."""

    # Force that drag has to balance, along the normal of the top face and down its slope [N]
    axial: Array
    slope: Array
    lift: Array  # Vertical force of the gas on the flyer at rest, with buoyancy [N]
    weight: Array  # [N]


class Vehicle(Module):
    """What flies, where, and by which rule it lies."""

    setup: Setup
    rule: AbstractAttitudeRule
    # By how much the wind differs from the environment's; None for not at all
    wind_error: WindError | None = None
    waves: Waves | None = None  # Of the air, beside the environment's state; None for still air
    # Drag over what the flyer's law has [1]; None for the law's
    drag: Numeric | None = None

    @property
    def planet(self) -> Planet:
        """The planet under the flyer."""
        return planet_of(self.setup.environment)

    def surroundings(self, altitude: Numeric, place: Place, elapsed: Numeric) -> Surroundings:
        """What surrounds the flyer, and how it lies there; ``elapsed``: time since the release."""
        state = self.setup.environment.state(altitude, place)
        if self.waves is not None:
            state = self.waves.disturb(state, altitude, place, elapsed)
        moment = self.moment(altitude, place, elapsed, state)
        lying = with_attitude(self.setup.flyer, self.rule.attitude(moment))
        return Surroundings(lying, state, moment.wind, self.rule.light(moment), self.drag)

    def moment(
        self, altitude: Numeric, place: Place, elapsed: Numeric, state: EnvironmentState
    ) -> Moment:
        """What the rule sees in some state of the surroundings."""
        wind = Wind(0.0, 0.0, 0.0) if state.wind is None else state.wind
        if self.wind_error is not None:
            wind = self.wind_error.add_to_wind(wind, place, elapsed)
        flyer, environment = self.setup.flyer, self.setup.environment
        return Moment(elapsed, altitude, place, state.radiation, wind, flyer.attitude, environment)

    def heat(self, local: Surroundings) -> Equilibrium:
        return equilibrium(local.flyer, local.lit, self.setup.model, throw=False)

    def forces(self, local: Surroundings, unknowns: tuple[Array, ...]) -> Forces:
        """Forces in some surroundings."""
        flyer, state = local.flyer, local.state
        force = self.setup.model.force(flyer, state, unknowns)
        buoyancy = flyer.buoyancy(state, unknowns)
        heaviness = weight(flyer, state)
        sunk = heaviness - buoyancy
        if flyer.attitude is None:
            return Forces(force - sunk, xp.zeros_like(force), force + buoyancy, heaviness)
        cosine, sine = xp.cos(flyer.attitude.tilt), xp.sin(flyer.attitude.tilt)
        return Forces(force - sunk * cosine, sunk * sine, force * cosine + buoyancy, heaviness)


def with_attitude(flyer: AbstractFlyer, attitude: Attitude | None) -> AbstractFlyer:
    """A flyer with another attitude."""
    return tree.replace_at(lambda flyer: flyer.attitude, flyer, attitude)


def steady_speeds(
    local: Surroundings, forces: Forces, unknowns: tuple[Array, ...]
) -> tuple[Array, Array]:
    """Speeds through the air at which drag balances the other forces [m/s]."""
    flyer, state = local.flyer, local.state
    drag = 1.0 if local.drag is None else local.drag  # which the law's balances force / drag

    def speed_of(force: Array, direction: Direction) -> Array:
        """Signed speed at which the odd, increasing drag balances a force."""

        def resistance(speed: Array) -> Array:
            return flyer.drag(state, unknowns, speed, direction)

        sign, size = xp.sign(force), xp.abs(force)
        at_rest = size == 0.0
        slope = resistance(xp.full_like(force, _SLOW)) / _SLOW
        target = xp.where(at_rest, slope * _SLOW, size)
        proportional = target / slope

        def search() -> tuple[Array, RootOutcome]:
            found, outcome = find_power_root(
                resistance,
                target=target,
                lower=_SLOWEST * proportional,
                upper=_FASTEST * proportional,
                guess=proportional,
            )
            return xp.where(at_rest, 0.0, sign * found), outcome

        return implicit_root(lambda speed: resistance(speed) - force, search)[0]

    axial = speed_of(forces.axial / drag, "broadside")
    if flyer.attitude is None:
        return axial, xp.zeros_like(axial)
    return axial, speed_of(forces.slope / drag, "edgewise")


def in_balance(vehicle: Vehicle, local: Surroundings) -> tuple[Array, Array, Array]:
    """Steady speeds [m/s], and what :data:`INERTIA` is the most of [1]."""
    unknowns = vehicle.heat(local).unknowns
    axial, slope = steady_speeds(local, vehicle.forces(local, unknowns), unknowns)
    thermal = local.state.gas.specific_gas_constant * local.state.temperature
    return axial, slope, axial**2 / thermal


def settle(speed: Array, force: Array, stiffness: Array) -> Array:
    """Speed of a flyer that comes to its balance in :data:`SETTLING`, not at once [m/s]."""
    # Its force is zero there and falls off on the way up by the stiffness [N/m]. Drag grows with
    # the square of the speed of a large body, so that a steady speed would change infinitely fast.
    stable = (stiffness > 0.0) & (force != 0.0)
    steady = xp.where(stable, xp.abs(speed), 1.0)
    towards = xp.where(stable, xp.abs(force) / (SETTLING * stiffness), 1.0)
    slower = steady * towards / (steady**_BLEND + towards**_BLEND) ** (1.0 / _BLEND)
    return xp.where(stable, xp.sign(speed) * slower, speed)


def velocity(local: Surroundings, axial: Array, slope: Array) -> Wind:
    """Velocity over ground of a flyer that moves through the air [m/s]; east, north and up."""
    wind, attitude = local.wind, local.flyer.attitude
    if attitude is None:
        return Wind(wind.east, wind.north, wind.up + axial)
    cosine, sine = xp.cos(attitude.tilt), xp.sin(attitude.tilt)
    outwards = axial * sine + slope * cosine
    return Wind(
        wind.east + outwards * xp.sin(attitude.azimuth),
        wind.north + outwards * xp.cos(attitude.azimuth),
        wind.up + axial * cosine - slope * sine,
    )


def planet_of(environment: AbstractEnvironment) -> Planet:
    """The planet that an environment is on."""
    planet = environment.planet
    if planet is None:
        raise ParameterError(
            f"a mission needs a planet below it; {type(environment).__name__} has none"
        )
    return planet


_STRESS = "stress_over_strength"


def failures_of(flyer: AbstractFlyer) -> tuple[TerminationReason, ...]:
    """The ends by failure whose limits a flyer states."""
    too_hot = flyer.highest_temperature is not None
    known = too_hot, _STRESS in flyer.known_shape
    ends = TerminationReason.TOO_HOT, TerminationReason.TORN
    return tuple(end for end, is_known in zip(ends, known, strict=True) if is_known)


def loads(vehicle: Vehicle, local: Surroundings, heat: Equilibrium) -> Array:
    """Load over what is borne for each of :func:`failures_of`, shape (ends,); above one it fails.

    Zero where it is not known, such as the tension of a film of unknown strength.
    """
    flyer, model, found = local.flyer, vehicle.setup.model, []
    if flyer.highest_temperature is not None:
        found.append(heat.temperature / flyer.highest_temperature)
    if _STRESS in flyer.known_shape:
        results: dict[str, Any] = {}
        if flyer.held_pressure is not None:
            results = model.own_results(flyer, local.state, heat.unknowns)
        pressure = results.get(flyer.held_pressure or "", 0.0)
        lift = vehicle.forces(local, heat.unknowns).lift
        shape = flyer.shape(local.state, heat.temperatures, lift, pressure)
        found.append(xp.nan_to_num(xp.asarray(shape.stress_over_strength)))
    return xp.stack([xp.asarray(load, float) for load in found])


class Variable(NamedTuple):
    """Unit and description of a result over time."""

    unit: str  # As datasets write it
    long_name: str

    @property
    def attributes(self) -> dict[str, Any]:
        """As a dataset has them."""
        return {"units": self.unit, "long_name": self.long_name}


ELAPSED = "elapsed"  # Dimension of time

VARIABLES = {
    "pressure": Variable("Pa", "gas pressure"),
    "gas_temperature": Variable("K", "gas temperature"),
    "temperature": Variable("K", "temperature of the flyer's hottest part"),
    "lift_over_weight": Variable("1", "lift of the flyer at rest over its weight"),
    "lift": Variable("N", "upward force of the gas on the flyer at rest, with buoyancy"),
    "weight": Variable("N", "weight with payload"),
    "irradiance": Variable("W m-2", "irradiance of the light on a surface that faces it"),
    "light_share": Variable("1", "share of the light that the flyer lets in"),
    "sun_elevation": Variable(
        "degree", "geometric elevation of the sun, or of what lights the flyer"
    ),
    "tilt": Variable("degree", "tilt of the top face's normal"),
    "absorbed_power": Variable(
        "W", "light absorbed, and heat radiation beyond that of surroundings as warm as the gas"
    ),
    "gas_power": Variable("W", "heat taken by the gas"),
    "radiated_power": Variable("W", "heat radiated, net of surroundings as warm as the gas"),
    "axial_speed": Variable("m s-1", "speed through the air along the normal of the top face"),
    "slope_speed": Variable("m s-1", "speed through the air down the slope of the top face"),
    "drag_power": Variable("W", "power that drag takes"),
    "vertical_speed": Variable("m s-1", "vertical speed over ground, upwards"),
    "eastward_speed": Variable("m s-1", "eastward speed over ground"),
    "northward_speed": Variable("m s-1", "northward speed over ground"),
    "wind_east": Variable("m s-1", "eastward wind"),
    "wind_north": Variable("m s-1", "northward wind"),
    "wind_up": Variable("m s-1", "upward wind"),
}
"""Results over time beside altitude and place; SI units, angles in degrees."""

NODE = "temperature_{}"  # Name of the temperature of one part of a flyer of several

_DEGREES = 180.0 / np.pi


class Course(Module):
    """Where a flyer is over time."""

    elapsed: Numeric  # shape (times,); since the release [s]
    altitude: Numeric  # shape (times,); [m]
    position: Numeric  # shape (times, 3); unit vector in the planet's frame
    released: Numeric  # Time of the release [s]


def node_variables(nodes: tuple[str, ...]) -> dict[str, Variable]:
    """Temperatures of the parts of a flyer of several; empty for a flyer of one temperature."""
    if len(nodes) == 1:
        return {}
    return {
        NODE.format(node): Variable("K", f"temperature of the {node.replace('_', ' ')}")
        for node in nodes
    }


def within(vehicle: Vehicle, course: Course) -> Course:
    """A course whose end lies within the environment, which it may miss by rounding."""
    where = vehicle.setup.environment.coordinate
    altitude = np.clip(np.asarray(course.altitude), where.lowest, where.highest)
    return replace(course, altitude=altitude)


@entry_point
def moments(vehicle: Vehicle, course: Course) -> dict[str, Any]:
    """Results over time of a flyer in balance at each moment [1], shape (times,)."""
    course, elapsed = within(vehicle, course), course.elapsed
    place = Place(*latitude_and_longitude(course.position), course.released + elapsed)
    local = vehicle.surroundings(course.altitude, place, elapsed)
    heat = vehicle.heat(local)
    forces = vehicle.forces(local, heat.unknowns)
    axial, slope = steady_speeds(local, forces, heat.unknowns)
    moving = velocity(local, axial, slope)
    flyer, state = local.flyer, local.state
    tilt = 0.0 if flyer.attitude is None else flyer.attitude.tilt
    found = {
        "pressure": state.pressure,
        "gas_temperature": state.temperature,
        "temperature": heat.temperature,
        "lift_over_weight": forces.lift / forces.weight,
        "lift": forces.lift,
        "weight": forces.weight,
        "irradiance": state.radiation.visible_part(state.radiation.irradiance),
        "sun_elevation": 90.0 - state.radiation.zenith_angle * _DEGREES,
        "tilt": tilt * _DEGREES,
        "absorbed_power": heat.absorbed_power,
        "gas_power": heat.gas_power,
        "radiated_power": heat.radiated_power,
        "axial_speed": axial,
        "slope_speed": slope,
        # drag balances these forces
        "drag_power": forces.axial * axial + forces.slope * slope,
        "vertical_speed": moving.up,
        "eastward_speed": moving.east,
        "northward_speed": moving.north,
        "wind_east": local.wind.east,
        "wind_north": local.wind.north,
        "wind_up": local.wind.up,
        "residual": xp.abs(heat.residual),
    }
    if local.share is not None:
        found["light_share"] = local.share
    if len(heat.nodes) > 1:
        for node, temperature in zip(heat.nodes, heat.temperatures, strict=True):
            found[NODE.format(node)] = temperature
    return {
        name: xp.broadcast_to(xp.asarray(value, float), xp.shape(elapsed))
        for name, value in found.items()
    }
