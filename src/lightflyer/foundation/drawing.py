"""Figures. Only this module and ``*_figures`` import matplotlib; functions take and return axes.

Colours are Okabe and Ito's, which people with any colour vision can tell apart, and lines differ
in style too.
"""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from lightflyer.prediction.prediction import AltitudePrediction, ChamberPrediction

BLUE, ORANGE, GREEN, VERMILION, GREY = "#0072B2", "#E69F00", "#009E73", "#D55E00", "#777777"
PALETTE = (BLUE, VERMILION, GREEN, ORANGE, "black")
MARKERS = "osD^vP*X"

_KILOMETRE = 1e3
_MILLIGRAM = 1e-6

_IRRADIANCE_SPAN = 30.0  # how far above the least irradiance the axes reach
_DOTS_PER_INCH = 150


def new_figure(columns: int = 1, width: float = 6.0, height: float = 4.2, rows: int = 1) -> Figure:
    """An empty figure with axes in a row, or in several.

    Parameters
    ----------
    columns : int
    width : float
        Of each axes [inch].
    height : float
        Of the figure [inch].
    rows : int

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = Figure(figsize=(columns * width, height), layout="constrained")
    figure.subplots(rows, columns)
    return figure


def save(figure: Figure, paths: list[Path]) -> None:
    """Write a figure, the same bytes every time.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    paths : list of Path
        The suffix chooses the format, PNG or SVG.
    """
    figure.set_dpi(_DOTS_PER_INCH)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out: not again for every format
    # the canvases are called directly because savefig draws everything twice
    with mpl.rc_context({"svg.hashsalt": "lightflyer", "svg.fonttype": "none"}):
        for path in paths:
            if path.suffix == ".svg":
                blank = {"Date": None, "Creator": None}
                canvas: Any = FigureCanvasSVG(figure)
                canvas.print_svg(path, metadata=blank)
            else:
                canvas = FigureCanvasAgg(figure)
                canvas.print_png(path, metadata={"Software": None})


def plain_decades(axis: Axis) -> None:
    """Label decades in plain numbers, which read as well as powers and draw much faster.

    Parameters
    ----------
    axis : matplotlib.axis.Axis
        A logarithmic one.
    """
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axis.set_minor_locator(LogLocator(subs=range(2, 10)))
    axis.set_minor_formatter(NullFormatter())


def _interesting(prediction: AltitudePrediction) -> tuple[float, float]:
    """Altitude range worth drawing [km]: where flight takes not many times the light there is."""
    needed = prediction.table["levitation_irradiance"]
    if prediction.easiest is not None:
        least = prediction.easiest[1]["levitation_irradiance"][0]
        near = needed < _IRRADIANCE_SPAN * least
        ends = prediction.altitude[np.flatnonzero(near)[[0, -1]]]
    else:
        ends = prediction.best[0] + np.array([-15e3, 15e3])
        ends = np.clip(ends, prediction.altitude[0], prediction.altitude[-1])
    return float(ends[0]) / _KILOMETRE, float(ends[1]) / _KILOMETRE


def _shade_bands(prediction: AltitudePrediction, ax: Axes) -> None:
    for index, (lower, upper) in enumerate(prediction.bands):
        ax.axvspan(
            lower / _KILOMETRE,
            upper / _KILOMETRE,
            color=GREEN,
            alpha=0.15,
            lw=0,
            label="levitates" if index == 0 else None,
        )


def _altitude_axis(prediction: AltitudePrediction, ax: Axes) -> None:
    low, high = _interesting(prediction)
    ax.set_xlim(low, high)
    ax.set_xlabel("altitude [km]")
    ax.grid(alpha=0.25)
    # the same axis in pressure, through the table: log-pressure is monotonic in altitude
    altitude = prediction.altitude / _KILOMETRE
    log_pressure = np.log10(prediction.table["pressure"])

    def to_log_pressure(x: Any) -> np.ndarray:
        return np.interp(x, altitude, log_pressure)

    def to_altitude(x: Any) -> np.ndarray:
        return np.interp(x, log_pressure[::-1], altitude[::-1])

    top = ax.secondary_xaxis("top", functions=(to_log_pressure, to_altitude))
    decades = np.arange(np.floor(log_pressure.min()), np.ceil(log_pressure.max()) + 1)
    ticks = np.add.outer(decades, np.log10([1.0, 3.0])).ravel()
    inside = (ticks > to_log_pressure(high)) & (ticks < to_log_pressure(low))
    top.set_xticks(ticks[inside], [f"{10**tick:.2g}" for tick in ticks[inside]])
    top.set_xlabel("pressure [Pa]")


def irradiance_over_altitude(prediction: AltitudePrediction, ax: Axes, available: float) -> Axes:
    """Draw the smallest irradiance that levitates the flyer, against altitude.

    Parameters
    ----------
    prediction : AltitudePrediction
    ax : matplotlib.axes.Axes
    available : float
        Irradiance available [W/m²].

    Returns
    -------
    matplotlib.axes.Axes
    """
    altitude = prediction.altitude / _KILOMETRE
    needed = prediction.table["levitation_irradiance"]
    ax.plot(altitude, np.where(np.isfinite(needed), needed, np.nan), color=BLUE, label="needed")
    ax.axhline(available, color=ORANGE, ls="--", label="available")
    if prediction.easiest is not None:
        point, there = prediction.easiest
        least = there["levitation_irradiance"][0]
        ax.plot(point / _KILOMETRE, least, "o", color=BLUE, ms=5)
        label = f"{least:.0f} W/m²"
        ax.annotate(label, (point / _KILOMETRE, least), (0, -14), textcoords="offset points",
                    ha="center")  # fmt: skip
        ax.set_ylim(0.5 * least, _IRRADIANCE_SPAN * max(least, available) / 2)
    _shade_bands(prediction, ax)
    ax.set_yscale("log")
    plain_decades(ax.yaxis)
    ax.set_ylabel("irradiance [W/m²]")
    _altitude_axis(prediction, ax)
    ax.legend(loc="lower left")
    return ax


def temperature_over_altitude(prediction: AltitudePrediction, ax: Axes) -> Axes:
    """Draw the flyer's temperature, in the available light and when it just levitates.

    Parameters
    ----------
    prediction : AltitudePrediction
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    altitude = prediction.altitude / _KILOMETRE
    table = prediction.table
    ax.plot(altitude, table["temperature"], color=VERMILION, label="flyer, available light")
    ax.plot(
        altitude,
        table["levitation_temperature"],
        color=BLUE,
        ls="-.",
        label="flyer, just levitating",
    )
    ax.plot(altitude, table["gas_temperature"], color=GREY, ls=":", label="gas")
    _shade_bands(prediction, ax)
    low, high = _interesting(prediction)
    shown = (altitude >= low) & (altitude <= high)
    coldest, hottest = table["gas_temperature"][shown].min(), table["temperature"][shown].max()
    ax.set_ylim(coldest - 20.0, hottest + 0.4 * (hottest - coldest))
    ax.set_ylabel("temperature [K]")
    _altitude_axis(prediction, ax)
    ax.legend(loc="upper center", ncols=2, fontsize="small")
    return ax


def payload_over_altitude(prediction: AltitudePrediction, ax: Axes) -> Axes:
    """Draw the largest payload against altitude, with the relative payload on the right.

    Parameters
    ----------
    prediction : AltitudePrediction
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    altitude = prediction.altitude / _KILOMETRE
    payload = prediction.table["payload"] / _MILLIGRAM
    point, there = prediction.best
    best = there["payload"][0] / _MILLIGRAM
    own_mass = there["payload"][0] / there["relative_payload"][0] / _MILLIGRAM
    ax.plot(altitude, payload, color=BLUE)
    ax.plot(point / _KILOMETRE, best, "o", color=BLUE, ms=5)
    ax.annotate(f"{best:.3g} mg", (point / _KILOMETRE, best), (0, 7), textcoords="offset points",
                ha="center")  # fmt: skip
    ax.axhline(0.0, color=GREY, lw=0.8)
    _shade_bands(prediction, ax)
    low = min(0.0, best) - 0.35 * max(abs(best), 0.3 * own_mass)
    ax.set_ylim(low, best + 0.25 * (best - low))
    ax.set_ylabel("largest payload [mg]")
    right = ax.secondary_yaxis(
        "right", functions=(lambda mass: mass / own_mass, lambda ratio: ratio * own_mass)
    )
    right.set_ylabel("relative payload [own mass]")
    _altitude_axis(prediction, ax)
    if prediction.bands:
        ax.legend(loc="lower left")
    return ax


def irradiance_over_pressure(prediction: ChamberPrediction, ax: Axes) -> Axes:
    """Draw the smallest irradiance that levitates the flyer, against chamber pressure.

    Parameters
    ----------
    prediction : ChamberPrediction
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    needed = prediction.table["levitation_irradiance"]
    finite = np.isfinite(needed)
    ax.set_xscale("log")
    ax.set_yscale("log")
    plain_decades(ax.xaxis)
    plain_decades(ax.yaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("irradiance to levitate [W/m²]")
    ax.grid(alpha=0.25, which="both")
    if prediction.optimum is None:
        ax.set_xlim(prediction.pressure[0], prediction.pressure[-1])
        ax.text(0.5, 0.5, "does not levitate", transform=ax.transAxes, ha="center")
        return ax
    ax.plot(prediction.pressure[finite], needed[finite], color=BLUE)
    pressure, there = prediction.optimum
    least = there["levitation_irradiance"][0]
    ax.plot(pressure, least, "o", color=BLUE, ms=5)
    label = f"{least:.0f} W/m²\nat {pressure:.3g} Pa"
    ax.annotate(label, (pressure, least), (0, -28), textcoords="offset points", ha="center")
    near = finite & (needed < _IRRADIANCE_SPAN * least)
    ends = prediction.pressure[np.flatnonzero(near)[[0, -1]]]
    ax.set_xlim(ends[0], ends[1])
    ax.set_ylim(0.4 * least, _IRRADIANCE_SPAN * least)
    return ax


def temperature_map(prediction: ChamberPrediction, ax: Axes) -> Axes:
    """Draw the flyer's temperature over pressure and irradiance, with the levitation curve.

    Parameters
    ----------
    prediction : ChamberPrediction
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    image = ax.contourf(
        prediction.map_pressure,
        prediction.map_irradiance,
        prediction.map_temperature.T,
        levels=24,
        cmap="cividis",
    )
    ax.figure.colorbar(image, ax=ax, label="flyer temperature [K]")
    needed = prediction.table["levitation_irradiance"]
    shown = np.where(needed <= prediction.map_irradiance[-1], needed, np.nan)
    ax.plot(prediction.pressure, shown, color="white", lw=2, label="levitates above")
    ax.set_xscale("log")
    plain_decades(ax.xaxis)
    ax.set_xlim(prediction.map_pressure[0], prediction.map_pressure[-1])
    ax.set_ylim(prediction.map_irradiance[0], prediction.map_irradiance[-1])
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("irradiance [W/m²]")
    if np.isfinite(shown).any():
        ax.legend(loc="lower right", facecolor=GREY, labelcolor="white")
    return ax


def prediction_figures(
    prediction: AltitudePrediction | ChamberPrediction, available: float
) -> dict[str, Figure]:
    """The figures of a prediction, by file name without suffix.

    Parameters
    ----------
    prediction : AltitudePrediction or ChamberPrediction
    available : float
        Irradiance available [W/m²].

    Returns
    -------
    dict of str to matplotlib.figure.Figure
    """
    if isinstance(prediction, ChamberPrediction):
        irradiance, temperature = new_figure(), new_figure()
        irradiance_over_pressure(prediction, irradiance.axes[0])
        temperature_map(prediction, temperature.axes[0])
        return {"levitation-irradiance": irradiance, "temperature-map": temperature}
    band, payload = new_figure(columns=2), new_figure()
    left, right = band.axes
    irradiance_over_altitude(prediction, left, available)
    temperature_over_altitude(prediction, right)
    payload_over_altitude(prediction, payload.axes[0])
    return {"levitation-irradiance": band, "payload": payload}
