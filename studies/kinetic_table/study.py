"""Make the tables of the kinetic force that ship with the package.

Run as ``python studies/kinetic_table/study.py [--processes 2] [--only PART]``. Each solved point
is kept in ``points/`` and not solved again; the tables are written from what is there.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from lightflyer.kinetic.gas_model import gas_model
from lightflyer.kinetic.operators import Quadrature
from lightflyer.kinetic.solution import (
    COARSE,
    FINE,
    MEDIUM,
    Case,
    Outcome,
    Resolution,
    solve_case,
)

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data"

GASES = ("monatomic", "diatomic")
KNUDSEN = (0.03, 0.05, 0.08, 0.125, 0.2, 0.35, 0.6, 1.0, 2.0, 5.0, 10.0, 30.0)
RATIOS = (1.0, 1.6, 2.5)
TAC = (0.6, 0.8, 1.0)
BOUNDARIES = (2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0)
COARSEST = Resolution(3, 0.7, Quadrature(3, 4, 3))  # within 1e-4 of the finest in thin gas
THIN = 0.3  # Knudsen number above which the medium mesh does
CHECKED_TAC = (
    0.8  # of the non-linear points that are solved on two meshes; others share their error
)
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
    found = [ratios(point, solve_case(case(point), level)) for level in levels(point)]
    errors = {f"{name}_error": abs(found[0][name] - found[-1][name]) for name in found[0]}
    return found[0] | (errors if len(found) == 2 else {})


def levels(point: Point) -> tuple[Resolution, ...]:
    """Meshes on which a point is solved: the first gives the result, the second its error."""
    if point.tac == BOUNDARY_TAC:
        return (MEDIUM,)
    if point.ratio == 1.0:
        return (MEDIUM, COARSE) if point.knudsen > THIN else (FINE, MEDIUM)
    if point.tac == CHECKED_TAC:
        return (COARSE, COARSEST) if point.knudsen > THIN else (MEDIUM, COARSE)
    return (COARSEST,) if point.knudsen > THIN else (MEDIUM,)


def case(point: Point) -> Case:
    """Faces of TAC above and below the mean by half the difference."""
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


def ratios(point: Point, outcome: Outcome) -> dict[str, float]:
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
    return [
        Point(g, k, r, a) for k in reversed(KNUDSEN) for r in chosen for g in GASES for a in TAC
    ]


TABLE_COLUMNS = (
    "gas,knudsen,temperature_ratio,tac,force_ratio,heat_ratio,heat_ratio_slope,"
    "force_ratio_error,heat_ratio_error"
)
TABLE_COMMENTS = """\
# Force and heat loss of a thin disk over their exact free-molecular values for Maxwell walls, in
# open space, from the kinetic equation (lightflyer.kinetic); made by studies/kinetic_table/study.py.
# knudsen: mean free path (mu/p) sqrt(pi R T_c/2) over the diameter, in the gas far away;
# temperature_ratio: T_h/T_c, where 1 is the linear limit; tac: mean of both faces.
# force_ratio: F/F_fm for a small difference of the faces' TAC; a face's heat over its own
# free-molecular value is heat_ratio +- heat_ratio_slope/2 (alpha_top - alpha_bottom), + at the top.
# Errors are absolute, from a second mesh. Licence: MIT, as this package.
"""
BOUNDARY_COLUMNS = "gas,knudsen,boundary,force_factor,heat_factor"
BOUNDARY_COMMENTS = f"""\
# What a cold cylindrical reservoir of half-width and half-height `boundary` (disk radii) does to
# force and heat loss of a thin disk: factors over open space, from the linear kinetic equation
# (lightflyer.kinetic) at a mean TAC of {BOUNDARY_TAC}; made by studies/kinetic_table/study.py.
# knudsen: mean free path over the disk's diameter. Licence: MIT, as this package.
"""


def kept(point: Point) -> dict[str, float] | None:
    """A point's result, if it is there; without an error of its own, that at the checked TAC."""
    if not point.path.exists():
        return None
    result = json.loads(point.path.read_text())
    if "force_ratio_error" not in result:
        checked = kept(replace(point, tac=CHECKED_TAC))
        if checked is None:
            return None
        result |= {name: checked[name] for name in ("force_ratio_error", "heat_ratio_error")}
    return result


def write_table() -> None:
    """Write the table of force and heat, with every ratio and gas that is complete."""
    rows = []
    for gas in GASES:
        for ratio in RATIOS:
            grid = [Point(gas, knudsen, ratio, tac) for knudsen in KNUDSEN for tac in TAC]
            results = [kept(point) for point in grid]
            if any(result is None for result in results):
                print(f"{gas} at ratio {ratio:g} is incomplete and left out")
                continue
            rows += [table_row(*pair) for pair in zip(grid, results, strict=True)]
    write_whole(DATA / "kinetic.csv", TABLE_COMMENTS, TABLE_COLUMNS, rows)


def table_row(point: Point, result: dict[str, float]) -> str:
    """One line of the table."""
    values = (
        *(f"{result[name]:.6f}" for name in ("force_ratio", "heat_ratio", "heat_ratio_slope")),
        *(f"{max(result[name], 2e-5):.1e}" for name in ("force_ratio_error", "heat_ratio_error")),
    )
    place = f"{point.gas},{point.knudsen:g},{point.ratio:g},{point.tac:g}"
    return ",".join((place, *values))


def write_boundaries() -> None:
    """Write the factors of a reservoir, for every gas and Knudsen number that is complete."""
    rows = []
    for gas in GASES:
        for knudsen in KNUDSEN:
            grid = [Point(gas, knudsen, 1.0, BOUNDARY_TAC, place) for place in BOUNDARIES]
            results = [p.path.exists() and json.loads(p.path.read_text()) for p in grid]
            opened = Point(gas, knudsen, 1.0, BOUNDARY_TAC).path
            if not all(results) or not opened.exists():
                print(f"boundaries of {gas} at Kn {knudsen:g} are incomplete and left out")
                continue
            free = json.loads(opened.read_text())
            rows += [
                f"{gas},{knudsen:g},{place:g},{result['force_ratio'] / free['force_ratio']:.5f},"
                f"{result['heat_ratio'] / free['heat_ratio']:.5f}"
                for place, result in zip(BOUNDARIES, results, strict=True)
            ]
    write_whole(DATA / "kinetic_boundary.csv", BOUNDARY_COMMENTS, BOUNDARY_COLUMNS, rows)


def write_whole(path: Path, comments: str, columns: str, rows: list[str]) -> None:
    """Write a CSV file, whole or not at all."""
    if not rows:
        return
    partial = path.with_suffix(".partial")
    partial.write_text(comments + columns + "\n" + "\n".join(rows) + "\n")
    partial.rename(path)
    print(f"wrote {path.name}: {len(rows)} rows")


def main() -> None:
    """Solve what is missing and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--only", choices=("linear", "boundary", "nonlinear", "tables"))
    arguments = parser.parse_args()
    POINTS.mkdir(exist_ok=True)
    parts = [arguments.only] if arguments.only else ["linear", "boundary", "nonlinear"]
    parts = [part for part in parts if part != "tables"]
    todo = [p for part in parts for p in points(part) if not p.path.exists()]
    with ProcessPoolExecutor(arguments.processes) as pool:
        waiting = {pool.submit(solve_and_keep, point): point for point in todo}
        for number, future in enumerate(as_completed(waiting), 1):
            failure = future.exception()
            word = f"failed: {failure}" if failure else "done"
            print(f"{number}/{len(todo)} {waiting[future].path.stem} {word}", flush=True)
    write_table()
    write_boundaries()


if __name__ == "__main__":
    main()
