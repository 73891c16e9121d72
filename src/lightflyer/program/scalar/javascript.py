"""Programs of single numbers, written in JavaScript."""

import math
from collections.abc import Sequence
from typing import Any, ClassVar

from lightflyer.program.program import Program
from lightflyer.program.scalar.emitter import graph_of
from lightflyer.program.scalar.graph import PREFIX, Table
from lightflyer.program.scalar.writer import Language, Written, write_graph


def number(value: float | bool) -> str:
    """A constant as JavaScript reads it, to the last bit."""
    if isinstance(value, bool):
        return str(value).lower()
    if not math.isfinite(value):
        return "NaN" if math.isnan(value) else ("-Infinity" if value < 0 else "Infinity")
    text = repr(float(value)).removesuffix(".0").replace("e-0", "e-").replace("e+", "e")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


class Tables:
    """Arrays of constants, each written once however many functions read it."""

    def __init__(self) -> None:
        self._names: dict[tuple[Any, ...], str] = {}

    def name(self, values: tuple[Any, ...]) -> str:
        """Name of an array."""
        return self._names.setdefault(values, f"T{len(self._names)}")

    def text(self) -> str:
        """The declarations."""
        return "".join(map(_table, self._names.values(), self._names))


def _table(name: str, values: tuple[Any, ...]) -> str:
    listed = f"[{','.join(map(number, values))}]"
    flags = any(isinstance(value, bool) for value in values)
    return f"const {name}={listed if flags else f'new Float64Array({listed})'};\n"


def write_function(name: str, program: Program, tables: Tables) -> str:
    """A function of numbers that returns an array of them; ``tables``: where constants go."""
    graph = graph_of(program, {}, {})
    results = [node for array in graph.results for node in array.ravel()]
    return write_graph(name, graph.arguments, results, _JavaScript(tables))


class _JavaScript(Language):
    name = "JavaScript"
    reserved = frozenset({"do", "if", "in", "for", "let", "new", "try", "var", "NaN"})
    signs: ClassVar = {
        "add": "+", "sub": "-", "mul": "*", "div": "/", "rem": "%", "lt": "<", "le": "<=",
        "gt": ">", "ge": ">=", "eq": "===", "ne": "!==", "and": "&&", "or": "||", "neg": "-",
        "number": "+",
    }  # fmt: skip
    functions: ClassVar = {
        **{one: f"Math.{one}" for one in (
            "abs", "acos", "asin", "asinh", "atan", "atan2", "cbrt", "ceil", "cos", "cosh", "exp",
            "expm1", "floor", "log", "log1p", "max", "min", "pow", "sign", "sin", "sinh", "sqrt",
            "tan", "tanh", "trunc")},
        "is_finite": "Number.isFinite",
    }  # fmt: skip

    def __init__(self, tables: Tables):
        self._tables = tables

    def number(self, value: Any) -> str:
        return number(value)

    def choice(self, condition: str, true: str, false: str) -> str:
        return f"{condition}?{true}:{false}"

    def negation(self, operand: str) -> Written:
        return f"!{operand}", PREFIX

    def table(self, values: Sequence[Any] | Table) -> str:
        assert not isinstance(values, Table), "its functions have no parameters"
        return self._tables.name(tuple(values))

    def definition(self, name: str, text: str) -> str:
        return f"const {name}={text};"

    def change(self, name: str, text: str) -> str:
        return f"{name}={text};"

    def loop(self, start: list[tuple[str, str]], body: list[str]) -> list[str]:
        variables = ",".join(f"{name}={text}" for name, text in start)
        return [f"let {variables};", "for(;;){", *body, "}"]

    def stop(self, condition: str) -> str:
        return f"if(!{condition})break;"

    def function(
        self, name: str, arguments: Sequence[str], body: list[str], results: Sequence[str]
    ) -> str:
        lines = "\n".join([*body, f"return [{','.join(results)}];"])
        return f"function {name}({','.join(arguments)}){{\n{lines}\n}}\n"
