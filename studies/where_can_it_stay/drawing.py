"""Figures of the study."""

from pathlib import Path

import numpy as np
from matplotlib.colors import LogNorm

from lightflyer.files import drawing as plot
from lightflyer.files import palette

IMAGES = Path(__file__).parents[2] / "docs" / "images"
MONTHS = "JFMAMJJASOND"
LOOKS = {
    "as stated": ("black", "-"),
    "albedo 0.1": (palette.BLUE, ":"),
    "albedo 0.5": (palette.BLUE, "--"),
    "wind 0.1 m/s down": (palette.VERMILION, ":"),
    "wind 0.1 m/s up": (palette.VERMILION, "--"),
    "lu2023": (palette.GREEN, "-"),
    "lu2023 as printed": (palette.ORANGE, "-"),
    "follows the sun": (palette.PURPLE, "-"),
}


def draw_season(sizes, latitudes, names):
    """Map of the largest disk over season and latitude."""
    figure = plot.new_figure(columns=len(sizes), width=3.4, height=4.0)
    levels = [0.5, 1, 2, 5, 10, 20]
    filled = None
    for ax, size, name in zip(figure.axes, sizes, names, strict=True):
        millimetres = 1e3 * np.asarray(size, float).T  # over latitude and month
        filled = ax.pcolormesh(
            np.arange(12) + 0.5,
            latitudes,
            millimetres,
            cmap=palette.QUANTITY_MAP,
            norm=LogNorm(levels[0], levels[-1]),
            shading="nearest",
        )
        ax.set(title=name, ylim=(-90, 90), xlim=(0, 12), xlabel="21st of the month")
        ax.set_xticks(np.arange(12) + 0.5, list(MONTHS))
        ax.set_yticks(np.arange(-90, 91, 30))
        ax.tick_params(axis="x", length=0)
        ax.set_facecolor("0.88")
    figure.axes[0].set_ylabel("latitude [°]")
    bar = figure.colorbar(filled, ax=figure.axes, ticks=levels, shrink=0.9)
    bar.minorticks_off()
    bar.ax.set_yticklabels([f"{level:g}" for level in levels])
    bar.set_label("largest disk that stays aloft,\ndiameter [mm]; grey: none")
    plot.save(figure, [IMAGES / "where-can-it-stay.png"])


def draw_cases(cases, latitudes, names):
    """Largest disk at the June solstice over latitude, by case."""
    figure = plot.new_figure(columns=2, width=4.6, height=4.6)
    for number, (ax, name) in enumerate(zip(figure.axes, names, strict=True)):
        for case, sizes in cases.items():
            colour, line = LOOKS[case]
            size = 1e3 * np.asarray(sizes[number], float)
            ax.plot(latitudes, size, color=colour, ls=line, label=case, marker=".", ms=4)
        ax.set(title=name, xlabel="latitude [°]", yscale="log", xlim=(0, 90), ylim=(0.5, 40))
        ax.set_yticks([0.5, 1, 2, 5, 10, 20], ["0.5", "1", "2", "5", "10", "20"])
        ax.minorticks_off()
        ax.grid(alpha=0.25)
    figure.axes[0].set_ylabel("largest disk that stays aloft, diameter [mm]")
    handles = figure.axes[0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside lower center", ncols=4, fontsize="small")
    plot.save(figure, [IMAGES / "where-can-it-stay-cases.png"])
