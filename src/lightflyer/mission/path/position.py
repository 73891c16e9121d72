"""Positions on a sphere as unit vectors, for which poles and date line are nothing special.

The frame turns with the planet: ``x`` towards latitude 0, longitude 0, ``z`` towards the north
pole.
"""

import sys
from typing import Any, NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp

_SMALLEST = sys.float_info.min


class Directions(NamedTuple):
    """Local directions as unit vectors in the planet's frame."""

    east: Array  # shape (..., 3); at a pole those of the meridian of longitude 0
    north: Array


def unit_vector(latitude: Numeric, longitude: Numeric) -> Array:
    """Unit vector of a place, shape (..., 3)."""
    across = xp.cos(latitude)
    return xp.stack(
        xp.broadcast_arrays(
            across * xp.cos(longitude), across * xp.sin(longitude), xp.sin(latitude)
        ),
        axis=-1,
    )


def latitude_and_longitude(position: Any) -> tuple[Array, Array]:
    """Place of a unit vector [rad]; ``position`` (..., 3); the longitude of a pole is 0."""
    x, y, z = position[..., 0], position[..., 1], position[..., 2]
    square = x**2 + y**2
    at_pole = square <= _SMALLEST
    # stand-ins, so that a derivative at the pole is a number
    across = xp.where(at_pole, 0.0, xp.sqrt(xp.where(at_pole, 1.0, square)))
    east, front = xp.where(at_pole, 0.0, y), xp.where(at_pole, 1.0, x)
    return xp.arctan2(z, across), xp.arctan2(east, front)


def directions(latitude: Numeric, longitude: Numeric) -> Directions:
    """East and north at a place."""
    sine, cosine = xp.sin(longitude), xp.cos(longitude)
    up, across = xp.sin(latitude), xp.cos(latitude)
    east = xp.broadcast_arrays(-sine, cosine, 0.0 * sine)
    north = xp.broadcast_arrays(-up * cosine, -up * sine, across)
    return Directions(xp.stack(east, axis=-1), xp.stack(north, axis=-1))


def angles_towards(
    latitude: Numeric, longitude: Numeric, of_latitude: Numeric, of_longitude: Numeric
) -> tuple[Array, Array]:
    """Angle of the great circle to another place, as components to the east and north [rad]."""
    there = unit_vector(of_latitude, of_longitude)
    to_east, to_north = directions(latitude, longitude)
    east, north = (xp.sum(there * part, axis=-1) for part in (to_east, to_north))
    ahead = xp.sum(there * unit_vector(latitude, longitude), axis=-1)
    square = east**2 + north**2
    known = square > 0.0
    # a stand-in, so that a derivative at the place itself is a number
    sine = xp.sqrt(xp.where(known, square, 1.0))
    stretch = xp.where(known, xp.arctan2(sine, ahead) / sine, 1.0)
    return stretch * east, stretch * north
