"""A mission's track as KML, for globes such as Google Earth."""

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.mission.report.dataset import ELAPSED, SEVERAL

if TYPE_CHECKING:
    import xarray as xr

_KML, _EXTENSION = "http://www.opengis.net/kml/2.2", "http://www.google.com/kml/ext/2.2"
_HALF_A_TURN = 180.0  # degrees
_SECOND = 1e9  # nanoseconds
MOST_MEMBERS = 200  # Members of an ensemble that are drawn: a globe does not bear more lines


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
    _track(_placemark(document, "flight"), dataset, places, known)
    end = (dataset.end_longitude, dataset.end_latitude, dataset.end_altitude)
    _point(document, "release", places[0])
    _point(document, f"end: {dataset.attrs['end']}", np.array([float(part) for part in end]))
    for prefix, dimension in SEVERAL:
        if f"{prefix}altitude" in dataset:
            _lines(document, dataset, prefix, dimension)
    ET.indent(root)
    ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _track(
    placemark: ET.Element, dataset: "xr.Dataset", places: np.ndarray, known: np.ndarray
) -> None:
    """The timed track, in pieces where it crosses the date line."""
    pieces = pieces_of(np.column_stack([places, dataset[ELAPSED].values[known]]))
    parent = placemark
    if len(pieces) > 1:
        parent = _add(placemark, "MultiTrack", space=_EXTENSION)
        _add(parent, "altitudeMode", "absolute")
    for piece in pieces:
        track = _add(parent, "Track", space=_EXTENSION)
        _add(track, "altitudeMode", "absolute")
        since = np.round(_SECOND * piece[:, 3]).astype("timedelta64[ns]")
        for date in np.datetime_as_string(dataset.time.values[0] + since, unit="ms"):
            _add(track, "when", f"{date}Z")
        for place in piece[:, :3]:
            _add(track, "coord", " ".join(_coordinates_text(place)), space=_EXTENSION)


def _lines(document: ET.Element, dataset: "xr.Dataset", prefix: str, dimension: str) -> None:
    """Lines of further flights, in a folder."""
    folder = _add(document, "Folder")
    _add(folder, "name", f"{dimension}s, at most {MOST_MEMBERS}")
    for number, line in enumerate(places_of(dataset, prefix)[:MOST_MEMBERS], start=1):
        pieces = _add(_placemark(folder, f"{dimension} {number}"), "MultiGeometry")
        for piece in pieces_of(line[np.isfinite(line).all(axis=1)]):
            string = _add(pieces, "LineString")
            _add(string, "altitudeMode", "absolute")
            text = " ".join(",".join(_coordinates_text(place)) for place in piece)
            _add(string, "coordinates", text)


def pieces_of(line: np.ndarray) -> list[np.ndarray]:
    """Parts of a line between its passes over the date line, where each ends and begins anew.

    ``line`` (n, k): longitude [deg] first, then what goes on evenly from place to place.
    """
    found, begin = [], line[:0]
    rest = line
    for place in np.flatnonzero(np.abs(np.diff(line[:, 0])) > _HALF_A_TURN) + 1:
        here, there = line[place - 1], line[place]
        side = np.copysign(_HALF_A_TURN, here[0])
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
