"""The equations of numpy_model compiled by numba, with the root-finder one would write for it.

The formulas are those of numpy_model itself, compiled; what is here is the search alone: false
position after Dowell and Jarratt (1971, "Illinois"), which never leaves its bracket.
"""

from types import FunctionType

import numba
import numpy as np
import numpy_model

MOST_STEPS = 200

_names = dict(vars(numpy_model))
for _name in ("viscosity", "conductivity", "heat_capacity", "mean_speed", "lost_power"):
    _plain = getattr(numpy_model, _name)
    _names[_name] = numba.njit(FunctionType(_plain.__code__, _names, _name, _plain.__defaults__))
_lost_power = _names["lost_power"]


@numba.njit
def temperature(absorbed, cold, hottest, pressure, radius, tac_mean, emittance, tolerance):
    """Temperature at which a disk gives off what it absorbs [K]."""
    low, high = cold, hottest
    at_low = -1.0
    at_high = _lost_power(high, cold, pressure, radius, tac_mean, emittance) / absorbed - 1.0
    side = 0
    for _ in range(MOST_STEPS):
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        if not low < middle < high:
            return middle
        found = _lost_power(middle, cold, pressure, radius, tac_mean, emittance) / absorbed - 1.0
        if abs(found) <= tolerance:
            return middle
        if found < 0.0:
            low, at_low = middle, found
            if side == -1:
                at_high *= 0.5
            side = -1
        else:
            high, at_high = middle, found
            if side == 1:
                at_low *= 0.5
            side = 1
    return np.nan


@numba.njit
def temperatures(absorbed, cold, hottest, pressure, radius, tac_mean, emittance, tolerance):
    """Temperatures of many disks, on one processor."""
    found = np.empty(absorbed.size)
    for n in range(absorbed.size):
        found[n] = temperature(
            absorbed[n], cold[n], hottest[n], pressure[n], radius[n], tac_mean, emittance[n],
            tolerance,
        )  # fmt: skip
    return found
