"""Temperature on the axis and in the plane of the disk: direct simulation and kinetic equation.

Run as ``python studies/direct_simulation/figure.py``; writes ``temperature.png``. Two minutes on
one core.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from study import POINTS_TO_RUN, WARM_UP_TIME, label, simulation

from lightflyer.files import palette
from lightflyer.kinetic_theory import solve

FOLDER = Path(__file__).parent
POINT = POINTS_TO_RUN[0]
TIME = 4000.0  # [radii/√(2RT_c)]
BESIDE = 0.2  # cells whose centre is as near to the axis count for it
PLACES = np.linspace(0.02, 3.9, 80)


def main() -> None:
    """Simulate, solve and draw."""
    made = simulation(POINT, seed=100)
    made.run(round(WARM_UP_TIME / made.duration))
    made.run(round(TIME / made.duration))
    found = made.fields()
    solution = solve(
        POINT.knudsen,
        POINT.tac_top,
        POINT.tac_bottom,
        temperature_ratio=POINT.temperature_ratio,
        gas="diatomic",
        boundary=POINT.boundary,
    )
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), sharey=True, layout="constrained")
    draw_axis(axes[0], found, made.cells.volume, solution)
    draw_plane(axes[1], found, made.cells.volume, solution)
    axes[0].set_ylabel("temperature $T/T_c$")
    axes[1].legend(*axes[0].get_legend_handles_labels(), frameon=False)
    figure.suptitle(label(POINT), fontsize="medium")
    figure.savefig(FOLDER / "temperature.png", dpi=150)


def draw_axis(axes, found, volume, solution) -> None:
    """Along the axis, below the disk and above."""
    near = found["radius"] < BESIDE
    heights, index = np.unique(found["height"][near].round(6), return_inverse=True)
    draw_means(axes, heights, index, found, near, volume)
    for sign in (-1.0, 1.0):
        fields = solution.flow(np.full(PLACES.size, 0.5 * BESIDE), sign * PLACES)
        draw_solution(axes, sign * PLACES, fields, sign > 0.0)
    axes.set_xlabel("height on the axis [radii]")


def draw_plane(axes, found, volume, solution) -> None:
    """Beside the disk, in its plane."""
    near = (np.abs(found["height"]) < BESIDE) & (found["radius"] > 1.0)
    radii, index = np.unique(found["radius"][near].round(2), return_inverse=True)
    draw_means(axes, radii, index, found, near, volume)
    radii = 1.0 + PLACES[PLACES < 2.9]
    draw_solution(axes, radii, solution.flow(radii, np.full(radii.size, 0.5 * BESIDE)), True)
    axes.set_xlabel("radius in the disk's plane [radii]")


def draw_means(axes, places, index, found, near, volume) -> None:
    """Means of the simulation over cells of one place."""
    weights = (volume * found["density"])[near]
    total = np.bincount(index, weights)
    for name, marker in (("temperature", "o"), ("rotational_temperature", "s")):
        mean = np.bincount(index, weights * found[name][near]) / total
        axes.plot(places, mean, marker, ms=3.5, mfc="none", label=f"{words(name)}, simulated")


def draw_solution(axes, places, fields, labelled) -> None:
    """Temperatures of the kinetic equation."""
    for name, style in (
        ("temperature", {"color": palette.BLUE}),
        ("rotational_temperature", {"color": palette.VERMILION, "ls": "--"}),
    ):
        text = f"{words(name)}, kinetic equation" if labelled else None
        axes.plot(places, 1.0 + fields[name], lw=1.2, **style, label=text)


def words(name: str) -> str:
    """A field in words."""
    return {"temperature": "translation", "rotational_temperature": "rotation"}[name]


if __name__ == "__main__":
    main()
