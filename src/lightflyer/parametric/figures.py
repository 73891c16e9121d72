"""Figures and text of sweeps: maps, the best design, and the best at each place of an axis."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from lightflyer.core.errors import ConfigurationError
from lightflyer.files.display_units import scale_and_label
from lightflyer.files.drawing import (
    BAND,
    EXTRAPOLATED,
    figure_for,
    legend_below,
    new_figure,
    outline_effects,
    plain_decades,
    wrap_label,
)
from lightflyer.files.palette import BLUE, GREEN, GREY, ORANGE, VERMILION
from lightflyer.files.result_text import table_of
from lightflyer.parametric.explore import (
    COSTS,
    best_design,
    choose_slice,
    find_name,
    front,
    less_is_better,
    margin_of_most,
    over_samples,
)
from lightflyer.study.axes import SAMPLE

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

_LEVELS = 12
_LOGARITHMIC = 3.0  # largest over smallest from which evenly spaced logarithms get a log axis
_DECADES = 100.0  # largest over smallest from which an output gets a log axis
_PROBABILITIES = (0.1, 0.5, 0.9)
_HALF = 0.5
_MARKED = 60  # designs along a line, up to which each has a marker
_FINE = 1001  # points at which a border between designs is looked for
_IN_A_LINE = 3  # fixed fields in a line of the title
_OPACITY = 0.25
# legend of hatched designs, without and with samples
_NOT_FLYING = ("cannot fly", "flies in less than half of the samples")
_OR_TOO_HOT = ", or its film is too hot"

_ROWS = 12


def _axis(ax: Axes, side: str, array: "xr.DataArray") -> np.ndarray:
    """Label one axis; returns the coordinate in the unit shown."""
    factor, label = scale_and_label(array)
    values = factor * np.asarray(array.values, float)
    getattr(ax, f"set_{side}label")(wrap_label(label))
    low = float(np.min(values))
    steps = np.diff(np.log(values)) if low > 0.0 and values.size > 2 else np.array([np.nan])
    if np.max(values) >= _LOGARITHMIC * low and np.allclose(steps, steps[0], rtol=1e-3):
        getattr(ax, f"set_{side}scale")("log")
        plain_decades(getattr(ax, f"{side}axis"))
    return values


def _fix_text(ax: Axes, dataset: "xr.Dataset", drawn: tuple[str, ...]) -> None:
    """Say above the axes what the fields that are not drawn are fixed at."""
    said = []
    for name, array in dataset.coords.items():
        if name not in drawn and not array.ndim and np.isfinite(float(array)):
            factor, label = scale_and_label(array)
            words, _, unit = label.partition(" [")
            number = f"{factor * float(array):.4g} {unit.removesuffix(']')}"
            said.append(f"{words} = {number}".rstrip())
    lines = [
        "; ".join(said[start : start + _IN_A_LINE]) for start in range(0, len(said), _IN_A_LINE)
    ]
    if lines:
        ax.set_title("at " + "\n".join(lines), fontsize="small")


def draw_map(dataset: "xr.Dataset", x: str, y: str, value: str, ax: Axes) -> Axes:
    """Contours of an output over two fields, each column's best, and where no design flies."""
    array, able = dataset[value], margin_of_most(dataset)
    sampled = SAMPLE in array.dims
    shown = over_samples(array)["median"] if sampled else array
    able = None if able is None else able.transpose(y, x)
    horizontal, vertical = _axis(ax, "x", dataset[x]), _axis(ax, "y", dataset[y])
    factor, label = scale_and_label(array)
    values = factor * shown.transpose(y, x).values
    values = np.where(np.isfinite(values), values, np.nan)
    flying = values if able is None else np.where(able.values >= 0.0, values, np.nan)
    if not np.isfinite(flying).any():
        flying = values
    handles = []
    _fix_text(ax, dataset, (x, y))
    if np.isfinite(flying).any():
        levels = MaxNLocator(_LEVELS).tick_values(np.nanmin(flying), np.nanmax(flying))
        filled = ax.contourf(
            horizontal,
            vertical,
            np.ma.masked_invalid(values),
            levels=levels,
            cmap="cividis",
            extend="min" if np.nanmin(values) < levels[0] else "neither",
        )
        bar = ax.get_figure().colorbar(filled, ax=ax)  # type: ignore[union-attr]
        bar.set_label(wrap_label(label) + ("\nmedian of the samples" if sampled else ""))
        handles += _fade_extrapolated(ax, horizontal, vertical, flying, dataset, (y, x))
        least = less_is_better(value)
        score = np.where(np.isfinite(flying), -flying if least else flying, -np.inf)
        even = np.log(vertical) if ax.get_yscale() == "log" else vertical
        best = np.array([_peak(even, column) for column in score.T])
        best = np.exp(best) if ax.get_yscale() == "log" else best
        words = "least" if least else "most"
        across = ax.get_xlabel().replace("\n", " ").partition(" [")[0]
        handles += ax.plot(
            horizontal,
            best,
            color=VERMILION,
            lw=2.0,
            label=f"{words} at each {across}",
            path_effects=outline_effects(3.5, "white"),
        )
    if able is not None:
        hatched = _not_flying(dataset, sampled=sampled)
        handles += _cannot_fly(ax, horizontal, vertical, able.values, hatched, sampled=sampled)
    legend_below(ax, handles, most=2)
    return ax


def _fade_extrapolated(
    ax: Axes,
    horizontal: np.ndarray,
    vertical: np.ndarray,
    flying: np.ndarray,
    dataset: "xr.Dataset",
    drawn: tuple[str, str],
) -> list[Any]:
    """Fade designs at which force model or gas are outside their ranges, as far as is known."""
    # ``flying``: values of those that fly, NaN elsewhere, shape (vertical, horizontal)
    if "covered" not in dataset:
        return []
    outside = dataset["covered"] < _HALF
    if SAMPLE in outside.dims:
        outside = outside.mean(SAMPLE) > _HALF
    level = outside.transpose(*drawn).values & np.isfinite(flying)
    if not level.any() or min(level.shape) < 2:
        return []
    veil = level.astype(float)
    ax.contourf(horizontal, vertical, veil, levels=[_HALF, 1.5], colors="white", alpha=0.65)
    return [Patch(facecolor="white", edgecolor=GREY, linewidth=0.5, label=EXTRAPOLATED)]


def _peak(places: np.ndarray, score: np.ndarray) -> float:
    """Where a score is largest: the top of the parabola through its three largest neighbours."""
    # At an end of the places, and beside one without a score, the place of the largest itself.
    best = int(np.argmax(score))
    if not np.isfinite(score[best]):
        return np.nan
    near = slice(best - 1, best + 2)
    if not 0 < best < places.size - 1 or not np.isfinite(score[near]).all():
        return float(places[best])
    curvature, slope, _ = np.polyfit(places[near] - places[best], score[near], 2)
    return float(places[best] - (slope / (2.0 * curvature) if curvature < 0.0 else 0.0))


def _not_flying(dataset: "xr.Dataset", *, sampled: bool) -> str:
    """What is said of hatched designs."""
    return _NOT_FLYING[sampled] + (_OR_TOO_HOT if "usable" in dataset else "")


def _cannot_fly(
    ax: Axes,
    horizontal: np.ndarray,
    vertical: np.ndarray,
    able: np.ndarray,
    label: str,
    *,
    sampled: bool,
) -> list[Any]:
    """Hatch where no design flies; with samples, lines of the probability of flying."""
    handles: list[Any] = []
    if np.any(able < 0.0):
        if min(able.shape) > 1:
            lowest = min(float(np.nanmin(able)), -1.0)
            known = np.ma.masked_invalid(able)
            area = ax.contourf(
                horizontal, vertical, known, levels=[lowest, 0.0], colors="white", hatches=["///"]
            )
            area.set_edgecolor(GREY)
            area.set_linewidth(0.0)
        handles.append(
            Patch(facecolor="white", edgecolor=GREY, hatch="///", linewidth=0.0, label=label)
        )
    if sampled and np.nanmax(able) > np.nanmin(able):
        chances = np.ma.masked_invalid(able) + _HALF
        for chance, style in zip(_PROBABILITIES, (":", "-", "--"), strict=True):
            lines = ax.contour(
                horizontal, vertical, chances, levels=[chance], colors="black",
                linestyles=[style], linewidths=1.2,
            )  # fmt: skip
            lines.set_path_effects(outline_effects(3.0, "white"))
            words = f"{100.0 * chance:g} % of the samples fly"
            handles.append(Line2D([], [], color="black", ls=style, lw=1.2, label=words))
    return handles


def draw_line(dataset: "xr.Dataset", x: str, value: str, ax: Axes) -> Axes:
    """An output over one field, with its 95 % band where there are samples; ``x``: field."""
    array, able = dataset[value], margin_of_most(dataset)
    horizontal = _axis(ax, "x", dataset[x])
    factor, label = scale_and_label(array)
    ax.set_ylabel(wrap_label(label))
    _fix_text(ax, dataset, (x,))
    # few designs are seen one by one, straight lines between them
    marker = "o" if horizontal.size <= _MARKED else ""
    if SAMPLE in array.dims:
        band = over_samples(array)
        low, middle, high = (factor * band[end].values for end in ("low", "median", "high"))
        shown = np.concatenate([low, middle, high])
        shown = shown[np.isfinite(shown)]
        if shown.size:  # infinite ends go to the end of the axis
            low, high = (np.clip(end, shown.min(), shown.max()) for end in (low, high))
        ax.fill_between(horizontal, low, high, color=BLUE, alpha=_OPACITY, lw=0, label=BAND)
        ax.plot(horizontal, np.where(np.isfinite(middle), middle, np.nan), color=BLUE,
                label="median of the samples", marker=marker, ms=3.5)  # fmt: skip
    else:
        shown = factor * array.values[np.isfinite(array.values)]
        ax.plot(
            horizontal,
            factor * array.values,
            color=BLUE,
            label="designs, joined by straight lines",
            marker=marker,
            ms=3.5,
        )
    if shown.size and 0.0 < _DECADES * shown.min() < shown.max():
        ax.set_yscale("log")
        plain_decades(ax.yaxis)
    if able is not None and bool((able < 0.0).any()):
        # between two designs, one of which flies, the border lies where their margin vanishes
        spaced = np.geomspace if ax.get_xscale() == "log" else np.linspace
        fine = spaced(horizontal[0], horizontal[-1], _FINE)
        order = np.argsort(horizontal)
        unable = np.interp(fine, horizontal[order], able.values[order]) < 0.0
        ax.fill_between(
            fine,
            0.0,
            1.0,
            where=unable,
            transform=ax.get_xaxis_transform(),
            facecolor="none",
            edgecolor=GREY,
            hatch="///",
            lw=0,
            label=_not_flying(dataset, sampled=SAMPLE in array.dims),
        )
    legend_below(ax)
    ax.grid(alpha=_OPACITY)
    return ax


def plot_sweep(
    dataset: "xr.Dataset",
    value: str,
    x: str,
    y: str | None = None,
    *,
    at: Mapping[str, str] | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Draw an output of a sweep over one or two of its fields.

    Parameters
    ----------
    dataset : xarray.Dataset
        From :func:`lightflyer.sweep`.
    value : str
        Output.
    x : str
        Field across, in full or its last part, such as ``"diameter"``.
    y : str, optional
        Field up; without it the value itself is drawn upwards.
    at : dict of str to str, optional
        Values of other fields, such as ``{"altitude": "70 km"}``; by default those of the best
        design.
    ax : matplotlib.axes.Axes, optional
        By default that of a new figure.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    ConfigurationError
        If a name is unknown, or a value is outside the sweep.

    See Also
    --------
    pareto_figure
    """
    output = find_name(dataset, value, among="outputs")
    fields = [find_name(dataset, name, among="fields") for name in (x, y) if name is not None]
    if len(set(fields)) < len(fields):
        raise ConfigurationError(f"plot: x and y are both {fields[0]}")
    sliced, _ = choose_slice(dataset, output, fields, at or {})
    figure, ax = figure_for(ax)
    if y is None:
        draw_line(sliced, fields[0], output, ax)
    else:
        draw_map(sliced, fields[0], fields[1], output, ax)
    return figure


def pareto_figure(dataset: "xr.Dataset", gain: str) -> Figure | None:
    """Pareto fronts of an output against altitude, irradiance and temperature; ``gain``: output."""
    costs = {
        name: sign
        for name, sign in COSTS.items()
        if name != gain and (name in dataset.dims or name in dataset.data_vars)
    }
    if not costs:
        return None
    figure = new_figure(columns=len(costs), width=4.6)
    for ax, (cost, sign), colour in zip(
        figure.axes, costs.items(), (BLUE, GREEN, ORANGE), strict=False
    ):
        _, gains, against = front(dataset, gain, cost)
        (up, label_up), (across, label_across) = map(
            scale_and_label, (dataset[gain], dataset[cost])
        )
        better = "more" if sign < 0.0 else "less"
        worth = "less" if less_is_better(gain) else "more"
        # the best of the designs computed: between two of them nothing is known
        ax.plot(across * against, up * gains, "o", color=colour, ms=4, label="best designs")
        ax.set_xlabel(f"{wrap_label(label_across)}\n({better} is better)")
        ax.set_ylabel(f"{wrap_label(label_up)}\n({worth} is better)")
        ax.grid(alpha=_OPACITY)
    return figure


def map_parts(dataset: "xr.Dataset", fields: list[str], output: str) -> "tuple[str, Table]":
    """The best design that is drawn, and the best at some values of the first field."""
    # ``dataset``: with one or two fields that are not fixed, as it is drawn
    best, word = best_design(dataset, output), "least" if less_is_better(output) else "largest"
    able, values = margin_of_most(dataset), dataset[output]
    if SAMPLE in values.dims:
        values = over_samples(values)["median"]
    values = values.where(np.isfinite(values))
    flying = values if able is None else values.where(able >= 0.0)
    finding = f"no design has a {output}"
    if best is not None:
        where = {name: best.where[name] for name in fields}
        finding = f"{word} {output}: {replace(best, where=where)}"
    if best is not None and not bool(flying.notnull().any()):
        finding = f"no design flies; {finding}"
    x, *others = fields
    places = np.linspace(0, flying.sizes[x] - 1, min(_ROWS, flying.sizes[x])).round().astype(int)
    flying = flying.isel({x: places})
    columns = [flying[x]]
    for y in others:
        columns.append(flying.idxmin(y) if less_is_better(output) else flying.idxmax(y))
        columns[-1].attrs, columns[-1].name = dataset[y].attrs, y
        flying = flying.min(y) if less_is_better(output) else flying.max(y)
    flying.attrs = dataset[output].attrs
    scales, headings = zip(*map(scale_and_label, [*columns, flying]), strict=True)
    rows = (
        [
            f"{scale * value:.4g}" if math.isfinite(value) else "–"
            for scale, value in zip(scales, row, strict=True)
        ]
        for row in zip(*(part.values for part in [*columns, flying]), strict=True)
    )
    return finding, table_of(headings, rows, left=(), collapse_padding=True, pad_edge=False)
