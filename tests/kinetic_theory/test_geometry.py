"""Mesh, directions, rays and speed integrals: what they integrate is known exactly."""

import os

import numpy as np
import pytest
from scipy.integrate import quad

from lightflyer.kinetic_theory.disk.operators import Quadrature, kernel_arguments
from lightflyer.kinetic_theory.grid import kernels as _kernels
from lightflyer.kinetic_theory.grid.directions import node_directions
from lightflyer.kinetic_theory.grid.interpolation import bases_at, nodes_in_eta
from lightflyer.kinetic_theory.grid.mesh import build_mesh, gauss, panel_nodes
from lightflyer.kinetic_theory.grid.rays import (
    LARGEST_DEPTH,
    LOWEST_POWER,
    MOST_CUTS,
    NUMBER,
    cut_ray,
    exit_length,
    piece_integrals,
    speed_integral,
    spheroidal,
    spline_table,
)


@pytest.mark.parametrize("boundary", [np.inf, 4.0, 1.5])
def test_nodes_lie_where_their_coordinates_say(boundary):
    mesh = build_mesh(0.9, boundary=boundary)
    for r, z, xi, eta in zip(
        mesh.radius,
        mesh.height,
        mesh.xi.ravel(),
        np.broadcast_to(mesh.eta, mesh.xi.shape).ravel(),
        strict=True,
    ):
        assert spheroidal(r * r, z) == pytest.approx((xi, eta), rel=1e-10)
    assert np.all(mesh.radius < boundary)
    assert np.all(mesh.height < boundary)
    assert mesh.face_weights.sum() == pytest.approx(1.0)
    assert mesh.face_weights @ mesh.face_radius**2 == pytest.approx(0.5)
    # nodes on common edges are there once, and those in the disk's plane lie outside it
    assert np.all(np.diff(mesh.eta) > 0.0)
    assert np.all(np.diff(mesh.xi, axis=0) > 0.0)
    assert mesh.eta[0] == 0.0
    assert np.all(mesh.xi > 0.0)


def test_nodes_of_a_panel_are_those_of_the_tables():
    """Gauss, Radau and Lobatto, Abramowitz and Stegun 25.4."""
    gauss_nodes = 0.5 + np.array([-1.0, 1.0]) / np.sqrt(12.0)
    assert panel_nodes(2, lower=False, upper=False) == pytest.approx(gauss_nodes)
    assert panel_nodes(3, lower=True, upper=True) == pytest.approx([0.0, 0.5, 1.0])
    radau = 0.5 + 0.5 * np.array([-1.0, -0.289898, 0.689898])
    assert panel_nodes(3, lower=True, upper=False) == pytest.approx(radau, abs=1e-6)
    assert panel_nodes(3, lower=False, upper=True) == pytest.approx(1.0 - radau[::-1], abs=1e-6)


@pytest.mark.parametrize("boundary", [np.inf, 4.0])
def test_fields_go_on_across_the_edges_of_panels(boundary):
    mesh = build_mesh(3.0, boundary=boundary)
    panels = kernel_arguments(mesh, 3.0, Quadrature())[1]
    values = np.random.default_rng(3).normal(size=mesh.size)
    xi_basis, eta_basis = np.empty((2, mesh.order))

    def value(xi, eta):
        i, j = bases_at(xi, eta, panels, xi_basis, eta_basis)
        block = values.reshape(-1, nodes_in_eta(panels))[i : i + mesh.order, j : j + mesh.order]
        return xi_basis @ block @ eta_basis

    for edge in mesh.xi_edges[1:-1]:
        if edge < boundary:
            assert value(edge - 1e-9, 0.3) == pytest.approx(value(edge + 1e-9, 0.3), abs=1e-5)
    for edge in mesh.eta_edges[1:-1]:
        assert value(0.3, edge - 1e-9) == pytest.approx(value(0.3, edge + 1e-9), abs=1e-5)


@pytest.mark.parametrize(("depth", "width"), [(0.0, 0.02), (0.7, 1.1), (12.0, 9.0)])
def test_a_piece_of_a_uniform_gas_emits_what_its_optical_depth_says(depth, width):
    """d/dτ θ^(p/2−1/2) J_{p+1}(τ/√θ) = −θ^(p/2−1) J_p: exact with any rule along the ray."""
    setup = kernel_arguments(build_mesh(1.0), 1.0, Quadrature(ray=2))[0][3:]
    frequencies, theta = np.array([1.3, 0.8]), 1.7
    values = np.empty((2, NUMBER))
    end = piece_integrals(
        depth, width, np.full(2, theta), frequencies, setup, np.empty((4, NUMBER)), values
    )
    shares = width * setup[0][1] * frequencies
    assert end == pytest.approx(depth + shares.sum())
    for p in range(1, NUMBER):
        at_start, at_end = (
            theta ** (0.5 * (p - 1)) * speed_integral(p + 1, np.array(z / theta**0.5))
            for z in (depth, end)
        )
        assert shares @ values[:, p - 1] == pytest.approx(at_start - at_end, abs=1e-9)


def test_kernels_are_compiled_again_after_any_change(tmp_path):
    cache = tmp_path / "__pycache__"
    cache.mkdir()
    dates = {"a.py": 50, "b.py": 100, "__pycache__/a.nbi": 90, "__pycache__/b.nbi": 110}
    for name, date in dates.items():
        (tmp_path / name).write_text("")
        os.utime(tmp_path / name, (date, date))
    _kernels.forget_stale_kernels(tmp_path)
    assert [file.name for file in cache.iterdir()] == ["b.nbi"]


@pytest.mark.parametrize(
    "point",
    [(0.5, 0.1), (0.9, 0.3), (1.2, 0.3), (3.0, 0.5), (40.0, 70.0), (1.3, 0.0), (9.0, 0.0)],
)
def test_directions_cover_the_sphere_and_find_the_disk(point):
    radius, height = point
    found = np.empty((40000, 4))
    rule = np.array(gauss(4))
    count = node_directions(radius, height, 0.1, rule, rule, found)
    x, y, z, weight = found[:count].T
    np.testing.assert_allclose(x**2 + y**2 + z**2, 1.0, rtol=1e-12)
    assert weight.sum() == pytest.approx(2.0 * np.pi, rel=1e-6)
    assert weight @ z == pytest.approx(0.0, abs=1e-5)
    assert weight @ z**2 == pytest.approx(2.0 * np.pi / 3.0, rel=1e-5)
    hit = z < 0.0
    reach = -height / z[hit]
    inside = (radius + reach * x[hit]) ** 2 + (reach * y[hit]) ** 2 < 1.0
    seen = 2.0 * (weight[hit] @ inside)
    assert seen == pytest.approx(solid_angle(radius, height), rel=2e-3)


def solid_angle(radius, height):
    """Of the unit disk, by brute force over its area."""
    s = np.polynomial.legendre.leggauss(400)
    rho, w_rho = 0.5 * (s[0] + 1.0), 0.5 * s[1]
    phi, w_phi = 0.5 * np.pi * (s[0] + 1.0), np.pi * s[1]
    x = rho[:, None] * np.cos(phi) - radius
    y = rho[:, None] * np.sin(phi)
    # ∮ form: integrate over the area after moving the weight to where the point is close
    distance = np.sqrt(x**2 + y**2 + height**2)
    return float((w_rho * rho) @ (height / distance**3) @ w_phi)


def test_a_ray_is_cut_where_it_crosses_panels():
    mesh = build_mesh(0.9)
    cuts = np.empty(MOST_CUTS)
    direction = np.array([-0.6, 0.0, -0.8])
    number, hit = cut_ray(2.0, 1.5, direction, 30.0, 1.0, mesh.xi_edges, mesh.eta_edges, cuts)
    assert hit == pytest.approx(1.5 / 0.8)
    assert np.all(np.diff(cuts[:number]) >= 0.0)
    assert (cuts[0], cuts[number - 1]) == (0.0, 30.0)
    middle = 0.5 * (cuts[: number - 1] + cuts[1:number])
    for s, start, end in zip(middle, cuts, cuts[1:number], strict=False):
        panels = {
            panel(mesh, 2.0 + t * direction[0], 1.5 + t * direction[2])
            for t in (s, start + 1e-9 * (end - start), end - 1e-9 * (end - start))
            if end - start > 1e-6
        }
        assert len(panels) <= 1


def panel(mesh, r, z):
    xi, eta = spheroidal(r * r, z)
    return (
        int(np.searchsorted(mesh.xi_edges, xi)),
        int(np.searchsorted(mesh.eta_edges, eta)),
        z > 0.0,
    )


def test_rays_end_on_the_reservoir():
    for direction in ([1.0, 0.0, 0.0], [0.6, 0.0, 0.8], [-0.6, 0.0, -0.8], [0.0, 1.0, 0.0]):
        w = np.array(direction)
        s = exit_length(0.5, 1.0, w, 4.0, 4.0, 4.0)
        end = np.array([0.5, 0.0, 1.0]) + s * w
        assert max(np.hypot(end[0], end[1]), abs(end[2])) == pytest.approx(4.0)


@pytest.mark.parametrize("power", [1, 4, 8])
@pytest.mark.parametrize("depth", [0.0, 1e-3, 0.7, 6.0, 59.0])
def test_integral_is_what_scipy_finds(power, depth):
    expected = quad(
        lambda c: c**power * np.exp(-c * c - depth / c), 0.0, 12.0, epsabs=0.0, limit=400
    )[0]
    assert speed_integral(power, np.array(depth)) == pytest.approx(expected, rel=1e-10)


def test_recurrence_of_abramowitz_and_stegun():
    z = np.linspace(0.0, 30.0, 50)
    for p in (4, 6, 8):
        right = (p - 1) * speed_integral(p - 2, z) + z * speed_integral(p - 3, z)
        np.testing.assert_allclose(2.0 * speed_integral(p, z), right, rtol=1e-9)


def test_spline_table_is_as_exact_between_its_nodes():
    table, per_unit = spline_table()
    root = np.random.default_rng(3).uniform(0.0, np.sqrt(LARGEST_DEPTH), 500)
    root[:20] *= 1e-3  # the first cell, where a logarithm is worst
    cell = (root * per_unit).astype(int)
    t = (root - cell / per_unit)[:, None]
    rows = table[cell]
    values = ((rows[:, 0] * t + rows[:, 1]) * t + rows[:, 2]) * t + rows[:, 3]
    for column in range(NUMBER):
        exact = speed_integral(column + LOWEST_POWER, root**2)
        np.testing.assert_allclose(values[:, column], exact, atol=4e-10)
