"""Figure of levitation points: curves of several samples, and the model's."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.core.units import scale_and_offset
from lightflyer.files import drawing
from lightflyer.files.palette import GREY, PALETTE
from lightflyer.lab.estimate import NORMAL_FACTOR

if TYPE_CHECKING:
    from lightflyer.lab.levitation.curve import LevitationCurve

_HEIGHT = 5.2
_PER_KILOWATT = 1e-3
_PERCENT = 100.0
_MODEL_STYLES = ("--", ":")
_FAR = 1e3  # times a value, beyond the axes
_OPACITY, _FEW = 0.2, 3  # of the band of each of so many curves, less of more
_ABOVE = 1.6  # factor by which the axes extend beyond the points

ModelCurves = Mapping[str, tuple[np.ndarray, np.ndarray]]
"""Pressure [Pa] and irradiance [W/m²] by the name of a sample."""


def levitation_curves(
    curves: "Sequence[LevitationCurve]",
    ax: Axes,
    *,
    pressure_unit: str = "Pa",
    models: Mapping[str, ModelCurves] | None = None,
) -> Axes:
    """Draw points with their stated ±, curves with their 95 % bands, and each minimum."""
    models = models or {}
    per_pascal = 1.0 / scale_and_offset(pressure_unit, "Pa")[0]
    opacity = _OPACITY / max(1.0, len(curves) / _FEW)
    for number, curve in enumerate(curves):
        colour, points = PALETTE[number % len(PALETTE)], curve.points
        marker = drawing.MARKERS[number % len(drawing.MARKERS)]
        pressure = curve.pressure * per_pascal
        ax.fill_between(pressure, curve.lower * _PER_KILOWATT, curve.upper * _PER_KILOWATT,
                        color=colour, alpha=opacity, lw=0)  # fmt: skip
        ax.plot(pressure, curve.irradiance * _PER_KILOWATT, color=colour, lw=1.4)
        ax.plot([], [], marker, ls="-", color=colour, mfc="none", ms=5, lw=1.4, label=points.name)
        light = points.irradiance * _PER_KILOWATT
        stated = points.uncertainties
        right, up = (
            NORMAL_FACTOR * scale * stated.get(f"{name}_uncertainty", np.zeros(light.size))
            for name, scale in (("pressure", per_pascal), ("irradiance", _PER_KILOWATT))
        )
        ax.errorbar(points.pressure * per_pascal, light, up, right, fmt=marker, color=colour,
                    mfc="none", ms=5, lw=0.7)  # fmt: skip
        if curve.step:  # the light that suffices lies on these lines
            ax.vlines(points.pressure * per_pascal, light - curve.step * _PER_KILOWATT, light,
                      color=colour, lw=0.8)  # fmt: skip
        least = curve.optimal_pressure, curve.minimum_irradiance
        x, y = (
            np.array([one.value, *one.interval]) * scale
            for one, scale in zip(least, (per_pascal, _PER_KILOWATT), strict=True)
        )
        # an open end is drawn as far as the axes go
        x, y = (np.where(np.isfinite(z), z, _FAR * z[0]) for z in (x, y))
        # an interval from resamples may not contain the estimate
        up, right = (np.maximum([[z[0] - z[1]], [z[2] - z[0]]], 0.0) for z in (y, x))
        ax.errorbar(x[0], y[0], up, right, color=colour, fmt="*", ms=9, mec="white", mew=0.5,
                    capsize=2, lw=1.2, zorder=4)  # fmt: skip
        for style, drawn in zip(_MODEL_STYLES, models.values(), strict=False):
            at, needed = drawn[points.name]
            ax.plot(at * per_pascal, needed * _PER_KILOWATT, color=colour, ls=style, lw=1)
    light = np.concatenate([curve.points.irradiance for curve in curves]) * _PER_KILOWATT
    drawing.label_axes(
        ax, f"pressure [{pressure_unit}]", "irradiance to levitate [kW/m²]", log="xy"
    )
    ax.set_ylim(light.min() / _ABOVE, light.max() * _ABOVE)
    for style, (name, lines) in zip(_MODEL_STYLES, models.items(), strict=False):
        needed = np.concatenate([drawn[1] for drawn in lines.values()]) * _PER_KILOWATT
        seen = np.any((needed > light.min() / _ABOVE) & (needed < light.max() * _ABOVE))
        label = name if seen else f"{name}: beyond the axes"
        ax.plot([], [], color=GREY, ls=style, lw=1, label=label)
    ax.plot(
        [], [], "*", color=GREY, ms=9, mec="white", mew=0.5, label=f"minimum, {drawing.INTERVAL}"
    )
    ax.fill_between([], [], [], color=GREY, alpha=0.3, lw=0, label="95 % band of a line")
    bars = ", with stated ± (95 %)" * any(curve.points.uncertainties for curve in curves)
    drawing.legend_below(ax, title=f"points: measured{bars}; solid lines: LOESS, twice")
    return ax


def residuals(curves: "Sequence[LevitationCurve]", ax: Axes, pressure_unit: str) -> Axes:
    """Draw measured over smoothed irradiance against pressure."""
    per_pascal = 1.0 / scale_and_offset(pressure_unit, "Pa")[0]
    for number, curve in enumerate(curves):
        points, colour = curve.points, PALETTE[number % len(PALETTE)]
        line = np.interp(np.log(points.pressure), np.log(curve.pressure), np.log(curve.irradiance))
        off = _PERCENT * (points.irradiance * np.exp(-line) - 1.0)
        stated = points.uncertainties.get("irradiance_uncertainty", np.zeros(off.size))
        up = _PERCENT * NORMAL_FACTOR * stated * np.exp(-line)
        ax.errorbar(points.pressure * per_pascal, off, up, color=colour, mfc="none", ms=5, lw=0.7,
                    fmt=drawing.MARKERS[number % len(drawing.MARKERS)])  # fmt: skip
    ax.axhline(0.0, color=GREY, lw=0.8)
    said = "measured over the line, less 1 [%]"
    drawing.label_axes(ax, f"pressure [{pressure_unit}]", said, log="x")
    return ax


def levitation_figures(
    curves: "Sequence[LevitationCurve]",
    *,
    pressure_unit: str = "Pa",
    models: Mapping[str, ModelCurves] | None = None,
) -> dict[str, Figure]:
    """Figure of several samples, by file name without suffix."""
    figure = drawing.new_figure(columns=2, height=_HEIGHT)
    levitation_curves(curves, figure.axes[0], pressure_unit=pressure_unit, models=models)
    residuals(curves, figure.axes[1], pressure_unit)
    return {"levitation": figure}
