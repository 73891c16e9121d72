"""Search for the dimmest light that carries a load, where the force need not grow with the light.

The force is looked at in more and more light until it carries the load, and at its peak if it never
does. From there on a bracketed search goes back to where force and load are equal. All of it is one
loop, in which every element goes its own way: the force contains a heat balance, and compiling that
costs more than running it.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple, TypeVar

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.flyer.base import HIGHEST_TEMPERATURE
from lightflyer.numerics.rootfind import (
    MAXIMUM_STEPS,
    SMALLEST_SHARE,
    BracketSearch,
    SolverStatus,
    geometric_middle,
    power_step,
)
from lightflyer.numerics.system import implicit_system
from lightflyer.statics.balance import imbalances, solve_balance
from lightflyer.statics.equations import FlightEquations, total

_DIMMEST = 1e-5  # light looked at after darkness, over the brightest
_STEPS = 15  # in equal ratios from there to the brightest
_RATIO = _DIMMEST ** (-1.0 / _STEPS)

# what an element looks at: darkness is 0, then come the lights
_AT_BRIGHTEST = _STEPS + 1
_AT_PEAK = _AT_BRIGHTEST + 1
_IN_BRACKET = _AT_PEAK + 1
_AT_ROOT = _IN_BRACKET + 1
_DONE = _AT_ROOT + 1

T = TypeVar("T")
Look = Callable[[Array, tuple[Array, ...]], tuple[Array, Array, tuple[Array, ...]]]
"""Force, slope and unknowns in a light, from the unknowns in another one."""


class LeastLight(eqx.Module):
    """A search for the dimmest light, or its result."""

    stage: Array  # What is looked at next
    # To be looked at next. In the end the dimmest that carries the load; where none does, that of
    # the strongest force [W/m²]
    light: Array
    force: Array  # Where the force carried the load first, or was strongest [N]
    carries: Array  # Whether some light carries the load
    unknowns: tuple[Array, ...]  # Of the heat balance in the light looked at last
    before: tuple[Array, Array]  # Forces in the last two lights [N]
    # Largest force between two smaller ones [N], and the light where a parabola through them has
    # its vertex [W/m²]
    peak: Array
    vertex: Array
    bracket: BracketSearch

    @property
    def in_the_dark(self) -> Array:
        """Whether the load is carried without light."""
        return self.carries & (self.light == 0.0)

    @property
    def status(self) -> Array:
        """Why the search ended; that no light suffices is an answer."""
        searched = self.carries & (self.light > 0.0)
        return jnp.where(searched, self.bracket.status, jnp.int8(SolverStatus.CONVERGED))


class LiftOff(NamedTuple):
    """Where a search found that a flyer lifts off, with what belongs to stand-ins."""

    levitates: Array  # Whether any irradiance suffices
    irradiance: Array  # Of the beam [W/m²]
    temperature: Array  # Of the hottest node [K]
    residual: Array  # Force over weight, minus one [1]
    status: Array  # Why the search ended
    strongest: Array  # Largest force that was met [N]


def find_by_irradiance(equations: FlightEquations) -> LiftOff:
    """Several unknowns: the irradiance that carries the load, with a heat balance in each step."""
    # And one, where warm gas lifts: it may carry the load though it is no warmer than the gas
    # around.
    #
    # The brightest light looked at absorbs what the flyer would lose if all of it were at the
    # highest temperature: at any stronger one some node is hotter.
    flyer, state, load = equations.flyer, equations.state, equations.weight
    hottest = HIGHEST_TEMPERATURE / state.temperature - 1.0
    loss = total(equations.losses(equations.unknowns_at(hottest)))
    brightest, collects = equations.irradiance_for(loss)
    shape = jnp.shape(brightest + load)

    still, top, least = jax.lax.stop_gradient((equations, brightest, load))
    dark = still.flyer.first_guess(still.state, jnp.zeros(shape))
    found = find_least_light(partial(_force_in, still, shape), top, least, dark)
    share = found.light / top
    held = ~found.carries | found.in_the_dark
    balance = equations.trace_balance(shape)

    def residual(point: tuple[Array, ...]) -> tuple[Array, ...]:
        *unknowns, way = point
        powers = equations.powers(way * top)
        push = equations.upward_force(tuple(unknowns)) / load - 1.0
        return *imbalances(balance, tuple(unknowns), powers), jnp.where(held, way - share, push)

    *rest, share = implicit_system(residual, (*found.unknowns, share))
    unknowns = tuple(rest)
    temperature = state.temperature * (
        1.0 + jax.tree.reduce(jnp.maximum, unknowns[: len(flyer.nodes)])
    )
    off = equations.upward_force(unknowns) / load - 1.0
    levitates = found.carries & collects & (temperature <= HIGHEST_TEMPERATURE)
    return LiftOff(
        levitates=found.in_the_dark | levitates,
        irradiance=share * top,
        temperature=temperature,
        residual=jnp.where(found.in_the_dark, 0.0, off),
        status=found.status,
        strongest=found.force,
    )


def _force_in(
    equations: FlightEquations,
    shape: tuple[int, ...],
    light: Array,
    guess: tuple[Array, ...],
) -> tuple[Array, Array, tuple[Array, ...]]:
    """Force in a light [N], its slope [N m²/W] and the unknowns; ``guess``: of those."""
    balance = equations.trace_balance(shape)

    def force(light: Array) -> tuple[Array, tuple[Array, ...]]:
        unknowns, _ = solve_balance(equations, balance, equations.powers(light), shape, guess)
        return jnp.broadcast_to(equations.upward_force(unknowns), shape), unknowns

    found: tuple[Array, Array, tuple[Array, ...]] = jax.jvp(
        force, (light,), (jnp.ones_like(light),), has_aux=True
    )
    return found


def find_least_light(
    look: Look, brightest: Array, load: Array, unknowns: tuple[Array, ...]
) -> LeastLight:
    """Find the dimmest light in which a force carries a load; ``unknowns``: in darkness, about."""
    brightest, load = jnp.broadcast_arrays(brightest, load)

    def advance(at: tuple[LeastLight, Array]) -> tuple[LeastLight, Array]:
        search, steps = at
        return _advance(search, look, brightest, load), steps + 1

    def unfinished(at: tuple[LeastLight, Array]) -> Array:
        search, steps = at
        return jnp.any(search.stage != _DONE) & (steps < MAXIMUM_STEPS + _DONE)

    start = _start(brightest, unknowns)
    end, _ = jax.lax.while_loop(unfinished, advance, (start, jnp.zeros((), int)))
    return end


def _start(brightest: Array, unknowns: tuple[Array, ...]) -> LeastLight:
    nothing = jnp.zeros_like(brightest)
    return LeastLight(
        stage=jnp.zeros(brightest.shape, np.int32),
        light=nothing,
        force=nothing,
        carries=jnp.zeros(brightest.shape, bool),
        unknowns=tuple(jnp.broadcast_to(one, brightest.shape) for one in unknowns),
        before=(nothing, nothing),
        peak=jnp.full_like(brightest, -jnp.inf),
        vertex=brightest,
        bracket=BracketSearch.within(nothing, brightest, brightest),
    )


def _advance(at: LeastLight, look: Look, brightest: Array, load: Array) -> LeastLight:
    """The search after a look at its light."""
    force, slope, unknowns = look(at.light, at.unknowns)
    looking, searching = at.stage <= _AT_PEAK, at.stage == _IN_BRACKET
    carries = looking & (force >= load)
    begins = carries & (at.light > 0.0)
    residual, newton = power_step(force, slope, at.light, load)
    bracket = _select(
        begins,
        BracketSearch.within(SMALLEST_SHARE * at.light, at.light, at.light * load / force),
        _select(searching, at.bracket.advance(residual, newton, geometric_middle), at.bracket),
    )
    peak, vertex = _peak(at, force)
    goes_on = looking & ~carries & (at.stage < _AT_PEAK)
    brighter = jnp.where(at.stage == 0, _DIMMEST * brightest, _RATIO * at.light)
    strongest = jnp.where(peak > force, vertex, at.light)
    brighter = jnp.where(at.stage == _AT_BRIGHTEST, strongest, brighter)
    return LeastLight(
        stage=_next_stage(at, carries, begins, bracket.active),
        light=jnp.where(begins | searching, bracket.point, jnp.where(goes_on, brighter, at.light)),
        force=jnp.where(looking, force, at.force),
        carries=at.carries | carries,
        unknowns=_select(at.stage == _DONE, at.unknowns, unknowns),
        before=(at.before[1], force),
        peak=peak,
        vertex=vertex,
        bracket=bracket,
    )


def _next_stage(at: LeastLight, carries: Array, begins: Array, active: Array) -> Array:
    after = jnp.minimum(at.stage + 1, _DONE)
    after = jnp.where((at.stage == _IN_BRACKET) & active, _IN_BRACKET, after)
    after = jnp.where((at.stage == _AT_PEAK) | carries, _DONE, after)
    return jnp.where(begins, _IN_BRACKET, after).astype(np.int32)


def _peak(at: LeastLight, force: Array) -> tuple[Array, Array]:
    """The largest force between two smaller ones so far, and the light of a parabola's vertex."""
    two_before, before = at.before
    bend = two_before - 2.0 * before + force
    offset = 0.5 * (two_before - force) / jnp.where(bend == 0.0, 1.0, bend)
    vertex = at.light * _RATIO ** (jnp.clip(offset, -1.0, 1.0) - 1.0)
    three_lights = (at.stage > 2) & (at.stage <= _AT_BRIGHTEST)  # none of them darkness
    higher = three_lights & (bend < 0.0) & (before > at.peak)
    return jnp.where(higher, before, at.peak), jnp.where(higher, vertex, at.vertex)


def _select(condition: Array, first: T, second: T) -> T:
    chosen: T = jax.tree.map(lambda a, b: jnp.where(condition, a, b), first, second)
    return chosen
