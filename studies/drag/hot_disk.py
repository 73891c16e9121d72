"""Drag of a hot disk by the kinetic equation, over what the law of a cold one makes of it.

    python studies/drag/hot_disk.py

Each solved case becomes a line of ``hot_points.jsonl`` and is not solved again. Then the table is
printed: drag, its growth by the warmth, and the growth of the resistance of dense gas that
stands for it once the free molecules' own growth is known.

The disk moves slowly along its axis, and what is solved is the flow at rest, disturbed: the disk is
at rest and the gas far away streams. What the stream changes is linear in its speed and, with faces
that are alike, odd between the halves. It carries the warmth of the disk, so that the change of
temperature does not vanish far away: it goes to the cosine to the axis times a number that follows
from the heat of the disk. The rest vanishes.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.kinetic_theory.disk.cases import COARSE, MEDIUM, TOLERANCE, Resolution
from lightflyer.kinetic_theory.disk.linear import FaceWalls, LinearSystem
from lightflyer.kinetic_theory.disk.nonlinear import FixedPoint, HotDisk, NonlinearProblem, iterate
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import GasModel, gas_model

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

SPEED = 1e-4  # of the stream, in whose square its effect is not linear


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


def hot_disk_drag(
    rarefaction: float, gas: GasModel, tac: float, ratios: Sequence[float], resolution: Resolution
) -> list[float]:
    """Drag F/(pAs) of a disk in open space for each T_w/T of both its faces, at Maxwell walls."""
    mesh = resolution.mesh(rarefaction, np.inf)
    operators = assemble(mesh, rarefaction, resolution.quadrature)
    system = LinearSystem(operators, gas, tac)
    found = []
    for ratio in ratios:
        problem = NonlinearProblem(system, rarefaction, resolution.quadrature)
        disk = HotDisk((tac, tac), (ratio, ratio))
        start = system.solve(FaceWalls(disk.tac, (ratio - 1.0, ratio - 1.0)))[0]
        fields, _ = problem.solve(disk, start, TOLERANCE)
        problem.precondition_about(fields, disk)
        found.append(stream_drag(problem, disk, fields[0]))
    return found


def stream_drag(problem: NonlinearProblem, disk: HotDisk, around: np.ndarray) -> float:
    """Force per speed of a stream; ``around``: fields of a half without the stream."""
    mesh, gas = problem.system.operators.mesh, problem.system.gas
    at_rest = problem.face_result(np.stack([around, around]), 0, disk)
    # conduction and advection balance: T − 1 = b/r far away, and its change b U/(2 a) cos θ with
    # the diffusivity a
    modes = 7.0 if gas.has_rotation else 5.0
    eucken = 2.5 / gas.translational_rate
    if gas.has_rotation:
        eucken += 1.0 / gas.rotational_rate
    far = float(mesh.face_weights @ at_rest.heat) * problem.rarefaction / eucken
    warmth = 0.5 * modes * problem.rarefaction / eucken * far
    streaming = HotDisk(disk.tac, disk.temperature, stream=(SPEED, SPEED * warmth))

    def follows(fields: np.ndarray, of: HotDisk) -> np.ndarray:
        emitted = problem.emission(problem.arriving_fluxes(fields, 0, of), 0, of)
        return problem.half_fields(fields, 0, of, emitted)

    before = follows(np.stack([around, around]), disk)

    def halves(change: np.ndarray) -> np.ndarray:
        return np.stack([around + SPEED * change, around - SPEED * change])

    def missing(change: np.ndarray) -> np.ndarray:
        return (follows(halves(change), streaming) - before) / SPEED - change

    def precondition(residual: np.ndarray) -> np.ndarray:
        odd = lu_solve(problem.factors[1], residual.ravel(), check_finite=False)
        return odd.reshape(residual.shape)

    steps = FixedPoint(missing, precondition, lambda _: None, lambda _, new: new)
    change, step, _ = iterate(steps, np.zeros_like(around), TOLERANCE, problem.rarefaction)
    pressed = problem.face_result(halves(change + step), 0, streaming).pressure - at_rest.pressure
    return float(-2.0 * mesh.face_weights @ pressed / SPEED)


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
