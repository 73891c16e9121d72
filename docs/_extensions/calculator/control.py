"""JAX's calls, branches and loops, and the way in: a function of numbers becomes a graph."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.extend.core import ClosedJaxpr, Jaxpr

from .graph import Graph, Node
from .primitives import Interpreter, UnsupportedError, rule, within

MOST_STEPS = 256
"""Steps up to which a loop of a known number of steps is written out."""


def _closed(function: Any) -> ClosedJaxpr:
    return function if isinstance(function, ClosedJaxpr) else ClosedJaxpr(function, ())


@rule("jit", "pjit", "closed_call", "core_call", "checkpoint", "custom_jvp_call", "custom_vjp_call")
def _call(to: Interpreter, equation: Any, *inputs: Any) -> Any:
    given = equation.params
    names = ("jaxpr", "call_jaxpr", "fun_jaxpr")
    function = next(given[name] for name in names if name in given)
    return to.run(_closed(function), list(inputs))


@rule("cond")
def _cond(to: Interpreter, equation: Any, which: Any, *inputs: Any) -> Any:
    """Every branch is computed, and one is chosen: nothing in them has a side effect."""
    branches = equation.params["branches"]
    if any(_has_loop(branch.jaxpr) for branch in branches):
        raise UnsupportedError('primitive "while" inside of "cond"')
    found = [to.run(branch, list(inputs)) for branch in branches]
    number = to.apply("number", which).item()
    place = within(to, number, len(branches) - 1)
    return [
        to.map(lambda *nodes: to.graph.element(list(nodes), place), *results)
        for results in zip(*found, strict=True)
    ]


def _has_loop(jaxpr: Jaxpr) -> bool:
    return any(
        equation.primitive.name == "while"
        or any(_has_loop(inner.jaxpr) for inner in _functions(equation.params.values()))
        for equation in jaxpr.eqns
    )


def _functions(values: Any) -> Iterator[ClosedJaxpr]:
    for value in values:
        if isinstance(value, ClosedJaxpr | Jaxpr):
            yield _closed(value)
        elif isinstance(value, tuple):
            yield from _functions(value)


@rule("custom_linear_solve")
def _custom_linear_solve(to: Interpreter, equation: Any, *inputs: Any) -> Any:
    """By the solver that comes with it, as the derivative of a root has one."""
    lengths, functions = equation.params["const_lengths"], equation.params["jaxprs"]
    begin = lengths.matvec + lengths.vecmat
    sides = inputs[sum(lengths) :]
    return to.run(functions.solve, [*inputs[begin : begin + lengths.solve], *sides])


@rule("scan")
def _scan(to: Interpreter, equation: Any, *inputs: Any) -> Any:
    given = equation.params
    length, constants, carried = given["length"], given["num_consts"], given["num_carry"]
    if length > MOST_STEPS:
        raise UnsupportedError(f'primitive "scan" of {length} steps: at most {MOST_STEPS}')
    fixed, carry = list(inputs[:constants]), list(inputs[constants : constants + carried])
    rows = inputs[constants + carried :]
    steps = range(length)
    outputs = []
    for step in reversed(steps) if given["reverse"] else steps:
        found = to.run(given["jaxpr"], [*fixed, *carry, *(row[step, ...] for row in rows)])
        carry = found[:carried]
        outputs.append(found[carried:])
    if given["reverse"]:
        outputs.reverse()
    return carry + [np.stack(column) for column in zip(*outputs, strict=True)]


@rule("while")
def _while(to: Interpreter, equation: Any, *inputs: Any) -> Any:
    given, graph, outer = equation.params, to.graph, to.scope
    of_condition, of_body = given["cond_nconsts"], given["body_nconsts"]
    for_condition, for_body = inputs[:of_condition], inputs[of_condition : of_condition + of_body]
    start = inputs[of_condition + of_body :]
    loop = graph.loop([node for array in start for node in array.ravel()], outer)
    variables = _like(start, loop.variables)
    to.scope = loop.scope
    (condition,) = to.run(given["cond_jaxpr"], [*for_condition, *variables])
    following = to.run(given["body_jaxpr"], [*for_body, *variables])
    to.scope = outer
    loop.condition = condition.item()
    loop.following = [node for array in following for node in array.ravel()]
    return _like(start, graph.results(loop, outer))


def _like(arrays: Any, nodes: list[Node]) -> list[np.ndarray]:
    """The nodes in arrays of the same shapes."""
    rest, found = iter(nodes), []
    for array in arrays:
        filled = np.empty(array.shape, object)
        filled.ravel()[:] = list(itertools.islice(rest, array.size))
        found.append(filled)
    return found


def trace(function: Callable[..., Any], count: int) -> tuple[list[Node], list[Node]]:
    """Trace a function of numbers.

    Parameters
    ----------
    function : callable
        Of ``count`` numbers, to numbers or arrays; to be called in double precision.
    count : int

    Returns
    -------
    arguments, results : list of Node
    """
    number = jax.ShapeDtypeStruct((), jnp.float64)
    closed = jax.make_jaxpr(function)(*(number,) * count)
    graph = Graph()
    arguments = [graph.variable() for _ in range(count)]
    inputs = []
    for node in arguments:
        scalar = np.empty((), object)
        scalar[()] = node
        inputs.append(scalar)
    found = Interpreter(graph).run(closed, inputs)
    return arguments, [node for array in found for node in array.ravel()]
