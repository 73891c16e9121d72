"""Polynomials in several variables, by Horner's rule; places in tables, and their ends."""

from typing import Any, TypeAlias

import numpy as np

from lightflyer.array import tree
from lightflyer.array.memory import kept
from lightflyer.array.namespace import is_foreign, xp

Coefficients: TypeAlias = Any
"""Numbers in nested tuples, as deep as there are variables; each depth holds the powers of one."""

_MOST = 32_768  # elements that are worked on at a time: they stay within the processor's cache


def polynomial(coefficients: Coefficients, *variables: Any) -> Any:
    """Polynomial in several variables; the first one's powers come last."""
    # found by identity: to hash the numbers would take longer than to compute the polynomial
    key = id(coefficients), len(variables)
    if key not in _prepared:
        trimmed = coefficients
        table = _table(trimmed, len(variables))
        places = tuple(place for place, length in enumerate(table.shape) if length > 1)
        if len(places) < len(variables):
            table = table.reshape([table.shape[place] for place in places])
            trimmed = trim_zeros(as_tuples(table))
        _prepared[key] = coefficients, trimmed, places, np.ascontiguousarray(table.T)
    _, needed, places, table = _prepared[key]
    if len(places) < len(variables):
        variables = tuple(variables[place] for place in places)
    if not variables:
        return needed
    if xp.follows and is_foreign(*variables):
        return _written_out(needed, *variables)
    return _evaluate(table, *variables)


polynomial_once = kept(polynomial)
"""The same, remembered within a public call: for variables that its searches do not change."""

_prepared: dict[tuple[int, int], tuple[Coefficients, Coefficients, tuple[int, ...], Any]] = {}


def _written_out(coefficients: Coefficients, *variables: Any) -> Any:
    """Horner's rule, one operation after another: XLA's compiler, or a recorder, sees them."""
    if not variables:
        return coefficients
    first, *others = variables
    total, *parts = (_written_out(part, *others) for part in reversed(coefficients))
    for part in parts:
        total = total * first + part
    return total


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


def _table(coefficients: Coefficients, count: int) -> np.ndarray:
    """Coefficients as an array, filled up by zeros."""
    if count <= 1:
        return np.asarray(coefficients, float)
    parts = [_table(part, count - 1) for part in coefficients]
    table = np.zeros((len(parts), *np.max([part.shape for part in parts], axis=0)))
    for row, part in zip(table, parts, strict=True):
        row[tuple(map(slice, part.shape))] = part
    return table


def _evaluate(table: np.ndarray, first: Any, *others: Any) -> Any:
    """The polynomial; the last axis of the table holds the powers of the first variable."""
    # of the others a search often changes none
    if not others:
        return _horner(table, first)
    if table[0].size * max(map(np.size, (first, *others))) <= _MOST:
        return _horner(_powers_of_first(table, *others), first)
    return _horner([_power_of_first(table, n, *others) for n in range(table.shape[-1])], first)


@kept
def _powers_of_first(table: np.ndarray, *others: Any) -> np.ndarray:
    """Coefficients of the powers of the first variable, all at once: few calls."""
    table = table.reshape(table.shape + (1,) * max(map(np.ndim, others)))
    for variable in reversed(others):
        table = _horner(table, variable)
    return table


@kept
def _power_of_first(table: np.ndarray, power: int, *others: Any) -> Any:
    """Coefficient of a power of the first variable, by itself: little memory."""

    def value(table: np.ndarray, first: Any, *others: Any) -> Any:
        if not others:
            return _horner(table, first)
        parts = [value(table[..., n], *others) for n in range(table.shape[-1])]
        return _horner(parts, first)

    return value(table[..., power], *others)


def _horner(coefficients: Any, variable: Any) -> Any:
    total = coefficients[-1]
    for part in coefficients[-2::-1]:
        total = total * variable
        total += part
    return total


_MARGIN = 0.02  # how far beyond an end a corner lies, and half of the width of its rounding
_ROUNDED = (0.0, 0.0, 0.0, 0.25 / _MARGIN**2, -0.0625 / _MARGIN**3)


def place_between(value: Any, low: float, high: float) -> Any:
    """Place of a value between two ends, from −1 to 1."""
    return (2.0 * value - low - high) / (high - low)


def hold_within(value: Any, low: float, high: float) -> Any:
    """A value within two ends, and a little beyond the nearer one where it lies outside."""
    # The corners are round: a kink would stop Newton's method where a solution lies at it. Up to
    # the ends the value is itself. Twice differentiable, without transcendental functions, which
    # would cost more than all else in a heat balance.
    if (
        type(value) in (np.ndarray, np.float64)
        and value.size
        and low <= value.min()
        and value.max() <= high
    ):
        return value  # as nearly always
    from_middle = value - (low + high) / 2.0
    beyond = xp.abs(from_middle) - (high - low) / 2.0
    rounded = polynomial(_ROUNDED, xp.clip(beyond, 0.0, 2.0 * _MARGIN))
    excess = xp.where(beyond < 2.0 * _MARGIN, rounded, beyond - _MARGIN)
    return value - xp.sign(from_middle) * excess
