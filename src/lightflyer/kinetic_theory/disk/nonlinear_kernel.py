"""One evaluation of the non-linear kinetic equation in integral form.

Given fields at all nodes, every ray is traced anew: optical depth grows with the local collision
frequency, the local model distribution emits, and the moments that arrive are returned. Sums are
over the deviation from the gas at rest far away, so that an undisturbed gas is exact.

Fields, in this order: nT − 1, u_r, u_z, τ = T − 1, q_r, q_z, and for rotation τ_r, q_r, q_z;
radial ones are divided by √(1−η²). Pressure is interpolated, not density: separate interpolation
of density and temperature would make spurious pressures, and so forces, between nodes. Speeds are
in √(2RT_c), temperatures in T_c, densities in n_c.

The last of ``half`` is a slow stream of the gas far away: its speed from the disk, and how much
warmer its wake is. Fields are then less those of the stream, sums over the deviation from it.
"""

import numpy as np

from lightflyer.kinetic_theory.disk.linear_kernel import MOST_DIRECTIONS, NORMALISATION
from lightflyer.kinetic_theory.grid.directions import node_directions
from lightflyer.kinetic_theory.grid.interpolation import (
    bases_at,
    interpolate,
    interpolate_on_face,
    nodes_in_eta,
    rim_basis_at,
)
from lightflyer.kinetic_theory.grid.kernels import inner_kernel, shared_kernel
from lightflyer.kinetic_theory.grid.rays import (
    LARGEST_DEPTH,
    MOST_CUTS,
    NUMBER,
    REACH,
    SHORTEST,
    maxwellian_integrals,
    piece_integrals,
    spheroidal,
    trace_between,
)

_POWERS = 4  # of the speed, 2 to 5, in the integrals along a ray; two more for rotational energy
_OF_TRANSLATION = 6  # Number of fields without rotation
LOWEST = 0.1  # temperature of an iterate between nodes; those of solutions stay above 1


@inner_kernel
def _local_source(state, gas, radial, vertical, coefficients):
    """Model distribution along a direction, a Maxwellian times a polynomial in the speed."""
    # Fills the coefficients of c⁰ to c³ for number and for rotational energy; returns the
    # temperature of the Maxwellian.
    heat, rotational_heat, exchange, _, rotates = gas
    temperature = max(LOWEST, 1.0 + state[3])
    density = (1.0 + state[0]) / temperature
    turning = 1.0 + state[6]
    theta, turning_to = temperature, turning
    if rotates:
        theta += 0.4 * exchange * (turning - temperature)
        turning_to += 0.6 * exchange * (temperature - turning)
    theta = max(theta, LOWEST)
    drift = radial * state[1] + vertical * state[2]
    flux = heat * (radial * state[4] + vertical * state[5])
    a = coefficients[0]
    a[0] = density * (1.0 - state[9] / theta)
    a[1] = 2.0 * density * drift / theta - 2.5 * flux / theta**2
    a[2] = 2.0 * density * (drift / theta) ** 2
    a[3] = flux / theta**3
    if rotates:
        b = coefficients[1]
        for k in range(4):
            b[k] = turning_to * a[k]
        b[1] += rotational_heat * (radial * state[7] + vertical * state[8]) / theta
    return theta


@inner_kernel
def _add_piece(brought, weight, hot, cold, coefficients, rotates):
    """Add the contribution of one ray point, with four powers of the speed (two for rotation)."""
    a, b = coefficients[0], coefficients[1]
    for k in range(_POWERS):
        brought[k] += weight * (
            a[0] * hot[k] + a[1] * hot[k + 1] + a[2] * hot[k + 2] + a[3] * hot[k + 3] - cold[k]
        )
    if rotates:
        for k in range(2):
            brought[_POWERS + k] += weight * (
                b[0] * hot[k] + b[1] * hot[k + 1] + b[2] * hot[k + 2] + b[3] * hot[k + 3] - cold[k]
            )


@inner_kernel
def _shift(cold, drift, square):
    """Turn the integrals of a gas at rest into those of a stream, to its second order."""
    if square == 0.0:
        return
    for k in range(NUMBER - 2):
        cold[k] = (1.0 - square) * cold[k] + 2.0 * drift * (cold[k + 1] + drift * cold[k + 2])


@inner_kernel
def _add_stream(fields, sign, stream, xi, eta):
    """Add a stream to fields at a point, or take it from them."""
    fields[2] += sign * stream[0]
    wake = sign * stream[1] * xi * eta / np.sqrt(1.0 + xi * xi)
    fields[3] += wake
    if fields.size > _OF_TRANSLATION:
        fields[6] += wake


@inner_kernel
def _add_stream_at_wall(brought, shares, drift, square, cold):
    """Add what a stream adds at a face, whose emission is less that of a gas at rest."""
    if square == 0.0:
        return
    for k in range(_POWERS + 2):
        at = k + 1 if k < _POWERS else k + 1 - _POWERS
        more = 2.0 * drift * (cold[at + 1] + drift * cold[at + 2]) - square * cold[at]
        # what is reflected came with the other sign of the drift
        brought[k] -= shares[0] * more + shares[1] * 4.0 * drift * cold[at + 1]


@inner_kernel
def _ray(point, direction, rarefaction, setup, meshes, gas, half, cuts, brought):
    """Fill the contribution of one ray: its deviation times the speed to the powers 2 to 5."""
    # arrays and the loop over points are local: a compiler cannot rule out that arrays passed to a
    # function of its own overlap, and that takes half as long again
    rule, eta_size, order = setup[3], nodes_in_eta(meshes[0]), meshes[0][3].shape[2]
    points = rule.shape[1]
    xi_basis, eta_basis, state = np.empty(order), np.empty(order), np.zeros(10)
    frequencies, thetas, ones = np.empty(points), np.empty(points), np.ones(points)
    hot, cold = np.empty((points, NUMBER)), np.empty((points, NUMBER))
    buffer, coefficients = np.empty((4, NUMBER)), np.empty((points, 2, 4))
    optical_scale = 1.0 / rarefaction
    longest = REACH * LARGEST_DEPTH * optical_scale
    number, hit, crossing, leaves = trace_between(
        point[0], point[1], direction, longest, optical_scale, meshes, cuts
    )
    disk = crossing < 1.0
    reflected, transmitted = half[3][1], half[3][2]
    normal = direction[2] * direction[2]
    stream = half[-1]
    brought[:] = 0.0
    first, depth, share = 0, 0.0, 1.0
    at_disk, depth_at_disk = -1, 0.0
    # up to the disk and on as reflected; then once more from the disk on, as transmitted
    for through in range(2):
        for piece in range(first, number - 1):
            start, width = cuts[piece], cuts[piece + 1] - cuts[piece]
            if width < SHORTEST:
                continue
            below = start >= hit
            if below and disk and at_disk < 0:
                x, y = point[0] + hit * direction[0], hit * direction[1]
                eta = np.sqrt(max(0.0, 1.0 - x * x - y * y))
                emission = _emission(eta, normal, half, meshes[0], eta_basis)
                _add_emission(brought, emission, depth, setup, hot[0], cold[0])
                drift, square = -direction[2] * stream[0], stream[0] * stream[0]
                _add_stream_at_wall(brought, half[3], drift, square, cold[0])
                at_disk, depth_at_disk, share = piece, depth, reflected
            if share == 0.0:
                break
            other = below and (through == 1 or not disk)
            fields, mesh, sign = (half[1], meshes[1], -1.0) if other else (half[0], meshes[0], 1.0)
            vertical = direction[2] if below else -direction[2]
            flow = sign * stream[0]
            for k in range(points):
                s = start + width * rule[0, k]
                x, y, z = point[0] + s * direction[0], s * direction[1], point[1] + s * direction[2]
                xi, eta = spheroidal(x * x + y * y, z)
                i, j = bases_at(xi, eta, mesh, xi_basis, eta_basis)
                interpolate(fields, i, j, eta_size, xi_basis, eta_basis, state)
                _add_stream(state, sign, stream, xi, eta)
                # u²: the radial velocity is kept divided by √(1−η²)
                state[9] = state[1] * state[1] * (1.0 - eta * eta) + state[2] * state[2]
                radial = -(direction[0] * x + direction[1] * y) / np.sqrt(1.0 + xi * xi)
                temperature = max(LOWEST, 1.0 + state[3])
                frequencies[k] = rarefaction * (1.0 + state[0]) * temperature ** gas[3]
                thetas[k] = _local_source(state, gas, radial, vertical, coefficients[k])
            piece_integrals(depth, width, thetas, frequencies, setup[3:], buffer, hot)
            depth = piece_integrals(depth, width, ones, frequencies, setup[3:], buffer, cold)
            for k in range(points):
                _shift(cold[k], vertical * flow, flow * flow)
                w = share * width * rule[1, k] * frequencies[k]
                _add_piece(brought, w, hot[k], cold[k], coefficients[k], gas[4])
            if depth > LARGEST_DEPTH:
                break
        end = cuts[number - 1]
        rim = half[5] if hit < end and (through == 1 or not disk) else half[4]
        seen, place = share * leaves, (point, direction, end)
        _add_rim(brought, place, rim, seen, depth, setup, meshes[0], hot[0], cold[0])
        if at_disk < 0 or transmitted == 0.0:
            return
        first, depth, share = at_disk, depth_at_disk, transmitted


@inner_kernel
def _emission(eta, normal, half, mesh, eta_basis):
    """Maxwellian that a face emits at a point along a ray; ``normal``: its cosine, squared."""
    density = interpolate_on_face(half[2][0], eta, mesh, eta_basis)
    across = max(LOWEST, interpolate_on_face(half[2][1], eta, mesh, eta_basis))
    along = max(LOWEST, interpolate_on_face(half[2][2], eta, mesh, eta_basis))
    turning = interpolate_on_face(half[2][3], eta, mesh, eta_basis)
    # one of two temperatures is one of a single temperature along each ray
    temperature = across * along / (normal * along + (1.0 - normal) * across)
    density *= temperature * np.sqrt(temperature / across) / along
    return density, temperature, turning, half[3][0]


@inner_kernel
def _add_rim(brought, place, rim, share, depth, setup, mesh, hot, cold):
    """Add the emission of the walls around the gas at the end of a ray, if it is seen."""
    if rim.size == 0 or share == 0.0 or depth >= LARGEST_DEPTH:
        return
    point, direction, end = place
    x, y = point[0] + end * direction[0], end * direction[1]
    _, eta = spheroidal(x * x + y * y, point[1] + end * direction[2])
    basis = np.empty(mesh[7].shape[2])
    first = rim_basis_at(eta, mesh, basis)
    density, temperature = 0.0, 0.0
    for a in range(basis.size):
        density += basis[a] * rim[0, first + a]
        temperature += basis[a] * rim[1, first + a]
    emission = (density, max(LOWEST, temperature), temperature, share)
    _add_emission(brought, emission, depth, setup, hot, cold)


@inner_kernel
def _add_emission(brought, emission, depth, setup, hot, cold):
    """Add a Maxwellian by density, temperatures and share, less that of the gas at rest."""
    density, temperature, turning, share = emission
    table, scale = setup[5:]
    maxwellian_integrals(depth, temperature, table, scale, hot)
    maxwellian_integrals(depth, 1.0, table, scale, cold)
    for k in range(_POWERS):
        brought[k] += share * (density * hot[k + 1] - cold[k + 1])
    for k in range(2):
        brought[_POWERS + k] += share * (density * turning * hot[k + 1] - cold[k + 1])


@inner_kernel
def _collect(point, on_face, rarefaction, setup, meshes, gas, half, out):
    """Raw moments at a node, or fluxes at a face, summed over all directions."""
    layer, gauss_height, gauss_azimuth = setup[:3]
    directions = np.empty((MOST_DIRECTIONS, 4))
    count = node_directions(point[0], point[1], layer, gauss_height, gauss_azimuth, directions)
    cuts, brought = np.empty(MOST_CUTS), np.empty(_POWERS + 2)
    out[:] = 0.0
    for d in range(count):
        direction = directions[d]
        normal = point[3] * direction[0] + point[4] * direction[2]
        if on_face and normal <= 0.0:
            continue
        _ray(point, direction, rarefaction, setup, meshes, gas, half, cuts, brought)
        w, x, z = NORMALISATION * direction[3], -direction[0], -direction[2]
        if on_face:
            # number, normal momentum, energy; of rotation; axial momentum, energy of normal motion
            out[0] += w * normal * brought[1]
            out[1] += w * normal * normal * brought[2]
            out[2] += w * normal * brought[3]
            out[3] += w * normal * brought[5]
            out[4] += w * normal * z * brought[2]
            out[5] += w * normal**3 * brought[3]
        else:
            out[0] += w * brought[0]
            out[1] += w * x * brought[1]
            out[2] += w * z * brought[1]
            out[3] += w * brought[2]
            out[4] += w * x * brought[3]
            out[5] += w * z * brought[3]
            out[6] += w * brought[4]
            out[7] += w * x * brought[5]
            out[8] += w * z * brought[5]
            out[9] += w * x * x * brought[2]
            out[10] += w * x * z * brought[2]
            out[11] += w * z * z * brought[2]


@inner_kernel
def _central(raw, radial_scale, rotates, fields):
    """Fields from raw moments: central in the mean velocity."""
    density = 1.0 + raw[0]
    u, w = raw[1] / density, raw[2] / density
    square = u * u + w * w
    energy = 1.5 + raw[3]
    temperature = (energy / density - square) / 1.5
    xx, xz, zz = 0.5 + raw[9], raw[10], 0.5 + raw[11]
    common = 2.0 * density * square - energy
    fields[0] = density * temperature - 1.0
    fields[1] = u / radial_scale
    fields[2] = w
    fields[3] = temperature - 1.0
    fields[4] = (raw[4] - 2.0 * (xx * u + xz * w) + common * u) / radial_scale
    fields[5] = raw[5] - 2.0 * (xz * u + zz * w) + common * w
    if rotates:
        fields[6] = (1.0 + raw[6]) / density - 1.0
        fields[7] = (raw[7] - (1.0 + raw[6]) * u) / radial_scale
        fields[8] = raw[8] - (1.0 + raw[6]) * w


@shared_kernel
def evaluate(start, stop, points, on_face, rarefaction, setup, mesh, beyond, gas, half, out):
    """Fill the fields at the nodes of one half, or the fluxes on a face, from fields."""
    for i in range(start, stop):
        meshes = (mesh, beyond)
        if on_face:
            _collect(points[i], on_face, rarefaction, setup, meshes, gas, half, out[i])
        else:
            raw = np.empty(12)
            _collect(points[i], on_face, rarefaction, setup, meshes, gas, half, raw)
            stream = half[-1][0]
            raw[2] += stream
            raw[3] += stream**2
            raw[5] += 2.5 * stream + stream**3
            raw[8] += stream
            raw[11] += stream**2
            _central(raw, points[i, 2], gas[4], out[i])
            xi, eta = spheroidal(points[i, 0] * points[i, 0], points[i, 1])
            _add_stream(out[i], -1.0, half[-1], xi, eta)
