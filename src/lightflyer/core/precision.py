"""Double precision without touching JAX's process-wide switch."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from typing import Any

import numpy as np

from lightflyer.pytree.lazy_jax import Array, forget, is_loaded, jax, jnp, when_used


@contextmanager
def float64() -> Iterator[None]:
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
    with ExitStack() as stack:

        def switch() -> None:
            stack.enter_context(jax.enable_x64(True))

        when_used(switch)  # within the context, too
        try:
            yield
        finally:
            forget(switch)


def in_double(value: Any) -> Any:
    """A number as an array of double precision; one of JAX stays one of JAX."""
    return jnp.asarray(value, float) if isinstance(value, Array) else np.asarray(value, float)


def beside_traces() -> AbstractContextManager[Any]:
    """Context whose results are numbers, also where it is entered while a function is traced."""
    return jax.ensure_compile_time_eval() if is_loaded() else nullcontext()
