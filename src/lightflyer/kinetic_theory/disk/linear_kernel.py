"""Matrices of the linearised kinetic equation in integral form.

A row gives one moment of the distribution at one node as a weighted sum of the fields at all
nodes: an integral over directions, and along each ray, of what molecules carry from their last
collision. The equation is linearised about a gas at rest of uniform pressure. Its temperature θ is
1 in the linear problem, and that of an approximate solution where the matrices precondition the
non-linear problem.

Fields and moments are, in this order, the perturbations of p, u_r, u_z, T, q_r, q_z, with the
radial ones divided by √(1−η²).
"""

import numpy as np

from lightflyer.kinetic_theory.grid.directions import node_directions
from lightflyer.kinetic_theory.grid.interpolation import (
    bases_at,
    eta_basis_at,
    interpolate,
    nodes_in_eta,
    rim_basis_at,
    scatter,
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

FIELDS = 6
FLUXES = 3  # Fluxes of arriving molecules at a face: number, normal momentum, energy
WALL_FLUXES = 4  # The same and axial momentum, which differs from normal momentum at a side wall

EMISSIONS = 3
"""Emissions of a wall, by their factor: σ with 1, temperature with c²/θ−2, velocity with c·e_z."""

RIM_EMISSIONS = 2  # Emissions of the walls around the gas, which rest: σ and temperature

DIRECT, ACROSS, REFLECTED = 0, 1, 2
"""Ways by which walls around the gas are seen: in the own half, in the other one past the disk, and
in the own half by reflection at the disk."""

NORMALISATION = 2.0 * np.pi**-1.5  # of the Maxwellian; directions cover half of the sphere
MOST_DIRECTIONS = 40000

# moments of the uniform source shapes, by exact integration over the Maxwellian
_EXACT = np.array([1.0, 0.5, 0.5, 1.0, 1.25, 1.25])


@inner_kernel
def _shape(j, first, kind, inverse):
    """Speed integral of the source of one unit field; ``first`` indexes J, ``inverse`` is 1/θ."""
    if kind == 0:
        return j[first] * inverse
    if kind == 1:
        return j[first + 1] * inverse * inverse
    if kind == 2:
        return (j[first + 2] * inverse - 2.5 * j[first]) * inverse * inverse
    return (j[first + 3] * inverse - 2.5 * j[first + 1]) * inverse * inverse


@inner_kernel
def _emission_integral(j, first, kind, inverse):
    """Speed integral of an emission 1, (c²/θ−2)/θ² or c; ``inverse`` is 1/θ."""
    if kind == 0:
        return j[first]
    if kind == 1:
        # as many molecules, at uniform pressure before: their density is 1/θ
        return (j[first + 2] * inverse - 2.0 * j[first]) * inverse * inverse
    return j[first + 1]


@inner_kernel
def _moments(power_0, power_1, power_2, power_3, row, theta, weight, out):
    """Fill the six fields at a node of temperature θ, from integrals with 0 to 3 more powers."""
    pressure = weight * (2.0 / 3.0) * power_2
    speed, flux = weight * theta * power_1, weight * (power_3 - 2.5 * theta * power_1)
    out[0] = pressure
    out[1] = speed * row[0]
    out[2] = speed * row[1]
    out[3] = theta * (pressure - weight * theta * power_0)
    out[4] = flux * row[0]
    out[5] = flux * row[1]


@inner_kernel
def _fluxes(power_1, power_2, power_3, normal, axial, weight, out):
    """Fill the fluxes that arrive at a wall, from integrals with 1 to 3 more powers."""
    out[0] = weight * normal * power_1
    out[1] = weight * normal * normal * power_2
    out[2] = weight * normal * power_3
    out[3] = weight * normal * axial * power_2


@inner_kernel
def _source_weights(j, first, on_face, row, source, theta, source_theta, weight, out):
    """Fill the weights of the fields at one ray point in each moment or flux of the row."""
    inverse = 1.0 / source_theta
    for kind in range(4):
        power_1 = _shape(j, first + 1, kind, inverse)
        power_2 = _shape(j, first + 2, kind, inverse)
        power_3 = _shape(j, first + 3, kind, inverse)
        vector = kind == 1 or kind == 3
        field = kind if kind < 2 else kind + 1
        for component in range(2 if vector else 1):
            w = weight * source[component] if vector else weight
            if on_face:
                _fluxes(power_1, power_2, power_3, row[1], row[2], w, out[field + component])
            else:
                power_0 = _shape(j, first, kind, inverse)
                _moments(power_0, power_1, power_2, power_3, row, theta, w, out[field + component])


@inner_kernel
def _conserve(uniform, radial_scale, cell, correction):
    """Correct the node's own weights so that uniform fields are reproduced exactly."""
    # Far away the equation describes diffusion. Its terms are differences of integrals, and smaller
    # than these by the square of the optical depth. Without the correction, the quadrature's error
    # would act there as a sink of conserved quantities.
    for field in range(FIELDS):
        factor = radial_scale if field == 1 or field == 4 else 1.0
        for moment in range(FIELDS):
            missing = -factor * uniform[field, moment]
            if field == moment:
                missing += _EXACT[field]
            cell[field * FIELDS + moment] += missing
            correction[field, moment] = missing


@inner_kernel
def _locate(point, direction, start, width, state, excess, setup, mesh, scratch):
    """Fill position, temperature and collision frequency at the points of one piece of a ray."""
    rarefaction, exponent, linear = state[0], state[1], state[5]
    gauss_ray = setup[3]
    xi_basis, eta_basis, panels, radial, temperatures, frequencies, _, _, here = scratch
    eta_size = nodes_in_eta(mesh)
    for k in range(gauss_ray.shape[1]):
        s = start + width * gauss_ray[0, k]
        x, y = point[0] + s * direction[0], s * direction[1]
        xi, eta = spheroidal(x * x + y * y, point[1] + s * direction[2])
        i, j = bases_at(xi, eta, mesh, xi_basis[k], eta_basis[k])
        panels[k, 0], panels[k, 1] = i, j
        radial[k] = -(direction[0] * x + direction[1] * y) / np.sqrt(1.0 + xi * xi)
        temperatures[k] = 1.0
        if not linear:
            interpolate(excess, i, j, eta_size, xi_basis[k], eta_basis[k], here)
            temperatures[k] += here[0]
        frequencies[k] = rarefaction * temperatures[k] ** exponent


@inner_kernel
def _add_piece(depth, width, below, seen, state, setup, mesh, scratch, target, out):
    """Add the points of one piece to a row; returns the optical depth at the piece's end."""
    on_face, row, straight, theta, weight = seen
    linear, gauss_ray = state[5], setup[3]
    xi_basis, eta_basis, panels, radial, temperatures, frequencies, buffer, integrals, _ = scratch
    _, source, weights, uniform = out
    eta_size = nodes_in_eta(mesh)
    flat = weights.ravel()
    source[1] = -straight[1] if below else straight[1]
    end = piece_integrals(depth, width, temperatures, frequencies, setup[3:], buffer, integrals)
    for k in range(gauss_ray.shape[1]):
        j = integrals[k]
        source[0] = radial[k]
        w = weight * frequencies[k] * width * gauss_ray[1, k]
        _source_weights(j, 0, on_face, row, source, theta, temperatures[k], w, weights)
        scatter(target, flat, panels[k, 0], panels[k, 1], eta_size, xi_basis[k], eta_basis[k])
        if linear and not on_face:
            _source_weights(j, 0, on_face, row, straight, 1.0, 1.0, w, weights)
            uniform += weights
    return end


@inner_kernel
def _ray(point, direction, seen, state, setup, meshes, scratch, out, cuts, rows, walls, rim):
    """Add one ray to a row; returns the optical depth at its end."""
    table, scale = setup[5:]
    number, hit, crossing, leaves = trace_between(
        point[0],
        point[1],
        direction,
        REACH * LARGEST_DEPTH / state[0],
        1.0 / state[0],
        meshes,
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
            maxwellian_integrals(depth, state[4], table, scale, out[0])
            eta = np.sqrt(1.0 - crossing)
            _wall(out[0], seen, eta, state[4], meshes[0], scratch[1][0], walls)
        target = DIRECT
        if below:
            target = REFLECTED if disk else ACROSS
        mesh, excess = (meshes[1], state[3]) if target == ACROSS else (meshes[0], state[2])
        _locate(point, direction, start, width, state, excess, setup, mesh, scratch)
        depth = _add_piece(
            depth, width, below, seen, state, setup, mesh, scratch, rows[target], out
        )
    if leaves and rim[DIRECT].size > 0 and depth < LARGEST_DEPTH:
        end = cuts[number - 1]
        x, y = point[0] + end * direction[0], end * direction[1]
        _, eta = spheroidal(x * x + y * y, point[1] + end * direction[2])
        target = DIRECT
        if hit < end:
            target = REFLECTED if disk else ACROSS
        maxwellian_integrals(depth, 1.0, table, scale, out[0])
        _rim(out[0], seen, eta, meshes[0], scratch[1][0], rim[target])
    return depth


@inner_kernel
def _row(i, point, on_face, state, setup, meshes, rows, walls, rim, correction):
    """Fill one row: weights of the own half's fields, the other half's and after reflection."""
    layer, gauss_height, gauss_azimuth, gauss_ray, _, table, scale = setup
    order, points = meshes[0][3].shape[2], gauss_ray.shape[1]
    directions = np.empty((MOST_DIRECTIONS, 4))
    count = node_directions(point[0], point[1], layer, gauss_height, gauss_azimuth, directions)
    scratch = (
        np.empty((points, order)),
        np.empty((points, order)),
        np.empty((points, 2), np.int64),
        np.empty(points),
        np.empty(points),
        np.empty(points),
        np.empty((4, NUMBER)),
        np.empty((points, NUMBER)),
        np.empty(1),
    )
    weights = np.empty((FIELDS, WALL_FLUXES if on_face else FIELDS))
    uniform = np.zeros_like(weights)
    j, cuts = np.empty(NUMBER), np.empty(MOST_CUTS)
    out = (j, np.empty(2), weights, uniform)
    row, straight = np.empty(3), np.empty(2)
    corrected = state[5] and not on_face
    theta = 1.0 if on_face else 1.0 + state[2][i, 0]
    for d in range(count):
        direction = directions[d]
        straight[0], straight[1] = -direction[0], -direction[2]
        row[0] = straight[0] / point[2]
        row[1], row[2] = straight[1], straight[1]
        if on_face:
            row[1] = point[3] * direction[0] + point[4] * direction[2]
            if row[1] <= 0.0:
                continue
        weight = NORMALISATION * direction[3]
        seen = (on_face, row, straight, theta, weight)
        depth = _ray(
            point, direction, seen, state, setup, meshes, scratch, out, cuts, rows, walls, rim
        )
        if corrected and depth < LARGEST_DEPTH:
            # contribution of uniform fields beyond the end of the ray
            maxwellian_integrals(depth, 1.0, table, scale, j)
            _source_weights(j, 1, False, row, straight, 1.0, 1.0, weight, weights)
            uniform += weights
    if corrected:
        _conserve(uniform, point[2], rows[0][i], correction)


@inner_kernel
def _wall(j, seen, eta, face, mesh, eta_basis, walls):
    """Add the emission of a face at θ = ``face`` towards a node: σ and temperature by its nodes."""
    order, first = eta_basis.size, eta_basis_at(eta, mesh, eta_basis)
    size, inverse = nodes_in_eta(mesh), 1.0 / face
    out = np.empty(FIELDS)
    for kind in range(EMISSIONS):
        _emission(j, kind, inverse, seen, out)
        for m in range(walls.shape[1]):
            if kind == 2:
                walls[2 * size, m] += out[m]
            else:
                for a in range(order):
                    walls[kind * size + first + a, m] += eta_basis[a] * out[m]


@inner_kernel
def _emission(j, kind, inverse, seen, out):
    """Fill the moments or fluxes of one emission of a wall along a ray."""
    on_face, row, straight, theta, weight = seen
    w = weight * straight[1] if kind == 2 else weight
    power_1, power_2 = (
        _emission_integral(j, 2, kind, inverse),
        _emission_integral(j, 3, kind, inverse),
    )
    power_3 = _emission_integral(j, 4, kind, inverse)
    if on_face:
        _fluxes(power_1, power_2, power_3, row[1], row[2], w, out)
    else:
        power_0 = _emission_integral(j, 1, kind, inverse)
        _moments(power_0, power_1, power_2, power_3, row, theta, w, out)


@inner_kernel
def _rim(j, seen, eta, mesh, basis, target):
    """Add the emission of a wall around the gas: σ and temperature by its nodes."""
    first, size = rim_basis_at(eta, mesh, basis), target.shape[0] // RIM_EMISSIONS
    out = np.empty(FIELDS)
    for kind in range(RIM_EMISSIONS):
        _emission(j, kind, 1.0, seen, out)
        for m in range(target.shape[1]):
            for a in range(basis.size):
                target[kind * size + first + a, m] += basis[a] * out[m]


@shared_kernel
def assemble(
    start, stop, points, on_face, state, setup, mesh, beyond, own, other, reflected, walls, rim,
    corrections,
):  # fmt: skip
    """Fill the rows of all nodes of a half, or of all nodes on a wall; ``points`` (m, 5)."""
    # One kernel does both, as compiling takes many seconds.
    meshes = mesh, beyond
    for i in range(start, stop):
        rows, emitted = (own[i], other[i], reflected[i]), (walls[i], rim[:, i])
        _row(i, points[i], on_face, state, setup, meshes, rows, *emitted, corrections[i])
