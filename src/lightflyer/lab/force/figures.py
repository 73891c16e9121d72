"""Figure of a heated vane: predicted and measured force over pressure."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from lightflyer.files.drawing import BAND, label_axes, legend_below
from lightflyer.files.palette import BLUE
from lightflyer.lab.estimate import NORMAL_FACTOR

if TYPE_CHECKING:
    from lightflyer.lab.force.vane import VaneForces

MICRONEWTON = 1e-6
_DECADES = 2.5  # below the largest force that the axis shows, at most


def plot_forces(found: "VaneForces", ax: Axes) -> None:
    """Draw curve, band and points."""
    low, high = found.band / MICRONEWTON
    ax.fill_between(found.pressure, low, high, color=BLUE, alpha=0.2, lw=0, label=BAND)
    ax.plot(found.pressure, found.force / MICRONEWTON, color=BLUE, lw=1.5, label="predicted")
    shown = found.force
    if found.points is not None:
        numbers = found.points.numbers
        up, right = (
            NORMAL_FACTOR * numbers.get(f"{name}_uncertainty", np.zeros(found.predicted.size))
            for name in ("force", "pressure")
        )
        ax.errorbar(numbers["pressure"], numbers["force"] / MICRONEWTON, up / MICRONEWTON, right,
                    fmt="o", color="black", mfc="none", ms=5, lw=0.7, label="measured")  # fmt: skip
        shown = np.concatenate([shown, numbers["force"]])
    label_axes(ax, "pressure [Pa]", "force [µN]", log="xy")
    most = shown.max() / MICRONEWTON
    ax.set_ylim(max(0.5 * shown.min() / MICRONEWTON, most / 10**_DECADES), 2.0 * most)
    legend_below(ax)
