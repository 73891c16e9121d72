"""Newton's method for very many small systems at once, and roots in several unknowns by it.

Every array element is a system of its own. The Jacobian is taken and solved element by element, in
array operations, and each element ends by itself: by NumPy, those that have ended are left out.

Root-finding in several unknowns, with implicit gradients.

Every array element holds a system of its own: n equations for n unknowns, n small. Neither the
search nor the derivatives ever form a matrix that couples elements. For one unknown use
:mod:`lightflyer.numerics.rootfind`, which brackets the root and is more than twice as fast.
"""

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from typing import Any, TypeAlias

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, call, xp
from lightflyer.array.records import Module
from lightflyer.array.transformations import either, implicit, repeat_while, shape_of, with_slopes
from lightflyer.numerics.rootfind import (
    MAXIMUM_STEPS,
    RELATIVE_TOLERANCE,
    ROUNDING,
    RootOutcome,
    SolverStatus,
)

Unknowns: TypeAlias = tuple[Array, ...]

_NEAR = 1e-8
"""Relative Newton step after which there is nothing to look at.

The error falls as the square of the step, but not below the step times the rounding error of the
Jacobian's inverse: 1e-4 where the coefficients of a system are 1e12 apart.
"""

_NEAR_AT_LAST = 1e-6
_PATIENCE = 12  # Steps after which :data:`_NEAR_AT_LAST` will do, as rounding may allow no more

_TOUCH = 0.1
"""Relative step that an element still takes when its residual is within tolerance.

The step is at hand, and an unknown that hardly matters to the residual may need it.
"""

_LARGEST_LOSS = 0.9
"""Largest share of its distance to the lower bound that an unknown may lose in a step."""

_FEW, _MANY_LEFT = 64, 0.6
"""Elements, and share of them, above which those that have ended are not worth leaving out."""

_SHRINKAGE = 0.3  # A step that does not help is shortened to this share


def solve_linear(matrix: Sequence[Sequence[Array]], vector: Sequence[Array]) -> tuple[Array, ...]:
    """Solve linear systems, one in every element; ``matrix``: rows of the matrices."""
    # The solution is written out in array operations, which XLA fuses with what stands around them:
    # a call to LAPACK for every small matrix would take longer than all else together.
    # Differentiable where the matrix is regular.
    if len(vector) == 2:  # Cramer's rule loses no accuracy for two, and is half the work
        (a, b), (c, d) = matrix
        first, second = vector
        inverse = 1.0 / (a * d - b * c)
        return (first * d - b * second) * inverse, (a * second - first * c) * inverse
    # Gaussian elimination with partial pivoting
    rows = [[*row, right] for row, right in zip(matrix, vector, strict=True)]
    for pivot in range(len(rows)):
        for below in range(pivot + 1, len(rows)):
            larger = xp.abs(rows[below][pivot]) > xp.abs(rows[pivot][pivot])
            pairs = list(zip(rows[pivot], rows[below], strict=True))
            rows[pivot] = [xp.where(larger, lower, upper) for upper, lower in pairs]
            rows[below] = [xp.where(larger, upper, lower) for upper, lower in pairs]
        for below in range(pivot + 1, len(rows)):
            share = rows[below][pivot] / rows[pivot][pivot]
            rows[below] = [
                entry - share * above for entry, above in zip(rows[below], rows[pivot], strict=True)
            ]
    solution: list[Array] = []
    for index, (*coefficients, right) in reversed(list(enumerate(rows))):
        for coefficient, known in zip(reversed(coefficients), solution, strict=False):
            right = right - coefficient * known
        solution.append(right / coefficients[index])
    return tuple(reversed(solution))


class _Newton(Module):
    """Residual and Jacobian at a point, and Newton's step from there."""

    value: Unknowns
    jacobian: tuple[Unknowns, ...]
    step: Unknowns


def _newton(
    function: Callable[[Unknowns], Unknowns], point: Unknowns, lower: tuple[float, ...]
) -> _Newton:
    """Newton's step; ``lower``: bounds of the unknowns."""
    value, columns = with_slopes(function, point, lower)
    if len(value) != len(point):
        raise ValueError(f"{len(point)} unknowns need as many equations, not {len(value)}")
    rows = tuple(zip(*columns, strict=True))
    return _Newton(value, rows, solve_linear(rows, [-entry for entry in value]))


class _Careful(Module):
    """Best point of the careful search, what residuals are measured by, and the largest there."""

    base: Unknowns
    scale: Unknowns
    level: Array


class _State(Module):
    start: Unknowns
    point: Unknowns
    is_careful: Array
    careful: _Careful
    status: Array
    steps: Array


@dataclass(frozen=True)
class SafeNewton:
    """Newton's method in every element, and from the start again, carefully, where that fails."""

    # The first search only keeps above the lower bounds: it is fast, but may diverge. Where its
    # next point would not be finite, or it has not ended after :attr:`plain_steps`, the search
    # begins anew with steps that are shortened until they reduce the residual. There each equation
    # is measured by the sum of what its terms would change if every unknown changed by itself and
    # by its step, so that neither the equations' scale nor that of the unknowns matters.
    #
    # Both are one loop because XLA takes longer to compile a function than the rules to run.

    lower: tuple[float, ...]  # Bounds that the unknowns never reach
    tolerance: float | Array = RELATIVE_TOLERANCE  # Largest residual at a root
    plain_steps: int = 30  # Bounds on the steps of each search
    careful_steps: int = MAXIMUM_STEPS  # Bounds on the steps of each search

    def search(
        self, function: Callable[..., Unknowns], start: Unknowns, parameters: tuple[Any, ...] = ()
    ) -> tuple[Unknowns, RootOutcome]:
        """Roots of all elements, or the best points of those that have not ended."""
        shape = start[0].shape
        scale = tuple(xp.ones_like(entry) for entry in start)
        state = _State(
            start=start,
            point=start,
            is_careful=xp.zeros(shape, bool),
            careful=_Careful(start, scale, xp.full_like(start[0], np.inf)),
            status=xp.full(shape, int(SolverStatus.STEP_LIMIT), np.int8),
            steps=xp.zeros((), int),
        )
        most = self.plain_steps + self.careful_steps
        if call.jax is not None:
            state = repeat_while(
                lambda at: xp.any(_searching(at.status)) & (at.steps < most),
                lambda at: self._move_active(lambda point: function(point, *parameters), at),
                state,
            )
        else:
            # elements that have ended take no more steps
            whole, places, shape, finder = state, None, state.status.shape, self
            while state.steps < most:
                searching = _searching(state.status)
                count = np.count_nonzero(searching)
                if not count:
                    break
                if len(shape) == 1 and shape[0] > _FEW and count < _MANY_LEFT * shape[0]:
                    rows = np.flatnonzero(searching)
                    whole = tree.put_rows(whole, places, state)
                    places = rows if places is None else places[rows]
                    given = state, parameters, finder.tolerance
                    state, parameters, tolerance = tree.take_rows(given, shape, rows)
                    finder, shape = replace(finder, tolerance=tolerance), (count,)
                state = finder._move_active(lambda point: function(point, *parameters), state)  # noqa: B023
            state = tree.put_rows(whole, places, state)
        unfinished = _searching(state.status) & state.is_careful
        root = _select(unfinished, state.careful.base, state.point)
        return root, RootOutcome(state.status, state.steps)

    def _move_active(self, function: Callable[[Unknowns], Unknowns], state: _State) -> _State:
        """The state after a step of every element that is still searching."""
        newton = _newton(function, state.point, self.lower)
        # The first search. A point that is not finite at the very first step ends an element: no
        # method could do better.
        target = tuple(
            old + xp.maximum(change, _LARGEST_LOSS * (bound - old))
            for old, change, bound in zip(state.point, newton.step, self.lower, strict=True)
        )
        finite = _all_finite(target)
        near = xp.where(state.steps < _PATIENCE, _NEAR, _NEAR_AT_LAST)
        arrived = self._is_root(newton) | _is_short(newton.step, state.point, near)
        plain_verdict = _choose(
            (arrived, SolverStatus.CONVERGED),
            (finite | (state.steps > 0), SolverStatus.STEP_LIMIT),
            (_all_finite(newton.value), SolverStatus.SINGULAR),
            otherwise=SolverStatus.NOT_FINITE,
        )
        fails = _searching(plain_verdict) & (~finite | (state.steps + 1 >= self.plain_steps))
        moving = finite & self._may_move(newton, state.point)
        plain = _select(fails, state.start, _select(moving, target, state.point))
        searching, is_careful = _searching(state.status), state.is_careful

        def with_careful() -> tuple[Unknowns, Array, _Careful]:
            point, verdict, memory = self._careful(newton, state.point, state.careful)
            return (
                _select(is_careful, point, plain),
                xp.where(is_careful, verdict, plain_verdict),
                tree.map_leaves(lambda a, b: xp.where(is_careful, a, b), memory, state.careful),
            )

        # hardly any element needs care
        point, verdict, memory = either(
            xp.any(is_careful), with_careful, lambda: (plain, plain_verdict, state.careful)
        )
        return _State(
            start=state.start,
            point=_select(searching, point, state.point),
            is_careful=is_careful | (searching & fails),
            careful=memory,
            status=xp.where(searching, verdict, state.status),
            steps=state.steps + 1,
        )

    def _is_root(self, newton: _Newton) -> Array:
        return _largest(newton.value) <= self.tolerance

    def _may_move(self, newton: _Newton, point: Unknowns) -> Array:
        return ~self._is_root(newton) | _is_short(newton.step, point, _TOUCH)

    def _careful(
        self, newton: _Newton, point: Unknowns, memory: _Careful
    ) -> tuple[Unknowns, Array, _Careful]:
        """Go on from a point that is better than the one before, go back from another."""
        better = _level(newton.value, memory.scale) < memory.level
        # all of a step is shortened so as to keep above the bounds
        share = xp.ones_like(point[0])
        for old, change, bound in zip(point, newton.step, self.lower, strict=True):
            allowed = _LARGEST_LOSS * (old - bound) / xp.maximum(-change, sys.float_info.min)
            share = xp.minimum(share, allowed)
        target = tuple(old + share * change for old, change in zip(point, newton.step, strict=True))
        moving = _all_finite(target) & self._may_move(newton, point)
        arrived = self._is_root(newton) | _is_short(newton.step, point, _NEAR_AT_LAST)
        onward = _choose(
            (arrived, SolverStatus.CONVERGED),
            (~_all_finite(target), SolverStatus.SINGULAR),
            (_is_still(target, point), SolverStatus.STALLED),
            otherwise=SolverStatus.STEP_LIMIT,
        )
        advance = _select(moving, target, point)
        retreat = tuple(
            old + _SHRINKAGE * (new - old) for old, new in zip(memory.base, point, strict=True)
        )
        nowhere = _is_still(retreat, memory.base), SolverStatus.STALLED
        backward = _choose(nowhere, otherwise=SolverStatus.STEP_LIMIT)
        verdict = xp.where(better, onward, backward)
        base = _select(better, point, memory.base)
        failed = verdict > SolverStatus.STEP_LIMIT
        ahead = _select(failed, base, _select(better, advance, retreat))
        size = [xp.abs(a) + xp.abs(b) for a, b in zip(point, newton.step, strict=True)]
        terms = [
            [xp.abs(slope) * b for slope, b in zip(row, size, strict=True)]
            for row in newton.jacobian
        ]
        scale = _select(better, tuple(1.0 / reduce(xp.add, row) for row in terms), memory.scale)
        level = xp.where(better, _level(newton.value, scale), memory.level)
        return ahead, verdict, _Careful(base, scale, level)


def _searching(status: Array) -> Array:
    return status == SolverStatus.STEP_LIMIT


def _choose(*cases: tuple[Array, SolverStatus], otherwise: SolverStatus) -> Array:
    """SolverStatus of the first case that holds, element by element."""
    chosen: Array = np.int8(otherwise)
    for holds, status in reversed(cases):
        chosen = xp.where(holds, np.int8(status), chosen)
    return chosen


def _select(condition: Array, true: Unknowns, false: Unknowns) -> Unknowns:
    return tuple(xp.where(condition, a, b) for a, b in zip(true, false, strict=True))


def _largest(entries: Sequence[Array]) -> Array:
    return reduce(xp.maximum, [xp.abs(entry) for entry in entries])


def _all(conditions: Sequence[Array]) -> Array:
    return reduce(xp.logical_and, conditions)


def _all_finite(point: Unknowns) -> Array:
    return _all([xp.isfinite(entry) for entry in point])


def _is_short(step: Unknowns, point: Unknowns, share: Array | float) -> Array:
    return _all([xp.abs(a) <= share * xp.abs(b) for a, b in zip(step, point, strict=True)])


def _is_still(new: Unknowns, old: Unknowns) -> Array:
    return _is_short(tuple(a - b for a, b in zip(new, old, strict=True)), old, ROUNDING)


def _level(value: Unknowns, scale: Unknowns) -> Array:
    return _largest([a * b for a, b in zip(value, scale, strict=True)])


_PLAIN_STEPS = 30
"""Newton steps before the careful search: enough from a thousand times the root of radiation."""


def solve_system(
    residual: Callable[..., Unknowns],
    guess: tuple[Numeric, ...] | Callable[[], tuple[Numeric, ...]],
    parameters: tuple[Any, ...] = (),
    *,
    lower: float | tuple[float, ...] = -math.inf,
    tolerance: float | Array = RELATIVE_TOLERANCE,
    maximum_steps: int = MAXIMUM_STEPS,
) -> tuple[Unknowns, RootOutcome]:
    """Find where several functions of as many unknowns vanish, element by element."""
    # Newton's method in all elements at once; each stops by itself. Where that fails, the search
    # starts again from the guess with steps that are shortened until they reduce the residual.
    # ``guess``: of the shape of the elements, or single numbers. ``parameters``: further arguments
    # of the residual, with all that is an element's own, so that those that have ended can be left
    # out.
    #
    # The derivative is that of the implicit function. It is not finite where the Jacobian is
    # singular.

    def search() -> tuple[Unknowns, RootOutcome]:
        first = tuple(xp.asarray(entry, float) for entry in (guess() if callable(guess) else guess))
        bounds = lower if isinstance(lower, tuple) else (lower,) * len(first)
        if len(bounds) != len(first):
            raise ValueError(f"{len(first)} unknowns need as many bounds, not {len(bounds)}")
        shape = xp.broadcast_shapes(*(xp.shape(entry) for entry in first))
        if call.jax is not None or shape == ():
            found = shape_of(residual, first, *parameters)
            shape = xp.broadcast_shapes(*found, shape)
        start = tuple(
            xp.broadcast_to(_usable(entry, bound), shape)
            for entry, bound in zip(first, bounds, strict=True)
        )
        finder = SafeNewton(
            bounds, tolerance, min(_PLAIN_STEPS, maximum_steps), careful_steps=maximum_steps
        )
        return finder.search(residual, start, parameters)

    return implicit_system(lambda point: residual(point, *parameters), search)


def implicit_system(
    residual: Callable[[Unknowns], Unknowns], search: Callable[[], tuple[Unknowns, Any]]
) -> tuple[Unknowns, Any]:
    """What a search for a root gives; under JAX the root has the derivative of its equations."""
    if call.jax is None:
        return search()
    # only the shapes are used, and what is not is not compiled
    guess = tuple(xp.zeros(shape, float) for shape in shape_of(lambda: search()[0]))

    def wide(point: Unknowns) -> Unknowns:
        return tuple(xp.broadcast_to(entry, guess[0].shape) for entry in residual(point))

    def invert(linear: Callable[[Unknowns], Unknowns], vector: Unknowns) -> Unknowns:
        columns = [
            linear(tuple(xp.full_like(entry, place == index) for place, entry in enumerate(vector)))
            for index in range(len(vector))
        ]
        return solve_linear(tuple(zip(*columns, strict=True)), vector)

    return implicit(wide, guess, lambda *_: search(), invert)


def _usable(guess: Array, bound: float) -> Array:
    stand_in = bound + 1.0 if math.isfinite(bound) else 0.0
    return xp.where(xp.isfinite(guess) & (guess > bound), guess, stand_in)
