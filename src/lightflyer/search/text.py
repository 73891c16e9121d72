"""Optima, fronts and sensitivities in words: lines and tables."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from rich.table import Table

from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.files.display_units import amount, suitable
from lightflyer.files.result_text import Parts, warning_lines, wrap
from lightflyer.prediction.text import prediction_parts

if TYPE_CHECKING:
    from lightflyer.search.front import Front
    from lightflyer.search.optimiser import Optimum
    from lightflyer.search.problem import Constraint, Problem
    from lightflyer.search.sobol import Indices
    from lightflyer.search.stacks import Ranking
    from lightflyer.search.tolerance import AsMade

_SHOWN_ELASTICITIES = 8
_ROWS = 12
_STACKS = 8
_NANOMETRES = 1e9
_PAYLOADS = ("payload", "relative_payload", "payload_per_area", "afloat_payload", "usable_payload")
_MORE = 1.001  # times a payload, from which on another is told


def optimum_parts(optimum: "Optimum") -> Parts:
    """The best design, what limits it, and what it is most sensitive to."""
    problem = optimum.problem  # with the chosen stack, where there were several
    objective = problem.objectives[0]
    if optimum.ranking is not None:
        yield from _ranking_parts(problem, optimum.ranking)
    what = objective.name
    if problem.samples:
        of = "mean" if problem.quantile is None else f"{100.0 * problem.quantile:g} % quantile"
        count = len(next(iter(problem.samples.values())))
        what = f"{of} of {what} over {count} samples of {', '.join(problem.samples)}"
    value = amount(optimum.value, problem.unit_of(objective.name))
    yield f"{objective.word} {what}: {value}"
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
    yield table
    for constraint in problem.constraints:
        yield _constraint_line(optimum, constraint)
    note = "" if optimum.active_bounds else "; no bound is active"
    yield (
        f"{optimum.agreeing} of {optimum.starts} starts agree ({optimum.evaluations} gradients)"
        f"{note}"
    )
    for rival in optimum.rivals:
        words = [f"{objective.name} {amount(rival.value, problem.unit_of(objective.name), 4)}"]
        for name, number in rival.design.items():
            words.append(f"{name} {amount(number, problem.design.field(name).quantity.unit, 4)}")
        yield wrap(f"{rival.words}: {', '.join(words)}")
    if optimum.as_made is not None:
        yield from _tolerance_parts(problem, optimum.as_made)
    if optimum.elasticities:
        yield _elasticities_table(optimum)
    yield from warning_lines(optimum.warnings)


def design_parts(optimum: "Optimum") -> Parts:
    """What the best design does in all of its surroundings."""
    # Where the best payload was asked for, there is no second one but for the study's limits.
    asked = optimum.problem.objectives[0].name in _PAYLOADS
    yield from prediction_parts(optimum.prediction, payload=not asked)
    if asked:
        yield from _without_limits(optimum)


def _without_limits(optimum: "Optimum") -> Iterator[str]:
    """What the best design would carry elsewhere, and which limits of the study forbid it."""
    problem, prediction = optimum.problem, optimum.prediction
    best, name = prediction.verdict.best, problem.design.coordinate_name
    if best is None or not prediction.asked.size:
        return
    values, carried = best.values, best.values["payload"]
    if carried < _MORE * prediction.at["payload"][0]:
        return
    passed = [
        part.name.replace("_", " ")
        for part in problem.constraints
        if part.sign * (values.get(part.name, part.limit) - part.limit) < 0.0
    ]
    ends = [(one.low, one.high) for one in problem.bounds if one.field.name == name]
    if not any(low <= best.coordinate <= high for low, high in ends):
        passed.append(name)
    if passed:
        where = amount(best.coordinate, problem.design.field(name).quantity.unit, 3)
        yield wrap(
            f"Without the study's limit of {' and '.join(passed)} it would carry up to "
            f"{amount(carried, problem.unit_of('payload'), 3)}: at {where} and "
            f"{values['temperature']:.0f} K."
        )


def _constraint_line(optimum: "Optimum", constraint: "Constraint") -> str:
    problem, name, limit = optimum.problem, constraint.name, constraint.limit
    unit = problem.unit_of(name)
    word = "at least" if constraint.sign > 0.0 else "at most"
    gain = optimum.active_constraints.get(name)
    objective = problem.unit_of(problem.objectives[0].name)
    effect = "not active"
    if gain is not None:
        worth = amount(gain * abs(limit) / 100.0, objective, 3)
        effect = f"active: 1 % looser is worth {worth}"
    at, limit_shown = (amount(value, unit) for value in (optimum.outputs[name], limit))
    if constraint.of_film:
        withstands = f"the film withstands {limit_shown}"
        return f"{name} {at} ({withstands}{'' if gain is None else f'; {effect}'})"
    return f"{name} {at} ({word} {limit_shown}; {effect})"


def _ranking_parts(problem: "Problem", ranking: "Ranking") -> Parts:
    """Stacks of layers among which the film was chosen."""
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
    yield table
    yield f"{ranking.screened} of {ranking.allowed} stacks were compared"


def _tolerance_parts(problem: "Problem", made: "AsMade") -> Parts:
    """What is lost where the design is not made exactly."""
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
    yield table
    yield (
        f"made so, with all errors at once: mean {amount(made.mean, unit, 4)}, and "
        f"{100.0 * (1.0 - made.low_share):g} % are better than {amount(made.low, unit, 4)}"
    )


def _elasticities_table(optimum: "Optimum") -> Table:
    table = Table(box=None, padding=(0, 1))
    table.add_column("1 % more of", justify="left")
    table.add_column("changes the optimum by [%]", justify="right")
    for name, elasticity in list(optimum.elasticities.items())[:_SHOWN_ELASTICITIES]:
        table.add_row(name, f"{elasticity:+.3g}")
    return table


def front_parts(front: "Front") -> Parts:
    """Some of the designs of a front."""
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
    yield table
    shown = "" if step == 1 else f"; one in {step} is shown"
    yield f"{count} designs on the front, {front.evaluations} computed{shown}"
    yield from warning_lines(front.warnings)


def indices_parts(found: "Indices") -> Parts:
    """The output with its spread, the effect of each input, and what to measure next."""
    factor, name = found.shown
    unit = f" {name}" if name else ""
    yield (
        f"{found.output} {factor * found.nominal:.4g}{unit}; over all inputs "
        f"{factor * found.mean:.4g} ± {factor * found.spread:.2g}{unit}"
    )
    table = Table(box=None, padding=(0, 1, 0, 0))  # so that it fits into 80 columns
    ends = (f"at its\n{end} %\n[{name or '1'}]" for end in ("2.5", "97.5"))
    shares = ("share of\nvariance\n[%]", "with inter-\nactions\n[%]")
    headings = ("input", *shares, "elasticity", *ends)
    for heading in headings:
        left = heading == "input"
        table.add_column(heading, justify="left" if left else "right", no_wrap=True)
    for row in (-found.total).argsort():
        table.add_row(
            "\n".join(found.groups[row]),
            _share(found.first[row], found.first_interval[row]),
            _share(found.total[row], found.total_interval[row]),
            "\n".join(_sign_text(found.elasticity[name]) for name in found.groups[row]),
            _short(factor * found.low[row]),
            _short(factor * found.high[row]),
        )
    yield table
    if not found.ranked:
        advice = "too few points to say what to measure next: the 95 % interval of a share reaches "
        advice += f"{100.0 * found.first_interval.max():.0f} % to either side; raise points"
    elif found.next is None:
        advice = "all of it is the model's own error, which measurements cannot reduce"
    else:
        advice = f"measure {found.next} next: halving its uncertainty would leave ± "
        advice += f"{factor * found.spread_after_halving:.2g}{unit}"
    yield advice
    if found.ranked and found.with_known_force is not None:
        removed, spread = found.with_known_force
        yield wrap(
            f"a force measured on the same film would remove {100.0 * removed:.0f} % of the "
            f"variance and leave ± {factor * spread:.2g}{unit}; tangential momentum measured on "
            "both faces removes a part of that"
        )
    for one in found.differences if found.ranked else ():
        yield wrap(
            f"the difference {one.top} less {one.bottom}, known to ± {one.known:.2g}: measuring it "
            f"to ± {one.accuracy:g} would remove {100.0 * one.removed:.0f} % of the variance and "
            f"leave ± {factor * one.spread_after(found.spread):.2g}{unit}"
        )


def _share(share: float, half_width: float) -> str:
    """A share in percent with its standard uncertainty, from that and half its 95 % interval."""
    return f"{100.0 * share:.1f} ± {100.0 * half_width / NORMAL_HALF_WIDTH_95:.1f}"


def _short(value: float) -> str:
    """Few digits where a power of ten takes room: the table fits into 80 columns."""
    text = f"{value:.4g}"
    return f"{value:.3g}" if "e" in text else text


def _sign_text(elasticity: float) -> str:
    return "–" if math.isnan(elasticity) else f"{elasticity:+.3g}"
