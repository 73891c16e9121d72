"""Figure of accommodation coefficients: conductance of a heater against pressure."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.files import drawing
from lightflyer.files.palette import BLUE, GREY, MEASURED
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate

if TYPE_CHECKING:
    from lightflyer.lab.tac.difference import TacDifference
    from lightflyer.lab.tac.fit import TacFit, TacRuns

_TITLE = "points: measured; lines through them: fit"
_SHADED = (0.5, 1.5)  # range of coefficients that the paper shades
_MOST_POINTS = 3_000  # drawn of one run
_HEIGHT = 4.8
_PERCENT = 100.0
_ELLIPSE_POINTS = 181
_ROOM = 1.25  # half width of axes over the longest error bar


def _order(fit: "TacFit") -> np.ndarray:
    """Rows in the order of pressure, thinned evenly if there are very many."""
    return fit.order[:: max(1, len(fit.order) // _MOST_POINTS)]


def effective_conductance(fits: "Sequence[TacFit]", ax: Axes) -> Axes:
    """Draw the conductance per effective area against pressure, with the fit."""
    first, rows = fits[0], _order(fits[0])
    beside = first.offset.value + first.radiation[rows]
    ends = [first.limits.conductance(tac)[rows] + beside for tac in _SHADED]
    ax.fill_between(first.pressure[rows], *ends, color="0.85", lw=0, zorder=0,
                    label=f"{_SHADED[0]:g} ≤ α ≤ {_SHADED[1]:g}")  # fmt: skip
    for number, fit in enumerate(fits):
        rows, style = _order(fit), drawing.series_style(number)
        ratio = fit.area_ratio.value
        ax.plot(fit.pressure[rows], fit.conductance[rows] / ratio, ls="", mfc="none", ms=4,
                rasterized=len(rows) > 1000, **style)  # fmt: skip
        ax.plot(fit.pressure[rows], fit.fitted[rows] / ratio, color=style["color"], lw=1.2)
        low, high = fit.tac.interval
        found = f"α = {fit.tac.value:.3g} (95 %: {low:.3g} to {high:.3g})"
        said = f"{fit.run.source}: {found}"
        if len(fits) == 1:
            said = f"{found}, δ = {fit.area_ratio.value:.3g}"
        ax.plot([], [], mfc="none", ms=4, lw=1.2, label=said, **style)
    rows = _order(first)
    ax.axhline(first.offset.value, color=GREY, ls=":", lw=1, label="offset (leads, radiation)")
    shown = ax.get_ylim()
    for limit, colour, dashes, name in (
        (first.tac.value * first.limits.free_molecular, BLUE, "--", "free-molecular and offset"),
        (first.limits.continuum(first.tac.value), GREY, "-.", "continuum and offset"),
    ):
        ax.plot(first.pressure[rows], limit[rows] + beside, color=colour, ls=dashes, lw=1,
                label=name)  # fmt: skip
    ax.set_ylim(*shown)
    drawing.label_axes(ax, "pressure [Pa]", "power / effective area / ΔT [W/(m² K)]", log="x")
    drawing.legend_below(ax, most=2, title=_TITLE)
    return ax


def residuals(fits: "Sequence[TacFit]", ax: Axes) -> Axes:
    """Draw measured over fitted conductance against pressure, with the scatter of the first run."""
    for number, fit in enumerate(fits):
        rows, style = _order(fit), drawing.series_style(number)
        off = _PERCENT * (fit.conductance[rows] / fit.fitted[rows] - 1.0)
        ax.plot(fit.pressure[rows], off, ls="", mfc="none", ms=4, rasterized=len(rows) > 1000,
                **style)  # fmt: skip
    ends = NORMAL_FACTOR * _PERCENT * fits[0].scatter
    ax.axhspan(-ends, ends, color="0.85", lw=0, zorder=0, label="95 % of independent rows")
    ax.axhline(0.0, color=GREY, lw=0.8)
    drawing.label_axes(ax, "pressure [Pa]", "measured over fitted, less 1 [%]", log="x")
    drawing.legend_below(ax)
    return ax


def tac_figures(fits: "Sequence[TacFit]") -> dict[str, Figure]:
    """Figure of one or several runs, by file name without suffix."""
    figure = drawing.new_figure(columns=2, height=_HEIGHT)
    left, right = figure.axes
    effective_conductance(fits, left)
    residuals(fits, right)
    return {"tac": figure}


def both_faces(found: "TacDifference", ax: Axes) -> Axes:
    """Draw the coefficients of both faces with their joint error, and lines of equal difference."""
    x, y = found.tac_bottom, found.tac_top
    spread = np.array([x.uncertainty or 0.0, y.uncertainty or 0.0])
    related = found.tac_correlation
    # an ellipse whose projections are the 95 % intervals of both coefficients and the difference
    turn = np.linspace(0.0, 2.0 * np.pi, _ELLIPSE_POINTS)
    along = np.array(
        [np.cos(turn), related * np.cos(turn) + np.sqrt(1 - related**2) * np.sin(turn)]
    )
    ellipse = np.array([[x.value], [y.value]]) + NORMAL_FACTOR * spread[:, None] * along
    ax.plot(*ellipse, color=MEASURED, lw=1.2, label="both together; its extents are 95 % intervals")
    ax.errorbar(
        x.value, y.value, xerr=_arms(x), yerr=_arms(y), color=MEASURED, marker="o", ms=4, lw=0.8,
        capsize=3, ls="", label="each face, 95 % interval",
    )  # fmt: skip
    # the same scale both ways, so that lines of equal difference are at 45°
    half = _ROOM * max(np.max(np.abs(_arms(one))) for one in (x, y))
    ends = np.array([x.value - half, x.value + half])
    first, last = found.difference.interval
    ax.fill_between(
        ends, ends + first, ends + last, color=BLUE, alpha=0.2, lw=0,
        label=f"top less bottom: {found.difference.value:.3g} (95 %: {first:.3g} to {last:.3g})",
    )  # fmt: skip
    ax.plot(ends, ends, color=GREY, ls=":", lw=1, label="equal faces: no force")
    ax.set_xlim(*ends)
    ax.set_ylim(y.value - half, y.value + half)
    ax.set_aspect("equal")
    drawing.label_axes(ax, "TAC of the bottom face", "TAC of the top face")
    drawing.legend_below(ax, most=1)
    return ax


def _arms(one: Estimate) -> np.ndarray:
    """Lengths of error bars below and above a value, shape (2, 1)."""
    low, high = one.interval
    return np.array([[one.value - low], [high - one.value]])


def bench_figures(found: "TacRuns | TacDifference") -> dict[str, Figure]:
    """Figures of all runs, and of the coefficients of both faces, by file name without suffix."""
    faces = {"tac-difference": found.plot()} if hasattr(found, "plot") else {}
    return tac_figures(found.fits) | faces
