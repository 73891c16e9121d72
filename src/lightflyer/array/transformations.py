"""Loops, choices, derivatives and roots: what JAX has its own way of."""

import functools
import math
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import (
    Array,
    by_jax,
    call,
    float64,
    is_jax,
    is_tracer,
    load_jax,
    number,
    xp,
)


def stop_gradient(value: Any) -> Any:
    """The same numbers, as constants for derivatives."""
    leaves = tree.leaves(value)
    if call.jax is None and not any(map(is_jax, leaves)):
        return value
    stop = (call.jax or sys.modules["jax"]).lax.stop_gradient
    return tree.map_leaves(lambda leaf: stop(leaf) if is_jax(leaf) else leaf, value)


def repeat_while(goes_on: Callable[[Any], Any], body: Callable[[Any], Any], state: Any) -> Any:
    """The state after steps of a loop that goes on as long as a condition holds."""
    if call.jax is not None:
        return call.jax.lax.while_loop(goes_on, body, state)
    while goes_on(state):
        state = body(state)
    return state


def repeat(body: Callable[[Any], tuple[Any, Any]], state: Any, count: int) -> tuple[Any, Any]:
    """The state after a number of steps, and what each step gave besides, stacked."""
    if call.jax is not None:
        found: tuple[Any, Any] = call.jax.lax.scan(
            lambda state, _: body(state), state, None, length=count
        )
        return found
    rows = []
    for _ in range(count):
        state, row = body(state)
        rows.append(row)
    return state, tree.map_leaves(lambda *parts: np.stack(parts), *rows)


def either(choice: Any, one: Callable[[], Any], other: Callable[[], Any]) -> Any:
    """What one of two functions gives; the other is not computed."""
    if call.jax is not None:
        return call.jax.lax.cond(choice, one, other)
    return one() if choice else other()


class custom_jvp:  # noqa: N801
    """As :class:`jax.custom_jvp`: a function with a rule for its derivative, which JAX alone uses.

    What records in JAX's place differentiates the function itself.
    """

    def __init__(self, function: Callable[..., Any]):
        functools.update_wrapper(self, function)
        self._function = function

    def defjvp(self, rule: Callable[..., Any]) -> Callable[..., Any]:
        self._rule = rule
        return rule

    @functools.cached_property
    def _with_rule(self) -> Any:
        made = sys.modules["jax"].custom_jvp(self._function)
        made.defjvp(self._rule)
        return made

    def __call__(self, *args: Any) -> Any:
        by_jax = call.jax is not None and call.jax is sys.modules.get("jax")
        traced = by_jax or any(map(is_jax, args))
        return (self._with_rule if traced else self._function)(*args)


def shape_of(function: Callable[..., Any], *args: Any) -> Any:
    """Shape of what a function gives, in its structure; JAX finds it without computing."""
    found = call.jax.eval_shape(function, *args) if call.jax is not None else function(*args)
    return tree.map_leaves(np.shape, found)


def implicit(
    residual: Callable[[Any], Any],
    guess: Any,
    solve: Callable[[Any, Any], tuple[Any, Any]],
    invert: Callable[[Any, Any], Any],
) -> tuple[Any, Any]:
    """A root under JAX, with the derivative of its equations, and what its search gives besides.

    ``invert``: solves a linear function for a value.
    """
    jax = call.jax
    kinds: list[Any] = []

    def solve_in_numbers(function: Any, guess: Any) -> tuple[Any, Any]:
        root, beside = solve(function, guess)
        kinds[:] = [tree.map_leaves(lambda leaf: xp.asarray(leaf).dtype, beside)]
        # what is no floating-point number has no tangent, which JAX does not allow for here
        return root, tree.map_leaves(lambda leaf: xp.asarray(leaf, float), beside)

    root, beside = jax.lax.custom_root(residual, guess, solve_in_numbers, invert, has_aux=True)
    return root, tree.map_leaves(lambda leaf, kind: leaf.astype(kind), beside, kinds[0])


_DIFFERENCE = 1e-7  # relative, of numbers by whose change a slope is taken
_LEAST_DIFFERENCE = 1e-10  # of those that are zero, and of the distance to a bound


def with_slopes(
    function: Callable[[Any], tuple[Array, ...]],
    point: tuple[Array, ...],
    lower: tuple[float, ...] = (),
) -> tuple[tuple[Array, ...], list[tuple[Array, ...]]]:
    """Values of elementwise functions, and their derivatives in each argument, one after another.

    JAX's are exact. NumPy's are differences, all of them by one call with one more axis in front;
    ``lower``: bounds of the first arguments. What has one, as an excess of temperature has, is
    known to the function by its distance to the bound: smaller steps would be lost in rounding.
    """
    if call.jax is not None:
        jvp, value, columns = call.jax.jvp, (), []
        for index, entry in enumerate(point):  # what does not depend on one is then no work

            def of_one(moved: Array, index: int = index) -> Any:
                return function((*point[:index], moved, *point[index + 1 :]))

            value, column = jvp(of_one, (entry,), (xp.ones_like(entry),))
            columns.append(column)
        return value, columns
    rows, steps = [], []
    for place, entry in enumerate(point, 1):
        stack = np.repeat(np.asarray(entry)[None], len(point) + 1, axis=0)
        change = np.where(entry == 0.0, _LEAST_DIFFERENCE, _DIFFERENCE * np.abs(entry))
        bound = lower[place - 1] if place <= len(lower) else -math.inf
        if bound > -math.inf:
            change = np.maximum(change, _LEAST_DIFFERENCE * np.abs(entry - bound))
        stack[place] += change
        rows.append(stack)
        steps.append(stack[place] - entry)
    values, slopes = [], []
    for found in function(tuple(rows)):
        wide = np.broadcast_to(found, (len(rows) + 1, *np.shape(found)[1:]))
        values.append(wide[0])
        slopes.append([(one - wide[0]) / step for one, step in zip(wide[1:], steps, strict=True)])
    return tuple(values), list(zip(*slopes, strict=True))


def compiled(function: Callable[..., Any], **options: Any) -> Callable[..., Any]:
    """A function of numbers and records that XLA compiles, in double precision; NumPy in and out.

    ``options``: of :func:`jax.jit`.
    """

    @functools.cache
    def jitted() -> Any:
        return load_jax().jit(function, **options)

    @functools.wraps(function)
    def wrapper(*args: Any) -> Any:
        if any(map(is_tracer, tree.leaves(args))):
            with by_jax():
                return jitted()(*args)
        run = jitted()
        with by_jax():
            found = run(*tree.map_leaves(number, args))
            return tree.map_leaves(lambda leaf: np.asarray(leaf)[()], found)

    return wrapper


def real_of_jax(value: Array) -> Array:
    """Real part of an array of JAX, whose derivative is in double precision for any caller."""
    return _real_part().bind(value)


@functools.cache
def _real_part() -> Any:
    from jax.extend.core import Primitive
    from jax.interpreters import ad, batching, mlir

    jax = load_jax()

    def along(change: Any, _: Any) -> list[Any]:
        with float64():
            return [jax.lax.complex(change, jax.numpy.zeros_like(change))]

    primitive = Primitive("real_part")
    primitive.def_impl(jax.lax.real)
    primitive.def_abstract_eval(lambda z: jax.core.ShapedArray(z.shape, np.dtype(float)))
    ad.deflinear2(primitive, along)
    batching.defvectorized(primitive)
    mlir.register_lowering(primitive, mlir.lower_fun(jax.lax.real, multiple_results=False))
    return primitive
