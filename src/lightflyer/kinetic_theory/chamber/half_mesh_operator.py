"""Rows of the linear problem in the two halves of a mesh that need not be alike."""

from dataclasses import dataclass

import numpy as np

from lightflyer.kinetic_theory.disk import linear_kernel
from lightflyer.kinetic_theory.disk.operators import (
    BaseState,
    OperatorRows,
    Quadrature,
    face_points,
    kernel_arguments,
    node_points,
    trace_rows,
)
from lightflyer.kinetic_theory.grid.mesh import Mesh, Rim

_FINER = 2  # Gauss nodes in directions at walls, of which there are few, over those in the gas


@dataclass(frozen=True)
class HalfOperator:
    """Rows of one half: of its gas, of its face of the disk and of its walls."""

    # ``corrections``, shape (n, 6, 6), are those of uniform fields, contained in ``gas``.

    mesh: Mesh
    rim: Rim
    gas: OperatorRows
    face: OperatorRows
    walls: OperatorRows
    corrections: np.ndarray

    @property
    def rim_points(self) -> np.ndarray:
        """Nodes on the walls as the compiled kernels take them; none in open space."""
        return self.rim.points if self.walls.theta.size else np.zeros((0, 5))


def wall_quadrature(quadrature: Quadrature) -> Quadrature:
    """Quadrature at walls, where what arrives is to add up to what leaves."""
    return Quadrature(_FINER * quadrature.height, _FINER * quadrature.azimuth, quadrature.ray)


def assemble_halves(
    meshes: tuple[Mesh, Mesh],
    rarefaction: float,
    quadrature: Quadrature,
    about: BaseState | None = None,
) -> tuple[HalfOperator, HalfOperator]:
    """Trace all rays of the upper and of the lower half; ``rarefaction``: δ of the gas at rest."""
    about = about or BaseState()
    upper, lower = meshes
    first = _assemble(upper, lower, rarefaction, quadrature, about, 0)
    if upper.ceiling == lower.ceiling and about.excess is None:
        return first, first
    return first, _assemble(lower, upper, rarefaction, quadrature, about, 1)


def _assemble(
    mesh: Mesh, beyond: Mesh, rarefaction: float, quadrature: Quadrature, about: BaseState, k: int
) -> HalfOperator:
    setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
    wall_setup = kernel_arguments(mesh, rarefaction, wall_quadrature(quadrature))[0]
    others = kernel_arguments(beyond, rarefaction, quadrature)[1]
    at_walls, halves = (wall_setup, panels, others), (setup, panels, others)
    state = about.of_kernel(mesh.size, rarefaction, k)
    rim = Rim(mesh)
    nodes = rim.eta.size if np.isfinite(mesh.boundary) else 0
    corrections = np.zeros((mesh.size, linear_kernel.FIELDS, linear_kernel.FIELDS))
    around = rim.points if nodes else np.zeros((0, 5))
    return HalfOperator(
        mesh,
        rim,
        trace_rows(mesh, node_points(mesh), state, halves, corrections, nodes),
        trace_rows(mesh, face_points(mesh), state, at_walls, wall_nodes=nodes),
        trace_rows(mesh, around, state, at_walls, wall_nodes=nodes),
        corrections,
    )
