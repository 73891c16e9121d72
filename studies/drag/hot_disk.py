"""Drag of a hot disk by the kinetic equation, over what the law of a cold one makes of it.

    python studies/drag/hot_disk.py

Each solved case becomes a line of ``hot_points.jsonl`` and is not solved again. Then the table is
printed: drag, its growth by the warmth, and the growth of the resistance of dense gas that
stands for it once the free molecules' own growth is known.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from lightflyer.kinetic_theory.disk.cases import COARSE, MEDIUM, hot_disk_drag
from lightflyer.kinetic_theory.model_gases import gas_model

POINTS = Path(__file__).parent / "hot_points.jsonl"
LEVELS = {"coarse": COARSE, "medium": MEDIUM}
RATIOS = (1.0, 1.6, 2.5)
CASES = [
    ("coarse", "diatomic", 1.0, 0.3),
    ("coarse", "diatomic", 1.0, 0.1),
    ("medium", "diatomic", 1.0, 0.1),
    ("medium", "diatomic", 1.0, 0.3),
    ("coarse", "diatomic", 0.5, 0.1),
    ("medium", "diatomic", 0.5, 0.1),
    ("coarse", "diatomic", 1.0, 1.0),
    ("coarse", "diatomic", 0.5, 1.0),
    ("coarse", "monatomic", 1.0, 0.1),
    ("coarse", "diatomic", 1.0, 0.05),
    ("medium", "diatomic", 1.0, 0.05),
    ("coarse", "diatomic", 1.0, 3.0),
]


def free_molecular(tac: float, ratio: float) -> float:
    """Drag of free molecules, F/(pAs)."""
    return 4.0 / np.sqrt(np.pi) * (2.0 - tac) + tac * np.sqrt(np.pi * ratio)


def read_points() -> dict[tuple, list[float]]:
    """Drag for each of ``RATIOS``, of each case solved so far."""
    lines = POINTS.read_text().splitlines() if POINTS.exists() else []
    points = [json.loads(line) for line in lines]
    return {tuple(point["case"]): point["drag"] for point in points}


def growths(tac: float, drag: list[float]) -> list[tuple[float, float]]:
    """Growth of the drag and of the resistance of dense gas, for each of ``RATIOS``."""
    met = [
        1.0 / one - 1.0 / free_molecular(tac, ratio)
        for one, ratio in zip(drag, RATIOS, strict=True)
    ]
    return [(one / drag[0], met[0] / left) for one, left in zip(drag, met, strict=True)]


def main() -> None:
    """Solve what is missing and print the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    solved = read_points()
    for case in CASES:
        if case in solved:
            continue
        level, gas, tac, knudsen = case
        rarefaction = np.sqrt(np.pi) / (4.0 * knudsen)
        drag = hot_disk_drag(rarefaction, gas_model(gas), tac, RATIOS, LEVELS[level])
        with POINTS.open("a") as file:
            file.write(json.dumps({"case": case, "ratios": RATIOS, "drag": drag}) + "\n")
    for case, drag in sorted(read_points().items()):
        columns = (f"{growth:.4f} {dense:.4f}" for growth, dense in growths(case[2], drag))
        print(*case, f"{drag[0]:.4f}", *columns)


if __name__ == "__main__":
    main()
