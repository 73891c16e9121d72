"""From a function to a program: all that is needed of JAX's inside.

JAX traces the function; here its jaxpr becomes a :class:`~lightflyer.program.program.Program`.
On the way equal operations become one, what is known is computed, calls are written out, what a
loop does not change moves out of it, and what no output needs is left out.
"""

import gc
import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial, reduce
from typing import Any

import numpy as np

from lightflyer.program import horner
from lightflyer.program.operations import UnsupportedError, evaluate
from lightflyer.program.primitives import PARAMETERS, is_concrete, length, lengths_of
from lightflyer.program.program import SYMBOLS, Block, Length, Operation, Program
from lightflyer.program.pruning import without_dead
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import Array, extend, jax, jnp

_LARGEST_FOLDED = 100_000  # elements: what is larger is computed when it is needed

_MOST_STEPS = 16  # Steps up to which a loop of a known number of steps is written out

_IDENTITIES = {
    "copy",
    "copy_p",
    "nonbatchable",
    "nondifferentiable_backward",
    "optimization_barrier",
    "pvary",
    "reduce_precision",
    "stop_gradient",
}
"""Operations that only matter to JAX's transformations."""

_RENAMED = {"add_any": "add", "expand_dims": "reshape", "scatter-add": "scatter_add",
            "shift_right_logical": "shift"}  # fmt: skip
_CALLS = ("jaxpr", "call_jaxpr", "fun_jaxpr")  # names of the parameter that holds what is called


def trace(
    function: Callable[..., Any], shapes: Sequence[tuple[Length, ...]], types: Sequence[Any]
) -> tuple[Program, Any]:
    """Trace a function of arrays, in double precision; returns ``program``, ``structure``."""
    symbols = _symbols()
    arguments = [
        jax.ShapeDtypeStruct(
            tuple(symbols[length] if isinstance(length, str) else length for length in shape), kind
        )
        for shape, kind in zip(shapes, types, strict=True)
    ]
    with _without_collection():
        closed, result = jax.make_jaxpr(function, return_shape=True)(arguments)
        return _Builder().build(closed), tree.structure(result)


def trace_numbers(function: Callable[..., Any], count: int) -> Program:
    """Trace a function of single numbers, in double precision."""
    return trace(lambda numbers: function(*numbers), [()] * count, [np.dtype(float)] * count)[0]


@contextmanager
def _without_collection() -> Iterator[None]:
    """Context without the collector of garbage, which takes a quarter of a trace's time."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


@cache
def _symbols() -> dict[str, Any]:
    """Symbols as JAX has them: the same for all traces, so that JAX finds what it traced before."""
    return dict(zip(SYMBOLS, jax.export.symbolic_shape(", ".join(SYMBOLS)), strict=True))


def with_parameters(
    function: Callable[..., Any], *examples: Any
) -> tuple[Callable[..., Any], list[Any]]:
    """A function that takes what it closes over as arguments; ``*examples``: like its arguments."""
    closed, result = jax.make_jaxpr(function, return_shape=True)(*examples)
    structure = jax.tree.structure(result)

    def converted(*given: Any) -> Any:
        args, parameters = given[: len(examples)], given[len(examples) :]
        run = extend.jaxpr_as_fun(extend.ClosedJaxpr(closed.jaxpr, parameters))
        return jax.tree.unflatten(structure, run(*jax.tree.leaves(args)))

    return converted, list(closed.consts)


class _Scope:
    """Operations of a block that is being built."""

    def __init__(self, depth: int, *, is_choice: bool = False):
        self.depth = depth
        self.is_choice = is_choice  # what is here must not run unless it is chosen
        self.operations: list[Operation] = []
        self.known: dict[Any, tuple[int, ...]] = {}
        self.called: dict[tuple[int, ...], tuple[Any, tuple[int, ...]]] = {}


class _Builder:
    """Numbers the values of a jaxpr and lists its operations."""

    def __init__(self) -> None:
        self._constants: dict[int, np.ndarray] = {}
        self._by_content: dict[Any, int] = {}
        self._scopes = [_Scope(0)]
        self._depths: list[int] = []
        self._rows: dict[int, list[int]] = {}  # of what was put together from rows
        self._along: set[int] = set()  # values whose one axis is that of the elements

    def build(self, closed: "extend.ClosedJaxpr") -> Program:
        inputs = [self._new(0) for _ in closed.jaxpr.invars]
        self._note_rows(closed.jaxpr.invars, inputs)
        outputs = self._run(closed, inputs)
        shapes = [variable.aval.shape for variable in closed.jaxpr.outvars]
        body = without_dead(Block(tuple(inputs), tuple(self._scopes[0].operations), tuple(outputs)))
        used = body.reads()
        return Program(
            body=body,
            constants={n: array for n, array in self._constants.items() if n in used},
            input_shapes=tuple(lengths_of(one.aval.shape) for one in closed.jaxpr.invars),
            output_shapes=tuple(map(lengths_of, shapes)),
            output_types=tuple(str(one.aval.dtype) for one in closed.jaxpr.outvars),
            rows=frozenset(self._along & used),
        )

    # --- values ---

    def _new(self, depth: int) -> int:
        self._depths.append(depth)
        return len(self._depths) - 1

    def _constant(self, value: Any) -> int:
        array = np.asarray(value)
        key = array.dtype.str, array.shape, array.tobytes()
        if key not in self._by_content:
            self._by_content[key] = self._new(0)
            self._constants[self._by_content[key]] = array
        return self._by_content[key]

    def _add(
        self,
        name: str,
        inputs: Sequence[int],
        count: int = 1,
        blocks: tuple[Block, ...] = (),
        **parameters: Any,
    ) -> list[int]:
        """Outputs of an operation, which is added where all that it reads exists."""
        operation = Operation(name, tuple(inputs), (), parameters, blocks)
        folded = None if blocks else self._fold(operation, count)
        if folded is not None:
            return folded
        depths = [self._depths[number] for number in inputs] + [*map(self._depth_of, blocks)]
        depths += [scope.depth for scope in self._scopes if scope.is_choice]
        scope = self._scopes[max(depths, default=0)]
        key = None if blocks else (name, tuple(inputs), repr(parameters) if parameters else "")
        if key is not None and key in scope.known:
            return list(scope.known[key])
        outputs = tuple(self._new(scope.depth) for _ in range(count))
        scope.operations.append(operation._replace(outputs=outputs))
        if key is not None:
            scope.known[key] = outputs
        return list(outputs)

    def _depth_of(self, block: Block) -> int:
        """Depth of the innermost value outside of a block that it reads."""
        inside = block.makes()
        return max((self._depths[n] for n in block.reads() - inside), default=0)

    def _fold(self, operation: Operation, count: int) -> list[int] | None:
        known = self._constants
        if not all(number in known for number in operation.inputs):
            return None
        if not is_concrete(operation.parameters):
            return None
        try:
            found = evaluate(
                operation._replace(outputs=(0,) * count),
                [known[number][()] for number in operation.inputs],
            )
        except UnsupportedError:
            return None
        if sum(np.size(value) for value in found) > _LARGEST_FOLDED:
            return None
        return [self._constant(value) for value in found]

    # --- equations ---

    def _run(self, closed: Any, inputs: Sequence[int]) -> list[int]:
        if not hasattr(closed, "consts"):
            closed = extend.ClosedJaxpr(closed, ())
        jaxpr: extend.Jaxpr = closed.jaxpr
        known: dict[Any, int] = {
            variable: self._constant(value)
            for variable, value in zip(jaxpr.constvars, closed.consts, strict=True)
        }
        known.update(zip(jaxpr.invars, inputs, strict=True))

        literal = extend.Literal

        def read(atom: Any) -> int:
            if isinstance(atom, literal):
                kind: Any = atom.aval
                return self._constant(np.asarray(atom.val, kind.dtype))
            return known[atom]

        for equation in jaxpr.eqns:
            found = self._equation(equation, [read(atom) for atom in equation.invars])
            self._note_rows(equation.outvars, found)
            known.update(zip(equation.outvars, found, strict=True))
        return [read(atom) for atom in jaxpr.outvars]

    def _call(self, called: Any, inputs: list[int]) -> list[int]:
        """Outputs of a function, which is written out unless it has been with the same inputs."""
        key = (id(called), *inputs)
        for scope in self._scopes:  # what is known around is known here
            if key in scope.called:
                return list(scope.called[key][1])
        found = self._run(called, inputs)
        self._scopes[-1].called[key] = called, tuple(found)  # held, so that no other has its key
        return found

    def _note_rows(self, variables: Sequence[Any], values: Sequence[int]) -> None:
        for variable, value in zip(variables, values, strict=True):
            shape: tuple[Any, ...] = getattr(variable.aval, "shape", ())
            if len(shape) == 1 and length(shape[0]) == SYMBOLS[0]:
                self._along.add(value)

    def _equation(self, equation: Any, inputs: list[int]) -> list[int]:
        name, given = equation.primitive.name, equation.params
        if name in _IDENTITIES:
            return inputs
        if name == "select_if_vmap":
            return [inputs[1]]
        if name.startswith("unvmap_"):
            return self._record_unmapped(name, equation, inputs)
        special = {
            "while": self._while,
            "scan": self._scan,
            "cond": self._cond,
            "custom_linear_solve": self._linear_solve,
            horner.NAME: self._polynomial,
        }
        if name in special:
            return special[name](equation, inputs)
        if name in ("call_hi_primitive", "polynomial"):
            return self._run(_expanded(equation), inputs)
        called = next((given[key] for key in _CALLS if key in given), None)
        if called is not None:
            return self._call(called, inputs)
        name = _RENAMED.get(name, name)
        if name == "convert_element_type" and (
            equation.invars[0].aval.dtype == equation.outvars[0].aval.dtype
        ):
            return inputs
        parameters = PARAMETERS[name](equation) if name in PARAMETERS else {}
        return self._add(name, inputs, len(equation.outvars), **parameters)

    def _record_unmapped(self, name: str, equation: Any, inputs: list[int]) -> list[int]:
        """Equinox's reductions over whatever a function is mapped over."""
        (shape,) = (variable.aval.shape for variable in equation.invars)
        kind = {"any": "or", "all": "and", "max": "max"}[name.removeprefix("unvmap_")]
        if not shape:
            return inputs
        return self._add(f"reduce_{kind}", inputs, axes=list(range(len(shape))))

    def _linear_solve(self, equation: Any, inputs: list[int]) -> list[int]:
        """By the solver that comes with it, as the derivative of a root has one."""
        lengths, functions = equation.params["const_lengths"], equation.params["jaxprs"]
        begin = lengths.matvec + lengths.vecmat
        sides = inputs[sum(lengths) :]
        return self._run(functions.solve, [*inputs[begin : begin + lengths.solve], *sides])

    def _polynomial(self, equation: Any, inputs: list[int]) -> list[int]:
        return [self._horner(equation.params["coefficients"], inputs)]

    def _horner(self, coefficients: horner.Coefficients, variables: Sequence[int]) -> int:
        """One operation, or several where some of it does not change in a loop."""
        coefficients, places = horner.needed(coefficients, len(variables))
        if not places:
            return self._constant(coefficients)
        first, *others = (variables[place] for place in places)
        if max((self._depths[other] for other in others), default=math.inf) >= self._depths[first]:
            return self._add(horner.NAME, [first, *others], coefficients=coefficients)[0]
        total, *factors = (self._horner(part, others) for part in reversed(coefficients))
        for factor in factors:
            (product,) = self._add("mul", [total, first])
            (total,) = self._add("add", [product, factor])
        return total

    # --- blocks ---

    def _block(
        self, closed: Any, outer: Sequence[int], arguments: int, *, is_choice: bool = False
    ) -> Block:
        """A jaxpr of values that exist, then of arguments of its own."""
        depth = len(self._scopes)
        scope = _Scope(depth, is_choice=is_choice)
        self._scopes.append(scope)
        own = [self._new(depth) for _ in range(arguments)]
        if arguments:
            jaxpr = getattr(closed, "jaxpr", closed)
            self._note_rows(jaxpr.invars[-arguments:], own)
        results = self._run(closed, [*outer, *own])
        self._scopes.pop()
        return Block(tuple(own), tuple(scope.operations), tuple(results))

    def _while(self, equation: Any, inputs: list[int]) -> list[int]:
        given = equation.params
        ends = given["cond_nconsts"], given["cond_nconsts"] + given["body_nconsts"]
        start = inputs[ends[1] :]
        condition = self._block(given["cond_jaxpr"], inputs[: ends[0]], len(start))
        body = self._block(given["body_jaxpr"], inputs[ends[0] : ends[1]], len(start))
        return self._add("while", start, len(start), (condition, body))

    def _scan(self, equation: Any, inputs: list[int]) -> list[int]:
        given = equation.params
        fixed, carried = _fixed_and_carried(given)
        outer, rest = inputs[:fixed], inputs[fixed:]
        if isinstance(given["length"], int) and given["length"] <= _MOST_STEPS:
            return self._unroll(equation, outer, rest)
        block = self._block(given["jaxpr"], outer, len(rest))
        return self._add(
            "scan",
            rest,
            len(equation.outvars),
            (block,),
            carried=carried,
            length=length(given["length"]),
            reverse=bool(given["reverse"]),
            ranks=[len(one.aval.shape) - 1 for one in equation.outvars[carried:]],
        )

    def _unroll(self, equation: Any, outer: list[int], rest: list[int]) -> list[int]:
        """A loop of a few steps as one step after the other."""
        given = equation.params
        (_, carried), steps = _fixed_and_carried(given), range(given["length"])
        state, columns = rest[:carried], rest[carried:]
        variables = equation.invars[len(outer) + carried :]
        collected: list[list[int]] = []
        for step in reversed(steps) if given["reverse"] else steps:
            rows = [
                self._row(column, step, variable.aval.shape)
                for column, variable in zip(columns, variables, strict=True)
            ]
            found = self._run(given["jaxpr"], [*outer, *state, *rows])
            state = found[:carried]
            collected.append(found[carried:])
        if given["reverse"]:
            collected.reverse()
        gathered = [
            self._stack(list(column), variable.aval.shape[1:])
            for column, variable in zip(
                zip(*collected, strict=True), equation.outvars[carried:], strict=True
            )
        ]
        return [*state, *gathered]

    def _row(self, column: int, step: int, shape: Sequence[Any]) -> int:
        if column in self._rows:
            return self._rows[column][step]
        rest = list(lengths_of(shape[1:]))
        (part,) = self._add(
            "slice",
            [column],
            start=[step, *[0] * len(rest)],
            stop=[step + 1, *rest],
            steps=None,
        )
        return self._add("squeeze", [part], dimensions=[0])[0]

    def _stack(self, rows: list[int], shape: Sequence[Any]) -> int:
        (whole,) = self._add("stack", rows, shape=list(lengths_of(shape)), axis=0)
        self._rows[whole] = rows
        return whole

    def _cond(self, equation: Any, inputs: list[int]) -> list[int]:
        which, *outer = inputs
        branches = equation.params["branches"]
        if which in self._constants:
            place = int(np.clip(int(self._constants[which]), 0, len(branches) - 1))
            return self._run(branches[place], outer)
        blocks = tuple(self._block(branch, outer, 0, is_choice=True) for branch in branches)
        return self._add("cond", [which], len(equation.outvars), blocks)


def _fixed_and_carried(given: Any) -> tuple[int, int]:
    """How many inputs of a scan stay the same, and how many go from step to step."""
    if "num_carry" in given:  # JAX before 0.11
        return given["num_consts"], given["num_carry"]
    fixed, carried, _ = given["ft_in"].unpack()
    return len(fixed), len(carried)


def _expanded(equation: Any) -> "extend.ClosedJaxpr":
    """An operation that JAX makes of others, such as a search in a table since 0.12."""
    examples = [jax.ShapeDtypeStruct(atom.aval.shape, atom.aval.dtype) for atom in equation.invars]
    if equation.primitive.name == "polynomial":
        return jax.make_jaxpr(_horner)(*examples)
    whole = equation.params["_prim"]
    if type(whole).__name__ == "SearchSorted":
        return jax.make_jaxpr(partial(_search_sorted, side=whole.params["side"]))(*examples)
    return jax.make_jaxpr(lambda *flat: whole.expand(*jax.tree.unflatten(whole.in_tree, flat)))(
        *examples
    )


def _search_sorted(nodes: Array, values: Array, side: str) -> Array:
    """Bisection; JAX's own compares the bits of numbers."""
    begins, ends = jnp.zeros(values.shape, np.int32), jnp.full(values.shape, nodes.size, np.int32)

    def halve(_: Any, found: tuple[Array, Array]) -> tuple[Array, Array]:
        low, high = found
        middle = (low + high) // 2
        node = nodes[middle]  # what is no number comes after all nodes
        before = values < node if side == "right" else values <= node
        return jnp.where(before, low, middle), jnp.where(before, middle, high)

    # a place before the first node, too, so that one step more than halvings of the nodes
    steps = math.ceil(math.log2(nodes.size + 1))
    return jax.lax.fori_loop(0, steps, halve, (begins, ends))[1]


def _horner(x: Array, *coefficients: Array) -> Array:
    """A polynomial; ``coefficients``: the lowest first."""
    return reduce(lambda total, one: total * x + one, reversed(coefficients))
