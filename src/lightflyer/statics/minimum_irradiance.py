"""Search for the dimmest light that carries a load, where the force need not grow with the light.

The force is looked at in more and more light until it carries the load, and at its peak if it never
does: where its slope changes its sign, a cubic says where and how high that is. From there on a
bracketed search goes back to where force and load are equal. Light far too dim for a force that
grows as it begins to in darkness is left out, unless the first look thereafter belies it. All of it
is one loop, in which every element goes its own way: the force contains a heat balance, and
compiling that costs more than running it. Each balance begins where the last one leads, by its own
derivative.
"""

import math
from collections.abc import Callable
from functools import partial, reduce
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, call, xp
from lightflyer.array.transformations import repeat_while, stop_gradient, with_slopes
from lightflyer.flyer.base import HIGHEST_TEMPERATURE
from lightflyer.numerics.rootfind import (
    MAXIMUM_STEPS,
    RELATIVE_TOLERANCE,
    SMALLEST_SHARE,
    BracketSearch,
    SolverStatus,
    geometric_middle,
    power_step,
)
from lightflyer.numerics.system import implicit_system, solve_linear
from lightflyer.statics.balance import imbalances, largest_power, solve_balance
from lightflyer.statics.equations import FlightEquations, total

LOAD_TOLERANCE = 1e-10
"""Largest difference of force and weight of a levitating flyer, over its weight."""

_DIMMEST = 1e-5  # light looked at after darkness, over the brightest
_STEPS = 8  # in equal ratios from there to the brightest
_RATIO = _DIMMEST ** (-1.0 / _STEPS)
_FURTHEST = 4  # of these the last that may be the first one looked at
_HOPE = 0.5  # share of the load that a cubic must expect at a peak for a look there
_NEARLY = 0.2, 2.0  # range of a force's growth, over that of one that is linear, to believe it
_TOLERANCE = 1e-6  # of a balance: the step after it, which is taken, squares what is left
_ROUGH = 1e-3  # the same on the way to light that carries the load
_PATIENCE = 8  # steps of a balance before the careful search begins
_FEW = 64  # elements that are not worth being taken apart
_MANY_LEFT = 0.7  # share of the elements above which those that have ended are not left out
_CLOSER = 4  # steps in the end, where they are needed
_STEEPEST = 2.0  # power of the light with which an unknown is taken to grow, at most

# what an element looks at: darkness is 0, then come the lights
_AT_BRIGHTEST = _STEPS + 1
_AT_PEAK = _AT_BRIGHTEST + 2  # of two looks the last
_IN_BRACKET = _AT_PEAK + 1
_DONE = _IN_BRACKET + 1

Unknowns: TypeAlias = tuple[Array, ...]
Balanced: TypeAlias = tuple[Array, Unknowns]
"""Force and unknowns of a heat balance, or their slopes over the light."""


class Knot(NamedTuple):
    """A force in a light."""

    light: Array  # [W/m²]
    force: Array  # [N]
    slope: Array  # Over the logarithm of the light [N]


class LeastLight(NamedTuple):
    """A search for the dimmest light, or its result."""

    stage: Array  # What is looked at next
    # To be looked at next. In the end the dimmest that carries the load; where none does, the last
    # one looked at [W/m²]
    light: Array
    force: Array  # Where it carried the load first, or in the last light [N]
    carries: Array  # Whether some light carries the load
    # Of the heat balance in the light looked at last in the end, before that about those in the
    # light to be looked at
    unknowns: Unknowns
    dark: Knot  # Darkness, with the force's slope over the light itself
    skipped: Array  # Whether the light to be looked at is the first one after some left out
    rising: Knot  # The last look at which the force grew with the light
    peak: tuple[Knot, Knot]  # Looks on both sides of the highest peak so far
    height: Array  # Force that is expected there [N]
    bracket: BracketSearch

    @property
    def tolerance(self) -> Array:
        """Imbalance before a balance's last step, over all powers, that will do for a look."""
        scans = (self.stage > 0) & (self.stage <= _AT_BRIGHTEST)
        return xp.where(scans, _ROUGH, _TOLERANCE)

    @property
    def in_the_dark(self) -> Array:
        """Whether the load is carried without light."""
        return self.carries & (self.light == 0.0)

    @property
    def status(self) -> Array:
        """Why the search ended; that no light suffices is an answer."""
        searched = self.carries & (self.light > 0.0)
        return xp.where(searched, self.bracket.status, np.int8(SolverStatus.CONVERGED))


class LiftOff(NamedTuple):
    """Where a search found that a flyer lifts off, with what belongs to stand-ins."""

    levitates: Array  # Whether any irradiance suffices
    irradiance: Array  # Of the beam [W/m²]
    temperature: Array  # Of the hottest node [K]
    residual: Array  # Force over weight, minus one [1]
    status: Array  # Why the search ended
    strongest: Array  # A force that was met; NaN where it is not known [N]


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
    shape = xp.shape(brightest + load)

    still, top, least = stop_gradient((equations, brightest, load))
    dark = still.flyer.first_guess(still.state, xp.zeros(shape))
    found = find_least_light(still, top, least, dark)
    share = found.light / top
    held = ~found.carries | found.in_the_dark

    def residual(equations: FlightEquations, load: Array, point: Unknowns) -> Unknowns:
        unknowns, way = point[:-1], point[-1]
        powers = equations.powers(way * top)
        push = equations.upward_force(unknowns) / load - 1.0
        balance = equations.balance(unknowns)
        off = imbalances(balance, powers, largest_power(powers))
        return *off, xp.where(held, way - share, push)

    def search() -> tuple[Unknowns, None]:
        known = (*found.unknowns, share)
        return _closer(partial(residual, still, least), known, len(flyer.nodes)), None

    (*rest, share), _ = implicit_system(partial(residual, equations, load), search)
    unknowns = tuple(rest)
    temperature = state.temperature * (1.0 + reduce(xp.maximum, unknowns[: len(flyer.nodes)]))
    off = equations.upward_force(unknowns) / load - 1.0
    levitates = found.carries & collects & (temperature <= HIGHEST_TEMPERATURE)
    return LiftOff(
        levitates=found.in_the_dark | levitates,
        irradiance=share * top,
        temperature=temperature,
        residual=xp.where(found.in_the_dark, 0.0, off),
        status=found.status,
        strongest=found.force,
    )


def _closer(residual: Callable[[Unknowns], Unknowns], point: Unknowns, nodes: int) -> Unknowns:
    """A root found before, with Newton steps where the force still misses the load."""

    # Light is found to a share of itself. Where the force is what two large ones leave, as that of
    # a balloon thousands of times as heavy as its film, so much light changes it by more.
    def misses(left: Unknowns) -> Array:
        return xp.abs(left[-1]) > LOAD_TOLERANCE

    def step(at: tuple[Unknowns, Array, Array]) -> tuple[Unknowns, Array, Array]:
        point, rough, count = at
        left, columns = with_slopes(residual, point, (-1.0,) * nodes)
        rows = tuple(zip(*columns, strict=True))
        steps = solve_linear(rows, [-one for one in left])
        finite = reduce(xp.logical_and, [xp.isfinite(one) for one in steps])
        moved = tuple(
            xp.where(rough & finite, one + by, one) for one, by in zip(point, steps, strict=True)
        )
        return moved, misses(residual(moved)), count + 1

    start = (point, misses(residual(point)), xp.zeros((), int))
    found, _, _ = repeat_while(lambda at: xp.any(at[1]) & (at[2] < _CLOSER), step, start)
    return found


def _force_in(
    equations: FlightEquations, light: Array, guess: Unknowns, tolerance: Array
) -> tuple[Balanced, Balanced]:
    """Force in a light [N] and the unknowns, and how they change with it; ``guess``: of those."""
    unknowns, _ = solve_balance(equations, equations.powers(light), guess, tolerance)
    found, slopes, _ = _step_in(equations, light, unknowns)
    return found, slopes


def _step_in(
    equations: FlightEquations, light: Array, unknowns: Unknowns
) -> tuple[Balanced, Balanced, Array]:
    """Newton's step of a balance: force and unknowns after it, their slopes, and what it was for.

    The last is the largest imbalance before the step, over all powers.
    """
    size = largest_power(equations.powers(light))

    def together(point: tuple[Array, ...]) -> tuple[Array, ...]:
        unknowns, light = point[:-1], point[-1]
        balance, powers = equations.balance(unknowns), equations.powers(light)
        return *imbalances(balance, powers, size), equations.upward_force(unknowns)

    (*left, force), (*columns, by_light) = with_slopes(
        together, (*unknowns, light), (-1.0,) * len(equations.flyer.nodes)
    )
    rows = tuple(zip(*(column[:-1] for column in columns), strict=True))
    pushes = [column[-1] for column in columns]
    steps = solve_linear(rows, [-one for one in left])
    # singular equations, far beyond any light that lifts, lead nowhere
    finite = reduce(xp.logical_and, [xp.isfinite(step) for step in steps])
    steps = tuple(xp.where(finite, step, 0.0) for step in steps)
    changes = solve_linear(rows, [-one for one in by_light[:-1]])  # of the implicit functions
    force = force + sum(push * step for push, step in zip(pushes, steps, strict=True))
    slope = by_light[-1] + sum(push * one for push, one in zip(pushes, changes, strict=True))
    unknowns = tuple(one + step for one, step in zip(unknowns, steps, strict=True))
    found = xp.broadcast_to(force, xp.shape(light)), unknowns
    return found, (slope, changes), reduce(xp.maximum, [xp.abs(one) for one in left])


def find_least_light(
    equations: FlightEquations, brightest: Array, load: Array, unknowns: Unknowns
) -> LeastLight:
    """Find the dimmest light in which a force carries a load; ``unknowns``: in darkness, about."""
    brightest, load = xp.broadcast_arrays(brightest, load)
    start, most = _start(brightest, unknowns), MAXIMUM_STEPS + _DONE
    if call.jax is None:
        return _find_step_by_step(equations, start, brightest, load)

    def look(at: LeastLight) -> LeastLight:
        looked = _force_in(equations, at.light, at.unknowns, at.tolerance)
        return _advance(at, *looked, brightest, load)

    found, _ = repeat_while(
        lambda at: xp.any(at[0].stage != _DONE) & (at[1] < most),
        lambda at: (look(at[0]), at[1] + 1),
        (start, xp.zeros((), int)),
    )
    return found


def _find_step_by_step(
    equations: FlightEquations, at: LeastLight, brightest: Array, load: Array
) -> LeastLight:
    """The same by NumPy: light and balance go on together, each element by itself."""
    # An element's light changes once a step of its balance was for hardly anything; what has not
    # come to that after some steps is left to the careful search. Those that have ended are left
    # out.
    whole, places, tries = at, None, np.zeros(at.stage.shape, int)
    for _ in range(_PATIENCE * (MAXIMUM_STEPS + _DONE)):
        searching = at.stage != _DONE
        if not searching.any():
            break
        several = searching.ndim == 1 and searching.size > _FEW
        if several and np.count_nonzero(searching) < _MANY_LEFT * searching.size:
            rows = np.flatnonzero(searching)
            whole = tree.put_rows(whole, places, at)
            places = rows if places is None else places[rows]
            given = equations, at, brightest, load, tries
            equations, at, brightest, load, tries = tree.take_rows(given, searching.shape, rows)
        found, slopes, imbalance = _step_in(equations, at.light, at.unknowns)
        settled = imbalance <= at.tolerance
        # temperatures are above absolute zero, and all unknowns numbers
        warm = (one > -1.0 for one in found[1][: len(equations.flyer.nodes)])
        possible = reduce(np.logical_and, [*map(np.isfinite, found[1]), *warm])
        lost = ~settled & ((tries == _PATIENCE) | ~possible)
        if (lost & (at.stage != _DONE)).any():
            careful = _force_in(equations, at.light, at.unknowns, at.tolerance)
            found, slopes = _select(lost, careful, (found, slopes))
        settled, tries = settled | lost, np.where(settled | lost, 0, tries + 1)
        closer = at._replace(unknowns=_select(at.stage == _DONE, at.unknowns, found[1]))
        if settled.ndim == 1 and settled.size > _FEW:
            rows = np.flatnonzero(settled)
            if rows.size:
                looked = at, found, slopes, brightest, load
                some = _advance(*tree.take_rows(looked, settled.shape, rows))
                closer = tree.put_rows(closer, rows, some)
        elif settled.any():
            closer = _select(settled, _advance(at, found, slopes, brightest, load), closer)
        at = closer
    return tree.put_rows(whole, places, at)


def _start(brightest: Array, unknowns: Unknowns) -> LeastLight:
    nothing = xp.zeros_like(brightest)
    darkness = Knot(nothing, nothing, nothing)
    return LeastLight(
        stage=xp.zeros(brightest.shape, np.int32),
        light=nothing,
        force=nothing,
        carries=xp.zeros(brightest.shape, bool),
        unknowns=tuple(xp.broadcast_to(one, brightest.shape) for one in unknowns),
        dark=darkness,
        skipped=xp.zeros(brightest.shape, bool),
        rising=darkness,
        peak=(darkness, darkness),
        height=xp.full_like(brightest, -np.inf),
        bracket=BracketSearch.within(nothing, brightest, brightest),
    )


def _advance(
    at: LeastLight, found: Balanced, slopes: Balanced, brightest: Array, load: Array
) -> LeastLight:
    """The search after a look at its light: force and unknowns there, and their slopes."""
    (force, unknowns), (slope, changes) = found, slopes
    here = Knot(at.light, force, at.light * slope)
    growth = (force - at.dark.force) / (at.dark.slope * at.light)
    belied = at.skipped & ~((_NEARLY[0] < growth) & (growth < _NEARLY[1]) & (slope > 0.0))
    looking, searching = (at.stage <= _AT_PEAK) & ~belied, at.stage == _IN_BRACKET
    carries = looking & (force >= load)
    begins = carries & (at.light > 0.0)
    residual, newton = power_step(force, slope, at.light, load)
    # Newton's error falls as its square: after a step from here there is nothing to look at
    close = xp.abs(newton - at.light) <= math.sqrt(RELATIVE_TOLERANCE) * at.light
    lower = xp.where(at.rising.light > 0.0, at.rising.light, SMALLEST_SHARE * at.light)
    bracket = _select(
        begins,
        BracketSearch.within(lower, at.light, _between(at.rising, here, load)),
        _select(
            searching,
            at.bracket.advance(residual, newton, geometric_middle, close=close),
            at.bracket,
        ),
    )
    rising, peak, height = _peaks(at, here)
    vertex, _ = _vertex(*peak)
    # a peak that is far too low is not looked at
    hopeless = (at.stage >= _AT_BRIGHTEST) & ~(height > _HOPE * load)
    goes_on = looking & ~carries & ~hopeless & (at.stage < _AT_PEAK)
    in_the_dark = at.stage == 0
    dark = _select(in_the_dark, Knot(at.light, force, slope), at.dark)
    first = xp.where(belied, 1, xp.where(in_the_dark, _first_stage(dark, brightest, load), 0))
    moves = goes_on | belied
    ends = carries | (looking & hopeless)
    stage = xp.minimum(at.stage + 1, _DONE)
    stage = xp.where((at.stage == _IN_BRACKET) & bracket.active, _IN_BRACKET, stage)
    stage = xp.where((at.stage == _AT_PEAK) | ends, _DONE, stage)
    stage = xp.where(begins, _IN_BRACKET, stage).astype(np.int32)
    stage = xp.where(moves, xp.where(first > 0, first, stage), stage)
    brighter = xp.where(at.stage >= _AT_BRIGHTEST, vertex, _RATIO * at.light)
    brighter = xp.where(first > 0, _DIMMEST * _RATIO ** (first - 1.0) * brightest, brighter)
    light = xp.where(begins | searching, bracket.point, xp.where(moves, brighter, at.light))
    # the last step of a bracketed search is so short that nothing has to be looked at thereafter
    step = xp.where(searching, light - at.light, 0.0)
    ends = tuple(one + step * change for one, change in zip(unknowns, changes, strict=True))
    following = _select(stage == _DONE, ends, _ahead(at.light, light, unknowns, changes))
    return LeastLight(
        stage=stage,
        light=light,
        force=xp.where(looking, force, at.force),
        carries=at.carries | carries,
        unknowns=_select(at.stage == _DONE, at.unknowns, following),
        dark=dark,
        skipped=goes_on & (first > 1),
        rising=_select(belied, at.rising, rising),
        peak=peak,
        height=height,
        bracket=bracket,
    )


def _first_stage(dark: Knot, brightest: Array, load: Array) -> Array:
    """Of lights in equal ratios the last but one that is too dim if the force grows linearly."""
    grows = dark.slope > 0.0
    needed = (load - dark.force) / xp.where(grows, dark.slope, 1.0)
    ratio = xp.where(grows & (needed > 0.0), needed / (_DIMMEST * brightest), 1.0)
    return xp.clip(xp.floor(xp.log(ratio) / math.log(_RATIO)), 1, _FURTHEST).astype(np.int32)


def _between(low: Knot, high: Knot, load: Array) -> Array:
    """Light between two in which a force carries a load, about."""
    # by the cubic for the light over the force, in logarithms, else in proportion to the force
    known = (low.light > 0.0) & (low.force > 0.0) & (low.slope > 0.0) & (high.slope > 0.0)
    width, gain = xp.log(high.light / low.light), xp.log(high.force / low.force)
    way = xp.log(load / low.force) / gain
    first, last = gain * low.force / low.slope, gain * high.force / high.slope
    turn = 3.0 * width - 2.0 * first - last
    found = way * (first + way * (turn + way * (first + last - 2.0 * width)))
    inside = known & (found > 0.0) & (found < width)
    return xp.where(inside, low.light * xp.exp(found), high.light * load / high.force)


def _ahead(light: Array, following: Array, unknowns: Unknowns, changes: Unknowns) -> Unknowns:
    """Unknowns in another light, about: each is taken as a power of the light."""
    ratio = xp.where(light > 0.0, following / xp.where(light > 0.0, light, 1.0), 1.0)
    found = []
    for value, change in zip(unknowns, changes, strict=True):
        power = light * change / xp.where(value == 0.0, 1.0, value)
        grown = value * ratio ** xp.clip(power, -_STEEPEST, _STEEPEST)
        line = value + change * (following - light)
        found.append(xp.where((light > 0.0) & (value != 0.0), grown, line))
    return tuple(found)


def _peaks(at: LeastLight, here: Knot) -> tuple[Knot, tuple[Knot, Knot], Array]:
    """What a search knows of peaks after a look."""
    scans, closes_in = (at.stage > 0) & (at.stage <= _AT_BRIGHTEST), at.stage > _AT_BRIGHTEST
    rises = here.slope > 0.0
    _, height = _vertex(at.rising, here)
    higher = scans & (at.rising.slope > 0.0) & ~rises & (height > at.height)
    left, right = at.peak
    left = _select(higher, at.rising, _select(closes_in & rises, here, left))
    right = _select(higher | (closes_in & ~rises), here, right)
    rising = _select(scans & rises, here, at.rising)
    return rising, (left, right), xp.where(higher, height, at.height)


def _vertex(left: Knot, right: Knot) -> tuple[Array, Array]:
    """Light and height of the peak of a cubic over the light's logarithm, between two looks."""
    ratio = right.light / xp.where(left.light > 0.0, left.light, 1.0)
    ratio = xp.where(ratio > 1.0, ratio, _RATIO)  # of stand-ins
    width = xp.log(ratio)
    gain, first, last = right.force - left.force, width * left.slope, width * right.slope
    # of the cubic's derivative, which goes from ``first`` to ``last`` along the way from 0 to 1
    square, linear = 3.0 * (first + last) - 6.0 * gain, 6.0 * gain - 4.0 * first - 2.0 * last
    root = xp.sqrt(xp.maximum(linear**2 - 4.0 * square * first, 0.0)) - linear
    way = xp.clip(2.0 * first / xp.where(root > 0.0, root, 1.0), 0.0, 1.0)
    height = left.force + way * (first + way * (0.5 * linear + way * square / 3.0))
    return left.light * ratio**way, height


def _select(condition: Array, first: Any, second: Any) -> Any:
    """One of two arrays, or tuples of them, in each element."""
    if not isinstance(first, tuple):
        return xp.where(condition, first, second)
    pairs = zip(first, second, strict=True)
    parts = [_select(condition, one, other) for one, other in pairs]
    return type(first)(*parts) if hasattr(first, "_fields") else tuple(parts)
