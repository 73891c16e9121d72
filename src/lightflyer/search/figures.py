"""Figures of Pareto fronts and sensitivities."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from lightflyer.files.display_units import in_words, scale_and_label
from lightflyer.files.drawing import INTERVAL, legend_below, new_figure, wrap_label
from lightflyer.files.palette import BLUE, GREEN, GREY, LESS, MORE, VERMILION

if TYPE_CHECKING:
    from lightflyer.search.front import Front
    from lightflyer.search.optimiser import Optimum
    from lightflyer.search.sobol import Indices

_OPACITY = 0.25
_TICKS = 6
_BAR = 0.4  # height, in rows
_FRAME, _ROW = 1.8, 0.45  # heights of all but the rows, and of a row [inch]


def front_figure(front: "Front") -> Figure:
    """The objectives of a Pareto front, each against the first."""
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


def tornado_figure(found: "Indices") -> Figure:
    """Effect of the uncertainty of each input on an output, the largest on top."""
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


def elasticity_figure(optimum: "Optimum") -> Figure:
    """Relative change of the objective over that of each number that is not free."""
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
