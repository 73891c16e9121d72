"""Programs without what no output needs."""

from collections.abc import Sequence
from dataclasses import replace

from lightflyer.program.program import Block, Operation, Program


def with_outputs(program: Program, places: Sequence[int]) -> Program:
    """The program with some of its outputs, without what only the others need."""
    body = program.body._replace(results=tuple(program.body.results[place] for place in places))
    return replace(
        program,
        body=without_dead(body),
        output_shapes=tuple(program.output_shapes[place] for place in places),
        output_types=tuple(program.output_types[place] for place in places),
        _prepared={},
    )


def without_dead(block: Block) -> Block:
    """The block without operations that its results do not need."""
    return _prune(block, set(block.results))


def _prune(block: Block, needed: set[int]) -> Block:
    """Without dead operations; ``needed`` gains what the rest reads."""
    kept: list[Operation] = []
    for operation in reversed(block.operations):
        if needed.isdisjoint(operation.outputs):
            continue
        if not operation.blocks:
            needed.update(operation.inputs)
            kept.append(operation)
            continue
        alive = _live_loop(operation, needed) if operation.name == "while" else operation
        blocks = []
        for part in alive.blocks:
            inner = set(part.results)
            blocks.append(_prune(part, inner))
            needed |= inner - part.makes()
        needed |= set(alive.inputs)
        kept.append(alive._replace(blocks=tuple(blocks)))
    return block._replace(operations=tuple(kept[::-1]))


def _live_loop(loop: Operation, needed: set[int]) -> Operation:
    """A loop without variables that neither its condition nor what follows needs."""
    condition, body = loop.blocks
    alive = {place for place, output in enumerate(loop.outputs) if output in needed}
    of_condition = _needs(condition, condition.results)
    alive |= {place for place, own in enumerate(condition.arguments) if own in of_condition}
    while True:
        wanted = _needs(body, [body.results[place] for place in alive])
        more = {place for place, own in enumerate(body.arguments) if own in wanted}
        if more <= alive:
            break
        alive |= more
    places = sorted(alive)

    def keep(values: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(values[place] for place in places)

    return loop._replace(
        inputs=keep(loop.inputs),
        outputs=keep(loop.outputs),
        blocks=(
            condition._replace(arguments=keep(condition.arguments)),
            body._replace(arguments=keep(body.arguments), results=keep(body.results)),
        ),
    )


def _needs(block: Block, results: Sequence[int]) -> set[int]:
    """All values that some results of a block depend on."""
    needed = set(results)
    for operation in reversed(block.operations):
        if not needed.isdisjoint(operation.outputs):
            needed.update(operation.inputs)
            for part in operation.blocks:
                needed |= part.reads() - part.makes()
    return needed
