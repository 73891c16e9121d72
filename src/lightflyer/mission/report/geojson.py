"""Tracks and ends of a mission as GeoJSON, for maps."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.mission.report.dataset import ends_of
from lightflyer.mission.report.kml import MOST_MEMBERS, pieces_of, places_of
from lightflyer.mission.report.summary import date_after

if TYPE_CHECKING:
    import xarray as xr

_DIGITS = 6, 6, 1  # of longitude and latitude, a tenth of a metre, and of the altitude


def write_geojson(dataset: "xr.Dataset", path: Path) -> None:
    """Write the tracks of the flights, of an ensemble the first, and all their ends."""
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
    write_collection([begin, *tracks, *ends], path)


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
