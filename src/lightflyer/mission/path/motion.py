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

from collections.abc import Callable
from dataclasses import replace

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.errors import ParameterError
from lightflyer.design.setup import Setup
from lightflyer.drag.disk import Direction
from lightflyer.environment.base import AbstractEnvironment, EnvironmentState, Place, Wind
from lightflyer.environment.planet import Planet
from lightflyer.environment.radiation import Attitude
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Moment
from lightflyer.mission.path.waves import Waves
from lightflyer.mission.path.wind_error import WindError
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


class Craft(Module):
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

    def heat(self, around: Surroundings) -> Equilibrium:
        return equilibrium(around.flyer, around.lit, self.setup.model, throw=False)

    def forces(self, around: Surroundings, unknowns: tuple[Array, ...]) -> Forces:
        """Forces in some surroundings."""
        flyer, state = around.flyer, around.state
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
    around: Surroundings, forces: Forces, unknowns: tuple[Array, ...]
) -> tuple[Array, Array]:
    """Speeds through the air at which drag balances the other forces [m/s]."""
    flyer, state = around.flyer, around.state
    drag = 1.0 if around.drag is None else around.drag  # which the law's balances force / drag

    def speed_of(force: Array, direction: Direction) -> Array:
        return _speed(lambda speed: flyer.drag(state, unknowns, speed, direction), force / drag)

    axial = speed_of(forces.axial, "broadside")
    if flyer.attitude is None:
        return axial, xp.zeros_like(axial)
    return axial, speed_of(forces.slope, "edgewise")


def in_balance(craft: Craft, around: Surroundings) -> tuple[Array, Array, Array]:
    """Steady speeds [m/s], and what :data:`INERTIA` is the most of [1]."""
    unknowns = craft.heat(around).unknowns
    axial, slope = steady_speeds(around, craft.forces(around, unknowns), unknowns)
    thermal = around.state.gas.specific_gas_constant * around.state.temperature
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


def velocity(around: Surroundings, axial: Array, slope: Array) -> Wind:
    """Velocity over ground of a flyer that moves through the air [m/s]; east, north and up."""
    wind, attitude = around.wind, around.flyer.attitude
    if attitude is None:
        return Wind(wind.east, wind.north, wind.up + axial)
    cosine, sine = xp.cos(attitude.tilt), xp.sin(attitude.tilt)
    outwards = axial * sine + slope * cosine
    return Wind(
        wind.east + outwards * xp.sin(attitude.azimuth),
        wind.north + outwards * xp.cos(attitude.azimuth),
        wind.up + axial * cosine - slope * sine,
    )


def _speed(drag: Callable[[Array], Array], force: Array) -> Array:
    """Signed speed at which an odd, increasing drag balances a force."""
    sign, size = xp.sign(force), xp.abs(force)
    at_rest = size == 0.0
    slope = drag(xp.full_like(force, _SLOW)) / _SLOW
    target = xp.where(at_rest, slope * _SLOW, size)
    proportional = target / slope

    def search() -> tuple[Array, RootOutcome]:
        found, outcome = find_power_root(
            drag,
            target=target,
            lower=_SLOWEST * proportional,
            upper=_FASTEST * proportional,
            guess=proportional,
        )
        return xp.where(at_rest, 0.0, sign * found), outcome

    speed, _ = implicit_root(lambda speed: drag(speed) - force, search)
    return speed


def planet_of(environment: AbstractEnvironment) -> Planet:
    """The planet that an environment is on."""
    planet = environment.planet
    if planet is None:
        raise ParameterError(
            f"a mission needs a planet below it, which {type(environment).__name__} has not"
        )
    return planet
