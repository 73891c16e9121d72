"""Double precision without touching JAX's process-wide switch."""

from contextlib import AbstractContextManager
from typing import Any

import jax


def float64() -> AbstractContextManager[Any]:
    """Context in which JAX computes in double precision; nothing outside it changes.

    Returns
    -------
    context manager

    Examples
    --------
    >>> import jax.numpy as jnp
    >>> with float64():
    ...     print(jnp.ones(1).dtype)
    float64
    """
    return jax.enable_x64(True)
