"""Levitation: the irradiance that it takes."""

from collections.abc import Callable
from functools import partial

import equinox as eqx
import jax
import jax.numpy as jnp
from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.environment.base import EnvironmentState
from lightflyer.files.display_units import number_text
from lightflyer.files.result_text import Parts, PrintedResult, rows_of
from lightflyer.flight.balance import (
    SMALLEST_SHARE,
    balance_solver,
    imbalance_of,
    light_and_gains,
    node_losses,
    require_converged,
    require_suitable,
    status_lines,
    status_within,
    total,
)
from lightflyer.flight.loads import upward_force, weight
from lightflyer.flight.minimum_irradiance import find_least_light
from lightflyer.flyer.base import HIGHEST_TEMPERATURE, AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.numerics.rootfind import (
    RootOutcome,
    SolverStatus,
    bracketed_power_newton,
    implicit_root,
)
from lightflyer.numerics.system import implicit_system
from lightflyer.program.entry_point import elementwise_entry_point

HIGHEST_IRRADIANCE = 1e7
"""Irradiance above which nothing levitates [W/m²]: two black faces at the highest temperature of
the search emit a little less, so a flyer that needs more hardly absorbs its light or has melted."""

LOAD_TOLERANCE = 1e-10
"""Largest difference of force and weight of a converged levitation, over the weight."""


class Levitation(PrintedResult, eqx.Module):
    """Light and temperature at which a flyer just levitates.

    Fields have the broadcast shape of the inputs.
    """

    #: Smallest irradiance of the beam that carries the flyer's weight [W/m²]; infinite where none
    #: up to :data:`HIGHEST_IRRADIANCE` does, zero where thermal radiation alone suffices
    irradiance: Numeric
    #: Temperature of the hottest node at that irradiance [K]; NaN where none suffices
    temperature: Numeric
    levitates: Numeric  #: Whether any irradiance suffices
    residual: Numeric  #: Force over weight, minus one [1]
    #: Why the search ended, a :class:`~lightflyer.numerics.rootfind.SolverStatus`. That no
    #: irradiance suffices is an answer: converged
    status: Numeric

    def text_parts(self) -> Parts:
        """Lines and tables of the text."""
        yield rows_of(
            {
                "irradiance to levitate": number_text(self.irradiance, "W/m²"),
                "temperature then": number_text(self.temperature, "K"),
            }
        )
        yield from status_lines(self.status)

    @property
    def converged(self) -> Numeric:
        """True where the root-find met its tolerance, or found that there is no root."""
        return self.status == SolverStatus.CONVERGED


def levitate(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Levitation:
    """Smallest irradiance at which a flyer carries its weight, and its temperature then.

    The irradiance of ``state`` has no effect; its direction and thermal surroundings do.

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
    ParameterError
        If the model is not for the flyer or the gas.

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
    require_suitable(flyer, state, model)
    result = _levitate(flyer, state, model)
    if throw:
        require_converged("levitation", result.status, result.residual)
    return result


@elementwise_entry_point
def _levitate(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> Levitation:
    lifts_cold = type(flyer).buoyancy is not AbstractFlyer.buoyancy
    lifts_cold |= model.pushes_unheated(flyer, state)
    if len(flyer.nodes) == 1 and not flyer.flows and not lifts_cold:
        return _by_temperature(flyer, state, model)
    return _by_irradiance(flyer, state, model)


def _reach(
    function: Callable[[Array], Array], top: Array, strongest: Array, load: Array
) -> tuple[Array, Array, RootOutcome]:
    """Find where an increasing force reaches the load; ``top``: upper end of the argument."""
    within = strongest >= load
    # Where no argument suffices, a load within reach stands in, to be discarded by the caller: so
    # neither the search nor its derivative meets a NaN.
    reached_at_top = jnp.where(strongest == 0.0, 1.0, jnp.abs(strongest))
    stand_in = jnp.where(strongest == 0.0, 1.0, 0.5 * reached_at_top)
    target = jnp.where(within, load, stand_in)

    def reached(argument: Array) -> Array:
        pushed = jnp.sign(strongest) * function(argument)
        return jnp.where(strongest == 0.0, argument / top, pushed)

    def search() -> tuple[Array, RootOutcome]:
        return bracketed_power_newton(
            reached,
            target=target,
            lower=top * SMALLEST_SHARE,
            upper=top,
            guess=top * target / reached_at_top,
        )

    argument, outcome = implicit_root(
        lambda argument: reached(argument) - target, search, jnp.shape(target)
    )
    return argument, within, outcome


def _by_temperature(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> Levitation:
    """One node: the temperature that carries the load, then the irradiance that holds it."""

    def pushed(excess: Array) -> Array:
        return upward_force(flyer, state, model, (excess,))

    load = weight(flyer, state)
    hottest = HIGHEST_TEMPERATURE / state.temperature - 1.0
    shape = jax.eval_shape(lambda: load + pushed(hottest))
    traced = jax.jit(pushed)

    def force(excess: Array) -> Array:
        return traced(jnp.broadcast_to(excess, shape.shape))

    strongest = force(hottest)
    excess, levitates, outcome = _reach(force, hottest, strongest, load)
    needed = total(node_losses(flyer, state, model, (excess,))) - total(flyer.heat_gains(state))
    collecting = total(flyer.beam_areas(state))
    irradiance = needed / jnp.where(collecting > 0.0, collecting, 1.0)
    temperature = state.temperature * (1.0 + excess)
    levitates &= collecting > 0.0
    return _answer(
        levitates, irradiance, temperature, force(excess) / load - 1.0, outcome.status, strongest
    )


def _by_irradiance(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> Levitation:
    """Several unknowns: the irradiance that carries the load, with a heat balance in each step."""
    # And one, where warm gas lifts: it may carry the load though it is no warmer than the gas
    # around.
    #
    # The brightest light looked at absorbs what the flyer would lose if all of it were at the
    # highest temperature: at any stronger one some node is hotter.
    load = weight(flyer, state)
    collecting = total(flyer.beam_areas(state))
    can_collect = collecting > 0.0
    hottest = HIGHEST_TEMPERATURE / state.temperature - 1.0
    everywhere = (hottest,) * len(flyer.nodes) + (0.0 * hottest,) * len(flyer.flows)
    loss = total(node_losses(flyer, state, model, everywhere))
    brightest = (loss - total(flyer.heat_gains(state))) / jnp.where(can_collect, collecting, 1.0)
    shape = jnp.shape(brightest + load)

    still = jax.lax.stop_gradient((flyer, state, model, brightest, load))
    dark = still[0].first_guess(still[1], jnp.zeros(shape))
    found = find_least_light(partial(_force_in, *still[:3], shape), *still[3:], dark)
    share = found.light / still[3]
    held = ~found.carries | found.in_the_dark
    imbalance = imbalance_of(flyer, state, model, shape)

    def residual(point: tuple[Array, ...]) -> tuple[Array, ...]:
        *unknowns, way = point
        powers = light_and_gains(flyer, state, way * still[3])
        push = upward_force(flyer, state, model, tuple(unknowns)) / load - 1.0
        return *imbalance(tuple(unknowns), powers), jnp.where(held, way - share, push)

    *rest, share = implicit_system(residual, (*found.unknowns, share))
    unknowns = tuple(rest)
    temperature = state.temperature * (
        1.0 + jax.tree.reduce(jnp.maximum, unknowns[: len(flyer.nodes)])
    )
    off = upward_force(flyer, state, model, unknowns) / load - 1.0
    levitates = found.carries & can_collect & (temperature <= HIGHEST_TEMPERATURE)
    return _answer(
        found.in_the_dark | levitates,
        share * still[3],
        temperature,
        jnp.where(found.in_the_dark, 0.0, off),
        found.status,
        found.force,
    )


def _force_in(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    shape: tuple[int, ...],
    light: Array,
    guess: tuple[Array, ...],
) -> tuple[Array, Array, tuple[Array, ...]]:
    """Force in a light [N], its slope [N m²/W] and the unknowns; ``guess``: of those."""
    solve = balance_solver(flyer, state, model, shape, guess)

    def force(light: Array) -> tuple[Array, tuple[Array, ...]]:
        unknowns, _ = solve(light_and_gains(flyer, state, light))
        pushed = upward_force(flyer, state, model, unknowns)
        return jnp.broadcast_to(pushed, shape), unknowns

    found: tuple[Array, Array, tuple[Array, ...]] = jax.jvp(
        force, (light,), (jnp.ones_like(light),), has_aux=True
    )
    return found


def _answer(
    levitates: Array,
    irradiance: Array,
    temperature: Array,
    residual: Array,
    status: Array,
    strongest: Array,
) -> Levitation:
    """The result, without what belongs to stand-ins."""
    levitates &= irradiance <= HIGHEST_IRRADIANCE
    residual = jnp.where(levitates, residual, 0.0)
    status = status_within(status, residual, LOAD_TOLERANCE)
    status = jnp.where(levitates, status, int(SolverStatus.CONVERGED))
    return Levitation(
        irradiance=jnp.where(levitates, jnp.maximum(irradiance, 0.0), jnp.inf),
        temperature=jnp.where(levitates, temperature, jnp.nan),
        levitates=levitates,
        residual=residual,
        status=jnp.where(jnp.isnan(strongest), int(SolverStatus.NOT_FINITE), status),
    )
