"""How fast a flyer sinks or climbs where drag balances its weight and lift."""

from collections.abc import Callable
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.checks import is_concrete
from lightflyer.core.entry_point import elementwise_entry_point, reads_units
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Altitude, require_record
from lightflyer.environment.base import AbstractEnvironment, EnvironmentState, Place
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.numerics.rootfind import (
    RootOutcome,
    SolverStatus,
    find_power_root,
    implicit_root,
)
from lightflyer.statics.balance import require_converged, solve_equilibrium
from lightflyer.statics.equations import FlightEquations, weight

_SLOW = 1e-6  # Speed at which drag is proportional to it, far below those of flight [m/s]

_BRACKET = (1e-6, 1.0 + 1e-6)
"""Range of the speed, over that of a drag proportional to it: inertia only adds to drag."""

_NODES = 64  # Points of Gauss's quadrature over the altitude, for the time of a descent
_NODES_OF_NIGHT = 24  # The same within a band of altitudes, good to 1e-4


class Sinking(Module):
    """Steady speeds of sinking, converged or not."""

    speed: Array  # Downward positive, through the gas [m/s]
    status: Array  # Why the search ended
    residual: Numeric  # Of the heat balance [1]

    @property
    def converged(self) -> Array:
        return self.status == SolverStatus.CONVERGED


def steady_speed(drag: Callable[[Array], Array], force: Array) -> tuple[Array, RootOutcome]:
    """Speed at which a drag balances a force.

    Parameters
    ----------
    drag : callable
        Odd, increasing function of the speed [m/s], elementwise [N]; at least proportional to it.
    force : array, shape (...)
        Of either sign [N].

    Returns
    -------
    speed : array, shape (...)
        Of the sign of the force [m/s]. Differentiable in all that ``drag`` and ``force`` use.
    outcome : RootOutcome
    """
    size = xp.abs(force)
    at_rest = size == 0.0
    slope = drag(xp.full_like(force, _SLOW)) / _SLOW
    target = xp.where(at_rest, slope * _SLOW, size)
    fastest = target / slope

    def search() -> tuple[Array, RootOutcome]:
        lower, upper = (share * fastest for share in _BRACKET)
        found, outcome = find_power_root(drag, target, lower, upper, guess=fastest)
        return xp.where(at_rest, 0.0, xp.sign(force) * found), outcome

    return implicit_root(lambda speed: drag(speed) - force, search)


def sinking_speed(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel | None = None,
    *,
    throw: bool = True,
) -> Array:
    """Speed at which a level flyer sinks steadily.

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    model : AbstractForceModel, optional
        For temperature and lift in the light of ``state``, of which :func:`in_the_dark` leaves heat
        radiation alone. Without one the flyer is as warm as the gas and has no lift but its
        buoyancy.
    throw : bool
        Raise where an element has not converged (not under JAX's transformations).

    Returns
    -------
    array, broadcast shape
        Downward positive, through the gas; negative where the flyer climbs [m/s].

    Raises
    ------
    ConvergenceError
        If an element has not converged and ``throw`` is true.
    ParameterError
        If the flyer is tilted, or the model is not for the flyer or the gas.
    ConfigurationError
        If the flyer has no law of drag.

    Notes
    -----
    Force and heat balance are those of the flyer at rest. Differentiable in every number of flyer,
    state and model. :meth:`AbstractFlyer.drag_diagnostics` says where
    the drag is outside its range.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk, state = lf.Disk(film, radius=0.01), lf.Earth().state(70e3)
    >>> print(f"{lf.statics.sinking_speed(disk, state):.2f} m/s")
    1.38 m/s
    """
    attitude = flyer.attitude
    if attitude is not None and is_concrete(attitude.tilt) and np.any(attitude.tilt != 0.0):
        raise ParameterError("sinking_speed is for a level flyer: a tilted one glides, see fly()")
    if model is None:
        require_record("flyer", (AbstractFlyer,), flyer)
        require_record("state", (EnvironmentState,), state)
        found = _sinking_cold(flyer, state)
    else:
        found = sinking(FlightEquations(flyer, state, model))
    if throw:
        require_converged("sinking speed", found.status, found.residual)
    return found.speed


@elementwise_entry_point
def _sinking_cold(flyer: AbstractFlyer, state: EnvironmentState) -> Sinking:
    unknowns = (xp.zeros(()),) * (len(flyer.nodes) + len(flyer.flows))
    return Sinking(*_steady(flyer, state, unknowns, flyer.buoyancy(state, unknowns)), 0.0)


@elementwise_entry_point
def sinking(equations: FlightEquations) -> Sinking:
    """Steady speed of a level flyer that is as warm as its light makes it."""
    balance = solve_equilibrium(equations)
    lift = equations.upward_force(balance.unknowns)
    speed, status = _steady(equations.flyer, equations.state, balance.unknowns, lift)
    return Sinking(speed, xp.maximum(status, balance.status), balance.residual)


def _steady(
    flyer: AbstractFlyer, state: EnvironmentState, unknowns: tuple[Array, ...], lift: Numeric
) -> tuple[Array, Array]:
    slow = flyer.drag(state, unknowns, xp.full_like(lift, _SLOW))
    force = weight(flyer, state) - lift + xp.zeros_like(slow)
    speed, outcome = steady_speed(lambda speed: flyer.drag(state, unknowns, speed), force)
    return speed, outcome.status


def in_the_dark(state: EnvironmentState) -> EnvironmentState:
    """The same surroundings without light; heat radiation stays.

    Parameters
    ----------
    state : EnvironmentState

    Returns
    -------
    EnvironmentState
    """
    return tree.replace_at(
        lambda state: (state.radiation.irradiance, state.radiation.diffuse_above),
        state,
        (xp.zeros_like(state.radiation.irradiance), 0.0),
    )


@reads_units
def settling_time(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel | None = None,
    *,
    start: Altitude,
    end: Altitude,
    place: Place | None = None,
) -> float:
    """Time that a level flyer takes to sink from one altitude to another in the dark.

    Parameters
    ----------
    flyer : AbstractFlyer
    environment : AbstractEnvironment
        With an altitude.
    model : AbstractForceModel, optional
        As for :func:`sinking_speed`.
    start, end : array, shape ()
        Altitudes, the first one above the other [m].
    place : Place, optional
        Held throughout.

    Returns
    -------
    float
        [s].

    Raises
    ------
    ParameterError
        If the environment has no altitude, ``start`` is not above ``end``, or the flyer climbs
        somewhere between.

    Notes
    -----
    The speed is steady at every altitude. Wind is left out.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk = lf.Disk(film, radius=0.01)
    >>> time = lf.statics.settling_time(disk, lf.Earth(), start=75e3, end=50e3)
    >>> print(f"{time / 3600:.2f} h")
    5.80 h
    """
    if environment.coordinate.name != "altitude":
        raise ParameterError("settling_time needs an environment with an altitude")
    if np.ndim(start) or np.ndim(end) or not start > end:
        raise ParameterError("start is not above end: settling_time takes one altitude each")
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    altitudes = 0.5 * (start - end) * nodes + 0.5 * (start + end)
    state = environment.state(altitudes, place)
    speed = sinking_speed(flyer, in_the_dark(state), model)
    if np.any(speed <= 0.0):
        where = altitudes[int(np.argmin(speed))]
        raise ParameterError(f"the flyer does not sink in the dark at {where:.4g} m")
    return float(0.5 * (start - end) * np.sum(weights / speed))


def sinks_level(flyer: AbstractFlyer) -> bool:
    """Whether a flyer has a law of drag and is level, and so a steady speed."""
    attitude = flyer.attitude
    tilted = attitude is not None and is_concrete(attitude.tilt) and np.any(attitude.tilt != 0.0)
    return not tilted and type(flyer).drag is not AbstractFlyer.drag


def night_places(start: Numeric, end: Numeric) -> Any:
    """Altitudes whose speeds give the time of a descent, shape (..., 24) [m]; ends (...)."""
    nodes, _ = np.polynomial.legendre.leggauss(_NODES_OF_NIGHT)
    return 0.5 * ((start - end)[..., None] * nodes + (start + end)[..., None])


def night_length(start: Numeric, end: Numeric, speed: Any) -> Any:
    """Time to sink from one altitude to another [s]; ``speed``: at :func:`night_places`."""
    # infinite for a flyer that stays up
    _, weights = np.polynomial.legendre.leggauss(_NODES_OF_NIGHT)
    xp = speed.__array_namespace__()
    stays = speed <= 0.0
    slowness = xp.where(stays, xp.inf, 1.0 / xp.where(stays, 1.0, speed))
    return 0.5 * (start - end) * xp.sum(weights * slowness, axis=-1)


def night_change(ends: Any, speed: Any, change: Any, slope: Any, moves: Any) -> Any:
    """How :func:`night_length` changes [s].

    ``ends``: start and end, ``moves``: their changes. ``speed``, its ``change`` at each of the
    :func:`night_places` and its ``slope`` over the altitude: shape (24,).
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES_OF_NIGHT)
    depth, deeper = ends[0] - ends[1], moves[0] - moves[1]
    shift = 0.5 * (deeper * nodes + moves[0] + moves[1])
    slower = -(change + slope * shift) / speed**2
    return 0.5 * np.sum(weights * (deeper / speed + depth * slower))
