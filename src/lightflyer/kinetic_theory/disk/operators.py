"""Assembly of the linear problem on a mesh: matrices for any TAC and any wall."""

from dataclasses import dataclass

import numpy as np

from lightflyer.kinetic_theory.disk import linear_kernel
from lightflyer.kinetic_theory.grid.mesh import Mesh, gauss
from lightflyer.kinetic_theory.grid.rays import spline_table

_LAYER = 0.1  # height of the panel of directions next to the horizon


@dataclass(frozen=True)
class Quadrature:
    """Gauss nodes per panel: in height and azimuth of directions, and along rays."""

    height: int = 4
    azimuth: int = 4
    ray: int = 4


def kernel_arguments(mesh: Mesh, rarefaction: float, quadrature: Quadrature) -> tuple:
    """Arguments of the compiled kernels: quadratures with tables, and panels."""
    table, scale = spline_table()
    # weights of the integral from 0 to each Gauss node, from values at the nodes, shape (m, m)
    nodes, powers = gauss(quadrature.ray)[0][:, None], np.arange(quadrature.ray)
    integrals = nodes ** (powers + 1) / (powers + 1)
    partial = np.linalg.solve((nodes**powers).T, integrals.T).T
    setup = (
        min(_LAYER, _LAYER / rarefaction),
        np.array(gauss(quadrature.height)),
        np.array(gauss(quadrature.azimuth)),
        np.array(gauss(quadrature.ray)),
        np.ascontiguousarray(partial),
        table,
        scale,
    )
    panels = (
        mesh.xi_edges,
        mesh.xi_kinds,
        mesh.eta_edges,
        _lagrange_bases(mesh.xi_nodes),
        _lagrange_bases(mesh.eta_nodes),
        float(mesh.boundary),
        float(mesh.ceiling),
        _lagrange_bases(np.tile(gauss(mesh.order)[0], (mesh.eta_nodes.shape[0], 1))),
    )
    return setup, panels


def _lagrange_bases(nodes: np.ndarray) -> np.ndarray:
    """Nodes and inverse denominators of Lagrange's polynomials, shape (panels, 2, order)."""
    differences = nodes[:, :, None] - nodes[:, None, :] + np.eye(nodes.shape[1])
    return np.stack([nodes, 1.0 / np.prod(differences, axis=2)], axis=1)


@dataclass(frozen=True)
class BaseState:
    """Gas at rest about which the equation is linearised, by default that far away."""

    # shape (n,); θ − 1 at the nodes of the two halves
    excess: tuple[np.ndarray, np.ndarray] | None = None
    face: float = 1.0  # θ of the faces
    frequency_exponent: float = 0.0  # Exponent of the collision frequency in θ at uniform pressure

    def of_kernel(self, size: int, rarefaction: float, half: int = 0) -> tuple:
        """Arguments of the kernels for a half of as many nodes; ``rarefaction``: δ at rest."""
        zero = np.zeros((size, 1))
        own, other = (zero, zero) if self.excess is None else (x[:, None] for x in self.excess)
        if half:
            own, other = other, own
        linear = self.excess is None
        return rarefaction, self.frequency_exponent, own, other, self.face, linear


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


def trace_rows(
    mesh: Mesh,
    points: np.ndarray,
    state: tuple,
    arguments: tuple[tuple, tuple, tuple],
    corrections: np.ndarray | None = None,
    wall_nodes: int = 0,
) -> OperatorRows:
    """Trace all rays to points, shape (m, 5): the nodes of a half, or on walls.

    ``arguments``: quadratures, and panels of the own and the other half. ``corrections``, shape
    (n, 6, 6), are filled for nodes; None at walls.
    """
    n, m, e, on_wall = mesh.size, points.shape[0], mesh.eta.size, corrections is None
    count = linear_kernel.WALL_FLUXES if on_wall else linear_kernel.FIELDS
    own, other, reflected = (np.zeros((m, n, 6 * count)) for _ in range(3))
    face = np.zeros((m, 2 * e + 1, count))
    rim = np.zeros((3, m, 2 * wall_nodes, count))
    unused = np.zeros((m, 0, linear_kernel.FIELDS))
    linear_kernel.assemble(
        np.ascontiguousarray(points), on_wall, state, *arguments, own, other, reflected, face, rim,
        unused if corrections is None else corrections,
    )  # fmt: skip
    return OperatorRows(
        own=own.reshape(m, n, 6, count),
        other=other.reshape(m, n, 6, count),
        reflected=reflected.reshape(m, n, 6, count),
        sigma=face[:, :e],
        temperature=face[:, e : 2 * e],
        velocity=face[:, 2 * e],
        rim=rim.reshape(3, m, 2, wall_nodes, count),
        theta=np.ones(m) if on_wall else 1.0 + state[2][:, 0],
    )


@dataclass(frozen=True)
class Operators:
    """Assembled rows, with n nodes of a half and e of a face."""

    mesh: Mesh
    own: np.ndarray  # shape (n, n, 6, 6); node of the row, of the column, field, moment
    other: np.ndarray
    reflected: np.ndarray
    # shape (n, e, 6); contribution of σ and of the temperature at the nodes of the face to each
    # moment
    sigma: np.ndarray
    temperature: np.ndarray
    velocity: np.ndarray  # shape (n, 6); contribution of a velocity of the face
    # shape (e, n, 6, 3); node of the face, node, field, arriving flux of number, normal momentum,
    # energy
    fluxes: np.ndarray
    # shape (n, 6, 6); additions to each node's own weights that make uniform fields exact, field
    # and moment
    corrections: np.ndarray
    theta: np.ndarray  # shape (n,); temperature about which the equation is linearised
    face_theta: float  # The same for the faces


def node_points(mesh: Mesh) -> np.ndarray:
    """Radius, height and √(1−η²) of the nodes, shape (n, 5); the rest is for walls."""
    zero = np.zeros_like(mesh.radius)
    return np.stack([mesh.radius, mesh.height, mesh.radial_scale, zero, zero], axis=1)


def face_points(mesh: Mesh) -> np.ndarray:
    """Radius, height, 1 (not used) and normal of the nodes on a face, shape (e, 5)."""
    zero = np.zeros_like(mesh.eta)
    return np.stack([mesh.face_radius, zero, zero + 1.0, zero, zero + 1.0], axis=1)


def assemble(
    mesh: Mesh, rarefaction: float, quadrature: Quadrature, base: BaseState | None = None
) -> Operators:
    """Assemble the linear operators by tracing all rays of a mesh."""
    setup, panels = kernel_arguments(mesh, rarefaction, quadrature)
    base = base or BaseState()
    state = base.of_kernel(mesh.size, rarefaction)
    corrections = np.zeros((mesh.size, linear_kernel.FIELDS, linear_kernel.FIELDS))
    arguments = setup, panels, panels
    gas = trace_rows(mesh, node_points(mesh), state, arguments, corrections)
    # rays from a face never come back to the disk
    face = trace_rows(mesh, face_points(mesh), state, arguments)
    return Operators(
        mesh=mesh,
        own=gas.own,
        other=gas.other,
        reflected=gas.reflected,
        sigma=gas.sigma,
        temperature=gas.temperature,
        velocity=gas.velocity,
        fluxes=face.own[..., : linear_kernel.FLUXES],
        corrections=corrections,
        theta=gas.theta,
        face_theta=base.face,
    )
