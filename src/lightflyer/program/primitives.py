"""Parameters of JAX's primitives as plain data."""

from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import Any

import numpy as np

from lightflyer.program import horner, spline
from lightflyer.program.program import Length
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import jax


def length(given: Any) -> Length:
    """A length of JAX's, which may be symbolic, as a program has it."""
    return int(given) if isinstance(given, int | np.integer) else _text(given)


@cache
def _text(symbolic: Any) -> str:
    """A symbolic length as JAX writes it, which takes long."""
    return str(symbolic)


def lengths_of(shape: Sequence[Any]) -> tuple[Length, ...]:
    """All lengths of a shape."""
    return tuple(map(length, shape))


def is_concrete(parameters: Any) -> bool:
    """Whether no length in parameters is a symbol."""
    symbolic = ("shape", "shapes", "new", "start", "stop", "sizes", "index_shape", "update_shape")
    flat = tree.leaves([parameters[key] for key in symbolic if key in parameters])
    return "dim" not in parameters and not any(isinstance(leaf, str) for leaf in flat)


def _shape_of(equation: Any, place: int = 0) -> list[Length]:
    return list(lengths_of(equation.invars[place].aval.shape))


def _shapes_of(equation: Any) -> list[list[Length]]:
    return [_shape_of(equation, place) for place in range(len(equation.invars))]


def _broadcast(equation: Any) -> dict[str, Any]:
    shape, taken = equation.params["shape"], equation.params["broadcast_dimensions"]
    return {
        "axes": [at for at in range(len(shape)) if at not in taken],
        "new": list(lengths_of(shape)),
    }


def _slice(equation: Any) -> dict[str, Any]:
    given = equation.params
    steps = given["strides"]
    return {
        "start": list(lengths_of(given["start_indices"])),
        "stop": list(lengths_of(given["limit_indices"])),
        "steps": None if steps is None else list(map(int, steps)),
    }


def _reshape(equation: Any) -> dict[str, Any]:
    new = list(lengths_of(equation.outvars[0].aval.shape))
    return {"shape": _shape_of(equation), "new": new}


def _gather(equation: Any) -> dict[str, Any]:
    given = equation.params
    numbers = given["dimension_numbers"]
    filling = given["mode"] == jax.lax.GatherScatterMode.FILL_OR_DROP
    fill = given["fill_value"]
    return {
        "shape": _shape_of(equation),
        "index_shape": _shape_of(equation, 1),
        "offset_dims": list(numbers.offset_dims),
        "start_index_map": list(numbers.start_index_map),
        "collapsed": list(numbers.collapsed_slice_dims),
        "operand_batching": list(numbers.operand_batching_dims),
        "index_batching": list(numbers.start_indices_batching_dims),
        "sizes": list(lengths_of(given["slice_sizes"])),
        "mode": "fill" if filling else "clip",
        "fill": None if fill is None else float(fill),
    }


def _scatter(equation: Any, *, add: bool) -> dict[str, Any]:
    given = equation.params
    numbers = given["dimension_numbers"]
    clips = given["mode"] == jax.lax.GatherScatterMode.CLIP
    return {
        "shape": _shape_of(equation),
        "index_shape": _shape_of(equation, 1),
        "update_shape": _shape_of(equation, 2),
        "window_dims": list(numbers.update_window_dims),
        "inserted": list(numbers.inserted_window_dims),
        "start_index_map": list(numbers.scatter_dims_to_operand_dims),
        "operand_batching": list(numbers.operand_batching_dims),
        "index_batching": list(numbers.scatter_indices_batching_dims),
        "add": add,
        "mode": "clip" if clips else "fill",
    }


def _dot(equation: Any) -> dict[str, Any]:
    contracted, batched = equation.params["dimension_numbers"]
    return {
        "contracted": [list(map(int, axes)) for axes in contracted],
        "batched": [list(map(int, axes)) for axes in batched],
        "shapes": _shapes_of(equation),
    }


def _along_axis(equation: Any) -> dict[str, Any]:
    return {"shape": _shape_of(equation), "axis": int(equation.params["axis"])}


def _axes(equation: Any) -> dict[str, Any]:
    return {"axes": [int(axis) for axis in equation.params["axes"]]}


def _whole_axes(equation: Any) -> dict[str, Any]:
    return _axes(equation) | {"shape": _shape_of(equation)}


def _accumulation(equation: Any) -> dict[str, Any]:
    return _along_axis(equation) | {"reverse": bool(equation.params["reverse"])}


def _search(equation: Any) -> dict[str, Any]:
    return _whole_axes(equation) | {"index_dtype": str(np.dtype(equation.params["index_dtype"]))}


PARAMETERS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "argmax": _search,
    "argmin": _search,
    "broadcast_in_dim": _broadcast,
    "concatenate": lambda equation: {
        "dimension": int(equation.params["dimension"]),
        "shapes": _shapes_of(equation),
    },
    "convert_element_type": lambda equation: {
        "new_dtype": str(equation.outvars[0].aval.dtype),
    },
    "cummax": _accumulation,
    "cummin": _accumulation,
    "cumprod": _accumulation,
    "cumsum": _accumulation,
    "dim_as_value": lambda equation: {
        "dim": length(equation.params["dim"]),
        "dtype": str(equation.outvars[0].aval.dtype),
    },
    "dot_general": _dot,
    "dynamic_slice": lambda equation: {
        "sizes": list(lengths_of(equation.params["slice_sizes"])),
        "shape": _shape_of(equation),
    },
    "dynamic_update_slice": lambda equation: {
        "shape": _shape_of(equation),
        "sizes": _shape_of(equation, 1),
    },
    "gather": _gather,
    horner.NAME: lambda equation: equation.params,
    "integer_pow": lambda equation: {"y": int(equation.params["y"])},
    "iota": lambda equation: {
        "dtype": str(np.dtype(equation.params["dtype"])),
        "shape": list(lengths_of(equation.params["shape"])),
        "dimension": int(equation.params["dimension"]),
    },
    "pad": lambda equation: {
        "config": [list(map(int, axis)) for axis in equation.params["padding_config"]],
        "shape": _shape_of(equation),
    },
    "reduce_and": _axes,
    "reduce_max": _axes,
    "reduce_min": _axes,
    "reduce_or": _axes,
    "reduce_prod": _whole_axes,
    "reduce_sum": _whole_axes,
    "reshape": _reshape,
    "rev": lambda equation: {"dimensions": list(map(int, equation.params["dimensions"]))},
    "scatter": partial(_scatter, add=False),
    "scatter_add": partial(_scatter, add=True),
    "slice": _slice,
    "sort": lambda equation: {
        "dimension": int(equation.params["dimension"]),
        "num_keys": int(equation.params["num_keys"]),
        "shape": _shape_of(equation),
    },
    spline.NAME: lambda equation: equation.params,
    "split": lambda equation: (
        _along_axis(equation) | {"sizes": list(lengths_of(equation.params["sizes"]))}
    ),
    "stack": _along_axis,
    "squeeze": lambda equation: {"dimensions": list(map(int, equation.params["dimensions"]))},
    "unstack": _along_axis,
    "transpose": lambda equation: {"permutation": list(map(int, equation.params["permutation"]))},
}
"""Parameters of operations, as data, by the primitive's name."""
