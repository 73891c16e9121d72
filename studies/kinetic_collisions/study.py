"""What collisions of real molecules take from force and heat, over what the model equation says.

Run as ``python studies/kinetic_collisions/study.py [--only tables]``. Each solved point becomes a
line of ``points.jsonl`` and is not solved again; the package's table is written from these lines.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from lightflyer.kinetic_theory.collisions.brackets import Molecule
from lightflyer.kinetic_theory.collisions.operator import FEWER_MOMENTS, MOMENTS
from lightflyer.kinetic_theory.collisions.problem import solve_molecules
from lightflyer.kinetic_theory.disk.cases import COARSE, Case, DiskOutcome, solve_case
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import gas_model

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data" / "kinetic_collisions.csv"

KNUDSEN = (0.25, 0.1, 0.6, 1.5, 0.05, 5.0, 30.0, 0.03)
ALSO_POOR = (0.1, 0.6, 5.0)  # Knudsen numbers at which another TAC is solved as well
EXPONENTS = {"monatomic": (0.74, 0.5, 0.93), "diatomic": (0.74, 0.93)}
EXCHANGE = 0.2  # Larsen and Borgnakke's probability of nitrogen near 300 K
TAC, POOR_TAC, TAC_DIFFERENCE = 0.9, 0.4, 0.1
CHECKED = ((0.1, 0.74), (1.5, 0.74))  # points also solved with fewer moments


@dataclass(frozen=True)
class Point:
    """One point of the table."""

    gas: str
    viscosity_exponent: float
    knudsen: float
    tac: float
    fewer: bool = False

    @property
    def molecule(self) -> Molecule:
        """Its molecules."""
        rotates = self.gas == "diatomic"
        return Molecule(self.viscosity_exponent, EXCHANGE if rotates else 0.0, rotates)

    @property
    def case(self) -> Case:
        """A disk with faces of slightly different TAC."""
        half = 0.5 * TAC_DIFFERENCE
        return Case(
            rarefaction=float(np.sqrt(np.pi) / (4.0 * self.knudsen)),
            tac=(self.tac + half, self.tac - half),
            temperature=(1.0, 1.0),
            linear=True,
            gas=gas_model(self.gas),
            boundary=np.inf,
        )


Kept = dict[Point, dict[str, float]]


def points() -> Iterator[Point]:
    """All points, those first that matter most."""
    for knudsen in KNUDSEN:
        for exponent in sorted({w for of_kind in EXPONENTS.values() for w in of_kind}):
            for gas, exponents in EXPONENTS.items():
                if exponent not in exponents:
                    continue
                yield Point(gas, exponent, knudsen, TAC)
                if knudsen in ALSO_POOR:
                    yield Point(gas, exponent, knudsen, POOR_TAC)
                if (knudsen, exponent) in CHECKED:
                    yield Point(gas, exponent, knudsen, TAC, fewer=True)


def ratios(case: Case, outcome: DiskOutcome) -> tuple[float, float]:
    """Force and heat over those of free molecules."""
    free = case.free_molecular()
    return float(outcome.force / free.force), float(sum(outcome.heat) / sum(free.heat))


def measure(group: list[Point]) -> Iterator[tuple[Point, dict[str, float]]]:
    """Solve points that differ in TAC and kind alone, on the coarse mesh, with both operators."""
    case = group[0].case
    mesh = COARSE.mesh(case.rarefaction, case.boundary)
    operators = assemble(mesh, case.rarefaction, COARSE.quadrature)
    for point in group:
        moments = FEWER_MOMENTS if point.fewer else MOMENTS
        real = solve_molecules(
            point.case, COARSE, point.molecule, moments=moments, operators=operators
        )
        model = solve_case(point.case, COARSE)
        result = {}
        pairs = zip(ratios(point.case, real), ratios(point.case, model), strict=True)
        for name, (here, there) in zip(("force", "heat"), pairs, strict=True):
            result[f"{name}_ratio"] = here
            result[f"{name}_factor"] = (1.0 / here - 1.0) / (1.0 / there - 1.0)
        yield point, {name: float(value) for name, value in result.items()}


def read_kept() -> Kept:
    """The points solved so far."""
    if not POINTS.exists():
        return {}
    lines = (json.loads(line) for line in POINTS.read_text().splitlines())
    return {Point(**place): result for place, result in lines}


def write_table(found: Kept) -> None:
    """Write the package's table."""
    rows = [
        f"{p.gas},{p.viscosity_exponent:g},{p.knudsen:g},{p.tac:g},"
        f"{result['force_factor']:.5f},{result['heat_factor']:.5f}"
        for p, result in sorted(found.items(), key=lambda item: _order(item[0]))
        if not p.fewer
    ]
    partial = DATA.with_suffix(".partial")
    partial.write_text(COMMENTS + COLUMNS + "\n" + "\n".join(rows) + "\n")
    partial.rename(DATA)
    print(f"wrote {DATA.name}: {len(rows)} rows")


def _order(point: Point) -> tuple[str, float, float, float]:
    """Order of the rows."""
    return point.gas, point.viscosity_exponent, point.knudsen, point.tac


COLUMNS = "gas,viscosity_exponent,knudsen,tac,force_factor,heat_factor"
COMMENTS = f"""\
# What collisions of VHS molecules take from force and heat of a thin disk, 1/F - 1 and 1/Q - 1 with
# F and Q over free-molecular values, over what the package's model equation says: small temperature
# differences, open space, Maxwell walls; made by studies/kinetic_collisions/study.py.
# viscosity_exponent: that of viscosity in temperature; diatomic: with rotation by Larsen and
# Borgnakke at a probability of {EXCHANGE:g}; knudsen: mean free path (mu/p) sqrt(pi R T_c/2) over
# the diameter; tac: mean of both faces. Licence: MIT, as this package.
"""


def main() -> None:
    """Solve what is missing and write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=("tables",))
    arguments = parser.parse_args()
    found = read_kept()
    if not arguments.only:
        todo = [point for point in points() if point not in found]
        for (knudsen, exponent), group in groupby(
            todo, key=lambda p: (p.knudsen, p.viscosity_exponent)
        ):
            print(f"Kn {knudsen:g}, exponent {exponent:g}", flush=True)
            for point, result in measure(list(group)):
                with POINTS.open("a") as file:
                    file.write(json.dumps([asdict(point), result]) + "\n")
    write_table(read_kept())


if __name__ == "__main__":
    main()
