"""Operations of a program on single numbers.

An array is a NumPy array of nodes. What moves elements about costs nothing then, and every other
operation is a few on each element. An array that is known stays one of numbers for as long as its
elements are only moved and looked up. An operation that is not here is refused by its name.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from lightflyer.program import horner, spline
from lightflyer.program.operations import RULES as MOVES
from lightflyer.program.operations import UnsupportedError
from lightflyer.program.program import LOOKED_UP, Block, Operation, Program
from lightflyer.program.scalar.graph import FOLDS, Graph, Node, Scope, Table

MOST_STEPS = 256
"""Steps up to which a loop of a known number of steps is written out."""

_MOVES = {"broadcast_in_dim", "concatenate", "pad", "reshape", "rev", "slice", "split", "squeeze",
          "stack", "transpose", "unstack"}  # fmt: skip
"""Operations that move elements alone: NumPy's rules serve for nodes, too."""

_LARGE = 100_000  # Elements from which on a table stays in its array

_REDUCTIONS = {
    "reduce_sum": "add",
    "reduce_prod": "mul",
    "reduce_max": "max",
    "reduce_min": "min",
    "reduce_and": "and",
    "reduce_or": "or",
}

_RULES: dict[str, Callable[..., Any]] = {}
"""What is neither one operation on each element nor a move, by the operation's name."""


class GraphOf(NamedTuple):
    """A program as a graph of numbers."""

    arguments: list[Node]
    parameters: list[Node]  # Numbers that are given before
    tables: list[Table]  # The same of arrays
    results: list[np.ndarray]  # Of nodes


def graph_of(
    program: Program,
    known: Mapping[int, Any],
    shapes: Mapping[int, tuple[int, ...]],
    given: Mapping[int, np.ndarray] = MappingProxyType({}),
) -> GraphOf:
    """The graph of a program.

    ``known``: inputs that are known, by their places; ``given``: those that will be known before
    the function is used, numbers and arrays like these; ``shapes``: those of the others, which
    have no axes where none is given.
    """
    emitter = _Emitter(Graph())
    found = GraphOf([], [], [], [])
    emitter.values.update(program.constants)
    for place, number in enumerate(program.body.arguments):
        if place in known:
            emitter.values[number] = np.asarray(known[place])
            continue
        if place in given and is_table(program, place, given[place]):
            # a view: the same array may stand in two places now, and others there later
            emitter.values[number] = array = given[place].view()
            found.tables.append(emitter.table_to_come(array))
            continue
        if place in given:
            shape, make, listed = given[place].shape, emitter.graph.parameter, found.parameters
        else:
            shape, make, listed = shapes.get(place, ()), emitter.graph.variable, found.arguments
        nodes = np.empty(shape, object)
        nodes.ravel()[:] = [make("f") for _ in range(nodes.size)]
        emitter.values[number] = nodes
        listed.extend(nodes.ravel())
    found.results.extend(map(emitter.nodes, emitter.run(program.body)))
    return found


def is_table(program: Program, place: int, array: np.ndarray) -> bool:
    """Whether elements of an input are looked up, and nothing else is done with it."""
    return bool(array.ndim) and program.tables[place]


def elements_of(array: np.ndarray) -> Sequence[Any]:
    """The elements of an array of numbers, to be looked up one by one."""
    # numbers of Python are found a little sooner, and need four times the memory
    flat = array.ravel()
    return tuple(flat.tolist()) if flat.size < _LARGE else flat.data


class _Emitter:
    def __init__(self, graph: Graph):
        self.graph = graph
        self.scope: Scope | None = None
        self.values: dict[int, np.ndarray] = {}
        self._tables: dict[int, tuple[np.ndarray, Sequence[Any] | Table]] = {}

    def run(self, block: Block) -> list[np.ndarray]:
        """Results of a block whose arguments are set."""
        for operation in block.operations:
            inputs = [self.values[number] for number in operation.inputs]
            found = self._outputs(operation, inputs)
            parts = found if isinstance(found, list) else [found]
            self.values.update(zip(operation.outputs, parts, strict=True))
        return [self.values[number] for number in block.results]

    def _outputs(self, operation: Operation, inputs: Sequence[np.ndarray]) -> Any:
        name, given = operation.name, operation.parameters
        is_known = [array.dtype != object for array in inputs]
        if not (name in _MOVES and all(is_known)):
            kept = name in LOOKED_UP
            inputs = [*inputs[:kept], *map(self.nodes, inputs[kept:])]
        if name in _BLOCKS:
            return _BLOCKS[name](self, operation, inputs)
        if name in _RULES:
            return _RULES[name](self, *inputs, **given)
        if name in _MOVES:
            return MOVES[name]({}, *inputs, **given)
        if name in _REDUCTIONS:
            value = self.filled(inputs[0], given["shape"]) if "shape" in given else inputs[0]
            return self._reduce(_REDUCTIONS[name], value, given["axes"])
        if name not in FOLDS:
            raise UnsupportedError(f'operation "{name}" is not written on single numbers yet')
        return self.apply(name, *inputs)

    def nodes(self, array: np.ndarray) -> np.ndarray:
        """An array as one of nodes."""
        return array if array.dtype == object else self.constants(array)

    def filled(self, array: np.ndarray, shape: Sequence[int]) -> np.ndarray:
        """An array that fills its axes: a constant that is the same everywhere need not."""
        if array.shape == tuple(shape):
            return array
        if id(array) in self._tables and isinstance(self.table(array), Table):
            raise UnsupportedError("a table that fills axes is not written as one to come")
        return np.broadcast_to(array, shape)

    def table(self, array: np.ndarray) -> Sequence[Any] | Table:
        """The elements of an array of numbers."""
        # what is kept keeps the array, too: another one may not come to its place in memory
        if id(array) not in self._tables:
            self._tables[id(array)] = array, elements_of(array)
        return self._tables[id(array)][1]

    def table_to_come(self, array: np.ndarray) -> Table:
        """What stands for the elements of an array like this one."""
        table = Table("b" if array.dtype == bool else "f")
        self._tables[id(array)] = array, table
        return table

    def constants(self, value: Any) -> np.ndarray:
        """Nodes of an array that is known."""
        array = np.asarray(value)
        return self.map(self.graph.constant, array)

    def map(self, function: Callable[..., Node], *arrays: np.ndarray) -> np.ndarray:
        """Apply a function to each element."""
        if not any(array.ndim for array in arrays):
            found = np.empty((), object)
            found[()] = function(*(array.item() for array in arrays))
            return found
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
        found = np.empty(shape, object)
        flat = [np.broadcast_to(array, shape).ravel() for array in arrays]
        found.ravel()[:] = [function(*elements) for elements in zip(*flat, strict=True)]
        return found

    def apply(self, name: str, *arrays: np.ndarray) -> np.ndarray:
        """Apply an operation to each element."""
        return self.map(lambda *nodes: self.graph.operation(name, *nodes), *arrays)

    def _reduce(self, name: str, value: np.ndarray, axes: list[int]) -> np.ndarray:
        if not value.ndim:
            return value
        kept = [axis for axis in range(value.ndim) if axis not in axes]
        rows = value.transpose([*axes, *kept]).reshape([-1, *(value.shape[axis] for axis in kept)])
        if not len(rows):
            raise UnsupportedError(f'operation "{name}" of no elements')
        parts = [rows[place, ...] for place in range(len(rows))]
        return reduce(lambda one, other: self.apply(name, one, other), parts)

    def within(self, index: Node, last: int) -> Node:
        """An index moved between 0 and the last place."""
        low, high = self.graph.constant(0), self.graph.constant(last)
        return self.graph.operation("min", self.graph.operation("max", index, low), high)

    def window(self, value: np.ndarray, start: list[Node], sizes: Sequence[int]) -> np.ndarray:
        """A part of an array that begins at some place within it."""
        steps = [math.prod(value.shape[axis + 1 :]) for axis in range(value.ndim)]
        graph, found = self.graph, np.empty(sizes, object)
        if value.dtype == object:
            look_up = partial(graph.element, list(value.ravel()))
        else:
            look_up = partial(graph.row, self.table(value))
        for offsets in itertools.product(*map(range, sizes)):
            place = graph.constant(sum(a * b for a, b in zip(offsets, steps, strict=True)))
            for begin, step in zip(start, steps, strict=True):
                part = graph.operation("mul", begin, graph.constant(step))
                place = graph.operation("add", part, place)
            found[offsets] = look_up(place)
        return found


def _rule(*names: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def keep(function: Callable[..., Any]) -> Callable[..., Any]:
        _RULES.update(dict.fromkeys(names, function))
        return function

    return keep


# --- element by element ---


@_rule("div")
def _div(to: _Emitter, one: Any, other: Any) -> Any:

    def divided(a: Node, b: Node) -> Node:
        quotient = to.graph.operation("div", a, b)
        return to.graph.operation("trunc", quotient) if a.kind == b.kind == "i" else quotient

    return to.map(divided, one, other)


@_rule("integer_pow")
def _integer_pow(to: _Emitter, base: Any, *, y: int) -> Any:
    result, square, left = to.constants(1.0), base, abs(y)
    while left:
        result = to.apply("mul", result, square) if left % 2 else result
        square, left = to.apply("mul", square, square), left // 2
    return to.apply("div", to.constants(1.0), result) if y < 0 else result


def _written_out(function: Callable[..., Any]) -> Callable[..., Any]:
    def applied(to: _Emitter, *variables: Any, **parameters: Any) -> Any:
        def apply(name: str, *values: Any) -> Any:
            return to.apply(name, *(to.nodes(np.asarray(value)) for value in values))

        return function(apply, *variables, **parameters)

    return applied


_RULES[horner.NAME] = _written_out(horner.written_out)
_RULES[spline.NAME] = _written_out(spline.written_out)


@_rule("square")
def _square(to: _Emitter, base: Any) -> Any:
    return to.apply("mul", base, base)


@_rule("rsqrt")
def _rsqrt(to: _Emitter, value: Any) -> Any:
    return to.apply("div", to.constants(1.0), to.apply("sqrt", value))


@_rule("logistic")
def _logistic(to: _Emitter, value: Any) -> Any:
    one = to.constants(1.0)
    return to.apply("div", one, to.apply("add", one, to.apply("exp", to.apply("neg", value))))


@_rule("lt_to")
def _before(to: _Emitter, one: Any, other: Any) -> Any:
    """Less in the order that sorting has: NaN comes last."""
    less, is_number = to.apply("lt", one, other), to.apply("eq", one, one)
    return to.apply("or", less, to.apply("and", is_number, to.apply("ne", other, other)))


def _logic(name: str) -> Callable[..., Any]:
    def applied(to: _Emitter, *inputs: Any) -> Any:
        if any(node.kind != "b" for array in inputs for node in array.ravel()):
            raise UnsupportedError(f'operation "{name}" is for truth values only, not for bits')
        return to.apply("ne" if name == "xor" else name, *inputs)

    return applied


for _name in ("and", "or", "xor", "not"):
    _RULES[_name] = _logic(_name)


@_rule("clamp")
def _clamp(to: _Emitter, low: Any, value: Any, high: Any) -> Any:
    return to.apply("min", to.apply("max", value, low), high)


@_rule("select_n")
def _select_n(to: _Emitter, which: Any, *cases: Any) -> Any:
    if len(cases) == 2:
        return to.map(lambda flag, no, yes: to.graph.choice(flag, yes, no), which, *cases)
    numbers = to.apply("number", which)
    return to.map(lambda place, *nodes: to.graph.element(list(nodes), place), numbers, *cases)


@_rule("convert_element_type")
def _convert(to: _Emitter, value: Any, *, new_dtype: str) -> Any:
    if new_dtype == "float32":
        raise UnsupportedError("float32: numbers are float64, whole or truth values")
    new = np.dtype(new_dtype).kind.replace("u", "i")

    def converted(node: Node) -> Node:
        if node.kind == new:
            return node
        if new == "b":
            return to.graph.operation("ne", node, to.graph.constant(0))
        if node.kind == "b":
            return to.graph.operation("number", node)
        return to.graph.operation("trunc", node) if new == "i" else to.graph.real(node)

    return to.map(converted, value)


# --- elements moved about ---


@_rule("broadcast_in_dim")
def _broadcast(_: _Emitter, value: Any, *, axes: list[int], new: list[int]) -> Any:
    return np.broadcast_to(np.expand_dims(value, tuple(axes)) if value.ndim else value, new)


@_rule("iota")
def _iota(to: _Emitter, *, dtype: str, shape: list[int], dimension: int) -> Any:
    return to.constants(np.indices(shape)[dimension].astype(dtype))


@_rule("dynamic_slice")
def _dynamic_slice(
    to: _Emitter, value: Any, *start: Any, sizes: list[int], shape: list[int]
) -> Any:
    begins = [
        to.within(one.item(), full - size)
        for one, full, size in zip(start, shape, sizes, strict=True)
    ]
    return to.window(to.filled(value, shape), begins, sizes)


@_rule("gather")
def _gather(to: _Emitter, value: Any, indices: Any, **given: Any) -> Any:
    """A window for each index vector; a place beyond the ends is moved in, or filled."""
    if given["operand_batching"] or given["index_batching"]:
        raise UnsupportedError('operation "gather" with batches of operands')
    value, indices = to.filled(value, given["shape"]), to.filled(indices, given["index_shape"])
    sizes, offsets, graph = given["sizes"], given["offset_dims"], to.graph
    kept = [axis for axis in range(value.ndim) if axis not in given["collapsed"]]
    windows = [sizes[axis] for axis in kept]
    found = np.empty([*indices.shape[:-1], *windows], object)
    for where in np.ndindex(*indices.shape[:-1]):
        start, inside = [graph.constant(0)] * value.ndim, graph.constant(True)
        for axis, index in zip(given["start_index_map"], indices[where], strict=True):
            start[axis] = to.within(index, value.shape[axis] - sizes[axis])
            same = graph.operation("eq", start[axis], index)
            inside = graph.operation("and", inside, same)
        window = to.window(value, start, sizes).reshape(windows)
        if given["mode"] == "fill":
            other = graph.constant(math.nan if given["fill"] is None else given["fill"])
            window = to.map(lambda node, i=inside, o=other: graph.choice(i, node, o), window)
        found[(*where, ...)] = window  # the dots: an array of no axes is one number, too
    batch = indices.ndim - 1
    return np.moveaxis(found, range(batch, batch + len(kept)), offsets) if kept else found


@_rule("dot_general")
def _dot_general(
    to: _Emitter, one: Any, other: Any, *, contracted: Any, batched: Any, shapes: Any
) -> Any:
    if any(batched):
        raise UnsupportedError(f'operation "dot_general" with batches, of shapes {shapes}')
    one, other = (to.filled(*pair) for pair in zip((one, other), shapes, strict=True))
    left, right = contracted
    rows = np.moveaxis(one, left, range(len(left)))
    columns = np.moveaxis(other, right, range(len(right)))
    free = rows.shape[len(left) :] + columns.shape[len(right) :]
    count = math.prod(rows.shape[: len(left)])
    rows, columns = rows.reshape(count, -1, 1), columns.reshape(count, 1, -1)
    products = [to.apply("mul", row, column) for row, column in zip(rows, columns, strict=True)]
    return reduce(lambda a, b: to.apply("add", a, b), products).reshape(free)


@_rule("cumsum")
def _cumsum(to: _Emitter, value: Any, *, axis: int, reverse: bool, shape: list[int]) -> Any:
    rows = np.moveaxis(to.filled(value, shape), axis, 0)
    order = rows[::-1] if reverse else rows
    found = np.stack([*itertools.accumulate(order[:, None], partial(to.apply, "add"))])[:, 0]
    return np.moveaxis(found[::-1] if reverse else found, 0, axis)


# --- loops and choices ---


def _cond(to: _Emitter, operation: Operation, inputs: Sequence[Any]) -> Any:
    """Every branch is computed, and one is chosen: nothing in them has a side effect."""
    branches = operation.blocks
    if any("while" in _names(branch) for branch in branches):
        raise UnsupportedError('operation "while" inside of "cond"')
    found = [to.run(branch) for branch in branches]
    place = to.within(to.apply("number", inputs[0]).item(), len(branches) - 1)
    return [
        to.map(lambda *nodes: to.graph.element(list(nodes), place), *results)
        for results in zip(*found, strict=True)
    ]


def _names(block: Block) -> set[str]:
    inner = [_names(part) for operation in block.operations for part in operation.blocks]
    return {operation.name for operation in block.operations}.union(*inner)


def _scan(to: _Emitter, operation: Operation, inputs: Sequence[Any]) -> Any:
    (body,), given = operation.blocks, operation.parameters
    length, carried = given["length"], given["carried"]
    if length > MOST_STEPS:
        raise UnsupportedError(f'operation "scan" of {length} steps: at most {MOST_STEPS}')
    state, columns = list(inputs[:carried]), inputs[carried:]
    outputs = []
    for step in range(length - 1, -1, -1) if given["reverse"] else range(length):
        rows = (column[step, ...] if column.ndim else column for column in columns)
        given_here = [*state, *rows]
        to.values.update(zip(body.arguments, given_here, strict=True))
        found = to.run(body)
        state = found[:carried]
        outputs.append(found[carried:])
    if given["reverse"]:
        outputs.reverse()
    return state + [np.stack(column) for column in zip(*outputs, strict=True)]


def _while(to: _Emitter, operation: Operation, inputs: Sequence[Any]) -> Any:
    condition, body = operation.blocks
    graph, outer = to.graph, to.scope
    loop = graph.loop([node for array in inputs for node in array.ravel()], outer)
    variables = _like(inputs, loop.variables)
    to.scope = loop.scope
    to.values.update(zip(condition.arguments, variables, strict=True))
    (goes_on,) = to.run(condition)
    to.values.update(zip(body.arguments, variables, strict=True))
    following = to.run(body)
    to.scope = outer
    if any(
        np.broadcast_shapes(array.shape, start.shape) != start.shape
        for array, start in zip(following, inputs, strict=True)
    ):
        raise UnsupportedError('operation "while" of an array that begins as one number')
    loop.condition = goes_on.item()
    loop.following = [
        node
        for array, start in zip(following, inputs, strict=True)
        for node in np.broadcast_to(array, start.shape).ravel()
    ]
    return _like(inputs, graph.results(loop, outer))


def _like(arrays: Sequence[Any], nodes: list[Node]) -> list[np.ndarray]:
    """The nodes in arrays of the same shapes."""
    rest, found = iter(nodes), []
    for array in arrays:
        filled = np.empty(array.shape, object)
        filled.ravel()[:] = list(itertools.islice(rest, array.size))
        found.append(filled)
    return found


_BLOCKS: dict[str, Callable[[_Emitter, Operation, Sequence[Any]], Any]] = {
    "cond": _cond,
    "scan": _scan,
    "while": _while,
}
