"""Root-finding in several unknowns, with implicit gradients.

Every array element holds a system of its own: n equations for n unknowns, n small. Neither the
search nor the derivatives ever form a matrix that couples elements. For one unknown use
:mod:`lightflyer.numerics.rootfind`, which brackets the root and is more than twice as fast.
"""

import math
from collections.abc import Callable
from typing import Any, TypeAlias

from lightflyer.array.namespace import Array, Numeric, call, xp
from lightflyer.array.transformations import implicit, shape_of
from lightflyer.numerics.newton import SafeNewton
from lightflyer.numerics.rootfind import MAXIMUM_STEPS, RELATIVE_TOLERANCE, RootOutcome

Unknowns: TypeAlias = tuple[Array, ...]

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

    return implicit(wide, guess, lambda *_: search())


def _usable(guess: Array, bound: float) -> Array:
    stand_in = bound + 1.0 if math.isfinite(bound) else 0.0
    return xp.where(xp.isfinite(guess) & (guess > bound), guess, stand_in)
