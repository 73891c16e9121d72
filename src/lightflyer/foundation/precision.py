"""Double precision, settled in one place.

JAX computes in single precision unless a process-wide switch is set. Setting that switch on
import would change the precision of every other library in the process, so lightflyer never
touches it. Instead each public numeric function is wrapped by :func:`entry_point`, which

* opens JAX's *scoped* 64-bit context for the duration of the call,
* converts every number in its inputs to float64,
* compiles the function once (:func:`jax.jit`) and reuses it,
* returns NumPy arrays, whose later arithmetic stays in double precision whatever JAX's
  switch says; under ``jit``, ``vmap`` or ``grad`` it returns JAX tracers.

Gradients taken outside a :func:`float64` context are computed in double precision and then
rounded to the precision of the caller's inputs, because ``jax.grad`` itself belongs to the
caller. To keep all digits::

    with lightflyer.float64():
        slope = jax.grad(f)(0.08)
"""

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial, wraps
from typing import Any, ParamSpec, TypeVar

import jax
import jax.numpy as jnp
import numpy as np

from lightflyer.foundation.batches import in_batches
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.kept_programs import KeptProgram

P = ParamSpec("P")
R = TypeVar("R")


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


def is_traced(*trees: Any) -> bool:
    """Whether any leaf is a JAX tracer, that is, has no concrete value yet.

    Parameters
    ----------
    *trees : pytrees of arrays or numbers

    Returns
    -------
    bool
    """
    return any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(trees))


def _promote(leaf: Any) -> Any:
    array = jnp.asarray(leaf)
    return array if array.dtype == bool else array.astype(jnp.float64)


def _to_numpy(leaf: Any) -> Any:
    return np.asarray(leaf)[()]


PIECE = 50_000
"""Elements worked on at a time by :func:`elementwise_entry_point`."""

# Compiling dominates a single prediction, and most of it is XLA's optimisation of small kernels.
_QUICK_COMPILATION: dict[str, Any] = {
    "xla_backend_optimization_level": 0,
    "xla_cpu_use_fusion_emitters": False,
    "xla_cpu_opt_preset": "CPU_OPT_PRESET_FAST_COMPILE",  # a sixth less for large programs
}


def entry_point(function: Callable[P, R]) -> Callable[P, R]:
    """Make a pure numeric function public: float64, compiled, NumPy out.

    Parameters
    ----------
    function : callable
        Pure function of pytrees of numbers and arrays. It may not read anything else.

    Returns
    -------
    callable
        Same signature. Works on plain numbers, NumPy arrays and JAX arrays, and under
        ``jit``, ``vmap``, ``grad`` and ``jvp``.
    """
    return _scoped(function, jax.jit(_promoting(function)))


def elementwise_entry_point(function: Callable[P, R]) -> Callable[P, R]:
    """Like :func:`entry_point`, for a function that treats every element by itself.

    Large arrays are worked through in pieces that fit the processor's cache, which is twice as
    fast as one sweep over all of memory, needs little of it, and compiles once for any length.

    Parameters
    ----------
    function : callable
        As for :func:`entry_point`; where its arrays all have one shape, each element of the
        result depends on the same element of the arguments only.

    Returns
    -------
    callable
    """
    compiled = jax.jit(_promoting(function))

    def in_pieces(*args: Any) -> Any:
        leaves, structure = jax.tree.flatten(args)
        shapes = {np.shape(leaf) for leaf in leaves} - {()}
        # arrays of several shapes may hold tables, which must stay whole
        if is_traced(leaves) or len(shapes) != 1 or math.prod(*shapes) <= PIECE:
            return compiled(*args)
        (shape,) = shapes
        flat = [np.ravel(leaf) if np.ndim(leaf) else leaf for leaf in leaves]
        whole = in_batches(
            lambda *piece: compiled(*jax.tree.unflatten(structure, piece)), flat, PIECE
        )
        return jax.tree.map(lambda leaf: leaf.reshape(shape) if leaf.ndim else leaf, whole)

    return _scoped(function, in_pieces)


def quick_entry_point(function: Callable[P, R]) -> Callable[P, R]:
    """Like :func:`entry_point`, for a function that runs on little data in a short process.

    It is compiled twice as fast into code that runs several times slower, and cannot be used
    under JAX's transformations. A later process finds it compiled where JAX keeps programs.

    Parameters
    ----------
    function : callable
        As for :func:`entry_point`.

    Returns
    -------
    callable
    """
    traced = jit_with_options(_promoting(function), _QUICK_COMPILATION)
    kept = KeptProgram(function, partial(_compile_flat, _QUICK_COMPILATION))

    def compiled(*args: Any, **kwargs: Any) -> Any:
        program = None if kwargs else kept.find(jax.tree.map(_in_double, args))
        return traced(*args, **kwargs) if program is None else program()

    return _scoped(function, compiled)


def jit_with_options(function: Callable[..., Any], options: dict[str, Any]) -> Callable[..., Any]:
    """Like :func:`jax.jit`, with options of XLA where it knows them.

    Parameters
    ----------
    function : callable
    options : dict of str to object
        They take precedence over XLA's flags.

    Returns
    -------
    callable
    """
    jitted = _Tolerant(function, options)
    return lambda *args, **kwargs: jitted.use(lambda chosen: chosen(*args, **kwargs))


class _Tolerant:
    """A jitted function, without those of its options that this XLA does not know."""

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]):
        self._function, self._known = function, dict(options)
        self._chosen = jax.jit(function, compiler_options=self._known)

    def use(self, how: Callable[[Any], Any]) -> Any:
        while True:
            try:
                return how(self._chosen)
            except jax.errors.JaxRuntimeError as error:
                unknown = {name for name in self._known if f"'{name}'" in str(error)}
                if "No such compile option" not in str(error) or not unknown:
                    raise
            self._known = {k: v for k, v in self._known.items() if k not in unknown}
            self._chosen = jax.jit(self._function, compiler_options=self._known or None)


def _compile_flat(
    options: dict[str, Any], function: Callable[[list[Any]], list[Any]], leaves: list[Any]
) -> Any:
    return _Tolerant(function, options).use(lambda chosen: chosen.lower(leaves).compile())


def _in_double(leaf: Any) -> np.ndarray:
    array = np.asarray(leaf)
    return array if array.dtype == bool else array.astype(np.float64)


def _promoting(function: Callable[..., Any]) -> Callable[..., Any]:
    def promoted(*args: Any, **kwargs: Any) -> Any:
        args, kwargs = jax.tree.map(_promote, (args, kwargs))
        return function(*args, **kwargs)

    return promoted


def _scoped(function: Callable[P, R], compiled: Callable[..., Any]) -> Callable[P, R]:
    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        plain = [_plain(function, arg) for arg in args]
        named = {name: _plain(function, arg) for name, arg in kwargs.items()}
        with float64():
            result: Any = compiled(*plain, **named)
        return result if is_traced(result) else jax.tree.map(_to_numpy, result)

    wrapper.is_entry_point = True  # type: ignore[attr-defined]
    return wrapper


def is_entry_point(function: Any) -> bool:
    """Whether a function was made public by one of the decorators here.

    Parameters
    ----------
    function : object

    Returns
    -------
    bool
    """
    return getattr(function, "is_entry_point", False) is True


def _plain(function: Callable[..., Any], argument: Any) -> Any:
    """An argument without what JAX does not take for an array: lists and xarray's are."""
    if isinstance(argument, list) or hasattr(argument, "dims"):
        return np.asarray(argument)
    if isinstance(argument, str) or hasattr(argument, "magnitude"):
        raise ParameterError(
            f"{function.__name__.lstrip('_')}() takes numbers in SI units, not {argument!s:.60}; "
            "constructors and files read units"
        )
    return argument
