"""Whether a trace for single numbers serves arrays of them, too."""

from collections.abc import Sequence
from typing import NamedTuple

from lightflyer.program.operations import SINGLE
from lightflyer.program.program import ROWS, Block, Operation, Program


def serves_many(program: Program, widened: Sequence[bool]) -> bool:
    """Whether inputs without axes may be given as arrays along the program's one axis."""
    # So they may where each is only an operand of arithmetic until it meets values along that axis.
    wide = {n for n, is_wide in zip(program.body.arguments, widened, strict=True) if is_wide}
    known = _Known(wide, program.single, program.rows)
    return _stay_apart(program.body, known) and not wide.intersection(program.body.results)


class _Known(NamedTuple):
    """Values given as arrays though they have no axes, values without axes, values of all rows."""

    wide: set[int]
    single: set[int]
    rows: frozenset[int]


def _stay_apart(block: Block, known: _Known) -> bool:
    """Whether wide values take part in arithmetic alone; ``known`` gains what is made of them."""
    wide, single, rows = known
    for operation in block.operations:
        touched = bool(wide.intersection(operation.inputs))
        if operation.name in SINGLE:
            if single.issuperset(operation.inputs):
                single.update(operation.outputs)
                wide.update(operation.outputs if touched else ())
            elif touched and not all(n in single or n in rows for n in operation.inputs):
                return False
        elif operation.name == "while":
            if not _loop_stays_apart(operation, known):
                return False
        elif operation.blocks:
            if touched or not all(
                _stay_apart(part, known) and not wide.intersection(part.results)
                for part in operation.blocks
            ):
                return False
        elif touched and not (
            operation.name == "broadcast_in_dim" and operation.parameters["new"] == [ROWS]
        ):
            return False
    return True


def _loop_stays_apart(loop: Operation, known: _Known) -> bool:
    wide, single, _ = known
    condition, body = loop.blocks
    for start, checked, own, output in zip(
        loop.inputs, condition.arguments, body.arguments, loop.outputs, strict=True
    ):
        if start in single:
            single.update((checked, own, output))
    size = -1
    while size != len(wide):  # until no more variables of the loop turn out to be wide
        size = len(wide)
        for start, checked, own, following, output in zip(
            loop.inputs, condition.arguments, body.arguments, body.results, loop.outputs,
            strict=True,
        ):  # fmt: skip
            if wide.intersection((start, following)):
                wide.update((checked, own, output))
        if not all(_stay_apart(part, known) for part in loop.blocks):
            return False
    return not wide.intersection(condition.results)
