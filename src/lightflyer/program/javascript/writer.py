"""A graph of scalar operations, written as a function in JavaScript."""

import itertools
import math
import string
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Any

from lightflyer.program.javascript.emitter import graph_of
from lightflyer.program.javascript.graph import (
    CHOICE,
    OPERATORS,
    PREFIX,
    PRIMARY,
    Loop,
    Node,
    Scope,
)
from lightflyer.program.program import Program

_LONGEST = 400  # characters of an expression; a longer one gets a name
_RESERVED = {"do", "if", "in", "for", "let", "new", "try", "var", "NaN"}
_DEEPEST = 20_000  # nodes above each other


def names() -> Iterator[str]:
    """Short names, in order."""
    for length in itertools.count(1):
        for first, *rest in itertools.product(
            string.ascii_letters,
            *[string.ascii_letters + string.digits] * (length - 1),
        ):
            name = first + "".join(rest)
            if name not in _RESERVED and not name.startswith("T"):
                yield name


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
    arguments, results = graph_of(program)
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _DEEPEST))
    try:
        return _Writer(arguments, results, tables).function(name)
    finally:
        sys.setrecursionlimit(limit)


class _Writer:
    def __init__(self, arguments: list[Node], results: list[Node], tables: Tables):
        self._arguments, self._results, self._tables = arguments, results, tables
        self._fresh = names()
        self._live = _Live(results)
        self._lines: dict[Scope, list[str]] = {}
        self._texts: dict[Node, tuple[str, int]] = {
            node: (next(self._fresh), PRIMARY) for node in arguments
        }

    def function(self, name: str) -> str:
        root = self._arguments[0].scope
        self._lines[root] = []
        found = ",".join(self._text(node) for node in self._results)
        given = ",".join(self._texts[node][0] for node in self._arguments)
        body = "\n".join(self._lines[root])
        return f"function {name}({given}){{\n{body}\nreturn [{found}];\n}}\n"

    def _text(self, node: Node, least: int = 0) -> str:
        """A node in an expression that binds as closely as ``least``."""
        text, precedence = self._expression(node)
        return f"({text})" if precedence < least else text

    def _expression(self, node: Node) -> tuple[str, int]:
        if node not in self._texts:
            if node.operation == "result":
                self._loop(node.data[0], node.scope)
            else:
                written = self._written(node)
                if node.is_constant:
                    return written
                if self._live.is_inline(node) and len(written[0]) < _LONGEST:
                    return written
                name = next(self._fresh)
                self._lines[node.scope].append(f"const {name}={written[0]};")
                self._texts[node] = name, PRIMARY
        return self._texts[node]

    def _written(self, node: Node) -> tuple[str, int]:
        if node.is_constant:
            text = number(node.data)
            return text, PREFIX if text.startswith("-") else PRIMARY
        if node.operation == "choice":
            condition, true, false = node.operands
            parts = self._text(condition, CHOICE + 1), self._text(true), self._text(false)
            return "{}?{}:{}".format(*parts), CHOICE
        if node.operation == "real":
            return self._expression(node.operands[0])
        if node.operation == "table":
            return f"{self._tables.name(node.data)}[{self._text(node.operands[0])}]", PRIMARY
        sign, precedence, _ = OPERATORS[node.operation]
        if precedence == 0:
            return f"{sign}({','.join(map(self._text, node.operands))})", PRIMARY
        if precedence == PREFIX:
            return f"{sign}{self._text(node.operands[0], PREFIX + 1)}", PREFIX
        one, other = node.operands
        right = self._text(other, precedence + 1)
        # sums and products are not associative in floating point; two signs would be one
        right = f"({right})" if right.startswith(("-", "+")) else right
        return f"{self._text(one, precedence)}{sign}{right}", precedence

    def _loop(self, loop: Loop, outer: Scope) -> None:
        kept = self._live.variables(loop)
        for place in kept:
            self._texts[loop.variables[place]] = next(self._fresh), PRIMARY
        start = ",".join(
            f"{self._text(loop.variables[place])}={self._text(loop.start[place])}" for place in kept
        )
        lines = self._lines[loop.scope] = []
        assert loop.condition is not None
        stop = f"if(!{self._text(loop.condition, PREFIX + 1)})break;"
        lines.append(stop)
        changed = [place for place in kept if loop.following[place] is not loop.variables[place]]
        new = [self._text(loop.following[place]) for place in changed]
        fresh = [next(self._fresh) for _ in changed]
        # all at once: none may see what another has become
        lines += [f"const {name}={text};" for name, text in zip(fresh, new, strict=True)]
        lines += [
            f"{self._text(loop.variables[place])}={name};"
            for place, name in zip(changed, fresh, strict=True)
        ]
        body = "\n".join(lines)
        self._lines[outer].append(f"let {start};\nfor(;;){{\n{body}\n}}")
        for node in self._live.results(loop):
            self._texts[node] = self._texts[loop.variables[node.data[1]]]


class _Live:
    """What the results need, and how often."""

    def __init__(self, results: list[Node]):
        self._uses: Counter[Node] = Counter()
        self._is_hoisted: set[Node] = set()
        self._results: dict[Loop, list[Node]] = {}
        self._kept: dict[Loop, set[int]] = {}
        self._loop_of: dict[Node, tuple[Loop, int]] = {}
        root = results[0].scope if results else None
        self._visit_all((node, root) for node in results)

    def is_inline(self, node: Node) -> bool:
        """Whether an expression is used once, where it is computed."""
        return self._uses[node] == 1 and node not in self._is_hoisted

    def variables(self, loop: Loop) -> list[int]:
        """Places of the variables of a loop that have an effect."""
        return sorted(self._kept[loop])

    def results(self, loop: Loop) -> list[Node]:
        """Results of a loop that are used."""
        return self._results[loop]

    def _visit_all(self, uses: Iterable[tuple[Node, Scope | None]]) -> None:
        waiting = list(uses)
        while waiting:
            node, scope = waiting.pop()
            self._uses[node] += 1
            if node.scope is not scope:
                self._is_hoisted.add(node)
            if self._uses[node] > 1:
                continue
            waiting += [(operand, node.scope) for operand in node.operands]
            if node.operation == "result":
                loop, place = node.data
                if loop not in self._results:
                    self._results[loop], self._kept[loop] = [], set()
                    self._loop_of |= {
                        variable: (loop, index) for index, variable in enumerate(loop.variables)
                    }
                    waiting.append((loop.condition, loop.scope))
                self._results[loop].append(node)
                waiting += self._keep(loop, place, node.scope)
            elif node in self._loop_of:
                loop, place = self._loop_of[node]
                waiting += self._keep(loop, place, None)

    def _keep(self, loop: Loop, place: int, scope: Scope | None) -> list[tuple[Node, Scope | None]]:
        if place in self._kept[loop]:
            return []
        self._kept[loop].add(place)
        # None is no scope: what starts a loop gets a name before it
        return [(loop.start[place], scope), (loop.following[place], loop.scope)]
