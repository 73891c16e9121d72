"""What each operation of a program is in NumPy.

A value that does not vary along an axis need not fill it: it may have one element there, or no axes
at all. What must see the whole of an array is given its shape and fills it.
"""

import itertools
import math
import operator
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from lightflyer.program import horner, spline
from lightflyer.program.indexing import (
    Lengths,
    dynamic_slice,
    dynamic_update_slice,
    fill_axes,
    gather,
    scatter,
    shape_of,
)
from lightflyer.program.program import Length, Operation, length_of


class UnsupportedError(NotImplementedError):
    """A program has an operation that a backend lacks; the message names it."""


def evaluate(operation: Operation, inputs: Sequence[Any]) -> list[Any]:
    """Outputs of one operation whose lengths are all numbers."""
    with np.errstate(all="ignore"):
        found = function_of(operation)({}, *inputs)
    return list(found) if len(operation.outputs) > 1 else [found]


# --- element by element ---


def _divide(one: Any, other: Any) -> Any:
    if one.dtype.kind in "iu":
        return np.trunc(one / other).astype(one.dtype)
    return one / other


def _select(which: Any, *cases: Any) -> Any:
    if which.ndim == 0:
        return cases[int(which)]
    if len(cases) == 2:
        return np.where(which, cases[1], cases[0])
    return np.choose(which, cases)


def _before(one: Any, other: Any) -> Any:
    """Less in the order that sorting has: NaN comes last."""
    return (one < other) | ((one == one) & (other != other))


def _before_or_same(one: Any, other: Any) -> Any:
    return (one <= other) | (other != other)


def _sigmoid(value: Any) -> Any:
    return 1.0 / (1.0 + np.exp(-value))


def _special(name: str) -> Callable[..., Any]:
    """A function of SciPy, which is imported when it is called."""

    def function(*values: Any) -> Any:
        import scipy.special

        return getattr(scipy.special, name)(*values)

    return function


def _of_python(function: Callable[[float], float]) -> Callable[[Any], Any]:
    """A function of single numbers for arrays: SciPy takes longer to import than this to run."""
    each = np.frompyfunc(function, 1, 1)

    def of_array(value: Any) -> Any:
        return np.asarray(each(value), np.float64)[()]

    return of_array


# NumPy's functions take ten times as long on single numbers as Python's operators do
ELEMENTWISE: dict[str, Callable[..., Any]] = {
    "abs": np.abs,
    "acos": np.arccos,
    "acosh": np.arccosh,
    "add": operator.add,
    "and": operator.and_,
    "asin": np.arcsin,
    "asinh": np.arcsinh,
    "atan": np.arctan,
    "atan2": np.arctan2,
    "atanh": np.arctanh,
    "cbrt": np.cbrt,
    "ceil": np.ceil,
    "clamp": lambda low, value, high: np.minimum(np.maximum(value, low), high),
    "cos": np.cos,
    "cosh": np.cosh,
    "div": _divide,
    "eq": operator.eq,
    "erf": _of_python(math.erf),
    "erf_inv": _special("erfinv"),
    "erfc": _of_python(math.erfc),
    "exp": np.exp,
    "exp2": np.exp2,
    "expm1": np.expm1,
    "floor": np.floor,
    "ge": operator.ge,
    "gt": operator.gt,
    "is_finite": np.isfinite,
    "le": operator.le,
    "le_to": _before_or_same,
    "lgamma": _special("gammaln"),
    "log": np.log,
    "log1p": np.log1p,
    "logistic": _sigmoid,
    "lt": operator.lt,
    "lt_to": _before,
    "max": np.maximum,
    "min": np.minimum,
    "mul": operator.mul,
    "ne": operator.ne,
    "neg": operator.neg,
    "nextafter": np.nextafter,
    "not": np.bitwise_not,
    "or": operator.or_,
    "pow": np.power,
    "rem": np.fmod,
    "round": np.rint,
    "rsqrt": lambda value: 1.0 / np.sqrt(value),
    "select_n": _select,
    "sign": np.sign,
    "sin": np.sin,
    "sinh": np.sinh,
    "sqrt": np.sqrt,
    "square": np.square,
    "sub": operator.sub,
    "tan": np.tan,
    "tanh": np.tanh,
    "xor": operator.xor,
}
"""Operations on each element by itself, without parameters."""

SINGLE = {*ELEMENTWISE, "convert_element_type", "integer_pow", horner.NAME, spline.NAME}
"""Operations that make a value without axes of such values, element by element."""

RULES: dict[str, Callable[..., Any]] = {}
"""Functions of lengths, inputs and an operation's parameters, by the operation's name."""


def _tuples(value: Any) -> Any:
    """Tuples, which can be hashed, for the lists that a kept program has."""
    return tuple(map(_tuples, value)) if isinstance(value, list | tuple) else value


_MADE: dict[str, Callable[[Operation], Callable[..., Any]]] = {
    horner.NAME: lambda operation: horner.evaluator(
        _tuples(operation.parameters["coefficients"]), len(operation.inputs)
    ),
    spline.NAME: lambda operation: spline.evaluator(
        spline.Sums(*_tuples(operation.parameters["sums"]))
    ),
}
"""What makes a function of the inputs alone, once for all calls."""


def is_known(name: str) -> bool:
    """Whether NumPy runs an operation, which is neither a loop nor a choice."""
    return name in ELEMENTWISE or name in RULES or name in _MADE


def function_of(operation: Operation) -> Callable[..., Any]:
    """A function of the lengths and the inputs."""
    name = operation.name
    if name in ELEMENTWISE:
        plain = ELEMENTWISE[name]
        return lambda _, *inputs: plain(*inputs)
    if name in _MADE:
        made = _MADE[name](operation)
        return lambda _, *inputs: made(*inputs)
    if not is_known(name):
        raise UnsupportedError(f'operation "{name}" is not among those that NumPy runs')
    return partial(RULES[name], **operation.parameters)


def _rule(*names: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    def keep(function: Callable[..., Any]) -> Callable[..., Any]:
        RULES.update(dict.fromkeys(names, function))
        return function

    return keep


@_rule("integer_pow")
def _integer_pow(_: Lengths, base: Any, *, y: int) -> Any:
    result, square, left = None, base, abs(y)
    while left:
        if left % 2:
            result = square if result is None else result * square
        left //= 2
        square = square * square if left else square
    if result is None:
        return np.ones_like(base)
    return 1.0 / result if y < 0 else result


@_rule("convert_element_type")
def _convert(_: Lengths, value: Any, *, new_dtype: str) -> Any:
    return np.asarray(value).astype(new_dtype)[()]


# --- elements moved about ---


@_rule("broadcast_in_dim")
def _broadcast(_: Lengths, value: Any, *, axes: list[int], new: list[Length]) -> Any:  # noqa: ARG001
    """A value with axes where it has none yet, of one element: they need not be filled."""
    return np.expand_dims(value, tuple(axes)) if value.ndim else value


@_rule("squeeze")
def _squeeze(_: Lengths, value: Any, *, dimensions: list[int]) -> Any:
    return np.squeeze(value, tuple(dimensions)) if value.ndim else value


@_rule("reshape")
def _reshape(lengths: Lengths, value: Any, *, shape: list[Length], new: list[Length]) -> Any:
    if np.size(value) == 1:
        return np.reshape(value, (1,) * len(new))
    return np.reshape(fill_axes(value, shape, lengths), shape_of(new, lengths))


@_rule("transpose")
def _transpose(_: Lengths, value: Any, *, permutation: list[int]) -> Any:
    return np.transpose(value, permutation) if np.ndim(value) else value


@_rule("rev")
def _reverse(_: Lengths, value: Any, *, dimensions: list[int]) -> Any:
    return np.flip(value, tuple(dimensions)) if np.ndim(value) else value


@_rule("slice")
def _slice(
    lengths: Lengths,
    value: Any,
    *,
    start: list[Length],
    stop: list[Length],
    steps: list[int] | None,
) -> Any:
    if np.ndim(value) == 0:
        return value
    parts = zip(shape_of(start, lengths), shape_of(stop, lengths), steps or [1] * len(start),
                strict=True)  # fmt: skip
    return value[
        tuple(
            slice(None) if length == 1 and part[1] > part[0] else slice(*part)
            for length, part in zip(value.shape, parts, strict=True)
        )
    ]


@_rule("concatenate")
def _concatenate(lengths: Lengths, *values: Any, dimension: int, shapes: list[list[Length]]) -> Any:
    return np.concatenate(
        [fill_axes(value, shape, lengths) for value, shape in zip(values, shapes, strict=True)],
        dimension,
    )


@_rule("stack")
def _stack(lengths: Lengths, *values: Any, shape: list[Length], axis: int) -> Any:
    return np.stack([fill_axes(value, shape, lengths) for value in values], axis)


@_rule("unstack")
def _unstack(lengths: Lengths, value: Any, *, shape: list[Length], axis: int) -> Any:
    rows = np.moveaxis(fill_axes(value, shape, lengths), axis, 0)
    parts = [rows[number, ...] for number in range(len(rows))]  # arrays, also of single objects
    return parts if len(parts) > 1 else parts[0]


@_rule("split")
def _split(
    lengths: Lengths, value: Any, *, sizes: list[Length], axis: int, shape: list[Length]
) -> Any:
    ends = list(itertools.accumulate(shape_of(sizes, lengths)))[:-1]
    parts = np.split(fill_axes(value, shape, lengths), ends, axis)
    return parts if len(parts) > 1 else parts[0]


@_rule("pad")
def _pad(
    lengths: Lengths, value: Any, filling: Any, *, config: list[list[int]], shape: list[Length]
) -> Any:
    full = fill_axes(value, shape, lengths)
    inner = [length + (length - 1) * gap for length, (_, _, gap) in zip(full.shape, config,
             strict=True)]  # fmt: skip
    whole = np.full(
        [length + max(low, 0) + max(high, 0) for length, (low, high, _) in zip(inner, config,
         strict=True)], filling, full.dtype)  # fmt: skip
    whole[
        tuple(
            slice(max(low, 0), max(low, 0) + length, gap + 1)
            for length, (low, _, gap) in zip(inner, config, strict=True)
        )
    ] = full
    cut = (
        slice(max(-low, 0), size - max(-high, 0))
        for size, (low, high, _) in zip(whole.shape, config, strict=True)
    )
    return whole[tuple(cut)]


@_rule("iota")
def _iota(lengths: Lengths, *, dtype: str, shape: list[Length], dimension: int) -> Any:
    count = length_of(shape[dimension], lengths)
    sizes = [1] * len(shape)
    sizes[dimension] = count
    return np.arange(count, dtype=dtype).reshape(sizes)


@_rule("dim_as_value")
def _dim_as_value(lengths: Lengths, *, dim: Length, dtype: str) -> Any:
    return np.dtype(dtype).type(length_of(dim, lengths))


RULES |= {
    "dynamic_slice": dynamic_slice,
    "dynamic_update_slice": dynamic_update_slice,
    "gather": gather,
    "scatter": scatter,
    "scatter_add": scatter,
}


# --- many elements to one ---


def _whole_reduction(reduce: Callable[..., Any]) -> Callable[..., Any]:
    def reduced(lengths: Lengths, value: Any, *, axes: list[int], shape: list[Length]) -> Any:
        full = fill_axes(value, shape, lengths)
        return reduce(full, axis=tuple(axes), dtype=full.dtype)

    return reduced


def _idempotent_reduction(reduce: Callable[..., Any]) -> Callable[..., Any]:
    def reduced(_: Lengths, value: Any, *, axes: list[int]) -> Any:
        return reduce(value, axis=tuple(axes)) if value.ndim else value

    return reduced


RULES["reduce_sum"] = _whole_reduction(np.sum)
RULES["reduce_prod"] = _whole_reduction(np.prod)
_REDUCTIONS: dict[str, Any] = {"max": np.max, "min": np.min, "and": np.all, "or": np.any}
for _name, _reduce in _REDUCTIONS.items():
    RULES[f"reduce_{_name}"] = _idempotent_reduction(_reduce)


def _accumulation(accumulate: Callable[..., Any]) -> Callable[..., Any]:
    def accumulated(
        lengths: Lengths, value: Any, *, axis: int, reverse: bool, shape: list[Length]
    ) -> Any:
        full = fill_axes(value, shape, lengths)
        full = np.flip(full, axis) if reverse else full
        found = accumulate(full, axis=axis, dtype=full.dtype)
        return np.flip(found, axis) if reverse else found

    return accumulated


for _name, _function in {
    "cumsum": np.add.accumulate,
    "cumprod": np.multiply.accumulate,
    "cummax": np.maximum.accumulate,
    "cummin": np.minimum.accumulate,
}.items():
    RULES[_name] = _accumulation(_function)


def _search(find: Callable[..., Any]) -> Callable[..., Any]:
    def found(
        lengths: Lengths, value: Any, *, axes: list[int], index_dtype: str, shape: list[Length]
    ) -> Any:
        (axis,) = axes
        return find(fill_axes(value, shape, lengths), axis=axis).astype(index_dtype)

    return found


RULES["argmax"], RULES["argmin"] = _search(np.argmax), _search(np.argmin)


@_rule("sort")
def _sort(
    lengths: Lengths, *values: Any, dimension: int, num_keys: int, shape: list[Length]
) -> Any:
    full = [fill_axes(value, shape, lengths) for value in values]
    if len(full) == 1:
        return np.sort(full[0], axis=dimension, kind="stable")
    if num_keys != 1:
        raise UnsupportedError('operation "sort" by several keys')
    order = np.argsort(full[0], axis=dimension, kind="stable")
    return [np.take_along_axis(part, order, dimension) for part in full]


@_rule("dot_general")
def _dot_general(
    lengths: Lengths,
    one: Any,
    other: Any,
    *,
    contracted: list[list[int]],
    batched: list[list[int]],
    shapes: list[list[Length]],
) -> Any:
    left, right = (
        fill_axes(value, shape, lengths) for value, shape in zip((one, other), shapes, strict=True)
    )
    names = itertools.count()
    of_left = [next(names) for _ in range(left.ndim)]
    of_right = [next(names) for _ in range(right.ndim)]
    for a, b in zip(contracted[0] + batched[0], contracted[1] + batched[1], strict=True):
        of_right[b] = of_left[a]
    shared = [of_left[axis] for axis in batched[0]]
    summed = {of_left[axis] for axis in contracted[0]} | set(shared)
    free = [name for name in of_left + of_right if name not in summed]
    return np.einsum(left, of_left, right, of_right, shared + free)
