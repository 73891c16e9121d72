"""Solve the published cases of a perforated disk with the kinetic solver.

    python studies/schafer2025_table/solve.py

Each solved point becomes a line of points.jsonl and is not solved again; the table is written
from these lines. About an hour on one core.
"""

import json
from pathlib import Path

from lightflyer.kinetic_theory.disk.cases import COARSE, MEDIUM, totals
from lightflyer.kinetic_theory.disk.linear import FaceWalls, LinearSystem
from lightflyer.kinetic_theory.disk.nonlinear import HotDisk, NonlinearProblem
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import gas_model

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
TABLE = FOLDER.parents[1] / "src/lightflyer/data/perforated_disk.csv"

# half-width of the reservoir [radii] at each rarefaction: that of the published simulations where
# it is known, up to 1; beyond, that in which the force at the middle open fraction is theirs
RESERVOIRS = {
    0.1: 3.0, 0.2: 3.0, 0.5: 3.0, 1.0: 3.0, 2.0: 4.0, 5.0: 6.0, 10.0: 6.0, 20.0: 5.0, 50.0: 5.0,
    100.0: 3.0,
}  # fmt: skip
OPEN_FRACTIONS = (0.0, 0.2, 0.4, 0.6, 0.7, 0.9, 0.95)
COARSE_SERVES = 10.0  # rarefaction up to which it is within half a percent of the medium mesh
RATIO = 4.0 / 3.0  # of the hot bottom face
TACS, TEMPERATURES = (1.0, 1.0), (1.0, RATIO)
TOLERANCE = 1e-6
COMMENTS = """\
# Perforated disk, one hot face, monatomic gas, complete accommodation, within a reservoir: from
# the non-linear kinetic equation; made by studies/schafer2025_table/solve.py. Licence: MIT.
# beta: open area fraction; delta = p a/(mu sqrt(2 R T0)); reservoir: its half-width over a;
# force F = force p pi a^2 dT/T0; heat Q = heat p sqrt(2 R T0) pi a^2 dT/T0 of each face
beta,delta,reservoir,force,heat_top,heat_bottom
"""


def read_found() -> dict[tuple[float, float], list[float]]:
    """Force and heat of both faces by rarefaction and open fraction, of what is solved."""
    lines = POINTS.read_text().splitlines() if POINTS.exists() else []
    return {(delta, beta): values for delta, beta, values in map(json.loads, lines)}


def solve(delta: float, missing: list[float]) -> None:
    """Solve a rarefaction at some open fractions; each becomes a line."""
    level, gas = COARSE if delta <= COARSE_SERVES else MEDIUM, gas_model("monatomic")
    mesh = level.mesh(delta, RESERVOIRS[delta])
    operators = assemble(mesh, delta, level.quadrature)
    excess, start = RATIO - 1.0, None
    for beta in missing:
        system = LinearSystem(operators, gas, TACS[0], beta, "maxwell")
        problem = NonlinearProblem(system, delta, level.quadrature)
        disk = HotDisk(TACS, TEMPERATURES, beta, "maxwell")
        if start is None:
            start = system.solve(FaceWalls(TACS, (0.0, excess), open_fraction=beta))[0]
        start, _ = problem.solve(disk, start, TOLERANCE)
        faces = [problem.face_result(start, face, disk) for face in (0, 1)]
        force, heat = totals(mesh, faces)
        values = [round(value / excess, 7) for value in (force, *heat)]
        with POINTS.open("a") as file:
            file.write(json.dumps([delta, beta, values]) + "\n")


def main() -> None:
    """Solve what is missing and write the table."""
    for delta in RESERVOIRS:
        found = read_found()
        missing = [beta for beta in OPEN_FRACTIONS if (delta, beta) not in found]
        if missing:
            solve(delta, missing)
    found = read_found()
    rows = [
        ",".join(f"{number:g}" for number in (beta, delta, reservoir, *found[delta, beta]))
        for beta in OPEN_FRACTIONS
        for delta, reservoir in RESERVOIRS.items()
    ]
    TABLE.write_text(COMMENTS + "\n".join(rows) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
