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

    excess: np.ndarray | None = None  # shape (n,); θ − 1 at the nodes of a half, the same in both
    face: float = 1.0  # θ of the faces
    frequency_exponent: float = 0.0  # Exponent of the collision frequency in θ at uniform pressure


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
    n, e = mesh.size, mesh.eta.size
    base = base or BaseState()
    linear = base.excess is None
    excess = np.zeros(n) if base.excess is None else np.ascontiguousarray(base.excess)
    column = excess[:, None]
    state = (rarefaction, base.frequency_exponent, column, column, base.face, linear)
    bare = np.zeros((3, n, 0, linear_kernel.FIELDS))
    own, other, reflected = (np.zeros((n, n, 36)) for _ in range(3))
    walls = np.zeros((n, 2 * e + 1, linear_kernel.FIELDS))
    corrections = np.zeros((n, linear_kernel.FIELDS, linear_kernel.FIELDS))
    linear_kernel.assemble(
        node_points(mesh),
        False,
        state,
        setup,
        panels,
        panels,
        own,
        other,
        reflected,
        walls,
        bare,
        corrections,
    )
    fluxes = np.zeros((e, n, linear_kernel.FIELDS * linear_kernel.WALL_FLUXES))
    nothing = np.zeros((e, 0, linear_kernel.FIELDS))
    linear_kernel.assemble(
        face_points(mesh),
        True,
        state,
        setup,
        panels,
        panels,
        fluxes,
        fluxes,
        fluxes,
        nothing,
        bare[:, :e],
        nothing,
    )
    return Operators(
        mesh=mesh,
        own=own.reshape(n, n, 6, 6),
        other=other.reshape(n, n, 6, 6),
        reflected=reflected.reshape(n, n, 6, 6),
        sigma=walls[:, :e],
        temperature=walls[:, e : 2 * e],
        velocity=walls[:, 2 * e],
        fluxes=fluxes.reshape(e, n, 6, linear_kernel.WALL_FLUXES)[..., : linear_kernel.FLUXES],
        corrections=corrections,
        theta=1.0 + excess,
        face_theta=base.face,
    )
