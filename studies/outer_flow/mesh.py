"""Mesh around a thin disk in oblate spheroidal coordinates, as files of OpenFOAM's ``polyMesh``.

    r = a cosh ξ cos η,    z = a sinh ξ sin η

The disk is ξ = 0, with its top face at η > 0 and its bottom face at η < 0. The coordinates are
orthogonal, and cells shrink towards the rim as the square of their distance in ξ and η: the
pressure, which is singular there as the root of the distance, is smooth in these coordinates. The
mesh is a wedge about the z axis.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

WEDGE = math.radians(1.0)
"""Angle of the wedge; the sector's plane face differs from an arc by its square over 6."""


@dataclass(frozen=True)
class Mesh:
    """Size of the mesh.

    Attributes
    ----------
    outward, around : int
        Cells away from the disk, and from one axis to the other.
    outer : float
        Radius of the outer boundary, over that of the disk.
    wall, jet : float
        How much larger the cells' steps are far away than at the disk, and at the rim than at the
        lower axis.
    """

    outward: int
    around: int
    outer: float
    wall: float = 1.0
    jet: float = 1.0

    def coordinates(self):
        """ξ and η of the mesh lines, η rising from the lower axis to the upper one."""
        xi = math.acosh(self.outer) * _graded(self.outward, self.wall)
        half = self.around // 2
        below = _graded(half, self.jet)
        above = np.linspace(0.0, 1.0, half + 1)
        eta = np.concatenate([-1.0 + below, above[1:]]) * 0.5 * math.pi
        return xi, eta


def _graded(cells, growth):
    """From 0 to 1 with steps that grow by a constant factor, ``growth`` in all."""
    if growth == 1.0:
        return np.linspace(0.0, 1.0, cells + 1)
    steps = growth ** (np.arange(cells) / (cells - 1.0))
    return np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()


def write(mesh, folder):
    """Write ``points``, ``faces``, ``owner``, ``neighbour`` and ``boundary``.

    Parameters
    ----------
    mesh : Mesh
    folder : Path
        The ``polyMesh`` to be made.

    Returns
    -------
    float
        Area of one face of the disk in the mesh, over the square of its radius.
    """
    xi, eta = mesh.coordinates()
    radius = np.cosh(xi)[:, None] * np.cos(eta)[None, :]
    height = np.sinh(xi)[:, None] * np.sin(eta)[None, :]
    radius[:, [0, -1]] = 0.0
    height[0] = 0.0
    points, front, back = _points(radius, height)
    faces, owner, neighbour, patches = _faces(mesh, front, back)
    folder.mkdir(parents=True, exist_ok=True)
    _write_list(
        folder / "points", "vectorField", [f"({x:.17g} {y:.17g} {z:.17g})" for x, y, z in points]
    )
    _write_list(folder / "faces", "faceList", [f"{len(f)}({' '.join(map(str, f))})" for f in faces])
    _write_list(folder / "owner", "labelList", owner)
    _write_list(folder / "neighbour", "labelList", neighbour)
    _write_list(folder / "boundary", "polyBoundaryMesh", patches)
    return 0.5 * math.tan(0.5 * WEDGE) * 2.0 * math.cos(0.5 * WEDGE) ** 2


def _points(radius, height):
    """Points of the two sides of the wedge; those on the axis stand once."""
    shape = radius.shape
    front = np.empty(shape, int)
    back = np.empty(shape, int)
    points = []
    cosine, sine = math.cos(0.5 * WEDGE), math.sin(0.5 * WEDGE)
    for place in np.ndindex(shape):
        r, z = radius[place], height[place]
        front[place] = len(points)
        points.append((r * cosine, -r * sine, z))
        if r > 0.0:
            back[place] = len(points)
            points.append((r * cosine, r * sine, z))
        else:
            back[place] = front[place]
    return np.array(points), front, back


def _faces(mesh, front, back):
    """Faces with owner and neighbour, in OpenFOAM's order, and its patches."""
    many, around = mesh.outward, mesh.around

    def cell(i, j):
        return j * many + i

    def outward(i, j):  # the face of ξ_i between η_j and η_j+1, its normal towards larger ξ
        return _loop(front[i, j], back[i, j], back[i, j + 1], front[i, j + 1])

    def upward(i, j):  # the face of η_j between ξ_i and ξ_i+1, its normal towards larger η
        return _loop(front[i, j], front[i + 1, j], back[i + 1, j], back[i, j])

    inner = []
    for j in range(around):
        for i in range(many):
            if i + 1 < many:
                inner.append((cell(i, j), cell(i + 1, j), outward(i + 1, j)))
            if j + 1 < around:
                inner.append((cell(i, j), cell(i, j + 1), upward(i, j + 1)))
    half = around // 2
    sides = [(i, j) for j in range(around) for i in range(many)]
    groups = (
        ("bottom", "patch", [(cell(0, j), outward(0, j)[::-1]) for j in range(half)]),
        ("top", "patch", [(cell(0, j), outward(0, j)[::-1]) for j in range(half, around)]),
        ("far", "patch", [(cell(many - 1, j), outward(many, j)) for j in range(around)]),
        ("front", "wedge", [(cell(i, j), _side(front, i, j)) for i, j in sides]),
        ("back", "wedge", [(cell(i, j), _side(back, i, j)[::-1]) for i, j in sides]),
    )
    faces = [face for _, _, face in inner]
    owner = [first for first, _, _ in inner]
    neighbour = [second for _, second, _ in inner]
    patches = []
    for name, kind, members in groups:
        patches.append(f"{name} {{ type {kind}; nFaces {len(members)}; startFace {len(faces)}; }}")
        owner += [first for first, _ in members]
        faces += [face for _, face in members]
    return faces, owner, neighbour, patches


def _loop(*corners):
    """The corners without repetition: faces at the axis are triangles."""
    return list(dict.fromkeys(int(corner) for corner in corners))


def _side(points, i, j):
    """Face of one cell on the front of the wedge, its normal outwards."""
    return _loop(points[i, j], points[i + 1, j], points[i + 1, j + 1], points[i, j + 1])


def _write_list(path: Path, kind, items):
    header = f"FoamFile {{ version 2.0; format ascii; class {kind}; object {path.name}; }}"
    path.write_text("\n".join([header, str(len(items)), "(", *map(str, items), ")", ""]), "utf-8")
