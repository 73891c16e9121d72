"""Programs written in Python: for one number at a time the fastest way without a compiler.

An operation on Python's own numbers takes a tenth of what NumPy takes for it. Python raises where a
division or a function has no finite result; here it is what NumPy gives.
"""

import itertools
import keyword
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from lightflyer.program.operations import ELEMENTWISE
from lightflyer.program.program import Program
from lightflyer.program.scalar.emitter import graph_of
from lightflyer.program.scalar.graph import FOLDS, PRIMARY
from lightflyer.program.scalar.writer import Language, Written, write_graph

_NAME = "_program"


def compile_numbers(
    program: Program, given: Mapping[int, Any], shapes: Mapping[int, tuple[int, ...]]
) -> Callable[[Sequence[Any]], list[np.ndarray]]:
    """A function of those inputs of a program that are not given, in their order.

    ``given``: inputs that are known, by their places; ``shapes``: those of the others, which have
    no axes where none is given. Raises
    :class:`~lightflyer.program.operations.UnsupportedError` where the program has an operation
    that is not one on numbers.
    """
    arguments, found = graph_of(program, given, shapes)
    language = _Python()
    nodes = [node for array in found for node in array.ravel()]
    text = write_graph(_NAME, arguments, nodes, language)
    names = {**_FUNCTIONS, **language.tables}
    # the text is written above, of a graph of numbers: nothing in it comes from outside
    exec(compile(text, _NAME, "exec"), names)
    function = names[_NAME]
    shapes_found = [array.shape for array in found]
    ends = [0, *itertools.accumulate(array.size for array in found)]
    parts = [slice(*pair) for pair in itertools.pairwise(ends)]

    def call(inputs: Sequence[Any]) -> list[np.ndarray]:
        numbers = [number for one in inputs for number in np.ravel(one).tolist()]
        results = function(*numbers)
        return [
            np.array(results[part], kind).reshape(shape)[()]
            for part, kind, shape in zip(parts, program.output_types, shapes_found, strict=True)
        ]

    return call


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

    def __init__(self) -> None:
        self.tables: dict[str, Sequence[Any]] = {}
        self._names: dict[int, str] = {}

    def number(self, value: Any) -> str:
        if isinstance(value, float) and not math.isfinite(value):
            return "_nan" if math.isnan(value) else ("-_inf" if value < 0 else "_inf")
        return repr(value)

    def choice(self, condition: str, true: str, false: str) -> str:
        return f"{true} if {condition} else {false}"

    def negation(self, operand: str) -> Written:
        return f"(not {operand})", PRIMARY

    def table(self, values: Sequence[Any]) -> str:
        name = self._names.setdefault(id(values), f"T{len(self._names)}")
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
