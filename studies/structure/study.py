"""Finite elements of films, membranes, ligaments and their heat, to test closed forms with.

Nothing here uses lightflyer. Needs scikit-fem 12; two minutes. Writes ``results.csv``: what was
solved, its parameters, and one number, which ``tests/structure`` compares with the package.
"""

import csv
from pathlib import Path

import numpy as np
import scipy.sparse as sparse
from holes import peaks  # beside this file
from scipy.sparse.linalg import eigsh, spsolve
from skfem import (
    Basis,
    BilinearForm,
    ElementLineHermite,
    ElementLineP2,
    ElementTriMorley,
    LinearForm,
    MeshLine,
    MeshTri,
    condense,
    solve,
)
from skfem.helpers import dd, ddot, dot, eye, grad, trace

HERE = Path(__file__).parent


def bending_form(poisson):
    """Energy of Kirchhoff's plate, over D."""

    @BilinearForm
    def form(w, v, _):
        curvature = dd(w)
        moment = (1 - poisson) * curvature + poisson * eye(trace(curvature), 2)
        return ddot(moment, dd(v))

    return form


# ---- a free round plate under a load on a ring -------------------------------------------------


def free_plate(poisson, ring):
    """Rise of ring and edge over the middle of a plate of R = D = P = 1; axially symmetric."""
    below = np.linspace(1e-6, ring, 121)
    mesh = MeshLine(np.concatenate([below, np.linspace(ring, 1.0, 201)[1:]]))
    basis = Basis(mesh, ElementLineHermite(), intorder=6)

    @BilinearForm
    def stiffness(w, v, at):
        r = at.x[0]
        a, b = dd(w)[0, 0], grad(w)[0] / r
        c, d = dd(v)[0, 0], grad(v)[0] / r
        return (a * c + b * d + poisson * (a * d + b * c)) * r

    @LinearForm
    def pressure(v, at):
        return v * at.x[0] / np.pi  # over 2π, as is the stiffness

    load = pressure.assemble(basis)
    dofs = basis.nodal_dofs  # values and slopes of nodes
    node = int(np.argmin(np.abs(mesh.p[0] - ring)))
    load[dofs[0, node]] -= 1.0 / (2.0 * np.pi)
    middle = int(np.argmin(mesh.p[0]))
    fixed = np.array([dofs[0, middle], dofs[1, middle]])  # and flat there
    w = solve(*condense(stiffness.assemble(basis), load, D=fixed))
    return w[dofs[0, node]], w[dofs[0, int(np.argmax(mesh.p[0]))]]


def three_points(poisson, ring):
    """Range of heights of the same plate under a third of the load at each of three points."""
    mesh = MeshTri.init_circle(7)
    basis = Basis(mesh, ElementTriMorley(), intorder=4)
    angles = 2.0 * np.pi * np.arange(3) / 3.0

    @LinearForm
    def pressure(v, _):
        return v / np.pi

    load = pressure.assemble(basis)
    for angle in angles:
        load -= basis.point_source(ring * np.array([np.cos(angle), np.sin(angle)])) / 3.0
    held = [int(np.argmin(np.hypot(*(mesh.p.T - np.array([x, y])).T)))
            for x, y in ((0.0, 0.0), (0.5, 0.0), (0.0, 0.5))]  # fmt: skip
    matrix = bending_form(poisson).assemble(basis)
    w = solve(*condense(matrix, load, D=basis.nodal_dofs[0, held]))[basis.nodal_dofs[0]]
    # by the symmetry of three its tilt is zero over the area
    corners = mesh.p[:, mesh.t]
    across = np.linalg.det(np.moveaxis(corners[:, 1:] - corners[:, :1], (0, 1, 2), (1, 2, 0)))
    area = np.bincount(mesh.t.ravel(), np.tile(np.abs(across), 3))
    level = np.column_stack([np.ones(w.size), *mesh.p])
    root = np.sqrt(area)[:, None]
    w -= level @ np.linalg.lstsq(root * level, root[:, 0] * w, rcond=None)[0]
    return np.ptp(w)


def sandwich_plate(poisson, ring, shear):
    """Rise of the edge over the middle of the free plate, which also shears: R = D = P = 1."""
    mesh = MeshLine(np.concatenate([np.linspace(1e-6, ring, 61), np.linspace(ring, 1.0, 121)[1:]]))
    rise, turn = Basis(mesh, ElementLineP2(), intorder=6), Basis(mesh, ElementLineP2(), intorder=6)

    @BilinearForm
    def bending(u, v, at):
        r = at.x[0]
        a, b, c, d = grad(u)[0], u / r, grad(v)[0], v / r
        return (a * c + b * d + poisson * (a * d + b * c)) * r + shear * u * v * r

    @BilinearForm
    def shearing(w, v, at):
        return shear * grad(w)[0] * grad(v)[0] * at.x[0]

    @BilinearForm
    def both(w, v, at):  # w the rise, v the turn of the section
        return -shear * grad(w)[0] * v * at.x[0]

    @LinearForm
    def pressure(v, at):
        return v * at.x[0] / np.pi

    load = pressure.assemble(rise)
    dofs = rise.nodal_dofs[0]
    load[dofs[int(np.argmin(np.abs(mesh.p[0] - ring)))]] -= 1.0 / (2.0 * np.pi)
    mixed = both.assemble(rise, turn)
    matrix = sparse.bmat([[shearing.assemble(rise), mixed.T], [mixed, bending.assemble(turn)]])
    inner, edge = dofs[int(np.argmin(mesh.p[0]))], dofs[int(np.argmax(mesh.p[0]))]
    fixed = np.array([inner, rise.N + turn.nodal_dofs[0, int(np.argmin(mesh.p[0]))]])
    found = solve(*condense(matrix.tocsr(), np.concatenate([load, np.zeros(turn.N)]), D=fixed))
    return found[edge]


def frequency(poisson):
    """Lowest frequency but those of a rigid body, times 2π, of a free plate of R = D = m = 1."""
    basis = Basis(MeshTri.init_circle(6), ElementTriMorley(), intorder=4)

    @BilinearForm
    def mass(w, v, _):
        return w * v

    stiffness, inertia = bending_form(poisson).assemble(basis), mass.assemble(basis)
    squares = eigsh(stiffness, k=5, M=inertia, sigma=-1.0, return_eigenvectors=False)
    return np.sqrt(np.sort(squares)[3])


# ---- plates that stretch, axially symmetric ----------------------------------------------------


def von_karman(poisson, pressure=0.0, curvature=0.0, tension=0.0, clamped=True, cells=120):
    """Rise of the edge, or sag of the middle, of a plate of R = t = E = 1.

    ``curvature``: that which its small pieces have by themselves; ``tension``: N of the flat plate,
    whose edge is held where it is clamped.
    """
    mesh = MeshLine(np.linspace(1e-6, 1.0, cells + 1))
    out, along = (
        Basis(mesh, ElementLineHermite(), intorder=8),
        Basis(mesh, ElementLineP2(), intorder=8),
    )
    bend, stretch = 1.0 / 12.0 / (1.0 - poisson**2), 1.0 / (1.0 - poisson**2)

    def strains(u, w, r):
        return grad(u)[0] + 0.5 * grad(w)[0] ** 2, u / r

    @BilinearForm
    def bending(w, v, at):
        r = at.x[0]
        a, b, c, d = dd(w)[0, 0], grad(w)[0] / r, dd(v)[0, 0], grad(v)[0] / r
        return bend * (a * c + b * d + poisson * (a * d + b * c)) * r

    @LinearForm
    def loads(v, at):
        r = at.x[0]
        own = bend * (1.0 + poisson) * curvature * (dd(v)[0, 0] + grad(v)[0] / r)
        return (pressure * v + own) * r

    def forces(at):
        first, second = strains(at["u"], at["w"], at.x[0])
        radial = stretch * (first + poisson * second) + tension
        around = stretch * (second + poisson * first) + tension
        return radial, around

    @LinearForm
    def inner_out(v, at):
        radial, _ = forces(at)
        return radial * grad(at["w"])[0] * grad(v)[0] * at.x[0]

    @LinearForm
    def inner_along(v, at):
        radial, around = forces(at)
        return radial * grad(v)[0] * at.x[0] + around * v

    @BilinearForm
    def ww(w, v, at):
        radial, _ = forces(at)
        slope = grad(at["w"])[0]
        return (radial + stretch * slope**2) * grad(w)[0] * grad(v)[0] * at.x[0]

    @BilinearForm
    def uw(u, v, at):
        slope = grad(at["w"])[0]
        return stretch * (grad(u)[0] + poisson * u / at.x[0]) * slope * grad(v)[0] * at.x[0]

    @BilinearForm
    def wu(w, v, at):
        slope = grad(at["w"])[0] * grad(w)[0]
        return stretch * slope * (grad(v)[0] * at.x[0] + poisson * v)

    @BilinearForm
    def uu(u, v, at):
        r = at.x[0]
        a, b, c, d = grad(u)[0], u / r, grad(v)[0], v / r
        return stretch * (a * c + b * d + poisson * (a * d + b * c)) * r

    n_w = out.N
    inner, edge = int(np.argmin(mesh.p[0])), int(np.argmax(mesh.p[0]))
    fixed = [out.nodal_dofs[1, inner], n_w + along.nodal_dofs[0, inner]]
    if clamped:
        fixed += [*out.nodal_dofs[:, edge], n_w + along.nodal_dofs[0, edge]]
    else:
        fixed += [out.nodal_dofs[0, inner]]
    total = n_w + along.N
    free = np.setdiff1d(np.arange(total), fixed)
    x = np.zeros(total)
    if clamped:
        size = np.sqrt(max(-4.0 * tension - 5.0, 0.1) / 3.0)  # of a buckle, to begin with
        x[out.nodal_dofs[0]] = size * (1.0 - mesh.p[0] ** 2) ** 2
        x[out.nodal_dofs[1]] = -4.0 * size * mesh.p[0] * (1.0 - mesh.p[0] ** 2)
    flat = bending.assemble(out)
    stiff = uu.assemble(along)
    steps = np.linspace(0.1, 1.0, 10) if not clamped else [1.0]
    for share in steps:
        outer = share * loads.assemble(out)
        for _ in range(200):
            state = {"w": out.interpolate(x[:n_w]), "u": along.interpolate(x[n_w:])}
            residual = np.concatenate(
                [
                    flat @ x[:n_w] + inner_out.assemble(out, **state) - outer,
                    inner_along.assemble(along, **state),
                ]
            )
            slope = sparse.bmat(
                [
                    [flat + ww.assemble(out, **state), uw.assemble(along, out, **state)],
                    [wu.assemble(out, along, **state), stiff],
                ]
            ).tocsc()
            step = spsolve(slope[free][:, free], -residual[free])
            largest = np.abs(step).max()
            x[free] += step * min(1.0, 0.5 / largest)
            if largest < 1e-8 * (1.0 + np.abs(x).max()):
                break
        else:
            raise RuntimeError("not converged")
    w = x[out.nodal_dofs[0]]
    return w[inner] - w[edge] if clamped else w[edge] - w[inner]


# ---- how a film holds the end of a post --------------------------------------------------------


def ring_mesh(outer, share, sectors=96, rings=28):
    """Mesh between a circle of radius ``share`` and an outline ``outer(angle)``."""
    angles = np.linspace(0.0, 2.0 * np.pi, sectors, endpoint=False)
    ways = np.linspace(0.0, 1.0, rings + 1) ** 1.5
    points = []
    for way in ways:
        radius = share + way * (outer(angles) - share)
        points.append(np.array([radius * np.cos(angles), radius * np.sin(angles)]))
    p = np.concatenate(points, axis=1)
    cells = []
    for ring in range(rings):
        for k in range(sectors):
            a, b = ring * sectors + k, ring * sectors + (k + 1) % sectors
            c, d = a + sectors, b + sectors
            cells += [(a, b, c), (b, d, c)]
    return MeshTri(p, np.array(cells).T)


def root(share, outline="clamped circle", poisson=0.24):
    """Moment over angle and D of a rigid post in a film; ``share``: its radius over the cell's."""
    if outline == "clamped circle":
        outer = lambda angle: np.ones_like(angle)  # noqa: E731
    else:  # a square of the area of a circle of radius 1
        half = 0.5 * np.sqrt(np.pi)
        outer = lambda angle: half / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))  # noqa: E731
    mesh = ring_mesh(outer, share)
    basis = Basis(mesh, ElementTriMorley(), intorder=4)
    matrix = bending_form(poisson).assemble(basis)
    x = np.zeros(basis.N)
    nodes, facets = basis.nodal_dofs[0], basis.facet_dofs[0]
    middle = mesh.p[:, mesh.facets].mean(axis=1)
    rim = mesh.boundary_facets()
    inside = rim[np.hypot(*middle[:, rim]) < 1.05 * share]
    outside = np.setdiff1d(rim, inside)
    first, last = np.unique(mesh.facets[:, inside]), np.unique(mesh.facets[:, outside])
    # w = x on the post; Morley's unknown of a facet is the derivative along its normal
    x[nodes[first]] = mesh.p[0, first]
    tangent = mesh.p[:, mesh.facets[1]] - mesh.p[:, mesh.facets[0]]
    normals = basis_normals(mesh, tangent)
    x[facets[inside]] = normals[0, inside]
    fixed = [nodes[first], facets[inside]]
    if outline == "clamped circle":
        fixed += [nodes[last], facets[outside]]
    else:
        across = outside[np.abs(np.abs(middle[0, outside]) - half) < 1e-3]
        level = np.setdiff1d(outside, across)
        fixed += [nodes[np.unique(mesh.facets[:, across])], facets[level]]
    fixed = np.unique(np.concatenate(fixed))
    w = solve(*condense(matrix, np.zeros(basis.N), x=x, D=fixed))
    return w @ (matrix @ w)


def basis_normals(mesh, tangent):
    """Normals that scikit-fem gives facets: those of the first cell of each."""
    normal = np.array([tangent[1], -tangent[0]]) / np.hypot(*tangent)
    cells = mesh.f2t[0]
    middle = mesh.p[:, mesh.facets].mean(axis=1)
    outward = middle - mesh.p[:, mesh.t[:, cells]].mean(axis=1)
    return normal * np.sign((normal * outward).sum(axis=0))


# ---- the heat of posts -------------------------------------------------------------------------


def posts_heat(share, spread, posts, rings=60):
    """Heat through a post over that between films of one temperature each; axially symmetric.

    Lengths are over the cell's radius and conductances per area over that of the gas between the
    films. ``spread``: of the film's sheet, k t/(G b²); ``posts``: of the posts, alone. Only the
    lower film is heated; each film loses the same conductance to the outside as passes the gas.
    """
    mesh = MeshLine(share + (1.0 - share) * np.linspace(0.0, 1.0, rings + 1) ** 1.5)
    basis = Basis(mesh, ElementLineP2(), intorder=6)

    @BilinearForm
    def sheet(t, v, at):
        return spread * dot(grad(t), grad(v)) * at.x[0]

    @BilinearForm
    def mass(t, v, at):
        return t * v * at.x[0]

    @LinearForm
    def one(v, at):
        return v * at.x[0]

    own, gas, light = sheet.assemble(basis), mass.assemble(basis), one.assemble(basis)
    count = basis.N
    joint = sparse.lil_matrix((count, count))
    inner = basis.nodal_dofs[0, int(np.argmin(mesh.p[0]))]
    joint[inner, inner] = 0.5 * posts  # posts π b² over 2π, as all forms
    lower = own + 2.0 * gas + joint
    matrix = sparse.bmat([[lower, -gas - joint], [-gas - joint, lower]]).tocsc()
    t = spsolve(matrix, np.concatenate([light, np.zeros(count)]))
    bottom, top = t[:count], t[count:]
    area = float(np.sum(light))
    mean = float(light @ (bottom - top)) / area
    return (bottom[inner] - top[inner]) / mean


def main():
    """Solve everything."""
    rows = []
    for poisson in (0.24, 0.38):
        for ring in (1e-3, 0.1, 0.5, 0.8):
            on_ring, edge = free_plate(poisson, ring)
            rows.append(("free plate", poisson, ring, edge))
            rows.append(("ring of a free plate", poisson, ring, on_ring))
    for ring in (0.3, 0.5, 0.6, 0.7):
        rows.append(("three points", 0.24, ring, three_points(0.24, ring)))
    for pressure in (1e-2, 1.0, 10.0, 100.0, 1e4):
        rows.append(("clamped", pressure, 0.0, von_karman(0.24, pressure)))
    for tension in (0.1, 1.0, 10.0):
        rows.append(("clamped", 1.0, tension, von_karman(0.24, 1.0, tension=tension)))
    for tension in (-4.0, -20.0):
        rows.append(("clamped", 1e-3, tension, von_karman(0.24, 1e-3, tension=tension)))
    for curvature in (0.1, 1.0, 2.0, 4.0, 4.8):
        found = von_karman(0.38, curvature=curvature, clamped=False)
        rows.append(("dish", 0.38, curvature, found))
    for share in (0.05, 0.1, 0.2, 0.4):
        for outline in ("clamped circle", "square cell"):
            rows.append((f"root in {outline}", share, 0.0, root(share, outline)))
    for share in (0.01, 0.1, 0.3, 0.5, 0.6):
        alike, one, stiff = peaks(share)
        rows.append(("holes pulled alike", share, 0.24, alike))
        rows.append(("holes pulled in one direction", share, 0.24, one))
        rows.append(("stiffness with holes", share, 0.24, stiff))
    for ring in (0.1, 0.5):
        for shear in (1.0, 10.0, 1e3):
            rows.append(("sandwich plate", ring, shear, sandwich_plate(0.24, ring, shear)))
    for poisson in (0.24, 0.38):
        rows.append(("frequency", poisson, 0.0, frequency(poisson)))
    for spread in (0.03, 0.1, 0.3, 1.0, 3.0, 10.0):
        rows.append(("heat of posts", 0.1, spread, posts_heat(0.1, spread, 0.1)))
    with (HERE / "results.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("problem", "first", "second", "result"))
        writer.writerows((*row[:3], f"{row[3]:.8g}") for row in rows)


if __name__ == "__main__":
    main()
