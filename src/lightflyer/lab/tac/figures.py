"""Figure of accommodation coefficients: conductance of a heater against pressure."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.markers import CARETDOWNBASE

from lightflyer.files.drawing import (
    BLUE,
    GREY,
    MARKERS,
    PALETTE,
    figure_for,
    legend_below,
    new_figure,
    plain_decades,
)

if TYPE_CHECKING:
    from lightflyer.lab.tac.fit import TacFit

_TITLE = "points: measured; lines through them: fit"
_SHADED = (0.5, 1.5)  # range of coefficients that the paper shades
_MOST_POINTS = 3_000  # drawn of one run
_HEIGHT = 4.8


def _order(fit: "TacFit", most: int = _MOST_POINTS) -> np.ndarray:
    """Rows in the order of pressure, thinned evenly if there are very many."""
    return fit.order[:: max(1, len(fit.order) // most)]


def effective_conductance(fits: "Sequence[TacFit]", ax: Axes) -> Axes:
    """Draw the conductance per effective area against pressure, with the fit."""
    _shade(fits[0], ax, with_offset=True)
    for number, fit in enumerate(fits):
        rows, style = _order(fit), _style(number)
        ratio = fit.area_ratio.value
        ax.plot(fit.pressure[rows], fit.conductance[rows] / ratio, ls="", mfc="none", ms=4,
                rasterized=len(rows) > 1000, **style)  # fmt: skip
        ax.plot(fit.pressure[rows], fit.fitted[rows] / ratio, color=style["color"], lw=1.2)
        ax.plot([], [], mfc="none", ms=4, lw=1.2, label=_label(fit, len(fits)), **style)
    ax.axhline(fits[0].offset.value, color=GREY, ls=":", lw=1, label="offset (leads, radiation)")
    ax.set_xscale("log")
    plain_decades(ax.xaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("power / effective area / ΔT [W/(m² K)]")
    legend_below(ax, most=2, title=_TITLE)
    return ax


def _style(number: int) -> dict[str, Any]:
    return {"color": PALETTE[number % len(PALETTE)], "marker": MARKERS[number % len(MARKERS)]}


def _label(fit: "TacFit", count: int) -> str:
    low, high = fit.tac.interval
    found = f"α = {fit.tac.value:.3g} (95 %: {low:.3g} to {high:.3g})"
    return f"{fit.run.source}: {found}" if count > 1 else f"{found}, δ = {fit.area_ratio.value:.3g}"


def _shade(fit: "TacFit", ax: Axes, *, with_offset: bool) -> None:
    rows = _order(fit)
    ends = [
        fit.limits.conductance(tac)[rows] + with_offset * (fit.offset.value + fit.radiation[rows])
        for tac in _SHADED
    ]
    label = f"{_SHADED[0]:g} ≤ α ≤ {_SHADED[1]:g}"
    ax.fill_between(fit.pressure[rows], *ends, color="0.85", lw=0, label=label, zorder=0)


def gas_part(fits: "Sequence[TacFit]", ax: Axes) -> Axes:
    """Draw the conductance of the gas against pressure, with both limits for the first run."""
    first = fits[0]
    _shade(first, ax, with_offset=False)
    noise = first.scatter * float(np.median(first.conductance)) / first.area_ratio.value
    bottom = max(0.1 * noise, 1e-4)
    below = "at or below the axis"
    for number, fit in enumerate(fits):
        rows, style = _order(fit), _style(number)
        taken = fit.offset.value + fit.radiation[rows]
        gas = fit.conductance[rows] / fit.area_ratio.value - taken
        low = gas < bottom
        ax.plot(fit.pressure[rows], np.where(low, np.nan, gas), ls="", mfc="none", ms=4,
                rasterized=len(rows) > 1000, **style)  # fmt: skip
        if low.any():
            ax.plot(fit.pressure[rows][low], np.full(low.sum(), bottom), ls="",
                    marker=CARETDOWNBASE, color=style["color"], clip_on=False, zorder=5,
                    label=f"measured, {below}" if below else None)  # fmt: skip
            below = ""
        modelled = fit.limits.conductance(fit.tac.value)[rows]
        ax.plot(fit.pressure[rows], modelled, color=style["color"], lw=1.2)
    rows = _order(first)
    pressure, alpha = first.pressure[rows], first.tac.value
    ax.plot(pressure, alpha * first.free_molecular[rows], color=BLUE, ls="--", lw=1,
            label="free-molecular")  # fmt: skip
    ax.plot(pressure, first.continuum[rows], color=GREY, ls="-.", lw=1, label="continuum")
    ax.set_ylim(bottom, 3.0 * float(first.continuum[first.order[-1]]))
    ax.set(xscale="log", yscale="log")
    plain_decades(ax.xaxis)
    plain_decades(ax.yaxis)
    ax.set_xlabel("pressure [Pa]")
    ax.set_ylabel("conductance of the gas [W/(m² K)]")
    legend_below(ax, most=2)
    return ax


def tac_figures(fits: "Sequence[TacFit]") -> dict[str, Figure]:
    """Figure of one or several runs, by file name without suffix."""
    figure = new_figure(columns=2, height=_HEIGHT)
    left, right = figure.axes
    effective_conductance(fits, left)
    gas_part(fits, right)
    return {"tac": figure}


def plot_tac(fit: "TacFit", ax: Axes | None = None) -> Figure:
    """Draw one run."""
    if ax is None:
        return tac_figures([fit])["tac"]
    figure, ax = figure_for(ax)
    effective_conductance([fit], ax)
    return figure
