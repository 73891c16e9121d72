"""Collisions of variable hard spheres, chosen without time counter."""

import math

from dsmc.compilation import kernel


@kernel
def collide(particles, order, first, cells, fastest, duration, molecule, rng):
    """Let the particles of each cell collide for a time step.

    Of all pairs of a cell as many are looked at as would collide if all did at the cell's
    largest rate; each collides in proportion to its own rate ([Bird1994]_, no time counter).

    Parameters
    ----------
    particles, order, first
        Particles sorted by cell.
    cells : Cells
    fastest : array, shape (cells,)
        Largest cross-section times relative speed met in each cell; raised where exceeded.
    duration : float
    molecule : Molecule
    rng : numpy.random.Generator

    Returns
    -------
    float
        Collisions of molecules.
    """
    collisions = 0.0
    for cell in range(cells.volume.size):
        start = first[cell]
        inside = first[cell + 1] - start
        density = cells.weight[cell] / cells.volume[cell]
        pairs = 0.5 * inside * (inside - 1) * density * fastest[cell] * duration
        for _ in range(int(pairs + rng.random())):
            one = int(rng.random() * inside)
            two = int(rng.random() * (inside - 1))
            if two >= one:
                two += 1
            a, b = particles[order[start + one]], particles[order[start + two]]
            square = (
                (a.radial - b.radial) ** 2
                + (a.azimuthal - b.azimuthal) ** 2
                + (a.axial - b.axial) ** 2
            )
            rate = molecule.cross_section * square**molecule.exponent
            if rng.random() * fastest[cell] < rate:
                _scatter(a, b, _relative_speed(a, b, square, molecule, rng), rng)
                collisions += cells.weight[cell]
            fastest[cell] = max(fastest[cell], rate)
    return collisions


@kernel
def _relative_speed(a, b, square, molecule, rng):
    """Relative speed of a pair after both have had the chance to exchange rotational energy.

    Larsen and Borgnakke: an exchanging molecule's rotation and the relative motion share their
    energy as in equilibrium. With two freedoms the share is a power of a uniform number.
    """
    if molecule.exchange == 0.0:
        return math.sqrt(square)
    energy = 0.25 * square
    for partner in (a, b):
        if rng.random() < molecule.exchange:
            total = energy + partner.rotation
            energy = total * rng.random() ** (1.0 / molecule.split)
            partner.rotation = total - energy
    return 2.0 * math.sqrt(energy)


@kernel
def _scatter(a, b, speed, rng):
    """Turn the relative velocity of a pair to any direction alike."""
    along = 0.5 * speed * (2.0 * rng.random() - 1.0)
    across = math.sqrt(max(0.25 * speed * speed - along * along, 0.0))
    angle = 2.0 * math.pi * rng.random()
    radial, azimuthal = across * math.cos(angle), across * math.sin(angle)
    for_radial = 0.5 * (a.radial + b.radial)
    for_azimuthal = 0.5 * (a.azimuthal + b.azimuthal)
    for_axial = 0.5 * (a.axial + b.axial)
    a.radial, b.radial = for_radial + radial, for_radial - radial
    a.azimuthal, b.azimuthal = for_azimuthal + azimuthal, for_azimuthal - azimuthal
    a.axial, b.axial = for_axial + along, for_axial - along
