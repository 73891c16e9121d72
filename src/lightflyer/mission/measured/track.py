"""A measured track: where something was, and when."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.clock import date_text, seconds_of
from lightflyer.core.errors import ConfigurationError, LightflyerError, ParameterError
from lightflyer.core.quantity import Latitude, Longitude, Quantity, quantity_of
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.files.table_rows import Rejected
from lightflyer.mission.measured.xml_track import Fix, read_gpx, read_kml

_HEIGHT = Quantity("m", -1e3, 1e6)  # receivers show some below the sea
_KINDS = {
    "latitude": quantity_of(Latitude) or Quantity(),
    "longitude": quantity_of(Longitude) or Quantity(),
    "altitude": _HEIGHT,
}
_COLUMNS = (
    Column("time", text=True, aliases=(
        "datetime", "date_time", "timestamp", "utc", "time_utc", "utc_time", "gps_time", "when"
    )),
    Column("date", text=True, aliases=("day", "utc_date", "date_utc")),
    Column("latitude", Latitude, ("lat", "gps_latitude"), required=True, assumed_unit="deg"),
    Column(
        "longitude", Longitude, ("lon", "lng", "long", "gps_longitude"),
        required=True, assumed_unit="deg",
    ),
    Column(
        "altitude", _HEIGHT, ("alt", "height", "elevation", "ele", "gps_altitude"),
        required=True, assumed_unit="m",
    ),
)  # fmt: skip
_UNIX = re.compile(r"\d{10}(?:\d{3})?(?:\.\d+)?")
_MILLISECONDS = 13  # digits of a Unix time in them
_ZONE = re.compile(r"\s*(?:UTC|GMT)$", re.I)
_GAP, _SHORTEST_GAP = 10.0, 600.0  # over the usual time between two fixes [1]; at least [s]
_MOST_GAPS = 3  # that are named
_HOUR = 3600.0


@dataclass(frozen=True)
class MeasuredTrack(ShortRepr):
    """A measured track, in the order of time.

    Examples
    --------
    >>> track = MeasuredTrack.from_arrays(
    ...     ["2026-06-21T12:00Z", "2026-06-21T12:10Z"], [45.0, 45.1], [10.0, 10.0], [18e3, 18.2e3]
    ... )
    >>> float(track.time[1] - track.time[0])
    600.0
    """

    source: str  #: Name of the file
    time: np.ndarray  #: shape (n,); seconds since 2000-01-01 12:00 UTC, increasing [s]
    latitude: np.ndarray  #: shape (n,); [deg]
    longitude: np.ndarray  #: shape (n,); [deg]
    altitude: np.ndarray  #: shape (n,); above sea level [m]
    notes: tuple[str, ...] = ()  #: What was done to its fixes, one line each

    @classmethod
    def from_arrays(
        cls, time: Any, latitude: Any, longitude: Any, altitude: Any, source: str = "track"
    ) -> "MeasuredTrack":
        """A track from arrays of shape (n,).

        Parameters
        ----------
        time : array
            Dates in UTC, as texts or ``datetime64``, or seconds since 2000-01-01 12:00 UTC.
        latitude, longitude : array
            [deg].
        altitude : array
            Above sea level [m].
        source : str
            What to call it.

        Raises
        ------
        ParameterError
            If a number is impossible, or the arrays are of different lengths.
        """
        columns = [np.array([seconds_of(one) for one in np.asarray(time)], float)]
        for name, given in zip(_KINDS, (latitude, longitude, altitude), strict=True):
            values = np.asarray(_KINDS[name].number(name, given), float)
            _KINDS[name].check(name, values)
            columns.append(values)
        if len({column.shape for column in columns}) > 1 or columns[0].ndim != 1:
            raise ParameterError("time, latitude, longitude, altitude must be of one length")
        try:
            return _ordered(source, np.arange(1, columns[0].size + 1), np.stack(columns), "fix")
        except ConfigurationError as error:
            raise ParameterError(str(error)) from None

    @property
    def gaps(self) -> np.ndarray:
        """Places after whose fix nothing was received for long, shape (m,)."""
        apart = np.diff(self.time)
        return np.flatnonzero(apart > max(_GAP * float(np.median(apart)), _SHORTEST_GAP))


def read_track(path: str | Path) -> MeasuredTrack:
    """Read a measured track.

    Parameters
    ----------
    path : str or path
        A table (CSV, workbook) with the columns ``time``, ``latitude``, ``longitude`` and
        ``altitude``, or usual other names of them such as SondeHub's ``datetime,lat,lon,alt``;
        a GPX file; or a KML file with a ``gx:Track``. Times are UTC where they name no zone.

    Returns
    -------
    MeasuredTrack

    Raises
    ------
    ConfigurationError
        One line that names file and line.
    """
    path = Path(path)
    readers = {".gpx": read_gpx, ".kml": read_kml}
    if path.suffix.lower() == ".kmz":
        raise ConfigurationError(f"{path}: is a KMZ file; unpack it and give the KML file in it")
    reader = readers.get(path.suffix.lower(), _read_csv)
    fixes, rejected, notes = reader(path)
    found, lines = [], []
    for fix in fixes:
        numbers = _numbers(fix)
        if isinstance(numbers, str):
            rejected.append(Rejected(str(path), fix.line, numbers))
        else:
            found.append(numbers)
            lines.append(fix.line)
    if len(found) < 2:
        why = f"{min(rejected, key=lambda row: row.line)}; " if rejected else ""
        name = "" if rejected else f"{path}: "
        raise ConfigurationError(f"{why}{name}a track needs two fixes or more, has {len(found)}")
    if rejected:
        first = min(rejected, key=lambda row: row.line)
        count = f"{len(rejected)} fix{'es' * (len(rejected) > 1)} left out"
        notes.append(f"{count}: line {first.line}: {first.reason}")
    track = _ordered(str(path), np.array(lines), np.array(found, float).T, "line")
    return MeasuredTrack(**vars(track) | {"notes": (*notes, *track.notes)})


def _read_csv(path: Path) -> tuple[list[Fix], list[Rejected], list[str]]:
    table = read_table(path, _COLUMNS, preamble=False)
    days, times = (table.texts.get(name, [""] * len(table)) for name in ("date", "time"))
    if not {"date", "time"} & table.texts.keys():
        raise ConfigurationError(
            f"{table.source}: the column time is missing, such as 2026-06-21T12:00:00Z; found: "
            f"{', '.join([*table.numbers, *table.unused])}"
        )
    columns = (table.numbers[name] for name in _KINDS)
    rows = zip(table.lines, days, times, *columns, strict=True)
    fixes = [Fix(int(line), f"{day} {time}".strip(), *place) for line, day, time, *place in rows]
    return fixes, list(table.rejected), list(table.notes)


def _numbers(fix: Fix) -> tuple[float, ...] | str:
    """Time [s], latitude, longitude [deg] and altitude [m] of a fix; or what is wrong with it."""
    if not fix.time:
        return "has no time"
    text = _ZONE.sub("", fix.time)
    try:
        if _UNIX.fullmatch(text):
            whole = len(text.partition(".")[0])
            since = float(text) / (1e3 if whole == _MILLISECONDS else 1.0)
            text = str(np.datetime64(round(since * 1e3), "ms"))
        found = [float(seconds_of(text))]
    except LightflyerError:
        return f'time: "{fix.time}" is not a date in UTC such as 2026-06-21T12:00:00Z'
    for name, value in zip(_KINDS, fix[2:], strict=True):
        if value in ("", None):
            return f"has no {name}"
        try:
            number, possible = float(value), _KINDS[name]
            if not possible.lowest <= number <= possible.highest:
                possible.check(name, number)
        except ParameterError as error:
            return str(error)
        except ValueError:
            return f'{name}: "{value}" is not a number'
        found.append(number)
    if found[1] == found[2] == 0.0:
        return "is at 0° N, 0° E, where receivers are that know no place"
    return tuple(found)


def _ordered(source: str, lines: np.ndarray, columns: np.ndarray, word: str) -> MeasuredTrack:
    """A track from columns of time, latitude, longitude and altitude (4, n), and what is said."""
    notes = []
    order = np.argsort(columns[0], kind="stable")
    late = np.flatnonzero(np.diff(columns[0]) < 0.0)
    if late.size:
        first = f"{word} {lines[late[0] + 1]}"
        notes.append(f"not in the order of time ({first} is the first): sorted")
    columns, lines = columns[:, order], lines[order]
    again = np.append(False, np.diff(columns[0]) == 0.0)
    if again.any():
        elsewhere = again & np.append(False, np.any(np.diff(columns[1:]) != 0.0, axis=0))
        said = f"{again.sum()} of {again.size} times repeat another, whose fix is kept"
        if elsewhere.any():
            place = np.flatnonzero(elsewhere)[0]
            said += f"; {elsewhere.sum()} have another place ({word} {lines[place]} the first)"
        notes.append(said)
    columns = columns[:, ~again]
    if columns.shape[1] < 2:
        raise ConfigurationError(f"{source}: a track needs two fixes or more at different times")
    track = MeasuredTrack(source, *columns)
    return MeasuredTrack(**vars(track) | {"notes": (*notes, *_gap_notes(track))})


def _gap_notes(track: MeasuredTrack) -> Sequence[str]:
    if not track.gaps.size:
        return ()
    longest = sorted(track.gaps, key=lambda place: track.time[place] - track.time[place + 1])
    named = ", ".join(
        f"{(track.time[place + 1] - track.time[place]) / _HOUR:.2g} h after "
        f"{date_text(track.time[place])}"
        for place in longest[:_MOST_GAPS]
    )
    return (f"{track.gaps.size} gap{'s' * (track.gaps.size > 1)} without a fix: {named}",)
