"""Drag of a hot disk that moves slowly along its axis: the flow at rest, disturbed.

The disk is at rest and the gas far away streams. What the stream changes is linear in its speed
and, with faces that are alike, odd between the halves. It carries the warmth of the disk, so that
the change of temperature does not vanish far away: it goes to the cosine to the axis times a number
that follows from the heat of the disk. The rest vanishes.
"""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.kinetic_theory.disk.cases import Resolution
from lightflyer.kinetic_theory.disk.fixed_point import Problem, iterate
from lightflyer.kinetic_theory.disk.linear import LinearSystem, Walls
from lightflyer.kinetic_theory.disk.nonlinear import HotDisk, NonlinearProblem
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import GasModel

_SPEED = 1e-4  # of the stream, in whose square its effect is not linear
_TOLERANCE = 1e-6


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
        start = system.solve(Walls(disk.tac, (ratio - 1.0, ratio - 1.0)))[0]
        fields, _ = problem.solve(disk, start, _TOLERANCE)
        problem.precondition_about(fields, disk)
        found.append(_stream_drag(problem, disk, fields[0]))
    return found


def _stream_drag(problem: NonlinearProblem, disk: HotDisk, around: np.ndarray) -> float:
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
    streaming = HotDisk(disk.tac, disk.temperature, stream=(_SPEED, _SPEED * warmth))

    def follows(fields: np.ndarray, of: HotDisk) -> np.ndarray:
        emitted = problem.emission(problem.arriving_fluxes(fields, 0, of), 0, of)
        return problem.half_fields(fields, 0, of, emitted)

    before = follows(np.stack([around, around]), disk)

    def halves(change: np.ndarray) -> np.ndarray:
        return np.stack([around + _SPEED * change, around - _SPEED * change])

    def missing(change: np.ndarray) -> np.ndarray:
        return (follows(halves(change), streaming) - before) / _SPEED - change

    def precondition(residual: np.ndarray) -> np.ndarray:
        odd = lu_solve(problem.factors[1], residual.ravel(), check_finite=False)
        return odd.reshape(residual.shape)

    steps = Problem(missing, precondition, lambda _: None, lambda _, new: new)
    change, step, _ = iterate(steps, np.zeros_like(around), _TOLERANCE, problem.rarefaction)
    pressed = problem.face_result(halves(change + step), 0, streaming).pressure - at_rest.pressure
    return float(-2.0 * mesh.face_weights @ pressed / _SPEED)
