"""What molecules bring to a point from their last collision, or from the disk, without matrices.

Sources are powers of the speed times spherical harmonics. Along a ray, those with the same power
of the speed add up before the speed is integrated over, and what arrives is kept by powers until
the ray ends. So many moments cost little more than their interpolation.
"""

import numpy as np

from lightflyer.kinetic_theory.disk.linear_kernel import MOST_DIRECTIONS, NORMALISATION
from lightflyer.kinetic_theory.grid.directions import node_directions
from lightflyer.kinetic_theory.grid.interpolation import (
    bases_at,
    interpolate,
    interpolate_on_face,
    nodes_in_eta,
)
from lightflyer.kinetic_theory.grid.kernels import inner_kernel, kernel, shared_kernel
from lightflyer.kinetic_theory.grid.rays import (
    LARGEST_DEPTH,
    MOST_CUTS,
    REACH,
    SHORTEST,
    integrals,
    spheroidal,
    trace_ray,
)

FLUXES = 4
"""Fluxes of arriving molecules at a face: number, normal momentum, energy, rotational energy."""

_TINY = 1e-30
_WHOLE = 4.0 * np.pi**-0.5  # all directions, by NORMALISATION and weights of half of them


@kernel
def harmonics(x, y, z, norms, out):
    """Fill the real spherical harmonics of a direction that are even in y."""
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


@inner_kernel
def _locate(point, direction, s, below, setup, seen, mesh, scratch, by_power):
    """Fill the sources at a point of a ray in its direction, by power of the speed."""
    norms, odd, components, moved = setup[6:10]
    xi_basis, eta_basis, source, fields = scratch[:4]
    x, y = point[0] + s * direction[0], s * direction[1]
    xi, eta = spheroidal(x * x + y * y, point[1] + s * direction[2])
    i, j = bases_at(xi, eta, mesh, xi_basis, eta_basis)
    interpolate(seen, i, j, nodes_in_eta(mesh), xi_basis, eta_basis, fields)
    inverse = 1.0 / np.sqrt(max(x * x + y * y, _TINY))
    radial = -(direction[0] * x + direction[1] * y) * inverse
    turning = -(direction[1] * x - direction[0] * y) * inverse
    vertical = direction[2] if below else -direction[2]
    harmonics(radial, turning, vertical, norms, source)
    shrink = np.sqrt(max(0.0, (1.0 - eta) * (1.0 + eta)))
    for c in range(odd.size):
        if odd[c]:
            source[c] *= shrink
    angular, power = components[0], components[1]
    by_power[:] = 0.0
    for i in range(angular.size):
        by_power[1 if i >= moved else 0, power[i]] += source[angular[i]] * fields[i]


@inner_kernel
def _correct(values, at_start, at_end, span, rule):
    """Correct the integrals at the points of a piece: uniform gas emits what its ends say."""
    powers = values.shape[1]
    for p in range(powers - 1):
        missing = (at_start[powers + p + 1] - at_end[powers + p + 1]) / span
        for k in range(values.shape[0]):
            missing -= rule[1, k] * values[k, p]
        for k in range(values.shape[0]):
            values[k, p] += missing


@inner_kernel
def _ray(point, direction, on_face, rarefaction, setup, mesh, half, scratch, cuts, brought):
    """Fill what one ray brings, by power of the speed: of translation and of rotation."""
    rule, table, scale = setup[3:6]
    own, other, shares = half[0], half[1], half[2]
    values, at_start, at_end, by_power = scratch[4:]
    optical_scale, powers = 1.0 / rarefaction, values.shape[1]
    longest = REACH * LARGEST_DEPTH * optical_scale
    number, hit, crossing = trace_ray(
        point[0], point[1], direction, longest, optical_scale, mesh, cuts
    )
    disk = crossing < 1.0
    depth, share, emitted = 0.0, 1.0, False
    brought[:] = 0.0
    integrals(0.0, table, scale, 0, at_end)
    for piece in range(number - 1):
        start, width = cuts[piece], cuts[piece + 1] - cuts[piece]
        if width < SHORTEST:
            continue
        if depth >= LARGEST_DEPTH or share == 0.0:
            break
        below = start >= hit
        if below and disk and not emitted:
            emitted, share = True, shares[1]
            at = np.sqrt(1.0 - crossing)
            _add_wall(brought, at_end, at, -direction[2], half, mesh, scratch[1])
        seen = other if below and not disk else own
        end = depth + rarefaction * width
        at_start, at_end = at_end, at_start
        integrals(end, table, scale, 0, at_end)
        for k in range(rule.shape[1]):
            s, there = start + width * rule[0, k], depth + (end - depth) * rule[0, k]
            _locate(point, direction, s, below, setup, seen, mesh, scratch, by_power[k])
            integrals(there, table, scale, powers if on_face else 0, values[k])
        if not on_face:
            _correct(values, at_start, at_end, end - depth, rule)
        for k in range(rule.shape[1]):
            sources, of_speed = by_power[k], values[k]
            strength = share * (end - depth) * rule[1, k]
            for kind in range(sources.shape[0]):
                for p in range(sources.shape[1]):
                    weight = strength * sources[kind, p]
                    if weight == 0.0:
                        continue
                    for q in range(brought.shape[1]):
                        brought[kind, q] += weight * of_speed[1 + p + q]
        depth = end


@inner_kernel
def _add_wall(brought, values, eta, straight_z, half, mesh, eta_basis):
    """Add the emission of a face, by power of the speed."""
    shares, density, temperature, velocity = half[2], half[3], half[4], half[5]
    simple = values[values.size // 2 :]
    sigma = shares[0] * interpolate_on_face(density, eta, mesh, eta_basis)
    warmth = shares[0] * interpolate_on_face(temperature, eta, mesh, eta_basis)
    sigma -= 2.0 * warmth
    for q in range(brought.shape[1]):
        brought[0, q] += sigma * simple[q + 2] + warmth * simple[q + 4]
        brought[0, q] += velocity * straight_z * simple[q + 3]
        brought[1, q] += warmth * simple[q + 2]


@inner_kernel
def _collect(i, point, on_face, rarefaction, setup, mesh, half, out):
    """Moments at a node in powers of the speed, or fluxes at a face, of all directions."""
    layer, gauss_height, gauss_azimuth, rule, table = setup[:5]
    norms, odd, components, moved = setup[6:10]
    order, points, size = mesh[3].shape[2], rule.shape[1], components.shape[1]
    directions = np.empty((MOST_DIRECTIONS, 4))
    count = node_directions(point[0], point[1], layer, gauss_height, gauss_azimuth, directions)
    powers = components[1].max() + 1
    scratch = (
        np.empty(order),
        np.empty(order),
        np.empty(odd.size),
        np.empty(size),
        np.empty((points, table.shape[2] // 2)),
        np.empty(table.shape[2]),
        np.empty(table.shape[2]),
        np.empty((points, 2, powers)),
    )
    row, cuts, brought = np.empty(odd.size), np.empty(MOST_CUTS), np.empty((2, powers))
    uniform = np.zeros((odd.size, odd.size))
    out[:] = 0.0
    for d in range(count):
        direction = directions[d]
        _ray(point, direction, on_face, rarefaction, setup, mesh, half, scratch, cuts, brought)
        weight = NORMALISATION * direction[3]
        if on_face:
            z = direction[2]
            out[0] += weight * z * brought[0, 1]
            out[1] += weight * z * z * brought[0, 2]
            out[2] += weight * z * brought[0, 3]
            out[3] += weight * z * brought[1, 1]
            continue
        harmonics(-direction[0], -direction[1], -direction[2], norms, row)
        for a in range(odd.size):
            for b in range(odd.size):
                uniform[a, b] += weight * row[a] * row[b]
        for c in range(odd.size):
            if odd[c]:
                row[c] /= point[2]
        for c in range(size):
            kind = 1 if c >= moved else 0
            out[c] += weight * row[components[0, c]] * brought[kind, components[1, c]]
    if not on_face:
        _conserve(i, uniform, point[2], setup, half[0], out)


@inner_kernel
def _conserve(i, uniform, radial_scale, setup, own, out):
    """Correct by the node's own sources, so that uniform fields are reproduced exactly."""
    odd, components, moved, uniform_integrals = setup[7:]
    for c in range(components.shape[1]):
        target = components[0, c]
        shrunk = 1.0 / radial_scale if odd[target] else 1.0
        for b in range(components.shape[1]):
            if (b >= moved) != (c >= moved):
                continue
            origin = components[0, b]
            missing = -uniform[origin, target] * shrunk
            if odd[origin]:
                missing *= radial_scale
            if origin == target:
                missing += _WHOLE
            out[c] += (
                missing * uniform_integrals[2 + components[1, b] + components[1, c]] * own[i, b]
            )


@shared_kernel
def evaluate(start, stop, points, on_face, rarefaction, setup, mesh, half, out):
    """Fill the moments at the nodes of one half, or the fluxes on a face, that sources make."""
    for i in range(start, stop):
        _collect(i, points[i], on_face, rarefaction, setup, mesh, half, out[i])
