"""Public functions: units, records and checks at the outermost call, plain calls within.

Within, every call is a plain call. Numbers are computed by NumPy, in double precision. What JAX
traces (under ``grad``, ``jit``, ``vmap``) is computed by JAX, in double precision whatever its
process-wide switch says, which is never touched.

Gradients taken outside a :func:`~lightflyer.float64` context are computed in double precision and
then rounded to the precision of the caller's inputs, because ``jax.grad`` itself belongs to the
caller. To keep all digits::

    with lightflyer.float64():
        slope = jax.grad(f)(0.08)
"""

import inspect
import math
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, wraps
from os import PathLike
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, ParamSpec, TypeVar, Union, get_args, get_origin

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
from lightflyer.core.checks import is_labelled, is_series
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import quantity_of, require_fit
from lightflyer.core.units import is_si

P = ParamSpec("P")
R = TypeVar("R")


def reads_units(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function take numbers as constructors do, by the quantities of its annotations."""
    if isinstance(function, type):
        function.__init__ = reads_units(function.__init__)  # type: ignore[misc]
        return function
    read = Reader(function, refuse=False)

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        plain, named = read(args, kwargs)
        return function(*plain, **named)

    return wrapper


class Reader:
    """Arguments of a function in SI."""

    # ``refuse``: whether texts and quantities are refused where no annotation tells their unit
    def __init__(self, function: Callable[..., Any], *, refuse: bool = True):
        self._function, self._refuse = function.__name__.lstrip("_"), refuse
        parameters = inspect.signature(function).parameters
        self._names = tuple(parameters)
        self._kinds = {name: _kinds_of(one.annotation) for name, one in parameters.items()}
        found = {name: quantity_of(one.annotation) for name, one in parameters.items()}
        self._quantities = {name: one for name, one in found.items() if one is not None}

    def __call__(
        self, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> tuple[list[Any], dict[str, Any]]:
        """Arguments by place and by name."""
        names = self._names[: len(args)] + self._names[-1:] * (len(args) - len(self._names))
        plain = [self._read(name, arg) for name, arg in zip(names, args, strict=True)]
        named = {name: self._read(name, arg) for name, arg in kwargs.items()}
        if self._quantities:
            given = dict(zip(names, plain, strict=True)) | named
            numbers = {name: given.get(name) for name in self._quantities}
            shapes = {name: getattr(one, "shape", ()) for name, one in numbers.items()}
            require_fit({name: shapes[name] for name in shapes if not is_labelled(numbers[name])})
        return plain, named

    def _read(self, name: str, value: Any) -> Any:
        if (kinds := self._kinds.get(name)) and not isinstance(value, kinds):
            said = " or ".join(kind.__name__ for kind in kinds if kind is not NoneType)
            wanted = "a path" if PathLike in kinds else f"of class {said}"
            raise ParameterError(f"{name} must be {wanted}, not {type(value).__name__}")
        quantity = self._quantities.get(name)
        if quantity is not None and value is not None:
            return quantity.number(name, value, keep_index=self._refuse)
        if not self._refuse:
            return value
        plain = np.asarray(value) if isinstance(value, list) else value
        no_number = isinstance(plain, np.ndarray) and plain.dtype.kind not in "biufc"
        if isinstance(value, str) or hasattr(value, "magnitude") or no_number:
            raise ParameterError(
                f"{self._function}() takes numbers in SI units, not {name} = {value!s:.60}"
            )
        return plain


def _kinds_of(annotation: Any) -> tuple[type, ...]:
    """Classes that an annotation names, of paths and of this package; none where it has others."""
    several = get_origin(annotation) in (Union, UnionType)
    kinds = get_args(annotation) if several else (annotation,)
    if not all(isinstance(one, type) and get_origin(one) is None for one in kinds):
        return ()
    known = any(one is Path or one.__module__.startswith("lightflyer") for one in kinds)
    return tuple(PathLike if one is Path else one for one in kinds) if known else ()


def strip_labels(whole: Any) -> Any:
    """The same without names of dimensions."""
    return tree.map_leaves(lambda leaf: leaf.to_numpy() if is_labelled(leaf) else leaf, whole)


def align(arguments: Any) -> tuple[Any, Callable[[Any], Any]]:
    """Arguments without names of dimensions, and what gives results of their shape these names."""
    columns = [leaf for leaf in tree.leaves(arguments) if is_series(leaf)]
    if columns:
        return _align_columns(arguments, columns)
    labelled = [leaf for leaf in tree.leaves(arguments) if is_labelled(leaf)]
    if not labelled:
        return arguments, lambda result: result
    for unit in (leaf.attrs.get("units", "") for leaf in labelled):
        if not is_si(unit):
            raise ParameterError(f'an array in "{unit}" is given where numbers are in SI units')
    import xarray as xr

    try:
        spread = iter(xr.broadcast(*xr.align(*labelled, join="exact")))
    except ValueError:
        sizes = " and ".join(str(dict(one.sizes)) for one in labelled)
        raise ParameterError(
            f"arrays of sizes {sizes} do not fit together: coordinates of the same name differ"
        ) from None
    template = labelled[0]

    def plain(leaf: Any) -> Any:
        nonlocal template
        if is_labelled(leaf):
            template = next(spread)
            return template.to_numpy()
        return leaf

    found = tree.map_leaves(plain, arguments)

    def named(leaf: Any) -> Any:
        fits = template.ndim and isinstance(leaf, np.ndarray) and leaf.shape == template.shape
        return xr.DataArray(leaf, template.coords, template.dims) if fits else leaf

    return found, lambda result: tree.map_leaves(named, result)


def _align_columns(arguments: Any, columns: list[Any]) -> tuple[Any, Callable[[Any], Any]]:
    """Arguments without the index of columns of pandas; beside arrays of xarray it is dropped."""
    first = columns[0]
    if not all(one.index.equals(first.index) for one in columns):
        raise ParameterError("columns of pandas have different indexes: take them of one table")
    found = tree.map_leaves(lambda leaf: leaf.to_numpy() if is_series(leaf) else leaf, arguments)
    if any(map(is_labelled, tree.leaves(found))):
        return align(found)

    def named(leaf: Any) -> Any:
        fits = isinstance(leaf, np.ndarray) and leaf.shape == first.shape
        return type(first)(leaf, index=first.index) if fits else leaf

    return found, lambda result: tree.map_leaves(named, result)


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
            numeric = tuple(is_tracer(leaf) or is_numeric(leaf) for leaf in leaves)
            pairs = list(zip(numeric, leaves, strict=True))
            fixed = tuple(None if one else leaf for one, leaf in pairs)
            numbers = [leaf for one, leaf in pairs if one]
            traced = _jitted if structure.is_ours else _run
            with within(load_jax()), written_for_jax():
                result = traced(function)(numbers, (structure, fixed, numeric))
            return labels(result)

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
            result = tree.map_leaves(
                lambda leaf: leaf if isinstance(leaf, str) else np.asarray(leaf)[()], result
            )
        return labels(result)

    wrapper.is_entry_point = True  # type: ignore[attr-defined]
    return wrapper


# --- by JAX ---


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
