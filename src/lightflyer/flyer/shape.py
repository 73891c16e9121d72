"""How flyers of films with known layers hold their shape under stress, heat and loads."""

from collections.abc import Sequence
from functools import reduce
from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.structure.curl import Curl, curl_of_film
from lightflyer.structure.laminate import (
    Laminate,
    Stiffness,
    flat_load,
    free_curvature,
    free_strain,
    laminate_stiffness,
    layer_stresses,
)
from lightflyer.structure.plates import (
    clamped_deflection,
    free_plate_heights,
    load_curvature,
    shear_heights,
)
from lightflyer.structure.sandwich import (
    Ligaments,
    ligament_shear_stiffness,
    perforated_share,
    sandwich_stiffness,
)

HOLD = 0.01
"""Radius over the flyer's of what holds a payload in its middle: a drop of glue [1]."""


class Shape(NamedTuple):
    """How a flyer holds its shape."""

    curvature: Numeric  #: The larger of the principal curvatures [1/m]; its edge rises if positive
    deflection: Numeric  #: How far its edge is from the height of its middle, at most [m]
    #: Largest tension in a layer over what it bears [1]; NaN where no layer's strength is known
    stress_over_strength: Numeric
    #: Share of the gap by which two membranes come closer between ligaments [1]
    gap_closed: Numeric = 0.0


def shape_of_film(
    film: Laminate,
    radius: Numeric,
    temperature: Numeric,
    load: Numeric,
    hanging: Numeric | None = None,
) -> Shape:
    """Shape of a round film; its payload [N] hangs from a circle of a radius ``hanging`` [m]."""
    stiffness, strain = laminate_stiffness(film), free_strain(film, temperature)
    curl = curl_of_film(free_curvature(film, temperature), stiffness, radius)
    plate = stiffness.plate, stiffness.poisson
    ring = _ring(hanging, HOLD * radius)
    bent = load_curvature(load, radius, ring, *plate)
    curvatures = curl.largest + bent, curl.smallest + bent
    droop = _range(free_plate_heights(load, radius, ring, *plate))
    stresses = layer_stresses(film, temperature, (strain, strain), curvatures)
    return Shape(curl.largest, _rise(curl, droop, radius), _most_strained([film], [stresses]))


class Core(NamedTuple):
    """What holds two films apart."""

    shear: Numeric  # Shear stiffness of the whole [N/m]
    free_radius: Numeric  # Of the widest circle of film that it leaves free [m]
    spacing: Numeric  # Between its parts [m]


def core_of_posts(
    ligaments: Ligaments, films: Sequence[Laminate], gap: Numeric, open_fraction: Numeric
) -> Core:
    """Posts between films with holes; these hold the posts' ends."""
    shear = ligament_shear_stiffness(ligaments, gap, *_faces(films, open_fraction))
    return Core(shear, ligaments.free_radius, ligaments.spacing)


def shape_of_sandwich(
    films: Sequence[Laminate],
    temperatures: Sequence[Numeric],
    core: Core,
    gap: Numeric,
    open_fraction: Numeric,
    radius: Numeric,
    load: Numeric,
    pressure: Numeric,
    hanging: Numeric | None = None,
) -> Shape:
    """Shape of two membranes with holes and a core; films and temperatures are top and bottom.

    ``load``: weight of the payload [N]; ``pressure``: of the lift, borne by either membrane [Pa];
    ``hanging``: radius of the circle from which the payload hangs [m].
    """
    share = perforated_share(open_fraction)
    top, bottom = faces = _faces(films, open_fraction)
    thick = sum(layer.thickness for layer in films[1].layers)
    distance = gap + thick - bottom.neutral + top.neutral
    whole = sandwich_stiffness(top, bottom, distance)
    arms = distance - whole.neutral, -whole.neutral  # heights over what bending does not strain
    loads = [flat_load(film, heat) for film, heat in zip(films, temperatures, strict=True)]
    tensions = [share * tension for tension, _ in loads]
    moment = sum(
        share * own + tension * arm
        for (_, own), tension, arm in zip(loads, tensions, arms, strict=True)
    )
    curl = curl_of_film(moment / whole.bending, whole, radius)
    ring = _ring(hanging, jnp.maximum(core.spacing, HOLD * radius))
    bent_by_one = free_plate_heights(1.0, radius, ring, whole.plate, whole.poisson)
    sheared = shear_heights(1.0, radius, ring, core.shear)
    together = _range([one + other for one, other in zip(bent_by_one, sheared, strict=True)])
    alone = _range(free_plate_heights(1.0, radius, ring, top.plate + bottom.plate, whole.poisson))
    droop = load / (1.0 / together + 1.0 / alone)
    bent = load_curvature(load, radius, ring, whole.plate, whole.poisson)
    curvatures = curl.largest + bent, curl.smallest + bent
    mean = -sum(tensions) / whole.stretching
    stresses, closed = [], jnp.zeros(())
    for film, face, heat, arm, tension in zip(
        films, faces, temperatures, arms, tensions, strict=True
    ):
        strains = tuple(mean - curvature * arm for curvature in curvatures)
        stresses.append(layer_stresses(film, heat, strains, curvatures))
        held = tension + face.stretching * 0.5 * (strains[0] + strains[1])
        closed = closed + clamped_deflection(pressure, core.free_radius, face, held)
    return Shape(
        curl.largest, _rise(curl, droop, radius), _most_strained(films, stresses), closed / gap
    )


def _ring(hanging: Numeric | None, least: Numeric) -> Numeric:
    """Radius of the circle from which a payload hangs [m]."""
    return least if hanging is None else jnp.maximum(hanging, least)


def _range(heights: Sequence[Array]) -> Array:
    """Largest difference between the heights of middle, ring and edge [m]; middle: zero."""
    ring, edge = heights
    highest, lowest = jnp.maximum(ring, edge), jnp.minimum(ring, edge)
    return jnp.maximum(highest, 0.0) - jnp.minimum(lowest, 0.0)


def _rise(curl: Curl, droop: Numeric, radius: Numeric) -> Array:
    """How far the edge is from the height of the middle, at most the radius [m]."""
    # Curl and droop add up though one may be upward and the other downward: their forms differ. Of
    # an arc this is within 3 % up to where its ends stand upright.
    shallow = 0.5 * jnp.abs(curl.largest) * radius**2 + droop
    return shallow / jnp.sqrt(1.0 + (shallow / radius) ** 2)


def _faces(films: Sequence[Laminate], open_fraction: Numeric) -> list[Stiffness]:
    """Stiffness of films with holes."""
    share = perforated_share(open_fraction)
    whole = [laminate_stiffness(film) for film in films]
    return [Stiffness._make([*(share * part for part in one[:-1]), one[-1]]) for one in whole]


def _most_strained(films: Sequence[Laminate], stresses: Sequence[tuple[Array, ...]]) -> Array:
    """Largest tension over strength [1]."""
    shares = [
        stress / layer.strength
        for film, row in zip(films, stresses, strict=True)
        for layer, stress in zip(film.layers, row, strict=True)
        if layer.strength is not None
    ]
    return reduce(jnp.maximum, shares) if shares else jnp.full((), jnp.nan)
