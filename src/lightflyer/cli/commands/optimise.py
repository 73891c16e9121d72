"""``lightflyer optimise``: the best design of a study."""

from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, say, write_json
from lightflyer.cli.prediction_tables import show_flyer, show_results
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    from lightflyer.search.front import Front
    from lightflyer.search.optimiser import Optimum
    from lightflyer.search.problem import Problem
    from lightflyer.search.stacks import Ranking

_SHOWN_ELASTICITIES = 8
_ROWS = 12
_STACKS = 8
_NANOMETRES = 1e9


def optimise_command(
    study_file: Path,
    /,
    *,
    out: Path | None = None,
    write: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Find the best design within bounds and constraints.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [optimise] and [optimise.over].
    out
        Folder to write the result (JSON) and its figure into: the elasticities of the best
        design or, with several objectives, the front.
    write
        Flyer file to write with the best design in place of the study's; it must be new, or one
        that this command wrote.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.search import optimise, pareto, read_problem

    problem = read_problem(study_file)
    if write is not None:
        from lightflyer.config.update import require_free

        require_free(write)
    console, written = printer(), []
    if len(problem.objectives) > 1:
        if write is not None:
            raise ConfigurationError("--write: several objectives have no single best design")
        front = pareto(problem)
        summary = front.summary()
        written = _write(out, front, "front", figures)
        if not json_output:
            _show_front(console, front)
    else:
        optimum = optimise(problem)
        summary = optimum.summary()
        written = _write(out, optimum, "elasticities", figures)
        if not json_output:
            _show_optimum(console, optimum)
            show_flyer(console, optimum.prediction)
            show_results(console, optimum.prediction)
        if write is not None:
            _write_flyer(write, study_file, optimum)
            written.append(write)
    if json_output:
        print_json(summary)
        return
    figures.tell(console, written)
    if write is not None:
        say(console, f"next: lightflyer predict {write}")


def _write_flyer(path: Path, study_file: Path, optimum: "Optimum") -> None:
    """The study's flyer file with the numbers of the best design."""
    from lightflyer.config.update import write_design

    problem = optimum.problem
    coordinate, quantities = problem.design.coordinate_name, problem.design.quantities
    found = {
        name: (value, quantities[name].unit)
        for name, value in (problem.fixed | optimum.design).items()
        if name != coordinate
    }
    write_design(path, problem.design.text, found, f"lightflyer optimise {study_file.name}")


def _write(
    out: Path | None, found: "Optimum | Front", title: str, figures: FigureOptions
) -> list[Path]:
    """The result, and its figure under a title."""
    if out is None:
        return []
    from lightflyer.core.atomic_files import output_directory

    names = ["optimum.json"]
    with output_directory(out) as stage:
        write_json(stage("optimum.json"), found.summary())
        names += figures.write(stage, lambda: {title: found.plot()})
    return [out / name for name in names]


def _show_optimum(console: Console, optimum: "Optimum") -> None:
    from lightflyer.files.display_units import amount, suitable

    problem = optimum.problem  # with the chosen stack, where there were several
    objective = problem.objectives[0]
    if optimum.ranking is not None:
        _show_ranking(console, problem, optimum.ranking)
    what = objective.name
    if problem.samples:
        of = "mean" if problem.quantile is None else f"{100.0 * problem.quantile:g} % quantile"
        count = len(next(iter(problem.samples.values())))
        what = f"{of} of {what} over {count} samples of {', '.join(problem.samples)}"
    value = amount(optimum.value, problem.unit_of(objective.name))
    console.print(f"{objective.word} {what}: {value}", soft_wrap=True)
    table = Table(box=None, padding=(0, 1))
    for heading in ("field", "best", "unit", "from", "to", ""):
        left = heading in ("field", "unit", "")
        table.add_column(heading, justify="left" if left else "right")
    for bounds in problem.bounds:
        name = bounds.field.name
        end = optimum.active_bounds.get(name)
        note = "" if end is None else f"at its {'lower' if end == 'low' else 'upper'} bound"
        note = " ".join(filter(None, (problem.design.label(name), note)))
        factor, unit = suitable(bounds.field.quantity.unit, optimum.design[name])
        numbers = optimum.design[name], bounds.low, bounds.high
        best, low, high = (f"{number * factor:.6g}" for number in numbers)
        table.add_row(name, best, unit, low, high, note)
    console.print(table)
    for constraint in problem.constraints:
        _show_constraint(console, optimum, constraint.name, constraint.limit, constraint.sign)
    note = "" if optimum.active_bounds else "; no bound is active"
    console.print(
        f"{optimum.agreeing} of {optimum.starts} starts agree ({optimum.evaluations} gradients)"
        f"{note}"
    )
    _show_made(console, problem, optimum)
    _show_elasticities(console, optimum)
    for text in optimum.warnings:
        console.print(f"warning: {text}", soft_wrap=True)


def _show_constraint(
    console: Console, optimum: "Optimum", name: str, limit: float, sign: float
) -> None:
    from lightflyer.files.display_units import amount

    problem = optimum.problem
    unit = problem.unit_of(name)
    word = "at least" if sign > 0.0 else "at most"
    gain = optimum.active_constraints.get(name)
    objective = problem.unit_of(problem.objectives[0].name)
    effect = "not active"
    if gain is not None:
        worth = amount(gain * abs(limit) / 100.0, objective, 3)
        effect = f"active: 1 % looser is worth {worth}"
    at, limit_shown = (amount(value, unit) for value in (optimum.outputs[name], limit))
    console.print(f"{name} {at} ({word} {limit_shown}; {effect})", soft_wrap=True)


def _show_ranking(console: Console, problem: "Problem", ranking: "Ranking") -> None:
    """Stacks of layers among which the film was chosen."""
    from lightflyer.files.display_units import suitable

    unit = problem.unit_of(problem.objectives[0].name)
    shown = ranking.stacks[:_STACKS]
    factor, unit = suitable(unit, max(abs(stack.value) for stack in shown))
    table = Table(box=None, padding=(0, 1))
    table.add_column(f"{problem.objectives[0].name}\n[{unit or '1'}]", justify="right")
    table.add_column("stack, top to bottom\n[nm]", justify="left")
    for stack in shown:
        layers = zip(stack.materials, stack.thickness, strict=True)
        words = ", ".join(f"{name} {_NANOMETRES * size:.4g}" for name, size in layers)
        note = "" if stack.in_full else " (films within a few thousandths)"
        table.add_row(f"{factor * stack.value:.5g}", words + note)
    console.print(table)
    console.print(f"{ranking.screened} of {ranking.allowed} stacks were compared")


def _show_made(console: Console, problem: "Problem", optimum: "Optimum") -> None:
    """What is lost where the design is not made exactly."""
    from lightflyer.files.display_units import amount, suitable

    made = optimum.as_made
    if made is None:
        return
    objective = problem.objectives[0]
    unit = problem.unit_of(objective.name)
    sizes = [size for effect in made.effects.values() for size in (effect.less, effect.more)]
    factor, shown = suitable(unit, max(map(abs, sizes)))
    table = Table(box=None, padding=(0, 1))
    table.add_column("made with ± (1 σ)", justify="left")
    for heading in ("", f"too small: {objective.name} [{shown or '1'}]", "too large"):
        table.add_column(heading, justify="right")
    for name, effect in made.effects.items():
        size = amount(effect.spread, problem.design.field(name).quantity.unit, 3)
        note = " (assumed)" if effect.assumed else ""
        changes = (f"{factor * change:+.3g}" for change in (effect.less, effect.more))
        table.add_row(name, f"± {size}{note}", *changes)
    console.print(table)
    console.print(
        f"made so, with all errors at once: mean {amount(made.mean, unit, 4)}, and "
        f"{100.0 * (1.0 - made.low_share):g} % are better than {amount(made.low, unit, 4)}",
        soft_wrap=True,
    )


def _show_elasticities(console: Console, optimum: "Optimum") -> None:
    if not optimum.elasticities:
        return
    table = Table(box=None, padding=(0, 1))
    table.add_column("1 % more of", justify="left")
    table.add_column("changes the optimum by [%]", justify="right")
    for name, elasticity in list(optimum.elasticities.items())[:_SHOWN_ELASTICITIES]:
        table.add_row(name, f"{elasticity:+.3g}")
    console.print(table)


def _show_front(console: Console, front: "Front") -> None:
    from lightflyer.files.display_units import suitable

    problem = front.problem
    table = Table(box=None, padding=(0, 1))
    columns = []
    for part in problem.objectives:
        factor, unit = suitable(problem.unit_of(part.name), front.objectives[part.name])
        table.add_column(f"{part.name}\n[{unit or '1'}] ({part.word})", justify="right")
        columns.append(factor * front.objectives[part.name])
    for bounds in problem.bounds:
        values = front.designs[bounds.field.name]
        factor, unit = suitable(bounds.field.quantity.unit, values)
        table.add_column(f"{bounds.field.name}\n[{unit or '1'}]", justify="right")
        columns.append(factor * values)
    count = len(columns[0])
    step = max(1, count // _ROWS)
    for row in range(0, count, step):
        table.add_row(*(f"{column[row]:.5g}" for column in columns))
    console.print(table)
    shown = "" if step == 1 else f"; one in {step} is shown"
    console.print(f"{count} designs on the front, {front.evaluations} computed{shown}")
    for text in front.warnings:
        console.print(f"warning: {text}", soft_wrap=True)
