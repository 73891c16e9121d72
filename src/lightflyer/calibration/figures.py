"""Figure of a calibration: points, fit and residuals."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.calibration.problem import UNREACHABLE
from lightflyer.files.drawing import (
    INTERVAL,
    LINES,
    figure_for,
    legend_below,
    new_figure,
    plain_decades,
    series_style,
    shared_legend,
)
from lightflyer.files.palette import GREY, PALETTE

if TYPE_CHECKING:
    from lightflyer.calibration.bayes import Posterior
    from lightflyer.calibration.calibration import Calibration

_PERCENT = 100.0
_PARAMETER_WIDTH = 3.4  # of the histogram of a parameter [inch]
_CURVE_POINTS = 80  # of the fit of each sample
_TITLE = "points: measured; lines: fit"


def fitted_curve(fit: "Calibration", sample: str) -> tuple[np.ndarray, np.ndarray]:
    """The fitted irradiance of a sample over pressure [Pa], shape (n,)."""
    problem, here = fit.problem, np.flatnonzero(fit.points.of(sample))
    here = here[np.argsort(fit.points.pressure[here])]
    pressure, model = fit.points.pressure[here], problem.model
    alike = all(
        np.array_equal(rows, np.broadcast_to(rows[:, :1], rows.shape), equal_nan=True)
        for rows in (model.stated[:, here], model.index[:, here])
    )
    if not alike or pressure[0] == pressure[-1]:
        return pressure, fit.fitted[here]
    # as many points at a time as there are in the fit, for which the model is compiled
    batch = len(fit.points)
    batches = -(-_CURVE_POINTS // batch)
    fine = np.geomspace(pressure[0], pressure[-1], batch * batches)
    same = np.full(batch, here[0])  # all else as at one of the points
    stated, index, moves = model.stated[:, same], model.index[:, same], model.moves[..., same]
    model, found = replace(model, stated=stated, index=index, moves=moves), []
    for part in np.split(fine, batches):
        points = replace(problem.points, numbers=problem.points.numbers | {"pressure": part})
        there = replace(problem, points=points, model=model)
        found.append(there.linearise(np.log(fit.values)).value)
    light = np.concatenate(found)
    return fine, np.where(light < UNREACHABLE, np.exp(np.minimum(light, UNREACHABLE)), np.nan)


def fitted_points(fit: "Calibration", ax: Axes) -> Axes:
    """Draw the points and the fitted irradiance, against pressure."""
    points = fit.points
    for number, sample in enumerate(dict.fromkeys(points.samples)):
        here, style = points.of(sample), series_style(number)
        line: dict[str, Any] = {"ls": LINES[number % len(LINES)], "lw": 1.2}
        ax.plot(points.pressure[here], points.irradiance[here], ls="", mfc="none", **style)
        ax.plot(*fitted_curve(fit, sample), color=style["color"], **line)
        ax.plot([], [], mfc="none", label=sample, **style, **line)
    ax.set(xscale="log", yscale="log")
    plain_decades(ax.xaxis)
    plain_decades(ax.yaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("irradiance to levitate [W/m²]")
    return ax


def residuals(fit: "Calibration", ax: Axes) -> Axes:
    """Draw measured over fitted irradiance, with each point's uncertainty."""
    points = fit.points
    for number, sample in enumerate(dict.fromkeys(points.samples)):
        here = points.of(sample)
        ax.errorbar(
            points.pressure[here],
            _PERCENT * fit.residuals[here],
            yerr=_PERCENT * fit.uncertainty[here],
            ls="",
            mfc="none",
            **series_style(number),
        )
    ax.axhline(0.0, color=GREY, lw=1)
    ax.set_xscale("log")
    plain_decades(ax.xaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("residual of log-irradiance [%]\n(bars: ± standard uncertainty)")
    return ax


def calibration_figure(fit: "Calibration") -> Figure:
    """Points and fit on the left, residuals on the right."""
    figure = new_figure(columns=2, height=4.6)
    left, right = figure.axes
    fitted_points(fit, left)
    residuals(fit, right)
    shared_legend(figure, left.get_legend_handles_labels()[0], title=_TITLE)
    return figure


def plot_calibration(fit: "Calibration", ax: Axes | None = None) -> Figure:
    """Draw a calibration."""
    if ax is None:
        return calibration_figure(fit)
    figure, ax = figure_for(ax)
    fitted_points(fit, ax)
    legend_below(ax, title=_TITLE)
    return figure


def posterior_figure(drawn: "Posterior") -> Figure:
    """Histograms of the draws of each parameter, chain by chain, with the 95 % interval."""
    figure = new_figure(columns=len(drawn.names), width=_PARAMETER_WIDTH)
    for row, (name, ax) in enumerate(zip(drawn.names, figure.axes, strict=True)):
        values = drawn.draws[..., row]
        edges = np.histogram_bin_edges(values, bins="auto")
        for chain, one in enumerate(values):
            label = f"chain {chain + 1}"
            ax.hist(one, edges.tolist(), histtype="step", color=PALETTE[chain % len(PALETTE)],
                    ls=LINES[chain % len(LINES)], density=True, label=label)  # fmt: skip
        ax.axvspan(*drawn.intervals[row], color=GREY, alpha=0.2, lw=0, label=INTERVAL)
        ax.set_xlabel(name)
        ax.set_yticks([])
    figure.axes[0].set_ylabel("probability density")
    shared_legend(figure, figure.axes[0].get_legend_handles_labels()[0], most=5)
    return figure
