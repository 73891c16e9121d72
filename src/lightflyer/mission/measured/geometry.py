"""Distances and directions between a measured track and a flight, and a track's velocity."""

from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.entry_point import entry_point
from lightflyer.environment.planet import Planet
from lightflyer.mission.areas import units_of
from lightflyer.mission.measured.track import MeasuredTrack
from lightflyer.mission.path.position import directions

_directions = entry_point(directions)
_LOOK = 300.0  # to either side, by which the direction of a track is found [s]
_AT_REST = 0.1  # speed below which it has no direction that receivers could show [m/s]


class Apart(NamedTuple):
    """From the flight to the measured track, over ground; shape (n,) [m]."""

    distance: np.ndarray
    along: np.ndarray  # The way that the measured track goes; NaN where it is at rest
    across: np.ndarray  # To the right of it


class Moved(NamedTuple):
    """Mean velocities between moments, and where; shape (n,)."""

    east: np.ndarray  # [m/s]
    north: np.ndarray  # [m/s]
    position: np.ndarray  # Unit vectors of the middle, shape (n, 3)
    altitude: np.ndarray  # [m]


def apart(track: MeasuredTrack, flown: np.ndarray, radius: float) -> Apart:
    """How far a track is from a flight at its fixes; ``flown`` (n, 3): unit vectors."""
    measured = units_of(track.latitude, track.longitude)
    away = -_tangential(flown, measured)
    sine = np.linalg.norm(away, axis=1)
    distance = radius * np.arctan2(sine, np.sum(flown * measured, axis=1))
    away *= (distance / np.where(sine > 0.0, sine, 1.0))[:, None]
    ends = [_at(track, measured, track.time + step) for step in (-_LOOK, _LOOK)]
    course = _tangential(ends[1] - ends[0], measured)
    length = np.linalg.norm(course, axis=1)
    lasted = np.ptp([np.clip(track.time + step, *track.time[[0, -1]])
                     for step in (-_LOOK, _LOOK)], axis=0)  # fmt: skip
    moves = length * radius > _AT_REST * lasted
    course /= np.where(moves, length, np.nan)[:, None]
    right = np.cross(course, measured)
    return Apart(distance, np.sum(away * course, axis=1), np.sum(away * right, axis=1))


def moved(track: MeasuredTrack, moments: np.ndarray, planet: Planet) -> Moved:
    """Mean velocity of a track between moments [s since 2000-01-01 12:00 UTC], (n + 1,)."""
    ends = _at(track, units_of(track.latitude, track.longitude), moments)
    middle = ends[1:] + ends[:-1]
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    turned = (ends[1:] - ends[:-1]) / np.diff(moments)[:, None]
    latitude = np.arcsin(np.clip(middle[:, 2], -1.0, 1.0))
    longitude = np.arctan2(middle[:, 1], middle[:, 0])
    heights = np.interp(0.5 * (moments[1:] + moments[:-1]), track.time, track.altitude)
    ways, radii = _directions(latitude, longitude), _curvature_radii(planet, latitude)
    east, north = (
        np.sum(turned * way, axis=1) * (np.asarray(radius) + heights)
        for way, radius in zip(ways, radii, strict=True)
    )
    return Moved(east, north, middle, heights)


@entry_point
def _curvature_radii(planet: Planet, latitude: Any) -> tuple[Any, Any]:
    """Radii of the planet's curvature towards east and north [m], shape (n,)."""
    return planet.curvature_radius(latitude, 0.5 * np.pi), planet.curvature_radius(latitude, 0.0)


def _at(track: MeasuredTrack, places: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Unit vectors between the fixes, shape (m, 3)."""
    found = np.stack([np.interp(time, track.time, column) for column in places.T], axis=1)
    found /= np.linalg.norm(found, axis=1, keepdims=True)
    return found


def _tangential(vectors: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Parts of vectors (n, 3) that are perpendicular to unit vectors (n, 3)."""
    return vectors - np.sum(vectors * normal, axis=1, keepdims=True) * normal
