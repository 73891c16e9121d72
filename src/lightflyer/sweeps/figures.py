"""Figures of sweeps, optimisations and sensitivities."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, MaxNLocator

from lightflyer.flight.outputs import OUTPUTS
from lightflyer.foundation.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    VERMILION,
    new_figure,
    plain_decades,
)
from lightflyer.search.optimiser import Front
from lightflyer.search.sobol import Indices
from lightflyer.sweeps.axes import SAMPLE
from lightflyer.sweeps.explore import LESS_IS_BETTER, margin, over_samples, pareto_front, unit_of

if TYPE_CHECKING:
    import xarray as xr

_LEVELS = 12
_LOGARITHMIC = 3.0  # largest over smallest from which evenly spaced logarithms get a log axis
_PROBABILITIES = (0.1, 0.5, 0.9)
_HALF = 0.5
_OPACITY = 0.25
_TICKS = 6
# What hatched designs do, without and with samples.
_NOT_FLYING = ("cannot fly", "flies in less than half of the samples")
# Factors and units in which people think, by the last part of a name and by the unit.
_BY_NAME = {"diameter": (1e2, "cm"), "thickness": (1e9, "nm"), "areal_density": (1e3, "g/m²")}
_BY_UNIT = {
    "m": (1e-3, "km"),
    "kg": (1e6, "mg"),
    "N": (1e6, "µN"),
    "W m-2": (1.0, "W/m²"),
    "kg m-2": (1e3, "g/m²"),
    "degree": (1.0, "°"),
}
# What a payload may cost, and whether more of it is better too.
_COSTS = {"altitude": -1.0, "levitation_irradiance": 1.0, "temperature": 1.0}


def scale_and_label(array: "xr.DataArray") -> tuple[float, str]:
    """Factor and axis label with unit for a coordinate or an output.

    Parameters
    ----------
    array : xarray.DataArray

    Returns
    -------
    factor : float
    label : str
    """
    name = str(array.name)
    return _factor_and_label(name, unit_of(array), str(array.attrs.get("long_name", name)))


def _factor_and_label(name: str, unit: str, words: str) -> tuple[float, str]:
    last = name.rpartition(".")[2]
    factor, shown = _BY_NAME.get(last) or _BY_UNIT.get(unit, (1.0, unit))
    return factor, f"{words} [{shown}]" if shown else words


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
    """Contours of an output over two fields, its best design per column, and where none flies.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of a sweep, with the dimensions ``x`` and ``y`` and perhaps samples, whose median is
        drawn then.
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
    less_is_better = name in LESS_IS_BETTER
    score = np.where(np.isfinite(values), -values if less_is_better else values, -np.inf)
    known = np.isfinite(score).any(axis=0)
    best = np.where(known, vertical[np.argmax(score, axis=0)], np.nan)
    words = "least" if less_is_better else "most"
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
        Of a sweep, with the dimension ``x`` and perhaps samples.
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
        low, high = (factor * band[end].values for end in ("low", "high"))
        ax.fill_between(horizontal, low, high, color=BLUE, alpha=_OPACITY, lw=0, label="95 % band")
        ax.plot(horizontal, factor * band["median"].values, color=BLUE, label="median")
        able = None if able is None else (able >= 0.0).mean(SAMPLE) - _HALF
    else:
        ax.plot(horizontal, factor * array.values, color=BLUE)
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
    """Fronts of an output against altitude, irradiance and temperature, as far as they are known.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of a sweep.
    gain : str
        Output.

    Returns
    -------
    matplotlib.figure.Figure or None
        None where nothing is known that it could be weighed against.
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
        worth = "less" if gain in LESS_IS_BETTER else "more"
        ax.plot(across * against, up * gains, ".-", color=colour, ms=4)
        ax.set_xlabel(f"{label_across}\n({better} is better)")
        ax.set_ylabel(f"{label_up}\n({worth} is better)")
        ax.grid(alpha=_OPACITY)
    return figure


def front_figure(front: Front) -> Figure:
    """The objectives of a Pareto front, each against the first.

    Parameters
    ----------
    front : Front

    Returns
    -------
    matplotlib.figure.Figure
    """
    first, *others = front.problem.objectives
    figure = new_figure(columns=len(others))
    for ax, other in zip(figure.axes, others, strict=True):
        for part, side in ((first, "x"), (other, "y")):
            better = "more" if part.sign > 0.0 else "less"
            _, label = _scaled(part.name)
            getattr(ax, f"set_{side}label")(f"{label}\n({better} is better)")
        across, up = (
            _scaled(part.name)[0] * front.objectives[part.name] for part in (first, other)
        )
        ax.plot(across, up, "o", color=BLUE, ms=4)
        ax.grid(alpha=_OPACITY)
    return figure


def _scaled(output: str) -> tuple[float, str]:
    """Factor and label of an output."""
    known = OUTPUTS.get(output)
    if known is None:
        return 1.0, output.replace("_", " ")
    return _factor_and_label(output, "" if known.units == "1" else known.units, known.long_name)


def tornado_figure(found: Indices) -> Figure:
    """What the uncertainty of each input does to an output, the largest on top.

    The bar of two inputs that vary together reaches over the same quantiles of the output.

    Parameters
    ----------
    found : Indices

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = new_figure(columns=2, width=5.0, height=1.4 + 0.45 * len(found.names))
    bars, shares = figure.axes
    order = np.argsort(found.total)
    factor, label = _scaled(found.output)
    places = np.arange(order.size)
    for ends, colour, words in (
        (found.low, ORANGE, "input at its 2.5 % quantile"),
        (found.high, BLUE, "input at its 97.5 % quantile"),
    ):
        width = factor * (ends[order] - found.nominal)
        bars.barh(places, width, left=factor * found.nominal, color=colour, label=words)
    bars.axvline(factor * found.nominal, color=GREY, lw=1.0)
    bars.set_yticks(places, [" and\n".join(found.groups[number]) for number in order])
    bars.set_xlabel(label)
    bars.locator_params(axis="x", nbins=_TICKS)
    half = 0.4
    for index, spread, colour, words, offset in (
        (found.total, found.total_interval, GREEN, "total", half / 2.0),
        (found.first, found.first_interval, VERMILION, "alone", -half / 2.0),
    ):
        shares.barh(
            places + offset, index[order], half, xerr=spread[order], color=colour, label=words
        )
    shares.set_yticks(places, [])
    shares.set_xlabel("share of the variance (Sobol index)")
    for ax in (bars, shares):
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False)
    return figure
