"""The way into numeric functions: double precision, the right way to run, NumPy out.

JAX computes in single precision unless a process-wide switch is set. Setting that switch on
import would change the precision of every other library in the process, so lightflyer never
touches it. Instead each public numeric function is wrapped by :func:`entry_point`, which

* opens JAX's *scoped* 64-bit context for the duration of the call,
* converts every number in its inputs to float64,
* traces the function once for arrays of any length, and keeps the trace for later processes,
* runs it by NumPy, or by XLA where that is faster though it compiles first,
* returns NumPy arrays, whose later arithmetic stays in double precision whatever JAX's
  switch says; under ``jit``, ``vmap`` or ``grad`` it returns JAX tracers.

Gradients taken outside a :func:`~lightflyer.core.precision.float64` context are computed in
double precision and then rounded to the precision of the caller's inputs, because ``jax.grad``
itself belongs to the caller. To keep all digits::

    with lightflyer.float64():
        slope = jax.grad(f)(0.08)
"""

import math
import os
from collections import Counter, OrderedDict
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, cached_property, partial, wraps
from threading import Lock
from typing import Any, Literal, NamedTuple, ParamSpec, TypeVar
from weakref import ref

import numpy as np

from lightflyer.core.checks import is_traced
from lightflyer.core.errors import ParameterError
from lightflyer.core.precision import float64
from lightflyer.program import kept
from lightflyer.program.arguments import Reader, align
from lightflyer.program.numpy_backend import (
    CALL,
    ELEMENT,
    Meter,
    OutOfTimeError,
    require_supported,
    run,
)
from lightflyer.program.operations import UnsupportedError
from lightflyer.program.program import SYMBOLS, Length, Program
from lightflyer.program.pruning import with_outputs
from lightflyer.program.scalar.python import compile_numbers
from lightflyer.program.structure import from_data
from lightflyer.program.tracing import trace
from lightflyer.program.widening import serves_many
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import is_loaded, jax, jnp

P = ParamSpec("P")
R = TypeVar("R")

SETTING = "LIGHTFLYER_RUN"  # Environment variable: ``numpy`` or ``xla`` run every function that way

COMPILATION, XLA_ELEMENT = 1.5e-3, 0.3e-9
"""Time that XLA takes to compile an operation of a program, and then for each element [s]; see
``benchmarks/programs.py``."""

PIECE = 50_000
"""Elements that XLA works on at a time, in functions that treat every element by itself."""

ROWS = 8192
"""Elements that NumPy works on at a time: their arrays stay within the processor's cache."""

MOST_STEPS = 500_000
"""Steps of all programs that a process has at hand, some 100 MB; those unused for longest go."""

_way: ContextVar[str | None] = ContextVar("way", default=None)


@contextmanager
def run_by(way: str) -> Iterator[None]:
    """Context in which functions are run one way, whatever they cost."""
    before = _way.set(_require_way(way))
    try:
        yield
    finally:
        _way.reset(before)


def _require_way(way: str) -> str:
    if way not in ("numpy", "xla"):
        raise ParameterError(f'functions run by "numpy" or "xla", not by "{way}"')
    return way


def forced_way() -> str | None:
    """The way in which the user wants functions to be run, if any."""
    chosen, setting = _way.get(), os.environ.get(SETTING, "")
    return chosen or (_require_way(setting) if setting else None)


def entry_point(
    function: Callable[P, R], *, way: Literal["numpy", "xla"] | None = None
) -> Callable[P, R]:
    """Make a pure numeric function public: float64, compiled where that pays, NumPy out.

    Parameters
    ----------
    function : callable
        Pure function of pytrees of numbers and arrays. It may not read anything else.
    way : {"numpy", "xla"}, optional
        How it is run unless the user forces another way; by default what costs least.

    Returns
    -------
    callable
        Same signature. Works on plain numbers, NumPy arrays and JAX arrays, and under
        ``jit``, ``vmap``, ``grad`` and ``jvp``.
    """
    return _public(function, _Runner(function, way=way))


def elementwise_entry_point(function: Callable[P, R]) -> Callable[P, R]:
    """Like :func:`entry_point`, for a function that treats every element by itself."""
    # Large arrays are worked through in pieces that fit the processor's cache, which is twice as
    # fast as one sweep over all of memory, needs little of it, and compiles once for any length.
    return _public(function, _Runner(function, elementwise=True))


def only(
    function: Callable[P, dict[str, Any]], names: Sequence[str]
) -> Callable[P, dict[str, Any]]:
    """Some of the outputs that an entry point returns by name; the others cost nothing."""
    return _only(function, tuple(names))


@cache
def _only(
    function: Callable[P, dict[str, Any]], names: tuple[str, ...]
) -> Callable[P, dict[str, Any]]:
    runner: _Runner = function.runner  # type: ignore[attr-defined]
    return _public(function, runner.only(names))


def bind(function: Callable[..., R], *given: Any, example: Sequence[Any]) -> Callable[..., R]:
    """A function of the last arguments of an entry point alone, for very many calls of it.

    They are plain numbers and arrays like those of ``example``. It is written in Python, number by
    number, with the arguments ``given`` in their places.
    """
    runner: _Runner = function.runner  # type: ignore[attr-defined]
    return runner.bind(given, tuple(example))


def evaluate_once(function: Callable[..., Any], *arrays: np.ndarray) -> np.ndarray:
    """A function of arrays whose result is one array, by NumPy, also while others are traced.

    For what is needed once: JAX would compile each of its operations.
    """
    shapes, types = [array.shape for array in arrays], [array.dtype.str for array in arrays]
    with float64():
        program, _ = trace(lambda leaves: function(*leaves), shapes, types)
    (found,) = run(program, arrays)
    return found


def is_entry_point(function: Any) -> bool:
    """Whether a function was made public by one of the decorators here."""
    return getattr(function, "is_entry_point", False) is True


def _public(function: Callable[P, R], runner: "_Runner") -> Callable[P, R]:
    read = Reader(function)

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        (plain, named), labels = align(read(args, kwargs))
        result: Any = labels(runner(plain, named))
        return result

    wrapper.is_entry_point = True  # type: ignore[attr-defined]
    wrapper.runner = runner  # type: ignore[attr-defined]
    return wrapper


def _run_beside(program: Program, known: list[np.ndarray], inputs: Sequence[Any]) -> list[Any]:
    """What a bound function gives where Python cannot be written for it: slower, and the same."""
    found = run(program, [*known, *map(np.asarray, inputs)])
    return [array[()] for array in found]


def _is_disabled() -> bool:
    """Whether JAX runs one operation after another, for whom looks for a fault."""
    return is_loaded() and bool(jax.config.jax_disable_jit)  # type: ignore[attr-defined]


def _in_double(leaf: Any) -> np.ndarray:
    array = np.asarray(leaf)
    return array if array.dtype == bool else array.astype(np.float64, copy=False)


def _promote(leaf: Any) -> Any:
    array = jnp.asarray(leaf)
    # strongly typed, or a function would be traced twice
    return array if array.dtype == bool else jax.lax.convert_element_type(array, jnp.float64)


class _Traced(NamedTuple):
    """A program, and how to put its outputs together."""

    program: Program
    assemble: Callable[[list[Any]], Any]

    def only(self, names: tuple[str, ...]) -> "_Traced":
        """The same for some outputs of a function that returns them by name."""
        places = self.assemble(list(range(len(self.program.output_shapes))))
        program = with_outputs(self.program, [places[name] for name in names])
        return _Traced(program, lambda leaves: dict(zip(names, leaves, strict=True)))

    def serves(self, widened: tuple[bool, ...]) -> bool:
        """Whether inputs that are single in the program may be given as arrays."""
        return not any(widened) or self.program.prepare_once(
            widened, lambda program: serves_many(program, widened)
        )


class _AtHand:
    """Programs in the order of their last use, of which the first make room for new ones."""

    def __init__(self) -> None:
        self._lock, self._steps = Lock(), 0
        self._uses: OrderedDict[int, tuple[ref[_Runner], Any, int]] = OrderedDict()

    def use(self, runner: "_Runner", key: Any, traced: _Traced) -> None:
        """Note that a runner uses one of its programs, which may end the use of others."""
        with self._lock:
            _, _, before = self._uses.pop(id(traced), (None, None, 0))
            self._uses[id(traced)] = ref(runner), key, traced.program.size
            self._steps += traced.program.size - before
            while self._steps > MOST_STEPS and len(self._uses) > 1:
                owner, other, steps = self._uses.popitem(last=False)[1]
                self._steps -= steps
                forgetful = owner()
                if forgetful is not None:
                    forgetful.forget(other)


_at_hand = _AtHand()


class _Runner:
    """Runs a function by the way that costs least."""

    def __init__(
        self, function: Callable[..., Any], *, elementwise: bool = False, way: str | None = None
    ):
        self._function, self._way = function, way
        self._elementwise = elementwise
        self._traced: dict[Any, _Traced | None] = {}
        self._spent: dict[Any, float] = {}  # time that NumPy took, by the shapes of a call
        self._run: dict[Program, tuple[float, float]] = {}  # calls a piece, work an element
        self._whole: _Runner | None = None
        self._names: tuple[str, ...] = ()

    def only(self, names: tuple[str, ...]) -> "_Runner":
        """What runs the function for some of its outputs, from the same traces."""

        def some(*args: Any, **kwargs: Any) -> dict[str, Any]:
            found = self._function(*args, **kwargs)
            return {name: found[name] for name in names}

        narrowed = _Runner(some, elementwise=self._elementwise, way=self._way)
        narrowed._whole, narrowed._names = self, names
        return narrowed

    def __call__(self, args: list[Any], kwargs: dict[str, Any]) -> Any:
        leaves, structure = tree.flatten((tuple(args), kwargs))
        if _is_disabled() or is_traced(leaves):
            with float64():
                return self._compiled(*args, **kwargs)
        arrays = [_in_double(leaf) for leaf in leaves]
        way = forced_way() or self._way
        found = None if way == "xla" else self._by_numpy(arrays, structure, way)
        if found is None:
            with float64():
                found = self._by_xla(arrays, structure)
            if not is_traced(found):  # as it is within another function's trace
                found = tree.map_leaves(lambda leaf: np.asarray(leaf)[()], found)
        return found

    @cached_property
    def _compiled(self) -> Any:
        return jax.jit(self._run_in_double)

    def _run_in_double(self, *args: Any, **kwargs: Any) -> Any:
        args, kwargs = tree.map_leaves(_promote, (args, kwargs))
        return self._function(*args, **kwargs)

    def bind(self, given: tuple[Any, ...], example: tuple[Any, ...]) -> Callable[..., Any]:
        """The function of its last arguments alone, run by Python where it can be."""
        leaves, structure = tree.flatten(((*given, *example), {}))
        arrays = [_in_double(leaf) for leaf in leaves]
        traced = self._program(
            structure,
            tuple(array.shape for array in arrays),
            tuple(array.dtype for array in arrays),
            may_trace=True,
        )
        if traced is None:
            raise UnsupportedError(f"{self._function.__name__} is not among what NumPy runs")
        first = len(leaves) - len(tree.leaves(example))
        known, shapes = arrays[:first], [array.shape for array in arrays[first:]]
        places = range(first, len(leaves))
        try:
            call = compile_numbers(
                traced.program,
                dict(enumerate(known)),
                dict(zip(places, shapes, strict=True)),
            )
        except UnsupportedError:
            call = partial(_run_beside, traced.program, known)
        return lambda *free: traced.assemble(call(tree.leaves(free)))

    # --- by XLA ---

    def _by_xla(self, arrays: list[np.ndarray], structure: Any) -> Any:
        def compiled(leaves: list[Any]) -> Any:
            args, kwargs = tree.unflatten(structure, leaves)
            return self._compiled(*args, **kwargs)

        shape = self._elements(structure, [array.shape for array in arrays])
        if shape is None or math.prod(shape) <= PIECE:
            return compiled(arrays)
        return _in_pieces(compiled, arrays, shape, PIECE, filled=True)

    def _elements(
        self, structure: Any, shapes: Sequence[tuple[int, ...]]
    ) -> tuple[int, ...] | None:
        """Shape of the elements where each is a problem of its own; None where unknown."""
        # Arrays of several shapes may hold tables, which must stay whole: then it is the shape of
        # those that stand beside flyer and surroundings.
        if not self._elementwise:
            return None
        several = {*shapes} - {()}
        if len(several) > 1:
            several = {shapes[n] for n in _beside(structure, len(shapes))} - {()}
        return several.pop() if len(several) == 1 else None

    # --- by NumPy ---

    def _by_numpy(self, arrays: list[np.ndarray], structure: Any, way: str | None) -> Any:
        """The result, or None where XLA is the better way."""
        shapes = tuple(array.shape for array in arrays)
        if 0 in (length for one in shapes for length in one):
            return None
        shape = self._elements(structure, shapes)
        if shape is not None:  # elements in one row
            arrays = [np.ravel(array) if array.shape == shape else array for array in arrays]
        traced = self._find(structure, arrays)
        if traced is None:
            return None
        program, call = traced.program, (structure, shapes)
        sizes = (
            array.size
            for array, is_table in zip(arrays, program.tables, strict=True)
            if not is_table
        )
        elements = max(sizes, default=1)
        rows = elements if shape is None else min(elements, ROWS)
        calls, work = self._run.get(program, (program.size, program.size))
        by_xla = COMPILATION * program.size + XLA_ELEMENT * work * elements
        affordable = by_xla - self._spent.get(call, 0.0)
        by_numpy = math.ceil(elements / rows) * calls * CALL + work * elements * ELEMENT
        if way is None and by_numpy > affordable:
            return None
        meter = Meter(math.inf if way or program in self._run else affordable)
        try:
            if shape is None:
                found = run(program, arrays, meter)
            else:
                found = _in_pieces(lambda piece: run(program, piece, meter), arrays, shape, ROWS)
        except OutOfTimeError:
            return None
        finally:
            self._spent[call] = self._spent.get(call, 0.0) + meter.spent
        self._run[program] = meter.calls * rows / elements, meter.work / elements
        return traced.assemble([part[()] for part in found])

    def _find(self, structure: Any, arrays: list[np.ndarray]) -> _Traced | None:
        """The program for some arguments: known, kept or traced now; None where there is none."""
        types = tuple(array.dtype for array in arrays)
        patterns = [*self._patterns(structure, tuple(array.shape for array in arrays))]
        for may_trace in (False, True):  # a trace that fails takes as long as one that does not
            for pattern, widened in patterns:
                found = self._program(structure, pattern, types, may_trace=may_trace)
                if found is not None and found.serves(widened):
                    return found
        return None

    def _patterns(
        self, structure: Any, shapes: tuple[tuple[int, ...], ...]
    ) -> Iterator[tuple[tuple[tuple[Length, ...], ...], tuple[bool, ...]]]:
        """Shapes to trace for, the most general first, and which of them stand for longer ones."""
        # Lengths are symbols: all, then the commonest, or that of the last argument, for which
        # tables are most often looked up, then none. Before that, numbers of a flyer or its
        # surroundings may be single though there are many, where the function takes an array beside
        # them: what a prediction traces then serves Monte Carlo, too.
        elements = self._elements(structure, shapes)
        beside = {n for n in _beside(structure, len(shapes)) if shapes[n] == elements}
        widened = tuple(shape == elements and n not in beside for n, shape in enumerate(shapes))
        if beside:
            pattern: tuple[tuple[Length, ...], ...] = tuple(
                SYMBOLS[:1] if n in beside else () if widened[n] else shape
                for n, shape in enumerate(shapes)
            )
            yield pattern, widened
        lengths = Counter(length for shape in shapes for length in shape if length > 1)
        commonest = [length for length, _ in lengths.most_common()]
        last = [one[0] for one in shapes if one and one[0] > 1][-1:]
        for chosen in dict.fromkeys(map(tuple, (commonest, commonest[:1], last, ()))):
            symbols = dict(zip(chosen, SYMBOLS, strict=False))
            pattern = tuple(
                tuple(symbols.get(length, length) for length in shape) for shape in shapes
            )
            yield pattern, (False,) * len(shapes)

    def _program(
        self,
        structure: Any,
        pattern: tuple[tuple[Length, ...], ...],
        types: tuple[Any, ...],
        *,
        may_trace: bool,
    ) -> _Traced | None:
        """The program for some shapes; None where there is none, or none yet."""
        key = structure, pattern, types
        known = self._traced.get(key, ...)
        if known is not ...:
            if known is not None:
                _at_hand.use(self, key, known)
            return known
        if self._whole is not None:
            whole = self._whole._program(structure, pattern, types, may_trace=may_trace)
            found = None if whole is None else whole.only(self._names)
        else:
            numbers = [
                kept.Number(shape, kind.str) for shape, kind in zip(pattern, types, strict=True)
            ]
            form = tree.unflatten(structure, numbers)
            found = _load_kept(self._function, form)
            if found is None and may_trace:
                with float64():
                    found = self._trace(structure, pattern, types, form)
        if found is not None or may_trace:
            self._traced[key] = found
        if found is not None:
            _at_hand.use(self, key, found)
        return found

    def forget(self, key: Any) -> None:
        """Let go of a program, which is read or traced again when it is needed."""
        traced = self._traced.pop(key, None)
        if traced is not None:
            self._run.pop(traced.program, None)

    def _trace(
        self,
        structure: Any,
        pattern: tuple[tuple[Length, ...], ...],
        types: Sequence[Any],
        form: Any,
    ) -> _Traced | None:
        def flat(leaves: list[Any]) -> Any:
            args, kwargs = tree.unflatten(structure, leaves)
            return self._compiled(*args, **kwargs)  # JAX keeps its trace, for derivatives of it

        symbolic = any(isinstance(length, str) for shape in pattern for length in shape)
        try:
            program, result = trace(flat, pattern, types)
            require_supported(program)
        except UnsupportedError:
            return None
        except Exception:
            if not symbolic:
                raise
            return None  # it needs to know a length: another pattern serves
        kept.keep(self._function, form, program, result)
        return _Traced(program, lambda leaves: tree.unflatten(result, leaves))


def _load_kept(function: Callable[..., Any], form: Any) -> _Traced | None:
    """The program that an earlier process kept, if any."""
    found = kept.find(function, form)
    if found is None:
        return None
    program, data = found
    return _Traced(program, lambda leaves: from_data(data, leaves))


def _beside(structure: Any, count: int) -> set[int]:
    """Places, among the leaves, of arrays that are arguments by themselves."""
    args, _ = tree.unflatten(structure, range(count))
    return {arg for arg in args if isinstance(arg, int)}


def _in_pieces(
    function: Callable[[list[Any]], Any],
    arrays: list[np.ndarray],
    shape: tuple[int, ...],
    size: int,
    *,
    filled: bool = False,
) -> Any:
    """Apply a function to as many elements at a time; each is a problem of its own."""
    count = math.prod(shape)
    cut = [array.shape in (shape, (count,)) for array in arrays]
    flat = [np.ravel(array) if is_cut else array for array, is_cut in zip(arrays, cut, strict=True)]

    def piece(start: int) -> list[np.ndarray]:
        stop = start + size if filled else min(start + size, count)
        rows = np.minimum(np.arange(start, stop), count - 1)
        return [array[rows] if is_cut else array for array, is_cut in zip(flat, cut, strict=True)]

    pieces = [function(piece(start)) for start in range(0, count, size)]

    def whole(*parts: Any) -> np.ndarray:
        if np.ndim(parts[0]) == 0:
            return np.asarray(parts[0])
        return np.concatenate([np.asarray(part) for part in parts])[:count].reshape(shape)

    return tree.map_leaves(whole, *pieces)
