"""Nodes on the walls around the gas, in one half of the mesh of a chamber."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lightflyer.kinetic_theory.grid.mesh import Mesh, cylinder_corner, cylinder_xi, gauss


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
