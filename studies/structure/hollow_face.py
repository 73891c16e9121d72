"""Free molecules at the hollow face of a curled film, a spherical cap: one molecule at a time.

Uses nothing of lightflyer; half a minute. Writes ``hollow_face.csv``: by the angle from the axis to
the rim and the face's accommodation coefficient, that of its opening.
"""

import csv
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
COUNT, SEED = 1_000_000, 1


def isotropic_flux(generator, normal):
    """Directions of molecules that leave a surface, by the cosine law."""
    count = normal.shape[0]
    sine, angle = np.sqrt(generator.random(count)), 2.0 * np.pi * generator.random(count)
    first = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.9, [[1.0, 0, 0]], [[0, 1.0, 0]]))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(normal, first)
    flat = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
    return sine[:, None] * flat + np.sqrt(1.0 - sine**2)[:, None] * normal


def hollow(rim, tac, generator):
    """Upward pressure of the hollow face on its opening, over that of a TAC of one."""
    # Molecules are followed from the opening until they leave by it. Each carries the share of its
    # excess energy that hits have given it; to first order momentum goes with half of it.
    ends = np.cos(rim)  # height of the rim; the sphere's centre is the origin, the film below
    radius = np.sin(rim) * np.sqrt(generator.random(COUNT))
    around = 2.0 * np.pi * generator.random(COUNT)
    place = np.column_stack(
        [radius * np.cos(around), radius * np.sin(around), np.full(COUNT, -ends)]
    )
    way = isotropic_flux(generator, np.broadcast_to([0.0, 0.0, -1.0], place.shape))
    energy, force = np.zeros(COUNT), 0.0
    while place.shape[0]:
        # to the sphere, from within it
        along = -np.sum(place * way, axis=1)
        far = along + np.sqrt(np.maximum(along**2 - np.sum(place**2, axis=1) + 1.0, 0.0))
        place = place + far[:, None] * way
        place /= np.linalg.norm(place, axis=1, keepdims=True)
        out = place[:, 2] > -ends  # through the opening, and on to the rest of the sphere
        force += np.sum(np.where(out, energy * np.abs(way[:, 2]), 0.0))
        place, energy = place[~out], energy[~out]
        energy = energy + tac * (1.0 - energy)
        way = isotropic_flux(generator, -place)
    return force / COUNT / (2.0 / 3.0)  # the mean cosine of the cosine law


def main():
    """All cases."""
    generator, rows = np.random.default_rng(SEED), []
    for rim in (0.1, 0.3, 0.6, 1.0, 1.5):
        opening = np.sin(rim) ** 2 / (2.0 * (1.0 - np.cos(rim)))  # over the film's area
        for tac in (0.3, 0.8):
            found = hollow(rim, tac, generator)
            rows.append((rim, tac, f"{opening:.6f}", f"{found:.5f}"))
            print(rows[-1], tac / (1.0 - (1.0 - tac) * (1.0 - opening)))
    with (HERE / "hollow_face.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("rim angle [rad]", "tac", "opening over film", "tac of the opening"))
        writer.writerows(rows)


if __name__ == "__main__":
    main()
