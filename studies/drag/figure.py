"""Draw the drag of a disk between thin and dense gas, and how fast disks sink in the dark.

    python studies/drag/figure.py

Writes docs/images/drag.png and prints the numbers of docs/drag.md.
"""

import json
from pathlib import Path

import jax
import numpy as np
from scipy.integrate import solve_ivp

import lightflyer as lf
from lightflyer.drag import disk, free_molecular
from lightflyer.drag.disk import dense_share
from lightflyer.files import drawing as plot
from lightflyer.files import palette

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"
SIZES = (5e-3, 1e-2, 2e-2, 5e-2)
NIGHT_SIZES = (1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 3e-2)
ALTITUDES = np.array([50e3, 60e3, 70e3, 80e3])
NIGHT = 12.0 * 3600.0
RELEASE = 75e3


def film():
    """The film of the paper."""
    return lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)


def speeds(diameter, altitudes):
    """Sinking speed in the dark of a disk of 1 g/m² [m/s]."""
    return lf.statics.sinking_speed(
        lf.Disk(film(), radius=0.5 * diameter), lf.Earth().state(altitudes)
    )


def after_a_night(diameter):
    """Altitude after twelve hours in the dark [km]."""
    grid = np.linspace(15e3, RELEASE, 601)
    found = speeds(diameter, grid)
    fall = solve_ivp(
        lambda _, z: -np.interp(z, grid, found), (0.0, NIGHT), [RELEASE], rtol=1e-8, max_step=60.0
    )
    return fall.y[0, -1] / 1e3


def tables(law):
    """Print sinking speeds and nights by the law in use."""
    print(law)
    for diameter in SIZES:
        print(f"  {diameter * 1e3:g} mm", np.round(speeds(diameter, ALTITUDES), 2), "m/s")
    for diameter in NIGHT_SIZES:
        print(f"  {diameter * 1e3:g} mm after a night: {after_a_night(diameter):.1f} km")


def draw_share(ax):
    """Drag over that of free molecules."""
    delta = np.geomspace(0.01, 100.0, 200)
    with lf.float64():
        thin = float(free_molecular.broadside_disk(0.0, 1.0, 1.0))
        share = np.asarray(jax.jit(lambda d: dense_share(d, 1.0, "diatomic"))(delta))
    dense = 16.0 / (np.pi * delta)
    ax.loglog(delta, 1.0 / (1.0 + share * thin / dense))
    ax.loglog(delta, 1.0 / (1.0 + thin / dense), "--")
    ax.loglog(delta, np.minimum(dense / thin, 2.0), ":", color=palette.GREY)
    ax.text(0.012, 0.03, "this package; dots:\nkinetic equation", color=palette.BLUE)
    ax.text(0.012, 0.014, "both resistances,\nadded", color=palette.VERMILION)
    ax.text(2.6, 1.0, "slow flow", color=palette.GREY)
    for line in (HERE / "points.jsonl").read_text().splitlines():
        point = json.loads(line)
        drag = {(gas, tac): value for gas, tac, value in point["drag"]}["diatomic", 1.0]
        if point["level"] == "fine":
            ax.loglog(point["rarefaction"], drag / thin, "o", color=palette.BLUE, markersize=3.5)
    ax.set_ylim(0.01, 1.5)
    ax.set_xlabel("rarefaction δ [1]")
    ax.set_ylabel("drag over that of free molecules [1]")


def draw_warmth(ax):
    """Growth of the drag by the warmth of a disk: the law, and the kinetic equation."""
    delta = np.geomspace(0.1, 10.0, 60)
    with lf.float64():
        share = np.asarray(jax.jit(lambda d: dense_share(d, 1.0, "diatomic"))(delta))
    for ratio, colour in ((1.6, palette.BLUE), (2.5, palette.VERMILION)):
        thin = [
            float(free_molecular.broadside_disk(0.0, 1.0, root)) for root in (1.0, np.sqrt(ratio))
        ]
        cold, hot = (1.0 / (1.0 / one + share * np.pi * delta / 16.0) for one in thin)
        ax.semilogx(delta, hot / cold, color=colour)
        ax.text(0.11, hot[0] / cold[0] - 0.07, f"$T_w/T$\n= {ratio}", color=colour)
        for line in (HERE / "hot_points.jsonl").read_text().splitlines():
            point = json.loads(line)
            level, gas, tac, knudsen = point["case"]
            drag = point["drag"][point["ratios"].index(ratio)] / point["drag"][0]
            if (gas, tac) == ("diatomic", 1.0):
                marker = "o" if level == "medium" else "+"
                ax.semilogx(np.sqrt(np.pi) / (4.0 * knudsen), drag, marker, color=colour)
    ax.set_xlabel("rarefaction δ [1]")
    ax.set_ylabel("drag over that of a cold disk [1]")


def draw_sinking(ax):
    """Sinking speed over altitude."""
    altitudes = np.linspace(30e3, 86e3, 113)
    for diameter in SIZES:
        found = speeds(diameter, altitudes)
        (line,) = ax.semilogx(found, altitudes / 1e3)
        at = altitudes.size // 3
        ax.annotate(
            f"{diameter * 1e3:g}" + " mm" * (diameter == SIZES[-1]),
            (found[at], altitudes[at] / 1e3),
            (4, 0),
            textcoords="offset points",
            color=line.get_color(),
        )
    plot.plain_decades(ax.xaxis)
    ax.set_xlabel("sinking speed in the dark [m/s]")
    ax.set_ylabel("altitude [km]")


def main():
    """Draw the figure and print the tables."""
    figure = plot.new_figure(columns=3, width=5.0, height=4.0)
    draw_share(figure.axes[0])
    draw_warmth(figure.axes[1])
    draw_sinking(figure.axes[2])
    plot.save(figure, [IMAGES / "drag.png"])
    tables("kinetic equation")
    disk.dense_share = lambda *_: 1.0
    jax.clear_caches()
    tables("both resistances, added")


if __name__ == "__main__":
    main()
