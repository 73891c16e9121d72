"""Measured beside predicted: light, what germanium saves, and temperatures."""

from pathlib import Path

import disks
import numpy as np
from measurements import number

from lightflyer.files import drawing as plot
from lightflyer.files import palette

IMAGES = Path(__file__).parents[2] / "docs" / "images"
SHOWN = {
    "open space": palette.VERMILION,
    "walls at 4.5 cm": palette.ORANGE,
    "floor at 4.5 cm, else 10 cm": palette.BLUE,
}
_APART = 0.24  # of lines of one row
_ENDLESS = 1e6  # stands for infinite light [W/m²]
_NAMES = {"germanium": "Ge", "nanotubes": "CNT"}
_ONLY = "open space"  # where models that know no walls are shown
_FEEL_WALLS = ("azadi2021",)
_OTHERS = {
    "azadi2021": "CNT 6 mm\n(Azadi 2021)",
    "cortes2020": "plate\n(Cortes 2020)",
    "schafer2025": "sandwich 1 cm\n(Schafer 2025)",
}


def draw(results, experiments):
    """Write docs/images/experiments.png."""
    figure = plot.new_figure(columns=3, width=4.4, height=5.2)
    draw_light(figure.axes[0], results, experiments)
    draw_saved(figure.axes[1], results, experiments["lu2023"])
    draw_temperature(figure.axes[2], results, experiments["lu2023"])
    plot.shared_legend(figure, figure.axes[1].get_legend_handles_labels()[0], most=2)
    IMAGES.mkdir(parents=True, exist_ok=True)
    plot.save(figure, [IMAGES / "experiments.png"])


def draw_light(axes, results, experiments):
    """Light that a flyer needs at least, one row a flyer."""
    paper = experiments["lu2023"]
    brightest = number(paper["setting"]["brightest"])
    rows = []
    for film in disks.FILMS:
        for size in disks.DIAMETERS:
            name = f"{film} {size} cm"
            entry = paper[film]["disks"][str(size)]
            found = {
                where: [results["bands"][where][when]["light"][name] for when in _WHEN]
                for where in SHOWN
            }
            bound = entry.get("at_most", 0.0) * brightest.high
            rows.append((f"{_NAMES[film]} {size} cm", entry.get("least"), bound, found))
    for name, text in _OTHERS.items():
        used = number(experiments[name]["at_most"])
        found = {
            where: [_times(results["others"][where][name]["over_used"], used.value)]
            for where in (SHOWN if name in _FEEL_WALLS else [_ONLY])
        }
        rows.append((text, None, used.high, found))
    for place, (_, least, bound, found) in enumerate(rows):
        _row(axes, place, found)
        _measured(axes, place, least, bound)
    axes.set_yticks(range(len(rows)), [row[0] for row in rows])
    axes.set(
        xscale="log", xlim=(300.0, 3e4), ylim=(len(rows) - 0.4, -0.6),
        xlabel="least irradiance [W/m²]",
    )  # fmt: skip
    axes.grid(alpha=0.3, axis="x")


_WHEN = ("before", "given_2_cm")


def _row(axes, place, found):
    for offset, (where, bands) in enumerate(found.items()):
        height = place + (_APART * (offset - 1) if len(found) > 1 else 0.0)
        color = SHOWN[where] if len(found) > 1 else palette.GREY
        for band, width in zip(bands, (1.0, 4.0), strict=False):
            axes.plot(_ends(band), [height] * 2, "-", color=color, lw=width, solid_capstyle="butt")
        last = bands[-1]
        axes.plot(_end(last["median"]), height, "o", color=color, ms=5, mfc="white")


def _measured(axes, place, least, bound):
    if least:
        axes.plot([least] * 2, [place - 0.42, place + 0.42], "k-", lw=2)
        return
    axes.plot([bound] * 2, [place - 0.42, place + 0.42], "k:", lw=1.5)
    axes.annotate(
        "",
        (0.72 * bound, place + 0.36),
        (bound, place + 0.36),
        arrowprops={"arrowstyle": "->", "color": "black"},
    )


def draw_saved(axes, results, paper):
    """What germanium saves, if the 2-cm disks are as measured."""
    sizes = np.array(disks.DIAMETERS, float)
    for offset, (where, color) in enumerate(SHOWN.items()):
        bands = [
            results["bands"][where]["given_2_cm"]["reductions"][str(s)] for s in disks.DIAMETERS
        ]
        _bands(axes, sizes + 0.08 * (offset - 1), bands, color, where, 100.0)
    values = np.array([number(paper["reductions"][str(s)]).value for s in disks.DIAMETERS])
    spread = np.sqrt(2.0) * number(paper["reading"]["lift_off"]).uncertainty
    axes.errorbar(
        sizes + 0.17, 100.0 * values, yerr=196.0 * spread * (1.0 - values), fmt="ks", capsize=4,
        label="measured; bar: 5 % of each light, assumed",
    )  # fmt: skip
    axes.set(xlabel="diameter [cm]", ylabel="light saved by germanium [%]", xticks=sizes)
    axes.set_ylim(0.0, 60.0)
    axes.grid(alpha=0.3)


def draw_temperature(axes, results, paper):
    """Temperature in the least light, if the 2-cm disks are as measured."""
    sizes = np.array(disks.DIAMETERS, float)
    for offset, (where, color) in enumerate(SHOWN.items()):
        found = results["bands"][where]["given_2_cm"]["temperature"]
        for film, marker in (("germanium", "o"), ("nanotubes", "s")):
            bands = [found[f"{film} {size} cm"] for size in disks.DIAMETERS]
            _bands(axes, sizes + 0.08 * (offset - 1), bands, color, None, 1.0, marker)
    melting = number(paper["setting"]["melting"]).value
    axes.axhline(melting, color="black", lw=1, ls="--")
    axes.annotate("mylar melts", (3.3, melting - 24.0), fontsize=8)
    axes.annotate("Ge", (3.6, 900.0), ha="center", fontsize=9)
    axes.annotate("CNT", (4.0, 385.0), ha="center", fontsize=9)
    axes.set(xlabel="diameter [cm]", ylabel="film in that light [K]", xticks=sizes)
    axes.grid(alpha=0.3)


def _bands(axes, places, bands, color, label, factor, marker="o"):
    middles = factor * np.array([band["median"] for band in bands])
    ends = factor * np.array([[band["low"], band["high"]] for band in bands]).T
    axes.errorbar(
        places, middles, yerr=np.abs(ends - middles), fmt=marker, mfc="white", color=color,
        capsize=3, label=label,
    )  # fmt: skip


def _times(band, factor):
    return {name: None if value is None else value * factor for name, value in band.items()}


def _ends(band):
    return [_end(band["low"]), _end(band["high"])]


def _end(value):
    return _ENDLESS if value is None else value
