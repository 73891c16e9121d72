"""What a recorder has recorded, as a function in JavaScript."""

import itertools
import math
import string
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from typing import Any

from .graph import Graph, Loop, Node, Scope

_PRIMARY, _PREFIX, _ORDER, _EQUAL, _CHOICE = 20, 14, 9, 8, 2  # how closely operators bind
_INFIX = {
    "add": ("+", 11), "sub": ("-", 11), "mul": ("*", 12), "div": ("/", 12), "rem": ("%", 12),
    "lt": ("<", _ORDER), "le": ("<=", _ORDER), "gt": (">", _ORDER), "ge": (">=", _ORDER),
    "eq": ("===", _EQUAL), "ne": ("!==", _EQUAL), "xor": ("!==", _EQUAL),
    "and": ("&&", 4), "or": ("||", 3),
}  # fmt: skip
_PREFIXES = {"neg": "-", "not": "!", "number": "+"}
_RESERVED = {"do", "if", "in", "of", "for", "let", "new", "try", "var", "NaN"}
_LONGEST = 400  # characters of an expression; a longer one gets a name

Written = tuple[str, int]
"""An expression, and how closely it binds."""

_SEARCH = {
    side: f"function {name}(t,x){{let a=0,b=t.length;while(a<b){{const m=a+b>>1;"
    f"if(t[m]{sign}x)a=m+1;else b=m}}return a}}\n"
    for side, name, sign in (("left", "TL", "<"), ("right", "TR", "<="))
}


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
        self.sides: set[str] = set()  # of searches in them

    def name(self, values: tuple[Any, ...]) -> str:
        """Name of an array."""
        return self._names.setdefault(values, f"T{len(self._names)}")

    def text(self) -> str:
        """The declarations."""
        listed = {name: ",".join(map(number, values)) for values, name in self._names.items()}
        tables = [f"const {name}=new Float64Array([{text}]);\n" for name, text in listed.items()]
        return "".join([*(_SEARCH[side] for side in sorted(self.sides)), *tables])


def write_function(
    name: str, graph: Graph, arguments: Sequence[Node], results: Sequence[Node], tables: Tables
) -> str:
    """A function of numbers that returns an array of them; ``tables``: where constants go."""
    return _Writer(graph, arguments, results, tables).function(name)


def _names() -> Iterator[str]:
    """Short names, in order; those that begin with T are of tables."""
    letters, others = string.ascii_letters.replace("T", ""), string.ascii_letters + string.digits
    for length in itertools.count(0):
        for first in letters:
            for rest in itertools.product(others, repeat=length):
                name = first + "".join(rest)
                if name not in _RESERVED:
                    yield name


class _Writer:
    def __init__(
        self, graph: Graph, arguments: Sequence[Node], results: Sequence[Node], tables: Tables
    ):
        self._graph, self._arguments, self._results = graph, arguments, results
        self._tables, self._fresh = tables, _names()
        self._uses: Counter[Node] = Counter()
        self._named: set[Node] = set()  # used where they are not computed
        self._kept: defaultdict[Loop, set[int]] = defaultdict(set)  # variables with an effect
        self._visit()
        self._texts: dict[Node, Written] = {}
        # of each scope, with the serial number of what they compute
        self._lines: defaultdict[Scope, list[tuple[int, str]]] = defaultdict(list)
        self._written: set[Loop] = set()

    def _visit(self) -> None:
        """Find what the results need, and how often."""
        waiting: list[tuple[Node, Scope]] = [(node, self._graph.root) for node in self._results]
        while waiting:
            node, scope = waiting.pop()
            self._uses[node] += 1
            if node.scope is not scope:
                self._named.add(node)
            if self._uses[node] > 1:
                continue
            waiting += [(operand, node.scope) for operand in node.operands]
            if node.data is None or node.operation not in ("result", "variable"):
                continue
            loop, place = node.data
            if loop not in self._kept:
                waiting.append((loop.condition, loop.scope))
            if place not in self._kept[loop]:
                self._kept[loop].add(place)
                new = loop.following[place]
                waiting += [(loop.start[place], loop.outer), (new, loop.scope)]
                self._named.add(new)  # or a variable would change before another has seen it

    def function(self, name: str) -> str:
        self._texts |= {node: (next(self._fresh), _PRIMARY) for node in self._arguments}
        for loop in self._kept:
            for place in sorted(self._kept[loop]):
                self._texts[loop.variables[place]] = next(self._fresh), _PRIMARY
        for node in sorted(self._uses, key=lambda node: node.serial):
            if node not in self._texts:
                self._texts[node] = self._write(node)
        given = ",".join(self._text(node) for node in self._arguments)
        found = ",".join(self._text(node) for node in self._results)
        lines = [text for _, text in self._lines[self._graph.root]]
        return "\n".join([f"function {name}({given}){{", *lines, f"return [{found}];", "}\n"])

    def _text(self, node: Node, least: int = 0) -> str:
        """A node in an expression that binds as closely as ``least``."""
        text, precedence = self._texts[node]
        return f"({text})" if precedence < least else text

    def _write(self, node: Node) -> Written:
        if node.operation == "result":
            loop, place = node.data
            if loop not in self._written:
                self._written.add(loop)
                self._lines[loop.outer].append((node.serial, self._loop(loop)))
            return self._texts[loop.variables[place]]
        written = self._expression(node)
        is_inline = self._uses[node] == 1 and node not in self._named
        if node.is_constant or (is_inline and len(written[0]) < _LONGEST):
            return written
        name = next(self._fresh)
        self._lines[node.scope].append((node.serial, f"const {name}={written[0]};"))
        return name, _PRIMARY

    def _expression(self, node: Node) -> Written:
        operation, operands = node.operation, node.operands
        if node.is_constant:
            text = number(node.data)
            return text, _PREFIX if text.startswith("-") else _PRIMARY
        if operation == "choice":
            above = _CHOICE + 1
            one, true = (self._text(operand, above) for operand in operands[:2])
            return f"{one}?{true}:{self._text(operands[2])}", _CHOICE
        if operation == "table":
            return f"{self._tables.name(node.data)}[{self._text(operands[0])}]", _PRIMARY
        if operation == "search":
            table, side = node.data
            self._tables.sides.add(side)
            text = f"T{side[0].upper()}({self._tables.name(table)},{self._text(operands[0])})"
            return text, _PRIMARY
        if operation in _PREFIXES:
            return f"{_PREFIXES[operation]}{self._text(operands[0], _PREFIX + 1)}", _PREFIX
        if operation in _INFIX:
            sign, precedence = _INFIX[operation]
            # sums and products are not associative in floating point, and a comparison of a
            # comparison may be another thing; two signs would be one
            left = self._text(operands[0], precedence + (precedence in (_ORDER, _EQUAL)))
            right = self._text(operands[1], precedence + (operation not in ("and", "or")))
            right = f"({right})" if right.startswith(("-", "+")) else right
            return f"{left}{sign}{right}", precedence
        name = "Number.isFinite" if operation == "is_finite" else f"Math.{operation}"
        return f"{name}({','.join(map(self._text, operands))})", _PRIMARY

    def _loop(self, loop: Loop) -> str:
        kept = sorted(self._kept[loop])
        lines = self._lines[loop.scope]
        names = [self._text(loop.variables[place]) for place in kept]
        starts = [self._text(loop.start[place]) for place in kept]
        before = [text for serial, text in lines if serial <= loop.tested]
        after = [text for serial, text in lines if serial > loop.tested]
        moved, aside = [], []
        for place, name in zip(kept, names, strict=True):
            new = loop.following[place]
            text = self._text(new)
            if text == name:
                continue
            if text in names:  # all change at once: none may see what another has become
                aside.append(f"const {(own := next(self._fresh))}={text};")
                text = own
            moved.append(f"{name}={text};")
        return "\n".join([
            f"let {','.join(f'{name}={text}' for name, text in zip(names, starts, strict=True))};",
            "for(;;){", *before, f"if(!{self._text(loop.condition, _PREFIX + 1)})break;", *after,
            *aside, *moved, "}",
        ])  # fmt: skip
