"""Make the tables of the kinetic force that ship with the package.

Run as ``python studies/kinetic_table/study.py [--processes 2] [--only PART]``. Each solved point
is kept in ``points/`` and not solved again; the tables are written from what is there.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data"

GASES = ("monatomic", "diatomic")
KNUDSEN = (0.03, 0.05, 0.08, 0.125, 0.2, 0.35, 0.6, 1.0, 2.0, 5.0, 10.0, 30.0)
RATIOS = (1.0, 1.6, 2.5)
TAC = (0.6, 0.8, 1.0)
BOUNDARIES = (2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0)
THIN = 0.3  # Knudsen number above which the medium mesh does
CHECKED_TAC = 0.8  # of the non-linear points that are solved on two meshes; others share their error
BOUNDARY_TAC = 0.85
TAC_DIFFERENCE = 0.1  # of the two faces: force and heat are odd and even in it


@dataclass(frozen=True)
class Point:
    """One point of a table; an infinite boundary is open space."""

    gas: str
    knudsen: float
    ratio: float
    tac: float
    boundary: float = np.inf

    @property
    def path(self) -> Path:
        """Where its result is kept."""
        return POINTS / (
            f"{self.gas}-{self.knudsen:g}-{self.ratio:g}-{self.tac:g}-{self.boundary:g}.json"
        )


def measure(point: Point) -> dict[str, float]:
    """Solve a point on two meshes: ratios to free-molecular values and their errors."""
    from lightflyer.kinetic.solution import COARSE, FINE, MEDIUM, solve_case

    levels = (FINE, MEDIUM) if point.ratio == 1.0 and point.knudsen < THIN else (MEDIUM, COARSE)
    if point.tac == BOUNDARY_TAC:
        levels = (MEDIUM,)
    elif point.ratio > 1.0 and point.tac != CHECKED_TAC:
        levels = levels[1:] if point.knudsen > THIN else levels[:1]
    found = [ratios(point, solve_case(case(point), level)) for level in levels]
    errors = {f"{name}_error": abs(found[0][name] - found[-1][name]) for name in found[0]}
    return found[0] | (errors if len(found) == 2 else {})


def case(point: Point):
    """Faces of TAC above and below the mean by half the difference."""
    from lightflyer.kinetic.gas_model import gas_model
    from lightflyer.kinetic.solution import Case

    half = 0.5 * TAC_DIFFERENCE
    linear = point.ratio == 1.0
    temperature = 1.0 if linear else point.ratio
    return Case(
        rarefaction=float(np.sqrt(np.pi) / (4.0 * point.knudsen)),
        tac=(point.tac + half, point.tac - half),
        temperature=(temperature, temperature),
        linear=linear,
        gas=gas_model(point.gas),
        boundary=point.boundary,
    )


def ratios(point: Point, outcome) -> dict[str, float]:
    """Force and heat ratios, and the difference of the faces' heat ratios per Δα."""
    limit = case(point).free_molecular()
    top, bottom = (heat / free for heat, free in zip(outcome.heat, limit.heat, strict=True))
    return {
        "force_ratio": outcome.force / limit.force,
        "heat_ratio": 0.5 * (top + bottom),
        "heat_ratio_slope": (top - bottom) / TAC_DIFFERENCE,
    }


def solve_and_keep(point: Point) -> None:
    """Solve a point unless it is kept already."""
    if point.path.exists():
        return
    result = measure(point)
    partial = point.path.with_suffix(".partial")
    partial.write_text(json.dumps(asdict(point) | result, indent=1) + "\n")
    partial.rename(point.path)


def points(part: str) -> list[Point]:
    """Points of a part: linear, boundary or nonlinear."""
    if part == "boundary":
        mean = BOUNDARY_TAC
        places = (*BOUNDARIES, np.inf)
        return [Point(g, k, 1.0, mean, d) for g in GASES for k in KNUDSEN for d in places]
    chosen = [r for r in RATIOS if (r == 1.0) == (part == "linear")]
    # the hardest last
    return [
        Point(g, k, r, a) for k in reversed(KNUDSEN) for r in chosen for g in GASES for a in TAC
    ]


def main() -> None:
    """Solve what is missing and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--only", choices=("linear", "boundary", "nonlinear"))
    arguments = parser.parse_args()
    POINTS.mkdir(exist_ok=True)
    parts = [arguments.only] if arguments.only else ["linear", "boundary", "nonlinear"]
    todo = [p for part in parts for p in points(part) if not p.path.exists()]
    with ProcessPoolExecutor(arguments.processes) as pool:
        waiting = {pool.submit(solve_and_keep, point): point for point in todo}
        for number, future in enumerate(as_completed(waiting), 1):
            failure = future.exception()
            word = f"failed: {failure}" if failure else "done"
            print(f"{number}/{len(todo)} {waiting[future].path.stem} {word}", flush=True)


if __name__ == "__main__":
    main()
