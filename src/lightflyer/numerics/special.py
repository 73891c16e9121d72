"""Dawson's function, the error function, and a sum of errors."""

from typing import Any

import numpy as np

from lightflyer.core.types import Numeric
from lightflyer.pytree.lazy_jax import Array, custom_jvp, jax, jnp

_STEP, _ODD = 0.25, range(-27, 28, 2)


def dawson(x: Numeric) -> Numeric:
    """Dawson's function, by Rybicki's sum [Rybicki1989]_, whose error is below e^{-(π/2h)²}."""
    middle = 2.0 * jnp.floor(x / (2.0 * _STEP) + 0.5)
    left = x - middle * _STEP
    parts = [jnp.exp(-((left - odd * _STEP) ** 2)) / (middle + odd) for odd in _ODD]
    total: Numeric = sum(parts) / np.sqrt(np.pi)
    return total


def root_sum_square(*values: Any) -> Array:
    """What independent errors amount to together; one of them is not zero."""
    # JAX's own takes ten times as many operations, for numbers whose squares no computer holds
    return jnp.sqrt(sum(value**2 for value in values))


@custom_jvp
def erf(x: Any) -> Array:
    """The error function, whose derivative is one that NumPy and JavaScript can run."""
    # JAX's derivative works on the bits of numbers since 0.12
    return jax.scipy.special.erf(x)


@erf.defjvp
def _erf_slope(primals: tuple[Any], tangents: tuple[Any]) -> tuple[Array, Array]:
    (x,), (moved,) = primals, tangents
    return erf(x), moved * 2.0 / np.sqrt(np.pi) * jnp.exp(-(x**2))
