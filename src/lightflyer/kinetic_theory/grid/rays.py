r"""Straight rays through the mesh: where they cross panels, and speed integrals along them.

Below the disk's plane everything is mirrored. A ray that has crossed z = 0 goes on through the
mirror image of the lower half, with the height of its direction reversed. With the fields of the
other half it is a ray that missed the disk or passed its holes, with those of its own half one that
the disk reflected.

Speed integrals of the kinetic equation along a ray.

.. math:: J_p(z) = \int_0^\infty c^p \exp(-c^2 - z/c)\,dc

They are the Abramowitz functions for p from 1 to 8, tabulated as cubic splines in :math:`\sqrt z`.
In this variable the logarithmic terms at zero have three continuous derivatives, and the decay at
large z is slow.
"""

from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from lightflyer.kinetic_theory.grid.kernels import inner_kernel, kernel

LOWEST_POWER = 1
HIGHEST_POWER = 8
NUMBER = HIGHEST_POWER - LOWEST_POWER + 1

LARGEST_DEPTH = 60.0  # Optical depth beyond which rays end: J₁(60) is 2e-12 of J₁(0)

_INTERVALS = 2400
_LOGARITHM_OF_SPEED = np.linspace(-14.0, 2.2, 900)


def speed_integral(power: int, depth: np.ndarray) -> np.ndarray:
    r"""Speed integral by the trapezoidal rule in ln c, which converges exponentially."""
    speed = np.exp(_LOGARITHM_OF_SPEED)
    weight = speed ** (power + 1) * np.exp(-(speed**2))
    step = _LOGARITHM_OF_SPEED[1] - _LOGARITHM_OF_SPEED[0]
    return np.exp(-np.asarray(depth)[..., None] / speed) @ weight * step


@lru_cache
def spline_table(highest_power: int = HIGHEST_POWER) -> tuple[np.ndarray, float]:
    """Spline coefficients for the compiled kernels."""
    root = np.linspace(0.0, np.sqrt(LARGEST_DEPTH) * 1.001, _INTERVALS + 1)
    depth = root**2
    columns = [
        CubicSpline(root, speed_integral(p, depth)).c
        for p in range(LOWEST_POWER, highest_power + 1)
    ]
    table = np.ascontiguousarray(np.transpose(np.stack(columns), (2, 1, 0)))
    return table, float(_INTERVALS / root[-1])


# optical depths at which a ray is cut: each piece is smooth enough for Gauss quadrature
DEPTH_CUTS = np.array([0.1, 0.5, 1.5, 3.3, 6.0, 10.0, 16.0, 25.0, 40.0, 60.0])
MOST_CUTS = 160
REACH = 1.6
"""Longest ray, over the length of the largest optical depth in the gas far away; hot gas is
thinner."""

SHORTEST = 1e-13
"""Length below which a piece of a ray is skipped [disk radii]: it crosses two edges at once."""

_SHORTENED = 0.999999  # keeps the largest depth inside the table


@kernel
def spheroidal(radius_squared, height):
    """ξ and η of a point, free of cancellation."""
    half = 0.5 * (radius_squared + height * height - 1.0)
    root = np.sqrt(half * half + height * height)
    if half > 0.0:
        xi = np.sqrt(half + root)
        return xi, min(1.0, abs(height) / xi)
    eta = np.sqrt(root - half)
    if eta == 0.0:
        return 0.0, 0.0
    return abs(height) / eta, min(1.0, eta)


@inner_kernel
def _insert(cuts, count, s, length):
    """Put a cut between 0 and the ray's length in its place; returns how many there are."""
    if not 0.0 < s < length:
        return count
    place = count
    while cuts[place - 1] > s:
        cuts[place] = cuts[place - 1]
        place -= 1
    cuts[place] = s
    return count + 1


@inner_kernel
def _insert_roots(cuts, count, a, b, c, length):
    """Put the roots of a s² + 2 b s + c in their places."""
    if abs(a) < 1e-14 * (abs(b) + abs(c)):
        return _insert(cuts, count, -0.5 * c / b, length)
    discriminant = b * b - a * c
    if discriminant <= 0.0:
        return count
    q = -(b + np.copysign(np.sqrt(discriminant), b))
    count = _insert(cuts, count, q / a, length)
    return _insert(cuts, count, c / q, length)


@kernel
def exit_length(radius, height, direction, boundary, above, below):
    """Length of a ray up to the cylinder r ≤ ``boundary``, −``below`` ≤ z ≤ ``above``."""
    if not np.isfinite(boundary):
        return np.inf
    length = np.inf
    if direction[2] > 0.0:
        length = (above - height) / direction[2]
    elif direction[2] < 0.0:
        length = (below + height) / -direction[2]
    a = direction[0] ** 2 + direction[1] ** 2
    if a > 0.0:
        b = radius * direction[0]
        c = radius * radius - boundary * boundary
        length = min(length, (-b + np.sqrt(max(0.0, b * b - a * c))) / a)
    return max(length, 0.0)


@kernel
def cut_ray(radius, height, direction, length, optical_scale, xi_edges, eta_edges, cuts):
    """Cut a ray at z = 0, at the edges of panels and at given optical depths."""
    wx, wz = direction[0], direction[2]
    a_r = wx * wx + direction[1] * direction[1]
    b_r, c_r = radius * wx, radius * radius
    a_z, b_z, c_z = wz * wz, height * wz, height * height
    count = 1
    cuts[0] = 0.0
    for k in range(1, xi_edges.size):
        edge = xi_edges[k]
        if not np.isfinite(edge):
            continue
        outer, inner = 1.0 / (1.0 + edge * edge), 1.0 / (edge * edge)
        a, b = a_r * outer + a_z * inner, b_r * outer + b_z * inner
        count = _insert_roots(cuts, count, a, b, c_r * outer + c_z * inner - 1.0, length)
    for k in range(1, eta_edges.size - 1):
        edge = eta_edges[k]
        outer, inner = 1.0 / (1.0 - edge * edge), 1.0 / (edge * edge)
        a, b = a_r * outer - a_z * inner, b_r * outer - b_z * inner
        count = _insert_roots(cuts, count, a, b, c_r * outer - c_z * inner - 1.0, length)
    hit = np.inf
    if wz < 0.0:
        hit = -height / wz
        count = _insert(cuts, count, hit, length)
    for depth in DEPTH_CUTS:
        count = _insert(cuts, count, depth * optical_scale, length)
    cuts[count] = length
    return count + 1, hit


@kernel
def trace_ray(radius, height, direction, longest, optical_scale, mesh, cuts):
    """Cut a ray as :func:`trace_between` between halves that are alike."""
    meshes = (mesh, mesh)
    count, hit, crossing, _ = trace_between(
        radius, height, direction, longest, optical_scale, meshes, cuts
    )
    return count, hit, crossing


@kernel
def trace_between(radius, height, direction, longest, optical_scale, meshes, cuts):
    """Cut a ray that ends at the cylinder around the gas or where nothing beyond is seen."""
    own, other = meshes
    below, crossing = other[6], 1.0
    if direction[2] < 0.0:
        s = -height / direction[2]
        crossing = (radius + s * direction[0]) ** 2 + (s * direction[1]) ** 2
        if crossing < 1.0:
            below = own[6]  # the disk reflects it into the half it came from
    end = exit_length(radius, height, direction, own[5], own[6], below)
    length = min(longest, end)
    count, hit = cut_ray(radius, height, direction, length, optical_scale, own[0], own[2], cuts)
    if not hit < length:
        crossing = 1.0
    return count, hit, crossing, end <= longest


@kernel
def integrals(depth, table, scale, first, values):
    """Fill speed integrals at an optical depth from one of a table on, as many as are asked for."""
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


@inner_kernel
def _tabulate(depth, table, scale, values):
    """Fill J₁ to J₈ at an optical depth below the largest of the table."""
    # as :func:`integrals`, of a number that the compiler knows: all of a solution is 10 % faster
    position = np.sqrt(depth) * scale
    cell = int(position)
    t = (position - cell) / scale
    row = table[cell]
    for p in range(NUMBER):
        values[p] = ((row[0, p] * t + row[1, p]) * t + row[2, p]) * t + row[3, p]


@kernel
def maxwellian_integrals(depth, temperature, table, scale, values):
    """Fill θ^((p−2)/2) J_p(depth/√θ): speed integrals of a Maxwellian of temperature θ."""
    root = np.sqrt(temperature)
    reduced = depth / root
    if reduced >= _SHORTENED * LARGEST_DEPTH:
        values[:] = 0.0
        return
    _tabulate(reduced, table, scale, values)
    factor = 1.0 / root
    for p in range(NUMBER):
        values[p] *= factor
        factor *= root


@kernel
def piece_integrals(depth, width, temperatures, frequencies, setup, buffer, values):
    """Fill the speed integrals at the points of one piece of a ray; ``width`` [disk radii]."""
    # They are corrected for the error of the quadrature, so that a piece of uniform gas emits
    # exactly what follows from its optical depth: see Conservation in the documentation.
    gauss_ray, inside, table, scale = setup
    points = gauss_ray.shape[1]
    middle = temperatures[points // 2]
    at_start, at_end, here, sums = buffer
    sums[:] = 0.0
    end = depth
    for k in range(points):
        reached = depth
        for m in range(points):
            reached += width * inside[k, m] * frequencies[m]
        share = width * gauss_ray[1, k] * frequencies[k]
        end += share
        maxwellian_integrals(reached, temperatures[k], table, scale, values[k])
        if temperatures[k] == middle:
            for p in range(NUMBER):
                sums[p] += share * values[k, p]
        else:
            maxwellian_integrals(reached, middle, table, scale, here)
            for p in range(NUMBER):
                sums[p] += share * here[p]
    if end == depth:
        return end
    maxwellian_integrals(depth, middle, table, scale, at_start)
    maxwellian_integrals(end, middle, table, scale, at_end)
    for p in range(NUMBER - 1):
        missing = (at_start[p + 1] - at_end[p + 1] - sums[p]) / (end - depth)
        for k in range(points):
            values[k, p] += missing
    return end
