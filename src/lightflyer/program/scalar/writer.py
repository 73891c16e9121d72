"""A graph of scalar operations, written as a function in some language."""

import itertools
import string
import sys
from abc import ABC, abstractmethod
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, ClassVar

from lightflyer.program.operations import UnsupportedError
from lightflyer.program.scalar.graph import (
    CHOICE,
    INFIX,
    PREFIX,
    PRIMARY,
    Loop,
    Node,
    Scope,
    Table,
)

Written = tuple[str, int]
"""An expression, and how closely it binds."""

_LONGEST = 400  # characters of an expression; a longer one gets a name
_DEEPEST = 20_000  # nodes above each other


class Language(ABC):
    """How a language writes what a function is made of."""

    name: ClassVar[str]
    reserved: ClassVar[frozenset[str]]
    """Words that cannot be names, of those made of letters and digits that begin with no T."""
    signs: ClassVar[dict[str, str]]
    """Of operations: those of :data:`~lightflyer.program.scalar.graph.INFIX` and prefixes."""
    functions: ClassVar[dict[str, str]]

    @abstractmethod
    def number(self, value: Any) -> str:
        """A constant, to the last bit."""

    @abstractmethod
    def choice(self, condition: str, true: str, false: str) -> str:
        """One of two; all bind more closely than it, but for the last."""

    @abstractmethod
    def negation(self, operand: str) -> Written:
        """Logical negation of an operand that binds more closely than a prefix."""

    @abstractmethod
    def table(self, values: Sequence[Any] | Table) -> str:
        """Name of an array of constants."""

    @abstractmethod
    def definition(self, name: str, text: str) -> str:
        """The line that gives a value its name for good."""

    @abstractmethod
    def loop(self, start: list[tuple[str, str]], body: list[str]) -> list[str]:
        """Lines of a loop without an end of its own; ``start``: its variables."""

    @abstractmethod
    def stop(self, condition: str) -> str:
        """The line that ends a loop where a condition does not hold."""

    @abstractmethod
    def change(self, name: str, text: str) -> str:
        """The line that changes a variable of a loop."""

    @abstractmethod
    def function(
        self, name: str, arguments: Sequence[str], body: list[str], results: Sequence[str]
    ) -> str:
        """The whole function."""

    def maker(self, parameters: Sequence[str], body: list[str], name: str, function: str) -> str:
        """A function of parameters that makes the function; where there are none, that alone."""
        del body, name
        if parameters:
            raise UnsupportedError(f"parameters are not written in {self.name} yet")
        return function


def names(reserved: frozenset[str]) -> Iterator[str]:
    """Short names, in order."""
    for length in itertools.count(1):
        for first, *rest in itertools.product(
            string.ascii_letters,
            *[string.ascii_letters + string.digits] * (length - 1),
        ):
            name = first + "".join(rest)
            if name not in reserved and not name.startswith("T"):
                yield name


def write_graph(
    name: str,
    arguments: list[Node],
    results: list[Node],
    language: Language,
    parameters: Sequence[Node] = (),
) -> str:
    """A function of numbers that returns a list of them; of parameters, one that makes it."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(max(limit, _DEEPEST))
    try:
        return _Writer(arguments, results, language, parameters).function(name)
    finally:
        sys.setrecursionlimit(limit)


class _Writer:
    def __init__(
        self,
        arguments: list[Node],
        results: list[Node],
        language: Language,
        parameters: Sequence[Node],
    ):
        self._arguments, self._results, self._language = arguments, results, language
        self._parameters = parameters
        self._fresh = names(language.reserved)
        self._live = _Live(results)
        self._lines: defaultdict[Scope, list[str]] = defaultdict(list)
        self._texts: dict[Node, Written] = {
            node: (next(self._fresh), PRIMARY) for node in (*arguments, *parameters)
        }

    def function(self, name: str) -> str:
        root = self._arguments[0].scope
        found = [self._text(node) for node in self._results]
        given, known = (
            [self._texts[node][0] for node in nodes]
            for nodes in (self._arguments, self._parameters)
        )
        before = [lines for scope, lines in self._lines.items() if scope.depth == 0]
        function = self._language.function(name, given, self._lines[root], found)
        return self._language.maker(known, before[0] if before else [], name, function)

    def _text(self, node: Node, least: int = 0) -> str:
        """A node in an expression that binds as closely as ``least``."""
        text, precedence = self._expression(node)
        return f"({text})" if precedence < least else text

    def _expression(self, node: Node) -> Written:
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
                self._lines[node.scope].append(self._language.definition(name, written[0]))
                self._texts[node] = name, PRIMARY
        return self._texts[node]

    def _written(self, node: Node) -> Written:
        language, operation = self._language, node.operation
        if node.is_constant:
            text = language.number(node.data)
            return text, PREFIX if text.startswith("-") else PRIMARY
        if operation == "choice":
            condition, true, false = node.operands
            above = CHOICE + 1
            parts = self._text(condition, above), self._text(true, above), self._text(false)
            return language.choice(*parts), CHOICE
        if operation == "real":
            return self._expression(node.operands[0])
        if operation == "listing":
            return f"({','.join(map(self._text, node.operands))},)", PRIMARY
        if operation in ("table", "pick"):
            *listing, place = map(self._text, node.operands)
            return f"{listing[0] if listing else language.table(node.data)}[{place}]", PRIMARY
        if operation == "not":
            return language.negation(self._text(node.operands[0], PREFIX + 1))
        if operation in language.functions:
            arguments = ",".join(map(self._text, node.operands))
            return f"{language.functions[operation]}({arguments})", PRIMARY
        if operation not in language.signs:
            raise UnsupportedError(f'operation "{operation}" is not written in {language.name} yet')
        sign = language.signs[operation]
        if operation not in INFIX:
            return f"{sign}{self._text(node.operands[0], PREFIX + 1)}", PREFIX
        one, other = node.operands
        precedence = INFIX[operation]
        # sums and products are not associative in floating point, and a comparison of a comparison
        # may be another thing; two signs would be one
        left = self._text(one, precedence + (precedence == INFIX["eq"]))
        right = self._text(other, precedence + 1)
        right = f"({right})" if right.startswith(("-", "+")) else right
        return f"{left}{sign}{right}", precedence

    def _loop(self, loop: Loop, outer: Scope) -> None:
        kept = self._live.variables(loop)
        for place in kept:
            self._texts[loop.variables[place]] = next(self._fresh), PRIMARY
        start = [
            (self._text(loop.variables[place]), self._text(loop.start[place])) for place in kept
        ]
        lines = self._lines[loop.scope]
        assert loop.condition is not None
        lines.append(self._language.stop(self._text(loop.condition, PREFIX + 1)))
        changed = [place for place in kept if loop.following[place] is not loop.variables[place]]
        new = [self._text(loop.following[place]) for place in changed]
        fresh = [next(self._fresh) for _ in changed]
        # all at once: none may see what another has become
        lines += map(self._language.definition, fresh, new)
        lines += [
            self._language.change(self._text(loop.variables[place]), name)
            for place, name in zip(changed, fresh, strict=True)
        ]
        self._lines[outer] += self._language.loop(start, lines)
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
