"""Polynomials in several variables, fitted by least squares and evaluated by JAX."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.pytree.lazy_jax import jnp

_ERROR_POWERS = [(0,), (1,), (2,)]
_MARGIN = 0.02  # how far beyond an end a corner lies, and half of the width of its rounding


def place_between(value: Any, low: float, high: float) -> Any:
    """Place of a value between two ends, from −1 to 1."""
    return (2.0 * value - low - high) / (high - low)


def polynomial(coefficients: Any, *variables: Any) -> Any:
    """Polynomial in several variables by Horner's rule; the first one's powers come last."""
    if not variables:
        return coefficients
    first, *others = variables
    *lower, highest = (polynomial(coefficient, *others) for coefficient in coefficients)
    result: Any = highest  # not from zero, which XLA would multiply and add
    for value in reversed(lower):
        result = result * first + value
    return result


def hold_within(value: Any, low: float, high: float) -> Any:
    """A value within two ends, and a little beyond the nearer one where it lies outside."""
    # The corners are round: a kink would stop Newton's method where a solution lies at it. Up to
    # the ends the value is itself. Twice differentiable, without transcendental functions, which
    # would cost more than all else in a heat balance.
    return (
        low
        - _MARGIN
        + _positive_part(value - low + _MARGIN)
        - _positive_part(value - high - _MARGIN)
    )


def _positive_part(value: Any) -> Any:
    """The value where it is positive, else zero; a polynomial within the margin of zero."""
    place = jnp.clip(value / _MARGIN, -1.0, 1.0)
    rounded = _MARGIN * (1.0 + place) ** 3 * (3.0 - place) / 16.0
    return jnp.where(value < _MARGIN, rounded, value)


def least_squares(
    values: np.ndarray,
    variables: tuple[np.ndarray, ...],
    powers: Sequence[tuple[int, ...]],
    errors: np.ndarray | float = 1.0,
) -> Any:
    """Coefficients of the polynomial with these powers that fits best, as nested tuples."""
    basis = np.stack(
        [np.prod([x**p for x, p in zip(variables, term, strict=True)], axis=0) for term in powers],
        axis=1,
    )
    weights = 1.0 / np.broadcast_to(errors, values.shape)
    fitted = np.linalg.lstsq(basis * weights[:, None], values * weights, rcond=None)[0]
    coefficients = np.zeros(np.max(powers, axis=0) + 1)
    coefficients[tuple(np.transpose(powers))] = fitted
    return as_tuples(coefficients)


def as_tuples(array: np.ndarray) -> Any:
    """An array as nested tuples of float, which can be hashed."""
    return tuple(map(as_tuples, array)) if array.ndim else float(array)


def trim_zeros(coefficients: Any) -> Any:
    """Coefficients without zeros of the highest powers, which cost time."""
    if not isinstance(coefficients, tuple):
        return coefficients
    kept = [trim_zeros(part) for part in coefficients]
    while len(kept) > 1 and kept[-1] in (0.0, (0.0,)):
        kept.pop()
    return tuple(kept)


def error_fit(bounds: np.ndarray, position: np.ndarray) -> Any:
    """Logarithm of the largest relative standard error at each place, smoothed."""
    places = np.unique(position)
    largest = np.array([bounds[position == place].max() for place in places])
    return least_squares(np.log(largest / NORMAL_HALF_WIDTH_95), (places,), _ERROR_POWERS)
