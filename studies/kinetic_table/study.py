"""Make the tables of the kinetic force that ship with the package.

Run as ``python studies/kinetic_table/study.py [--processes 2] [--only PART]``. Each solved point
becomes a line of ``points.jsonl`` and is not solved again; the tables are written from these lines.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from lightflyer.kinetic.cases import (
    COARSE,
    MEDIUM,
    SMALLEST_ERROR,
    Case,
    Outcome,
    Resolution,
    meshes,
    solve_case,
)
from lightflyer.kinetic.model_gases import gas_model
from lightflyer.kinetic.solver import furthest_boundary

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data"

GASES = ("monatomic", "diatomic")
KNUDSEN = (0.03, 0.05, 0.08, 0.125, 0.2, 0.35, 0.6, 1.0, 2.0, 5.0, 10.0, 30.0)
RATIOS = (1.0, 1.6, 2.5)
TAC = (0.6, 0.8, 1.0)
BOUNDARIES = (2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0)
CHECKED_TAC = 0.8  # of non-linear points solved on two meshes
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


Kept = dict[Point, dict[str, float]]


def measure(group: list[Point]) -> Kept:
    """Solve points that differ in TAC alone: ratios to free-molecular values and their errors.

    The non-linear problem is solved on the better mesh at one TAC only: what that changes there,
    it changes at the others. Each of its solutions starts from the one before.
    """
    if group[0].ratio == 1.0:
        return {
            point: compared(*(solved(point, level) for level in levels(point))) for point in group
        }
    first, *others = sorted(group, key=lambda point: point.tac != CHECKED_TAC)
    outcome = solve_case(case(first), COARSE)
    better, coarse = solved(first, MEDIUM), ratios(first, outcome)
    kept = {first: compared(better, coarse)}
    for point in others:
        outcome = solve_case(case(point), COARSE, start=outcome.fields)
        found = {
            name: x * better[name] / coarse[name] for name, x in ratios(point, outcome).items()
        }
        kept[point] = kept[first] | found
    return kept


def solved(point: Point, level: Resolution) -> dict[str, float]:
    """Ratios of one point on one mesh."""
    return ratios(point, solve_case(case(point), level))


def compared(found: dict[str, float], coarse: dict[str, float] | None = None) -> dict[str, float]:
    """Ratios, with their differences to those on a coarser mesh as errors."""
    if coarse is None:
        return found
    return found | {f"{name}_error": abs(found[name] - value) for name, value in coarse.items()}


def levels(point: Point) -> tuple[Resolution, ...]:
    """Meshes of a linear point: the first gives the result, the second its error."""
    if point.tac == BOUNDARY_TAC:
        return (MEDIUM,)
    return meshes(point.knudsen, linear=True)


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


def read_kept() -> Kept:
    """The points solved so far."""
    found: Kept = {}
    if POINTS.exists():
        for line in POINTS.read_text().splitlines():
            place, result = json.loads(line)
            found[Point(**place)] = result
    return found


def keep(solved: Kept) -> None:
    """Append solved points, a line each, at once."""
    lines = []
    for point, result in solved.items():
        place = {k: v for k, v in asdict(point).items() if v != np.inf}
        lines.append(json.dumps([place, {k: float(v) for k, v in result.items()}]) + "\n")
    with POINTS.open("a") as file:
        file.write("".join(lines))


def groups(part: str, found: Kept) -> list[list[Point]]:
    """Points of a part that are not all there yet, together if they differ in TAC alone."""
    together: dict[Point, list[Point]] = {}
    for point in points(part):
        together.setdefault(replace(point, tac=CHECKED_TAC), []).append(point)
    return [group for group in together.values() if not all(point in found for point in group)]


def points(part: str) -> list[Point]:
    """Points of a part, the longest to solve first: linear, boundary or nonlinear."""
    if part == "boundary":
        mean = BOUNDARY_TAC
        places = (*BOUNDARIES, np.inf)
        return [
            Point(g, k, 1.0, mean, d)
            for k in KNUDSEN
            for g in GASES
            for d in places
            if d <= furthest_boundary(k) or d == np.inf
        ]
    chosen = [r for r in RATIOS if (r == 1.0) == (part == "linear")]
    return [Point(g, k, r, a) for k in KNUDSEN for r in chosen for g in GASES for a in TAC]


TABLE_COLUMNS = (
    "gas,knudsen,temperature_ratio,tac,force_ratio,heat_ratio,heat_ratio_slope,"
    "force_ratio_error,heat_ratio_error"
)
TABLE_COMMENTS = """\
# Force and heat loss of a thin disk over their exact free-molecular values for Maxwell walls, in
# open space, from the kinetic equation; made by studies/kinetic_table/study.py.
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
# Further out than is resolved, the excess over 1 is taken to fall as 1/boundary.
# knudsen: mean free path over the disk's diameter. Licence: MIT, as this package.
"""


def with_error(point: Point, found: Kept) -> dict[str, float] | None:
    """A point's result; its errors are no smaller than in the linear limit.

    The finer mesh of the non-linear problem is one that agrees with a coarse one by chance here
    and there.
    """
    result, linear = found.get(point), found.get(replace(point, ratio=1.0))
    if result is None or linear is None:
        return None
    least = {name: max(result[name], linear[name]) for name in linear if name.endswith("_error")}
    return result | least


def write_table(found: Kept) -> None:
    """Write the table of force and heat, with every ratio and gas that is complete."""
    rows = []
    for gas in GASES:
        for ratio in RATIOS:
            grid = [Point(gas, knudsen, ratio, tac) for knudsen in KNUDSEN for tac in TAC]
            results = [with_error(point, found) for point in grid]
            if any(result is None for result in results):
                print(f"{gas} at ratio {ratio:g} is incomplete and left out")
                continue
            rows += [table_row(*pair) for pair in zip(grid, results, strict=True)]
    write_whole(DATA / "kinetic.csv", TABLE_COMMENTS, TABLE_COLUMNS, rows)


def table_row(point: Point, result: dict[str, float]) -> str:
    """One line of the table."""
    place = f"{point.gas},{point.knudsen:g},{point.ratio:g},{point.tac:g}"
    names = ("force_ratio", "heat_ratio", "heat_ratio_slope")
    values = [f"{result[name]:.6f}" for name in names]
    errors = [
        f"{max(result[f'{name}_error'], least):.1e}" for name, least in SMALLEST_ERROR.items()
    ]
    return ",".join((place, *values, *errors))


def write_boundaries(found: Kept) -> None:
    """Write the factors of a reservoir, for every gas and Knudsen number that is complete."""
    rows = []
    for gas in GASES:
        for knudsen in KNUDSEN:
            near = [d for d in BOUNDARIES if d <= furthest_boundary(knudsen)]
            grid = [Point(gas, knudsen, 1.0, BOUNDARY_TAC, place) for place in near]
            results = [found.get(point) for point in grid]
            free = found.get(Point(gas, knudsen, 1.0, BOUNDARY_TAC))
            if free is None or any(result is None for result in results):
                print(f"boundaries of {gas} at Kn {knudsen:g} are incomplete and left out")
                continue
            names = ("force_ratio", "heat_ratio")
            excess = [[result[name] / free[name] - 1.0 for name in names] for result in results]
            for place in BOUNDARIES:
                nearest = min(place, near[-1])
                values = excess[near.index(nearest)]
                force, heat = (1.0 + value * nearest / place for value in values)
                rows.append(f"{gas},{knudsen:g},{place:g},{force:.5f},{heat:.5f}")
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
    parts = [arguments.only] if arguments.only else ["linear", "boundary", "nonlinear"]
    found = read_kept()
    todo = [group for part in parts if part != "tables" for group in groups(part, found)]
    with ProcessPoolExecutor(arguments.processes) as pool:
        waiting = {pool.submit(measure, group): group for group in todo}
        for number, future in enumerate(as_completed(waiting), 1):
            group, failure = waiting[future], future.exception()
            if failure is None:
                keep(future.result())
            word = "done" if failure is None else f"failed: {failure}"
            print(f"{number}/{len(todo)} {group[0]} {word}", flush=True)
    found = read_kept()
    write_table(found)
    write_boundaries(found)


if __name__ == "__main__":
    main()
