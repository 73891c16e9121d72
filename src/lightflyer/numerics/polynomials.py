"""Places in tables, and their ends."""

from typing import Any

import numpy as np

from lightflyer.array.namespace import xp
from lightflyer.numerics.horner import polynomial

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
