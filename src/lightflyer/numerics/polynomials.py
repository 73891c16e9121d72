"""Polynomials in several variables, fitted by least squares."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from lightflyer.array.namespace import xp
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.numerics.horner import as_tuples, polynomial

_ERROR_POWERS = [(0,), (1,), (2,)]
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
    from_middle = value - (low + high) / 2.0
    beyond = xp.abs(from_middle) - (high - low) / 2.0
    if type(beyond) in (np.ndarray, np.float64) and not np.any(beyond > 0.0):
        return value  # as nearly always
    rounded = polynomial(_ROUNDED, xp.clip(beyond, 0.0, 2.0 * _MARGIN))
    excess = xp.where(beyond < 2.0 * _MARGIN, rounded, beyond - _MARGIN)
    return value - xp.sign(from_middle) * excess


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


def error_fit(bounds: np.ndarray, position: np.ndarray) -> Any:
    """Logarithm of the largest relative standard error at each place, smoothed."""
    places = np.unique(position)
    largest = np.array([bounds[position == place].max() for place in places])
    return least_squares(np.log(largest / NORMAL_HALF_WIDTH_95), (places,), _ERROR_POWERS)
