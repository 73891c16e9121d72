"""Dawson's function."""

import jax.numpy as jnp
import numpy as np

from lightflyer.core.types import Numeric

_STEP, _ODD = 0.25, range(-27, 28, 2)


def dawson(x: Numeric) -> Numeric:
    """Dawson's function, by Rybicki's sum [Rybicki1989]_, whose error is below e^{-(π/2h)²}."""
    middle = 2.0 * jnp.floor(x / (2.0 * _STEP) + 0.5)
    left = x - middle * _STEP
    parts = [jnp.exp(-((left - odd * _STEP) ** 2)) / (middle + odd) for odd in _ODD]
    total: Numeric = sum(parts) / np.sqrt(np.pi)
    return total
