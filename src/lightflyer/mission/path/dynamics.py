"""What flights follow: rates of change of scaled states, in balance or with inertia.

In balance a state is a unit vector and an altitude. From a rocket or an aircraft a flyer starts
with their velocity: it is then a part of the state, with its temperatures too where even heat is
not in balance at once. That is also a check of what flights in balance assume.
"""

from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import report
from lightflyer.core.quantity import Checked, SpecificHeat
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.planet import Planet
from lightflyer.mission.areas import directions, latitude_and_longitude, unit_vector
from lightflyer.mission.path.integration import (
    ALTITUDE_SCALE,
    Accuracy,
    Limits,
    Start,
    TerminationReason,
    Track,
    Trajectory,
    integrate,
)
from lightflyer.mission.path.motion import (
    INERTIA,
    Surroundings,
    Vehicle,
    failures_of,
    in_balance,
    loads,
    settle,
    steady_speeds,
    velocity,
)
from lightflyer.statics.equations import FlightEquations

_HOUR = 3600.0  # [s]
SPECIFIC_HEAT = 1000.0
"""Specific heat of films where none is given [J/(kg K)]: between alumina and polymers."""

SPEED_SCALE = 100.0
"""Speed that counts as much as one radian along the ground [m/s]."""

_TEMPERATURE_SCALE = 100.0  # kelvin
MOVING = slice(4, 7)  # entries of the state: its velocity over ground, in the planet's frame
_HEAT = slice(7, None)  # its temperatures
_SLOWEST = 1e-9  # Speed across a normal below which it has no direction [m/s]
_CLOSE = 0.01, 1.0
"""To the velocity in balance: over its size [1], and beside [m/s], by which shear and waves of the
air are never followed wholly."""
_SLOW, _PATIENCE = 1e-3, 60.0
"""Of :data:`~.motion.INERTIA`, for falls to end within metres, and the time that adds as much [s]:
what is heavy never falls as slowly."""

_DIFFERENCE = 1e-7  # of altitudes, over their size, by which a balloon's stiffness is taken


class FlightConditions(NamedTuple):
    """What a flyer with inertia meets, shape (n,)."""

    ground: Array  # Velocity over ground, to the east, north and up [m/s], shape (n, 3)
    speed: Array  # Through the air [m/s]
    density: Array  # Of the gas [kg/m³]
    heat_capacity: Array  # Of the gas at constant pressure [J/(kg K)]
    acceleration: Array  # [m/s²]


class Inertia(Checked):
    """What keeps a flyer's velocity and temperature from following at once.

    Attributes
    ----------
    specific_heat : array
        Heat capacity over mass, the same in all parts of the flyer [J/(kg K)]. Each part that has
        a temperature of its own has an equal share of the flyer's own mass.
    """

    specific_heat: SpecificHeat = SPECIFIC_HEAT


def scale_state(start: Start) -> Array:
    """State of a release: a unit vector, and the altitude in :data:`ALTITUDE_SCALE`."""
    position = unit_vector(start.place.latitude, start.place.longitude)
    height = xp.asarray(start.altitude)[..., None] / ALTITUDE_SCALE
    return xp.concatenate([position, height], axis=-1)


def rate_of(moving: Wind, place: Place, altitude: Array, planet: Planet) -> Array:
    """Rate of a scaled state [1/s], shape (..., 4); ``moving``: velocity over ground."""
    to_east, to_north = directions(place.latitude, place.longitude)
    along = moving.north / (planet.curvature_radius(place.latitude, 0.0) + altitude)
    across = moving.east / (planet.curvature_radius(place.latitude, 0.5 * np.pi) + altitude)
    across, along, up = xp.broadcast_arrays(across, along, moving.up / ALTITUDE_SCALE)
    level = across[..., None] * to_east + along[..., None] * to_north
    return xp.concatenate([level, up[..., None]], axis=-1)


def velocity_over_ground(state: Array, place: Place) -> Wind:
    """Velocity of a scaled state [m/s]."""
    east, north, up = xp.moveaxis(
        (_axes(place) @ state[..., MOVING, None])[..., 0] * SPEED_SCALE, -1, 0
    )
    return Wind(east, north, up)


scale = entry_point(scale_state)


@dataclass(frozen=True)
class Balanced:
    """Flyers in balance at each moment, as a :class:`~.integration.Law`."""

    vehicle: (
        Vehicle  # Numbers have the shape (members, 1, ...), or none where they are all members'
    )
    released: np.ndarray  # Times of the releases, shape (members, 1)
    limits: Limits

    coupled: ClassVar[slice] = slice(3, 4)
    first_step: ClassVar[float] = 600.0
    shortest: ClassVar[float] = 1e-3

    @property
    def failures(self) -> tuple[TerminationReason, ...]:
        return failures_of(self.vehicle.setup.flyer)

    def take(self, rows: np.ndarray) -> Any:
        members = len(self.released), 1
        if members == (1, 1):
            return self
        vehicle = tree.take_rows(self.vehicle, members, rows)
        return replace(self, vehicle=vehicle, released=self.released[rows])

    def local(
        self, elapsed: Any, states: Array, altitude: Array | None = None
    ) -> tuple[Array, Place, Surroundings]:
        """Altitude [m], place and surroundings of scaled states, or of others at an altitude."""
        altitude = states[..., 3] * ALTITUDE_SCALE if altitude is None else altitude
        place = Place(*latitude_and_longitude(states[..., :3]), self.released + elapsed)
        local = self.vehicle.surroundings(self.limits.inside(altitude), place, elapsed)
        return altitude, place, local

    def rate(self, elapsed: Any, states: Array) -> tuple[Array, Array]:
        """Rates [1/s], shape (members, n, 4), and the largest load, shape (members, n)."""
        vehicle, altitude = self.vehicle, states[..., 3] * ALTITUDE_SCALE
        floats = vehicle.setup.flyer.floats
        # a balloon's force a little higher tells how firmly it is held
        higher = _DIFFERENCE * altitude
        heights = np.stack([altitude, altitude + higher]) if floats else altitude
        _, place, local = self.local(elapsed, states, heights)
        heat = vehicle.heat(local)
        unknowns, load = heat.unknowns, self._largest_load(local, heat, heights.shape)
        forces = vehicle.forces(local, unknowns)
        axial, slope = steady_speeds(local, forces, unknowns)
        if floats:
            load = load[0]
            force = np.broadcast_to(forces.axial, heights.shape)
            axial = np.broadcast_to(axial, heights.shape)[0]
            axial = settle(axial, force[0], (force[0] - force[1]) / higher)
        moving = velocity(local, axial, slope)
        if floats:
            moving = Wind(*(np.broadcast_to(part, heights.shape)[0] for part in moving))
        return rate_of(moving, place, altitude, vehicle.planet), load

    def _largest_load(self, local: Surroundings, heat: Any, shape: tuple[int, ...]) -> Array:
        if not self.failures:
            return np.zeros(shape)
        return np.broadcast_to(loads(self.vehicle, local, heat).max(axis=0), shape)

    def loads(self, elapsed: Any, states: Array) -> Array:
        """Loads as :func:`~.failure.loads` has them, shape (members, n, failures)."""
        _, _, local = self.local(elapsed, states)
        found = loads(self.vehicle, local, self.vehicle.heat(local))
        return np.stack([np.broadcast_to(load, states.shape[:-1]) for load in found], axis=-1)


@dataclass(frozen=True)
class Moving(Balanced):
    """Flyers with inertia; without ``inertia`` heat is in balance."""

    # The mass of gas that moves with the flyer is left out, and so are the turning of the flyer
    # and what its speed does to heat.
    inertia: Inertia | None = None

    coupled: ClassVar[slice] = slice(3, None)
    first_step: ClassVar[float] = 0.05
    shortest: ClassVar[float] = 1e-8

    def __post_init__(self) -> None:
        flyer = self.vehicle.setup.flyer
        if flyer.flows:
            raise ParameterError(
                f"{type(flyer).__name__} has flows of gas, whose inertia is not known"
            )

    @property
    def failures(self) -> tuple[TerminationReason, ...]:
        found = failures_of(self.vehicle.setup.flyer)
        if self.inertia is None:
            return found
        # tension depends on the flyer's balance, which is not followed
        return tuple(end for end in found if end is TerminationReason.TOO_HOT)

    def at_release(self, start: Start) -> Array:
        """Scaled states of flyers that are released as warm as the gas; numbers (members, 1)."""
        local = self.vehicle.surroundings(start.altitude, start.place, xp.zeros(()))
        given = xp.stack(xp.broadcast_arrays(*local.wind, self.released)[:3], axis=-1)
        if start.velocity is not None:
            given = xp.asarray(start.velocity)
        moving = (given[..., None, :] @ _axes(start.place))[..., 0, :] / SPEED_SCALE
        nodes = 0 if self.inertia is None else len(self.vehicle.setup.flyer.nodes)
        warmth = xp.broadcast_to(local.state.temperature, self.released.shape)
        heat = xp.repeat(warmth[..., None], nodes, axis=-1) / _TEMPERATURE_SCALE
        return xp.concatenate([scale_state(start), moving, heat], axis=-1)

    def rate(self, elapsed: Any, states: Array) -> tuple[Array, Array]:
        """Rates [1/s], shape (members, n, components), and the largest load, (members, n)."""
        altitude, place, local = self.local(elapsed, states)
        vehicle, heating = self.vehicle, []
        if self.inertia is None:
            heat = vehicle.heat(local)
            unknowns, load = heat.unknowns, self._largest_load(local, heat, altitude.shape)
        else:
            load = self.loads(elapsed, states).max(axis=-1) if self.failures else 0.0 * altitude
            temperatures = xp.moveaxis(states[..., _HEAT], -1, 0) * _TEMPERATURE_SCALE
            unknowns = tuple(temperatures / local.state.temperature - 1.0)
            equations = FlightEquations(local.flyer, local.lit, vehicle.setup.model)
            powers = equations.powers(local.lit.radiation.irradiance)
            capacity = self.inertia.specific_heat * local.flyer.own_mass / len(local.flyer.nodes)
            both = zip(powers, equations.losses(unknowns), strict=True)
            heating = [(power - loss) / capacity for power, loss in both]
        ground = velocity_over_ground(states, place)
        # drag along the normal and across it are taken to be independent of each other
        flyer, state, attitude = local.flyer, local.state, local.flyer.attitude
        normal, down = (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
        if attitude is not None:
            sine, cosine = xp.sin(attitude.tilt), xp.cos(attitude.tilt)
            east, north = xp.sin(attitude.azimuth), xp.cos(attitude.azimuth)
            normal = sine * east, sine * north, cosine
            down = cosine * east, cosine * north, -sine
        forces = vehicle.forces(local, unknowns)
        through = [one - other for one, other in zip(ground, local.wind, strict=True)]
        axial = sum(one * other for one, other in zip(through, normal, strict=True))
        across = [one - axial * other for one, other in zip(through, normal, strict=True)]
        square = sum(one**2 for one in across)
        speed = xp.sqrt(xp.where(square > _SLOWEST**2, square, _SLOWEST**2))
        edgewise = flyer.drag(state, unknowns, speed, "edgewise") / speed
        broadside = flyer.drag(state, unknowns, axial, "broadside")
        share = 1.0 if local.drag is None else local.drag
        found = [
            (forces.axial * n + forces.slope * d - share * (broadside * n + edgewise * a))
            / flyer.mass
            for n, d, a in zip(normal, down, across, strict=True)
        ]
        speeding = xp.stack(xp.broadcast_arrays(*found), axis=-1)  # to the east, north and up
        speeding = (speeding[..., None, :] @ _axes(place))[..., 0, :]
        turning = xp.asarray([0.0, 0.0, 2.0 * vehicle.planet.rotation_rate])
        speeding = speeding - xp.cross(turning, states[..., MOVING] * SPEED_SCALE)  # Coriolis
        moving = rate_of(ground, place, altitude, vehicle.planet)
        warming = [xp.broadcast_to(one, altitude.shape)[..., None] for one in heating]
        warming = [one / _TEMPERATURE_SCALE for one in warming]
        return xp.concatenate([moving, speeding / SPEED_SCALE, *warming], axis=-1), load

    def loads(self, elapsed: Any, states: Array) -> Array:
        """Loads over what is borne [1], shape (members, n, failures)."""
        if self.inertia is None:
            return super().loads(elapsed, states)
        hottest = xp.max(states[..., _HEAT], axis=-1) * _TEMPERATURE_SCALE
        return (hottest / self.vehicle.setup.flyer.highest_temperature)[..., None]

    def is_balanced(self, elapsed: Any, states: Array) -> Array:
        """Whether flyers move as they do in balance, and go on doing so."""
        _, place, local = self.local(elapsed, states)
        axial, slope, inertia = in_balance(self.vehicle, local)
        balance, ground = velocity(local, axial, slope), velocity_over_ground(states, place)
        missed = _length(*(one - other for one, other in zip(ground, balance, strict=True)))
        share, beside = _CLOSE
        lasts = inertia < xp.minimum(INERTIA, _SLOW * (1.0 + elapsed / _PATIENCE))
        return lasts & (missed < share * xp.hypot(axial, slope) + beside)

    def conditions(self, elapsed: Any, states: Array) -> FlightConditions:
        """What flyers feel, shape (members, n)."""
        _, place, local = self.local(elapsed, states)
        ground, state = velocity_over_ground(states, place), local.state
        speed = _length(*(one - other for one, other in zip(ground, local.wind, strict=True)))
        speeding = SPEED_SCALE * _length(
            *xp.moveaxis(self.rate(elapsed, states)[0][..., MOVING], -1, 0)
        )
        density = state.gas.density(state.pressure, state.temperature)
        found = (speed, density, state.gas.heat_capacity(state.temperature), speeding)
        alike = (xp.broadcast_to(one, speed.shape) for one in found)
        return FlightConditions(xp.stack(ground, axis=-1), *alike)


def follow(
    vehicle: Vehicle, start: Start, limits: Limits, elapsed: Any, accuracy: Accuracy
) -> tuple[Track, Trajectory]:
    """Flight of one flyer in balance; ``elapsed``: times to keep, shape (times,)."""
    law = Balanced(vehicle, np.reshape(np.asarray(start.place.time, float), (1, 1)), limits)
    hours = float(np.max(elapsed)) / _HOUR

    def tell(share: float) -> None:
        if hours > 1.0:  # seconds are not worth a line
            report("flying", int(share * hours), int(hours), "h")

    found = integrate(law, np.reshape(scale(start), (1, -1)), elapsed, accuracy, tell)
    return tree.map_leaves(lambda leaf: leaf[0], found.track), found.trajectory


def _length(*components: Array) -> Array:
    return xp.sqrt(sum(one**2 for one in components))


def _axes(place: Place) -> Array:
    """East, north and up in the planet's frame, shape (..., 3, 3)."""
    to_east, to_north = directions(place.latitude, place.longitude)
    up = unit_vector(place.latitude, place.longitude)
    return xp.stack([to_east, to_north, up], axis=-2)
