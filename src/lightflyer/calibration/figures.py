"""Figure of a calibration: points, fit and residuals."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.calibration.calibration import Calibration
from lightflyer.foundation.drawing import GREY, MARKERS, PALETTE, new_figure, plain_decades

_PERCENT = 100.0


def _style(number: int) -> dict[str, Any]:
    return {"color": PALETTE[number % len(PALETTE)], "marker": MARKERS[number % len(MARKERS)]}


def fitted_points(fit: Calibration, ax: Axes) -> Axes:
    """Draw the points and the fitted irradiance at them, against pressure.

    Parameters
    ----------
    fit : Calibration
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    points = fit.points
    for number, sample in enumerate(dict.fromkeys(points.samples)):
        here = np.flatnonzero(points.of(sample))
        here = here[np.argsort(points.pressure[here])]
        style = _style(number)
        pressure = points.pressure[here]
        ax.plot(pressure, points.irradiance[here], ls="", mfc="none", label=sample, **style)
        ax.plot(pressure, fit.fitted[here], color=style["color"], lw=1)
    ax.plot([], [], color=GREY, lw=1, label="fit, joined by straight lines")
    ax.set(xscale="log", yscale="log")
    plain_decades(ax.xaxis)
    plain_decades(ax.yaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("irradiance to levitate [W/m²]")
    ax.legend(fontsize="small")
    return ax


def residuals(fit: Calibration, ax: Axes) -> Axes:
    """Draw measured over fitted irradiance, with each point's uncertainty.

    Parameters
    ----------
    fit : Calibration
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    points = fit.points
    for number, sample in enumerate(dict.fromkeys(points.samples)):
        here = points.of(sample)
        ax.errorbar(
            points.pressure[here],
            _PERCENT * fit.residuals[here],
            yerr=_PERCENT * fit.uncertainty[here],
            ls="",
            mfc="none",
            **_style(number),
        )
    ax.axhline(0.0, color=GREY, lw=1)
    ax.set_xscale("log")
    plain_decades(ax.xaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("residual of log-irradiance [%]")
    return ax


def calibration_figure(fit: Calibration) -> Figure:
    """Points and fit on the left, residuals on the right.

    Parameters
    ----------
    fit : Calibration

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = new_figure(columns=2)
    left, right = figure.axes
    fitted_points(fit, left)
    residuals(fit, right)
    return figure
