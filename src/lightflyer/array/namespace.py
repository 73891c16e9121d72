"""The namespace of the models, whose functions follow their arguments.

``xp.sqrt`` is NumPy's for numbers and NumPy's arrays, and JAX's for JAX's arrays and tracers;
another library's where its arrays name their namespace (:pep:`3118` aside, the Python array API).
As long as JAX is not loaded the functions are NumPy's own.

A public function decides at its call whether it is NumPy or JAX that computes
(:mod:`lightflyer.core.entry_point`). Within a call by JAX all arrays are JAX's, so that tables of
NumPy's can be indexed by what is traced.
"""

import importlib.util
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any, TypeAlias

import numpy as np

__all__ = ["Array", "Numeric", "as_numpy", "by_jax", "by_numpy", "call", "double", "float64",
           "has_jax", "is_foreign", "is_jax", "is_loaded", "is_numeric", "is_tracer", "load_jax",
           "notice_jax", "number", "when_loaded", "within", "xp"]  # fmt: skip

Array: TypeAlias = Any  # NumPy's or JAX's
Numeric: TypeAlias = Any  # A number, a NumPy array or a JAX array. Arguments of one call broadcast


class _Call(threading.local):
    """What the outermost call of a public function decides for all within it, thread by thread."""

    depth = 0  # 0 outside of public functions
    memory: dict[Any, dict[Any, Any]]  # See :mod:`lightflyer.array.memory`
    blanks = False  # Whether impossible numbers become NaN, where nothing is raised
    jax: Any = None  # JAX, or a module of its interface, where that computes instead of NumPy

    def __reduce__(self) -> str:  # another process has its own
        return "call"


call = _Call()


# --- JAX ---

_waiting: list[Callable[[], None]] = []
_lock = threading.Lock()


def is_loaded() -> bool:
    """Whether JAX is loaded, by whomever."""
    return hasattr(sys.modules.get("jax"), "Array")


def has_jax() -> bool:
    """Whether JAX is installed."""
    return importlib.util.find_spec("jax") is not None


def load_jax() -> ModuleType:
    """JAX, for what cannot do without: derivatives, compiled sweeps, GPUs."""
    import jax

    notice_jax()
    return jax


def when_loaded(action: Callable[[], None]) -> None:
    """Do something for JAX, such as register a class: now, or when its use is noticed."""
    _waiting.append(action)
    notice_jax()


def notice_jax() -> None:
    """Do what waits for JAX if it is loaded. Public functions and new records call this."""
    if not (_waiting and is_loaded()):
        return
    with _lock:
        while _waiting:
            _waiting.pop()()
    xp.follow()


def is_jax(value: Any) -> bool:
    """Whether a value is an array of JAX, traced or not."""
    return is_loaded() and isinstance(value, sys.modules["jax"].Array)


def is_tracer(value: Any) -> bool:
    """Whether a value is traced by JAX, or by what records in its place: it is not known yet."""
    if call.jax is not None:
        return isinstance(value, call.jax.core.Tracer)
    return is_loaded() and isinstance(value, sys.modules["jax"].core.Tracer)


def as_numpy(value: Any) -> Any:
    """What a model gives to a call by NumPy: known arrays of JAX, and lists of them, by NumPy."""
    # JAX would compile each step of what follows, for each shape
    if not call.depth or call.jax is not None or not is_loaded():
        return value
    if type(value) in (list, tuple):
        return type(value)(map(as_numpy, value))
    return np.asarray(value) if is_jax(value) and not is_tracer(value) else value


def is_foreign(*values: Any) -> bool:
    """Whether any value is an array of another library than NumPy."""
    return _other_namespace(values) is not None


@contextmanager
def float64() -> Iterator[None]:
    """Context in which JAX, imported before, computes in double precision; nothing else changes.

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
    if is_loaded():
        with sys.modules["jax"].enable_x64(True):
            yield
    else:
        yield


def double(value: Any) -> Any:
    """A number or array in double precision; what is logical stays so."""
    if is_jax(value):
        jax = sys.modules["jax"]
        array = jax.numpy.asarray(value)
        # strongly typed, or a function would be traced twice
        return array if array.dtype == bool else jax.lax.convert_element_type(array, np.float64)
    array = np.asarray(value)
    return array if array.dtype == bool else array.astype(np.float64, copy=False)


def is_numeric(value: Any) -> bool:
    """Whether a value is a number or an array of numbers; none that JAX traces."""
    return np.asarray(value).dtype.kind in "biufc"


def number(leaf: Any) -> Any:
    """A number or array in double precision, of NumPy's; anything else as it is."""
    array = np.asarray(leaf)
    if array.dtype.kind not in "biufc":
        return leaf
    return array.astype(np.float64, copy=False) if array.dtype.kind in "iuf" else array


@contextmanager
def within(jax: Any = None) -> Iterator[None]:
    """Context of a call of a public function: it computes in double precision, by NumPy or JAX.

    ``jax``: the module, or one of the same interface that records what is computed.
    """
    before = call.depth, call.jax
    call.depth, call.jax = call.depth + 1, jax
    if not before[0]:
        call.memory = {}
    try:
        if jax is not None:
            xp.follow()
        # both branches of ``where`` are computed; a model of the user's may be written in JAX
        with float64(), np.errstate(all="ignore"):
            yield
    finally:
        call.depth, call.jax = before
        if not call.depth:
            call.memory = {}


def by_numpy() -> Any:
    """Context whose arrays are NumPy's, also while JAX traces what is around it."""
    return within()


def by_jax() -> Any:
    """Context whose arrays are JAX's."""
    return within(load_jax())


# --- functions ---

_OWN = {np.ndarray, float, int, bool, complex, type(None), str, slice, type, np.dtype}
_OWN |= {np.float64, np.bool_, np.int64, np.int8, np.int32, np.complex128, np.float32}


def _other_namespace(values: Iterable[Any]) -> Any:
    """Namespace of the first array that is not NumPy's; None where all are."""
    for value in values:
        kind = type(value)
        if kind in _OWN:
            continue
        if kind in (list, tuple):
            found = _other_namespace(value)
        elif isinstance(value, np.ndarray | np.generic):
            continue
        else:
            find = getattr(value, "__array_namespace__", None)
            found = find() if find is not None and not isinstance(value, type) else None
        if found is not None and found is not np:
            return found
    return None


class _Namespace:
    """Functions of NumPy's names."""

    def __init__(self, path: tuple[str, ...] = ()):
        self._path, self.follows = path, False
        self._add_quick()

    def _add_quick(self) -> None:
        if not self._path:
            vars(self).update(_QUICK)

    def __reduce__(self) -> str:
        return ".".join(("xp", *self._path))

    def __getattr__(self, name: str) -> Any:
        path = *self._path, name
        own = _at(np, path)
        if isinstance(own, ModuleType):
            found: Any = _Namespace(path)
            found.follows = self.follows
        elif callable(own) and not isinstance(own, type) and self.follows:
            found = _following(path, own)
        else:
            found = own
        vars(self)[name] = found
        return found

    def follow(self) -> None:
        """From now on arrays need not be NumPy's."""
        if self.follows:
            return
        known = [name for name in vars(self) if not name.startswith("_") and name != "follows"]
        self.follows = True
        for name in known:
            del vars(self)[name]
        if not self._path:
            vars(self).update({name: _following((name,), own) for name, own in _QUICK.items()})


def _at(module: Any, path: tuple[str, ...]) -> Any:
    for name in path:
        module = getattr(module, name)
    return module


def _following(path: tuple[str, ...], own: Callable[..., Any]) -> Callable[..., Any]:
    def function(*args: Any, **options: Any) -> Any:
        if call.jax is not None:
            other = call.jax.numpy
        else:
            other = _other_namespace(args)
            if other is not None:
                args = as_numpy(args)
                other = _other_namespace(args)
            if other is None and options:
                other = _other_namespace(options.values())
        return own(*args, **options) if other is None else _at(other, path)(*args, **options)

    function.__name__ = function.__qualname__ = path[-1]
    return function


# NumPy's own take microseconds to find out that there is nothing to do


def _broadcast_to(array: Any, shape: Any) -> Any:
    if type(array) is np.ndarray and array.shape == shape:
        return array
    return np.broadcast_to(array, shape)


def _broadcast_arrays(*arrays: Any) -> Any:
    shapes = {array.shape if type(array) is np.ndarray else None for array in arrays}
    if len(shapes) == 1 and None not in shapes:
        return arrays
    return tuple(np.broadcast_arrays(*arrays))


def _broadcast_shapes(*shapes: Any) -> Any:
    several = {*shapes} - {()}
    return several.pop() if len(several) == 1 else np.broadcast_shapes(*shapes)


def _clip(value: Any, low: Any = None, high: Any = None) -> Any:
    value = value if low is None else np.maximum(value, low)
    return value if high is None else np.minimum(value, high)


def _full_like(array: Any, value: Any, dtype: Any = None) -> Any:
    found = np.empty(np.shape(array), dtype or getattr(array, "dtype", type(array)))
    found[...] = value
    return found


def _zeros_like(array: Any, dtype: Any = None) -> Any:
    return np.zeros(np.shape(array), dtype or getattr(array, "dtype", type(array)))


def _ones_like(array: Any, dtype: Any = None) -> Any:
    return np.ones(np.shape(array), dtype or getattr(array, "dtype", type(array)))


_QUICK: dict[str, Any] = {
    "broadcast_arrays": _broadcast_arrays, "broadcast_shapes": _broadcast_shapes,
    "broadcast_to": _broadcast_to, "clip": _clip, "full_like": _full_like,
    "ones_like": _ones_like, "zeros_like": _zeros_like,
}  # fmt: skip

xp: Any = _Namespace()
