"""Fit what a warm floor does: the share of its excess that the gas has, and its push on a disk.

Run as ``python studies/kinetic_chamber/warm_floor.py``; prints the numbers of
``environment/chamber.py`` and ``force/kinetic/chamber.py``, and what is left of the table.
"""

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from lightflyer.array.namespace import float64
from lightflyer.environment import chamber
from lightflyer.files.table import shipped_table
from lightflyer.force.kinetic import chamber as kinetic_warm_floor

TAC = 0.85  # of the table's disk


def chambers() -> dict[str, np.ndarray]:
    """The table but for a tube, whose mesh is too coarse for a warm floor."""
    table = dict(shipped_table("kinetic_chamber.csv").numbers)
    good = ~((table["wall"] == 1.5) & (table["lid"] == 12.0))
    return {name: column[good] for name, column in table.items()}


def fit(
    name: str, function: Callable[[np.ndarray], np.ndarray], values: np.ndarray, start: list[float]
) -> None:
    """Fit and print."""
    found = least_squares(lambda numbers: np.asarray(function(numbers)) - values, start)
    print(f"{name}: {np.round(found.x, 4).tolist()}")
    print(f"  r.m.s. {np.sqrt(np.mean(found.fun**2)):.4f}, at most {np.abs(found.fun).max():.4f}")


def main() -> None:
    """Fit both."""
    table = chambers()
    knudsen, *place = (table[name] for name in ("knudsen", "floor", "lid", "wall"))
    with float64():
        # in radii, of which Kn is half a mean free path
        fit(
            "share: join, jump",
            lambda numbers: chamber.joined_share(*place, knudsen, *numbers),
            table["floor_share"],
            [0.5, 1.5],
        )
        # a disk as cold as the walls is colder than the gas, which pushes it too
        unheated = table["floor_push"] + table["floor_share"] * table["lift"]
        fit(
            "push: first, second, steepness",
            lambda numbers: kinetic_warm_floor.joined_push(*place, knudsen, TAC, *numbers),
            unheated,
            [0.2, 0.05, 1.4],
        )


if __name__ == "__main__":
    main()
