"""Particles: where they are in a plane through the axis, and how they move in space."""

import numpy as np

from dsmc.compilation import kernel

# single precision halves the memory that each step reads; what needs more is computed in double
PARTICLE = np.dtype(
    [
        ("radius", "f4"),
        ("height", "f4"),
        ("radial", "f4"),
        ("azimuthal", "f4"),
        ("axial", "f4"),
        ("rotation", "f4"),
        ("cell", "i4"),
    ],
    align=True,
)
"""One particle: place, velocity along radius, azimuth and axis, rotational energy, cell."""


def resting_gas(cells, freedoms: int, rng: np.random.Generator) -> np.ndarray:
    """Particles of gas at rest in all cells, and room for as many again."""
    column, row = np.indices(cells.lookup.shape)
    volume = 2.0 * np.pi * cells.square**3 * (column + 0.5)
    expected = volume / cells.weight[cells.lookup]
    number = np.floor(expected + rng.random(expected.shape)).astype(int).ravel()
    count = number.sum()
    column, row = (np.repeat(index, number) for index in (column.ravel(), row.ravel()))
    particles = np.zeros(count, PARTICLE)
    between = column**2 + rng.random(count) * (2 * column + 1)
    particles["radius"] = cells.square * np.sqrt(between)
    particles["height"] = cells.square * (row - cells.below + rng.random(count))
    for name in ("radial", "azimuthal", "axial"):
        particles[name] = np.sqrt(0.5) * rng.standard_normal(count)
    if freedoms:
        particles["rotation"] = 0.5 * rng.standard_exponential(count)
    particles["cell"] = cells.lookup[column, row]
    return particles


@kernel
def sort(particles, count, first, order):
    """Particles of each cell: those at `order[first[c]]` to before `order[first[c + 1]]`."""
    first[:] = 0
    for i in range(count):
        first[particles[i].cell + 1] += 1
    for cell in range(first.size - 1):
        first[cell + 1] += first[cell]
    # counting down from the ends leaves the beginnings
    for i in range(count - 1, -1, -1):
        cell = particles[i].cell
        first[cell + 1] -= 1
        order[first[cell + 1]] = i
    for cell in range(first.size - 1):
        first[cell] = first[cell + 1]
    first[first.size - 1] = count


@kernel
def put_in_order(particles, count, order, spare):
    """Put sorted particles in their order in memory, where loops then find them faster."""
    for i in range(count):
        spare[i] = particles[order[i]]
    for i in range(count):
        particles[i] = spare[i]
        order[i] = i
