"""Figure of a comparison: payload, payload per area, lift over weight and temperature."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lightflyer.core.errors import ParameterError
from lightflyer.core.units import scale_and_offset
from lightflyer.files.drawing import (
    BAND,
    LINES,
    figure_for,
    legend_below,
    new_figure,
    plain_decades,
    shared_legend,
)
from lightflyer.files.palette import GREY, PALETTE

if TYPE_CHECKING:
    from lightflyer.comparison.comparison import Compared, Comparison

PANELS = ("payload", "payload_per_area", "lift_over_weight", "temperature")
"""Outputs that are drawn."""

_OPACITY = 0.15
_MANY = 20.0  # ratio of the largest to the smallest best value from which on an axis has decades
_DECADES = 1e-3  # of the largest value, down to which such an axis goes
_SHARE = 0.1  # of the smallest best value, drawn below it
_HEADROOM = 1.25
_MARGIN = 20.0  # kelvins
_LABELS = {
    "payload": "largest payload",
    "payload_per_area": "payload per area",
    "lift_over_weight": "lift over weight",
    "temperature": "temperature, available light",
}
_TOO_HOT = "hotter than the film withstands"
_EXTRAPOLATED = "outside the range of force model or gas"
_SHAPES: dict[str, dict[str, Any]] = {
    _TOO_HOT: {"marker": "x", "ms": 5.0},
    _EXTRAPOLATED: {"marker": "o", "ms": 4.0, "mfc": "none"},
}
_MARKS = 30  # along an axis
_BELOW = 0.2  # of the largest payload, drawn below zero


def comparison_figure(comparison: "Comparison") -> Figure:
    """The figure of a comparison."""
    rows = len(comparison.flyers) + 3
    figure = new_figure(columns=2, rows=2, height=7.0 + 0.22 * rows)
    handles = {}
    for ax, output in zip(figure.axes, PANELS, strict=True):
        handles = draw(comparison, output, ax)
    shared_legend(figure, list(handles.values()), most=1)
    return figure


def plot_comparison(
    comparison: "Comparison", output: str | None = None, ax: Axes | None = None
) -> Figure:
    """Draw a comparison, or one output of it."""
    known = ", ".join(PANELS)
    if output is None:
        if ax is not None:
            raise ParameterError(f"plot: axes hold one output: say which, one of {known}")
        return comparison_figure(comparison)
    if output not in PANELS:
        raise ParameterError(f'plot: output = "{output}": choose from {known}')
    figure, ax = figure_for(ax, height=4.6)
    legend_below(ax, list(draw(comparison, output, ax).values()), most=1)
    return figure


def draw(comparison: "Comparison", output: str, ax: Axes) -> dict[str, Any]:
    """Draw one output of all flyers; for a legend, by label; ``output``: one of :data:`PANELS`."""
    where = comparison.coordinate
    places = comparison.coordinates * scale_and_offset(where.unit, where.shown_unit)[0]
    scale, unit = comparison.display_unit(output)
    handles: dict[str, Any] = {}
    for index, found in enumerate(comparison.flyers):
        colour, style = PALETTE[index % len(PALETTE)], LINES[index % len(LINES)]
        named = "" if found.description.startswith(f"{found.name},") else f"{found.name}: "
        label = f"{named}{found.description}"
        values = found.table[output] * scale
        (handles[label],) = ax.plot(places, values, color=colour, ls=style, label=label)
        band = found.band(output)
        if band is not None:
            low, high = (end * scale for end in band)
            ax.fill_between(places, low, high, color=colour, alpha=_OPACITY, lw=0, zorder=0)
    for index, found in enumerate(comparison.flyers):
        highest = found.prediction.verdict.highest_temperature
        marks = {
            _TOO_HOT: found.table["temperature"] > (np.inf if highest is None else highest),
            _EXTRAPOLATED: found.table["covered"] < 1.0,
        }
        for meaning, there in marks.items():
            rows = np.flatnonzero(there)[2 * index :: max(1, places.size // _MARKS)]
            drawn = {"color": PALETTE[index % len(PALETTE)], "ls": "", **_SHAPES[meaning]}
            if rows.size:
                ax.plot(places[rows], scale * found.table[output][rows], **drawn)
                handles[meaning] = Line2D([], [], label=meaning, **drawn | {"color": GREY})
    if any(found.uncertainty is not None for found in comparison.flyers):
        handles[BAND] = Patch(color=GREY, alpha=2.0 * _OPACITY, lw=0, label=BAND)
    _limit(comparison, output, ax)
    if where.logarithmic:
        ax.set_xscale("log")
        plain_decades(ax.xaxis)
    ax.set_xlim(places[0], places[-1])
    ax.set_xlabel(f"{where.long_name.rpartition(' ')[2]} [{where.shown_unit}]")
    ax.set_ylabel(f"{_LABELS[output]} [{unit.replace('^2', '²')}]" if unit else _LABELS[output])
    ax.grid(alpha=0.25)
    return handles


def _limit(comparison: "Comparison", output: str, ax: Axes) -> None:
    """Scale and limits of an axis, so that every flyer's best is seen."""
    scale, _ = comparison.display_unit(output)
    tops = np.array([_top(found, output) * scale for found in comparison.flyers])
    if output == "temperature":
        coldest = min(float(np.nanmin(found.table[output])) for found in comparison.flyers)
        ax.set_ylim(coldest - _MARGIN, float(tops.max()) + _MARGIN)
        return
    if output == "lift_over_weight":
        ax.axhline(1.0, color=GREY, lw=0.8)
    positive = tops[tops > 0.0]
    largest = float(tops.max())
    if positive.size and largest > _MANY * float(positive.min()):
        lowest = min(_DECADES * largest, _SHARE * float(positive.min()))
        ax.set_yscale("log")
        plain_decades(ax.yaxis)
        ax.set_ylim(lowest, _HEADROOM * largest)
    elif output == "lift_over_weight":
        ax.set_ylim(0.0, _HEADROOM * max(largest, 1.0))
    elif largest > 0.0:
        ax.axhline(0.0, color=GREY, lw=0.8)
        ax.set_ylim(-_BELOW * largest, _HEADROOM * largest)


def _top(found: "Compared", output: str) -> float:
    """Largest value of an output, or of its band."""
    band = found.band(output)
    values = found.table[output] if band is None else np.fmax(found.table[output], band[1])
    return float(np.nanmax(values))
