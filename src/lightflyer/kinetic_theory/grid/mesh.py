r"""Mesh around the disk in oblate spheroidal coordinates, and the nodes of the walls around it.

.. math:: r = \sqrt{(1+\xi^2)(1-\eta^2)}, \qquad z = \pm\xi\eta

Lengths are in disk radii. The disk is at ξ = 0, its edge at ξ = η = 0 and the axis at η = 1. Only
the upper half, z ≥ 0, is meshed; the lower half has the same nodes, mirrored. Panels in ξ and η
carry tensor products of nodes. Neighbouring panels share the nodes on their common edge, and both
halves have nodes in the plane of the disk outside it. Where panels are many mean free paths wide,
the equation at these nodes makes the fields smooth across the edge. No node lies at infinity or on
the face, where a field depends on the direction of approach.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.kinetic_theory.grid.kernels import kernel

LINEAR, INVERSE, DECAYING, CYLINDER = 0, 1, 2, 3
"""Variable of interpolation in a panel: ξ; 1/ξ; 1/ξ with fields that vanish at infinity; 1/ξ from
a spheroid to the cylinder r ≤ R, z ≤ H."""


BEYOND = 10.0
"""Offset that marks panel ends as shares of the way to a cylinder, in half-widths of it."""


_RESERVOIR_LAYER = 10.0  # optical depth of the last panel before a reservoir
_RESERVOIR_GROWTH = 3.0


def gauss(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss–Legendre nodes and weights on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    return 0.5 * (nodes + 1.0), 0.5 * weights


def panel_nodes(order: int, *, lower: bool, upper: bool) -> np.ndarray:
    """Nodes on [0, 1] of Gauss, Radau or Lobatto: without ends, with one or with both."""
    basis = np.polynomial.legendre.Legendre.basis
    if lower and upper:
        inner = np.real(basis(order - 1).deriv().roots())  # NumPy 2.5 gives complex numbers
        nodes = np.concatenate([[-1.0], inner, [1.0]])
    elif lower or upper:
        nodes = np.real((basis(order) + basis(order - 1)).roots())
        nodes[0] = -1.0
        nodes = nodes if lower else -nodes[::-1]
    else:
        return gauss(order)[0]
    return 0.5 * (nodes + 1.0)


@dataclass(frozen=True)
class Mesh:
    """Panels and their nodes."""

    # shape (panels in ξ + 1,); starts at 0; the last is infinite in open space. Panels next to a
    # cylinder divide the way to it: their ends are :data:`BEYOND` times D, which no ray reaches,
    # plus the share
    xi_edges: np.ndarray
    xi_kinds: np.ndarray  # shape (panels in ξ,)
    eta_edges: np.ndarray  # shape (panels in η + 1,); from 0 to 1
    order: int  # Nodes per panel and direction
    boundary: float  # Radius of the cylinder [disk radii], infinite in open space
    ceiling: float  # Its height above the disk's plane [disk radii]

    @cached_property
    def xi_nodes(self) -> np.ndarray:
        """Nodes of each panel in ξ on [0, 1], shape (panels in ξ, order); none at the two ends."""
        last = self.xi_kinds.size - 1
        return np.array(
            [panel_nodes(self.order, lower=i > 0, upper=i < last) for i in range(last + 1)]
        )

    @cached_property
    def eta_nodes(self) -> np.ndarray:
        """Nodes of each panel in η on [0, 1], shape (panels in η, order); one at η = 0."""
        last = self.eta_edges.size - 2
        return np.array(
            [panel_nodes(self.order, lower=True, upper=j < last) for j in range(last + 1)]
        )

    @cached_property
    def eta(self) -> np.ndarray:
        """Nodes in η, shape (e,)."""
        by_panel = self.eta_edges[:-1, None] + self._eta_widths * self.eta_nodes
        return np.concatenate([by_panel[0], by_panel[1:, 1:].ravel()])  # shared nodes once

    @property
    def _eta_widths(self) -> np.ndarray:
        return np.diff(self.eta_edges)[:, None]

    @cached_property
    def face_weights(self) -> np.ndarray:
        """Weights at :attr:`eta` of the mean over a face, shape (e,)."""
        weights = np.zeros(self.eta.size)
        constant = np.eye(self.order)[0]
        for panel, (nodes, width) in enumerate(zip(self.eta_nodes, self._eta_widths, strict=True)):
            # exact for polynomials through the nodes: of Legendre's only the constant contributes
            values = np.polynomial.legendre.legvander(2.0 * nodes - 1.0, self.order - 1)
            first = panel * (self.order - 1)
            weights[first : first + self.order] += width * np.linalg.solve(values.T, constant)
        return 2.0 * self.eta * weights

    @cached_property
    def face_radius(self) -> np.ndarray:
        """Radius of the nodes on a face [disk radii], shape (e,)."""
        return np.sqrt(1.0 - self.eta**2)

    @cached_property
    def xi(self) -> np.ndarray:
        """Nodes in ξ, shape (x, e); they depend on η next to a cylinder only."""
        rows = []
        for panel, kind in enumerate(self.xi_kinds):
            low, high = self.xi_edges[panel : panel + 2]
            for v in self.xi_nodes[panel, min(panel, 1) :]:
                if kind == LINEAR:
                    row = np.full(self.eta.size, low + (high - low) * v)
                elif kind == CYLINDER:
                    start = self.xi_edges[int(np.argmax(self.xi_kinds == CYLINDER))]
                    ends = [max(0.0, edge - BEYOND * self.boundary) for edge in (low, high)]
                    share = ends[0] + (ends[1] - ends[0]) * v
                    outer = cylinder_xi(self.eta, self.boundary, self.ceiling)
                    row = 1.0 / (1.0 / start + (1.0 / outer - 1.0 / start) * share)
                else:
                    row = np.full(self.eta.size, 1.0 / (1.0 / low + (1.0 / high - 1.0 / low) * v))
                rows.append(row)
        return np.array(rows)

    @cached_property
    def radius(self) -> np.ndarray:
        """Distance of the nodes from the axis [disk radii], shape (x·e,)."""
        return np.sqrt((1.0 + self.xi**2) * (1.0 - self.eta**2)).ravel()

    @cached_property
    def height(self) -> np.ndarray:
        """Height of the nodes above the disk's plane [disk radii], shape (x·e,)."""
        return (self.xi * self.eta).ravel()

    @cached_property
    def radial_scale(self) -> np.ndarray:
        """√(1−η²) at the nodes; radial components divided by it are smooth, and kept so."""
        return np.broadcast_to(self.face_radius, self.xi.shape).ravel()

    @property
    def size(self) -> int:
        """Number of nodes of one half."""
        return self.xi.size


@kernel
def cylinder_xi(eta: Any, boundary: float, ceiling: float) -> Any:  # a number or an array of them
    """ξ where the hyperbola of constant η leaves the cylinder r ≤ R, |z| ≤ H."""
    side = np.sqrt(np.maximum(boundary**2 / np.maximum(1.0 - eta**2, 1e-300) - 1.0, 1e-300))
    return np.minimum(side, ceiling / np.maximum(eta, 1e-300))


def cylinder_corner(boundary: float, ceiling: float) -> float:
    """η of the cylinder's corner r = R, z = H."""
    excess = boundary**2 + ceiling**2 - 1.0
    return float(ceiling / np.sqrt(0.5 * (excess + np.sqrt(excess**2 + 4.0 * ceiling**2))))


def _geometric(first: float, growth: float, end: float) -> list[float]:
    """Edges from 0 with widths that grow by a factor, the last scaled to end exactly at ``end``."""
    edges, width = [0.0], first
    while edges[-1] < end * (1.0 - 1e-9):
        edges.append(edges[-1] + width)
        width *= growth
    return list(np.array(edges) * end / edges[-1])


def _outwards(inner: float, far: float, refinement: float) -> list[float]:
    """Edges of panels beyond ``inner`` up to ``far``, in geometric progression."""
    steps = max(1, int(np.ceil(refinement * np.log(far / inner) / np.log(1.9))))
    return list(inner * (far / inner) ** (np.arange(1, steps + 1) / steps))


def build_mesh(
    rarefaction: float, *, boundary: float = np.inf, order: int = 4, refinement: float = 1.0
) -> Mesh:
    """Mesh for a rarefaction, with panels as thin as the Knudsen layer needs."""
    layer = min(1.0, 1.5 / rarefaction)
    growth = 1.0 + 1.4 / refinement
    far = 0.6 * boundary if np.isfinite(boundary) else max(3.0, 3.0 / rarefaction)
    inner = min(1.0, 0.5 * boundary)
    near = _geometric(0.3 * layer / refinement, growth, inner)
    outer = _outwards(inner, far, refinement)
    kinds = [LINEAR] * (len(near) - 1)
    if far > inner * 1.01:
        kinds += [INVERSE] * len(outer)
        near += outer
    if np.isfinite(boundary):
        # ends of the panels next to the cylinder, as shares of the way to it: they get thinner
        # towards the reservoir, so that the last panel sees it
        depth, left = rarefaction * (boundary - far), [0.0]
        width = min(1.0, _RESERVOIR_LAYER / (depth * refinement))
        while left[-1] + width < 0.6:
            left.append(left[-1] + width)
            width *= _RESERVOIR_GROWTH
        shares = 1.0 - np.array(left[::-1])
        xi_edges = [*near, *(BEYOND * boundary + shares)]
        kinds += [CYLINDER] * len(shares)
    else:
        xi_edges, kinds = [*near, np.inf], [*kinds, DECAYING]
    edge = min(0.45, 0.7 * np.sqrt(2.0 / rarefaction))
    eta_edges = _geometric(edge / refinement, 1.0 + 0.5 / refinement, 1.0)
    if np.isfinite(boundary):
        corner = cylinder_corner(boundary, boundary)
        nearest = int(np.argmin(np.abs(np.array(eta_edges[1:-1]) - corner))) + 1
        eta_edges[nearest] = corner
    return Mesh(np.array(xi_edges), np.array(kinds), np.array(eta_edges), order, boundary, boundary)


_GAP_GROWTH = 1.6  # Ratio of the ends of panels on the longest way to a chamber's walls

_WALL_LAYER = 3.0  # largest optical depth of the panels next to a chamber's walls
_CLOSEST_EDGES = 0.3  # of the smaller neighbour: nearer edges of panels in η are moved together


def build_chamber_meshes(
    rarefaction: float,
    radius: float,
    ceilings: tuple[float, float],
    *,
    order: int = 5,
    refinement: float = 1.0,
) -> tuple[Mesh, Mesh]:
    """Meshes of the two halves of a cylinder around the disk; ``radius`` [disk radii]."""
    # They have the same panels, which end at different heights, so that their nodes in the plane of
    # the disk coincide.
    nearest = min(*ceilings, float(np.sqrt(radius**2 - 1.0)))
    furthest = max(*ceilings, radius)
    inner, far = min(1.0, 0.5 * nearest), 0.6 * nearest
    layer = min(1.0, 1.5 / rarefaction)
    near = _geometric(0.3 * layer / refinement, 1.0 + 1.4 / refinement, inner)
    kinds = [LINEAR] * (len(near) - 1)
    if far > inner * 1.3:
        outer = _outwards(inner, far, refinement)
        near += outer
        kinds += [INVERSE] * len(outer)
    far = near[-1]
    ratio, depth = furthest / far, rarefaction * far  # of the longest way's ends; of its start
    # ``ratio`` is that of the longest way's ends and ``depth`` the optical depth of its start.
    count = max(1, int(np.ceil(refinement * np.log(ratio) / np.log(_GAP_GROWTH))))
    ends = ratio ** (np.arange(1, count + 1) / count)
    # the last panel is thin enough to see the wall
    while ratio > 1.5 and depth * (ratio - ([1.0, *ends])[-2]) > _WALL_LAYER / refinement:
        before = ([1.0, *ends])[-2]
        ends = np.append(ends[:-1], [ratio - (ratio - before) / 3.0, ratio])
    shares = (1.0 - 1.0 / ends) / (1.0 - 1.0 / ratio)
    edge = min(0.45, 0.7 * np.sqrt(2.0 / rarefaction), 1.2 * nearest)
    eta_edges = _geometric(edge / refinement, 1.0 + 0.5 / refinement, 1.0)
    corners = sorted({cylinder_corner(radius, height) for height in ceilings})
    for corner in corners:
        eta_edges = _with_edge(eta_edges, corner, corners)
    upper, lower = (
        Mesh(
            np.array([*near, *(BEYOND * radius + shares)]),
            np.array(kinds + [CYLINDER] * shares.size),
            np.array(eta_edges),
            order,
            radius,
            height,
        )
        for height in ceilings
    )
    return upper, lower


def _with_edge(edges: list[float], value: float, fixed: list[float]) -> list[float]:
    """Edges with one at a value: the nearest one is moved unless fixed, or one is added."""
    nearest = int(np.argmin(np.abs(np.array(edges[1:-1]) - value))) + 1 if len(edges) > 2 else 0
    if nearest and edges[nearest] not in fixed:
        gap = min(edges[nearest] - edges[nearest - 1], edges[nearest + 1] - edges[nearest])
        if abs(edges[nearest] - value) < _CLOSEST_EDGES * gap:
            return sorted([*edges[:nearest], value, *edges[nearest + 1 :]])
    return sorted([*edges, value])


@dataclass(frozen=True)
class Rim:
    """Side wall and lid (or floor) of one half, seen as an upper half."""

    # Each panel in η has Gauss nodes of its own: nothing is shared at the edge between two walls.

    mesh: Mesh

    @cached_property
    def eta(self) -> np.ndarray:
        """Nodes in η, shape (w,)."""
        return self._by_panel(gauss(self.mesh.order)[0], offset=True)

    def _by_panel(self, values: np.ndarray, *, offset: bool) -> np.ndarray:
        edges = self.mesh.eta_edges
        scaled = np.diff(edges)[:, None] * values
        return np.ravel(scaled + edges[:-1, None] if offset else scaled)

    @cached_property
    def is_flat(self) -> np.ndarray:
        """Whether a node lies on the lid, not on the side wall, shape (w,)."""
        return self.eta > cylinder_corner(self.mesh.boundary, self.mesh.ceiling)

    @cached_property
    def xi(self) -> np.ndarray:
        """ξ of the nodes, shape (w,)."""
        return cylinder_xi(self.eta, self.mesh.boundary, self.mesh.ceiling)

    @cached_property
    def radius(self) -> np.ndarray:
        """Distance of the nodes from the axis [disk radii], shape (w,)."""
        inside = np.sqrt((1.0 + self.xi**2) * (1.0 - self.eta**2))
        return np.where(self.is_flat, inside, self.mesh.boundary)

    @cached_property
    def height(self) -> np.ndarray:
        """Height of the nodes above the disk's plane [disk radii], shape (w,)."""
        return np.where(self.is_flat, self.mesh.ceiling, self.xi * self.eta)

    @cached_property
    def points(self) -> np.ndarray:
        """Radius, height, 1 (not used) and normal into the gas, shape (w, 5)."""
        one = np.ones_like(self.eta)
        side = np.where(self.is_flat, 0.0, -1.0)
        return np.stack([self.radius, self.height, one, side, -one - side], axis=1)

    @cached_property
    def weights(self) -> np.ndarray:
        """Area of each node over that of the disk, shape (w,)."""
        eta, xi = self.eta, self.xi
        radius, ceiling = self.mesh.boundary, self.mesh.ceiling
        flat = 2.0 * eta * (1.0 + ceiling**2 / eta**4)  # −d(r²)/dη on the lid
        side = 2.0 * radius * (xi + (radius * eta) ** 2 / (xi * (1.0 - eta**2) ** 2))  # 2R dz/dη
        share = self._by_panel(gauss(self.mesh.order)[1], offset=False)
        return share * np.where(self.is_flat, flat, side)
