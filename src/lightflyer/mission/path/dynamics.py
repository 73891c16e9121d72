"""The same flight with velocity and temperature as unknowns of their own.

A check of what :mod:`lightflyer.mission.path.integration` assumes: that both follow at once.
"""

from typing import Any

import jax.numpy as jnp
from jax import Array

from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Checked, SpecificHeat
from lightflyer.mission.path.failure import failures_of
from lightflyer.mission.path.integration import (
    Accuracy,
    Limits,
    Start,
    Track,
    altitude_and_place,
    controller,
    events,
    rate_of,
    save_at,
    scale_state,
    track_of,
)
from lightflyer.mission.path.motion import Craft, Surroundings, velocity
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.statics.equations import FlightEquations

SPECIFIC_HEAT = 1000.0
"""Specific heat of films where none is given [J/(kg K)]: between alumina and polymers."""

_TEMPERATURE_SCALE = 100.0  # kelvin
_SPEED_SCALE = 1.0  # metres a second
_FIRST_STEP, _SHORTEST_STEP = 1e-3, 1e-8  # seconds
_PLACE = 4  # entries of the state that say where the flyer is
_SPEEDS = 2


class Inertia(Checked):
    """What keeps a flyer's velocity and temperature from following at once.

    Attributes
    ----------
    specific_heat : array
        Heat capacity over mass, the same in all parts of the flyer [J/(kg K)]. Each part that has
        a temperature of its own has an equal share of the flyer's own mass.
    """

    specific_heat: SpecificHeat = SPECIFIC_HEAT


def track_with_inertia(
    craft: Craft,
    start: Start,
    limits: Limits,
    elapsed: Array,
    accuracy: Accuracy,
    inertia: Inertia,
) -> Track:
    """Trajectory of one flyer that is released at rest in the air, as warm as the gas."""
    # The mass of gas that moves with the flyer is left out, and so are the turning of the flyer and
    # the acceleration of the air.
    if craft.setup.flyer.flows:
        raise ParameterError(
            f"{type(craft.setup.flyer).__name__} has flows of gas, whose inertia is not known"
        )
    import diffrax

    def rate(time: Any, flown: Array, _: Any) -> Array:
        altitude, place = altitude_and_place(start, flown[:_PLACE], time)
        around = craft.surroundings(limits.inside(altitude), place, time)
        axial, slope = flown[_PLACE : _PLACE + _SPEEDS] * _SPEED_SCALE
        temperatures = flown[_PLACE + _SPEEDS :] * _TEMPERATURE_SCALE
        unknowns = tuple(temperatures / around.state.temperature - 1.0)
        speeding = _acceleration(craft, around, unknowns, axial, slope)
        heating = _heating(craft, around, unknowns, inertia)
        moving = rate_of(velocity(around, axial, slope), place, altitude, craft.planet)
        return jnp.concatenate([moving, speeding / _SPEED_SCALE, heating / _TEMPERATURE_SCALE])

    # tension depends on the flyer's balance, which is not followed here
    heat = TerminationReason.TOO_HOT
    failures = tuple(end for end in failures_of(craft.setup.flyer) if end is heat)

    def spare(_: Any, flown: Array) -> Array:
        hottest = jnp.max(flown[_PLACE + _SPEEDS :]) * _TEMPERATURE_SCALE
        return 1.0 - jnp.stack([hottest / jnp.asarray(craft.setup.flyer.highest_temperature)])

    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(rate),
        diffrax.Kvaerno5(),
        t0=elapsed[0],
        t1=elapsed[-1],
        dt0=_FIRST_STEP,
        y0=_state_at_rest(craft, start),
        saveat=save_at(elapsed),
        stepsize_controller=controller(accuracy, _SHORTEST_STEP),
        event=events(limits, failures, spare),
        max_steps=accuracy.steps,
        throw=False,
    )
    return track_of(solution, failures)


def _state_at_rest(craft: Craft, start: Start) -> Array:
    gas = craft.setup.environment.state(start.altitude, start.place).temperature
    nodes = jnp.full(len(craft.setup.flyer.nodes), gas / _TEMPERATURE_SCALE)
    return jnp.concatenate([scale_state(start), jnp.zeros(_SPEEDS), nodes])


def _acceleration(
    craft: Craft, around: Surroundings, unknowns: tuple[Array, ...], axial: Array, slope: Array
) -> Array:
    """Rates of the speeds through the air [m/s²]."""
    flyer, state = around.flyer, around.state
    forces = craft.forces(around, unknowns)
    along = forces.axial - flyer.drag(state, unknowns, axial, "broadside")
    down = jnp.zeros_like(along)
    if flyer.attitude is not None:
        down = forces.slope - flyer.drag(state, unknowns, slope, "edgewise")
    return jnp.stack([along, down]) / flyer.mass


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
