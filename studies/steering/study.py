"""How fast a tilted disk drifts, and how far below it a payload may hang.

Run as ``python studies/steering/study.py``; prints the numbers of docs/swarms.md and writes
docs/images/steering.png.
"""

from pathlib import Path

import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.lu2023 import PRINTED

IMAGE = Path(__file__).parents[2] / "docs" / "images" / "steering.png"
FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
SIZES = {"5 mm": 5e-3, "1 cm": 1e-2, "2 cm": 2e-2}
COLOURS = dict(zip(SIZES, (palette.BLUE, palette.VERMILION, palette.GREEN), strict=True))
ALTITUDES = np.arange(50e3, 90.1e3, 1e3)
TILTS = np.radians(np.arange(0.0, 60.1, 1.0))
FIBRE = lf.mission.Tether(7e-9)  # kg/m: 3 µm of polyethylene
SHARE = 0.3  # of the film's mass, which the hanging payload has


def fastest(disk, model):
    """Fastest drift that keeps altitude [m/s] and its tilt [rad], NaN where none does."""
    found = lf.mission.steady_drift(
        disk, lf.Earth(), model, altitude=ALTITUDES[:, None], tilt=TILTS
    )
    climb, speed = found.climb, found.speed
    holds = (climb[:, :-1] >= 0.0) & (climb[:, 1:] < 0.0)
    row, at = np.arange(ALTITUDES.size), np.argmax(holds, axis=1)
    share = climb[row, at] / (climb[row, at] - climb[row, at + 1])
    at_hold = (1.0 - share) * speed[row, at] + share * speed[row, at + 1]
    tilt = (1.0 - share) * TILTS[at] + share * TILTS[at + 1]
    some = holds.any(axis=1)
    return np.where(some, at_hold, np.nan), np.where(some, tilt, np.nan)


def rods(diameter):
    """Longest rod that is stable over ALTITUDES [m]."""
    disk = lf.Disk(FILM, radius=0.5 * diameter)
    disk = lf.Disk(FILM, radius=disk.radius, payload=SHARE * float(disk.own_mass))
    earth = lf.Earth()
    return np.array([lf.mission.hanging_stability(disk, earth.state(altitude), rod=1e-3).longest_rod
                     for altitude in ALTITUDES])  # fmt: skip


def gram():
    """Flyers for one gram of payload, by size, film and force model, in the sun overhead."""
    models = (lf.Lu2023(), lf.Lu2023(reading=PRINTED), lf.Kinetic())
    for density in (1e-3, 0.37e-3):
        film = lf.FilmProperties(density, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
        for diameter in (5e-3, 1e-2, 2e-2, 3e-2):
            cells = []
            for model in models:
                try:
                    disk = lf.Disk(film, radius=0.5 * diameter)
                    found = lf.mission.tethered_swarm(
                        disk, lf.Earth(), model, payload="1 g", tether=FIBRE
                    )
                    cells.append(f"{found.count} at {found.altitude / 1e3:g} km, "
                                 f"radius {found.layer_radius:.1f} m, tethers "
                                 f"{1e3 * found.tether_mass:.2g} g")  # fmt: skip
                except lf.ParameterError:
                    cells.append("none")
            print(f"| {1e3 * density:g} g/m², {1e3 * diameter:g} mm | {' | '.join(cells)} |")


LABELLED = {  # where names of lines begin, left and right
    "5 mm": ((77.0, 2.5), (90.8, 0.0029)),
    "1 cm": ((87.0, 1.9), (90.8, 0.011)),
    "2 cm": ((72.5, 1.95), (90.8, 0.039)),
}


def main():
    """Both panels and tables."""
    gram()
    figure = plot.new_figure(columns=2, width=4.6, height=3.6)
    left, right = figure.axes
    speeds, tilts, lengths = {}, {}, {}
    for name, diameter in SIZES.items():
        disk = lf.Disk(FILM, radius=0.5 * diameter)
        speeds[name], tilts[name] = fastest(disk, lf.Lu2023())
        kinetic, tilted = fastest(disk, lf.Kinetic())
        for speed, tilt in ((speeds[name], tilts[name]), (kinetic, tilted)):
            at = np.nanargmax(speed)
            print(f"{name}: {speed[at]:.2f} m/s at {ALTITUDES[at] / 1e3:.0f} km "
                  f"and {np.degrees(tilt[at]):.0f}°")  # fmt: skip
        lengths[name] = rods(diameter)
        left.plot(ALTITUDES / 1e3, speeds[name], color=COLOURS[name])
        left.plot(ALTITUDES / 1e3, kinetic, "--", color=COLOURS[name])
        right.plot(ALTITUDES / 1e3, 1e3 * lengths[name], color=COLOURS[name])
        for ax, place in zip((left, right), LABELLED[name], strict=True):
            ax.text(*place, name, color=COLOURS[name])
    print("| altitude | " + " | ".join(SIZES) + " |")
    for number in range(10, ALTITUDES.size, 5):
        cells = [f"{speeds[name][number]:.2f} m/s at {np.degrees(tilts[name][number]):.0f}°"
                 for name in SIZES]  # fmt: skip
        cells += [f"{1e3 * lengths[name][number]:.2g} mm" for name in SIZES]
        print(f"| {ALTITUDES[number] / 1e3:.0f} km | " + " | ".join(cells) + " |")
    left.set(xlabel="altitude [km]", ylabel="fastest drift at constant altitude [m/s]",
             xlim=(55, 90), ylim=(0, None))  # fmt: skip
    right.set(xlabel="altitude [km]", ylabel="longest stable rod [mm]", yscale="log")
    right.set_xlim(None, 97.0)
    plot.plain_decades(right.yaxis)
    for ax in (left, right):
        ax.grid(alpha=0.25)
    left.text(56.0, 2.4, "solid: lu2023\ndashed: kinetic")
    plot.save(figure, [IMAGE])


if __name__ == "__main__":
    main()
