"""Uncertainty bands in a prediction's dataset and figures."""

from typing import TYPE_CHECKING

import numpy as np

from lightflyer.files.drawing import BAND, legend_below
from lightflyer.files.palette import GREY
from lightflyer.prediction.figures import across, display_unit_at_best, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lightflyer.uncertainty.propagation import PredictionUncertainty

_OPACITY = 0.2
_HEADROOM = 1.1
_FAR = 1e9  # beyond every axis


def add_to_figures(figures: "dict[str, Figure]", uncertainty: "PredictionUncertainty") -> None:
    """Shade the 95 % bands around the lines of a prediction's figures."""
    irradiance, temperature = figures["levitation-irradiance"].axes[:2]
    payload = figures["payload"].axes[0]
    for panel, ax in (
        ("irradiance", irradiance),
        ("temperature", temperature),
        ("payload", payload),
    ):
        add_bands(panel, ax, uncertainty)


_BANDS = {
    "irradiance": {"needed to levitate": "levitation_irradiance"},
    "temperature": {"just levitating": "levitation_temperature", "available light": "temperature"},
    "payload": {"largest payload": "payload"},
}
"""By panel, the outputs that have bands, by the ends of their lines' labels."""


def add_bands(panel: str, ax: "Axes", uncertainty: "PredictionUncertainty") -> None:
    """Shade the 95 % bands around the lines of one panel; ``ax``: with that panel; changed."""
    bands = _BANDS.get(panel, {})
    for label, output in bands.items():
        _shade(ax, label, output, uncertainty)
    if panel == "payload":
        scale, _ = display_unit_at_best(uncertainty.prediction, "payload")
        bottom, top = ax.get_ylim()
        highest = _HEADROOM * scale * float(np.nanmax(uncertainty.high["payload"]))
        ax.set_ylim(bottom, max(top, highest))
    if bands:
        # one entry for bands of several colours
        ax.fill_between([], [], [], color=GREY, alpha=2.0 * _OPACITY, lw=0, label=BAND)
        legend_below(ax)


def plot_uncertainty(
    uncertainty: "PredictionUncertainty", what: str | None = None, ax: "Axes | None" = None
) -> "Figure":
    """Draw a prediction with its 95 % bands."""
    figure, drawn = panels(uncertainty.prediction, what, ax)
    for panel, axes in drawn:
        add_bands(panel, axes, uncertainty)
    return figure


def _shade(ax: "Axes", label: str, output: str, uncertainty: "PredictionUncertainty") -> None:
    """Shade a band in the colour of its line, the first whose label ends so."""
    scale, _ = display_unit_at_best(uncertainty.prediction, output)
    low, high = uncertainty.low[output] * scale, uncertainty.high[output] * scale
    # a lower end without an upper one: some samples need more light than there is a number for
    ceiling = np.where(np.isfinite(low) & ~np.isfinite(high), _FAR, high)
    lines = (line for line in ax.get_lines() if str(line.get_label()).endswith(label))
    colour = next(lines).get_color()
    places = uncertainty.coordinate * across(uncertainty.prediction)
    ax.fill_between(places, low, ceiling, color=colour, alpha=_OPACITY, lw=0, zorder=0)
