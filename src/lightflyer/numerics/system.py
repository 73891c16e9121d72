"""Root-finding in several unknowns, with implicit gradients.

Every array element holds a system of its own: n equations for n unknowns, n small. Neither the
search nor the derivatives ever form a matrix that couples elements. For one unknown use
:mod:`lightflyer.numerics.rootfind`, which brackets the root and is more than twice as fast.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import Any, TypeAlias

from lightflyer.numerics.linear import solve_linear
from lightflyer.numerics.newton import SafeNewton
from lightflyer.numerics.rootfind import (
    MAXIMUM_STEPS,
    RELATIVE_TOLERANCE,
    RootOutcome,
    change_with,
)
from lightflyer.program.tracing import with_parameters
from lightflyer.pytree.lazy_jax import Array, ArrayLike, custom_jvp, jax, jnp

Unknowns: TypeAlias = tuple[Array, ...]

_PLAIN_STEPS = 30
"""Newton steps before the careful search: enough from a thousand times the root of radiation."""


def solve_system(
    residual: Callable[[Unknowns], Unknowns],
    guess: tuple[ArrayLike, ...] | Callable[[], tuple[ArrayLike, ...]],
    *,
    lower: float | tuple[float, ...] = -math.inf,
    tolerance: float | Array = RELATIVE_TOLERANCE,
    maximum_steps: int = MAXIMUM_STEPS,
) -> tuple[Unknowns, RootOutcome]:
    """Find where several functions of as many unknowns vanish, element by element."""
    # Newton's method in all elements at once; each stops by itself. Where that fails, the search
    # starts again from the guess with steps that are shortened until they reduce the residual.
    #
    # The derivative is that of the implicit function. It is not finite where the Jacobian is
    # singular.
    first: Callable[[], tuple[ArrayLike, ...]] = guess if callable(guess) else lambda: guess
    zeros = _zeros(residual, first)
    bounds = lower if isinstance(lower, tuple) else (lower,) * len(zeros)
    if len(bounds) != len(zeros):
        raise ValueError(f"{len(zeros)} unknowns need as many bounds, not {len(bounds)}")

    def equations(point: Unknowns) -> Unknowns:
        return tuple(jnp.broadcast_to(entry, zeros[0].shape) for entry in residual(point))

    def search() -> tuple[Unknowns, RootOutcome]:
        start = tuple(
            jnp.broadcast_to(_usable(jnp.asarray(entry, float), bound), zeros[0].shape)
            for entry, bound in zip(first(), bounds, strict=True)
        )
        finder = SafeNewton(
            bounds, tolerance, min(_PLAIN_STEPS, maximum_steps), careful_steps=maximum_steps
        )
        return finder.search(equations, start)

    plain, around = with_parameters(search)
    root, outcome = plain(*map(jax.lax.stop_gradient, around))
    return implicit_system(equations, root), outcome


def implicit_system(residual: Callable[[Unknowns], Unknowns], root: Unknowns) -> Unknowns:
    """Attach the derivative of a root to its value, however it was found."""

    def equations(point: Unknowns) -> Unknowns:
        return tuple(jnp.broadcast_to(entry, root[0].shape) for entry in residual(point))

    converted, parameters = with_parameters(equations, root)
    return _attach(converted, root, *parameters)


@partial(custom_jvp, nondiff_argnums=(0,))
def _attach(
    equations: Callable[..., Unknowns],  # noqa: ARG001
    root: Unknowns,
    *parameters: Array,  # noqa: ARG001
) -> Unknowns:
    """A root that moves with the parameters of its equations."""
    return root


@partial(_attach.defjvp, symbolic_zeros=True)
def _move(
    equations: Callable[..., Unknowns], primals: tuple[Any, ...], tangents: tuple[Any, ...]
) -> tuple[Unknowns, Unknowns]:
    (start, *parameters), (_, *changes) = primals, tangents
    root = _attach(equations, start, *parameters)
    moved = change_with(partial(equations, root), parameters, changes)
    _, linear = jax.linearize(lambda point: equations(point, *parameters), root)
    return root, _invert(linear, tuple(-entry for entry in moved))


def _zeros(
    residual: Callable[[Unknowns], Unknowns], first: Callable[[], tuple[ArrayLike, ...]]
) -> Unknowns:
    """Zeros in the shape of the unknowns."""

    def both() -> tuple[Unknowns, Unknowns]:
        point = tuple(jnp.asarray(entry, float) for entry in first())
        return point, residual(point)

    point, equations = jax.eval_shape(both)
    if len(equations) != len(point):
        raise ValueError(f"{len(point)} unknowns need as many equations, not {len(equations)}")
    shape = jnp.broadcast_shapes(*(entry.shape for entry in (*point, *equations)))
    return tuple(jnp.zeros(shape, float) for _ in point)


def _usable(guess: Array, bound: float) -> Array:
    stand_in = bound + 1.0 if math.isfinite(bound) else 0.0
    return jnp.where(jnp.isfinite(guess) & (guess > bound), guess, stand_in)


def _invert(linear: Callable[[Unknowns], Unknowns], vector: Unknowns) -> Unknowns:
    """Solve an elementwise linear map, whose Jacobian is one small block an element."""
    columns = []
    for index in range(len(vector)):
        unit = tuple(jnp.full_like(entry, place == index) for place, entry in enumerate(vector))
        columns.append(linear(unit))
    return solve_linear(tuple(zip(*columns, strict=True)), vector)
