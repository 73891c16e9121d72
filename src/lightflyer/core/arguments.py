"""What scripts hand to functions: numbers with units, arrays with names of dimensions."""

import inspect
from collections.abc import Callable
from functools import wraps
from os import PathLike
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, ParamSpec, TypeVar, Union, get_args, get_origin

import numpy as np

from lightflyer.array import tree
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
