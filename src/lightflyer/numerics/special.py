"""Dawson's function, the error function, and a sum of errors."""

import math
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, call, is_jax, load_jax, xp

_STEP, _ODD = 0.25, range(-27, 28, 2)


def dawson(x: Numeric) -> Numeric:
    """Dawson's function, by Rybicki's sum [Rybicki1989]_, whose error is below e^{-(π/2h)²}."""
    middle = 2.0 * xp.floor(x / (2.0 * _STEP) + 0.5)
    left = x - middle * _STEP
    parts = [xp.exp(-((left - odd * _STEP) ** 2)) / (middle + odd) for odd in _ODD]
    total: Numeric = sum(parts) / np.sqrt(np.pi)
    return total


def root_sum_square(*values: Any) -> Array:
    """What independent errors amount to together; one of them is not zero."""
    # JAX's own takes ten times as many operations, for numbers whose squares no computer holds
    return xp.sqrt(sum(value**2 for value in values))


def erf(x: Any) -> Array:
    """The error function."""
    if call.jax is not None:
        return call.jax.scipy.special.erf(x)
    if is_jax(x):
        return load_jax().scipy.special.erf(x)
    return _erf(x)  # SciPy's takes half a second to load


_erf = np.vectorize(math.erf, otypes=[float])


def xlogy(x: Any, y: Any) -> Array:
    """Product of x and ln y, zero where x is."""
    nothing = x == 0.0
    return xp.where(nothing, 0.0, x * xp.log(xp.where(nothing, 1.0, y)))


def i0e(x: Any) -> Array:
    """Modified Bessel function of order zero, over e to the size of x."""
    if call.jax is not None:
        return call.jax.scipy.special.i0e(x)
    if is_jax(x):
        return load_jax().scipy.special.i0e(x)
    from scipy import special

    return special.i0e(x)
