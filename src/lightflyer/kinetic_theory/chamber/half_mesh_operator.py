"""Rows of the linear problem in the two halves of a mesh that need not be alike."""

from dataclasses import dataclass

import numpy as np

from lightflyer.kinetic_theory.disk import linear_kernel
from lightflyer.kinetic_theory.disk.operators import (
    Quadrature,
    face_points,
    kernel_arguments,
    node_points,
)
from lightflyer.kinetic_theory.grid.mesh import Mesh, Rim

_FINER = 2  # Gauss nodes in directions at walls, of which there are few, over those in the gas


@dataclass(frozen=True)
class HalvesState:
    """Gas at rest about which the equation is linearised, by default that at T_c."""

    # shape (n,); θ − 1 at the nodes of the halves
    excess: tuple[np.ndarray, np.ndarray] | None = None
    face: float = 1.0  # θ of the disk
    frequency_exponent: float = 0.0  # Exponent of the collision frequency in θ at uniform pressure


@dataclass(frozen=True)
class OperatorRows:
    """Moments at nodes, or fluxes that arrive at walls, as weighted sums of what sends them."""

    # There are m points, n nodes of a half, e of a face, w of the walls of a half, and k moments or
    # fluxes.

    # shape (m, n, 6, k); of the fields at the nodes of the own half, of the other one, and of the
    # own one as the disk reflects it
    own: np.ndarray
    other: np.ndarray
    reflected: np.ndarray
    sigma: np.ndarray  # shape (m, e, k); of the face of the own half
    temperature: np.ndarray
    velocity: np.ndarray  # shape (m, k); of its velocity
    # shape (3, m, 2, w, k); of σ and temperature of the walls around the gas: seen in the own half,
    # in the other one, and by reflection
    rim: np.ndarray
    theta: np.ndarray  # shape (m,); temperature at the points; 1 at walls


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
    about: HalvesState | None = None,
) -> tuple[HalfOperator, HalfOperator]:
    """Trace all rays of the upper and of the lower half; ``rarefaction``: δ of the gas at rest."""
    about = about or HalvesState()
    upper, lower = meshes
    first = _assemble(upper, lower, rarefaction, quadrature, about, 0)
    if upper.ceiling == lower.ceiling and about.excess is None:
        return first, first
    return first, _assemble(lower, upper, rarefaction, quadrature, about, 1)


def _assemble(
    mesh: Mesh, beyond: Mesh, rarefaction: float, quadrature: Quadrature, about: HalvesState, k: int
) -> HalfOperator:
    setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
    wall_setup = kernel_arguments(mesh, rarefaction, wall_quadrature(quadrature))[0]
    others = kernel_arguments(beyond, rarefaction, quadrature)[1]
    linear = about.excess is None
    zero = np.zeros((mesh.size, 1))
    excess = (zero, zero) if about.excess is None else tuple(x[:, None] for x in about.excess)
    state = (rarefaction, about.frequency_exponent, excess[k], excess[1 - k], about.face, linear)
    rim = Rim(mesh)
    wall_nodes = rim.eta.size if np.isfinite(mesh.boundary) else 0
    corrections = np.zeros((mesh.size, linear_kernel.FIELDS, linear_kernel.FIELDS))

    def traced(points: np.ndarray, on_wall: bool) -> OperatorRows:
        n, m, e = mesh.size, points.shape[0], mesh.eta.size
        count = linear_kernel.WALL_FLUXES if on_wall else linear_kernel.FIELDS
        own, other, reflected = (np.zeros((m, n, 6 * count)) for _ in range(3))
        face = np.zeros((m, 2 * e + 1, count))
        walls = np.zeros((3, m, 2 * wall_nodes, count))
        unused = np.zeros((m, 0, linear_kernel.FIELDS))
        linear_kernel.assemble(
            np.ascontiguousarray(points),
            on_wall,
            state,
            wall_setup if on_wall else setup,
            panels,
            others,
            own,
            other,
            reflected,
            face,
            walls,
            unused if on_wall else corrections,
        )
        return OperatorRows(
            own=own.reshape(m, n, 6, count),
            other=other.reshape(m, n, 6, count),
            reflected=reflected.reshape(m, n, 6, count),
            sigma=face[:, :e],
            temperature=face[:, e : 2 * e],
            velocity=face[:, 2 * e],
            rim=walls.reshape(3, m, 2, wall_nodes, count),
            theta=np.ones(m) if on_wall else 1.0 + excess[k][:, 0],
        )

    return HalfOperator(
        mesh,
        rim,
        traced(node_points(mesh), False),
        traced(face_points(mesh), True),
        traced(rim.points if wall_nodes else np.zeros((0, 5)), True),
        corrections,
    )
