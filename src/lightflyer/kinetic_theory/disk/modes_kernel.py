"""Modes that a face emits, at the nodes of the gas, and that arrive at it from these nodes.

The gas rests far away at uniform pressure and temperature, so that an optical depth is a length.
"""

import numpy as np

from lightflyer.kinetic_theory.disk.linear_kernel import FIELDS, MOST_DIRECTIONS, NORMALISATION
from lightflyer.kinetic_theory.grid.directions import node_directions
from lightflyer.kinetic_theory.grid.interpolation import (
    bases_at,
    eta_basis_at,
    nodes_in_eta,
    scatter,
)
from lightflyer.kinetic_theory.grid.kernels import inner_kernel, shared_kernel
from lightflyer.kinetic_theory.grid.rays import (
    LARGEST_DEPTH,
    MOST_CUTS,
    SHORTEST,
    integrals,
    spheroidal,
    trace_ray,
)


@inner_kernel
def _polynomials(normal, radial, coefficients, harmonics, powers):
    """Fill the modes along a direction by powers of c² times c^j; ``powers`` (k, size)."""
    # ``normal`` and ``radial`` are the direction's parts along the normal and away from the axis
    c_n, c_t = normal * normal, 1.0 - normal * normal
    powers[:] = 0.0
    for k in range(powers.shape[0]):
        # c_t^j cos(jφ) by Chebyshev's recurrence
        last, factor = 0.0, 1.0
        for j in range(harmonics[k]):
            last, factor = factor, (radial if j == 0 else 2.0 * radial * factor - c_t * last)
        from_normal = factor
        for s in range(powers.shape[1]):
            from_tangential = from_normal
            for t in range(powers.shape[1] - s):
                powers[k, s + t] += from_tangential * coefficients[k, s, t]
                from_tangential *= c_t
            from_normal *= c_n


@inner_kernel
def _integral(values, first, powers, harmonic):
    """Speed integral of a mode times the powers from ``first`` on."""
    total = 0.0
    for q in range(powers.size):
        if powers[q] != 0.0:
            total += powers[q] * values[first + harmonic + 2 * q]
    return total


@inner_kernel
def _shape(values, first, kind, powers, harmonic):
    """Speed integral of the source of one unit field times a mode."""
    if kind == 0:
        return _integral(values, first, powers, harmonic)
    if kind == 1:
        return _integral(values, first + 1, powers, harmonic)
    low = 2.5 * _integral(values, first + kind - 2, powers, harmonic)
    return _integral(values, first + kind, powers, harmonic) - low


@inner_kernel
def _piece(rarefaction, start, width, rule, table, scale, ends, values):
    """Fill the speed integrals at the points of a piece of a ray; ``values`` (points, powers)."""
    # corrected, so that a piece of uniform gas emits exactly what follows from its optical depth
    depth = rarefaction * width
    integrals(rarefaction * start, table, scale, 0, ends[0])
    integrals(rarefaction * (start + width), table, scale, 0, ends[1])
    for g in range(rule.shape[1]):
        integrals(rarefaction * (start + width * rule[0, g]), table, scale, 0, values[g])
    for p in range(values.shape[1] - 1):
        missing = (ends[0, p + 1] - ends[1, p + 1]) / depth
        for g in range(rule.shape[1]):
            missing -= rule[1, g] * values[g, p]
        for g in range(rule.shape[1]):
            values[g, p] += missing


@inner_kernel
def _add_source(values, weight, along, powers, harmonics, cells):
    """Add what unit fields at a point of a ray bring in each mode; ``cells`` (fields, k)."""
    for k in range(harmonics.size):
        for kind in range(4):
            found = weight * _shape(values, 1, kind, powers[k], harmonics[k])
            field = kind if kind < 2 else kind + 1
            if kind % 2:
                cells[field, k] = found * along[0]
                cells[field + 1, k] = found * along[1]
            else:
                cells[field, k] = found


@shared_kernel
def arriving(start, stop, points, rarefaction, setup, mesh, coefficients, harmonics, rows):
    """Add what arrives at a face's nodes in each mode; ``rows`` (e, n, fields · k)."""
    # A ray from a face never comes back to it.
    layer, gauss_height, gauss_azimuth, rule, table, scale = setup
    for i in range(start, stop):
        directions, cuts = np.empty((MOST_DIRECTIONS, 4)), np.empty(MOST_CUTS)
        radius = points[i, 0]
        count = node_directions(radius, 0.0, layer, gauss_height, gauss_azimuth, directions)
        order, eta_size, number = mesh[3].shape[2], nodes_in_eta(mesh), table.shape[2]
        xi_basis, eta_basis, along = np.empty(order), np.empty(order), np.empty(2)
        values, ends = np.empty((rule.shape[1], number)), np.empty((2, number))
        powers = np.empty((coefficients.shape[0], coefficients.shape[1]))
        cells = np.empty((FIELDS, harmonics.size))
        for d in range(count):
            direction = directions[d]
            if direction[2] <= 0.0:
                continue
            _polynomials(direction[2], -direction[0], coefficients, harmonics, powers)
            longest, scale_length = LARGEST_DEPTH / rarefaction, 1.0 / rarefaction
            pieces, _, _ = trace_ray(radius, 0.0, direction, longest, scale_length, mesh, cuts)
            for piece in range(pieces - 1):
                start, width = cuts[piece], cuts[piece + 1] - cuts[piece]
                if width < SHORTEST:
                    continue
                _piece(rarefaction, start, width, rule, table, scale, ends, values)
                weight = NORMALISATION * direction[3] * direction[2] * rarefaction * width
                for g in range(rule.shape[1]):
                    s = start + width * rule[0, g]
                    x, y = radius + s * direction[0], s * direction[1]
                    xi, eta = spheroidal(x * x + y * y, s * direction[2])
                    a, b = bases_at(xi, eta, mesh, xi_basis, eta_basis)
                    along[0] = -(direction[0] * x + direction[1] * y) / np.sqrt(1.0 + xi * xi)
                    along[1] = -direction[2]
                    _add_source(values[g], weight * rule[1, g], along, powers, harmonics, cells)
                    scatter(rows[i], cells.ravel(), a, b, eta_size, xi_basis, eta_basis)


@shared_kernel
def emitted(start, stop, points, rarefaction, setup, mesh, coefficients, harmonics, rows):
    """Add the moments at all nodes of what a face emits; ``rows`` (n, e, fields, k)."""
    layer, gauss_height, gauss_azimuth, _, table, scale = setup
    for i in range(start, stop):
        directions = np.empty((MOST_DIRECTIONS, 4))
        radius, height, radial_scale = points[i, 0], points[i, 1], points[i, 2]
        count = node_directions(radius, height, layer, gauss_height, gauss_azimuth, directions)
        eta_basis, values = np.empty(mesh[3].shape[2]), np.empty(table.shape[2])
        powers = np.empty((coefficients.shape[0], coefficients.shape[1]))
        moments = np.empty(FIELDS)
        for d in range(count):
            direction = directions[d]
            if direction[2] >= 0.0:
                continue
            hit = -height / direction[2]
            x, y = radius + hit * direction[0], hit * direction[1]
            squared = x * x + y * y
            if squared >= 1.0 or rarefaction * hit >= LARGEST_DEPTH:
                continue
            distance = np.sqrt(squared)
            outward = 0.0
            if distance > 0.0:
                outward = -(direction[0] * x + direction[1] * y) / distance
            _polynomials(-direction[2], outward, coefficients, harmonics, powers)
            integrals(rarefaction * hit, table, scale, 0, values)
            first = eta_basis_at(np.sqrt(1.0 - squared), mesh, eta_basis)
            weight = NORMALISATION * direction[3]
            along, up = -direction[0] / radial_scale, -direction[2]
            for k in range(harmonics.size):
                power_0, power_1, power_2, power_3 = (
                    _integral(values, 1, powers[k], harmonics[k]),
                    _integral(values, 2, powers[k], harmonics[k]),
                    _integral(values, 3, powers[k], harmonics[k]),
                    _integral(values, 4, powers[k], harmonics[k]),
                )
                # harmonics vanish at the axis as r^j; what is left of them is smooth there
                scaled = weight * distance ** harmonics[k]
                moments[0] = scaled * (2.0 / 3.0) * power_2
                moments[1], moments[2] = scaled * power_1 * along, scaled * power_1 * up
                moments[3] = moments[0] - scaled * power_0
                flux = scaled * (power_3 - 2.5 * power_1)
                moments[4], moments[5] = flux * along, flux * up
                for a in range(eta_basis.size):
                    for m in range(FIELDS):
                        rows[i, first + a, m, k] += eta_basis[a] * moments[m]
