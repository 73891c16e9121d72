"""Figures of reflectance, transmittance and emissivity, and of a thermal image."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from lightflyer.files.drawing import INTERVAL, new_figure, outline_effects, shared_legend
from lightflyer.files.palette import BLUE, GREY, VERMILION

if TYPE_CHECKING:
    from lightflyer.lab.thermography.reduction import RadiativeProperties
    from lightflyer.lab.thermography.thermal_image import ThermalImage

Regions: TypeAlias = Mapping[str, tuple[slice, slice]]
"""Rows and columns of an image, by the name of what is seen there."""

_NONE: Regions = {}
_LARGEST = 6.0  # longer side of an image's axes [inch]
_WIDTH = 2.9  # of one property [inch]
_VISIBLE = 0.1  # of an interval, by which another one differs from it
_SPREAD = 0.3  # half the width over which rows are drawn


def draw_property(result: "RadiativeProperties", name: str, ax: Axes) -> Axes:
    """Draw a property of every row, and both intervals of its mean, on a scale of their own."""
    each = result.rows[list(result.first_order).index(name)]
    # side by side, so that equal rows stay apart
    spread = np.linspace(-_SPREAD, _SPREAD, each.size) if each.size > 1 else np.zeros(1)
    ax.plot(spread, each, "o", color=GREY, mfc="none", ms=5, label="rows")
    methods = [(result.first_order, BLUE, "s", "")]
    if any(  # differ to the eye
        np.abs(np.subtract(one.interval, result.monte_carlo[other].interval)).max()
        > _VISIBLE * np.ptp(one.interval)
        for other, one in result.first_order.items()
    ):
        methods = [(result.first_order, BLUE, "s", ", first order"),
                   (result.monte_carlo, VERMILION, "D", ", Monte Carlo")]  # fmt: skip
    for place, (estimates, colour, marker, label) in enumerate(methods, start=1):
        one = estimates[name]
        low, high = one.interval
        ends = np.maximum([[one.value - low], [high - one.value]], 0.0)  # rounding errors
        ax.errorbar(
            place, one.value, yerr=ends,
            fmt=marker, color=colour, capsize=5, ms=6, lw=1.6, label=f"mean, {INTERVAL}{label}",
        )  # fmt: skip
        said = f"{one.value:.3f}"
        ax.annotate(said, (place, high), (0, 6), textcoords="offset points", ha="center",
                    fontsize="small")  # fmt: skip
    ax.set_xlim(-0.6, len(methods) + 0.7)
    ax.set_xticks([])
    ax.margins(y=0.25)
    ax.set_xlabel(next(iter(result.name_properties({name: None}))))
    ax.grid(alpha=0.25, axis="y")
    return ax


def property_figures(results: "Sequence[RadiativeProperties]") -> dict[str, Figure]:
    """Figure of the properties of one result, by file name without suffix."""
    result = results[0]
    figure = new_figure(columns=len(result.first_order), width=_WIDTH)
    for name, ax in zip(result.first_order, figure.axes, strict=True):
        draw_property(result, name, ax)
    figure.axes[0].set_ylabel("fraction of the radiation [1]")
    figure.suptitle(result.meaning, fontsize="medium")
    shared_legend(figure, figure.axes[0].get_legend_handles_labels()[0])
    return {"thermography": figure}


def thermography_figures(
    result: "RadiativeProperties", image: "ThermalImage | None" = None, regions: Regions = _NONE
) -> dict[str, Figure]:
    """Figures of the properties, and of an image and its regions, by file name without suffix."""
    found = property_figures([result])
    return found if image is None else found | {"thermography-image": plot_image(image, regions)}


def plot_image(image: "ThermalImage", regions: Regions = _NONE) -> Figure:
    """Figure of the temperatures, row by row and column by column; ``regions`` by name."""
    rows, columns = image.temperature.shape
    scale = _LARGEST / max(rows, columns)
    figure = new_figure(width=max(scale * columns, 2.5), height=max(scale * rows, 2.5))
    ax = figure.axes[0]
    shown = ax.imshow(image.temperature, cmap="inferno", interpolation="nearest")
    for name, (down, across) in regions.items():
        size = across.stop - across.start, down.stop - down.start
        corner = across.start - 0.5, down.start - 0.5
        ax.add_patch(Rectangle(corner, *size, fill=False, ec="white",
                               path_effects=outline_effects()))  # fmt: skip
        said = f"{name}\n{image.temperature[down, across].mean():.1f} K"
        ax.text(across.start, down.start, said, color="white", va="top", fontsize="small",
                path_effects=outline_effects())  # fmt: skip
    ax.set_xlabel("column")
    ax.set_ylabel("row")
    ax.set_title(image.source)
    figure.colorbar(shown, ax=ax, label="temperature [K]")
    return figure
