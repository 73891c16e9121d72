"""XLA's options, where it knows them."""

from collections.abc import Callable
from typing import Any

from lightflyer.array.namespace import load_jax


def jit_with_options(function: Callable[..., Any], options: dict[str, Any]) -> Callable[..., Any]:
    """Like :func:`jax.jit`, with options of XLA where it knows them."""
    jitted = _Tolerant(function, options)
    return lambda *args, **kwargs: jitted.use(lambda chosen: chosen(*args, **kwargs))


class _Tolerant:
    """A jitted function, without those of its options that this XLA does not know."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]):
        self._function, self._known = function, dict(options)
        self._chosen = load_jax().jit(function, compiler_options=self._known)

    def use(self, how: Callable[[Any], Any]) -> Any:
        while True:
            try:
                return how(self._chosen)
            except load_jax().errors.JaxRuntimeError as error:
                unknown = {name for name in self._known if f"'{name}'" in str(error)}
                if "No such compile option" not in str(error) or not unknown:
                    raise
            self._known = {k: v for k, v in self._known.items() if k not in unknown}
            self._chosen = load_jax().jit(self._function, compiler_options=self._known or None)
