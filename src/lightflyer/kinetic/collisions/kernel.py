"""Rows of the linear problem with the collision operator of real molecules, in integral form.

As in :mod:`lightflyer.kinetic.linear_kernel`, but the gain of collisions has many moments and the
frequency depends on speed. A component is a spherical harmonic (l, m) times a speed to the power
l + 2a. Components with odd m are divided by √(1−η²), which makes them smooth.
"""

import numpy as np
from numba import prange

from lightflyer.kinetic._kernels import kernel, parallel_kernel
from lightflyer.kinetic.directions import node_directions
from lightflyer.kinetic.interpolation import bases_at, eta_basis_at, nodes_in_eta, scatter
from lightflyer.kinetic.linear_kernel import EMISSIONS, FLUXES, MOST_DIRECTIONS, NORMALISATION
from lightflyer.kinetic.rays import MOST_CUTS, REACH, SHORTEST, spheroidal, trace_ray
from lightflyer.kinetic.speed_integrals import LARGEST_DEPTH

_SHORTENED = 0.999999  # keeps the largest depth inside the table
_TINY = 1e-30


@kernel
def integrals(depth, table, scale, first, values):
    """Fill J_p, then I_p, from one of these on."""
    if depth >= _SHORTENED * LARGEST_DEPTH:
        values[:] = 0.0
        return
    position = np.sqrt(depth) * scale
    cell = int(position)
    t = (position - cell) / scale
    row = table[cell]
    for p in range(values.size):
        k = first + p
        values[p] = ((row[0, k] * t + row[1, k]) * t + row[2, k]) * t + row[3, k]


@kernel
def harmonics(x, y, z, norms, out):
    """Fill the real spherical harmonics of a direction that are even in y.

    Parameters
    ----------
    x, y, z : float
        Unit vector; z is the axis.
    norms : array, shape (degrees, degrees)
        Factors by which the mean of each square over the sphere is one.
    out : array, shape (degrees (degrees + 1)/2,)
        Filled, m from 0 to l within l from 0 up.
    """
    degrees = norms.shape[0]
    real, imaginary, leading = 1.0, 0.0, 1.0
    for m in range(degrees):
        before, value = 0.0, leading
        for degree in range(m, degrees):
            out[degree * (degree + 1) // 2 + m] = norms[degree, m] * value * real
            after = ((2 * degree + 1) * z * value - (degree + m) * before) / (degree + 1 - m)
            before, value = value, after
        real, imaginary = real * x - imaginary * y, real * y + imaginary * x
        leading *= 2 * m + 1


@kernel
def _outer(j, source, row, components, weight, out):
    """Fill the weights of all sources at one point in all moments of a row."""
    angular, power = components[0], components[1]
    for i in range(angular.size):
        at_source = weight * source[angular[i]]
        for k in range(angular.size):
            out[i, k] = at_source * row[angular[k]] * j[1 + power[i] + power[k]]


@kernel
def _arriving(j, source, normal, components, weight, out):
    """Fill the weights of all sources in the number, momentum and energy that arrive."""
    angular, power = components[0], components[1]
    simple = j[j.size // 2 :]
    for i in range(angular.size):
        w, first = weight * source[angular[i]] * normal, 1 + power[i]
        out[i, 0] = w * simple[first + 1]
        out[i, 1] = w * normal * simple[first + 2]
        out[i, 2] = w * simple[first + 3]


@kernel
def _emit(j, row, components, weight, straight_z, kind, out):
    """Fill the moments of what a wall emits: 1, c² − 2 or c_z."""
    angular, power = components[0], components[1]
    simple = j[j.size // 2 :]
    for k in range(angular.size):
        first = 2 + power[k]
        value = simple[first]
        if kind == 1:
            value = simple[first + 2] - 2.0 * simple[first]
        elif kind == 2:
            value = straight_z * simple[first + 1]
        out[k] = weight * row[angular[k]] * value


@kernel
def _piece(depth, end, start, width, point, direction, below, setup, mesh, scratch):
    """Fill bases, harmonics and corrected integrals at the points of one piece of a ray."""
    rule, table, scale, norms, odd = setup[3], setup[4], setup[5], setup[6], setup[7]
    xi_basis, eta_basis, panels, sources, values, at_ends = scratch
    points, number = rule.shape[1], values.shape[1] // 2
    integrals(depth, table, scale, 0, at_ends[0])
    integrals(end, table, scale, 0, at_ends[1])
    for k in range(points):
        integrals(depth + (end - depth) * rule[0, k], table, scale, 0, values[k])
        s = start + width * rule[0, k]
        x, y = point[0] + s * direction[0], s * direction[1]
        xi, eta = spheroidal(x * x + y * y, point[1] + s * direction[2])
        panels[k, 0], panels[k, 1] = bases_at(xi, eta, mesh, xi_basis[k], eta_basis[k])
        inverse = 1.0 / np.sqrt(max(x * x + y * y, _TINY))
        radial = -(direction[0] * x + direction[1] * y) * inverse
        turning = -(direction[1] * x - direction[0] * y) * inverse
        vertical = direction[2] if below else -direction[2]
        harmonics(radial, turning, vertical, norms, sources[k])
        shrink = np.sqrt(max(0.0, (1.0 - eta) * (1.0 + eta)))
        for c in range(sources.shape[1]):
            if odd[c]:
                sources[k, c] *= shrink
    for p in range(number - 1):
        # a piece of uniform gas emits exactly what follows from the depths of its ends
        missing = (at_ends[0, number + p + 1] - at_ends[1, number + p + 1]) / (end - depth)
        for k in range(points):
            missing -= rule[1, k] * values[k, p]
        for k in range(points):
            values[k, p] += missing


@kernel
def _ray(point, direction, seen, rarefaction, setup, mesh, scratch, weights, cuts, rows, walls):
    """Add one ray to a row; returns the optical depth at its end."""
    on_face, row, weight = seen
    rule, table, scale, components = setup[3], setup[4], setup[5], setup[8]
    values, eta_size = scratch[4], nodes_in_eta(mesh)
    xi_basis, eta_basis, panels, sources = scratch[0], scratch[1], scratch[2], scratch[3]
    flat = weights.ravel()
    number, hit, crossing = trace_ray(
        point[0],
        point[1],
        direction,
        REACH * LARGEST_DEPTH / rarefaction,
        1.0 / rarefaction,
        mesh,
        cuts,
    )
    disk = crossing < 1.0
    depth, emitted = 0.0, False
    for piece in range(number - 1):
        start, width = cuts[piece], cuts[piece + 1] - cuts[piece]
        if width < SHORTEST:
            continue
        if depth >= LARGEST_DEPTH:
            break
        below = start >= hit
        if below and disk and not emitted:
            emitted = True
            integrals(depth, table, scale, 0, values[0])
            _wall(values[0], seen, -direction[2], crossing, mesh, eta_basis[0], components, walls)
        end = depth + rarefaction * width
        _piece(depth, end, start, width, point, direction, below, setup, mesh, scratch)
        target = rows[0]
        if below:
            target = rows[2] if disk else rows[1]
        for k in range(rule.shape[1]):
            w = weight * (end - depth) * rule[1, k]
            if on_face:
                _arriving(values[k], sources[k], direction[2], components, w, weights)
            else:
                _outer(values[k], sources[k], row, components, w, weights)
            scatter(target, flat, panels[k, 0], panels[k, 1], eta_size, xi_basis[k], eta_basis[k])
        depth = end
    return depth


@kernel
def _wall(j, seen, straight_z, crossing, mesh, eta_basis, components, walls):
    """Add the emission of a face towards a node: σ and temperature by its nodes, velocity."""
    _, row, weight = seen
    eta = np.sqrt(1.0 - crossing)
    first = eta_basis_at(eta, mesh, eta_basis)
    nodes = (walls.shape[0] - 1) // 2
    out = np.empty(components.shape[1])
    for kind in range(EMISSIONS):
        _emit(j, row, components, weight, straight_z, kind, out)
        for k in range(out.size):
            if kind == 2:
                walls[2 * nodes, k] += out[k]
                continue
            for a in range(eta_basis.size):
                walls[kind * nodes + first + a, k] += eta_basis[a] * out[k]


@kernel
def _row(i, point, on_face, rarefaction, setup, mesh, rows, walls):
    """Fill one row: weights of the own half's fields, the other half's and after reflection."""
    layer, gauss_height, gauss_azimuth, rule, table, scale, norms, odd, components, exact = setup
    order, points, size = mesh[3].shape[2], rule.shape[1], components.shape[1]
    directions = np.empty((MOST_DIRECTIONS, 4))
    count = node_directions(point[0], point[1], layer, gauss_height, gauss_azimuth, directions)
    number = table.shape[2]
    scratch = (
        np.empty((points, order)),
        np.empty((points, order)),
        np.empty((points, 2), np.int64),
        np.empty((points, odd.size)),
        np.empty((points, number)),
        np.empty((2, number)),
    )
    weights = np.empty((size, FLUXES if on_face else size))
    uniform = np.zeros((size, size))
    row, straight, cuts = np.empty(odd.size), np.empty(odd.size), np.empty(MOST_CUTS)
    j = np.empty(number)
    for d in range(count):
        direction = directions[d]
        harmonics(-direction[0], -direction[1], -direction[2], norms, straight)
        for c in range(odd.size):
            row[c] = straight[c] / point[2] if odd[c] else straight[c]
        weight = NORMALISATION * direction[3]
        seen = (on_face, row, weight)
        _ray(point, direction, seen, rarefaction, setup, mesh, scratch, weights, cuts, rows, walls)
        if not on_face:
            # uniform fields along the whole ray: the integrals of the corrected pieces and beyond
            integrals(0.0, table, scale, 0, j)
            for p in range(number // 2 - 1):
                j[p] = j[number // 2 + p + 1]
            _outer(j, straight, row, components, weight, weights)
            uniform += weights
    if not on_face:
        _conserve(uniform, point[2], odd, components, exact, rows[0][i])


@kernel
def _conserve(uniform, radial_scale, odd, components, exact, cell):
    """Correct the node's own weights so that uniform fields are reproduced exactly."""
    size = components.shape[1]
    for i in range(size):
        factor = radial_scale if odd[components[0, i]] else 1.0
        for k in range(size):
            cell[i * size + k] += exact[i, k] - factor * uniform[i, k]


@parallel_kernel
def assemble(points, on_face, rarefaction, setup, mesh, own, other, reflected, walls):
    """Fill the rows of all nodes of a half, or of all nodes on a face.

    Parameters
    ----------
    points : array, shape (m, 3)
        Radius, height and √(1−η²) of the nodes.
    on_face : bool
        Whether the rows are fluxes that arrive at a face, not moments.
    rarefaction : float
        δ [1].
    setup, mesh : tuple
        Of :func:`lightflyer.kinetic.collisions.rows.assemble`; panels.
    own, other, reflected : array, shape (m, n, k²) or, on a face, (m, n, 3 k)
        Zeros, filled: node of the row, node of the column, source and moment or flux. On a face
        all three are the same array.
    walls : array, shape (m, 2 e + 1, k)
        Zeros, filled: σ at the nodes of the face, its temperature there, its velocity. Not used on
        a face.
    """
    for i in prange(points.shape[0]):
        rows = (own[i], other[i], reflected[i])
        # numba counts in unsigned integers here, for which it would compile everything once more
        _row(
            np.int64(i),
            points[i],
            on_face,
            rarefaction,
            setup,
            mesh,
            rows,
            walls[i],
        )
