"""JAX's primitives as operations on single numbers.

An array is a NumPy array of nodes. What moves elements about costs nothing then, and every other
primitive is a few operations on each element. A primitive that is not here is refused by its name.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from functools import reduce
from typing import Any

import jax
import numpy as np
from jax.extend.core import ClosedJaxpr, Jaxpr, Literal

from .graph import OPERATORS, Graph, Node, Scope


class UnsupportedError(NotImplementedError):
    """A traced function has something in it that is not written in JavaScript yet."""


class Interpreter:
    """Turns a traced function into a graph.

    Parameters
    ----------
    graph : Graph
    """

    def __init__(self, graph: Graph):
        self.graph = graph
        self.scope: Scope | None = None

    def run(self, closed: ClosedJaxpr, inputs: list[np.ndarray]) -> list[np.ndarray]:
        """Follow a traced function.

        Parameters
        ----------
        closed : ClosedJaxpr
        inputs : list of array of Node

        Returns
        -------
        list of array of Node

        Raises
        ------
        UnsupportedError
            If a primitive or a type of number is not supported.
        """
        jaxpr: Jaxpr = closed.jaxpr
        known = {
            name: self.constants(value)
            for name, value in zip(jaxpr.constvars, closed.consts, strict=True)
        }
        known.update(zip(jaxpr.invars, inputs, strict=True))

        def read(atom: Any) -> np.ndarray:
            return self.constants(atom.val) if isinstance(atom, Literal) else known[atom]

        for equation in jaxpr.eqns:
            found = self._bind(equation, [read(atom) for atom in equation.invars])
            known.update(zip(equation.outvars, found, strict=True))
        return [read(atom) for atom in jaxpr.outvars]

    def constants(self, value: Any) -> np.ndarray:
        """Nodes of an array that is known."""
        return self.map(self.graph.constant, np.asarray(value))

    def map(self, function: Callable[..., Node], *arrays: np.ndarray) -> np.ndarray:
        """Apply a function to each element."""
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
        found = np.empty(shape, object)
        flat = [np.broadcast_to(array, shape).ravel() for array in arrays]
        found.ravel()[:] = [function(*elements) for elements in zip(*flat, strict=True)]
        return found

    def apply(self, name: str, *arrays: np.ndarray) -> np.ndarray:
        """Apply an operation to each element."""
        return self.map(lambda *nodes: self.graph.operation(name, *nodes), *arrays)

    def _bind(self, equation: Any, inputs: list[np.ndarray]) -> list[np.ndarray]:
        name = equation.primitive.name
        rule = RULES.get(name)
        if rule is None and name not in OPERATORS:
            raise UnsupportedError(
                f'primitive "{name}" is not written in JavaScript yet: add it to '
                "docs/_extensions/calculator/primitives.py"
            )
        for variable in equation.outvars:
            _require_type(name, variable.aval.dtype)
        if rule is None:
            return [self.apply(name, *inputs)]
        found = rule(self, equation, *inputs)
        return found if equation.primitive.multiple_results else [found]


def _require_type(name: str, dtype: np.dtype) -> None:
    if not (dtype in (bool, np.float64) or np.issubdtype(dtype, np.integer)):
        raise UnsupportedError(
            f'primitive "{name}" gives {dtype}: numbers are float64, integers (which must not '
            "overflow) or truth values"
        )


RULES: dict[str, Callable[..., Any]] = {}
"""What is not one operation on each element, by the primitive's name."""


def rule(*names: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a function the rule of some primitives."""

    def keep(function: Callable[..., Any]) -> Callable[..., Any]:
        RULES.update(dict.fromkeys(names, function))
        return function

    return keep


# --- element by element ---


@rule("div")
def _div(to: Interpreter, equation: Any, one: Any, other: Any) -> Any:
    quotient = to.apply("div", one, other)
    whole = np.issubdtype(equation.outvars[0].aval.dtype, np.integer)
    return to.apply("trunc", quotient) if whole else quotient


@rule("integer_pow")
def _integer_pow(to: Interpreter, equation: Any, base: Any) -> Any:
    exponent = equation.params["y"]
    result, square, left = to.constants(1.0), base, abs(exponent)
    while left:
        result = to.apply("mul", result, square) if left % 2 else result
        square, left = to.apply("mul", square, square), left // 2
    return to.apply("div", to.constants(1.0), result) if exponent < 0 else result


@rule("square")
def _square(to: Interpreter, _: Any, base: Any) -> Any:
    return to.apply("mul", base, base)


@rule("rsqrt")
def _rsqrt(to: Interpreter, _: Any, value: Any) -> Any:
    return to.apply("div", to.constants(1.0), to.apply("sqrt", value))


@rule("logistic")
def _logistic(to: Interpreter, _: Any, value: Any) -> Any:
    one = to.constants(1.0)
    return to.apply("div", one, to.apply("add", one, to.apply("exp", to.apply("neg", value))))


@rule("add_any")
def _add_any(to: Interpreter, _: Any, one: Any, other: Any) -> Any:
    return to.apply("add", one, other)


@rule("lt_to")
def _before(to: Interpreter, _: Any, one: Any, other: Any) -> Any:
    """Less in the order that sorting has: NaN comes last."""
    less, is_number = to.apply("lt", one, other), to.apply("eq", one, one)
    return to.apply("or", less, to.apply("and", is_number, to.apply("ne", other, other)))


@rule("and", "or", "xor", "not")
def _logic(to: Interpreter, equation: Any, *inputs: Any) -> Any:
    name = equation.primitive.name
    if equation.outvars[0].aval.dtype != bool:
        raise UnsupportedError(f'primitive "{name}" is for truth values only, not for bits')
    return to.apply("ne" if name == "xor" else name, *inputs)


@rule("clamp")
def _clamp(to: Interpreter, _: Any, low: Any, value: Any, high: Any) -> Any:
    return to.apply("min", to.apply("max", value, low), high)


@rule("select_n")
def _select_n(to: Interpreter, _: Any, which: Any, *cases: Any) -> Any:
    if len(cases) == 2:
        return to.map(lambda flag, no, yes: to.graph.choice(flag, yes, no), which, *cases)
    numbers = to.apply("number", which)
    return to.map(lambda place, *nodes: to.graph.element(list(nodes), place), numbers, *cases)


@rule("convert_element_type")
def _convert(to: Interpreter, equation: Any, value: Any) -> Any:
    (source,), (target,) = equation.invars, equation.outvars
    old, new = source.aval.dtype, target.aval.dtype
    if old == new or value.size == 0:
        return value
    if np.issubdtype(new, np.bool_):
        return to.apply("ne", value, to.constants(0))
    if np.issubdtype(old, np.bool_):
        return to.apply("number", value)
    if np.issubdtype(old, np.floating) and np.issubdtype(new, np.integer):
        return to.apply("trunc", value)
    return value


@rule(
    "stop_gradient",
    "copy",
    "copy_p",
    "optimization_barrier",
    "pvary",
    "nonbatchable",
    "nondifferentiable_backward",
)
def _same(_: Interpreter, equation: Any, *values: Any) -> Any:
    return list(values) if equation.primitive.multiple_results else values[0]


# --- elements moved about ---


@rule("broadcast_in_dim")
def _broadcast_in_dim(_: Interpreter, equation: Any, value: Any) -> Any:
    shape, places = equation.params["shape"], equation.params["broadcast_dimensions"]
    sizes = [1] * len(shape)
    for place, size in zip(places, value.shape, strict=True):
        sizes[place] = size
    return np.broadcast_to(value.reshape(sizes), shape)


@rule("reshape", "squeeze", "expand_dims")
def _reshape(_: Interpreter, equation: Any, value: Any) -> Any:
    return value.reshape(equation.outvars[0].aval.shape)


@rule("transpose")
def _transpose(_: Interpreter, equation: Any, value: Any) -> Any:
    return value.transpose(equation.params["permutation"])


@rule("rev")
def _rev(_: Interpreter, equation: Any, value: Any) -> Any:
    return np.flip(value, equation.params["dimensions"])


@rule("concatenate")
def _concatenate(_: Interpreter, equation: Any, *values: Any) -> Any:
    return np.concatenate(values, equation.params["dimension"])


@rule("stack")
def _stack(_: Interpreter, equation: Any, *values: Any) -> Any:
    return np.stack(values, equation.params["axis"])


@rule("slice")
def _slice(_: Interpreter, equation: Any, value: Any) -> Any:
    given = equation.params
    steps = given["strides"] or (1,) * value.ndim
    limits = zip(given["start_indices"], given["limit_indices"], steps, strict=True)
    return value[tuple(slice(*limit) for limit in limits)]


@rule("iota")
def _iota(to: Interpreter, equation: Any, *_: Any) -> Any:
    given = equation.params
    places = np.indices(given["shape"])[given["dimension"]]
    return to.constants(places.astype(given["dtype"]))


@rule("dynamic_slice")
def _dynamic_slice(to: Interpreter, equation: Any, value: Any, *start: Any) -> Any:
    sizes = equation.params["slice_sizes"]
    places = [
        to.map(lambda node, last=full - size: within(to, node, last), one)
        for one, full, size in zip(start, value.shape, sizes, strict=True)
    ]
    return _window(to, value, [place.item() for place in places], sizes)


@rule("gather")
def _gather(to: Interpreter, equation: Any, value: Any, indices: Any) -> Any:
    """A window for each index vector; a place beyond the ends is moved in, or filled."""
    given = equation.params
    numbers, sizes = given["dimension_numbers"], given["slice_sizes"]
    if numbers.operand_batching_dims or numbers.start_indices_batching_dims:
        raise UnsupportedError('primitive "gather" has batches of operands')
    filling = given["mode"] == jax.lax.GatherScatterMode.FILL_OR_DROP
    shape = equation.outvars[0].aval.shape
    batch = [place for place in range(len(shape)) if place not in numbers.offset_dims]
    kept = [axis for axis in range(value.ndim) if axis not in numbers.collapsed_slice_dims]
    found = np.empty(shape, object)
    for where in np.ndindex(*indices.shape[:-1]):
        start, inside = [to.graph.constant(0)] * value.ndim, to.graph.constant(True)
        for axis, index in zip(numbers.start_index_map, indices[where], strict=True):
            last = value.shape[axis] - sizes[axis]
            start[axis] = within(to, index, last)
            same = to.graph.operation("eq", start[axis], index)
            inside = to.graph.operation("and", inside, same)
        window = _window(to, value, start, sizes).reshape([sizes[axis] for axis in kept])
        if filling:
            fill = _filling(given["fill_value"], equation.outvars[0].aval.dtype)
            other = to.graph.constant(fill)
            window = to.map(lambda node, i=inside, o=other: to.graph.choice(i, node, o), window)
        into: list[Any] = [slice(None)] * len(shape)
        for place, position in zip(batch, where, strict=True):
            into[place] = position
        found[(*into, ...)] = window  # the dots: an array of no axes is one number, too
    return found


def _filling(given: Any, dtype: np.dtype) -> Any:
    if given is not None:
        return given
    return math.nan if np.issubdtype(dtype, np.floating) else np.iinfo(dtype).min


def within(to: Interpreter, index: Node, last: int) -> Node:
    """An index moved between 0 and the last place."""
    low, high = to.graph.constant(0), to.graph.constant(last)
    return to.graph.operation("min", to.graph.operation("max", index, low), high)


def _window(to: Interpreter, value: Any, start: list[Node], sizes: Any) -> Any:
    """A part of an array that begins at some place within it."""
    steps = [math.prod(value.shape[axis + 1 :]) for axis in range(value.ndim)]
    flat, graph, found = list(value.ravel()), to.graph, np.empty(sizes, object)
    for offsets in itertools.product(*map(range, sizes)):
        shift = sum(offset * step for offset, step in zip(offsets, steps, strict=True))
        place = graph.constant(shift)
        for begin, step in zip(start, steps, strict=True):
            part = graph.operation("mul", begin, graph.constant(step))
            place = part if place.is_constant and place.data == 0 else _sum(graph, part, place)
        found[offsets] = graph.element(flat, place)
    return found


def _sum(graph: Graph, one: Node, other: Node) -> Node:
    """Sum of two whole numbers, zero being of no effect."""
    if one.is_constant and one.data == 0:
        return other
    return graph.operation("add", one, other)


# --- many elements to one ---


def _reduction(name: str) -> Callable[..., Any]:
    def reduced(to: Interpreter, equation: Any, value: Any) -> Any:
        axes = equation.params["axes"]
        kept = [axis for axis in range(value.ndim) if axis not in axes]
        count = math.prod(value.shape[axis] for axis in axes)
        rows = value.transpose([*axes, *kept]).reshape(
            [count, *(value.shape[axis] for axis in kept)]
        )
        if count == 0:
            raise UnsupportedError(f'primitive "{equation.primitive.name}" of no elements')
        elements = [rows[place, ...] for place in range(count)]
        return reduce(lambda one, other: to.apply(name, one, other), elements)

    return reduced


for _primitive, _operation in {
    "reduce_sum": "add",
    "reduce_prod": "mul",
    "reduce_max": "max",
    "reduce_min": "min",
    "reduce_and": "and",
    "reduce_or": "or",
}.items():
    rule(_primitive)(_reduction(_operation))


def _alone(node: Node) -> np.ndarray:
    """An array of no axes."""
    found = np.empty((), object)
    found[()] = node
    return found


@rule("select_if_vmap")
def _select_if_mapped(_: Interpreter, __: Any, ___: Any, value: Any, ____: Any) -> Any:
    """Equinox's choice for what is mapped over: nothing is."""
    return value


@rule("unvmap_any", "unvmap_all", "unvmap_max")
def _unvmap(to: Interpreter, equation: Any, value: Any) -> Any:
    """Equinox's reductions over whatever a function is mapped over, here over nothing else."""
    name = {"any": "or", "all": "and", "max": "max"}[equation.primitive.name.split("_")[1]]
    elements = list(map(_alone, value.ravel()))
    return reduce(lambda one, other: to.apply(name, one, other), elements)


@rule("dot_general")
def _dot_general(to: Interpreter, equation: Any, one: Any, other: Any) -> Any:
    (left, right), batches = equation.params["dimension_numbers"]
    if any(batches):
        raise UnsupportedError('primitive "dot_general" has batches')
    rows = np.moveaxis(one, left, range(len(left)))
    columns = np.moveaxis(other, right, range(len(right)))
    free = rows.shape[len(left) :] + columns.shape[len(right) :]
    count = math.prod(rows.shape[: len(left)])
    rows, columns = rows.reshape(count, -1, 1), columns.reshape(count, 1, -1)
    products = [to.apply("mul", row, column) for row, column in zip(rows, columns, strict=True)]
    return reduce(lambda a, b: to.apply("add", a, b), products).reshape(free)
