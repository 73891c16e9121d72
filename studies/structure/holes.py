"""Stress at the edge of round holes in a triangular pattern, by finite elements in plane stress.

``study.py`` calls it. Uses nothing of lightflyer; needs scikit-fem 12.
"""

import numpy as np
from skfem import (
    Basis,
    BilinearForm,
    ElementTriP2,
    ElementVector,
    FacetBasis,
    MeshTri,
    condense,
    solve,
)
from skfem.helpers import ddot, eye, sym_grad, trace

SECTORS, RINGS = 90, 60


def cell(open_fraction):
    """Quarter of a rectangle of two holes, 1 apart: a quarter of a hexagon, and its reflection."""
    radius = np.sqrt(open_fraction * np.sqrt(0.75) / np.pi)
    angles = np.linspace(0.0, 0.5 * np.pi, SECTORS + 1)
    outline = 0.5 / np.maximum(np.cos(angles), np.cos(angles - np.pi / 3.0))
    ways = np.linspace(0.0, 1.0, RINGS + 1)[:, None] ** 1.3
    distance = radius + ways * (outline - radius)
    points = np.array([distance * np.cos(angles), distance * np.sin(angles)]).reshape(2, -1)
    first = (np.arange(RINGS)[:, None] * (SECTORS + 1) + np.arange(SECTORS)).ravel()
    a, b, c, d = first, first + 1, first + SECTORS + 1, first + SECTORS + 2
    cells = np.array([np.r_[a, b], np.r_[b, d], np.r_[c, c]])
    size = np.array([[0.5], [np.sqrt(0.75)]])
    both = np.concatenate([points, size - points], axis=1)
    _, kept, place = np.unique(np.round(both, 9), axis=1, return_index=True, return_inverse=True)
    cells = np.ravel(place)[np.concatenate([cells, cells + points.shape[1]], axis=1)]
    return MeshTri(both[:, kept], cells), radius, size.ravel()


def stress(strain, poisson):
    """Of plane stress, E = 1."""
    return (strain * (1.0 - poisson) + poisson * eye(trace(strain), 2)) / (1.0 - poisson**2)


def peaks(open_fraction, poisson=0.24):
    """Largest tension over the mean stress, pulled alike in two directions and in one."""
    mesh, radius, size = cell(open_fraction)
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)

    @BilinearForm
    def stiffness(u, v, _):
        return ddot(stress(sym_grad(u), poisson), sym_grad(v))

    matrix = stiffness.assemble(basis)
    middle = mesh.p[:, mesh.facets].mean(axis=1)
    near = [np.hypot(*(middle - corner[:, None])) < 1.02 * radius
            for corner in (np.zeros(2), size)]  # fmt: skip
    rim = FacetBasis(mesh, basis.elem, facets=np.flatnonzero(near[0] | near[1]), intorder=4)
    moved = []
    for axis in (0, 1):
        x, fixed = np.zeros(basis.N), []
        for along in (0, 1):
            for end in (0.0, size[along]):
                there = basis.get_dofs(lambda p, a=along, e=end: np.abs(p[a] - e) < 1e-8)
                there = there.all(f"u^{along + 1}")
                fixed.append(there)
                x[there] = end if along == axis else 0.0
        moved.append(
            solve(*condense(matrix, np.zeros(basis.N), x=x, D=np.unique(np.concatenate(fixed))))
        )
    mean = np.array([[one @ (matrix @ other) for one in moved] for other in moved]) / size.prod()
    found = []
    for wanted in ([1.0, 1.0], [1.0, 0.0], [0.0, 1.0]):
        shares = np.linalg.solve(mean, wanted)
        field = rim.interpolate(shares[0] * moved[0] + shares[1] * moved[1])
        tensor = stress(sym_grad(field), poisson)
        principal = np.linalg.eigvalsh(np.moveaxis(np.asarray(tensor), (0, 1), (-2, -1)))
        found.append(float(principal.max()))
    return found[0], max(found[1:]), (mean[0, 0] ** 2 - mean[0, 1] ** 2) / mean[0, 0]


if __name__ == "__main__":
    for share in (0.01, 0.1, 0.3, 0.5, 0.6):
        print(share, peaks(share), 2 / (1 - share), 3 / (1 - share), (1 - share) / (1 + 2 * share))
