"""Polynomials in several variables as one operation; compilers see Horner's rule."""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import Any, TypeAlias

import numpy as np

from lightflyer.core.checks import is_traced
from lightflyer.program.elementwise import OwnPrimitive, apply_jax
from lightflyer.pytree import tree

NAME = "horner"  # of the primitive, and of the operation of a program

Coefficients: TypeAlias = Any
"""Numbers in nested tuples, as deep as there are variables; each depth holds the powers of one."""

_MOST = 32_768  # elements that are worked on at a time: they stay within the processor's cache


def polynomial(coefficients: Coefficients, *variables: Any) -> Any:
    """Polynomial in several variables; the first one's powers come last."""
    coefficients, places = needed(coefficients, len(variables))
    variables = tuple(variables[place] for place in places)
    if not variables:
        return coefficients
    if is_traced(variables):
        return _PRIMITIVE(*variables, coefficients=coefficients)
    return evaluator(coefficients, len(variables))(*variables)


@lru_cache(maxsize=1024)
def needed(coefficients: Coefficients, count: int) -> tuple[Coefficients, tuple[int, ...]]:
    """Coefficients for the variables that have powers, and the places of these."""
    table = _table(coefficients, count)
    places = tuple(place for place, length in enumerate(table.shape) if length > 1)
    if len(places) < count:
        lengths = [table.shape[place] for place in places]
        coefficients = trim_zeros(as_tuples(table.reshape(lengths)))
    return coefficients, places


@lru_cache(maxsize=1024)
def evaluator(coefficients: Coefficients, count: int) -> Callable[..., Any]:
    """The polynomial as a function of NumPy's numbers and arrays; ``count``: of variables."""
    table = np.ascontiguousarray(_table(coefficients, count).T)
    return partial(_evaluate, table)


def written_out(apply: Callable[..., Any], *variables: Any, coefficients: Coefficients) -> Any:
    """Horner's rule; ``apply(name, one, other)``: does an operation by its name."""
    if not variables:
        return coefficients
    first, *others = variables
    total, *parts = (
        written_out(apply, *others, coefficients=part) for part in reversed(coefficients)
    )
    for part in parts:
        total = apply("add", apply("mul", total, first), part)
    return total


def step_count(coefficients: Coefficients) -> int:
    """How many multiplications and additions the polynomial takes."""
    return 2 * len(tree.leaves(coefficients))


def as_tuples(array: Any) -> Coefficients:
    """Coefficients in an array as nested tuples, which can be hashed."""
    return tuple(map(as_tuples, array)) if np.ndim(array) else float(array)


def trim_zeros(coefficients: Coefficients) -> Coefficients:
    """Coefficients without zeros of the highest powers, which cost time."""
    if not isinstance(coefficients, tuple):
        return coefficients
    kept = [trim_zeros(part) for part in coefficients]
    while len(kept) > 1 and not any(tree.leaves(kept[-1])):
        kept.pop()
    return tuple(kept)


# --- as an array ---


@lru_cache(maxsize=1024)
def _table(coefficients: Coefficients, count: int) -> np.ndarray:
    """Coefficients as an array, filled up by zeros."""
    if count <= 1:
        return np.asarray(coefficients, float)
    parts = [_table(part, count - 1) for part in coefficients]
    table = np.zeros((len(parts), *np.max([part.shape for part in parts], axis=0)))
    for row, part in zip(table, parts, strict=True):
        row[tuple(map(slice, part.shape))] = part
    return table


@lru_cache(maxsize=1024)
def _slope(coefficients: Coefficients, count: int, place: int) -> Coefficients:
    """Coefficients of the derivative in one variable."""
    rows = np.moveaxis(_table(coefficients, count), place, -1)
    slope = rows[..., 1:] * np.arange(1, rows.shape[-1])
    return trim_zeros(as_tuples(np.moveaxis(slope, -1, place)))


def _evaluate(table: np.ndarray, *variables: Any) -> Any:
    """The polynomial; the first axis of the table holds the powers of the last variable."""
    first, *others = variables
    if others and table[0].size * max(map(np.size, variables)) > _MOST:
        total = _evaluate(table[..., -1], *others)
        for power in range(table.shape[-1] - 2, -1, -1):
            total = total * first
            total += _evaluate(table[..., power], *others)
        return total
    # for all powers of the other variables at once: few calls
    table = table.reshape(table.shape + (1,) * max(map(np.ndim, variables)))
    for variable in reversed(variables):
        total = table[-1]
        for part in table[-2::-1]:
            total = total * variable
            total += part
        table = total
    return table


def _slope_in(place: int, *variables: Any, coefficients: Coefficients) -> Any:
    return polynomial(_slope(coefficients, len(variables), place), *variables)


_PRIMITIVE = OwnPrimitive(NAME, partial(written_out, apply_jax), _slope_in)
