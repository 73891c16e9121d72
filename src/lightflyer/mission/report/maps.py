"""Tracks and ends of a mission for maps and globes: KML and GeoJSON."""

import json
import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.mission.path.motion import ELAPSED
from lightflyer.mission.report.dataset import SEVERAL, ends_of
from lightflyer.mission.report.landing import landings_of, outline
from lightflyer.mission.report.summary import date_after

if TYPE_CHECKING:
    import xarray as xr


_KML, _EXTENSION = "http://www.opengis.net/kml/2.2", "http://www.google.com/kml/ext/2.2"
_SECOND = 1e9  # nanoseconds
_HALF_TURN, _TURN, _POLE = 180.0, 360.0, 90.0  # degrees
_FEWEST = 3  # Corners of a polygon
_DIGITS = 6, 6, 1  # of longitude and latitude, a tenth of a metre, and of the altitude
MOST_MEMBERS = 200  # Members of an ensemble that are drawn: more lines would hide the globe


def write_kml(dataset: "xr.Dataset", path: Path) -> None:
    """Write a mission as KML: timed track, release and end, and an ensemble's tracks."""
    # Source: [OGC07147]_.
    ET.register_namespace("", _KML)
    ET.register_namespace("gx", _EXTENSION)
    root = ET.Element(_name("kml"))
    document = _add(root, "Document")
    _add(document, "name", f"lightflyer: {dataset.attrs['flyer']}")
    _add(document, "description", dataset.attrs["end"])
    known = np.isfinite(dataset.altitude.values)
    places = places_of(dataset, "")[known]
    parent = _placemark(document, "flight")
    pieces = pieces_of(np.column_stack([places, dataset[ELAPSED].values[known]]))
    if len(pieces) > 1:  # it crosses the date line
        parent = _add(parent, "MultiTrack", space=_EXTENSION)
        _add(parent, "altitudeMode", "absolute")
    for piece in pieces:
        track = _add(parent, "Track", space=_EXTENSION)
        _add(track, "altitudeMode", "absolute")
        since = np.round(_SECOND * piece[:, 3]).astype("timedelta64[ns]")
        for date in np.datetime_as_string(dataset.time.values[0] + since, unit="ms"):
            _add(track, "when", f"{date}Z")
        for place in piece[:, :3]:
            _add(track, "coord", " ".join(_coordinates_text(place)), space=_EXTENSION)
    end = (dataset.end_longitude, dataset.end_latitude, dataset.end_altitude)
    _point(document, "release", places[0])
    _point(document, f"end: {dataset.attrs['end']}", np.array([float(part) for part in end]))
    for prefix, dimension in SEVERAL:
        if f"{prefix}altitude" not in dataset:
            continue
        folder = _add(document, "Folder")
        _add(folder, "name", f"{dimension}s, at most {MOST_MEMBERS}")
        for number, line in enumerate(places_of(dataset, prefix)[:MOST_MEMBERS], start=1):
            lines = _add(_placemark(folder, f"{dimension} {number}"), "MultiGeometry")
            for piece in pieces_of(line[np.isfinite(line).all(axis=1)]):
                string = _add(lines, "LineString")
                _add(string, "altitudeMode", "absolute")
                text = " ".join(",".join(_coordinates_text(place)) for place in piece)
                _add(string, "coordinates", text)
    ET.indent(root)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def pieces_of(line: np.ndarray) -> list[np.ndarray]:
    """Parts of a line between its passes over the date line, where each ends and begins anew.

    ``line`` (n, k): longitude [deg] first, then what goes on evenly from place to place.
    """
    found, begin = [], line[:0]
    rest = line
    for place in np.flatnonzero(np.abs(np.diff(line[:, 0])) > _HALF_TURN) + 1:
        here, there = line[place - 1], line[place]
        side = np.copysign(_HALF_TURN, here[0])
        beyond = there.copy()
        beyond[0] += 2.0 * side  # the same place, as the line goes on to it
        share = (side - here[0]) / ((beyond[0] - here[0]) or 1.0)  # on it there is no way
        edge = here + share * (beyond - here)
        done = line.shape[0] - rest.shape[0]
        found.append(np.concatenate([begin, line[done:place], [edge]]))
        begin, rest = np.array([[-side, *edge[1:]]]), line[place:]
    return [*found, np.concatenate([begin, rest])]


def places_of(dataset: "xr.Dataset", prefix: str) -> np.ndarray:
    """Longitude [deg], latitude [deg] and altitude [m] along the last axis."""
    names = ("longitude", "latitude", "altitude")
    return np.stack([dataset[prefix + name].values for name in names], axis=-1)


def _coordinates_text(place: np.ndarray) -> tuple[str, str, str]:
    longitude, latitude, altitude = place
    return f"{longitude:.6f}", f"{latitude:.6f}", f"{altitude:.1f}"


def _point(document: ET.Element, name: str, place: np.ndarray) -> None:
    point = _add(_placemark(document, name), "Point")
    _add(point, "altitudeMode", "absolute")
    _add(point, "coordinates", ",".join(_coordinates_text(place)))


def _placemark(parent: ET.Element, name: str) -> ET.Element:
    found = _add(parent, "Placemark")
    _add(found, "name", name)
    return found


def _add(parent: ET.Element, name: str, text: str = "", space: str = _KML) -> ET.Element:
    found = ET.SubElement(parent, _name(name, space))
    if text:
        found.text = text
    return found


def _name(name: str, space: str = _KML) -> str:
    return f"{{{space}}}{name}"


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
    landings, areas = landings_of(dataset), []
    if landings is not None:
        for area in landings.areas:
            rings = rings_of(*outline(landings, area))
            polygons = [[np.round(ring, _DIGITS[0]).tolist()] for ring in rings]
            shape = {"type": "MultiPolygon", "coordinates": polygons}
            held = {"holds": area.share, "area_km2": area.size / 1e6}
            areas.append(feature(shape, what="area of landings", **held))
    # Source: [RFC7946]_.
    document = {"type": "FeatureCollection", "features": [begin, *areas, *tracks, *ends]}
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
