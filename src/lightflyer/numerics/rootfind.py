"""Root-finding in one unknown, bracketed and safeguarded, with implicit gradients.

It solves many independent scalar equations at once: every array element is a problem of its
own. Gradients do not unroll the loop: the residual is differentiated at the root, so forward,
reverse and higher derivatives cost one linearised residual, and nothing where none is asked for.
Several coupled unknowns are solved by :mod:`lightflyer.numerics.system`.
"""

import enum
import sys
from collections import Counter
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, call, xp
from lightflyer.array.records import Module
from lightflyer.array.transformations import implicit, repeat_while, shape_of

RELATIVE_TOLERANCE = 1e-12
"""Default bound on the scaled residual at a root; a hundred times tighter than promised."""

ROUNDING = sys.float_info.epsilon

MAXIMUM_STEPS = 100
"""Bound on Newton and bisection steps. Bisection alone needs about 60 for any bracket."""

SMALLEST_SHARE = 1e-26  # Lower end of a bracket, over its upper end

_NEAR = 0.1  # share of the tolerance that may be left where nothing is looked at any more


class Reason(enum.IntEnum):
    """Why something ended: a number, and a phrase for tables and messages."""

    phrase: str

    def __new__(cls, code: int, phrase: str = "") -> "Reason":
        """A member of a number and a phrase."""
        member = int.__new__(cls, code)
        member._value_, member.phrase = code, phrase
        return member

    def describe(self) -> str:
        return self.phrase


class SolverStatus(Reason):
    """Why a search ended."""

    CONVERGED = 0, "converged"
    STEP_LIMIT = 1, "reached the limit of steps"
    NOT_FINITE = 2, "met a number that is not finite"
    TOLERANCE_MISSED = 3, "missed the tolerance"
    SINGULAR = 4, "met a singular Jacobian"
    STALLED = 5, "stalled where no step reduces the residual"


def describe_status(status: Numeric) -> str:
    """Why searches ended, in words; ``status``: values of :class:`SolverStatus`."""
    counts = Counter(np.ravel(np.asarray(status)).tolist()).most_common()
    return ", ".join(
        SolverStatus(code).describe()
        if len(counts) == 1
        else f"{count} {SolverStatus(code).describe()}"
        for code, count in counts
    )


class RootOutcome(Module):
    """Result of a root-find, element by element."""

    status: Array  # Why it ended, values of :class:`SolverStatus`
    steps: Array  # Steps taken by the slowest element

    @property
    def converged(self) -> Array:
        """True where the search found a root: bool array."""
        return self.status == SolverStatus.CONVERGED


class BracketSearch(NamedTuple):
    """Where every element of a bracketed search stands."""

    point: Array  # To be looked at next
    lower: Array
    upper: Array
    last_step: Array
    active: Array  # False where the point is the root

    @classmethod
    def within(cls, lower: Array, upper: Array, guess: Array) -> "BracketSearch":
        """Begin at a guess, which is clipped into the bracket."""
        lower, upper, guess = xp.broadcast_arrays(lower, upper, guess)
        return cls(
            point=xp.clip(guess, lower, upper),
            lower=lower,
            upper=upper,
            last_step=2.0 * (upper - lower),
            active=xp.ones(guess.shape, bool),
        )

    @property
    def status(self) -> Array:
        """Why the search ended, by the last state alone, which costs its loop nothing."""
        # a residual of NaN leaves the bracket as it is, so that bisection proposes the same again
        stuck = ~xp.isfinite(self.last_step) | (self.last_step == 0.0)
        unfinished = xp.where(stuck, int(SolverStatus.NOT_FINITE), int(SolverStatus.STEP_LIMIT))
        return xp.where(self.active, unfinished, int(SolverStatus.CONVERGED)).astype(np.int8)

    def advance(
        self,
        value: Array,
        proposal: Array,
        middle: Callable[[Array, Array], Array],
        tolerance: Array | float = RELATIVE_TOLERANCE,
        close: Array | bool = False,
    ) -> "BracketSearch":
        """The search after a look at its point; ``middle``: of two arrays: where to bisect."""
        # ``proposal``: where the look leads; ``close``: whether there is nothing to look at there
        lower = xp.where(value < 0, self.point, self.lower)
        upper = xp.where(value > 0, self.point, self.upper)
        resolution = ROUNDING * (xp.abs(lower) + xp.abs(upper))
        done = (xp.abs(value) <= tolerance) | (upper - lower <= resolution)
        step = proposal - self.point
        trusted = (proposal > lower) & (proposal < upper)
        trusted = trusted & (xp.abs(step) <= 0.5 * xp.abs(self.last_step))
        following = xp.where(trusted, proposal, middle(lower, upper))
        moving = self.active & ~done
        return BracketSearch(
            point=xp.where(moving, following, self.point),
            lower=lower,
            upper=upper,
            last_step=xp.where(moving, following - self.point, self.last_step),
            active=moving & ~(trusted & close),
        )


class _Curve(NamedTuple):
    """The last two points of a search, and values there; NaN where there is none."""

    points: tuple[Array, Array]  # The later one first
    values: tuple[Array, Array]

    def advance(self, point: Array, value: Array) -> "_Curve":
        return _Curve((point, self.points[0]), (value, self.values[0]))


def find_root(
    residual: Callable[[Array], Array],
    lower: Array,
    upper: Array,
    guess: Array,
    tolerance: float = RELATIVE_TOLERANCE,
) -> tuple[Array, RootOutcome]:
    r"""Find the root of an increasing function in a bracket, element by element."""
    # The inverse curve through the last three points; where that leaves the bracket, or its step is
    # more than half of the last one, bisection (the safeguard of [Press2007]_ ch. 9.4), so that it
    # cannot diverge or stall.
    #
    # Not differentiable by itself: use :func:`implicit_root`.

    def look(point: Array, curve: _Curve) -> tuple[Array, Array, Array, Array]:
        value = residual(point)
        change, _ = _inverse_curve(curve, point, value)
        return value, point + change, xp.zeros(xp.shape(value), bool), value

    return _search(look, lambda a, b: 0.5 * (a + b), (lower, upper, guess), tolerance)


def find_power_root(
    function: Callable[[Array], Array],
    target: Array,
    lower: Array,
    upper: Array,
    guess: Array,
    tolerance: Array | float = RELATIVE_TOLERANCE,
    known: tuple[Array, Array] | None = None,
) -> tuple[Array, RootOutcome]:
    r"""Find where a positive, increasing function of a positive unknown reaches a target."""
    # For functions that are nearly power laws, :math:`f \propto x^s`, over many decades: the
    # inverse curve through the last three points is in logarithms of both. Bisection is geometric.
    #
    # A function that grows less than linearly may be saturating, :math:`f = ax/(1 + bx)`, as the
    # force on a hot flyer is. A power would lead much too far there. The step is taken in
    # reciprocals, where such a function is a straight line.
    #
    # ``known``: a point, and the value there. Not differentiable by itself: use
    # :func:`implicit_root`.

    def look(point: Array, curve: _Curve) -> tuple[Array, Array, Array, Array]:
        ratio = function(point) / target
        value, (before, _) = xp.log(ratio), curve.points
        place = xp.log(point)
        change, error = _inverse_curve(curve, place, value)
        # without a second point, as if the function were proportional to the unknown
        change = xp.where(xp.isnan(change), -value, change)
        proposal = point * xp.exp(change)
        # in reciprocals: (1/x, 1/f) through this point and the one before
        slow = xp.abs(value - curve.values[0]) < xp.abs(place - before)
        along, across = xp.exp(place - before), xp.exp(value - curve.values[0])
        straight = point / (1.0 + (ratio - 1.0) * (along - 1.0) / (across - 1.0))
        proposal = xp.where(slow & (straight > 0.0), straight, proposal)
        return ratio - 1.0, proposal, ~slow & (error <= _NEAR * tolerance), value

    begin = (lower, upper, guess)
    first = None if known is None else (xp.log(known[0]), xp.log(known[1] / target))
    return _search(look, geometric_middle, begin, tolerance, first, scale=xp.log)


def _inverse_curve(curve: _Curve, point: Array, value: Array) -> tuple[Array, Array]:
    """Step to where the inverse parabola through three points is zero, or the line through two.

    And about how far from zero the value will be there, where the curve bends about as a logarithm
    of a smooth function does.
    """
    (before, first), (older, oldest) = curve.points, curve.values
    inverse = (point - before) / (value - older)
    bend = (inverse - (before - first) / (older - oldest)) / (value - oldest)
    bends = xp.isfinite(bend)
    change = -value * inverse + xp.where(bends, value * older * bend, 0.0)
    error = xp.abs(value * older) * xp.where(bends, xp.abs(oldest), 1.0)
    return change, error


def power_step(value: Array, slope: Array, point: Array, target: Array) -> tuple[Array, Array]:
    """Residual of a function that is nearly a power law, and where Newton goes."""
    # Newton's step in logarithms; the power is replaced by its Padé approximant about one, which is
    # exact to second order and needs neither logarithm nor exponential. In reciprocals where the
    # function grows less than linearly, as in :func:`find_power_root`.
    ratio, inverse_exponent = value / target, value / (point * slope)
    low, high = xp.minimum(inverse_exponent, 1.0), xp.maximum(inverse_exponent, 1.0)
    rise = inverse_exponent + high
    above, below = 1.0 + low + (1.0 - low) * ratio, 2.0 - rise + rise * ratio
    return ratio - 1.0, point * above / below


def geometric_middle(lower: Array, upper: Array) -> Array:
    """Where a bracket of positive numbers is bisected."""
    return xp.sqrt(lower * upper)


def _search(
    look: Callable[[Array, _Curve], tuple[Array, Array, Array, Array]],
    middle: Callable[[Array, Array], Array],
    bracket_and_guess: tuple[Array, Array, Array],
    tolerance: Array | float,
    known: tuple[Array, Array] | None = None,
    scale: Callable[[Array], Array] = lambda point: point,
) -> tuple[Array, RootOutcome]:
    """Search with a rule that gives, at a point, the residual and where it leads."""
    # and whether there is nothing to look at there, and the value of the curve

    def advance(at: tuple[BracketSearch, _Curve, Array]) -> tuple[BracketSearch, _Curve, Array]:
        search, curve, steps = at
        residual, proposal, close, value = look(search.point, curve)
        following = search.advance(residual, proposal, middle, tolerance, close)
        return following, curve.advance(scale(search.point), value), steps + 1

    def unfinished(at: tuple[BracketSearch, _Curve, Array]) -> Array:
        search, _, steps = at
        # what has not moved would give the same again
        going = search.active & (search.last_step != 0.0)
        return xp.any(going) & (steps < MAXIMUM_STEPS)

    begin = BracketSearch.within(*bracket_and_guess)
    nothing = xp.full(begin.point.shape, np.nan)
    first = (nothing, nothing) if known is None else (one + 0.0 * begin.point for one in known)
    points, values = ((one, nothing) for one in first)
    end, _, steps = repeat_while(
        unfinished, advance, (begin, _Curve(points, values), xp.zeros((), int))
    )
    return end.point, RootOutcome(status=end.status, steps=steps)


def implicit_root(
    residual: Callable[[Array], Array], search: Callable[[], tuple[Array, RootOutcome]]
) -> tuple[Array, RootOutcome]:
    """What a search for a root gives; under JAX the root has the derivative of its equation."""
    if call.jax is None:
        return search()

    def solve(_: Any, guess: Array) -> tuple[Array, RootOutcome]:
        root, outcome = search()
        return xp.broadcast_to(root, guess.shape), outcome

    def invert(linear: Callable[[Array], Array], value: Array) -> Array:
        return value / linear(xp.ones_like(value))

    return implicit(residual, xp.zeros(shape_of(residual, 0.0), float), solve, invert)


def reach(
    function: Callable[[Array], Array], top: Array, highest: Array, wanted: Array
) -> tuple[Array, Array, RootOutcome]:
    """Find where an increasing function, ``highest`` at the ``top`` argument, has a value."""
    within = highest >= wanted
    # Where no argument suffices, a value within reach stands in, to be discarded by the caller: so
    # neither the search nor its derivative meets a NaN.
    size = xp.where(highest == 0.0, 1.0, xp.abs(highest))
    stand_in = xp.where(highest == 0.0, 1.0, 0.5 * size)
    target = xp.where(within, wanted, stand_in)

    def reached(argument: Array) -> Array:
        value = xp.sign(highest) * function(argument)
        return xp.where(highest == 0.0, argument / top, value)

    def search() -> tuple[Array, RootOutcome]:
        return find_power_root(
            reached,
            target=target,
            lower=top * SMALLEST_SHARE,
            upper=top,
            guess=top * target / size,
            known=(top, size),
        )

    argument, outcome = implicit_root(lambda argument: reached(argument) - target, search)
    return argument, within, outcome
