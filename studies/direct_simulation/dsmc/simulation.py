"""The disk in its vessel, step by step."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dsmc.cells import build_cells
from dsmc.collisions import collide
from dsmc.compilation import kernel
from dsmc.fields import add_moments, fields, no_moments
from dsmc.flight import build_inlets, empty_tally, fly, let_in
from dsmc.gas import Gas
from dsmc.particles import put_in_order, resting_gas, sort
from dsmc.vessel import FLOOR, SIDE, Vessel
from dsmc.walls import Faces, free_molecular

# steps between two that put particles of a cell side by side in memory and sum over them
_TIDY = 20
_ROOM = 2.0  # particles there is room for, over those in the gas at rest


@dataclass(frozen=True)
class Numerics:
    """Discretisation.

    Attributes
    ----------
    duration : float
        Of a time step [radii/√(2RT_c)].
    width : float
        Of the cells near the disk [radii]; half that at its edge, twice further out.
    particles : float
        In such a cell at the radius of the edge.
    """

    duration: float
    width: float = 0.1
    particles: float = 20.0


@dataclass(frozen=True)
class Block:
    """Means over some steps, each over its exact value without collisions.

    Attributes
    ----------
    force : float
    force_reservoir : float
        By the momentum that enters from floor, side and lid.
    heat : float
        Of both faces.
    heat_reservoir : float
    heat_top, heat_bottom : float
    force_floor : float
        Downwards on the floor, beyond that of gas at rest, over the disk's without collisions.
    heat_floor : float
        Into the floor, over the disk's without collisions.
    force_mean, heat_mean : float
        Force [p·A] and heat of both faces [p √(2RT_c) A].
    collision_rate : float
        Collisions of molecules in unit time.
    particles : float
    """

    force: float
    force_reservoir: float
    heat: float
    heat_reservoir: float
    heat_top: float
    heat_bottom: float
    force_floor: float
    heat_floor: float
    force_mean: float
    heat_mean: float
    collision_rate: float
    particles: float


class Simulation:
    """A disk in a vessel of gas.

    Parameters
    ----------
    gas : Gas
    knudsen : float
        λ(T_c)/(2r) with λ = (μ/p) √(πRT/2); infinite without collisions.
    faces : Faces
    vessel : Vessel
    numerics : Numerics
    seed : int
    """

    def __init__(
        self,
        gas: Gas,
        knudsen: float,
        faces: Faces,
        vessel: Vessel,
        numerics: Numerics,
        seed: int = 0,
    ) -> None:
        self.faces = faces
        self.duration = numerics.duration
        self.rng = np.random.Generator(np.random.SFC64(seed))
        self.cells = build_cells(vessel, numerics.width, numerics.particles)
        self.inlets = build_inlets(self.cells, self.duration)
        self.molecule = gas.molecule(knudsen)
        gas_at_rest = resting_gas(self.cells, gas.rotational_freedoms, self.rng)
        self.count = gas_at_rest.size
        self.particles = np.zeros(int(_ROOM * self.count), gas_at_rest.dtype)
        self.particles[: self.count] = gas_at_rest
        self.order = np.empty(self.particles.size, np.int32)
        # raised as faster pairs are met
        self.fastest = np.full(self.cells.volume.size, self.molecule.cross_section)
        self.tally = empty_tally()
        self.moments = no_moments(self.cells)

    def run(self, steps: int) -> Block:
        """Go on for some steps."""
        self.tally.clear()
        self.moments.sums[:] = self.moments.samples[:] = 0.0
        self.count = march(
            self.particles,
            self.count,
            self.order,
            self.cells,
            self.inlets,
            self.faces,
            self.fastest,
            self.molecule,
            steps,
            self.duration,
            self.tally,
            self.moments,
            self.rng,
        )
        return self._block(steps)

    def fields(self) -> dict[str, np.ndarray]:
        """Fields of the gas during the latest run, see :func:`dsmc.fields.fields`."""
        return fields(self.moments, self.cells)

    def blocks(self, number: int, steps: int, warm_up: int) -> Iterator[Block]:
        """Means over blocks of some steps, after others that are not counted."""
        self.run(warm_up)
        for _ in range(number):
            yield self.run(steps)

    def _block(self, steps: int) -> Block:
        time = steps * self.duration
        force_unit = time * 0.5 * math.pi  # p·A
        push, entered = self.tally.push / force_unit, self.tally.entered / force_unit
        heat = self.tally.heat / force_unit
        floor_area = self.cells.vessel.distance[SIDE] ** 2  # over the disk's
        free_force, free_heat = free_molecular(self.faces)
        return Block(
            force=_quotient(push.sum(), free_force),
            force_reservoir=_quotient(entered[:, 0].sum(), free_force),
            heat=_quotient(heat.sum(), sum(free_heat)),
            heat_reservoir=_quotient(-entered[:, 1].sum(), sum(free_heat)),
            heat_top=_quotient(heat[0], free_heat[0]),
            heat_bottom=_quotient(heat[1], free_heat[1]),
            force_floor=_quotient(entered[FLOOR, 0] - floor_area, free_force),
            heat_floor=_quotient(-entered[FLOOR, 1], sum(free_heat)),
            force_mean=float(push.sum()),
            heat_mean=float(heat.sum()),
            collision_rate=float(self.tally.collisions[0]) / time,
            particles=float(self.tally.particle_steps[0]) / steps,
        )


def _quotient(value: float, limit: float) -> float:
    return float(value / limit) if limit else math.nan


@kernel
def march(
    particles,
    count,
    order,
    cells,
    inlets,
    faces,
    fastest,
    molecule,
    steps,
    duration,
    tally,
    moments,
    rng,
):
    """Take some time steps; the number of particles is returned."""
    first = np.zeros(cells.volume.size + 1, np.int64)
    spare = np.empty_like(particles)
    for step in range(steps):
        count = fly(particles, count, cells, faces, duration, tally, rng)
        count = let_in(particles, count, cells, inlets, faces, duration, tally, rng)
        if 1.2 * count > particles.size:
            raise MemoryError("more particles than there is room for")
        sort(particles, count, first, order)
        if step % _TIDY == 0:
            put_in_order(particles, count, order, spare)
            add_moments(particles, count, moments)
        if molecule.cross_section > 0.0:
            tally.collisions[0] += collide(
                particles, order, first, cells, fastest, duration, molecule, rng
            )
        tally.particle_steps[0] += count
    return count
