"""Root-finding in one unknown: a bracketed, safeguarded Newton with implicit gradients.

It solves many independent scalar equations at once: every array element is a problem of its
own. Gradients do not unroll the loop: the residual is differentiated at the root, so forward,
reverse and higher derivatives cost one linearised residual, and nothing where none is asked for.
Several coupled unknowns are solved by :mod:`lightflyer.numerics.system`.
"""

import enum
import math
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from lightflyer.program.tracing import with_parameters
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import Array, ArrayLike, custom_jvp, jax, jnp
from lightflyer.pytree.module import Module

RELATIVE_TOLERANCE = 1e-12
"""Default bound on the scaled residual at a root; a hundred times tighter than promised."""

ROUNDING = sys.float_info.epsilon

MAXIMUM_STEPS = 100
"""Bound on Newton and bisection steps. Bisection alone needs about 60 for any bracket."""

SMALLEST_SHARE = 1e-26  # Lower end of a bracket, over its upper end

STEPS_ON_GPU = 4
"""Steps before a GPU first asks whether all elements have ended.

Between questions XLA can join all arithmetic into one kernel. Four steps end every one of the heat
balances of random disks in ``benchmarks/solver.py``. On an H100 none, three, four and five reach
2.9, 3.9, 4.9 and 1.7·10⁸ a second: the kernel of five has more numbers than registers. A kernel for
each step reaches 4.7. On processors this loses.
"""


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


def describe_status(status: ArrayLike) -> str:
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


class BracketSearch(Module):
    """Where every element of a bracketed search stands."""

    point: Array  # To be looked at next
    lower: Array
    upper: Array
    last_step: Array
    active: Array  # False where the point is the root

    @classmethod
    def within(cls, lower: Array, upper: Array, guess: Array) -> "BracketSearch":
        """Begin at a guess, which is clipped into the bracket."""
        lower, upper, guess = jnp.broadcast_arrays(lower, upper, guess)
        return cls(
            point=jnp.clip(guess, lower, upper),
            lower=lower,
            upper=upper,
            last_step=2.0 * (upper - lower),
            active=jnp.ones(guess.shape, bool),
        )

    @property
    def status(self) -> Array:
        """Why the search ended, by the last state alone, which costs its loop nothing."""
        # a residual of NaN leaves the bracket as it is, so that bisection proposes the same again
        stuck = ~jnp.isfinite(self.last_step) | (self.last_step == 0.0)
        unfinished = jnp.where(
            stuck, jnp.int8(SolverStatus.NOT_FINITE), jnp.int8(SolverStatus.STEP_LIMIT)
        )
        return jnp.where(self.active, unfinished, jnp.int8(SolverStatus.CONVERGED))

    def advance(
        self,
        value: Array,
        newton: Array,
        middle: Callable[[Array, Array], Array],
        tolerance: float = RELATIVE_TOLERANCE,
    ) -> "BracketSearch":
        """The search after a look at its point; ``middle``: of two arrays: where to bisect."""
        lower = jnp.where(value < 0, self.point, self.lower)
        upper = jnp.where(value > 0, self.point, self.upper)
        resolution = ROUNDING * (jnp.abs(lower) + jnp.abs(upper))
        done = (jnp.abs(value) <= tolerance) | (upper - lower <= resolution)
        step = newton - self.point
        trusted = (newton > lower) & (newton < upper)
        trusted &= jnp.abs(step) <= 0.5 * jnp.abs(self.last_step)
        proposal = jnp.where(trusted, newton, middle(lower, upper))
        moving = self.active & ~done
        # Newton's error falls as its square: after a step from here there is nothing to look at
        last = trusted & (jnp.abs(step) <= math.sqrt(tolerance) * jnp.abs(self.point))
        return BracketSearch(
            point=jnp.where(moving, proposal, self.point),
            lower=lower,
            upper=upper,
            last_step=jnp.where(moving, proposal - self.point, self.last_step),
            active=moving & ~last,
        )


def bracketed_newton(
    residual: Callable[[Array], Array],
    lower: Array,
    upper: Array,
    guess: Array,
    tolerance: float = RELATIVE_TOLERANCE,
) -> tuple[Array, RootOutcome]:
    r"""Find the root of an increasing function in a bracket, element by element."""
    # Newton steps that leave the bracket, or that shrink by less than half, are replaced by
    # bisection (the safeguard of [Press2007]_ ch. 9.4), so it cannot diverge or stall.
    #
    # Not differentiable by itself: use :func:`implicit_root`.
    #
    # Source: [Press2007]_ ch. 9.4.

    def look(point: Array) -> tuple[Array, Array]:
        value, slope = _with_slope(residual, point)
        return value, point - value / slope

    return _search(look, lambda a, b: 0.5 * (a + b), (lower, upper, guess), tolerance)


def bracketed_power_newton(
    function: Callable[[Array], Array],
    target: Array,
    lower: Array,
    upper: Array,
    guess: Array,
    tolerance: float = RELATIVE_TOLERANCE,
) -> tuple[Array, RootOutcome]:
    r"""Find where a positive, increasing function of a positive unknown reaches a target."""
    # For functions that are nearly power laws, :math:`f \propto x^s`, over many decades: Newton's
    # step is taken in logarithms, :math:`x \leftarrow x\,(f/f_0)^{-1/s}`, with the local exponent
    # :math:`s = x f'/f`. The power is replaced by its Padé approximant about one, which is exact to
    # second order and needs neither logarithm nor exponential. Bisection is geometric.
    #
    # A function that grows less than linearly may be saturating, :math:`f = ax/(1 + bx)`, as the
    # force on a hot flyer is. A power would lead much too far there. The step is taken in
    # reciprocals, where such a function is a straight line: :math:`x \leftarrow x/[1 + (f/f_0 -
    # 1)/s]`.
    #
    # Not differentiable by itself: use :func:`implicit_root`.

    def look(point: Array) -> tuple[Array, Array]:
        return power_step(*_with_slope(function, point), point, target)

    return _search(look, geometric_middle, (lower, upper, guess), tolerance)


def power_step(value: Array, slope: Array, point: Array, target: Array) -> tuple[Array, Array]:
    """Residual of a function that is nearly a power law, and where Newton goes."""
    ratio, inverse_exponent = value / target, value / (point * slope)
    low, high = jnp.minimum(inverse_exponent, 1.0), jnp.maximum(inverse_exponent, 1.0)
    rise = inverse_exponent + high
    above, below = 1.0 + low + (1.0 - low) * ratio, 2.0 - rise + rise * ratio
    return ratio - 1.0, point * above / below


def geometric_middle(lower: Array, upper: Array) -> Array:
    """Where a bracket of positive numbers is bisected."""
    return jnp.sqrt(lower * upper)


def _with_slope(function: Callable[[Array], Array], point: Array) -> tuple[Array, Array]:
    return jax.jvp(function, (point,), (jnp.ones_like(point),))


def _search(
    look: Callable[[Array], tuple[Array, Array]],
    middle: Callable[[Array, Array], Array],
    bracket_and_guess: tuple[Array, Array, Array],
    tolerance: float,
) -> tuple[Array, RootOutcome]:
    """Search with a rule that gives, at a point, the residual and where Newton would go."""

    def advance(at: tuple[BracketSearch, Array]) -> tuple[BracketSearch, Array]:
        search, steps = at
        return search.advance(*look(search.point), middle, tolerance), steps + 1

    def unfinished(at: tuple[BracketSearch, Array]) -> Array:
        search, steps = at
        return jnp.any(search.active) & (steps < MAXIMUM_STEPS)

    at = BracketSearch.within(*bracket_and_guess), jnp.zeros((), int)
    for _ in range(STEPS_ON_GPU if jax.default_backend() == "gpu" else 0):
        at = advance(at)
    end, steps = jax.lax.while_loop(unfinished, advance, at)
    return end.point, RootOutcome(status=end.status, steps=steps)


def implicit_root(
    residual: Callable[[Array], Array],
    solve: Callable[[], tuple[Array, RootOutcome]],
    shape: tuple[int, ...],
) -> tuple[Array, RootOutcome]:
    """Attach the derivative of a root to its value, however it was found."""
    equation, parameters = with_parameters(residual, jnp.zeros(shape))
    search, around = with_parameters(solve)
    root, outcome = search(*map(jax.lax.stop_gradient, around))
    return _attach(equation, jnp.broadcast_to(root, shape), *parameters), outcome


def reach(
    function: Callable[[Array], Array], top: Array, highest: Array, wanted: Array
) -> tuple[Array, Array, RootOutcome]:
    """Find where an increasing function, ``highest`` at the ``top`` argument, has a value."""
    within = highest >= wanted
    # Where no argument suffices, a value within reach stands in, to be discarded by the caller: so
    # neither the search nor its derivative meets a NaN.
    size = jnp.where(highest == 0.0, 1.0, jnp.abs(highest))
    stand_in = jnp.where(highest == 0.0, 1.0, 0.5 * size)
    target = jnp.where(within, wanted, stand_in)

    def reached(argument: Array) -> Array:
        value = jnp.sign(highest) * function(argument)
        return jnp.where(highest == 0.0, argument / top, value)

    def search() -> tuple[Array, RootOutcome]:
        return bracketed_power_newton(
            reached,
            target=target,
            lower=top * SMALLEST_SHARE,
            upper=top,
            guess=top * target / size,
        )

    argument, outcome = implicit_root(
        lambda argument: reached(argument) - target, search, jnp.shape(target)
    )
    return argument, within, outcome


@partial(custom_jvp, nondiff_argnums=(0,))
def _attach(
    residual: Callable[..., Array],  # noqa: ARG001
    root: Array,
    *parameters: Array,  # noqa: ARG001
) -> Array:
    """A root that moves with the parameters of its equation."""
    return root


@partial(_attach.defjvp, symbolic_zeros=True)
def _move(
    residual: Callable[..., Array], primals: tuple[Array, ...], tangents: tuple[Any, ...]
) -> tuple[Array, Array]:
    (start, *parameters), (_, *changes) = primals, tangents
    root = _attach(residual, start, *parameters)
    _, slope = _with_slope(lambda point: residual(point, *parameters), root)
    return root, -change_with(partial(residual, root), parameters, changes) / slope


def change_with(
    function: Callable[..., Any], parameters: Sequence[Any], changes: Sequence[Any]
) -> Any:
    """Change of a function with its parameters; those that do not change are no work."""
    moving = [
        n
        for n, change in enumerate(changes)
        if not isinstance(change, jax.custom_derivatives.SymbolicZero)
    ]

    def of_moving(*values: Any) -> Any:
        whole = list(parameters)
        for n, value in zip(moving, values, strict=True):
            whole[n] = value
        return function(*whole)

    values = tuple(parameters[n] for n in moving)
    if not moving:
        return tree.map_leaves(jnp.zeros_like, function(*parameters))
    return jax.jvp(of_moving, values, tuple(changes[n] for n in moving))[1]
