"""Public functions of numbers: units are read and ranges checked here, at the outermost call.

Within, every call is a plain call. Numbers are computed by NumPy, in double precision. What JAX
traces (under ``grad``, ``jit``, ``vmap``) is computed by JAX, in double precision whatever its
process-wide switch says, which is never touched.

Gradients taken outside a :func:`~lightflyer.float64` context are computed in double precision and
then rounded to the precision of the caller's inputs, because ``jax.grad`` itself belongs to the
caller. To keep all digits::

    with lightflyer.float64():
        slope = jax.grad(f)(0.08)
"""

import math
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import (
    call,
    double,
    is_numeric,
    is_tracer,
    load_jax,
    notice_jax,
    number,
    within,
)
from lightflyer.core.arguments import Reader, align
from lightflyer.core.errors import ParameterError

P = ParamSpec("P")
R = TypeVar("R")

ROWS = 8192
"""Elements that NumPy works on at a time: their arrays stay within the processor's cache."""


def entry_point(function: Callable[P, R]) -> Callable[P, R]:
    """Make a pure numeric function public: units read once, float64, NumPy in and out.

    Parameters
    ----------
    function : callable
        Function of numbers, arrays and records of them.

    Returns
    -------
    callable
        Same signature. Works on plain numbers, NumPy arrays, labelled arrays of xarray, and under
        JAX's ``jit``, ``vmap``, ``grad`` and ``jvp``. Called by another public function it is the
        plain function.
    """
    return _public(function, elementwise=False)


def elementwise_entry_point(function: Callable[P, R]) -> Callable[P, R]:
    """Like :func:`entry_point`, for a function that treats every element by itself."""
    # Large arrays are worked through in pieces that fit the processor's cache, which is twice as
    # fast as one sweep over all of memory, and needs little of it.
    return _public(function, elementwise=True)


def _public(function: Callable[P, R], *, elementwise: bool) -> Callable[P, R]:
    read = Reader(function)

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        if call.depth:
            return function(*args, **kwargs)
        notice_jax()
        (plain, named), labels = align(read(args, kwargs))
        leaves, structure = tree.flatten((tuple(plain), named))
        result: Any
        if any(map(is_tracer, leaves)):
            return labels(_by_jax(function, leaves, structure))

        def compute(leaves: Sequence[Any]) -> Any:
            plain, named = tree.unflatten(structure, leaves)
            return function(*plain, **named)

        leaves = [number(leaf) for leaf in leaves]
        shape = _elements(structure, leaves) if elementwise else None
        with within():
            if shape is None or math.prod(shape) <= ROWS:
                result = compute(leaves)
            else:
                result = _in_pieces(compute, leaves, shape)
            result = tree.map_leaves(_plain, result)
        return labels(result)

    wrapper.is_entry_point = True  # type: ignore[attr-defined]
    return wrapper


def _plain(leaf: Any) -> Any:
    return leaf if isinstance(leaf, str) else np.asarray(leaf)[()]


# --- by JAX ---


def _by_jax(function: Callable[..., Any], leaves: Sequence[Any], structure: Any) -> Any:
    numeric = tuple(is_tracer(leaf) or is_numeric(leaf) for leaf in leaves)
    pairs = list(zip(numeric, leaves, strict=True))
    fixed = tuple(None if one else leaf for one, leaf in pairs)
    numbers = [leaf for one, leaf in pairs if one]
    traced = _jitted if structure.is_ours else _run
    with within(load_jax()), written_for_jax():
        return traced(function)(numbers, (structure, fixed, numeric))


@contextmanager
def written_for_jax() -> Iterator[None]:
    """Context in which JAX traces models; where one of the user's is not written for it, say so."""
    try:
        yield
    except load_jax().errors.JAXTypeError as error:
        ours = [
            Path(sys.modules[name].__file__ or "").parent for name in ("lightflyer", "jax", "numpy")
        ]
        frames = traceback.extract_tb(error.__traceback__)
        own = [one for one in frames if not {*ours} & {*Path(one.filename).parents}]
        if not own:
            raise
        raise ParameterError(
            f"{Path(own[-1].filename).name}:{own[-1].lineno}: JAX cannot trace "
            f'"{own[-1].line}"; write lightflyer.xp in place of numpy, and xp.where in place of if'
        ) from None


@cache
def _run(function: Callable[..., Any]) -> Callable[..., Any]:
    xp = load_jax().numpy

    def run(numbers: Sequence[Any], beside: Any) -> Any:
        structure, fixed, is_number = beside
        rest = iter([double(xp.asarray(number)) for number in numbers])
        given = zip(fixed, is_number, strict=True)
        plain, named = tree.unflatten(
            structure, [next(rest) if number else leaf for leaf, number in given]
        )
        return function(*plain, **named)

    return run


@cache
def _jitted(function: Callable[..., Any]) -> Callable[..., Any]:
    # Compiled once: nothing that our own classes read changes. A class of the user's may read what
    # does, and so is traced anew each time.
    jitted: Callable[..., Any] = load_jax().jit(_run(function), static_argnums=1)
    return jitted


# --- pieces ---


def _elements(structure: Any, leaves: Sequence[Any]) -> tuple[int, ...] | None:
    """Shape of the elements where each is a problem of its own; None where unknown."""
    # Arrays of several shapes may hold tables, which must stay whole: then it is the shape of
    # those that stand beside flyer and surroundings.
    shapes = [np.shape(leaf) for leaf in leaves]
    several = {*shapes} - {()}
    if len(several) > 1:
        args, _ = tree.unflatten(structure, range(len(leaves)))
        several = {shapes[arg] for arg in args if isinstance(arg, int)} - {()}
    return several.pop() if len(several) == 1 else None


def _in_pieces(
    function: Callable[[Sequence[Any]], Any], leaves: Sequence[Any], shape: tuple[int, ...]
) -> Any:
    """Apply a function to as many elements at a time; each is a problem of its own."""
    count = math.prod(shape)
    cut = [np.shape(leaf) == shape for leaf in leaves]
    flat = [np.ravel(leaf) if is_cut else leaf for leaf, is_cut in zip(leaves, cut, strict=True)]

    def piece(rows: slice) -> Any:
        found = [leaf[rows] if is_cut else leaf for leaf, is_cut in zip(flat, cut, strict=True)]
        return function(found)

    pieces = [piece(slice(start, start + ROWS)) for start in range(0, count, ROWS)]

    def whole(*parts: Any) -> Any:
        if np.ndim(parts[0]) == 0:
            return parts[0]
        return np.concatenate(parts).reshape(shape)

    return tree.map_leaves(whole, *pieces)
