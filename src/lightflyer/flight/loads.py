"""Loads: weight, force of the gas, and the payload that it carries."""

import jax.numpy as jnp
from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.environment.base import EnvironmentState
from lightflyer.flight.balance import (
    Equilibrium,
    equilibrium,
    require_converged,
    require_suitable,
)
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.program.entry_point import elementwise_entry_point, entry_point


@entry_point
def weight(flyer: AbstractFlyer, state: EnvironmentState) -> Numeric:
    """Weight of a flyer with its payload [N].

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState

    Returns
    -------
    array, broadcast shape
    """
    return flyer.mass * state.gravity


def upward_force(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    unknowns: tuple[Array, ...],
) -> Array:
    """Vertical part of the gas's force, and the flyer's buoyancy [N]."""
    force = model.force(flyer, state, unknowns)
    if flyer.attitude is not None:
        force = force * jnp.cos(flyer.attitude.tilt)
    return force + buoyancy(flyer, state, model, unknowns)


def buoyancy(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    unknowns: tuple[Array, ...],
) -> Numeric:
    """Buoyancy that a model adds to its force [N]; zero for a published model that has none."""
    if not model.adds_buoyancy:
        return 0.0 * unknowns[0]
    return flyer.buoyancy(state, unknowns)


def largest_payload(flyer: AbstractFlyer, state: EnvironmentState, lift: Numeric) -> Numeric:
    """Mass that a lift carries beside the flyer's own [kg]."""
    return lift / state.gravity - flyer.own_mass


def lift(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Array:
    """Vertical force on a flyer in the given light, before its weight.

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    model : AbstractForceModel
    throw : bool
        Raise where the heat balance has not converged (not under JAX's transformations).

    Returns
    -------
    array, broadcast shape
        Force, upward positive [N].

    Raises
    ------
    ConvergenceError
        If the heat balance has not converged and ``throw`` is true.
    ParameterError
        If the model is not for the flyer or the gas.

    Notes
    -----
    Differentiable in every number of flyer, state and model.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk, state = lf.Disk(film, radius=0.01), lf.lu2023_earth().state(72e3)
    >>> print(f"{lf.lift(disk, state, lf.Lu2023()) / lf.flight.weight(disk, state):.6f}")
    1.589948
    """
    require_suitable(flyer, state, model)
    force, _, balance = _lift_and_payload(flyer, state, model)
    if throw:
        require_converged("heat balance", balance.status, balance.residual)
    return force


@elementwise_entry_point
def _lift_and_payload(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> tuple[Array, Numeric, Equilibrium]:
    balance = equilibrium(flyer, state, model, throw=False)
    force = upward_force(flyer, state, model, balance.unknowns)
    return force, largest_payload(flyer, state, force), balance


def force_vector(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> tuple[Array, Array, Array]:
    """Force of the gas on a flyer in the given light, in three directions.

    Parameters
    ----------
    flyer, state, model, throw
        As for :func:`lift`.

    Returns
    -------
    x, y, z : array, broadcast shape
        Components [N]: ``x`` towards azimuth 0, ``y`` towards azimuth 90°, ``z`` up. Buoyancy is
        not part of them.

    Raises
    ------
    ConvergenceError
        If the heat balance has not converged and ``throw`` is true.
    """
    require_suitable(flyer, state, model)
    *components, balance = _force_vector(flyer, state, model)
    if throw:
        require_converged("heat balance", balance.status, balance.residual)
    x, y, z = components
    return x, y, z


@elementwise_entry_point
def _force_vector(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> tuple[Array, Array, Array, Equilibrium]:
    balance = equilibrium(flyer, state, model, throw=False)
    force = model.force(flyer, state, balance.unknowns)
    if flyer.attitude is None:
        return 0.0 * force, 0.0 * force, force, balance
    sideways = force * jnp.sin(flyer.attitude.tilt)
    x, y = jnp.cos(flyer.attitude.azimuth), jnp.sin(flyer.attitude.azimuth)
    return sideways * x, sideways * y, force * jnp.cos(flyer.attitude.tilt), balance


def payload(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Array:
    """Largest mass that a flyer carries beside its own in the given light.

    Parameters
    ----------
    flyer : AbstractFlyer
        Its own ``payload`` field has no effect.
    state : EnvironmentState
    model : AbstractForceModel
    throw : bool
        Raise where the heat balance has not converged (not under JAX's transformations).

    Returns
    -------
    array, broadcast shape
        Mass [kg]; negative by what is missing where the flyer cannot lift itself.

    Raises
    ------
    ConvergenceError
        If the heat balance has not converged and ``throw`` is true.
    ParameterError
        If the model is not for the flyer or the gas.

    Notes
    -----
    Differentiable in every number of flyer, state and model.
    """
    require_suitable(flyer, state, model)
    _, mass, balance = _lift_and_payload(flyer, state, model)
    if throw:
        require_converged("heat balance", balance.status, balance.residual)
    return mass
