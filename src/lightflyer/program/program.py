"""A program: operations on arrays in the order in which they run, as plain data.

Values are numbered. Every value is made by one operation, is an input or is a constant. A length
is a whole number or an expression of symbols such as ``"n"`` and ``"n + 1"``; symbols are bound
when the program runs.
"""

import ast
import hashlib
import json
import math
import operator
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lightflyer.program import horner, spline

ROWS = "n0"  # Symbol of the axis along which elements lie
LOOKED_UP = "gather", "dynamic_slice"  # Operations that look up some elements of their first input
FORMAT = 2  # Version of the form in which programs are written
SYMBOLS = ("n0", "n1", "n2", "n3")  # Lengths that a program is traced without

_STEP_COUNTS: dict[str, Callable[..., int]] = {
    horner.NAME: horner.step_count,
    spline.NAME: spline.step_count,
}

Length: TypeAlias = int | str  # Number of elements along an axis, or an expression of symbols


class Operation(NamedTuple):
    """One step of a program."""

    name: str  # What is done, by JAX's name for it where it has one
    inputs: tuple[int, ...]  # Numbers of values
    outputs: tuple[int, ...]  # Numbers of values
    parameters: Mapping[str, Any]  # Of strings, numbers, lists and None
    blocks: "tuple[Block, ...]" = ()  # Bodies of a loop or of a choice

    @property
    def steps(self) -> int:
        """How many multiplications, or other steps as small, it takes."""
        count = _STEP_COUNTS.get(self.name)
        return 1 if count is None else count(**self.parameters)


class Block(NamedTuple):
    """Operations that run together, such as the body of a loop."""

    # Values that are set before it runs. It may read all values around it, too
    arguments: tuple[int, ...]
    operations: tuple[Operation, ...]
    results: tuple[int, ...]  # Values that are read after it

    @property
    def steps(self) -> int:
        """Steps of its operations, without those of blocks in them."""
        return sum(operation.steps for operation in self.operations)

    def reads(self) -> set[int]:
        """Values that it reads, its own included."""
        found = set(self.results)
        for operation in self.operations:
            found.update(operation.inputs, *(block.reads() for block in operation.blocks))
        return found

    def makes(self) -> set[int]:
        """Values that it sets, its arguments included."""
        found = set(self.arguments)
        for operation in self.operations:
            found.update(operation.outputs, *(block.makes() for block in operation.blocks))
        return found


@dataclass(frozen=True, eq=False)
class Program:
    """What a function computes."""

    body: Block  # Its arguments are the inputs, its results the outputs
    constants: dict[int, np.ndarray]  # Values that are known
    input_shapes: tuple[tuple[Length, ...], ...]  # Lengths of the axes of each input and output
    output_shapes: tuple[tuple[Length, ...], ...]
    output_types: tuple[str, ...]  # Types of the elements of the outputs, as NumPy writes them
    # Values with :data:`ROWS` as their one axis, of those that no arithmetic makes
    rows: frozenset[int] = frozenset()
    _prepared: dict[Any, Any] = field(default_factory=dict, repr=False)

    @cached_property
    def size(self) -> int:
        """Number of steps, those of loops and choices included."""
        return _size(self.body)

    @cached_property
    def names(self) -> frozenset[str]:
        return frozenset(_names(self.body))

    @property
    def single(self) -> set[int]:
        """Inputs and constants that have no axes."""
        inputs = zip(self.body.arguments, self.input_shapes, strict=True)
        single = {number for number, shape in inputs if not shape}
        return single | {number for number, array in self.constants.items() if not array.ndim}

    @cached_property
    def tables(self) -> tuple[bool, ...]:
        """Of which inputs only some elements are looked up, or none."""
        read = _read_whole(self.body)
        return tuple(number not in read for number in self.body.arguments)

    def prepare_once(self, what: Any, prepare: "Callable[[Program], Any]") -> Any:
        """What follows from the program, such as what a backend makes of it, made once."""
        if what not in self._prepared:
            self._prepared[what] = prepare(self)
        return self._prepared[what]

    def lengths(self, shapes: Sequence[tuple[int, ...]]) -> dict[str, int]:
        """Values of the symbols, for inputs of some shapes."""
        found: dict[str, int] = {}
        for stated, actual in zip(self.input_shapes, shapes, strict=True):
            for length, number in zip(stated, actual, strict=False):  # none stated: any serves
                if isinstance(length, str) and length.isidentifier():
                    found[length] = number
        return found

    def to_bytes(self, salt: bytes = b"") -> bytes:
        """The program as a file has it: a hash, operations in JSON, the bytes of constants."""
        tree = {
            "format": FORMAT,
            "body": _block_as_data(self.body),
            "constants": [
                [number, array.dtype.str, array.shape] for number, array in self.constants.items()
            ],
            "input_shapes": self.input_shapes,
            "output_shapes": self.output_shapes,
            "output_types": self.output_types,
            "rows": sorted(self.rows),
        }
        text = json.dumps(tree, separators=(",", ":"), default=operator.index).encode()
        arrays = b"".join(array.tobytes() for array in self.constants.values())
        content = zlib.compress(len(text).to_bytes(4, "little") + text + arrays)
        return hashlib.sha256(salt + content).digest() + content

    @classmethod
    def from_bytes(cls, content: bytes, salt: bytes = b"") -> "Program":
        """Read what :meth:`to_bytes` wrote."""
        digest, content = content[:32], content[32:]
        if hashlib.sha256(salt + content).digest() != digest:
            raise ValueError("the program is damaged")
        content = zlib.decompress(content)
        place = 4 + int.from_bytes(content[:4], "little")
        tree = json.loads(content[4:place])
        if tree["format"] != FORMAT:
            raise ValueError("the program is of another format")
        constants = {}
        for number, kind, shape in tree["constants"]:
            count = math.prod(shape)
            array = np.frombuffer(content, kind, count, place).reshape(shape)
            constants[number] = array
            place += array.nbytes
        return cls(
            body=_block_of_data(tree["body"]),
            constants=constants,
            input_shapes=tuple(map(tuple, tree["input_shapes"])),
            output_shapes=tuple(map(tuple, tree["output_shapes"])),
            output_types=tuple(tree["output_types"]),
            rows=frozenset(tree["rows"]),
        )


def _read_whole(block: Block) -> set[int]:
    """Values of which an operation reads all elements."""
    found = set(block.results)
    for operation in block.operations:
        found.update(
            operation.inputs[operation.name in LOOKED_UP :], *map(_read_whole, operation.blocks)
        )
    return found


def _size(block: Block) -> int:
    inner = (part for operation in block.operations for part in operation.blocks)
    return block.steps + sum(map(_size, inner))


def _names(block: Block) -> set[str]:
    found = {operation.name for operation in block.operations}
    return found.union(
        *(_names(part) for operation in block.operations for part in operation.blocks)
    )


def _block_as_data(block: Block) -> list[Any]:
    operations = [
        [name, inputs, outputs, dict(parameters), list(map(_block_as_data, blocks))]
        for name, inputs, outputs, parameters, blocks in block.operations
    ]
    return [block.arguments, operations, block.results]


def _block_of_data(data: list[Any]) -> Block:
    arguments, operations, results = data
    return Block(
        tuple(arguments),
        tuple(
            Operation(
                name,
                tuple(inputs),
                tuple(outputs),
                parameters,
                tuple(map(_block_of_data, blocks)),
            )
            for name, inputs, outputs, parameters, blocks in operations
        ),
        tuple(results),
    )


_ARITHMETIC: dict[Any, Callable[..., int]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Pow: operator.pow,
}
_FUNCTIONS: dict[str, Callable[..., int]] = {
    "floordiv": operator.floordiv,
    "mod": operator.mod,
    "max": max,
    "min": min,
}


def length_of(length: Length, symbols: Mapping[str, int]) -> int:
    """Value of a length."""
    if isinstance(length, int):
        return length
    if length in symbols:
        return symbols[length]
    return _evaluate(ast.parse(length, mode="eval").body, symbols)


def _evaluate(node: ast.expr, symbols: Mapping[str, int]) -> int:
    match node:
        case ast.Constant(value=int(value)):
            return value
        case ast.Name(id=name):
            return symbols[name]
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_evaluate(inner, symbols)
        case ast.BinOp(left=left, op=sign, right=right):
            return _ARITHMETIC[type(sign)](_evaluate(left, symbols), _evaluate(right, symbols))
        case ast.Call(func=ast.Name(id=name), args=args):
            return _FUNCTIONS[name](*(_evaluate(arg, symbols) for arg in args))
    raise ValueError(f"not a length: {ast.unparse(node)}")
