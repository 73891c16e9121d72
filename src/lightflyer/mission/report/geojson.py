"""Tracks and ends of a mission as GeoJSON, for maps."""

import json
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.mission.report.dataset import ends_of
from lightflyer.mission.report.kml import MOST_MEMBERS, pieces_of, places_of
from lightflyer.mission.report.landing import landings_of, outline
from lightflyer.mission.report.summary import date_after

if TYPE_CHECKING:
    import xarray as xr

_HALF_TURN, _TURN, _POLE = 180.0, 360.0, 90.0  # degrees
_FEWEST = 3  # Corners of a polygon
_DIGITS = 6, 6, 1  # of longitude and latitude, a tenth of a metre, and of the altitude


def write_geojson(dataset: "xr.Dataset", path: Path) -> None:
    """Write tracks of the flights, of an ensemble the first, all their ends, areas of landings."""
    tracks, ends = [], []
    for flight, number, end in ends_of(dataset):
        about = {"flight": flight, "number": number, "end": end["end_reason"]}
        place = np.array([end[f"end_{name}"] for name in ("longitude", "latitude", "altitude")])
        ends.append(feature(point(place), what="end", **about, end_elapsed_s=end["end_elapsed"]))
        if number is None or number < MOST_MEMBERS:
            prefix = {"stated": "", "member": "ensemble_"}.get(flight, f"{flight}_")
            track = places_of(dataset, prefix)
            track = track if number is None else track[number]
            known = track[np.isfinite(track).all(axis=1)]
            if len(known) == 1 or not np.array_equal(known[-1], place):
                known = np.vstack([known, place])  # it ended between two moments
            tracks.append(feature(line(known), what="track", **about))
    begin = feature(point(places_of(dataset, "")[0]), what="release", time=date_after(dataset, 0.0))
    write_collection([begin, *_areas(dataset), *tracks, *ends], path)


def _areas(dataset: "xr.Dataset") -> Iterator[dict[str, Any]]:
    """What holds shares of the landings, cut at the date line."""
    landings = landings_of(dataset)
    if landings is None:
        return
    for area in landings.areas:
        rings = rings_of(*outline(landings, area))
        polygons = [[np.round(ring, _DIGITS[0]).tolist()] for ring in rings]
        about = {"holds": area.share, "area_km2": area.size / 1e6}
        yield feature(
            {"type": "MultiPolygon", "coordinates": polygons}, what="area of landings", **about
        )


def write_collection(features: Iterable[dict[str, Any]], path: Path) -> None:
    """Write features as one file."""
    # Source: [RFC7946]_.
    document = {"type": "FeatureCollection", "features": [*features]}
    path.write_text(json.dumps(document, allow_nan=False) + "\n", encoding="utf-8")


def feature(geometry: dict[str, Any], **properties: Any) -> dict[str, Any]:
    """A geometry with what is known of it."""
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def point(place: np.ndarray) -> dict[str, Any]:
    """A place: longitude and latitude [deg], altitude [m]."""
    return {"type": "Point", "coordinates": _position(place)}


def line(places: np.ndarray) -> dict[str, Any]:
    """A line along places, shape (n, 3), which is cut where it crosses the date line."""
    pieces = [[_position(place) for place in piece] for piece in pieces_of(places)]
    if len(pieces) == 1:
        return {"type": "LineString", "coordinates": pieces[0]}
    return {"type": "MultiLineString", "coordinates": pieces}


def _position(place: np.ndarray) -> list[float]:
    return [round(float(part), digits) for part, digits in zip(place, _DIGITS, strict=True)]


def rings_of(latitude: np.ndarray, longitude: np.ndarray) -> list[np.ndarray]:
    """Closed rings between -180° and 180° of an outline (n,); each of shape (m, 2), eastward first.

    The outline runs anticlockwise around an area, which may hold a pole.
    """
    unbroken = np.unwrap(longitude, period=_TURN)
    ring = np.column_stack([unbroken, latitude])[:-1]
    turned = unbroken[-1] - unbroken[0]
    if abs(turned) > _HALF_TURN:  # around a pole: from the date line to it, and along the pole
        way = np.sign(turned)
        along = (way * ring[:, 0] + _HALF_TURN) % _TURN - _HALF_TURN
        order = np.argsort(along)
        edge = np.interp(_HALF_TURN, along[order], ring[order, 1], period=_TURN)
        ring = np.column_stack([way * along[order], ring[order, 1]])
        sides, pole = way * _HALF_TURN * np.array([1.0, 1.0, -1.0, -1.0]), way * _POLE
        ends = np.column_stack([sides, [edge, pole, pole, edge]])
        return [np.vstack([ring, ends, ring[:1]])]
    found = []
    for turn in _TURN * np.arange(-1.0, 2.0):
        piece = _cut(_cut(ring, turn + _HALF_TURN, 1.0), turn - _HALF_TURN, -1.0)
        if len(piece) >= _FEWEST:
            found.append(np.vstack([piece, piece[:1]]) - [turn, 0.0])
    return found


def _cut(ring: np.ndarray, edge: float, side: float) -> np.ndarray:
    """The part of an open ring west of a meridian, or with ``side`` -1 east of it."""
    found: list[np.ndarray] = []
    for one, other in pairwise([*ring, *ring[:1]]):
        here, there = (side * (edge - point[0]) for point in (one, other))
        if here >= 0.0:
            found.append(one)
        if here * there < 0.0:
            found.append(one + here / (here - there) * (other - one))
    return np.array(found).reshape(-1, 2)
