"""Areas on a planet, and places as unit vectors, for which poles and date line are not special.

The frame turns with the planet: ``x`` towards latitude 0, longitude 0, ``z`` towards the north
pole.
"""

import abc
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Checked,
    GroundDistance,
    Latitude,
    Longitude,
)

_FEWEST_CORNERS = 3
_SMALLEST = sys.float_info.min
_EDGE = 1e-12  # of a unit vector, by which a corner may miss the hemisphere


class AbstractArea(Checked):
    """An area on a planet. Subclasses are final."""

    @abc.abstractmethod
    def contains(self, position: np.ndarray, planet_radius: float) -> np.ndarray:
        """Whether positions lie in the area: unit vectors in the planet's frame, shape (..., 3)."""

    @abc.abstractmethod
    def describe(self) -> str:
        """The area in a few words."""


class Circle(AbstractArea):
    """All places within a distance of one.

    Attributes
    ----------
    latitude, longitude : array
        Of its middle [deg].
    radius : array
        Along the ground [m].

    Examples
    --------
    >>> Circle(45.0, 10.0, "300 km").describe()
    'within 300 km of 45° N, 10° E'
    """

    latitude: Latitude
    longitude: Longitude
    radius: GroundDistance

    def contains(self, position: np.ndarray, planet_radius: float) -> np.ndarray:
        return self.distances(position, planet_radius) <= float(self.radius)

    def distances(self, position: np.ndarray, planet_radius: float) -> np.ndarray:
        """Distances of positions from the middle, along the ground [m], shape (...)."""
        return distances_between(position, units_of(self.latitude, self.longitude), planet_radius)

    @property
    def middle(self) -> str:
        """Where its middle is, in words."""
        return describe_place(float(self.latitude), float(self.longitude))

    def describe(self) -> str:
        return f"within {float(self.radius) / 1e3:g} km of {self.middle}"


class Polygon(AbstractArea):
    """An area between corners that are joined by the shortest ways.

    Attributes
    ----------
    latitudes, longitudes : array, shape (corners,)
        In order around the area [deg]; the last is joined to the first. Date line and poles are
        nothing special.

    Raises
    ------
    ParameterError
        If there are fewer than three corners, or they do not lie within one half of the planet.
    """

    latitudes: Latitude
    longitudes: Longitude

    def __post_init__(self) -> None:
        corners = np.shape(self.latitudes)
        if corners != np.shape(self.longitudes) or len(corners) != 1:
            raise ParameterError("a polygon needs one latitude and one longitude for each corner")
        if corners[0] < _FEWEST_CORNERS:
            raise ParameterError(f"a polygon of {corners[0]} corners has no area")
        units = units_of(self.latitudes, self.longitudes)
        if np.any(units @ _middle(units) <= _EDGE):
            raise ParameterError("the corners of a polygon must lie within one half of the planet")

    def contains(self, position: np.ndarray, planet_radius: float) -> np.ndarray:
        """Counts how often the edges wind around a position."""
        del planet_radius
        units = units_of(self.latitudes, self.longitudes)
        winding = np.zeros(position.shape[:-1])
        for corner, following in zip(units, np.roll(units, -1, axis=0), strict=True):
            # directions to both corners in the plane that touches the planet at the position
            straight = position @ np.cross(corner, following)
            along = corner @ following - (position @ corner) * (position @ following)
            winding += np.arctan2(straight, along)
        ahead = position @ _middle(units) > 0.0  # the antipodes see the same winding
        return np.asarray(ahead & (np.abs(winding) > np.pi))

    def describe(self) -> str:
        corners = zip(np.asarray(self.latitudes), np.asarray(self.longitudes), strict=True)
        return "polygon of " + "; ".join(describe_place(*map(float, corner)) for corner in corners)


def distances_between(one: np.ndarray, other: np.ndarray, planet_radius: float) -> np.ndarray:
    """Along the ground, in the unit of the radius, shape (...); unit vectors (..., 3)."""
    # by the chord, which small distances do not round away
    chord = np.linalg.norm(one - other, axis=-1)
    return np.asarray(2.0 * planet_radius * np.arcsin(np.minimum(0.5 * chord, 1.0)))


def units_of(latitude: Any, longitude: Any) -> np.ndarray:
    """Unit vectors of places in degrees, shape (..., 3)."""
    north, east = (RADIANS_PER_DEGREE * np.asarray(part, float) for part in (latitude, longitude))
    parts = np.cos(north) * np.cos(east), np.cos(north) * np.sin(east), np.sin(north)
    return np.stack(parts, axis=-1)


def _middle(units: np.ndarray) -> np.ndarray:
    """Direction of the mean of corners."""
    total = units.sum(axis=0)
    return np.asarray(total / max(float(np.linalg.norm(total)), _EDGE))


def describe_place(latitude: float, longitude: float) -> str:
    """A place in words; ``latitude``, ``longitude`` [deg]."""
    north, east = "N" if latitude >= 0.0 else "S", "E" if longitude >= 0.0 else "W"
    return f"{abs(latitude):g}° {north}, {abs(longitude):g}° {east}"


def describe_all(areas: Sequence[AbstractArea]) -> list[str]:
    """Areas in words."""
    return [area.describe() for area in areas]


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


geographic, unit_vectors = entry_point(latitude_and_longitude), entry_point(unit_vector)
"""The same of plain numbers, computed by NumPy."""


def directions(latitude: Numeric, longitude: Numeric) -> tuple[Array, Array]:
    """East and north as unit vectors, shape (..., 3); at a pole those of longitude 0."""
    sine, cosine = xp.sin(longitude), xp.cos(longitude)
    up, across = xp.sin(latitude), xp.cos(latitude)
    east = xp.broadcast_arrays(-sine, cosine, 0.0 * sine)
    north = xp.broadcast_arrays(-up * cosine, -up * sine, across)
    return xp.stack(east, axis=-1), xp.stack(north, axis=-1)


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
