"""Loads: force of the gas, and the payload that it carries."""

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.statics.balance import Equilibrium, require_converged, solve_equilibrium
from lightflyer.statics.equations import FlightEquations


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
        If the model is not for the flyer or the gas, or its force is no number or has a shape that
        does not fit.

    Notes
    -----
    Differentiable in every number of flyer, state and model.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk, state = lf.Disk(film, radius=0.01), lf.lu2023_earth().state(72e3)
    >>> print(f"{lf.lift(disk, state, lf.Lu2023()) / lf.statics.weight(disk, state):.6f}")
    1.589948
    """
    equations = FlightEquations(flyer, state, model)
    force, _, balance = lift_and_payload(equations)
    if throw:
        require_converged("heat balance", balance.status, balance.residual)
        equations.require_force(force, balance.converged)
    return force


@elementwise_entry_point
def lift_and_payload(equations: FlightEquations) -> tuple[Array, Numeric, Equilibrium]:
    """Vertical force [N], the largest payload [kg], and the heat balance, converged or not."""
    balance = solve_equilibrium(equations)
    force = equations.upward_force(balance.unknowns)
    return force, equations.largest_payload(force), balance


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
    *components, balance = _force_vector(FlightEquations(flyer, state, model))
    if throw:
        require_converged("heat balance", balance.status, balance.residual)
    x, y, z = components
    return x, y, z


@elementwise_entry_point
def _force_vector(equations: FlightEquations) -> tuple[Array, Array, Array, Equilibrium]:
    balance, flyer = solve_equilibrium(equations), equations.flyer
    force = equations.model.force(flyer, equations.state, balance.unknowns)
    if flyer.attitude is None:
        return 0.0 * force, 0.0 * force, force, balance
    sideways = force * xp.sin(flyer.attitude.tilt)
    x, y = xp.cos(flyer.attitude.azimuth), xp.sin(flyer.attitude.azimuth)
    return sideways * x, sideways * y, force * xp.cos(flyer.attitude.tilt), balance


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
    _, mass, balance = lift_and_payload(FlightEquations(flyer, state, model))
    if throw:
        require_converged("heat balance", balance.status, balance.residual)
    return mass
