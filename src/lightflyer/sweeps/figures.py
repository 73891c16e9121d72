"""Figures of sweeps."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from lightflyer.foundation.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    VERMILION,
    new_figure,
    plain_decades,
)
from lightflyer.sweeps.distributions import SAMPLE
from lightflyer.sweeps.explore import less_is_better, margin, over_samples, pareto_front
from lightflyer.sweeps.shown import scale_and_label

if TYPE_CHECKING:
    import xarray as xr

_LEVELS = 12
_LOGARITHMIC = 3.0  # largest over smallest from which evenly spaced logarithms get a log axis
_DECADES = 100.0  # largest over smallest from which an output gets a log axis
_PROBABILITIES = (0.1, 0.5, 0.9)
_HALF = 0.5
_OPACITY = 0.25
# legend of hatched designs, without and with samples
_NOT_FLYING = ("cannot fly", "flies in less than half of the samples")
# what an output may be weighed against; -1 where more of that is better too
_COSTS = {"altitude": -1.0, "levitation_irradiance": 1.0, "temperature": 1.0}


def _is_logarithmic(values: np.ndarray) -> bool:
    """Whether values are spaced evenly in their logarithm, over a good span."""
    low = float(np.min(values))
    if values.size < 3 or low <= 0.0 or float(np.max(values)) < _LOGARITHMIC * low:
        return False
    steps = np.diff(np.log(values))
    return bool(np.allclose(steps, steps[0], rtol=1e-3))


def _axis(ax: Axes, side: str, array: "xr.DataArray") -> np.ndarray:
    """Label one axis; returns the coordinate in the unit shown."""
    factor, label = scale_and_label(array)
    values = factor * np.asarray(array.values, float)
    getattr(ax, f"set_{side}label")(label)
    if _is_logarithmic(values):
        getattr(ax, f"set_{side}scale")("log")
        axis = getattr(ax, f"{side}axis")
        plain_decades(axis)
        axis.set_minor_locator(LogLocator(subs=(2, 3, 5)))
        axis.set_minor_formatter("{x:g}")
    return values


def draw_map(dataset: "xr.Dataset", x: str, y: str, value: str, ax: Axes) -> Axes:
    """Contours of an output over two fields, its best design per column, and where no design flies.

    Parameters
    ----------
    dataset : xarray.Dataset
        A sweep with the dimensions ``x`` and ``y`` and perhaps samples, of which the
        median is drawn.
    x, y : str
        Fields.
    value : str
        Output.
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    array, able = dataset[value], margin(dataset)
    sampled = SAMPLE in array.dims
    shown = over_samples(array)["median"] if sampled else array
    if able is not None:
        able = ((able >= 0.0).mean(SAMPLE) - _HALF if sampled else able).transpose(y, x)
    horizontal, vertical = _axis(ax, "x", dataset[x]), _axis(ax, "y", dataset[y])
    factor, label = scale_and_label(array)
    values = factor * shown.transpose(y, x).values
    values = np.where(np.isfinite(values), values, np.nan)
    flying = values if able is None else np.where(able.values >= 0.0, values, np.nan)
    if not np.isfinite(flying).any():
        flying = values
    handles = []
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
        bar.set_label(f"median {label}" if sampled else label)
        handles += _best_per_column(ax, horizontal, vertical, flying, value)
    if able is not None:
        handles += _cannot_fly(ax, horizontal, vertical, able.values, sampled=sampled)
    if handles:
        ax.legend(
            handles=handles,
            loc="lower center",
            bbox_to_anchor=(0.5, 1.0),
            ncols=1 if sampled else 2,
            frameon=False,
        )
    return ax


def _best_per_column(
    ax: Axes, horizontal: np.ndarray, vertical: np.ndarray, values: np.ndarray, name: str
) -> list[Any]:
    """A line through the best design of each column."""
    least = less_is_better(name)
    score = np.where(np.isfinite(values), -values if least else values, -np.inf)
    known = np.isfinite(score).any(axis=0)
    best = np.where(known, vertical[np.argmax(score, axis=0)], np.nan)
    words = "least" if least else "most"
    across = ax.get_xlabel().partition(" [")[0]
    return ax.plot(horizontal, best, color=VERMILION, lw=1.6, label=f"{words} at each {across}")


def _cannot_fly(
    ax: Axes, horizontal: np.ndarray, vertical: np.ndarray, able: np.ndarray, *, sampled: bool
) -> list[Any]:
    """Hatch where no design flies; with samples, lines of the probability of flying."""
    handles: list[Any] = []
    if np.any(able < 0.0):
        if min(able.shape) > 1:
            lowest = min(float(able.min()), -1.0)
            area = ax.contourf(
                horizontal, vertical, able, levels=[lowest, 0.0], colors="white", hatches=["///"]
            )
            area.set_edgecolor(GREY)
            area.set_linewidth(0.0)
        handles.append(
            Patch(
                facecolor="white",
                edgecolor=GREY,
                hatch="///",
                linewidth=0.0,
                label=_NOT_FLYING[sampled],
            )
        )
    if sampled and np.ptp(able) > 0.0:
        chances = able + _HALF
        lines = ax.contour(
            horizontal, vertical, chances, levels=_PROBABILITIES, colors=GREY, linewidths=0.8
        )
        ax.clabel(lines, fmt=lambda level: f"{100.0 * level:g} % fly")
    return handles


def draw_line(dataset: "xr.Dataset", x: str, value: str, ax: Axes) -> Axes:
    """An output over one field, with its 95 % band where there are samples.

    Parameters
    ----------
    dataset : xarray.Dataset
        A sweep with the dimension ``x`` and perhaps samples.
    x : str
        Field.
    value : str
        Output.
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    array, able = dataset[value], margin(dataset)
    horizontal = _axis(ax, "x", dataset[x])
    factor, label = scale_and_label(array)
    ax.set_ylabel(label)
    if SAMPLE in array.dims:
        band = over_samples(array)
        low, middle, high = (factor * band[end].values for end in ("low", "median", "high"))
        shown = np.concatenate([low, middle, high])
        shown = shown[np.isfinite(shown)]
        if shown.size:  # infinite ends go to the end of the axis
            low, high = (np.clip(end, shown.min(), shown.max()) for end in (low, high))
        ax.fill_between(horizontal, low, high, color=BLUE, alpha=_OPACITY, lw=0, label="95 % band")
        ax.plot(horizontal, np.where(np.isfinite(middle), middle, np.nan), color=BLUE,
                label="median")  # fmt: skip
        able = None if able is None else (able >= 0.0).mean(SAMPLE) - _HALF
    else:
        shown = factor * array.values[np.isfinite(array.values)]
        ax.plot(horizontal, factor * array.values, color=BLUE)
    if shown.size and 0.0 < _DECADES * shown.min() < shown.max():
        ax.set_yscale("log")
    if able is not None and bool((able < 0.0).any()):
        ax.fill_between(
            horizontal,
            0.0,
            1.0,
            where=able.values < 0.0,
            transform=ax.get_xaxis_transform(),
            facecolor="none",
            edgecolor=GREY,
            hatch="///",
            lw=0,
            label=_NOT_FLYING[SAMPLE in array.dims],
        )
    if ax.get_legend_handles_labels()[0]:
        ax.legend()
    ax.grid(alpha=_OPACITY)
    return ax


def pareto_figure(dataset: "xr.Dataset", gain: str) -> Figure | None:
    """Pareto fronts of an output against altitude, irradiance and temperature.

    Parameters
    ----------
    dataset : xarray.Dataset
        A sweep.
    gain : str
        Output.

    Returns
    -------
    matplotlib.figure.Figure or None
        None where the sweep has none of these.
    """
    costs = {
        name: sign
        for name, sign in _COSTS.items()
        if name != gain and (name in dataset.dims or name in dataset.data_vars)
    }
    if not costs:
        return None
    figure = new_figure(columns=len(costs), width=4.6)
    for ax, (cost, sign), colour in zip(
        figure.axes, costs.items(), (BLUE, GREEN, ORANGE), strict=False
    ):
        gains, against = pareto_front(dataset, gain, cost, sign=sign)
        (up, label_up), (across, label_across) = map(
            scale_and_label, (dataset[gain], dataset[cost])
        )
        better = "more" if sign < 0.0 else "less"
        worth = "less" if less_is_better(gain) else "more"
        ax.plot(across * against, up * gains, ".-", color=colour, ms=4)
        ax.set_xlabel(f"{label_across}\n({better} is better)")
        ax.set_ylabel(f"{label_up}\n({worth} is better)")
        ax.grid(alpha=_OPACITY)
    return figure
