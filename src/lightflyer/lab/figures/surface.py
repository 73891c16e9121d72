"""Figure of height maps: levelled, and with particles and holes masked."""

from collections.abc import Sequence
from string import ascii_lowercase

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from scipy import ndimage

from lightflyer.foundation.drawing import ORANGE, new_figure
from lightflyer.lab.surface import NANOMETRE, Roughness

_WIDTH, _HEIGHT = 4.6, 8.0  # of the column of one map [inch]
_MOST_PIXELS = 1024  # drawn along a side
_SHOWN = 3.5  # range of the colours, in rms heights
_MICROMETRE = 1e-6
_PERCENT = 100.0
_HOLES = "#cc79a7"  # reddish purple of the palette for colour-blind readers


def draw_height_map(result: Roughness, ax: Axes, *, masked: bool) -> Axes:
    """Draw a levelled map, as it is or with its mask.

    Parameters
    ----------
    result : Roughness
    ax : matplotlib.axes.Axes
    masked : bool
        Show the mask of particles and holes, and scale the colours to the surface.

    Returns
    -------
    matplotlib.axes.Axes
    """
    step = max(1, max(result.height.shape) // _MOST_PIXELS)
    height = result.height[::step, ::step] / NANOMETRE
    extent = (0.0, result.source.width / _MICROMETRE, 0.0, result.source.length / _MICROMETRE)
    rms = result.parameters["rms_height"].value
    low, high = (-_SHOWN * rms, _SHOWN * rms) if masked else (height.min(), height.max())
    image = ax.imshow(height, extent=extent, cmap="cividis", vmin=low, vmax=max(high, low + 1e-12),
                      interpolation="nearest")  # fmt: skip
    if masked:
        _draw_masks(result, ax, step, extent)
        shares = ", ".join(
            f"{name} {_PERCENT * mask.mean():.2g} %"
            for name, mask, _ in _masks(result)
            if mask.any()
        )
        said = f"Sq = {rms:.3g} nm; masked: {shares or 'nothing'}"
    else:
        everything = result.parameters_all["rms_height"].value
        said = f"{result.source.source}: Sq = {everything:.3g} nm, all of it"
    ax.set_title(said, fontsize="small")
    ax.set_xlabel("x [µm]")
    ax.set_ylabel("y [µm]")
    ax.figure.colorbar(image, ax=ax, label="height [nm]", shrink=0.8)
    return ax


def _draw_masks(
    result: Roughness, ax: Axes, step: int, extent: tuple[float, float, float, float]
) -> None:
    """Particles and holes in plain colours."""
    for _, mask, colour in _masks(result):
        image = np.ma.masked_equal(_thinned(mask, step), 0)
        ax.imshow(image, extent=extent, cmap=ListedColormap([colour]), interpolation="nearest")


def _masks(result: Roughness) -> tuple[tuple[str, np.ndarray, str], ...]:
    """Name, mask and colour of what is masked."""
    return ("particles", result.particles, ORANGE), ("holes", result.holes, _HOLES)


def _thinned(mask: np.ndarray, step: int) -> np.ndarray:
    """Mask of every so many pixels, in which none that is masked gets lost."""
    return ndimage.maximum_filter(mask, step, origin=-((step - 1) // 2))[::step, ::step]


def roughness_figures(results: Sequence[Roughness]) -> dict[str, Figure]:
    """Figure of several maps, by file name without suffix.

    Parameters
    ----------
    results : sequence of Roughness
        One column each: all of the map above, masked below.

    Returns
    -------
    dict of str to matplotlib.figure.Figure
    """
    count = len(results)
    figure = new_figure(columns=count, width=_WIDTH, height=_HEIGHT, rows=2)
    figure.set_layout_engine("compressed")  # of axes with a fixed aspect
    for number, ax in enumerate(figure.axes[: 2 * count]):
        draw_height_map(results[number % count], ax, masked=number >= count)
        letter = ascii_lowercase[number % len(ascii_lowercase)]
        ax.text(0.02, 0.98, f"({letter})", transform=ax.transAxes, va="top", color="white",
                weight="bold")  # fmt: skip
    handles = [Patch(color=colour, label=name) for name, _, colour in _masks(results[0])]
    figure.legend(handles=handles, loc="outside lower center", ncols=2, frameon=False)
    return {"roughness": figure}
