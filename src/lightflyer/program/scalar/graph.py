"""A graph of scalar operations: what a traced function computes, number by number.

Equal operations on equal operands are one node, and what is known is computed at once. Every node
lies in the outermost loop in which all its operands exist, so that no loop repeats what does not
change in it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lightflyer.program.operations import ELEMENTWISE

PRIMARY, PREFIX, PRODUCT, SUM, ORDER, AND, OR, CHOICE = 20, 14, 12, 11, 8, 4, 3, 2
"""How closely operators bind; higher binds closer."""

INFIX = {
    "add": SUM,
    "sub": SUM,
    "mul": PRODUCT,
    "div": PRODUCT,
    "rem": PRODUCT,
    "lt": ORDER,
    "le": ORDER,
    "gt": ORDER,
    "ge": ORDER,
    "eq": ORDER,
    "ne": ORDER,
    "and": AND,
    "or": OR,
}
"""Operations that may be written between their operands; others are functions or signs."""

FOLDS: dict[str, Any] = {
    **ELEMENTWISE,
    "number": int,
    "trunc": lambda value: np.asarray(value).astype(np.int64)[()],
}
"""All operations but constants, choices, look-ups in tables and what belongs to loops, on NumPy's
numbers."""

_TRUTH = {"lt", "le", "gt", "ge", "eq", "ne", "le_to", "and", "or", "not", "is_finite"}
_WHOLE = {"number", "trunc"}
_OF_OPERANDS = {"add", "sub", "mul", "rem", "neg", "abs", "sign", "max", "min"}

_SAME = {"add": -0.0, "sub": 0.0, "mul": 1, "div": 1}  # right operands that change nothing


@dataclass(eq=False, slots=True)
class Scope:
    """The body of a loop, the function itself, at depth 1, or what is known before it, at 0."""

    depth: int


@dataclass(eq=False, slots=True)
class Node:
    """One scalar; nothing changes it."""

    # A key of :data:`FOLDS`, or ``constant``, ``choice``, ``table``, ``listing``, ``pick``,
    # ``variable``, ``result``
    operation: str
    operands: "tuple[Node, ...]"
    data: Any  # Value of a constant, values of a table, place of a loop's result
    scope: Scope
    kind: str  # ``"f"`` for a real number, ``"i"`` for a whole one, ``"b"`` for a truth value

    @property
    def is_constant(self) -> bool:
        """Whether its value is known."""
        return self.operation == "constant"


@dataclass(frozen=True, eq=False)
class Table:
    """A table whose numbers are given before the function is used."""

    kind: str  # Of its numbers, as of a node


@dataclass(eq=False)
class Loop:
    """Variables that change together for as long as a condition holds."""

    scope: Scope
    start: list[Node]
    variables: list[Node] = field(default_factory=list)
    condition: Node | None = None
    following: list[Node] = field(default_factory=list)


class Graph:
    """All nodes of one function."""

    def __init__(self) -> None:
        self._before, self._root = Scope(0), Scope(1)
        self._nodes: dict[Any, Node] = {}
        self._tables: dict[tuple[Any, ...], tuple[Any, ...]] = {}

    def constant(self, value: Any) -> Node:
        """A number or truth value that is known."""
        plain = value.item() if isinstance(value, np.generic) else value
        # the text tells 0.0 from -0.0, and finds NaN again
        return self._node("constant", (), plain, key=(type(plain), repr(plain)))

    def variable(self, kind: str, scope: Scope | None = None) -> Node:
        """A number that a caller gives, or that a loop changes."""
        return Node("variable", (), None, scope or self._root, kind)

    def parameter(self, kind: str) -> Node:
        """A number that is given before the function is used."""
        return self.variable(kind, self._before)

    def real(self, node: Node) -> Node:
        """A whole number as a real one."""
        if node.is_constant:
            return self.constant(float(node.data))
        return self._node("real", (node,))

    def operation(self, name: str, *operands: Node) -> Node:
        """One of :data:`FOLDS`."""
        if all(operand.is_constant for operand in operands):
            with np.errstate(all="ignore"):
                return self.constant(FOLDS[name](*(np.asarray(one.data)[()] for one in operands)))
        if name in _SAME and operands[1].is_constant:
            value, same = operands[1].data, _SAME[name]
            if value == same and math.copysign(1.0, value) == math.copysign(1.0, same):
                return operands[0]
        whole = all(operand.kind == "i" for operand in operands)
        if name == "add" and whole and operands[1].is_constant and operands[1].data == 0:
            return operands[0]
        if name == "mul" and operands[0].is_constant and operands[0].data == 1:
            return operands[1]
        return self._node(name, operands)

    def choice(self, condition: Node, true: Node, false: Node) -> Node:
        """One of two numbers."""
        if condition.is_constant:
            return true if condition.data else false
        return true if true is false else self._node("choice", (condition, true, false))

    def element(self, values: list[Node], index: Node) -> Node:
        """One of many numbers, by an index that is within range."""
        if index.is_constant:
            return values[int(index.data)]
        if all(value.is_constant for value in values):
            table = tuple(value.data for value in values)
            return self.row(self._tables.setdefault(table, table), index)
        if all(value.scope is self._before for value in values):
            return self._node("pick", (self._node("listing", tuple(values)), index))
        found = values[-1]
        for place in reversed(range(len(values) - 1)):
            here = self.operation("eq", index, self.constant(place))
            found = self.choice(here, values[place], found)
        return found

    def row(self, table: Sequence[Any] | Table, index: Node) -> Node:
        """A number of a table that lives on, by an index that is within range."""
        if index.is_constant and not isinstance(table, Table):
            return self.constant(table[int(index.data)])
        return self._node("table", (index,), table, key=id(table))

    def loop(self, start: list[Node], outer: Scope | None) -> Loop:
        """Open a loop; its condition and what follows are to be filled in."""
        scope = Scope((outer or self._root).depth + 1)
        return Loop(scope, start, [self.variable(node.kind, scope) for node in start])

    def results(self, loop: Loop, outer: Scope | None) -> list[Node]:
        """What the variables of a loop are after it."""
        places = range(len(loop.variables))
        return [
            Node("result", (), (loop, place), outer or self._root, loop.start[place].kind)
            for place in places
        ]

    def _node(
        self, operation: str, operands: tuple[Node, ...], data: Any = None, key: Any = None
    ) -> Node:
        key = operation, *map(id, operands), data if key is None else key
        known = self._nodes.get(key)
        if known is None:
            scope = self._before
            for operand in operands:
                if operand.scope.depth > scope.depth:
                    scope = operand.scope
            known = Node(operation, operands, data, scope, _kind(operation, operands, data))
            self._nodes[key] = known
        return known


def _kind(operation: str, operands: tuple[Node, ...], data: Any) -> str:
    """Kind of the number that an operation gives."""
    if isinstance(data, Table):
        return data.kind
    if operation in ("constant", "table"):
        value = data[0] if operation == "table" else data
        return "b" if isinstance(value, bool) else "i" if isinstance(value, int) else "f"
    if operation in _TRUTH:
        return "b"
    if operation in _WHOLE:
        return "i"
    if operation == "choice":
        return operands[1].kind
    if operation in ("listing", "pick"):
        return operands[0].kind
    whole = operation in _OF_OPERANDS and all(operand.kind == "i" for operand in operands)
    return "i" if whole else "f"
