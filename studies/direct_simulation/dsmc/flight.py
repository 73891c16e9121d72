"""Free flight for a time step: to disk and walls, into other cells, in from reservoirs and out."""

import math
from typing import NamedTuple

import numpy as np

from dsmc.cells import Cells
from dsmc.compilation import kernel
from dsmc.vessel import FLOOR, LID, PARTS, SIDE
from dsmc.walls import diffuse, leave

_NEVER = 1e30
# single precision, so that the loop over all particles stays in it
_ZERO, _ONE, _NEAREST = np.float32(0.0), np.float32(1.0), np.float32(1e-12)  # the last: to the axis


class Tally(NamedTuple):
    """What has been counted, for compiled loops.

    Attributes
    ----------
    push : array, shape (2,)
        Momentum upwards given to each face.
    heat : array, shape (2,)
        Energy taken from each face.
    entered : array, shape (3, 2)
        Upward momentum and energy that came from floor, side and lid, less what went there.
    collisions : array, shape (1,)
        Of molecules.
    particle_steps : array, shape (1,)
    """

    push: np.ndarray
    heat: np.ndarray
    entered: np.ndarray
    collisions: np.ndarray
    particle_steps: np.ndarray

    def clear(self) -> None:
        """Count anew."""
        for count in self:
            count[:] = 0.0


class Inlets(NamedTuple):
    """Pieces of reservoirs, each beside one square of the grid.

    Attributes
    ----------
    part : array, shape (n,)
        Of the vessel: floor, side or lid.
    low, high : array, shape (n,)
        Heights of the cylinder, radii of floor and lid, between which the piece lies.
    number : array, shape (n,)
        Particles that enter in a step on average.
    cell : array, shape (n,)
    """

    part: np.ndarray
    low: np.ndarray
    high: np.ndarray
    number: np.ndarray
    cell: np.ndarray


def empty_tally() -> Tally:
    """Nothing counted."""
    return Tally(np.zeros(2), np.zeros(2), np.zeros((len(PARTS), 2)), np.zeros(1), np.zeros(1))


def build_inlets(cells: Cells, duration: float) -> Inlets:
    """Inlets of gas at rest for a time step."""
    columns, rows = cells.lookup.shape
    radii = cells.square * np.arange(columns + 1)
    heights = cells.square * (np.arange(rows + 1) - cells.below)
    across = np.pi * np.diff(radii**2)
    around = 2.0 * np.pi * cells.vessel.distance[SIDE] * np.diff(heights)
    area = np.concatenate([across, around, across])
    cell = np.concatenate([cells.lookup[:, 0], cells.lookup[-1], cells.lookup[:, -1]])
    part = np.repeat([FLOOR, SIDE, LID], [columns, rows, columns])
    flux = 0.5 / math.sqrt(math.pi)  # v̄/4
    open_ = ~np.array(cells.vessel.solid)[part]
    return Inlets(
        part=part[open_],
        low=np.concatenate([radii[:-1], heights[:-1], radii[:-1]])[open_],
        high=np.concatenate([radii[1:], heights[1:], radii[1:]])[open_],
        number=(flux * duration * area / cells.weight[cell])[open_],
        cell=cell[open_],
    )


@kernel
def fly(particles, count, cells, faces, duration, tally, rng):
    """Move all particles; those that enter a cell of other weight are copied or dropped.

    Copies are put after the others, then closed up: the number of particles is returned.
    """
    kept, end = 0, count
    step, reach = np.float32(duration), np.float32(cells.vessel.distance[SIDE])
    lowest = -np.float32(cells.vessel.distance[FLOOR])
    highest = np.float32(cells.vessel.distance[LID])
    for i in range(count):
        p = particles[i]
        x, y, z = p.radius + p.radial * step, p.azimuthal * step, p.height + p.axial * step
        radius = math.sqrt(x * x + y * y)
        if radius < reach and lowest < z < highest and p.height * z > _ZERO:
            inverse = _ONE / max(radius, _NEAREST)
            radial, azimuthal = p.radial, p.azimuthal
            p.radius, p.height = radius, z
            p.radial = (radial * x + azimuthal * y) * inverse
            p.azimuthal = (azimuthal * x - radial * y) * inverse
        elif not _follow(p, cells, faces, duration, tally, rng):
            continue
        copies = _enter_cell(p, cells, rng)
        if copies > 0:
            if kept < i:
                particles[kept] = p
            kept += 1
            for _ in range(copies - 1):
                particles[end] = particles[kept - 1]
                end += 1
    for i in range(count, end):
        particles[kept] = particles[i]
        kept += 1
    return kept


@kernel
def let_in(particles, count, cells, inlets, faces, duration, tally, rng):
    """Let in gas from reservoirs, each particle at some time of the step."""
    distance = cells.vessel.distance
    for i in range(inlets.part.size):
        part = inlets.part[i]
        weight = cells.weight[inlets.cell[i]]
        for _ in range(int(inlets.number[i] + rng.random())):
            inwards, first, second, rotation = diffuse(1.0, faces.freedoms, rng)
            p = particles[count]
            p.cell, p.rotation = inlets.cell[i], rotation
            share = rng.random()
            if part == SIDE:
                p.radius = distance[SIDE]
                p.height = inlets.low[i] + share * (inlets.high[i] - inlets.low[i])
                p.radial, p.azimuthal, p.axial = -inwards, first, second
            else:
                low, high = inlets.low[i] ** 2, inlets.high[i] ** 2
                p.radius = math.sqrt(low + share * (high - low))
                upwards = 1.0 if part == FLOOR else -1.0
                p.height = -upwards * distance[part]
                p.radial, p.azimuthal, p.axial = first, second, upwards * inwards
            tally.entered[part, 0] += weight * p.axial
            tally.entered[part, 1] += weight * _energy(p)
            if _follow(p, cells, faces, duration * rng.random(), tally, rng):
                copies = _enter_cell(p, cells, rng)
                for copy in range(1, copies):
                    particles[count + copy] = p
                count += copies
    return count


@kernel
def _enter_cell(p, cells, rng):
    """Note the cell of a particle; how many of its weight stand for it there."""
    squares = 1.0 / cells.square
    column = min(int(p.radius * squares), cells.lookup.shape[0] - 1)
    row = int(p.height * squares + cells.below)
    cell = cells.lookup[column, min(max(row, 0), cells.lookup.shape[1] - 1)]
    share = cells.weight[p.cell] / cells.weight[cell]
    p.cell = cell
    return 1 if share == 1.0 else int(share + rng.random())


@kernel
def _energy(p):
    return 0.5 * (p.radial**2 + p.azimuthal**2 + p.axial**2) + p.rotation


@kernel
def _follow(p, cells, faces, time, tally, rng):
    """Move a particle that may meet the disk, a wall or a reservoir; whether it is still inside."""
    vessel = cells.vessel
    weight = cells.weight[p.cell]
    # in the frame where the particle was at azimuth 0, in double precision
    x, y, z = float(p.radius), 0.0, float(p.height)
    vx, vy, vz = float(p.radial), float(p.azimuthal), float(p.axial)
    while True:
        hit = _time_to_disk(x, y, z, vx, vy, vz)
        out, part = _time_out(x, y, z, vx, vy, vz, vessel.distance)
        if time <= min(hit, out):
            break
        before = 0.5 * (vx * vx + vy * vy + vz * vz) + p.rotation
        if hit < out:
            x, y, time = x + vx * hit, y + vy * hit, time - hit
            face = 0 if z > 0.0 else 1
            upwards = 1.0 - 2.0 * face
            radius = math.sqrt(x * x + y * y)
            normal, vx, vy, p.rotation = leave(
                faces, face, radius, weight, abs(vz), vx, vy, p.rotation, rng
            )
            tally.push[face] += weight * (vz - upwards * normal)
            z, vz = 0.0, upwards * normal
            tally.heat[face] += weight * (0.5 * (vx * vx + vy * vy + vz * vz) + p.rotation - before)
            continue
        tally.entered[part, 0] -= weight * vz
        tally.entered[part, 1] -= weight * before
        if not vessel.solid[part]:
            return False
        x, y, z, time = x + vx * out, y + vy * out, z + vz * out, time - out
        normal, first, second, p.rotation = diffuse(vessel.temperature[part], faces.freedoms, rng)
        if part == SIDE:
            inverse = 1.0 / math.sqrt(x * x + y * y)
            cosine, sine, vz = x * inverse, y * inverse, second
            vx, vy = -normal * cosine - first * sine, first * cosine - normal * sine
            x, y = vessel.distance[SIDE] * cosine, vessel.distance[SIDE] * sine
        else:
            vx, vy, vz = first, second, normal if part == FLOOR else -normal
            z = -vessel.distance[FLOOR] if part == FLOOR else vessel.distance[LID]
        tally.entered[part, 0] += weight * vz
        tally.entered[part, 1] += weight * (0.5 * (vx * vx + vy * vy + vz * vz) + p.rotation)
    x, y, z = x + vx * time, y + vy * time, z + vz * time
    radius = math.sqrt(x * x + y * y)
    inverse = 1.0 / max(radius, _NEAREST)
    p.radius, p.height, p.axial = radius, z, vz
    p.radial, p.azimuthal = (vx * x + vy * y) * inverse, (vy * x - vx * y) * inverse
    return True


@kernel
def _time_to_disk(x, y, z, vx, vy, vz):
    if z * vz >= 0.0:
        return _NEVER
    time = -z / vz
    across = (x + vx * time) ** 2 + (y + vy * time) ** 2
    return time if across < 1.0 else _NEVER


@kernel
def _time_out(x, y, z, vx, vy, vz, distance):
    """Until a straight flight ends at the vessel, and the part where."""
    time, part = _NEVER, LID
    if vz > 0.0:
        time = max((distance[LID] - z) / vz, 0.0)
    elif vz < 0.0:
        time, part = max((-distance[FLOOR] - z) / vz, 0.0), FLOOR
    square, outwards = vx * vx + vy * vy, x * vx + y * vy
    if square > 0.0:
        inside = distance[SIDE] * distance[SIDE] - x * x - y * y
        root = math.sqrt(max(outwards * outwards + square * inside, 0.0))
        aside = max((root - outwards) / square, 0.0)
        if aside < time:
            time, part = aside, SIDE
    return time, part
