"""What a model computes, number by number: a graph of scalar operations.

Equal operations on equal operands are one node, and what is known is computed at once. Every node
lies in the outermost loop in which all its operands exist, so that no loop repeats what does not
change in it.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np


class UnsupportedError(Exception):
    """An operation that is not written in JavaScript yet."""

    def __init__(self, what: str):
        super().__init__(f"{what} is not written in JavaScript yet")


OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.true_divide,
    "rem": np.fmod, "neg": np.negative, "abs": np.abs, "sign": np.sign, "pow": np.power,
    "max": np.maximum, "min": np.minimum, "lt": np.less, "le": np.less_equal, "gt": np.greater,
    "ge": np.greater_equal, "eq": np.equal, "ne": np.not_equal, "and": np.logical_and,
    "or": np.logical_or, "xor": np.logical_xor, "not": np.logical_not,
    "is_finite": np.isfinite, "number": int, "floor": np.floor, "ceil": np.ceil,
    "trunc": lambda value: int(value) if np.isfinite(value) else value,
    "sqrt": np.sqrt, "cbrt": np.cbrt, "exp": np.exp, "expm1": np.expm1, "log": np.log,
    "log1p": np.log1p, "sin": np.sin, "cos": np.cos, "tan": np.tan, "asin": np.arcsin,
    "acos": np.arccos, "atan": np.arctan, "atan2": np.arctan2, "sinh": np.sinh, "cosh": np.cosh,
    "tanh": np.tanh, "asinh": np.arcsinh,
}  # fmt: skip
"""Operations on numbers that are known; beside them are constants, choices, looks into tables,
variables, and results of loops."""

_OF_TRUTH = {"and", "or", "xor", "not", "eq", "ne", "number", "choice"}  # take it as it is
_TRUTH = {"and", "or", "xor", "not", "eq", "ne", "lt", "le", "gt", "ge", "is_finite"}
_WHOLE = {"number", "trunc", "search"}
_OF_OPERANDS = {"add", "sub", "mul", "rem", "neg", "abs", "sign", "max", "min"}

_SAME = {("add", 0), ("sub", 0), ("mul", 1), ("div", 1), ("and", True), ("or", False)}
_FIXED = {("and", False), ("or", True)}


@dataclass(eq=False, slots=True)
class Scope:
    """The function itself, at depth 0, or the body of a loop."""

    depth: int


@dataclass(eq=False, slots=True)
class Node:
    """One number; nothing changes it."""

    operation: str
    operands: "tuple[Node, ...]"
    data: Any  # Value of a constant, values of a table, loop and place of a variable or a result
    scope: Scope
    kind: str  # ``"f"`` for a real number, ``"i"`` for a whole one, ``"b"`` for a truth value
    serial: int  # Operands come before

    @property
    def is_constant(self) -> bool:
        return self.operation == "constant"


@dataclass(eq=False)
class Loop:
    """Variables that change together for as long as a condition holds."""

    scope: Scope
    outer: Scope
    start: list[Node]
    variables: list[Node] = field(default_factory=list)
    condition: Node | None = None
    tested: int = 0  # serial number of the last node that the condition may need
    following: list[Node] = field(default_factory=list)


class Graph:
    """All nodes of one function."""

    def __init__(self) -> None:
        self.scope = self.root = Scope(0)
        self._nodes: dict[Any, Node] = {}
        self._tables: dict[Any, tuple[Any, ...]] = {}
        self.last = 0  # serial number of the newest node

    def constant(self, value: Any) -> Node:
        """A number or truth value that is known."""
        plain = value.item() if isinstance(value, np.generic | np.ndarray) else value
        kind = "b" if isinstance(plain, bool) else "i" if isinstance(plain, int) else "f"
        if kind == "i":
            plain = int(plain)  # of a member of an enumeration
        # the text tells 0.0 from -0.0, and finds NaN again
        return self._node("constant", (), plain, kind, (kind, repr(plain)))

    def variable(self, kind: str = "f", data: Any = None, scope: Scope | None = None) -> Node:
        """A number that a caller gives, or that a loop changes."""
        return self._new("variable", (), data, scope or self.scope, kind)

    def apply(self, name: str, *operands: Node) -> Node:
        """One of :data:`OPERATIONS`, or ``choice`` of a truth value and two numbers."""
        if name not in _OF_TRUTH or len({one.kind == "b" for one in operands[-2:]}) > 1:
            first = name == "choice"  # the truth value that chooses stays one
            operands = *operands[:first], *(self.real(one) for one in operands[first:])
        if name == "choice":
            return self._choice(*operands)
        if all(one.is_constant for one in operands):
            with np.errstate(all="ignore"):
                known = OPERATIONS[name](*(one.data for one in operands))
            return self.constant(known)
        whole = name in _OF_OPERANDS and all(one.kind == "i" for one in operands)
        kind = "b" if name in _TRUTH else "i" if whole or name in _WHOLE else "f"
        return self._simpler(name, *operands) or self._node(name, operands, None, kind)

    def real(self, node: Node) -> Node:
        """A truth value as a number."""
        return self.apply("number", node) if node.kind == "b" else node

    def _choice(self, condition: Node, true: Node, false: Node) -> Node:
        if condition.is_constant:
            return true if condition.data else false
        if true is false:
            return true
        if condition.operation == "not":
            return self._choice(condition.operands[0], false, true)
        if true.kind == "b" and true.is_constant:
            first = condition if true.data else self.apply("not", condition)
            return self.apply("or" if true.data else "and", first, false)
        if false.kind == "b" and false.is_constant and not false.data:
            return self.apply("and", condition, true)
        kind = "f" if "f" in (true.kind, false.kind) else true.kind
        return self._node("choice", (condition, true, false), None, kind)

    def _simpler(self, name: str, one: Node, other: Node | None = None) -> Node | None:
        """What the same number is found by more easily."""
        # the sign of a zero is not told apart: no result is the reciprocal of one
        if other is None:
            return one.operands[0] if name in ("neg", "not") and one.operation == name else None
        left = (name, one.data) if one.is_constant else None
        right = (name, other.data) if other.is_constant else None
        if right in _SAME or (name in ("and", "or", "max", "min") and one is other):
            return one
        if left in _SAME - {("sub", 0), ("div", 1)}:
            return other
        if left in _FIXED or right in _FIXED:
            return one if left in _FIXED else other
        if left in (("sub", 0), ("mul", -1)):
            return self.apply("neg", other)
        if right in (("mul", -1), ("div", -1)):
            return self.apply("neg", one)
        if other.operation == "neg" and name in ("add", "sub"):
            return self.apply("sub" if name == "add" else "add", one, other.operands[0])
        if one.operation == "neg" and name == "add":
            return self.apply("sub", other, one.operands[0])
        return None

    def element(self, values: Sequence[Node], index: Node) -> Node:
        """One of many numbers, by an index that is within range."""
        if index.is_constant:
            return values[index.data]
        if all(value.is_constant for value in values):
            return self.look_up(tuple(value.data for value in values), index)
        found = values[-1]
        for place in reversed(range(len(values) - 1)):
            here = self.apply("eq", index, self.constant(place))
            found = self.apply("choice", here, values[place], found)
        return found

    def look_up(self, table: tuple[Any, ...], index: Node) -> Node:
        """A number of a table, by an index that is within range."""
        if index.is_constant:
            return self.constant(table[index.data])
        kind = self.constant(table[0]).kind
        if kind == "b":
            return self.apply("ne", self.look_up(tuple(map(int, table)), index), self.constant(0))
        table = self._tables.setdefault(table, table)
        return self._node("table", (index,), table, kind, (kind, id(table)))

    def search(self, about: tuple[tuple[float, ...], str], value: Node) -> Node:
        """How many numbers of a table, in rising order, are before a value, on a side of it."""
        table, side = about
        if value.is_constant:
            return self.constant(np.searchsorted(table, value.data, side))
        table = self._tables.setdefault(table, table)
        return self._node("search", (value,), (table, side), "i", (id(table), side))

    # --- loops ---

    def loop(self, start: list[Node]) -> Loop:
        """Begin a loop; what is recorded from now on is its body, up to :meth:`end`."""
        made = Loop(Scope(self.scope.depth + 1), self.scope, start)
        made.variables = [
            self.variable(node.kind, (made, place), made.scope) for place, node in enumerate(start)
        ]
        self.scope = made.scope
        return made

    def end(self, loop: Loop) -> list[Node]:
        """What the variables of a loop are after it."""
        self.scope = loop.outer
        return [
            self._new("result", (), (loop, place), loop.outer, node.kind)
            for place, node in enumerate(loop.start)
        ]

    # --- what follows from others ---

    def replace(self, nodes: list[Node], old: Node, new: Node) -> list[Node]:
        """The same nodes of another number in place of a variable."""
        made = {old: new}
        for node in in_order(nodes):
            if node not in made:
                operands = tuple(made[one] for one in node.operands)
                if operands == node.operands:
                    made[node] = node
                elif node.data is None:
                    made[node] = self.apply(node.operation, *operands)
                else:
                    look = self.look_up if node.operation == "table" else self.search
                    made[node] = look(node.data, *operands)
        return [made[node] for node in nodes]

    def _node(
        self, name: str, operands: tuple[Node, ...], data: Any, kind: str, beside: Any = None
    ) -> Node:
        key = name, *map(id, operands), beside
        known = self._nodes.get(key)
        if known is None:
            scope = max((one.scope for one in operands), key=lambda s: s.depth, default=self.root)
            known = self._nodes[key] = self._new(name, operands, data, scope, kind)
        return known

    def _new(self, *about: Any) -> Node:
        self.last += 1
        return Node(*about, self.last)


def in_order(nodes: Iterable[Node], *, in_loops: bool = False) -> list[Node]:
    """Some nodes and all that they are made of, operands first."""
    found: set[Node] = set()
    waiting = list(nodes)
    while waiting:
        node = waiting.pop()
        if node in found:
            continue
        found.add(node)
        waiting += node.operands
        if in_loops and node.operation == "result":
            loop = node.data[0]
            waiting += [*loop.start, loop.condition, *loop.following]
    return sorted(found, key=lambda node: node.serial)
