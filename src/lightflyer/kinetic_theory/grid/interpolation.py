"""Interpolation of fields between the nodes of a mesh, for compiled kernels.

``mesh`` is the tuple of panels from
:func:`lightflyer.kinetic_theory.disk.operators.kernel_arguments`.
"""

from lightflyer.kinetic_theory.grid.kernels import inner_kernel, kernel
from lightflyer.kinetic_theory.grid.mesh import (
    BEYOND,
    CYLINDER,
    DECAYING,
    INVERSE,
    LINEAR,
    cylinder_xi,
)


@kernel
def panel_of(edges, value):
    """Panel in which a value lies."""
    panel = 0
    while panel < edges.size - 2 and value >= edges[panel + 1]:
        panel += 1
    return panel


@inner_kernel
def _lagrange(nodes, v, basis):
    """Fill the Lagrange polynomials of nodes, nodes[0], on [0, 1]; nodes[1] scales them."""
    for i in range(basis.size):
        product = nodes[1, i]
        for j in range(basis.size):
            if j != i:
                product *= v - nodes[0, j]
        basis[i] = product


@kernel
def nodes_in_eta(mesh):
    """Number of nodes at one ξ; neighbouring panels share one."""
    return mesh[4].shape[0] * (mesh[4].shape[2] - 1) + 1


@kernel
def eta_basis_at(eta, mesh, basis):
    """Fill the Lagrange basis in η at a point; returns the number of its first node."""
    edges = mesh[2]
    panel = panel_of(edges, eta)
    v = (eta - edges[panel]) / (edges[panel + 1] - edges[panel])
    _lagrange(mesh[4][panel], v, basis)
    return panel * (basis.size - 1)


@kernel
def rim_basis_at(eta, mesh, basis):
    """Fill the Lagrange basis in η on the walls around the gas; returns the first node's number."""
    # Panels share no nodes there, since emission jumps at the edge between two walls.
    edges = mesh[2]
    panel = panel_of(edges, eta)
    v = (eta - edges[panel]) / (edges[panel + 1] - edges[panel])
    _lagrange(mesh[7][panel], v, basis)
    return panel * basis.size


@kernel
def bases_at(xi, eta, mesh, xi_basis, eta_basis):
    """Fill the Lagrange bases in ξ and η at a point; ``xi_basis``, ``eta_basis`` (order,)."""
    xi_edges, xi_kinds, _, xi_nodes, _, boundary, ceiling, _ = mesh
    i = panel_of(xi_edges, xi)
    kind = xi_kinds[i]
    if kind == LINEAR:
        v = (xi - xi_edges[i]) / (xi_edges[i + 1] - xi_edges[i])
    elif kind == CYLINDER:
        outer = cylinder_xi(eta, boundary, ceiling)
        v = (1.0 / xi_edges[i] - 1.0 / xi) / (1.0 / xi_edges[i] - 1.0 / outer)
        low, offset = 0.0, BEYOND * boundary
        while i < xi_kinds.size - 1 and v >= xi_edges[i + 1] - offset:
            low = xi_edges[i + 1] - offset
            i += 1
        v = (v - low) / (xi_edges[i + 1] - offset - low)
    elif kind == INVERSE:
        low = 1.0 / xi_edges[i]
        v = (low - 1.0 / xi) / (low - 1.0 / xi_edges[i + 1])
    else:
        v = 1.0 - xi_edges[i] / xi
    _lagrange(xi_nodes[i], v, xi_basis)
    if kind == DECAYING:
        for k in range(xi_basis.size):
            xi_basis[k] *= (1.0 - v) / (1.0 - xi_nodes[i, 0, k])
    return i * (xi_basis.size - 1), eta_basis_at(eta, mesh, eta_basis)


@kernel
def interpolate(fields, i, j, eta_size, xi_basis, eta_basis, values):
    """Fill the values of fields at a point; ``fields`` (n, m); ``values`` (m or more,)."""
    for f in range(fields.shape[1]):
        values[f] = 0.0
    for a in range(xi_basis.size):
        first = (i + a) * eta_size + j
        for b in range(eta_basis.size):
            weight = xi_basis[a] * eta_basis[b]
            for f in range(fields.shape[1]):
                values[f] += weight * fields[first + b, f]


@kernel
def interpolate_on_face(values, eta, mesh, eta_basis):
    """Value at a point of a face from those at the face's nodes, shape (e,)."""
    first = eta_basis_at(eta, mesh, eta_basis)
    value = 0.0
    for a in range(eta_basis.size):
        value += eta_basis[a] * values[first + a]
    return value


@kernel
def scatter(target, weights, i, j, eta_size, xi_basis, eta_basis):
    """Add the weights of fields at a point to those of the nodes around it; ``target`` (n, m)."""
    for a in range(xi_basis.size):
        for b in range(eta_basis.size):
            w = xi_basis[a] * eta_basis[b]
            cell = target[(i + a) * eta_size + j + b]
            for k in range(weights.size):
                cell[k] += w * weights[k]
