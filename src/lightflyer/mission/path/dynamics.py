"""Flight with velocity and temperature as unknowns of their own.

From a rocket or an aircraft a flyer starts with their velocity. It is also a check of what
:mod:`lightflyer.mission.path.integration` assumes: that both follow at once.
"""

from typing import Any

from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Checked, SpecificHeat
from lightflyer.environment.base import Place, Wind
from lightflyer.mission.path.failure import failures_of
from lightflyer.mission.path.integration import (
    Accuracy,
    Limits,
    Start,
    Track,
    altitude_and_place,
    controller,
    events,
    loads_of_state,
    rate_of,
    save_at,
    scale_state,
    track_of,
)
from lightflyer.mission.path.motion import INERTIA, Craft, Surroundings, in_balance, velocity
from lightflyer.mission.path.position import directions, unit_vector
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.pytree.lazy_jax import Array, jnp
from lightflyer.pytree.module import Module
from lightflyer.statics.equations import FlightEquations

SPECIFIC_HEAT = 1000.0
"""Specific heat of films where none is given [J/(kg K)]: between alumina and polymers."""

SPEED_SCALE = 100.0
"""Speed that counts as much as one radian along the ground [m/s]."""

_TEMPERATURE_SCALE = 100.0  # kelvin
_FIRST_STEP, _SHORTEST_STEP = 1e-3, 1e-8  # seconds
PLACE = slice(0, 4)  # entries of the state that say where the flyer is
MOVING = slice(4, 7)  # its velocity over ground, in the planet's frame
_HEAT = slice(7, None)  # its temperatures
_SLOWEST = 1e-9  # Speed across a normal below which it has no direction [m/s]
_CLOSE = 0.01, 1.0
"""To the velocity in balance: over its size [1], and beside [m/s], by which shear and waves of the
air are never followed wholly."""
_SLOW, _PATIENCE = 1e-3, 60.0
"""Of :data:`~.motion.INERTIA`, for falls to end within metres, and the time that adds as much [s]:
what is heavy never falls as slowly."""


class Inertia(Checked):
    """What keeps a flyer's velocity and temperature from following at once.

    Attributes
    ----------
    specific_heat : array
        Heat capacity over mass, the same in all parts of the flyer [J/(kg K)]. Each part that has
        a temperature of its own has an equal share of the flyer's own mass.
    """

    specific_heat: SpecificHeat = SPECIFIC_HEAT


class Thrown(Module):
    """A trajectory with inertia."""

    track: Track
    states: Array  # Scaled, shape (times, n); infinite after the end
    end: Array  # State at the end, shape (n,)


def state_at_release(craft: Craft, start: Start, inertia: Inertia | None) -> Array:
    """Scaled state of a flyer that is released as warm as the gas."""
    around = craft.surroundings(start.altitude, start.place, jnp.zeros(()))
    given = jnp.stack(around.wind) if start.velocity is None else jnp.asarray(start.velocity)
    nodes = 0 if inertia is None else len(craft.setup.flyer.nodes)
    warmth = jnp.full(nodes, around.state.temperature / _TEMPERATURE_SCALE)
    moving = jnp.asarray(given) @ _axes(start.place) / SPEED_SCALE
    return jnp.concatenate([scale_state(start), moving, warmth])


def velocity_over_ground(state: Array, place: Place) -> Wind:
    """Velocity of a scaled state [m/s]."""
    return Wind(*(_axes(place) @ state[MOVING] * SPEED_SCALE))


def track_with_inertia(
    craft: Craft,
    start: Start,
    state: Array,
    limits: Limits,
    elapsed: Array,
    accuracy: Accuracy,
    inertia: Inertia | None,
) -> Thrown:
    """Trajectory of one flyer from a scaled state on; ``elapsed``: shape (times,).

    Without ``inertia`` heat is in balance, and steps are explicit: for minutes.
    """
    import diffrax

    given = craft, start, limits, inertia
    failures = failures_with_inertia(craft, inertia)
    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(lambda time, flown, _: rate_with_inertia(*given, time, flown)),
        diffrax.Tsit5() if inertia is None else diffrax.Kvaerno5(),
        t0=elapsed[0],
        t1=elapsed[-1],
        dt0=_FIRST_STEP,
        y0=state,
        saveat=save_at(elapsed),
        stepsize_controller=controller(accuracy, _SHORTEST_STEP),
        event=events(
            limits, failures, lambda time, flown: 1.0 - loads_with_inertia(*given, time, flown)
        ),
        max_steps=accuracy.steps,
        throw=False,
    )
    results: Any = solution
    states, last = results.ys
    return Thrown(track_of(solution, failures), states, last[0])


def failures_with_inertia(craft: Craft, inertia: Inertia | None) -> tuple[TerminationReason, ...]:
    """What :func:`loads_with_inertia` has, in its order."""
    # The mass of gas that moves with the flyer is left out, and so are the turning of the flyer
    # and what its speed does to heat.
    if craft.setup.flyer.flows:
        raise ParameterError(
            f"{type(craft.setup.flyer).__name__} has flows of gas, whose inertia is not known"
        )
    failures = failures_of(craft.setup.flyer)
    if inertia is None:
        return failures
    # tension depends on the flyer's balance, which is not followed
    return tuple(end for end in failures if end is TerminationReason.TOO_HOT)


def loads_with_inertia(
    craft: Craft, start: Start, limits: Limits, inertia: Inertia | None, elapsed: Any, flown: Array
) -> Array:
    """Loads over what is borne in a scaled state [1], shape (failures,)."""
    if inertia is None:
        return loads_of_state(craft, start, limits, elapsed, flown[PLACE])
    hottest = jnp.max(flown[_HEAT]) * _TEMPERATURE_SCALE
    return jnp.stack([hottest / jnp.asarray(craft.setup.flyer.highest_temperature)])


def rate_with_inertia(
    craft: Craft, start: Start, limits: Limits, inertia: Inertia | None, elapsed: Any, flown: Array
) -> Array:
    """Rate of a scaled state [1/s], shape (n,)."""
    altitude, place, around = _around(craft, start, limits, elapsed, flown)
    if inertia is None:
        unknowns, heating = craft.heat(around).unknowns, jnp.zeros(0)
    else:
        temperatures = flown[_HEAT] * _TEMPERATURE_SCALE
        unknowns = tuple(temperatures / around.state.temperature - 1.0)
        heating = _heating(craft, around, unknowns, inertia)
    ground = velocity_over_ground(flown, place)
    speeding = _acceleration(craft, around, unknowns, ground) @ _axes(place)
    turning = jnp.array([0.0, 0.0, 2.0]) * craft.planet.rotation_rate
    speeding -= jnp.cross(turning, flown[MOVING] * SPEED_SCALE)  # Coriolis
    moving = rate_of(ground, place, altitude, craft.planet)
    return jnp.concatenate([moving, speeding / SPEED_SCALE, heating / _TEMPERATURE_SCALE])


def is_balanced(craft: Craft, start: Start, limits: Limits, elapsed: Array, flown: Array) -> Array:
    """Whether a flyer moves as it does in balance, and goes on doing so."""
    _, place, around = _around(craft, start, limits, elapsed, flown)
    axial, slope, inertia = in_balance(craft, around)
    balance = jnp.stack(velocity(around, axial, slope))
    missed = jnp.linalg.norm(jnp.stack(velocity_over_ground(flown, place)) - balance)
    share, beside = _CLOSE
    lasts = inertia < jnp.minimum(INERTIA, _SLOW * (1.0 + elapsed / _PATIENCE))
    return lasts & (missed < share * jnp.hypot(axial, slope) + beside)


def feel(
    craft: Craft, start: Start, limits: Limits, elapsed: Any, flown: Array, inertia: Inertia | None
) -> tuple[Array, ...]:
    """What a flyer feels, as :class:`~lightflyer.mission.first_seconds.Felt` has it."""
    _, place, around = _around(craft, start, limits, elapsed, flown)
    ground, state = jnp.stack(velocity_over_ground(flown, place)), around.state
    speed = jnp.linalg.norm(ground - jnp.stack(around.wind))
    density = state.gas.density(state.pressure, state.temperature)
    rate = rate_with_inertia(craft, start, limits, inertia, elapsed, flown)
    speeding = SPEED_SCALE * jnp.linalg.norm(rate[MOVING])
    return ground, speed, density, state.gas.heat_capacity(state.temperature), speeding


def _axes(place: Place) -> Array:
    """East, north and up in the planet's frame, shape (3, 3)."""
    to_east, to_north = directions(place.latitude, place.longitude)
    return jnp.stack([to_east, to_north, unit_vector(place.latitude, place.longitude)])


def _around(
    craft: Craft, start: Start, limits: Limits, elapsed: Any, flown: Array
) -> tuple[Array, Place, Surroundings]:
    altitude, place = altitude_and_place(start, flown[PLACE], elapsed)
    return altitude, place, craft.surroundings(limits.inside(altitude), place, elapsed)


def _acceleration(
    craft: Craft, around: Surroundings, unknowns: tuple[Array, ...], ground: Wind
) -> Array:
    """Rate of the velocity by all forces, towards east, north and up [m/s²]."""
    # drag along the normal and across it are taken to be independent of each other
    flyer, state, attitude = around.flyer, around.state, around.flyer.attitude
    normal, down = jnp.array([0.0, 0.0, 1.0]), jnp.zeros(3)
    if attitude is not None:
        sine, cosine = jnp.sin(attitude.tilt), jnp.cos(attitude.tilt)
        east, north = jnp.sin(attitude.azimuth), jnp.cos(attitude.azimuth)
        normal = jnp.stack([sine * east, sine * north, cosine])
        down = jnp.stack([cosine * east, cosine * north, -sine])
    forces = craft.forces(around, unknowns)
    through = jnp.stack(ground) - jnp.stack(around.wind)
    axial = through @ normal
    across = through - axial * normal
    moves = across @ across > _SLOWEST**2
    speed = jnp.sqrt(jnp.where(moves, across @ across, _SLOWEST**2))
    edgewise = flyer.drag(state, unknowns, speed, "edgewise") * across / speed
    drag = flyer.drag(state, unknowns, axial, "broadside") * normal + edgewise
    share = 1.0 if around.drag is None else around.drag
    return (forces.axial * normal + forces.slope * down - share * drag) / flyer.mass


def _heating(
    craft: Craft, around: Surroundings, unknowns: tuple[Array, ...], inertia: Inertia
) -> Array:
    """Rates of the temperatures [K/s]."""
    flyer, state = around.flyer, around.lit
    equations = FlightEquations(flyer, state, craft.setup.model)
    powers, losses = equations.powers(state.radiation.irradiance), equations.losses(unknowns)
    capacity = inertia.specific_heat * flyer.own_mass / len(flyer.nodes)
    balance = [power - loss for power, loss in zip(powers, losses, strict=True)]
    return jnp.stack(balance) / capacity
