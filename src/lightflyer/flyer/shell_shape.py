"""How closed flyers hold their shape: their wall under pressure and heat."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.flyer.shape import Shape, faces_of, most
from lightflyer.structure.holes import perforated_share
from lightflyer.structure.laminate import Laminate, Stiffness, flat_load, layer_stresses
from lightflyer.structure.sandwich import sandwich_stiffness
from lightflyer.structure.shells import (
    cylinder_buckling_pressure,
    rim_buckling_pressure,
    sphere_buckling_pressure,
)
from lightflyer.structure.vibrations import open_sphere_frequency, sphere_frequency

OF_SHELLS = ("stress_over_strength", "load_over_buckling", "buckling_pressure")


class Wall(NamedTuple):
    """One film, or two of them apart, that curve around a body."""

    films: Sequence[Laminate]  # From outside in
    temperatures: Sequence[Numeric]  # [K]
    open_fraction: Numeric = 0.0
    distance: Numeric = 0.0  # Between the middles of two films [m]

    @property
    def stiffness(self) -> Stiffness:
        """Of the wall with its holes."""
        outer, *inner = faces_of(self.films, self.open_fraction)
        return sandwich_stiffness(outer, inner[0], self.distance) if inner else outer

    def stress_over_strength(self, tension: Numeric) -> Array:
        """Largest stress over strength under a tension alike in all directions [N/m]."""
        # A closed wall cannot curl: both films have one length.
        share = perforated_share(self.open_fraction)
        pairs = list(zip(self.films, self.temperatures, strict=True))
        own = sum(share * flat_load(film, heat)[0] for film, heat in pairs)
        strain, none = (tension - own) / self.stiffness.stretching, xp.zeros(())
        return most(
            [
                stress / layer.strength
                for film, heat in pairs
                for layer, stress in zip(
                    film.layers,
                    layer_stresses(film, heat, (strain,) * 2, (none,) * 2, self.open_fraction),
                    strict=True,
                )
                if layer.strength is not None
            ]
        )


def shape_of_sphere(
    wall: Wall,
    radius: Numeric,
    opening: Numeric | None,
    mass: Numeric,
    pressure: Numeric,
    gas_density: Numeric,
) -> Shape:
    """Shape of a sphere; ``opening``: radius of a hole with a free rim [m], None for none.

    ``mass``: of the wall [kg]; ``pressure``: within over that outside [Pa]; ``gas_density``: of
    the gas within and around [kg/m³].
    """
    stiffness = wall.stiffness
    buckles = sphere_buckling_pressure(radius, stiffness)
    density = mass / (4.0 * np.pi * radius**2)
    frequency = sphere_frequency(
        radius, density, stiffness.membrane, stiffness.poisson, gas_density
    )
    if opening is not None:
        buckles = xp.minimum(buckles, rim_buckling_pressure(radius, opening, stiffness.plate))
        bends = open_sphere_frequency(radius, opening, density, stiffness.plate, stiffness.poisson)
        frequency = 1.0 / xp.sqrt(1.0 / frequency**2 + 1.0 / bends**2)  # Dunkerley's rule
    found = _under_pressure(wall, 0.5 * pressure * radius, buckles, pressure)
    return found._replace(lowest_frequency=frequency)


def shape_of_tube(
    wall: Wall, radius: Numeric, length: Numeric, opening: Numeric, pressure: Numeric
) -> Shape:
    """Shape of a tube or cone with one open end; ``radius``: the mean across its side [m]."""
    stiffness = wall.stiffness
    buckles = xp.minimum(
        cylinder_buckling_pressure(radius, length, stiffness),
        rim_buckling_pressure(radius, opening, stiffness.plate),
    )
    return _under_pressure(wall, pressure * radius, buckles, pressure)


def _under_pressure(wall: Wall, tension: Numeric, buckles: Array, pressure: Numeric) -> Shape:
    return Shape(
        stress_over_strength=wall.stress_over_strength(tension),
        load_over_buckling=xp.maximum(-xp.asarray(pressure), 0.0) / buckles,
        buckling_pressure=buckles,
    )
