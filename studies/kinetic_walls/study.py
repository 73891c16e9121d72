"""Make the table of what accommodated walls change beside Maxwell's, which ships with the package.

Run as ``python studies/kinetic_walls/study.py [--only PART]``. Each solved point becomes a line of
``points.jsonl`` and is not solved again; the table is written from these lines.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import get_args

import numpy as np

from lightflyer.kinetic_theory.disk.cases import COARSE, MEDIUM, Case, Resolution, solve_case
from lightflyer.kinetic_theory.disk.linear import FaceWalls, LinearSystem, face_result
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.walls import Wall

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
TABLE = FOLDER.parents[1] / "src" / "lightflyer" / "data" / "kinetic_walls.csv"

GASES = ("monatomic", "diatomic")
DENSE = (0.006, 0.012, 0.02)  # on the better mesh only
KNUDSEN = (0.03, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0, 10.0, 30.0)
TAC = (0.1, 0.3, 0.6, 0.8, 1.0)
FACTORISED = 0.6  # mean TAC whose factors precondition the others
HOT_KNUDSEN = (0.03, 0.06, 0.12, 0.3, 1.0, 4.0)
HOT_TAC = (0.4, 0.9)
HOT = 2.5
OTHER_KNUDSEN = (0.06, 0.3, 4.0)  # for other temperature ratios, at the second TAC
OTHER_RATIOS = (0.5, 1.6, 3.5)
OTHER_TAC = (0.15, 0.65)  # for the first ratio, at these Knudsen numbers
CHECKED = ((0.03, 1.0, 0.3), (0.03, 1.0, 0.8), (0.2, 1.0, 0.3), (0.1, HOT, 0.8))
"""Points that are solved on the better mesh too: Kn, T_h/T_c, mean TAC."""
TAC_DIFFERENCE = 0.1


@dataclass(frozen=True)
class Point:
    """A disk in a gas, with one wall and mesh; a ratio of 1 is the linear problem."""

    gas: str
    knudsen: float
    ratio: float
    tac: float
    wall: Wall
    mesh: str = "coarse"

    @property
    def case(self) -> Case:
        """Faces of TAC above and below the mean by half the difference."""
        half, linear = 0.5 * TAC_DIFFERENCE, self.ratio == 1.0
        return Case(
            rarefaction=float(np.sqrt(np.pi) / (4.0 * self.knudsen)),
            tac=(self.tac + half, self.tac - half),
            temperature=(self.ratio, self.ratio),
            linear=linear,
            gas=gas_model(self.gas),
            boundary=np.inf,
            wall=self.wall,
        )

    @property
    def resolution(self) -> Resolution:
        """Mesh by name."""
        return {"coarse": COARSE, "medium": MEDIUM}[self.mesh]


Kept = dict[Point, dict[str, float]]


def linear(points: list[Point]) -> Kept:
    """Solve linear points of one Knudsen number and mesh, whose rays are traced once."""
    case, resolution = points[0].case, points[0].resolution
    mesh = resolution.mesh(case.rarefaction, np.inf)
    operators = assemble(mesh, case.rarefaction, resolution.quadrature)
    found: Kept = {}
    for gas, wall in dict.fromkeys((point.gas, point.wall) for point in points):
        system = LinearSystem(operators, gas_model(gas), FACTORISED, wall=wall)
        for point in (p for p in points if (p.gas, p.wall) == (gas, wall)):
            walls = FaceWalls(point.case.tac, (1.0, 1.0))
            fields, _ = system.solve(walls)
            faces = [face_result(system, walls, fields[face], face) for face in (0, 1)]
            top, bottom = (float(mesh.face_weights @ face.heat) for face in faces)
            force = float(mesh.face_weights @ (faces[1].pressure - faces[0].pressure))
            found[point] = ratios(point, force, (top, bottom))
    return found


def hot(point: Point) -> dict[str, float]:
    """Solve a non-linear point."""
    outcome = solve_case(point.case, point.resolution)
    return ratios(point, outcome.force, outcome.heat)


def ratios(point: Point, force: float, heat: tuple[float, float]) -> dict[str, float]:
    """Force and mean heat of the faces over those of free molecules at the same wall."""
    limit = point.case.free_molecular()
    return {
        "force_ratio": force / limit.force,
        "heat_ratio": float(np.mean(np.divide(heat, limit.heat))),
    }


def mesh_of(knudsen: float) -> str:
    """Mesh of the table's points."""
    return "medium" if knudsen in DENSE else "coarse"


def linear_points() -> list[list[Point]]:
    """Points of the linear problem, by Knudsen number and mesh."""
    grid = [
        [Point(g, k, 1.0, a, w, mesh_of(k)) for g in GASES for a in TAC for w in get_args(Wall)]
        for k in (*KNUDSEN, *DENSE)
    ]
    checked = [
        [Point(g, k, r, a, w, "medium") for g in GASES for w in get_args(Wall)]
        for k, r, a in CHECKED
        if r == 1.0
    ]
    return grid + checked


def hot_points() -> Iterator[Point]:
    """Points of the non-linear problem, the quickest first."""
    places = [(k, HOT, a, "coarse") for k in HOT_KNUDSEN for a in HOT_TAC]
    places += [(k, r, HOT_TAC[1], "coarse") for k in OTHER_KNUDSEN for r in OTHER_RATIOS]
    places += [(k, HOT, a, "coarse") for k in OTHER_KNUDSEN for a in OTHER_TAC]
    places += [(k, r, a, mesh) for k, r, a in CHECKED if r != 1.0 for mesh in ("coarse", "medium")]
    for knudsen, ratio, tac, mesh in sorted(places, reverse=True):
        for gas in GASES:
            for wall in get_args(Wall):
                yield Point(gas, knudsen, ratio, tac, wall, mesh)


def read_kept() -> Kept:
    """The points solved so far."""
    if not POINTS.exists():
        return {}
    lines = [json.loads(line) for line in POINTS.read_text().splitlines()]
    return {Point(**place): result for place, result in lines}


def keep(solved: Kept) -> None:
    """Append solved points, a line each, at once."""
    with POINTS.open("a") as file:
        file.write("".join(json.dumps([asdict(p), r]) + "\n" for p, r in solved.items()))


COLUMNS = (
    "gas,knudsen,temperature_ratio,tac,force_ratio_maxwell,force_ratio_accommodated,"
    "heat_ratio_maxwell,heat_ratio_accommodated"
)
COMMENTS = """\
# Force and heat loss of a thin disk at Maxwell walls, and at walls from which all molecules leave
# at one accommodated temperature, each over its own exact free-molecular value, in open space, from
# the kinetic equation; made by studies/kinetic_walls/study.py, mostly on a coarse mesh: for the
# ratio of both walls, not for the values, which kinetic.csv has.
# knudsen: mean free path (mu/p) sqrt(pi R T_c/2) over the diameter, in the gas far away;
# temperature_ratio: T_h/T_c, where 1 is the linear limit; tac: mean of both faces, which differ by
# 0.1. Licence: MIT, as this package.
"""


def write_table(found: Kept) -> None:
    """Write the table of every place that is solved with both walls."""
    rows = []
    for point, maxwell in sorted(found.items(), key=lambda item: order(item[0])):
        accommodated = found.get(replace(point, wall="accommodated"))
        if point.mesh != mesh_of(point.knudsen) or point.wall != "maxwell" or accommodated is None:
            continue
        values = [
            f"{one[name]:.6f}"
            for name in ("force_ratio", "heat_ratio")
            for one in (maxwell, accommodated)
        ]
        place = f"{point.gas},{point.knudsen:g},{point.ratio:g},{point.tac:g}"
        rows.append(",".join((place, *values)))
    partial = TABLE.with_suffix(".partial")
    partial.write_text(COMMENTS + COLUMNS + "\n" + "\n".join(rows) + "\n")
    partial.rename(TABLE)
    print(f"wrote {TABLE.name}: {len(rows)} rows")


def order(point: Point) -> tuple[int, float, float, float]:
    """Order of the rows: gas, temperature ratio, Knudsen number, TAC."""
    return GASES.index(point.gas), point.ratio, point.knudsen, point.tac


def main() -> None:
    """Solve what is missing and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=("linear", "hot", "table"))
    only = parser.parse_args().only
    found = read_kept()
    if only in (None, "linear"):
        for group in linear_points():
            missing = [point for point in group if point not in found]
            if missing:
                keep(linear(missing))
                print(missing[0], flush=True)
    if only in (None, "hot"):
        for point in hot_points():
            if point not in found:
                keep({point: hot(point)})
                print(point, flush=True)
    write_table(read_kept())


if __name__ == "__main__":
    main()
