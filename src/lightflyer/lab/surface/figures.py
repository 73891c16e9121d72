"""Figure of height maps: levelled, and with particles and holes masked."""

from collections.abc import Sequence
from string import ascii_lowercase
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import Patch
from scipy import ndimage

from lightflyer.files import drawing
from lightflyer.files.palette import GREY, SKY, VERMILION
from lightflyer.lab.readers.height_map import NANOMETRE

if TYPE_CHECKING:
    from lightflyer.lab.surface.reduction import Roughness

_WIDTH = 4.0  # of the column of one map [inch]
# Beside the maps of a row, left of each, above each, below each, and at the bottom [inch]
_BAR, _LABELS, _TITLE, _TICKS, _LEGEND = 1.05, 0.58, 0.42, 0.24, 0.5
_BAR_LEFT, _BAR_WIDTH, _BAR_HEIGHT = 0.2, 0.1, 0.8  # of a colour bar [inch; inch; of its map]
_LONGEST = 3.0  # over its width, that a map is drawn in its shape
_MOST_PIXELS = 1024  # drawn along a side
_SHOWN = 3.5  # range of the colours, in rms heights
_MICROMETRE = 1e-6
_PERCENT = 100.0
_BINS = 80
_NM2_UM2 = NANOMETRE**2 * _MICROMETRE**2


def colour_range(results: "Sequence[Roughness]", *, masked: bool) -> tuple[float, float]:
    """Heights between which colours change, the same for maps that are compared [nm]."""
    if masked:
        rough = max(one.parameters["rms_height"].value for one in results)
        return -_SHOWN * rough, _SHOWN * rough
    low = min(float(one.height.min()) for one in results) / NANOMETRE
    high = max(float(one.height.max()) for one in results) / NANOMETRE
    return low, max(high, low + 1e-12)


def draw_height_map(
    result: "Roughness", ax: Axes, *, masked: bool, colours: tuple[float, float] | None = None
) -> AxesImage:
    """Draw a levelled map, as it is or with its mask; ``colours`` [nm]; for a colour bar."""
    step = max(1, max(result.height.shape) // _MOST_PIXELS)
    # levelling puts numbers where the file has no height; they are shown in the colour of holes
    ax.set_facecolor(SKY)
    known = np.where(result.source.missing, np.nan, result.height)
    height = known[::step, ::step] / NANOMETRE
    extent = (0.0, result.source.width / _MICROMETRE, 0.0, result.source.length / _MICROMETRE)
    low, high = colour_range([result], masked=masked) if colours is None else colours
    # greys, among which the colours of the mask stand out
    image = ax.imshow(height, extent=extent, cmap="gray", vmin=low, vmax=high,
                      interpolation="nearest")  # fmt: skip
    if masked:
        rms = result.parameters["rms_height"].value
        painted = np.zeros((*height.shape, 4), np.uint8)
        for _, mask, colour in _masks(result):
            # every so many pixels, in which none that is masked gets lost
            thin = ndimage.maximum_filter(mask, step, origin=-((step - 1) // 2))[::step, ::step]
            painted[thin > 0] = np.multiply(255, to_rgba(colour))
        ax.imshow(painted, extent=extent, interpolation="nearest")
        shares = ", ".join(
            f"{name} {_PERCENT * mask.mean():.2g} %"
            for name, mask, _ in _masks(result)
            if mask.any()
        )
        said = f"Sq = {rms:.3g} nm\nmasked: {shares or 'nothing'}"
    else:
        everything = result.parameters_all["rms_height"].value
        said = f"{result.source.source}\nSq = {everything:.3g} nm, all of it"
    # at a stated place: Matplotlib measures all ticks again and again to find it by itself
    ax.set_title(said, fontsize="small", y=1.0)
    return image


def _masks(result: "Roughness") -> tuple[tuple[str, np.ndarray, str], ...]:
    return ("particles", result.particles, VERMILION), ("holes", result.holes, SKY)


def roughness_figures(results: "Sequence[Roughness]") -> dict[str, Figure]:
    """Figure of several maps, by file name without suffix.

    Parameters
    ----------
    results : sequence of Roughness
        One column each: all of the map above, masked below; each row has one scale.

    Returns
    -------
    dict of str to matplotlib.figure.Figure
    """
    count = len(results)
    longest = max(one.source.length / one.source.width for one in results)
    figure = drawing.new_figure(columns=count, width=_WIDTH, rows=2)
    # laid out here: Matplotlib's engine would draw everything three times to measure it
    figure.set_layout_engine("none")
    scale = mpl.rcParams["font.size"] / mpl.rcParamsDefault["font.size"]
    bar, labels, title, ticks, legend = np.multiply(scale, (_BAR, _LABELS, _TITLE, _TICKS, _LEGEND))
    width = figure.get_figwidth()
    side = (width - bar) / count - labels
    up = side * min(longest, _LONGEST)
    height = 2.0 * (title + up + ticks) + legend
    figure.set_figheight(height)
    axes = figure.axes
    for masked, row in enumerate((axes[:count], axes[count:])):
        colours = colour_range(results, masked=bool(masked))
        bottom = legend + ticks + (0 if masked else up + title + ticks)
        for number, (result, ax) in enumerate(zip(results, row, strict=True), masked * count):
            left = labels + number % count * (side + labels)
            ax.set_position((left / width, bottom / height, side / width, up / height))
            image = draw_height_map(result, ax, masked=bool(masked), colours=colours)
            ax.locator_params(nbins=4)
            ax.set_xlabel("x [µm]" if masked else "")
            ax.set_ylabel("y [µm]" if ax is row[0] else "")
            letter = ascii_lowercase[number % len(ascii_lowercase)]
            ax.text(0.02, 0.98, f"({letter})", transform=ax.transAxes, va="top", color="white",
                    weight="bold", path_effects=drawing.outline_effects())  # fmt: skip
        label = "height of the surface [nm]" if masked else "height [nm]"
        extend = "both" if masked else "neither"
        left, bottom = width - bar + scale * _BAR_LEFT, bottom + 0.5 * (1.0 - _BAR_HEIGHT) * up
        size = scale * _BAR_WIDTH / width, _BAR_HEIGHT * up / height
        cax = figure.add_axes((left / width, bottom / height, *size))
        figure.colorbar(image, cax=cax, label=label, extend=extend)
    handles = [Patch(color=colour, label=name) for name, _, colour in _masks(results[0])]
    drawing.shared_legend(figure, handles)
    return {"roughness": figure}


def surface_figures(results: "Sequence[Roughness]") -> dict[str, Figure]:
    """Figures of maps and of their texture, by file name without suffix."""
    figure = drawing.new_figure(columns=3)
    left, middle, right = figure.axes
    for number, one in enumerate(results):
        found, colour = one.texture, drawing.series_style(number)["color"]
        heights = one.height[~one.mask] / NANOMETRE
        shares, edges = np.histogram(heights, _BINS, density=True)
        left.stairs(shares, edges, color=colour, label=one.source.source)
        distance = found.distance / _MICROMETRE
        middle.plot(distance, found.autocorrelation, color=colour)
        right.loglog(found.frequency * _MICROMETRE, found.power / _NM2_UM2, color=colour)
    middle.axhline(np.exp(-1.0), color=GREY, ls=":", lw=1)
    middle.annotate("1/e", (0.98, np.exp(-1.0)), (0, 3), ("axes fraction", "data"),
                    "offset points", ha="right", color=GREY, fontsize="small")  # fmt: skip
    for ax, x, y in (
        (left, "height of the surface [nm]", "probability density [1/nm]"),
        (middle, "distance [µm]", "autocorrelation [1]"),
        (right, "spatial frequency [1/µm]", "power spectral density [nm² µm²]"),
    ):
        drawing.label_axes(ax, x, y)
    for axis in (right.xaxis, right.yaxis):
        drawing.plain_decades(axis, ())
    drawing.shared_legend(figure, left.get_legend_handles_labels()[0])
    return roughness_figures(results) | {"roughness-texture": figure}


def plot_roughness(result: "Roughness", ax: Axes) -> None:
    """Draw one masked map with its colour bar."""
    image = draw_height_map(result, ax, masked=True)
    ax.set(xlabel="x [µm]", ylabel="y [µm]")
    figure = ax.get_figure(root=True)
    assert figure is not None  # axes that can be drawn on have one
    figure.colorbar(image, ax=ax, label="height of the surface [nm]", extend="both")
