"""How molecules leave a face.

Each law takes the velocity with which a molecule arrives, normal to the face and in two directions
along it, and its rotational energy. It gives those with which the molecule leaves.
"""

import math
from typing import NamedTuple

import numpy as np

from dsmc.compilation import kernel

MAXWELL, ACCOMMODATED, CERCIGNANI_LAMPIS = range(3)
WALLS = {
    "maxwell": MAXWELL,
    "accommodated": ACCOMMODATED,
    "cercignani-lampis": CERCIGNANI_LAMPIS,
}
RINGS = 10
"""Rings of a face, of equal width, each with its own accommodated temperature."""

_MEMORY = 1000.0
"""Molecules over which a ring's mean energy is taken; its noise lowers the force by 1e-4."""


_AT_FIRST = 1e-6
"""Molecules of the gas far away that stand for the arrivals before the first one."""


class Faces(NamedTuple):
    """Both faces, for compiled loops.

    Attributes
    ----------
    wall : int
        One of `WALLS`.
    tac : tuple of float
        Accommodation coefficient of energy; of normal and rotational energy by Cercignani and
        Lampis.
    tangential : tuple of float
        That of tangential energy, by Cercignani and Lampis.
    temperature : tuple of float
        T_h/T_c.
    freedoms : int
        Rotational degrees of freedom.
    arriving : array, shape (2, RINGS, 2)
        Energy and number of the latest molecules to arrive, which the simulation keeps.
    """

    wall: int
    tac: tuple[float, float]
    tangential: tuple[float, float]
    temperature: tuple[float, float]
    freedoms: int
    arriving: np.ndarray


def build_faces(
    wall: str,
    tac: tuple[float, float],
    temperature: tuple[float, float],
    freedoms: int,
    tangential: tuple[float, float] | None = None,
) -> Faces:
    """Faces; `tangential` is `tac` unless given."""
    arriving = np.full((2, RINGS, 2), _AT_FIRST)
    arriving[..., 0] *= 0.25 * (4 + freedoms)  # (2 + j/2) kT_c
    return Faces(WALLS[wall], tac, tangential or tac, temperature, freedoms, arriving)


def free_molecular(faces: Faces) -> tuple[float, tuple[float, float]]:
    """Force upwards [p·A] and heat out of each face [p √(2RT_c) A] without collisions, exact.

    Maxwell's walls push with α (√T − 1)/2 on each face, the others with (√(1 + α(T − 1)) − 1)/2:
    Cercignani and Lampis's law makes a half of a Maxwellian one of another temperature.
    """
    push, heat = [], []
    for tac, tangential, temperature in zip(
        faces.tac, faces.tangential, faces.temperature, strict=True
    ):
        if faces.wall == MAXWELL:
            push.append(0.5 * tac * (math.sqrt(temperature) - 1.0))
        else:
            push.append(0.5 * (math.sqrt(1.0 + tac * (temperature - 1.0)) - 1.0))
        if faces.wall != CERCIGNANI_LAMPIS:
            tangential = tac
        energy = 0.25 * (2.0 * tac + 2.0 * tangential + faces.freedoms * tac)
        heat.append(energy * (temperature - 1.0) / math.sqrt(math.pi))
    return push[1] - push[0], (heat[0], heat[1])


@kernel
def diffuse(temperature, freedoms, rng):
    """A molecule of a wall's gas on its way out."""
    spread = math.sqrt(0.5 * temperature)
    normal = math.sqrt(temperature * rng.standard_exponential())
    first, second = spread * rng.standard_normal(), spread * rng.standard_normal()
    rotation = 0.5 * temperature * rng.standard_exponential() if freedoms > 0 else 0.0
    return normal, first, second, rotation


@kernel
def leave(faces, face, radius, weight, normal, first, second, rotation, rng):
    """A molecule as it leaves a face by the face's law; `normal` is positive before and after."""
    temperature, tac = faces.temperature[face], faces.tac[face]
    if faces.wall == MAXWELL:
        if rng.random() >= tac:
            return normal, first, second, rotation
        return diffuse(temperature, faces.freedoms, rng)
    if faces.wall == ACCOMMODATED:
        ring = min(int(radius * RINGS), RINGS - 1)
        energy = 0.5 * (normal * normal + first * first + second * second) + rotation
        arrived = faces.arriving[face, ring]
        incoming = arrived[0] / arrived[1] / (0.25 * (4 + faces.freedoms))
        arrived[0] += weight * energy - arrived[0] / _MEMORY
        arrived[1] += weight - arrived[1] / _MEMORY
        return diffuse((1.0 - tac) * incoming + tac * temperature, faces.freedoms, rng)
    along = faces.tangential[face]
    kept, spread = math.sqrt(1.0 - along), math.sqrt(0.5 * along * temperature)
    return (
        math.sqrt(_partly(normal * normal, tac, temperature, rng)),
        kept * first + spread * rng.standard_normal(),
        kept * second + spread * rng.standard_normal(),
        0.5 * _partly(2.0 * rotation, tac, temperature, rng) if faces.freedoms > 0 else 0.0,
    )


@kernel
def _partly(square, tac, temperature, rng):
    """Sum of two squares after partial accommodation, exponentially distributed at a wall.

    The two are a point in a plane that is drawn towards the origin and scattered about there
    ([Lord1991]_).
    """
    kept = math.sqrt((1.0 - tac) * square)
    scattered = math.sqrt(tac * temperature * rng.standard_exponential())
    angle = 2.0 * math.pi * rng.random()
    return kept * kept + scattered * scattered + 2.0 * kept * scattered * math.cos(angle)
