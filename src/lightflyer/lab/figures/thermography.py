"""Figure of reflectance, transmittance and emissivity."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.foundation.drawing import BLUE, GREY, VERMILION, new_figure
from lightflyer.lab.thermography import PROPERTIES, RadiativeProperties

_OFFSET = 0.12  # half the distance between first order and Monte Carlo


def draw_properties(result: RadiativeProperties, ax: Axes) -> Axes:
    """Draw the properties of every row, and both intervals of their means.

    Parameters
    ----------
    result : RadiativeProperties
    ax : matplotlib.axes.Axes

    Returns
    -------
    matplotlib.axes.Axes
    """
    each = result.rows
    for number, name in enumerate(PROPERTIES):
        ax.plot(np.full(each.shape[1], number), each[number], "o", color=GREY, mfc="none", ms=4,
                label="rows" if number == 0 else None)  # fmt: skip
        ways = ((result.first_order, -_OFFSET, BLUE, "s", "first order"),
                (result.monte_carlo, _OFFSET, VERMILION, "D", "Monte Carlo"))  # fmt: skip
        for estimates, shift, colour, marker, label in ways:
            one = estimates[name]
            low, high = one.interval
            ends = np.maximum([[one.value - low], [high - one.value]], 0.0)  # rounding errors
            ax.errorbar(
                number + shift, one.value, yerr=ends,
                fmt=marker, color=colour, capsize=4, ms=5,
                label=f"{label}, 95 %" if number == 0 else None,
            )  # fmt: skip
    names = list(result.named(dict.fromkeys(PROPERTIES)))
    ax.set_xticks(range(len(names)), names)
    ax.set_xlim(-0.5, len(names) - 0.5)
    ax.axhline(0.0, color=GREY, lw=0.8)
    ax.set_ylabel("fraction of the radiation [1]")
    ax.set_title(result.meaning, fontsize="medium")
    ax.legend(fontsize="small")
    ax.grid(alpha=0.25, axis="y")
    return ax


def thermography_figures(result: RadiativeProperties) -> dict[str, Figure]:
    """Figure of the properties, by file name without suffix.

    Parameters
    ----------
    result : RadiativeProperties

    Returns
    -------
    dict of str to matplotlib.figure.Figure
    """
    figure = new_figure()
    draw_properties(result, figure.axes[0])
    return {"thermography": figure}
