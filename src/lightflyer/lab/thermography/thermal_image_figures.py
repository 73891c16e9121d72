"""Figure of a thermal image."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from lightflyer.files.drawing import new_figure

if TYPE_CHECKING:
    from lightflyer.lab.thermography.thermal_image import ThermalImage

_LARGEST = 6.0  # longer side of the axes [inch]


def plot_image(image: "ThermalImage") -> Figure:
    """Figure of the temperatures, row by row and column by column."""
    rows, columns = image.temperature.shape
    scale = _LARGEST / max(rows, columns)
    figure = new_figure(width=max(scale * columns, 2.5), height=max(scale * rows, 2.5))
    ax = figure.axes[0]
    shown = ax.imshow(image.temperature, cmap="inferno", interpolation="nearest")
    ax.set_xlabel("column")
    ax.set_ylabel("row")
    ax.set_title(image.source)
    figure.colorbar(shown, ax=ax, label="temperature [K]")
    return figure
