"""Tracks in GPX and KML files, with the line of each fix."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple
from xml.parsers import expat

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import read_content
from lightflyer.files.table_rows import Rejected

_DEEPEST = 100  # elements within each other
_BETWEEN = " "  # a namespace and a name
_UNTIMED = ("LineString", "LinearRing", "Polygon")


class Fix(NamedTuple):
    """A fix as a file has it."""

    line: int  # Counted from 1
    time: str
    latitude: Any  # Numbers, or their texts
    longitude: Any
    altitude: Any


_Found = tuple[list[Fix], list[Rejected], list[str]]


@dataclass
class _Element:
    name: str  # Without its namespace
    attributes: dict[str, str]
    line: int
    text: str = ""
    children: list["_Element"] = field(default_factory=list)

    def all(self, name: str) -> Iterator["_Element"]:
        """Elements of a name, at any depth."""
        for child in self.children:
            if child.name == name:
                yield child
            yield from child.all(name)

    def text_of(self, name: str) -> str:
        """Text of the first child of a name, empty without one."""
        return next((child.text.strip() for child in self.children if child.name == name), "")


def read_gpx(path: Path) -> _Found:
    """Fixes of a GPX file: its track points."""
    # Source: [GPX2004]_.
    root = _parse(path, "gpx")
    points = [
        Fix(
            point.line,
            point.text_of("time"),
            point.attributes.get("lat", ""),
            point.attributes.get("lon", ""),
            point.text_of("ele"),
        )
        for point in root.all("trkpt")
    ]
    if not points:
        raise ConfigurationError(f"{path}: has no track (<trkpt>); routes and waypoints are none")
    return points, [], []


def read_kml(path: Path) -> _Found:
    """Fixes of a KML file: of its ``gx:Track``."""
    # Source: [OGC07147]_.
    root = _parse(path, "kml")
    fixes, notes = [], []
    tracks = list(root.all("Track"))
    for track in tracks:
        if track.text_of("altitudeMode") == "relativeToGround":
            raise ConfigurationError(
                f"{path}:{track.line}: altitudes above ground cannot be compared; write them "
                "above sea level, with altitudeMode absolute"
            )
        times = [one for one in track.children if one.name == "when"]
        places = [one for one in track.children if one.name == "coord"]
        if len(times) != len(places):
            raise ConfigurationError(
                f"{path}:{track.line}: gx:Track has {len(times)} <when> and {len(places)} "
                "<gx:coord>; it needs as many of one as of the other"
            )
        for time, place in zip(times, places, strict=True):
            longitude, latitude, altitude = (*place.text.split(), "", "", "")[:3]
            fixes.append(Fix(place.line, time.text.strip(), latitude, longitude, altitude))
    lines = next((one for name in _UNTIMED for one in root.all(name)), None)
    if not tracks and lines is not None:
        raise ConfigurationError(
            f"{path}:{lines.line}: <{lines.name}> has no times, without which it cannot be laid "
            "beside a flight; give a gx:Track, a GPX or a CSV file"
        )
    if not fixes:
        raise ConfigurationError(f"{path}: has no gx:Track, whose places have times")
    if len(tracks) > 1:
        notes.append(f"{len(tracks)} pieces of gx:Track are taken as one track")
    return fixes, [], notes


def _parse(path: Path, kind: str) -> _Element:
    """Root of an XML file that declares no entities: they can expand without bound."""
    parser = expat.ParserCreate(namespace_separator=_BETWEEN)
    parser.buffer_text = True
    top = _Element("", {}, 0)
    open_ones = [top]

    def refuse(*_: Any) -> None:
        raise ConfigurationError(
            f"{path}:{parser.CurrentLineNumber}: has a DOCTYPE, which is not read; delete it"
        )

    def begin(name: str, attributes: dict[str, str]) -> None:
        if len(open_ones) > _DEEPEST:
            raise ConfigurationError(
                f"{path}:{parser.CurrentLineNumber}: elements are nested too deeply"
            )
        one = _Element(name.rpartition(_BETWEEN)[2], attributes, parser.CurrentLineNumber)
        open_ones[-1].children.append(one)
        open_ones.append(one)

    def end(_: str) -> None:
        open_ones.pop()

    def say(text: str) -> None:
        open_ones[-1].text += text

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler = say
    try:
        parser.Parse(read_content(path), True)
    except expat.ExpatError as error:
        said = expat.errors.messages[error.code]
        raise ConfigurationError(f"{path}:{error.lineno}: is no XML: {said}") from None
    (root,) = top.children
    if root.name != kind:
        raise ConfigurationError(
            f"{path}:{root.line}: is no {kind.upper()} file: its first element is <{root.name}>"
        )
    return root
