"""Results of searches, fronts and sensitivities in words, tables and figures."""

import math
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.files.display_units import amount, in_words, scale_and_label, suitable
from lightflyer.files.palette import BLUE, GREEN, GREY, LESS, MORE, VERMILION
from lightflyer.files.result_text import Parts, table_of, warning_lines, wrap
from lightflyer.prediction.text import prediction_parts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.search.front import Front
    from lightflyer.search.optimiser import Optimum
    from lightflyer.search.sobol import Indices

_SHOWN_ELASTICITIES = 8
_ROWS = 12
_STACKS = 8
_NANOMETRES = 1e9
_PAYLOADS = ("payload", "relative_payload", "payload_per_area", "afloat_payload", "usable_payload")
_MORE = 1.001  # times a payload, from which on another is told

_OPACITY = 0.25
_TICKS = 6
_BAR = 0.4  # height, in rows
_FRAME, _ROW = 1.8, 0.45  # heights of all but the rows, and of a row [inch]


def optimum_parts(optimum: "Optimum") -> Parts:
    """The best design, what limits it, and what it is most sensitive to."""
    problem = optimum.problem  # with the chosen stack, where there were several
    objective = problem.objectives[0]
    if optimum.ranking is not None:
        unit = problem.unit_of(problem.objectives[0].name)
        shown = optimum.ranking.stacks[:_STACKS]
        factor, unit = suitable(unit, max(abs(stack.value) for stack in shown))
        rows: list[tuple[str, ...]] = []
        for stack in shown:
            layers = zip(stack.materials, stack.thickness, strict=True)
            listed = ", ".join(f"{name} {_NANOMETRES * size:.4g}" for name, size in layers)
            note = "" if stack.in_full else " (films within a few thousandths)"
            rows.append((f"{factor * stack.value:.5g}", listed + note))
        name = problem.objectives[0].name
        yield table_of((f"{name}\n[{unit or '1'}]", "stack, top to bottom\n[nm]"), rows, left=(1,))
        yield f"{optimum.ranking.screened} of {optimum.ranking.allowed} stacks were compared"
    what = objective.name
    if problem.samples:
        of = "mean" if problem.quantile is None else f"{100.0 * problem.quantile:g} % quantile"
        count = len(next(iter(problem.samples.values())))
        what = f"{of} of {what} over {count} samples of {', '.join(problem.samples)}"
    value = amount(optimum.value, problem.unit_of(objective.name))
    yield f"{objective.word} {what}: {value}"
    rows = []
    for bounds in problem.bounds:
        name = bounds.field.name
        end = optimum.active_bounds.get(name)
        note = "" if end is None else f"at its {'lower' if end == 'low' else 'upper'} bound"
        note = " ".join(filter(None, (problem.design.label(name), note)))
        factor, unit = suitable(bounds.field.quantity.unit, optimum.design[name])
        numbers = optimum.design[name], bounds.low, bounds.high
        best, low, high = (f"{number * factor:.6g}" for number in numbers)
        rows.append((name, best, unit, low, high, note))
    yield table_of(("field", "best", "unit", "from", "to", ""), rows, left=(0, 2, 5))
    for limit in problem.constraints:
        gain, unit = optimum.active_constraints.get(limit.name), problem.unit_of(limit.name)
        at, end = (amount(one, unit) for one in (optimum.outputs[limit.name], limit.limit))
        state = "not active"
        if gain is not None:
            worth = gain * abs(limit.limit) / 100.0
            looser = amount(worth, problem.unit_of(objective.name), 3)
            state = f"active: 1 % looser is worth {looser}"
        said = f"{'at least' if limit.sign > 0.0 else 'at most'} {end}; {state}"
        if limit.of_film:
            said = f"the film withstands {end}{'' if gain is None else f'; {state}'}"
        yield f"{limit.name} {at} ({said})"
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
    made = optimum.as_made
    if made is not None:  # what is lost where the design is not made exactly
        unit = problem.unit_of(objective.name)
        sizes = [size for effect in made.effects.values() for size in (effect.less, effect.more)]
        factor, shown_unit = suitable(unit, max(map(abs, sizes)))
        rows = []
        for name, effect in made.effects.items():
            size = amount(effect.spread, problem.design.field(name).quantity.unit, 3)
            note = " (assumed)" if effect.assumed else ""
            changes = (f"{factor * change:+.3g}" for change in (effect.less, effect.more))
            rows.append((name, f"± {size}{note}", *changes))
        too_small = f"too small: {objective.name} [{shown_unit or '1'}]"
        yield table_of(("made with ± (1 σ)", "", too_small, "too large"), rows)
        yield (
            f"made so, with all errors at once: mean {amount(made.mean, unit, 4)}, and "
            f"{100.0 * (1.0 - made.low_share):g} % are better than {amount(made.low, unit, 4)}"
        )
    if optimum.elasticities:
        most = [*optimum.elasticities.items()][:_SHOWN_ELASTICITIES]
        moved = ((name, f"{elasticity:+.3g}") for name, elasticity in most)
        yield table_of(("1 % more of", "changes the optimum by [%]"), moved)
    yield from warning_lines(optimum.warnings)


def design_parts(optimum: "Optimum") -> Parts:
    """What the best design does in all of its surroundings."""
    # Where the best payload was asked for, there is no second one but for the study's limits.
    asked = optimum.problem.objectives[0].name in _PAYLOADS
    yield from prediction_parts(optimum.prediction, payload=not asked)
    problem, prediction = optimum.problem, optimum.prediction
    best, name = prediction.verdict.best, problem.design.coordinate_name
    if not asked or best is None or not prediction.asked.size:
        return
    # what it would carry elsewhere, and which limits of the study forbid it
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


def front_parts(front: "Front") -> Parts:
    """Some of the designs of a front."""
    problem = front.problem
    numbers = [
        (part.name, problem.unit_of(part.name), front.objectives[part.name], f" ({part.word})")
        for part in problem.objectives
    ] + [
        (one.field.name, one.field.quantity.unit, front.designs[one.field.name], "")
        for one in problem.bounds
    ]
    headings, columns = [], []
    for name, si_unit, values, word in numbers:
        factor, unit = suitable(si_unit, values)
        headings.append(f"{name}\n[{unit or '1'}]{word}")
        columns.append(factor * values)
    count = len(columns[0])
    step = max(1, count // _ROWS)
    rows = ([f"{column[row]:.5g}" for column in columns] for row in range(0, count, step))
    yield table_of(headings, rows, left=())
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
    ends = (f"at its\n{end} %\n[{name or '1'}]" for end in ("2.5", "97.5"))
    shares = ("share of\nvariance\n[%]", "with inter-\nactions\n[%]")
    rows = (
        (
            "\n".join(found.groups[row]),
            _share(found.first[row], found.first_interval[row]),
            _share(found.total[row], found.total_interval[row]),
            "\n".join(
                "–" if math.isnan(one := found.elasticity[name]) else f"{one:+.3g}"
                for name in found.groups[row]
            ),
            _short(factor * found.low[row]),
            _short(factor * found.high[row]),
        )
        for row in (-found.total).argsort()
    )
    table = table_of(("input", *shares, "elasticity", *ends), rows, padding=(0, 1, 0, 0))
    for column in table.columns:
        column.no_wrap = True
    yield table  # which fits into 80 columns
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
    for pair in found.differences if found.ranked else ():
        yield wrap(
            f"the difference {pair.top} less {pair.bottom}, known to ± {pair.known:.2g}: measuring "
            f"it to ± {pair.accuracy:g} would remove {100.0 * pair.removed:.0f} % of the variance "
            f"and leave ± {factor * pair.spread_after(found.spread):.2g}{unit}"
        )


def _share(share: float, half_width: float) -> str:
    """A share in percent with its standard uncertainty, from that and half its 95 % interval."""
    return f"{100.0 * share:.1f} ± {100.0 * half_width / NORMAL_HALF_WIDTH_95:.1f}"


def _short(value: float) -> str:
    """Few digits where a power of ten takes room: the table fits into 80 columns."""
    text = f"{value:.4g}"
    return f"{value:.3g}" if "e" in text else text


def front_figure(front: "Front") -> "Figure":
    """The objectives of a Pareto front, each against the first."""
    from lightflyer.files.drawing import legend_below, new_figure, wrap_label

    first, *others = front.problem.objectives
    figure, table = new_figure(columns=len(others)), front.dataset
    for ax, other in zip(figure.axes, others, strict=True):
        values = []
        for part, side in ((first, "x"), (other, "y")):
            better = "more" if part.sign > 0.0 else "less"
            factor, label = scale_and_label(table[part.name])
            getattr(ax, f"set_{side}label")(f"{wrap_label(label)}\n({better} is better)")
            values.append(factor * table[part.name].values)
        ax.plot(*values, "o", color=BLUE, ms=4, label="designs that no other beats in everything")
        ax.grid(alpha=_OPACITY)
        legend_below(ax)
    return figure


def tornado_figure(found: "Indices") -> "Figure":
    """Effect of the uncertainty of each input on an output, the largest on top."""
    from lightflyer.files.drawing import INTERVAL, legend_below, new_figure, wrap_label

    figure = new_figure(columns=2, width=5.0, height=_FRAME + _ROW * len(found.names))
    ranges, shares = figure.axes
    order = np.argsort(found.total)
    factor, label = scale_and_label(found.dataset.low.rename(found.output))
    rows = np.arange(order.size)
    for ends, colour, words in (
        (found.low, LESS, "input at its 2.5 % quantile"),
        (found.high, MORE, "input at its 97.5 % quantile"),
    ):
        width = factor * (ends[order] - found.nominal)
        ranges.barh(rows, width, left=factor * found.nominal, color=colour, label=words)
    ranges.axvline(factor * found.nominal, color=GREY, lw=1.0)
    names = [" and\n".join(map(in_words, found.groups[number])) for number in order]
    ranges.set_yticks(rows, names)
    ranges.set_xlabel(wrap_label(label))
    ranges.locator_params(axis="x", nbins=_TICKS)
    for index, spread, colour, words, offset in (
        (found.total, found.total_interval, GREEN, "with interactions", _BAR / 2.0),
        (found.first, found.first_interval, VERMILION, "alone", -_BAR / 2.0),
    ):
        shares.barh(rows + offset, index[order], _BAR, color=colour, label=words)
        bars = shares.errorbar(
            index[order], rows + offset, xerr=spread[order], ls="", color="black", lw=1.2, capsize=2
        )
    bars.set_label(INTERVAL)
    shares.axvline(0.0, color=GREY, lw=1.0)
    shares.set_yticks(rows, [])
    shares.set_xlabel("share of the variance (Sobol index)")
    for ax in figure.axes:
        legend_below(ax)
    return figure


def elasticity_figure(optimum: "Optimum") -> "Figure":
    """Relative change of the objective over that of each number that is not free."""
    from lightflyer.files.drawing import legend_below, new_figure

    known = {name: value for name, value in optimum.elasticities.items() if np.isfinite(value)}
    names = list(reversed(known))  # the largest on top
    figure = new_figure(height=_FRAME + _ROW * len(names))
    (ax,) = figure.axes
    rows, values = np.arange(len(names)), np.array([known[name] for name in names])
    for sign, colour, words in ((1.0, MORE, "increases it"), (-1.0, LESS, "decreases it")):
        chosen = sign * values > 0.0
        ax.barh(rows[chosen], values[chosen], color=colour, label=f"more of the number {words}")
    ax.axvline(0.0, color=GREY, lw=1.0)
    ax.set_yticks(rows, [in_words(name) for name in names])
    part = optimum.problem.objectives[0]
    ax.set_xlabel(f"elasticity of {part.name.replace('_', ' ')} at the optimum [1]")
    ax.grid(alpha=_OPACITY, axis="x")
    legend_below(ax, most=1)
    return figure
