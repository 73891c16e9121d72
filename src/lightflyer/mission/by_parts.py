"""Many flights through winds of large files, of which parts are in memory one after the other.

Flights go on together in stages of some hours. In each, those that are near each other fly through
the part around them, then others through theirs.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from lightflyer.core.progress import asked_to_end, report, report_to
from lightflyer.design.setup import Setup
from lightflyer.environment.base import Place
from lightflyer.environment.wind.gridded import GriddedWind, hold, parts_at, winds_in_files
from lightflyer.mission.fleet import (
    BATCH,
    FEW,
    Flights,
    around_guide,
    fly_all,
    guide_of,
    one_of,
    take,
)
from lightflyer.mission.kept import Keep, keep_nothing
from lightflyer.mission.path.integration import Accuracy, Limits, Start, Track
from lightflyer.mission.path.motion import planet_of
from lightflyer.mission.path.position import latitude_and_longitude, unit_vector
from lightflyer.mission.path.single import follow
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.program.entry_point import entry_point
from lightflyer.pytree import tree

_places, _unit_vector = entry_point(latitude_and_longitude), entry_point(unit_vector)
_STEPS, _APART = 2.5, 1.0
"""Duration of a stage, and difference of releases that fly in one part, over the time from one
entry of the data to the next: a part has four of these or more."""

_AT_END = 1e-3  # Margin to the end of data within which a flight has met it
_FASTEST = 60.0  # Speed at which a flyer stays in its part throughout a stage [m/s]


def fly_many(
    flights: Flights,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    first: Track | None = None,
    keep: Keep = keep_nothing,
) -> Track:
    """Trajectories of flights as of :func:`~.fleet.fly_all`, whatever size their wind has."""
    if flights.together and flights.errors.waves is not None:
        guide, _ = follow(*guide_of(flights), limits, elapsed, accuracy)
        flights = around_guide(flights, guide, elapsed)
    winds = winds_in_files(flights.setup)
    if not winds or flights.count - (first is not None) <= FEW:
        return fly_all(flights, limits, elapsed, accuracy, first, keep=keep)
    radius = float(planet_of(flights.setup.environment).radius)
    fleet = _Fleet(flights, elapsed, first, radius)
    length, fleet.apart = _lengths(winds, radius)
    stages = [*_stages(elapsed, length)]
    for number, (times, kept) in enumerate(stages):
        report("flying", number, len(stages), "stages")
        left = np.flatnonzero(fleet.flying)
        while left.size and not asked_to_end():
            rows, setup = fleet.together(left, times)
            left = np.setdiff1d(left, rows)
            with report_to(lambda _: None):  # stages are reported
                fleet.advance(rows, setup, limits, times, kept, accuracy, keep)
    if asked_to_end():
        return tree.map_leaves(lambda leaf: leaf[: int(first is not None)], fleet.track)
    return fleet.track


def _lengths(winds: list[GriddedWind], radius: float) -> tuple[float, float]:
    """Duration of a stage, and difference of releases that fly together [s]."""
    length = apart = math.inf
    for store in filter(None, (wind.store for wind in winds)):
        step = float(np.diff(store.axes[0]).min(initial=math.inf))
        half = 0.5 * store.height * radius
        length = min(length, _STEPS * step, 0.5 * half / _FASTEST)
        apart = min(apart, _APART * step)
    return length, apart


def _stages(elapsed: np.ndarray, length: float) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Times of each stage, and which of those to keep each of them is; -1 for none."""
    count, spacing = len(elapsed) - 1, float(np.diff(elapsed).max())
    if spacing > length:
        pieces = math.ceil(spacing / length)
        for row in range(count):
            edges = np.linspace(elapsed[row], elapsed[row + 1], pieces + 1)
            marks = np.array([row, *[-1] * (pieces - 1), row + 1])
            for piece in range(pieces):
                yield edges[piece : piece + 2], marks[piece : piece + 2]
        return
    stages = math.ceil(count / min(count, int(length / spacing)))
    size = math.ceil(count / stages)  # alike, so that less is compiled
    for row in range(0, count, size):
        marks = np.arange(row, min(row + size, count) + 1)
        yield elapsed[marks], marks


def unflown(flights: Flights, elapsed: np.ndarray) -> Track:
    """Tracks of flights that have not begun."""
    count, starts = flights.count, flights.starts
    known: dict[str, Any] = {
        "altitude": np.full((count, elapsed.size), np.inf),
        "position": np.full((count, elapsed.size, 3), np.inf),
        "end_elapsed": np.zeros(count),
        "end_altitude": np.array(starts.altitude),
        "end_position": np.array(_unit_vector(starts.place.latitude, starts.place.longitude)),
        "termination": np.full(count, int(TerminationReason.STILL_FLYING)),
        "steps": np.zeros(count, int),
    }
    return Track(**known)


class _Fleet:
    """Flights on their way."""

    apart: float  # between releases of flights that fly together [s]
    flown: int = 0  # groups of flights in stages, which follow from those before

    def __init__(self, flights: Flights, elapsed: np.ndarray, first: Track | None, radius: float):
        self._flights, self._radius = flights, radius
        self._released = np.asarray(flights.starts.place.time)
        self.track = unflown(flights, elapsed)
        self.flying = np.ones(flights.count, bool)
        if first is not None:
            self.flying[0] = False
            for all_flights, one in zip(*map(tree.leaves, (self.track, first)), strict=True):
                all_flights[0] = one

    def together(self, left: np.ndarray, times: np.ndarray) -> tuple[np.ndarray, Setup]:
        """Flights that stay in one part of the winds throughout a stage, and the setup there."""
        begin = self._released[left].min()
        soon = left[self._released[left] <= begin + self.apart]
        position = np.asarray(self.track.end_position)[soon]
        middle = int(np.argmax(position @ position.mean(axis=0)))
        latitude, longitude = map(np.asarray, _places(position))
        there = Place(latitude[middle], longitude[middle], begin + times[0])
        setup = parts_at(self._flights.setup, there)
        north = _FASTEST * (times[-1] - times[0]) / self._radius
        east = north / np.cos(latitude)
        stay = np.ones(soon.size, bool)
        for sign, when in ((-1.0, times[0]), (1.0, times[-1])):
            moment = self._released[soon] + when
            stay &= hold(setup, Place(latitude + sign * north, longitude + sign * east, moment))
        stay[middle] = True
        return soon[stay], setup

    def advance(
        self,
        rows: np.ndarray,
        setup: Setup,
        limits: Limits,
        times: np.ndarray,
        kept: np.ndarray,
        accuracy: Accuracy,
        keep: Keep,
    ) -> None:
        """Fly a stage."""
        flights, track = self._flights, self.track
        position = np.asarray(track.end_position)[rows]
        place = Place(*_places(position), self._released[rows])
        starts = Start(np.asarray(track.end_altitude)[rows], place)
        some = replace(take(flights, rows), setup=setup, starts=starts)

        def fly() -> Track:
            found = fly_all(some, limits, times, accuracy, size=min(BATCH, flights.count))
            if len(found.end_altitude) < rows.size:  # asked to end
                return tree.map_leaves(lambda leaf: leaf[:0], found)
            for row in np.flatnonzero(left_their_part(setup, found, self._released[rows])):
                alone, _ = follow(*one_of(some, int(row)), limits, times, accuracy)
                for flown, one in zip(*map(tree.leaves, (found, alone)), strict=True):
                    flown[row] = one
            return found

        found = keep(self.flown, fly)
        self.flown += 1
        if not found.end_altitude.size:
            return
        told = kept >= 0
        for name in ("altitude", "position"):
            getattr(track, name)[np.ix_(rows, kept[told])] = getattr(found, name)[:, told]
        for name in ("end_elapsed", "end_altitude", "end_position", "termination"):
            getattr(track, name)[rows] = getattr(found, name)
        track.steps[rows] += found.steps
        self.flying[rows] = np.equal(found.termination, TerminationReason.STILL_FLYING)


def left_their_part(whole: Any, track: Track, released: Any) -> Any:
    """Whether flights ended though the data of winds from files go on, shape (...).

    ``whole``: that has the winds; ``track``: fields have the shape (...) in front.
    """
    place = Place(*_places(track.end_position), released + track.end_elapsed)
    ended = np.equal(track.termination, TerminationReason.NO_DATA)
    for wind in winds_in_files(whole):
        margins = wind.margins(track.end_altitude, place).values()
        ended = ended & (np.min([*margins], axis=0) > _AT_END)
    return ended & bool(winds_in_files(whole))
