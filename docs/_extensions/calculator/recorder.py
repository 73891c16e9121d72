"""A recorder of numbers: a model that is called with its numbers leaves what it computes.

It has the interface of JAX that :mod:`lightflyer.array` uses, so that within
``within(jax=Recorder())`` public functions record. An array is a NumPy array of nodes: what moves
elements about costs nothing, and every other operation is one on each element. Numbers that are
known stay NumPy's. An operation that is not here is refused by its name.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial, partialmethod, reduce
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from lightflyer.array import tree

from .graph import OPERATIONS, Graph, Node, UnsupportedError, in_order

_MOST_STEPS = 256  # up to which a loop of a known number of steps is written out


class NotKnownError(TypeError):
    """What is asked for depends on numbers that are not known yet."""


class Table(np.ndarray):
    """Numbers that are known; the places where they are looked up need not be."""

    def __getitem__(self, index: Any) -> Any:
        parts = index if isinstance(index, tuple) else (index,)
        recorded = [part for part in parts if isinstance(part, Recorded)]
        return _look_up(self, parts, recorded[0].of) if recorded else super().__getitem__(index)


class Recorded:
    """An array of numbers that are not known yet."""

    __slots__ = ("nodes", "of")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, of: "Recorder", nodes: Any):
        self.of, self.nodes = of, nodes
        if isinstance(nodes, Node):  # NumPy takes it out of an array without axes
            self.nodes = np.empty((), object)
            self.nodes[()] = nodes

    def __array_namespace__(self, api_version: str | None = None) -> Any:
        del api_version
        return self.of.numpy

    def __array_ufunc__(self, function: Any, method: str, *args: Any, **options: Any) -> Any:
        if method != "__call__" or options:
            raise UnsupportedError(f'"{function.__name__}" into an array of numbers that are known')
        return getattr(self.of.numpy, function.__name__)(*args)

    shape = property(lambda self: self.nodes.shape)
    ndim = property(lambda self: self.nodes.ndim)
    size = property(lambda self: self.nodes.size)

    @property
    def dtype(self) -> np.dtype:
        kinds = {node.kind for node in self.nodes.flat}
        return np.dtype(float if "f" in kinds else int if "i" in kinds else bool)

    def astype(self, dtype: Any, **_: Any) -> Any:
        return self.of.numpy.astype(self, dtype)

    def reshape(self, *shape: Any) -> "Recorded":
        return Recorded(self.of, self.nodes.reshape(*shape))

    def __getitem__(self, index: Any) -> Any:
        parts = index if isinstance(index, tuple) else (index,)
        if any(isinstance(part, Recorded) for part in parts):
            return _look_up(self.nodes, parts, self.of)
        return Recorded(self.of, self.nodes[index])

    def __iter__(self) -> Iterator[Any]:
        if not self.ndim:
            raise TypeError("a number is not iterable")
        return (self[place] for place in range(self.shape[0]))

    def _not_known(self, *_: Any, **__: Any) -> Any:
        raise NotKnownError("this depends on numbers that are not known yet")

    __array__ = __bool__ = __float__ = __int__ = __index__ = _not_known


def _method(name: str, *, swapped: bool = False) -> Callable[..., Any]:
    def method(one: Recorded, *others: Any, **options: Any) -> Any:
        pair = (*others, one) if swapped else (one, *others)
        return getattr(one.of.numpy, name)(*pair, **options)

    return method


_SIGNS = {"add": "add", "sub": "subtract", "mul": "multiply", "truediv": "divide", "mod": "mod",
          "pow": "power", "and": "logical_and", "or": "logical_or", "xor": "logical_xor",
          "lt": "less", "le": "less_equal", "gt": "greater", "ge": "greater_equal", "eq": "equal",
          "ne": "not_equal", "neg": "negative", "abs": "abs", "invert": "logical_not"}  # fmt: skip
for _sign, _name in _SIGNS.items():
    setattr(Recorded, f"__{_sign}__", _method(_name))
    setattr(Recorded, f"__r{_sign}__", _method(_name, swapped=True))
for _name in ("sum", "prod", "max", "min", "any", "all"):
    setattr(Recorded, _name, _method(_name))


def _look_up(array: np.ndarray, index: Sequence[Any], of: "Recorder") -> Any:
    """Elements of numbers or nodes at places that are not known, but within range."""
    at = next(number for number, part in enumerate(index) if isinstance(part, Recorded))
    place = index[at]
    if place.dtype.kind != "i":
        raise UnsupportedError("a place that is no whole number")
    if sum(isinstance(part, Recorded) for part in index) > 1:  # then all of the array's axes
        place = 0
        for part, size in zip(index, array.shape, strict=True):
            place = place * size + part
        return _look_up(array.ravel(), (place,), of)
    whole = np.asarray(array)[(*index[:at], slice(None), *index[at + 1 :])]
    axis = sum(part is None or isinstance(part, slice) for part in index[:at])
    rows, places = np.moveaxis(whole, axis, -1), place.nodes
    look = of.graph.element if array.dtype == object else of.graph.look_up
    tables = [tuple(rows[row].tolist()) for row in np.ndindex(rows.shape[:-1])]
    nodes = (look(table, node) for table in tables for node in places.flat)
    found = _filled((*rows.shape[:-1], *places.shape), nodes)
    count = places.ndim
    return Recorded(of, np.moveaxis(found, range(-count, 0), range(axis, axis + count)))


def _filled(shape: Sequence[int], nodes: Iterator[Node]) -> np.ndarray:
    found = np.empty(shape, object)
    found.ravel()[...] = list(itertools.islice(nodes, found.size))
    return found


class Recorder:
    """Stands in the place of JAX while a model is recorded."""

    def __init__(self) -> None:
        self.graph, self.numpy = Graph(), _Numpy(self)
        self.core = SimpleNamespace(Tracer=Recorded)
        self.scipy = SimpleNamespace(special=self.numpy)
        self.lax = SimpleNamespace(
            while_loop=self._while_loop, cond=self._cond, scan=self._scan,
            stop_gradient=lambda value: value,
            # the derivative of a root is asked for by nobody
            custom_root=lambda function, guess, solve, *_, **__: solve(function, guess),
        )  # fmt: skip

    def variable(self) -> Recorded:
        """A number that a caller will give."""
        return Recorded(self, self.graph.variable())

    def nodes(self, value: Any) -> np.ndarray:
        """The nodes of a number or array, known or not."""
        if isinstance(value, Recorded):
            return value.nodes
        if isinstance(value, list | tuple):
            return np.stack(np.broadcast_arrays(*map(self.nodes, value)))
        array = np.asarray(value)
        if array.dtype.kind not in "biuf":
            raise UnsupportedError(f"an array of {array.dtype}")
        return _filled(array.shape, map(self.graph.constant, array.ravel().tolist()))

    # --- functions of JAX ---

    def jvp(
        self, function: Callable[..., Any], point: tuple[Any], direction: tuple[Any]
    ) -> tuple[Any, Any]:
        """What a function of one number gives, and how that changes in a direction."""
        own = self.variable()
        leaves, form = tree.flatten(function(own))
        ends = [self.nodes(leaf) for leaf in leaves]
        nodes = [node for array in ends for node in array.flat]
        there, along = (self.nodes(one).item() for (one,) in (point, direction))
        variable = own.nodes.item()
        found = self.graph.replace(nodes + self._slopes(nodes, variable), variable, there)
        moved = (self.graph.apply("mul", one, along) for one in found[len(nodes) :])
        value, change = (
            tree.unflatten(form, [Recorded(self, _filled(array.shape, flat)) for array in ends])
            for flat in (iter(found), moved)
        )
        return value, change

    def _slopes(self, nodes: list[Node], variable: Node) -> list[Node]:
        """Derivatives of nodes in a variable."""
        found: dict[Node, Any] = {variable: 1.0}
        for node in in_order(nodes):
            if node.operation == "result" and variable in in_order([node], in_loops=True):
                raise UnsupportedError("the derivative of a loop")
            parts = [found.get(one) for one in node.operands]
            if node.operation in _LEVEL or all(part is None for part in parts[-2:]):
                continue
            value, *operands = (Recorded(self, one) for one in (node, *node.operands))
            found[node] = _slope(self.numpy, node.operation, value, operands, parts)
        return [self.nodes(found.get(node, 0.0)).item() for node in nodes]

    def eval_shape(self, function: Callable[..., Any], *args: Any) -> Any:
        """What a function gives where no loop takes a step: of its shapes, which alone are used."""
        loop, self.lax.while_loop = self.lax.while_loop, lambda _goes_on, _body, state: state
        try:
            return function(*args)
        finally:
            self.lax.while_loop = loop

    def _while_loop(
        self, goes_on: Callable[[Any], Any], body: Callable[[Any], Any], state: Any
    ) -> Any:
        leaves, form = tree.flatten(state)
        varies = [True] * len(leaves)

        def arrays(nodes: list[Node]) -> list[Any]:
            rest = iter(nodes)
            own = iter([Recorded(self, _filled(array.shape, rest)) for array in starts])
            return [next(own) if one else leaf for leaf, one in zip(leaves, varies, strict=True)]

        while True:
            starts = [*map(self.nodes, itertools.compress(leaves, varies))]
            loop = self.graph.loop([node for array in starts for node in array.flat])
            given = arrays(loop.variables)
            loop.condition = self.nodes(goes_on(tree.unflatten(form, given))).item()
            loop.tested = self.graph.last
            found = [self.nodes(leaf) for leaf in tree.leaves(body(tree.unflatten(form, given)))]
            # what the body leaves as it is, is no variable: again without it
            moved = [
                one and not np.array_equal(new, old.nodes)
                for new, old, one in zip(found, given, varies, strict=True)
            ]
            if moved == varies:
                break
            self.graph.scope, varies = loop.outer, moved
        for array, new in zip(starts, itertools.compress(found, varies), strict=True):
            loop.following += np.broadcast_to(new, array.shape).flat
        return tree.unflatten(form, arrays(self.graph.end(loop)))

    def _cond(self, choice: Any, one: Callable[..., Any], other: Callable[..., Any]) -> Any:
        """Both branches are computed, and one is chosen: nothing in them has a side effect."""
        if not isinstance(choice, Recorded):
            return one() if choice else other()
        return tree.map_leaves(partial(self.numpy.where, choice), one(), other())

    def _scan(
        self, step: Callable[..., Any], state: Any, rows: Any, length: int = 0
    ) -> tuple[Any, Any]:
        length = length or tree.leaves(rows)[0].shape[0]
        if length > _MOST_STEPS:
            raise UnsupportedError(f"a loop of {length} steps, more than {_MOST_STEPS},")
        found = []
        for place in range(length):
            row = tree.map_leaves(lambda leaf, place=place: leaf[place], rows)
            state, one = step(state, row)
            found.append(one)
        return state, tree.map_leaves(lambda *parts: self.numpy.stack(parts), *found)


_SLOPES: dict[str, tuple[Callable[[Any], Any], ...]] = {
    "neg": (lambda _: -1.0,),
    "abs": (lambda at: at.np.sign(at.a),),
    "sqrt": (lambda at: 0.5 / at.y,),
    "exp": (lambda at: at.y,),
    "expm1": (lambda at: at.y + 1.0,),
    "log": (lambda at: 1.0 / at.a,),
    "log1p": (lambda at: 1.0 / (1.0 + at.a),),
    "sin": (lambda at: at.np.cos(at.a),),
    "cos": (lambda at: -at.np.sin(at.a),),
    "sinh": (lambda at: at.np.cosh(at.a),),
    "cosh": (lambda at: at.np.sinh(at.a),),
    "add": (lambda _: 1.0, lambda _: 1.0),
    "sub": (lambda _: 1.0, lambda _: -1.0),
    "mul": (lambda at: at.b, lambda at: at.a),
    "div": (lambda at: 1.0 / at.b, lambda at: -at.y / at.b),
    "pow": (lambda at: at.b * at.a ** (at.b - 1.0), lambda at: at.y * at.np.log(at.a)),
}
"""Derivatives of what an operation gives, y, in each operand, a and b."""

_LEVEL = {"lt", "le", "gt", "ge", "eq", "ne", "and", "or", "not", "is_finite", "number", "floor",
          "ceil", "trunc", "sign", "search", "table"}  # fmt: skip


def _slope(numpy: Any, name: str, value: Any, operands: list[Any], parts: list[Any]) -> Any:
    """Derivative of an operation; ``parts``: those of its operands, None for none."""
    if name in ("choice", "max", "min"):
        *condition, a, b = operands
        first = condition[0] if condition else a >= b if name == "max" else a <= b
        return numpy.where(first, *(0.0 if part is None else part for part in parts[-2:]))
    if name not in _SLOPES:
        raise UnsupportedError(f'the derivative of "{name}"')
    at = SimpleNamespace(np=numpy, y=value, a=operands[0], b=operands[-1])
    terms = (
        rule(at) * part for rule, part in zip(_SLOPES[name], parts, strict=True) if part is not None
    )
    return reduce(lambda one, other: one + other, terms)


# --- functions of NumPy ---

_ELEMENTWISE = {
    **{own.__name__: name for name, own in OPERATIONS.items() if isinstance(own, np.ufunc)},
    "abs": "abs", "where": "choice", "bitwise_and": "and", "bitwise_or": "or", "invert": "not",
    "bitwise_xor": "xor",
}  # fmt: skip
del _ELEMENTWISE["power"]  # a known power is written out
_MOVES = {"broadcast_to", "reshape", "ravel", "transpose", "moveaxis", "swapaxes", "expand_dims",
          "squeeze", "flip", "roll", "repeat", "concatenate", "stack", "atleast_1d"}  # fmt: skip
_OF_SHAPES = {"shape", "ndim", "size", "broadcast_shapes"}
_REDUCTIONS = {"sum": "add", "prod": "mul", "max": "max", "min": "min", "any": "or", "all": "and"}


class _Numpy:
    """Functions of NumPy's names, and SciPy's; of numbers that are known they are NumPy's own."""

    def __init__(self, of: Recorder):
        self._of = of

    def __getattr__(self, name: str) -> Any:
        own = getattr(np, name, None)
        if name.startswith("_"):
            raise AttributeError(name)
        if isinstance(own, ModuleType):
            raise UnsupportedError(f'"{name}"')
        if isinstance(own, type) or not (own is None or callable(own)) or name in _OF_SHAPES:
            return own
        if name in _ELEMENTWISE:
            recorded: Any = partial(self._apply, _ELEMENTWISE[name])
        elif name in _MOVES:
            recorded = partial(self._move, own)
        elif name in _REDUCTIONS:
            recorded = partial(self._reduce, _REDUCTIONS[name])
        else:
            recorded = getattr(self, f"_{name}", None)

        def function(*args: Any, **options: Any) -> Any:
            # most arguments are numbers, in no list
            known = not any(isinstance(one, Recorded) for one in args) and not any(
                isinstance(leaf, Recorded) for leaf in tree.leaves((args, options))
            )
            if own is not None and known:
                with np.errstate(all="ignore"):
                    found = own(*args, **options)
                return found.view(Table) if isinstance(found, np.ndarray) else found
            if recorded is None:
                raise UnsupportedError(f'"{name}"')
            return recorded(*args, **options)

        vars(self)[name] = function
        return function

    def _each(self, function: Callable[..., Node], *arrays: Any) -> Recorded:
        parts = [*map(self._of.nodes, arrays)]
        if not any(part.ndim for part in parts):  # most are numbers
            return Recorded(self._of, function(*(part.item() for part in parts)))
        parts = np.broadcast_arrays(*parts)
        return Recorded(self._of, _filled(parts[0].shape, map(function, *(x.flat for x in parts))))

    def _apply(self, name: str, *arrays: Any) -> Recorded:
        if name in ("and", "or", "xor", "not") and any(
            node.kind != "b" for array in arrays for node in self._of.nodes(array).flat
        ):
            raise UnsupportedError(f'"{name}" of bits, in place of truth values,')
        return self._each(partial(self._of.graph.apply, name), *arrays)

    def _move(self, own: Callable[..., Any], arrays: Any, *args: Any, **options: Any) -> Recorded:
        several = isinstance(arrays, list | tuple)
        nodes = [*map(self._of.nodes, arrays)] if several else self._of.nodes(arrays)
        return Recorded(self._of, own(nodes, *args, **options))

    def _reduce(self, name: str, array: Any, axis: Any = None, **_: Any) -> Recorded:
        nodes = self._of.nodes(array)
        axes = [*range(nodes.ndim)] if axis is None else [*np.ravel(axis)]
        rows = np.moveaxis(nodes, axes, range(len(axes)))
        rows = rows.reshape(-1, *rows.shape[len(axes) :])
        return reduce(partial(self._apply, name), [Recorded(self._of, row) for row in rows])

    # --- of numbers that are not known ---

    def asarray(self, array: Any, dtype: Any = None) -> Any:
        if any(isinstance(leaf, Recorded) for leaf in tree.leaves(array)):
            found = Recorded(self._of, self._of.nodes(array))
            return found if dtype is None else self.astype(found, dtype)
        return np.asarray(array, dtype).view(Table)

    def astype(self, array: Any, dtype: Any) -> Recorded:
        kind, graph = np.dtype(dtype).kind, self._of.graph
        if kind == "b":
            return self._apply("ne", array, 0)
        if kind not in "iuf":
            raise UnsupportedError(f"a number of {np.dtype(dtype)}")

        def convert(node: Node) -> Node:
            number = graph.real(node)
            return graph.apply("trunc", number) if kind != "f" and number.kind == "f" else number

        return self._each(convert, array)

    def _isnan(self, array: Any) -> Recorded:
        return self._apply("ne", array, array)

    def _clip(self, array: Any, low: Any = None, high: Any = None) -> Any:
        array = array if low is None else self.maximum(array, low)
        return array if high is None else self.minimum(array, high)

    def _mod(self, one: Any, other: Any) -> Any:
        rest = self._apply("rem", one, other)
        return self.where(rest * other < 0, rest + other, rest)

    _remainder = _mod

    def _power(self, base: Any, exponent: Any) -> Any:
        power = None if isinstance(exponent, Recorded) or np.ndim(exponent) else float(exponent)
        if power is None or abs(power) > 16.0 or power % 0.5:
            return self._apply("pow", base, exponent)
        left, square = int(abs(power)), base
        result: Any = self.sqrt(base) if power % 1.0 else self.ones_like(base)
        while left:
            result = result * square if left % 2 else result
            square, left = square * square, left // 2
        return 1.0 / result if power < 0.0 else result

    def _full(self, shape: Any, value: Any, dtype: Any = None) -> Any:
        return self.broadcast_to(value if dtype is None else value.astype(dtype), shape)

    def _full_like(self, array: Any, value: Any = None, dtype: Any = None) -> Any:
        return self.full(np.shape(array), value, dtype or self.asarray(array).dtype)

    _zeros_like = partialmethod(_full_like, value=0)
    _ones_like = partialmethod(_full_like, value=1)

    def _broadcast_arrays(self, *arrays: Any) -> tuple[Any, ...]:
        shape = np.broadcast_shapes(*map(np.shape, arrays))
        return tuple(self.broadcast_to(array, shape) for array in arrays)

    def _cumsum(self, array: Any, axis: int = 0) -> Recorded:
        return self.stack([*itertools.accumulate(self.moveaxis(array, axis, 0))], axis=axis)

    def _searchsorted(self, table: Any, values: Any, side: str = "left") -> Recorded:
        if isinstance(table, Recorded):
            before = self.less if side == "left" else self.less_equal
            return self.sum(before(table, self.asarray(values)[..., None]), axis=-1)
        known = tuple(np.asarray(table).tolist()), side
        return self._each(partial(self._of.graph.search, known), values)

    def _interp(self, value: Any, points: Any, values: Any) -> Any:
        points, values = self.asarray(points), self.asarray(values)
        inside = self.clip(value, points[0], points[-1])
        piece = self.clip(self.searchsorted(points, inside, side="right") - 1, 0, points.size - 2)
        left, low = points[piece], values[piece]
        return low + (inside - left) / (points[piece + 1] - left) * (values[piece + 1] - low)

    def _xlogy(self, x: Any, y: Any) -> Any:
        dark = self.logical_and(self.equal(x, 0.0), self.equal(y, y))
        return self.where(dark, 0.0, x * self.log(self.where(dark, 1.0, y)))
