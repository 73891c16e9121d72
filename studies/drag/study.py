"""Make the table of the drag of a thin disk that ships with the package.

Run as ``python studies/drag/study.py``. Each solved rarefaction becomes a line of ``points.jsonl``
and is not solved again; the table is written from these lines.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

from lightflyer.kinetic_theory.disk.cases import FINE, MEDIUM
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.moving import MovedDisk, moving_outcomes

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
TABLE = FOLDER.parents[1] / "src" / "lightflyer" / "data" / "drag_disk.csv"

RAREFACTION = np.round(np.geomspace(0.01, 100.0, 25), 6)
HIGHEST = 22.0  # of the table: beyond, the meshes are worse than the law that goes on from there
GASES = ("monatomic", "diatomic")
TAC = (0.6, 0.2, 1.0)  # in the table; the first one's factors precondition the others
CHECKED_TAC = (0.4, 0.8)  # between, to check the interpolation
LEVELS = {"fine": FINE, "medium": MEDIUM}
SMALLEST_ERROR = 1e-5  # relative, where two meshes happen to agree better

HEADER = """\
# Drag of a thin disk that moves slowly along its axis, from the linear kinetic equation
# (lightflyer.kinetic_theory.solve_moving), in open space; made by studies/drag/study.py.
# rarefaction: p r/(mu sqrt(2 R T)); tac: accommodation coefficient of both faces;
# drag: F/(p A s) with s = U/sqrt(2 R T) and the area of one face; drag_error: absolute, the change
# with a coarser mesh. Licence: MIT, as this package.
gas,rarefaction,tac,drag,drag_error
"""


def measure(rarefaction: float, level: str) -> dict:
    """Drag for every gas and TAC on one mesh."""
    cases = [(gas, tac) for gas in GASES for tac in (*TAC, *CHECKED_TAC)]
    began = time.process_time()
    solved = moving_outcomes(
        rarefaction,
        LEVELS[level],
        [(gas_model(gas), MovedDisk((tac, tac))) for gas, tac in cases],
    )
    drag = [[gas, tac, one.drag] for (gas, tac), one in zip(cases, solved, strict=True)]
    seconds = round(time.process_time() - began, 1)
    return {"rarefaction": rarefaction, "level": level, "seconds": seconds, "drag": drag}


def read_points() -> dict[tuple[float, str], dict[tuple[str, float], float]]:
    """Drag by gas and TAC, of each rarefaction and mesh solved so far."""
    found = {}
    if POINTS.exists():
        for line in POINTS.read_text().splitlines():
            point = json.loads(line)
            values = {(gas, tac): drag for gas, tac, drag in point["drag"]}
            found[point["rarefaction"], point["level"]] = values
    return found


def rows() -> list[str]:
    """Rows of the table."""
    points = read_points()
    found = []
    for gas in GASES:
        for rarefaction in RAREFACTION[RAREFACTION < HIGHEST]:
            fine, medium = (points[float(rarefaction), level] for level in LEVELS)
            for tac in sorted(TAC):
                drag = fine[gas, tac]
                error = max(abs(drag - medium[gas, tac]), SMALLEST_ERROR * drag)
                found.append(f"{gas},{rarefaction:g},{tac:g},{drag:.6g},{error:.1e}")
    return found


def main() -> None:
    """Solve what is missing and write the table."""
    argparse.ArgumentParser(description=__doc__).parse_args()
    solved = read_points()
    for level in LEVELS:
        for rarefaction in map(float, RAREFACTION):
            if (rarefaction, level) in solved:
                continue
            point = measure(rarefaction, level)
            with POINTS.open("a") as file:
                file.write(json.dumps(point) + "\n")
            print(f"{level} {rarefaction:g}: {point['seconds']} s", flush=True)
    partial = TABLE.with_suffix(".partial")
    partial.write_text(HEADER + "\n".join(rows()) + "\n")
    partial.rename(TABLE)
    print(f"wrote {TABLE.name}")


if __name__ == "__main__":
    main()
