"""Weather files that stay on the disk, of which a window is in memory.

The window reaches around all places that were asked for: it is widened where one lies beside it. At
its nodes it has what all files in memory would have there: the altitudes of all levels are found
once, when the files are opened.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.progress import report
from lightflyer.environment.base import Place
from lightflyer.environment.wind.base import near_poles, next_to
from lightflyer.environment.wind.dataset import (
    PLACING,
    WindFields,
    WindGrid,
    dimensions_of,
    grid_of,
    heights_of,
    read_fields,
    read_grid,
    readers_of,
    require_finite,
    winds_on,
)
from lightflyer.environment.wind.heights import new_levels
from lightflyer.environment.wind.layouts import load_parts, one_version, open_parts, weather_files
from lightflyer.numerics.interpolation import Axis

KEPT = 2_500_000  # Most points of a variable of files that are in memory as a whole
LARGEST_WINDOW = 40_000_000
"""Most points of a window: 2 GB with the air, and as much again while it is read."""

_ROOM = 4  # nodes around what is asked for, at least
_FEWEST_LEVELS = 2  # of a file
_TURN = 2.0 * np.pi

_Ranges = tuple[range, range, range, range]  # of nodes along time, level, latitude, longitude
_Window = tuple[range, range, range]  # the same without levels, all of which it has
_Table = tuple[np.ndarray, tuple[Axis, Axis, Axis, Axis]]


def open_wind(path: str | Path) -> "WindGrid | WindStore":
    """Winds of files: in memory where there is room for them."""
    files = open_parts(path)
    sizes = (max((field.size for field in file.data_vars.values()), default=0) for file in files)
    if sum(sizes) <= KEPT or not all("longitude" in file.dims for file in files):
        dataset = load_parts(path, files)
        for file in files:
            file.close()
        return read_grid(dataset)
    return WindStore(path, files)


def changes_of(path: str | Path) -> tuple[int, ...]:
    """When files were written, which tells them from what they were before."""
    return tuple(Path(file).stat().st_mtime_ns for file in weather_files(path))


class WindStore:
    """Winds of files that stay on the disk; equal to any other of the same files."""

    def __init__(self, path: str | Path, files: list[Any]):
        self.path, self._files = str(path), files
        self.key = self.path, changes_of(path)
        self._lock = Lock()  # of what follows: the window, and the tables of its times
        self._window: _Window | None = None
        self._tables: dict[int, np.ndarray] = {}
        self._beside: list[Axis] = []  # axes of levels, latitudes and longitudes
        self._whole: _Table | None = None
        names = dimensions_of(one_version(files[0]), str(next(iter(files[0].data_vars))))
        by_pressure = "pressure" in names
        kinds = ("time", "pressure" if by_pressure else "altitude", "latitude", "longitude")
        self._order = [names.get(kind) for kind in kinds]
        self._own = [  # coordinates of each file
            [np.zeros(1) if name is None else reader(file[name]) for file in files]
            for name, reader in zip(self._order, readers_of(by_pressure=by_pressure), strict=True)
        ]
        if any(not np.array_equal(own[0], one) for own in self._own[2:] for one in own):
            raise ConfigurationError(
                f"{path}: these files do not share one grid: their latitudes or longitudes differ"
            )
        source = [np.unique(np.concatenate(own)) for own in self._own]
        if source[3][-1] - source[3][0] > _TURN - 1e-6:  # 0° and 360° are both there
            source[3] = source[3][:-1]
        self._source = source
        width = source[3][-1] - source[3][0] + 1.01 * np.diff(source[3]).max()
        self.around = bool(width >= _TURN)
        # at which a table of all meridians goes on over the pole
        self.near_poles = near_poles(source[2]) if self.around else (False, False)
        there = {str(name) for file in files for name in file.data_vars}
        self.rises = "w" in there
        self._air = [name for name in PLACING if name in there][:1]
        times, levels, rows, columns = self._all
        self._first_level = 0  # the lowest that no mountain reaches
        for level in levels[:-_FEWEST_LEVELS]:
            found = self._select((times[:1], range(level, level + 1), rows, columns))
            if all(np.isfinite(field.values).all() for field in found.data_vars.values()):
                self._first_level = level
                break
        highest = self._fields((times[:1], levels[-_FEWEST_LEVELS:], rows[:2], columns))
        altitude, self.told = heights_of(highest)
        self.has_air = altitude is not None and "temperature" in there
        self.by_pressure = by_pressure and altitude is None
        self.axes = [source[0], source[1][self._first_level :], *source[2:]]
        if altitude is not None:
            # our levels, between which all columns have data at all times: those of
            # :func:`read_grid` for all files at once
            levels = levels[self._first_level :]
            blocks = [*self._heights(times[:1], levels)]
            means = [block[0].mean(axis=(1, 2)) for block in blocks]
            mean = np.average(means, axis=0, weights=[block.shape[2] for block in blocks])
            # by temperature an altitude follows from all levels below
            by_temperature = self._air == [PLACING[-1]]
            ends = levels if by_temperature else levels[:: len(levels) - 1]
            low, high = -np.inf, np.inf
            for block in self._heights(times, ends):
                low, high = max(low, block[:, 0].max()), min(high, block[:, -1].min())
            self.axes[1] = new_levels(mean, float(low), float(high))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, WindStore) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)

    def __reduce__(self) -> Any:
        return open_wind, (self.path,)

    @property
    def _all(self) -> _Ranges:
        """All nodes of the files."""
        return tuple(range(axis.size) for axis in self._source)  # type: ignore[return-value]

    # --- the window ---

    def table_around(self, place: Place, tabulate: Callable[[WindGrid], _Table]) -> _Table:
        """Table and axes that reach around all places of numbers, as far as the files do.

        ``tabulate``: what makes them of a grid.
        """
        with self._lock:
            wanted, window = self._wanted(place), self._window
            if window is None or any(
                one.start < old.start or one.stop > old.stop
                for one, old in zip(wanted, window, strict=True)
            ):
                self._widen(wanted)
                self._read(tabulate)
            assert self._whole is not None
            return self._whole

    def _wanted(self, place: Place) -> _Window:
        """Nodes that the cubics at some places look at; longitudes go on beyond the last."""
        axes, window = (self.axes[0], self.axes[2], self.axes[3]), self._window
        time, latitude, longitude = (
            np.ravel(part)
            for part in np.broadcast_arrays(place.time, place.latitude, place.longitude)
        )
        middle = 0.5 * (axes[2][0] + axes[2][-1])
        if self.around and window is not None:
            turns, nodes = np.divmod(window[2], axes[2].size)
            middle = np.mean(axes[2][nodes] + turns * _TURN)
        elif self.around and longitude.size:
            middle = longitude[0]
        where = [time, latitude, next_to(middle, longitude)]
        ends = [[axis[0], axis[-1]] for axis in axes]
        beyond = [(False, False), self.near_poles, (self.around, self.around)]
        inside = np.logical_and.reduce([
            (before | (x >= low)) & (after | (x <= high))
            for x, (low, high), (before, after) in zip(where, ends, beyond, strict=True)
        ])  # fmt: skip
        if not inside.any():
            if window is not None:
                return window
            where, inside = [axis[:1] for axis in axes], np.ones(1, bool)
        found = []
        for number, (axis, x) in enumerate(zip(axes, where, strict=True)):
            size, goes_on = axis.size, self.around and number == 2
            if goes_on and window is not None and len(window[2]) == size:
                found.append(window[2])
                continue
            turns = np.floor((x[inside] - axis[0]) / _TURN).astype(int) * goes_on
            cell = np.searchsorted(axis, x[inside] - turns * _TURN, side="right") - 1
            cell = np.clip(cell, 0, size - (1 if goes_on else min(size, 2))) + turns * size
            low, high = int(cell.min()) - 1, int(cell.max()) + 3
            found.append(range(low, high) if goes_on else range(max(low, 0), min(high, size)))
        return tuple(found)  # type: ignore[return-value]

    def _widen(self, wanted: _Window) -> None:
        """Have the window reach what is wanted too, with room beyond, if that is not too much."""
        old, levels = self._window, self.axes[1].size
        south, north = self.near_poles
        for roomy in (True, False):
            found: list[range] = []
            for number, one in enumerate(wanted):
                size = self.axes[(0, 2, 3)[number]].size
                before = one if old is None else old[number]
                low, high = min(one.start, before.start), max(one.stop, before.stop)
                first, last = 0, size
                if number == 1:  # a pole takes all meridians, so that it is no room for others
                    first, last = int(low > 0 and south), size - int(high < size and north)
                room = max(_ROOM, (high - low) // 2) if roomy else 0
                low -= room * (old is None or one.start < before.start)
                high += room * (old is None or one.stop > before.stop)
                if number < 2 or not self.around:
                    low, high = max(low, first), min(high, last)
                elif (
                    high - low >= size
                    or (south and found[1].start == 0)
                    or (north and found[1].stop == self.axes[2].size)
                ):
                    low, high = 0, size
                turn = low // size * size
                found.append(range(low - turn, high - turn))
            if np.prod([levels, *map(len, found)]) <= LARGEST_WINDOW:
                break
        else:
            times, rows, columns = map(len, found)
            raise ConfigurationError(
                f"{self.path}: the flights pass {times * levels * rows * columns:,} points of the "
                f"wind ({times} times, {levels} levels, {rows} latitudes, {columns} longitudes), "
                f"more than {LARGEST_WINDOW:,}; fly for a shorter time, or take every other time, "
                "level or meridian of the files, such as by xarray or cdo"
            )
        if old is None or found[1:] != [*old[1:]]:
            self._tables = {}
        self._window = tuple(found)  # type: ignore[assignment]

    def _read(self, tabulate: Callable[[WindGrid], _Table]) -> None:
        """Read what the window lacks, one time after the other."""
        assert self._window is not None
        times, rows, columns = self._window
        levels, new = self._all[1][self._first_level :], self.axes[1]
        report("reading the wind")
        for now in times:
            if now not in self._tables:
                fields = self._fields((range(now, now + 1), levels, rows, columns))
                altitude, told = heights_of(fields)
                if altitude is None:
                    grid = grid_of(fields, told)
                else:
                    grid = grid_of(fields, told, new, winds_on(new, fields, altitude))
                self._tables[now], (_, *self._beside) = tabulate(grid)
        table = np.concatenate([self._tables[now] for now in times])
        self._tables = {now: table[row : row + 1] for row, now in enumerate(times)}
        level, latitude, longitude = self._beside
        self._whole = table, (Axis(self.axes[0][times]), level, latitude, longitude)

    # --- reading ---

    def _fields(self, ranges: _Ranges, *, air_only: bool = False) -> WindFields:
        dataset = self._select(ranges, air_only=air_only)
        try:
            fields = read_fields(dataset, air_only=air_only)
            for name, values in fields.values.items():
                require_finite(values, name)
        except ConfigurationError as error:
            raise ConfigurationError(f"{self.path}: {error}") from None
        return fields

    def _select(self, ranges: _Ranges, *, air_only: bool = False) -> Any:
        """Dataset in memory of some nodes; longitudes go on beyond the last."""
        import xarray

        *others, columns = ranges
        name, size, found = str(self._order[3]), self._source[3].size, []
        for turn in range(columns[-1] // size + 1):
            first, last = max(columns[0] - turn * size, 0), min(columns[-1] + 1 - turn * size, size)
            if first < last:
                nodes, parts = (*others, range(first, last)), []
                for number, file in enumerate(self._files):
                    places = {
                        dimension: np.flatnonzero(
                            np.isin(self._own[axis][number], self._source[axis][nodes[axis]])
                        )
                        for axis, dimension in enumerate(self._order)
                        if dimension is not None
                    }
                    names = [name for name in file.data_vars if name in self._air or not air_only]
                    if names and all(rows.size for rows in places.values()):
                        in_one = {
                            dimension: slice(int(rows[0]), int(rows[-1]) + 1)
                            if rows[-1] - rows[0] + 1 == rows.size else rows
                            for dimension, rows in places.items()
                        }  # fmt: skip
                        parts.append(file[names].isel(in_one))
                one = load_parts(self.path, parts)
                turned = (name, one[name].values + 360.0 * turn, one[name].attrs)
                found.append(one.assign_coords({name: turned}))
        return found[0] if len(found) == 1 else xarray.concat(found, name)

    # --- levels ---

    def _heights(self, times: range, levels: range) -> Iterator[np.ndarray]:
        """Altitudes of levels [m], shape (t, z, y, x): some parallels after the others."""
        _, _, rows, columns = self._all
        many = max(1, KEPT // (len(levels) * len(columns)))
        several = min(len(times), max(1, many // len(rows)))
        for time in range(0, len(times), several):
            report("reading the heights of the wind's data", time, len(times), "times")
            for row in range(0, len(rows), many):
                ranges = times[time : time + several], levels, rows[row : row + many], columns
                altitude, _ = heights_of(self._fields(ranges, air_only=True))
                assert altitude is not None
                yield altitude
