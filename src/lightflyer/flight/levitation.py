"""Levitation: lift, payload, the irradiance it takes, and the altitudes where it works."""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flight.balance import (
    SMALLEST_SHARE,
    Equilibrium,
    beam_area,
    equilibrium,
    infrared_power,
    require_converged,
    total_loss,
)
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.foundation.precision import elementwise_entry_point, entry_point
from lightflyer.foundation.rootfind import RootStatus, bracketed_power_newton, implicit_root
from lightflyer.foundation.types import Numeric

HIGHEST_TEMPERATURE = 3000.0
"""Where the search for a levitating temperature ends [K]: no film survives it, and the gas
correlations end below it."""


LOAD_TOLERANCE = 1e-10
"""Largest difference of force and weight of a converged levitation, over the weight."""


class Levitation(eqx.Module):
    """What it takes to levitate. Fields have the broadcast shape of the inputs.

    Attributes
    ----------
    irradiance : array
        Smallest irradiance of the beam that carries the flyer's weight [W/m²]; infinite where
        none does, zero where thermal radiation alone suffices.
    temperature : array
        Temperature of the flyer at that irradiance [K]; NaN where none suffices.
    levitates : bool array
        Whether any irradiance suffices.
    residual : array
        Force over weight, minus one [1].
    converged : bool array
        Whether the root-find met its tolerance, or found that there is no root.
    """

    irradiance: Numeric
    temperature: Numeric
    levitates: Numeric
    residual: Numeric
    converged: Numeric


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


def lift(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Array:
    """Photophoretic force on a flyer in the given light, before its weight.

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

    Notes
    -----
    Differentiable in every number of flyer, state and model.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk, state = lf.Disk(film, radius=0.01), lf.lu2023_earth().state(72e3)
    >>> print(f"{lf.lift(disk, state, lf.Lu2023()) / lf.weight(disk, state):.6f}")
    1.589948
    """
    force, _, balance = _lift_and_payload(flyer, state, model)
    if throw:
        require_converged("heat balance", balance.converged, balance.residual)
    return force


@elementwise_entry_point
def _lift_and_payload(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> tuple[Array, Array, Equilibrium]:
    balance = equilibrium(flyer, state, model, throw=False)
    force = model.force(flyer, state, balance.excess)
    return force, force / state.gravity - flyer.own_mass, balance


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
        Its own ``payload`` field plays no part.
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

    Notes
    -----
    Differentiable in every number of flyer, state and model.
    """
    _, mass, balance = _lift_and_payload(flyer, state, model)
    if throw:
        require_converged("heat balance", balance.converged, balance.residual)
    return mass


def levitate(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Levitation:
    """Smallest irradiance at which a flyer carries its weight, and its temperature then.

    The irradiance of ``state`` plays no part, its incidence and thermal surroundings do.

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    model : AbstractForceModel
    throw : bool
        Raise where an element has not converged (not under JAX's transformations). A flyer
        that no irradiance lifts is an answer, not an error.

    Returns
    -------
    Levitation

    Raises
    ------
    ConvergenceError
        If an element has not converged and ``throw`` is true.

    Notes
    -----
    Differentiable in every number of flyer, state and model where the flyer levitates.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> state = lf.lu2023_earth().state(72e3)
    >>> result = lf.levitate(lf.Disk(film, radius=0.01), state, lf.Lu2023())
    >>> print(f"{result.irradiance:.3f} W/m², {result.temperature:.4f} K")
    811.018 W/m², 323.6874 K
    """
    result = _levitate(flyer, state, model)
    if throw:
        require_converged("levitation", result.converged, result.residual)
    return result


@elementwise_entry_point
def _levitate(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> Levitation:
    def force(excess: Array) -> Array:
        return model.force(flyer, state, excess)

    load = weight(flyer, state)
    hottest = HIGHEST_TEMPERATURE / state.temperature - 1.0
    strongest = force(hottest)
    levitates = (strongest >= load) & (jnp.cos(state.radiation.incidence) > 0.0)
    # Where no temperature suffices, a load within reach stands in, to be discarded below: so
    # neither the search nor its derivative meets a NaN.
    within_reach = jnp.where(strongest == 0.0, 1.0, 0.5 * jnp.abs(strongest))
    target = jnp.where(levitates, load, within_reach)

    def reached(excess: Array) -> Array:
        pushed = jnp.sign(strongest) * force(excess)
        return jnp.where(strongest == 0.0, excess / hottest, pushed)

    def search() -> tuple[Array, RootStatus]:
        return bracketed_power_newton(
            reached,
            target=target,
            lower=hottest * SMALLEST_SHARE,
            upper=hottest,
            guess=hottest * target / reached(hottest),
        )

    excess, status = implicit_root(
        lambda excess: reached(excess) - target, search, jnp.shape(target)
    )
    needed = total_loss(flyer, state, model, excess) - infrared_power(flyer, state)
    collecting = beam_area(flyer, state)
    irradiance = needed / jnp.where(collecting > 0.0, collecting, 1.0)
    levitates &= collecting > 0.0
    residual = jnp.where(levitates, force(excess) / load - 1.0, 0.0)
    held = status.converged & (jnp.abs(residual) <= LOAD_TOLERANCE)
    return Levitation(
        irradiance=jnp.where(levitates, jnp.maximum(irradiance, 0.0), jnp.inf),
        temperature=jnp.where(levitates, state.temperature * (1.0 + excess), jnp.nan),
        levitates=levitates,
        residual=residual,
        converged=~jnp.isnan(strongest) & (held | ~levitates),
    )
