"""Programs written in Python: for one number at a time the fastest way without a compiler.

An operation on Python's own numbers takes a tenth of what NumPy takes for it. Python raises where a
division or a function has no finite result. Then the function is written anew, of operations that
give what NumPy gives.
"""

import itertools
import keyword
import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, ClassVar

import numpy as np

from lightflyer.program.operations import ELEMENTWISE
from lightflyer.program.program import Program
from lightflyer.program.scalar.emitter import GraphOf, elements_of, graph_of, is_table
from lightflyer.program.scalar.graph import FOLDS, PRIMARY, Table
from lightflyer.program.scalar.writer import Language, Written, write_graph

_NAME, _MAKER = "_program", "_make"
_FEW = 64  # Numbers of an array that are written one by one
_MOST_KEPT = 16  # Functions of one program

_Call = Callable[[Sequence[Any]], list[np.ndarray]]
_Make = Callable[[Mapping[int, np.ndarray]], _Call]


def compile_numbers(
    program: Program, given: Mapping[int, Any], shapes: Mapping[int, tuple[int, ...]]
) -> _Call:
    """A function of those inputs of a program that are not given, in their order.

    ``given``: inputs that are known, by their places; ``shapes``: those of the others, which have
    no axes where none is given. Raises
    :class:`~lightflyer.program.operations.UnsupportedError` where the program has an operation
    that is not one on numbers. It is written once for all numbers and tables that may be given.
    """
    arrays = {place: np.asarray(value) for place, value in given.items()}
    open_ones = {
        place: array
        for place, array in arrays.items()
        if is_table(program, place, array) or _are_any_numbers(array)
    }
    fixed = {place: array for place, array in arrays.items() if place not in open_ones}
    kind = (
        *((place, array.shape, array.dtype.str) for place, array in open_ones.items()),
        *((place, array.shape, array.tobytes()) for place, array in fixed.items()),
        *shapes.items(),
    )
    known: dict[Any, Any] = program.prepare_once("python", lambda _: {})
    if kind not in known:
        for oldest in [*known][: 1 + len(known) - _MOST_KEPT]:
            known.pop(oldest, None)
        known[kind] = _write(program, fixed, shapes, open_ones)
    make: _Make = known[kind]
    return make(open_ones)


def _are_any_numbers(array: np.ndarray) -> bool:
    """Whether they are not so many, and none with which less has to be computed."""
    special = array.dtype == bool or np.isin(array, (0.0, 1.0))
    return array.size <= _FEW and not np.all(special)


def _write(
    program: Program,
    fixed: Mapping[int, Any],
    shapes: Mapping[int, tuple[int, ...]],
    open_ones: Mapping[int, np.ndarray],
) -> _Make:
    """What makes the function, of numbers and tables."""
    graph = graph_of(program, fixed, shapes, open_ones)
    shapes_found = [array.shape for array in graph.results]
    ends = [0, *itertools.accumulate(array.size for array in graph.results)]
    parts = [slice(*pair) for pair in itertools.pairwise(ends)]
    quick = _compiled(graph, _QuickPython)

    @cache
    def safe() -> Callable[..., Any]:
        # few functions need it: the graph is made again rather than kept for it
        return _compiled(graph_of(program, fixed, shapes, open_ones), _Python)

    def make(given: Mapping[int, np.ndarray]) -> _Call:
        tables = [place for place in sorted(given) if is_table(program, place, given[place])]
        numbers = [given[place].ravel().tolist() for place in sorted(given) if place not in tables]
        known = *itertools.chain(*numbers), *(elements_of(given[place]) for place in tables)
        function: Callable[..., list[Any]] | None = None

        def call(inputs: Sequence[Any]) -> list[np.ndarray]:
            nonlocal function
            values = [number for one in inputs for number in np.ravel(one).tolist()]
            try:
                function = function or quick(*known)
                results = function(*values)
            except (ArithmeticError, ValueError):  # from now on what never raises, and is slower
                function = safe()(*known)
                results = function(*values)
            return [
                np.array(results[part], kind).reshape(shape)[()]
                for part, kind, shape in zip(parts, program.output_types, shapes_found, strict=True)
            ]

        return call

    return make


def _compiled(graph: GraphOf, kind: "type[_Python]") -> Callable[..., Any]:
    """The function that makes the function."""
    language = kind(graph.tables)
    nodes = [node for array in graph.results for node in array.ravel()]
    text = write_graph(_NAME, graph.arguments, nodes, language, graph.parameters)
    names = {**_FUNCTIONS, **_QUICK, **language.tables}
    # the text is written above, of a graph of numbers: nothing in it comes from outside
    exec(compile(text, _NAME, "exec"), names)
    made: Callable[..., Any] = names[_MAKER]
    return made


# --- operations that Python's own do not serve for ---


def _divide(one: float, other: float) -> float:
    try:
        return one / other
    except ZeroDivisionError:
        if one == 0.0 or one != one:
            return math.nan
        return math.copysign(math.inf, one) * math.copysign(1.0, other)


def _largest(one: Any, other: Any) -> Any:
    return one if one >= other or one != one else other


def _smallest(one: Any, other: Any) -> Any:
    return one if one <= other or one != one else other


def _sign(value: Any) -> Any:
    return value if value != value else type(value)((value > 0) - (value < 0))


def _square_root(value: float) -> float:
    return math.sqrt(value) if value >= 0.0 else math.nan


def _truncated(value: float) -> int:
    try:
        return int(value)
    except (OverflowError, ValueError):
        return -(2**63)  # as NumPy has it


def _like_numpy(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of Python's that gives what NumPy does where it would raise."""
    other = FOLDS[name]

    def total(*values: Any) -> Any:
        try:
            return function(*values)
        except (ArithmeticError, ValueError):
            with np.errstate(all="ignore"):
                return other(*map(np.asarray, values)).item()

    return total


def _of_numpy(name: str) -> Callable[..., Any]:
    function = ELEMENTWISE[name]

    def plain(*values: Any) -> Any:
        with np.errstate(all="ignore"):
            return function(*(np.asarray(value)[()] for value in values)).item()

    return plain


_OF_MATH = ("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh",
            "erf", "erfc", "exp", "expm1", "log", "log1p", "pow", "sin", "sinh", "tan",
            "tanh")  # fmt: skip
_SIGNS = {"add": "+", "sub": "-", "mul": "*", "lt": "<", "le": "<=", "gt": ">", "ge": ">=",
          "eq": "==", "ne": "!=", "and": " and ", "or": " or ", "neg": "-",
          "number": "+"}  # fmt: skip

_FUNCTIONS: dict[str, Any] = {
    **{f"_{name}": _of_numpy(name) for name in ELEMENTWISE if name not in _SIGNS},
    **{f"_{name}": _like_numpy(name, getattr(math, name)) for name in _OF_MATH},
    "_div": _divide,
    "_max": _largest,
    "_min": _smallest,
    "_sign": _sign,
    "_sqrt": _square_root,
    "_abs": abs,
    "_is_finite": math.isfinite,
    "_trunc": _truncated,
    "_inf": math.inf,
    "_nan": math.nan,
}


class _Python(Language):
    name = "Python"
    reserved = frozenset(keyword.kwlist)
    signs: ClassVar = _SIGNS
    functions: ClassVar = {name.removeprefix("_"): name for name in _FUNCTIONS}

    def __init__(self, tables: Sequence[Table]) -> None:
        self.tables: dict[str, Sequence[Any]] = {}
        self._names = {id(table): f"T{number}" for number, table in enumerate(tables)}
        self._parameters = [*self._names.values()]

    def number(self, value: Any) -> str:
        if isinstance(value, float) and not math.isfinite(value):
            return "_nan" if math.isnan(value) else ("-_inf" if value < 0 else "_inf")
        return repr(value)

    def choice(self, condition: str, true: str, false: str) -> str:
        return f"{true} if {condition} else {false}"

    def negation(self, operand: str) -> Written:
        return f"(not {operand})", PRIMARY

    def table(self, values: Sequence[Any] | Table) -> str:
        name = self._names.setdefault(id(values), f"T{len(self._names)}")
        if not isinstance(values, Table):
            self.tables[name] = values
        return name

    def definition(self, name: str, text: str) -> str:
        return f"{name}={text}"

    change = definition

    def loop(self, start: list[tuple[str, str]], body: list[str]) -> list[str]:
        variables = [f"{name}={text}" for name, text in start]
        return [*variables, "while True:", *(f" {line}" for line in body)]

    def stop(self, condition: str) -> str:
        return f"if not {condition}:break"

    def function(
        self, name: str, arguments: Sequence[str], body: list[str], results: Sequence[str]
    ) -> str:
        lines = "".join(f" {line}\n" for line in body)
        return f"def {name}({','.join(arguments)}):\n{lines} return [{','.join(results)}]\n"

    def maker(self, parameters: Sequence[str], body: list[str], name: str, function: str) -> str:
        lines = "".join(f" {line}\n" for line in (*body, *function.splitlines()))
        given = ",".join((*parameters, *self._parameters))
        return f"def {_MAKER}({given}):\n{lines} return {name}\n"


_QUICK = {f"_quick_{name}": getattr(math, name) for name in (*_OF_MATH, "sqrt")}


class _QuickPython(_Python):
    """Operations that raise where they have no finite result."""

    signs: ClassVar = _SIGNS | {"div": "/"}
    functions: ClassVar = {
        **{name: text for name, text in _Python.functions.items() if name != "div"},
        **{name.removeprefix("_quick_"): name for name in _QUICK},
    }
