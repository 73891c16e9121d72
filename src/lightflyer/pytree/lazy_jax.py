"""JAX, loaded when something is traced: what runs kept programs by NumPy goes without.

``from lightflyer.pytree.lazy_jax import Array, jax, jnp`` stands for imports of JAX, which take as
long as a prediction does.
"""

import functools
import importlib
import importlib.util
import sys
import threading
from collections.abc import Callable
from importlib.abc import MetaPathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any

__all__ = ["Array", "ArrayLike", "custom_jvp", "extend", "forget", "is_loaded", "is_tracer", "jax",
           "jnp", "lax", "special", "when_loaded", "when_used"]  # fmt: skip

_waiting: list[Callable[[], None]] = []
_lock = threading.Lock()


class _Own(threading.local):
    """What waits for JAX in one thread alone."""

    def __init__(self) -> None:
        self.waiting: list[Callable[[], None]] = []

    def catch_up(self) -> None:
        """Do what has waited, now that JAX is loaded."""
        waiting, self.waiting = self.waiting, []
        for action in waiting:
            action()


_own = _Own()


def is_loaded() -> bool:
    """Whether JAX is loaded, as it is wherever a value is traced."""
    return hasattr(sys.modules.get("jax"), "core")


def is_tracer(value: Any) -> bool:
    """Whether a value is traced by JAX, that is, has no concrete value yet."""
    return is_loaded() and isinstance(value, jax.core.Tracer)


def when_loaded(action: Callable[[], None]) -> None:
    """Do something as soon as JAX is loaded, by whomever."""
    with _lock:
        if not is_loaded():
            _watch()
            _waiting.append(action)
            return
    action()


def when_used(action: Callable[[], None]) -> None:
    """Do something in this thread before it uses JAX, whichever thread loads it."""
    if not is_loaded():
        _watch()
        _own.waiting.append(action)
        return
    _own.catch_up()
    action()


def forget(action: Callable[[], None]) -> None:
    """Leave out what this thread was to do before it uses JAX."""
    if action in _own.waiting:
        _own.waiting.remove(action)


def _watch() -> None:
    if not any(isinstance(finder, _Watch) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Watch())


class _Watch(MetaPathFinder):
    """Sees JAX being loaded."""

    def find_spec(self, name: str, path: Any, target: Any = None) -> Any:
        if name != "jax":
            return None
        others = (finder for finder in sys.meta_path if finder is not self)
        specs = (finder.find_spec(name, path, target) for finder in others)
        spec: Any = next(filter(None, specs), None)
        if spec is not None:
            load = spec.loader.exec_module

            def load_and_tell(module: ModuleType) -> None:
                load(module)
                with _lock:
                    waiting = _waiting[:]
                    _waiting.clear()
                for action in waiting:
                    action()
                _own.catch_up()

            spec.loader.exec_module = load_and_tell
        return spec


if TYPE_CHECKING:
    import jax
    import jax.numpy as jnp
    from jax import Array, custom_jvp, lax
    from jax.extend import core as extend
    from jax.scipy import special
    from jax.typing import ArrayLike
else:

    class _Lazy(ModuleType):
        def __getattr__(self, name: str) -> Any:
            if "_module" not in vars(self):
                self._module = importlib.import_module(self.__name__)
            if _own.waiting:
                _own.catch_up()
            return getattr(self._module, name)

    jax, jnp, lax = _Lazy("jax"), _Lazy("jax.numpy"), _Lazy("jax.lax")
    extend, special = _Lazy("jax.extend.core"), _Lazy("jax.scipy.special")
    ArrayLike = Any

    class _ArrayType(type):
        def __instancecheck__(cls, value: Any) -> bool:
            return is_loaded() and isinstance(value, jax.Array)

    class Array(metaclass=_ArrayType):
        """JAX's array, in annotations and for ``isinstance``."""

    Array.__module__ = "jax"

    class custom_jvp:  # noqa: N801
        """JAX's decorator of the same name."""

        def __init__(self, function: Callable[..., Any], nondiff_argnums: tuple[int, ...] = ()):
            functools.update_wrapper(self, function)
            self._function, self._nondiff = function, nondiff_argnums

        def defjvp(self, rule: Callable[..., Any], **options: Any) -> Callable[..., Any]:
            self._rule, self._options = rule, options
            return rule

        @functools.cached_property
        def _made(self) -> Any:
            made = jax.custom_jvp(self._function, nondiff_argnums=self._nondiff)
            made.defjvp(self._rule, **self._options)
            return made

        def __call__(self, *args: Any, **kwargs: Any) -> Any:
            return self._made(*args, **kwargs)
