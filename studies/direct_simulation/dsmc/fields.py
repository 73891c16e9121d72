"""Fields of the gas: moments of the particles in each cell."""

from typing import NamedTuple

import numpy as np

from dsmc.cells import Cells
from dsmc.compilation import kernel


class Moments(NamedTuple):
    """Sums over the particles of each cell, for compiled loops.

    Attributes
    ----------
    sums : array, shape (cells, 5)
        Particles, radial and axial velocity, square of the velocity, rotational energy.
    samples : array, shape (1,)
        How often they were summed.
    """

    sums: np.ndarray
    samples: np.ndarray


def no_moments(cells: Cells) -> Moments:
    """Nothing summed yet."""
    return Moments(np.zeros((cells.volume.size, 5)), np.zeros(1))


@kernel
def add_moments(particles, count, moments):
    """Sum over the particles once more."""
    moments.samples[0] += 1.0
    for i in range(count):
        p = particles[i]
        sums = moments.sums[p.cell]
        sums[0] += 1.0
        sums[1] += p.radial
        sums[2] += p.axial
        sums[3] += p.radial**2 + p.azimuthal**2 + p.axial**2
        sums[4] += p.rotation


def fields(moments: Moments, cells: Cells) -> dict[str, np.ndarray]:
    """Fields at the centres of the cells; not a number where nothing was met.

    Returns
    -------
    dict of str to array, shape (cells,)
        ``radius``, ``height`` [radii]; ``density``, ``temperature`` (of translation) and
        ``rotational_temperature`` over those far away; ``velocity_radial``, ``velocity_axial``
        [√(2RT_c)].
    """
    number = moments.sums[:, 0]
    number = np.where(number > 0.0, number, np.nan)
    radial, axial, square, rotation = (moments.sums[:, 1:] / number[:, None]).T
    return {
        "radius": cells.radius,
        "height": cells.height,
        "density": moments.sums[:, 0] * cells.weight / (cells.volume * moments.samples[0]),
        "temperature": (square - radial**2 - axial**2) / 1.5,  # 3/2 kT = 3/4 T/T_c
        "rotational_temperature": 2.0 * rotation,
        "velocity_radial": radial,
        "velocity_axial": axial,
    }
