"""Programs run by NumPy: no compilation, arrays of any length.

A value that does not vary along an axis need not fill it: it may have one element there, or no axes
at all. Most numbers of a flyer are such values, and arithmetic on them costs next to nothing. What
must see the whole of an array is given its shape and fills it.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from lightflyer.program.indexing import fill_axes
from lightflyer.program.operations import (
    ELEMENTWISE,
    SINGLE,
    UnsupportedError,
    function_of,
    is_known,
)
from lightflyer.program.program import ROWS, Block, Operation, Program, length_of

Values = list[Any]


CALL, ELEMENT = 1.5e-6, 1.0e-9
"""Typical time that an operation takes, and each element of its result [s]."""


class OutOfTimeError(RuntimeError):
    """A program would take longer than it was allowed."""


class Meter:
    """Counts work, so that a long run can be broken off."""

    # Time is counted, not measured: the same work is always broken off at the same place.

    def __init__(self, allowed: float = math.inf):
        self.calls, self.work = 0, 0
        self._allowed = allowed

    @property
    def spent(self) -> float:
        """Time that the work typically takes [s]."""
        return self.calls * CALL + self.work * ELEMENT

    def count(self, operations: int, elements: int) -> None:
        """Count operations that are about to run."""
        self.calls += operations
        self.work += operations * elements
        if self.spent > self._allowed:
            raise OutOfTimeError


def run(
    program: Program, inputs: Sequence[np.ndarray], meter: Meter | None = None
) -> list[np.ndarray]:
    """Outputs of a program; ``meter``: what counts the work."""
    prepared: _Prepared = program.prepare_once("numpy", _Prepared)
    lengths = _Run(program.lengths([np.shape(array) for array in inputs]), meter)
    with np.errstate(all="ignore"):
        found = prepared.run(lengths, inputs)
    return [
        fill_axes(value, shape, lengths).astype(kind, copy=False).copy()
        for value, shape, kind in zip(
            found, program.output_shapes, program.output_types, strict=True
        )
    ]


def require_supported(program: Program) -> None:
    """Raise :class:`UnsupportedError` unless NumPy can run a program."""
    for name in program.names:
        if name not in CONTROL and not is_known(name):
            raise UnsupportedError(f'operation "{name}" is not among those that NumPy runs')


class _Run(dict[str, int]):
    """Lengths of one run, by their symbols, and what counts its work."""

    def __init__(self, lengths: Mapping[str, int], meter: Meter | None = None):
        super().__init__(lengths)
        self.meter = meter or Meter()


class _Prepared:
    """A program as a list of functions to call."""

    def __init__(self, program: Program):
        require_supported(program)
        self._body = program.body
        self._count = 1 + max([*_numbers(program.body)], default=0)
        body = _without_filling(program)
        self._results = body.results
        self._constants = [(number, array[()]) for number, array in program.constants.items()]
        fixed = {number for number, array in program.constants.items() if array.ndim}
        inputs = zip(program.body.arguments, program.input_shapes, strict=True)
        fixed |= {number for number, shape in inputs if shape and shape[0] != ROWS}
        self._steps = _with_ends(body, _steps(body, frozenset(fixed)), self._count)

    def run(self, run: "_Run", inputs: Sequence[Any]) -> list[Any]:
        values: Values = [None] * self._count
        for number, array in self._constants:
            values[number] = array
        for number, array in zip(self._body.arguments, inputs, strict=True):
            values[number] = array
        _call_all(self._steps, values, run)
        return [values[number] for number in self._results]


def _without_filling(program: Program) -> Block:
    """The body without operations that give axes to a value that has none: it fills any."""
    same: dict[int, int] = {}
    single = set(program.single)

    def rewrite(block: Block) -> Block:
        kept = []
        for operation in block.operations:
            name, inputs, outputs, _, blocks = operation
            changed = not same.keys().isdisjoint(inputs)
            if changed:
                inputs = tuple(same.get(number, number) for number in inputs)
            if name == "broadcast_in_dim" and inputs[0] in single:
                same[outputs[0]] = inputs[0]
                continue
            if name in SINGLE and single.issuperset(operation.inputs):
                single.update(outputs)
            if changed or blocks:
                blocks = tuple(map(rewrite, blocks))
                operation = operation._replace(inputs=inputs, blocks=blocks)
            kept.append(operation)
        results = tuple(same.get(number, number) for number in block.results)
        return block._replace(operations=tuple(kept), results=results)

    return rewrite(program.body)


_Step = tuple[Callable[..., Any], tuple[int, ...], tuple[int, ...], int, tuple[int, ...]]
"""Function, inputs, outputs, how it is called, and values that nothing needs afterwards."""


class _Steps(NamedTuple):
    """What to call, in order."""

    calls: list[_Step]
    weight: int  # in steps as small as a multiplication


_ONE, _TWO, _ANY, _SHAPED, _CONTROL = range(5)
_BY_COUNT = {1: _ONE, 2: _TWO}


def _steps(block: Block, fixed: frozenset[int]) -> _Steps:
    """What a block calls; ``fixed`` are tables, which have no row for each element."""
    steps: list[_Step] = []
    for operation in block.operations:
        name, inputs, outputs = operation.name, operation.inputs, operation.outputs
        if name in CONTROL:
            steps.append((CONTROL[name](operation, fixed), inputs, outputs, _CONTROL, ()))
        elif name in ELEMENTWISE:
            steps.append((ELEMENTWISE[name], inputs, outputs, _BY_COUNT.get(len(inputs), _ANY), ()))
        else:
            steps.append((function_of(operation), inputs, outputs, _SHAPED, ()))
    return _Steps(steps, block.steps)


def _with_ends(block: Block, steps: _Steps, count: int) -> _Steps:
    """Name, for each step, the values that it makes or reads last, so that memory is freed."""
    needed = bytearray(count)
    for number in block.results:
        needed[number] = 1
    found: list[_Step] = []
    for operation, step in zip(reversed(block.operations), reversed(steps.calls), strict=True):
        used = operation.inputs + operation.outputs
        if operation.blocks:
            used = (*used, *(number for part in operation.blocks for number in _numbers(part)))
        last = tuple([number for number in used if not needed[number]])
        for number in last:
            needed[number] = 1
        found.append((*step[:4], last) if last else step)
    return steps._replace(calls=found[::-1])


def _numbers(block: Block) -> Iterator[int]:
    """All values that a block sets or reads, some of them several times."""
    yield from block.arguments + block.results
    for operation in block.operations:
        yield from operation.inputs + operation.outputs
        for part in operation.blocks:
            yield from _numbers(part)


def _call_all(steps: _Steps, values: Values, lengths: _Run) -> None:
    lengths.meter.count(steps.weight, lengths.get(ROWS, 1))
    for function, inputs, outputs, way, last in steps.calls:
        if way == _TWO:
            values[outputs[0]] = function(values[inputs[0]], values[inputs[1]])
        elif way == _ONE:
            values[outputs[0]] = function(values[inputs[0]])
        elif way == _CONTROL:
            function(values, lengths)
        else:
            given = [values[number] for number in inputs]
            found = function(lengths, *given) if way == _SHAPED else function(*given)
            if len(outputs) == 1:
                values[outputs[0]] = found
            else:
                for number, value in zip(outputs, found, strict=True):
                    values[number] = value
        for number in last:
            values[number] = None


_BY_ROWS = {*SINGLE, "broadcast_in_dim", "squeeze", "reduce_or", "reduce_and", "gather", "while",
            "cond", "scan"}  # fmt: skip

CONTROL: dict[str, Callable[[Operation, frozenset[int]], Callable[[Values, _Run], None]]] = {}
"""Loops and choices: what makes, of an operation and the tables, a function that sets values."""


# --- loops and choices ---

_FEW, _MANY = 128, 0.6  # elements that are not worth leaving out; share above which all stay


def _control(name: str) -> Callable[[Any], Any]:
    def keep(make: Callable[..., Any]) -> Callable[..., Any]:
        CONTROL[name] = make
        return make

    return keep


@_control("while")
def _while(operation: Operation, fixed: frozenset[int]) -> Callable[[Values, _Run], None]:
    condition, body = operation.blocks
    for_condition, for_body = _steps(condition, fixed), _steps(body, fixed)
    (verdict,) = condition.results
    by_rows = _is_elementwise(condition, body)
    active = _activity(condition)
    around = sorted((condition.reads() | body.reads()) - condition.makes() - body.makes() - fixed)

    def loop(values: Values, lengths: _Run) -> None:
        state = [values[number] for number in operation.inputs]
        rest = _Rest(values, around, lengths) if by_rows else None
        while True:
            _set(values, condition.arguments, state)
            _call_all(for_condition, values, lengths)
            goes_on = values[verdict]
            if not np.any(goes_on):
                break
            _set(values, body.arguments, state)
            _call_all(for_body, values, lengths)
            following = [values[number] for number in body.results]
            if np.ndim(goes_on):  # each element ends by itself
                following = _where_rows(goes_on, following, state)
            elif active is not None:
                goes_on = values[active]
            state = following if rest is None else rest.narrow(goes_on, state, following)
        _set(values, operation.outputs, state if rest is None else rest.whole(state))

    return loop


def _set(values: Values, numbers: Sequence[int], given: Sequence[Any]) -> None:
    for number, value in zip(numbers, given, strict=True):
        values[number] = value


def _where_rows(condition: Any, following: list[Any], state: list[Any]) -> list[Any]:
    """What follows for the rows where a condition holds, else the state as it was."""
    chosen = []
    for new, old in zip(following, state, strict=True):
        missing = max(np.ndim(new), np.ndim(old)) - condition.ndim
        rows = condition.reshape(condition.shape + (1,) * max(missing, 0))
        chosen.append(np.where(rows, new, old))
    return chosen


class _Rest:
    """The elements of a loop that have not ended; those that have are left out, many at a time."""

    def __init__(self, values: Values, around: list[int], lengths: _Run):
        self._values, self._around, self._lengths = values, around, lengths
        self._count = lengths.get(ROWS, 1)
        self._before: dict[int, Any] = {}
        self._full: list[Any] | None = None
        self._rows: Any = None

    def narrow(self, active: Any, state: list[Any], following: list[Any]) -> list[Any]:
        """The state without elements that have ended and change no more, where they are many."""
        count = self._lengths.get(ROWS, 1)
        if count < _FEW or np.shape(active) != (count,):
            return following
        moving = active.copy()
        for old, new in zip(state, following, strict=True):
            if np.shape(new) == (count,):
                moving |= (old != new) & ((old == old) | (new == new))
        if np.count_nonzero(moving) > _MANY * count:
            return following
        chosen = np.flatnonzero(moving)
        self._keep(following, count)
        self._rows = chosen if self._rows is None else self._rows[chosen]
        for number in self._around:
            value = self._values[number]
            if _has_rows(value, count):
                self._before.setdefault(number, value)
                self._values[number] = value[chosen]
        self._lengths[ROWS] = chosen.size
        return [value[chosen] if _has_rows(value, count) else value for value in following]

    def whole(self, state: list[Any]) -> list[Any]:
        """The state of all elements, when the loop has ended."""
        if self._full is None:
            return state
        self._keep(state, self._rows.size)
        for number, value in self._before.items():
            self._values[number] = value
        self._lengths[ROWS] = self._count
        return self._full

    def _keep(self, state: list[Any], count: int) -> None:
        """Write the rows at hand into the state of all elements."""
        if self._full is None:
            self._full = [value.copy() if _has_rows(value, count) else value for value in state]
            return
        for place, value in enumerate(state):
            full = self._full[place]
            if not _has_rows(full, self._count):
                if not _has_rows(value, count):
                    self._full[place] = value
                    continue
                full = np.repeat(np.reshape(full, (1, *np.shape(value)[1:])), self._count, 0)
                self._full[place] = full
            full[self._rows] = value


def _has_rows(value: Any, count: int) -> bool:
    return np.ndim(value) > 0 and value.shape[0] == count


def _activity(condition: Block) -> int | None:
    """The value of a condition that says, for each element, whether it goes on."""
    found = [operation for operation in condition.operations if operation.name == "reduce_or"]
    return found[0].inputs[0] if len(found) == 1 else None


def _is_elementwise(*blocks: Block) -> bool:
    """Whether no element of what the blocks compute depends on another one."""
    return all(
        operation.name in _BY_ROWS
        and ROWS not in operation.parameters.get("shape", ())
        and all(map(_is_elementwise, operation.blocks))
        for block in blocks
        for operation in block.operations
    )


@_control("scan")
def _scan(operation: Operation, fixed: frozenset[int]) -> Callable[[Values, _Run], None]:
    (body,) = operation.blocks
    steps = _steps(body, fixed)
    given = operation.parameters
    carried: int = given["carried"]
    ranks: list[int] = given["ranks"]

    def loop(values: Values, lengths: _Run) -> None:
        state = [values[number] for number in operation.inputs[:carried]]
        columns = [values[number] for number in operation.inputs[carried:]]
        count = length_of(given["length"], lengths)
        collected: list[list[Any]] = [[] for _ in ranks]
        order = range(count - 1, -1, -1) if given["reverse"] else range(count)
        for place in order:
            rows = [
                column if np.ndim(column) == 0 else column[place if column.shape[0] == count else 0]
                for column in columns
            ]
            _set(values, body.arguments, [*state, *rows])
            _call_all(steps, values, lengths)
            found = [values[number] for number in body.results]
            state = found[:carried]
            for column, value in zip(collected, found[carried:], strict=True):
                column.append(value)
        if given["reverse"]:
            collected = [column[::-1] for column in collected]
        stacked = [_stack_rows(column, rank) for column, rank in zip(collected, ranks, strict=True)]
        _set(values, operation.outputs, [*state, *stacked])

    return loop


def _stack_rows(rows: list[Any], rank: int) -> Any:
    """Rows of one array; each may lack axes along which it does not vary."""
    whole = np.stack(np.broadcast_arrays(*rows)) if rows else np.zeros((0,))
    return whole.reshape(whole.shape + (1,) * (1 + rank - whole.ndim))


@_control("cond")
def _cond(operation: Operation, fixed: frozenset[int]) -> Callable[[Values, _Run], None]:
    branches = [(_steps(branch, fixed), branch.results) for branch in operation.blocks]

    def choose(values: Values, lengths: _Run) -> None:
        which = int(values[operation.inputs[0]])
        steps, results = branches[min(max(which, 0), len(branches) - 1)]
        _call_all(steps, values, lengths)
        _set(values, operation.outputs, [values[result] for result in results])

    return choose
