"""Weather files that stay on the disk, of which parts are read where they are wanted.

A part has at its nodes what all files in memory would have there: the altitudes of all levels are
found once, when the files are opened.
"""

import math
from collections import OrderedDict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.progress import report
from lightflyer.environment.base import Place
from lightflyer.environment.wind.dataset import (
    PLACING,
    Fields,
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
from lightflyer.environment.wind.layouts import (
    load_parts,
    one_version,
    open_parts,
    weather_files,
)
from lightflyer.environment.wind.reach import next_to

KEPT = 2_500_000
"""Most points of a variable that are in memory at once: of small files, or of a part of others."""

_PARTS = 2  # that are kept in memory
_TIMES = 8  # of a part; it has all levels, as who chooses its wind looks at them
_FEWEST = 6  # nodes of a part along an axis; the cubics at its ends lack a neighbour
_WIDER = 1.5  # meridians of a part over its parallels
_AT_POLE = 2.0  # points of a part that holds all meridians over those of another
_NEAR = 2 / 3  # of a part's parallels: closer to a pole it holds all meridians
_FEWEST_LEVELS = 2  # of a file
_TURN = 2.0 * np.pi

_Ranges = tuple[range, range, range, range]  # of nodes along time, level, latitude, longitude


class Part(NamedTuple):
    """Some nodes of all files along time, level, latitude and longitude."""

    first: tuple[int, ...]
    length: tuple[int, ...]

    @property
    def ranges(self) -> _Ranges:
        found = (range(i, i + n) for i, n in zip(self.first, self.length, strict=True))
        return tuple(found)  # type: ignore[return-value]


def open_wind(path: str | Path) -> "WindGrid | Store":
    """Winds of files: in memory where there is room for them."""
    files = open_parts(path)
    sizes = (max((field.size for field in file.data_vars.values()), default=0) for file in files)
    if sum(sizes) <= KEPT or not all("longitude" in file.dims for file in files):
        dataset = load_parts(path, files)
        for file in files:
            file.close()
        return read_grid(dataset)
    return Store(path, files)


def changes_of(path: str | Path) -> tuple[int, ...]:
    """When files were written, which tells them from what they were before."""
    return tuple(Path(file).stat().st_mtime_ns for file in weather_files(path))


class Store:
    """Winds of files that stay on the disk; equal to any other of the same files."""

    def __init__(self, path: str | Path, files: list[Any]):
        self.path, self._files = str(path), files
        self.key = self.path, changes_of(path)
        self._kept: OrderedDict[Part, Any] = OrderedDict()
        names = dimensions_of(one_version(files[0]), str(next(iter(files[0].data_vars))))
        by_pressure = "pressure" in names
        kinds = ("time", "pressure" if by_pressure else "altitude", "latitude", "longitude")
        self._order = [names.get(kind) for kind in kinds]
        self._own = [  # coordinates of each file
            [np.zeros(1) if name is None else reader(file[name], name) for file in files]
            for name, reader in zip(self._order, readers_of(by_pressure=by_pressure), strict=True)
        ]
        if any(not np.array_equal(own[0], one) for own in self._own[2:] for one in own):
            raise ConfigurationError(
                f"{path}: these files are no one grid: their latitudes or longitudes differ"
            )
        source = [np.unique(np.concatenate(own)) for own in self._own]
        if source[3][-1] - source[3][0] > _TURN - 1e-6:  # 0° and 360° are both there
            source[3] = source[3][:-1]
        self.axes = self._source = source
        width = source[3][-1] - source[3][0] + 1.01 * np.diff(source[3]).max()
        self.around = bool(width >= _TURN)
        there = {str(name) for file in files for name in file.data_vars}
        self.rises = "w" in there
        self._air = [name for name in PLACING if name in there][:1]
        self._first_level = self._lowest_whole()
        times, levels, rows, columns = self._all
        highest = self._fields((times[:1], levels[-_FEWEST_LEVELS:], rows[:2], columns))
        altitude, self.told = heights_of(highest)
        self.has_air = altitude is not None and "temperature" in there
        self.by_pressure = by_pressure and altitude is None
        own = source[1][self._first_level :]
        self.axes = [source[0], own if altitude is None else self._common_levels(), *source[2:]]
        self._count, self._count_at_pole = self._sizes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Store) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)

    def __reduce__(self) -> Any:
        return open_wind, (self.path,)

    @property
    def _all(self) -> _Ranges:
        """All nodes of the files."""
        return tuple(range(axis.size) for axis in self._source)  # type: ignore[return-value]

    # --- which part ---

    def _sizes(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Nodes of a part along each axis, and of one at a pole."""
        all_times, levels, all_rows, meridians = (axis.size for axis in self.axes)
        times, fewest = min(all_times, _TIMES), min(all_rows, meridians, _FEWEST)
        area = KEPT / (times * levels)
        rows = int(np.clip(math.sqrt(area / _WIDER), fewest, all_rows))
        columns = int(np.clip(area / rows, fewest, meridians))
        polar = int(np.clip(_AT_POLE * area / meridians, fewest, all_rows))
        times = int(np.clip(KEPT / (levels * rows * columns), times, all_times))
        return (times, levels, rows, columns), (times, levels, polar, meridians)

    def part_at(self, place: Place) -> Part:
        """The part around a place; it goes on from that time."""
        sizes, (west, east) = [axis.size for axis in self.axes], self.axes[3][[0, -1]]
        turned = next_to(0.5 * (west + east), place.longitude)
        if turned < west and self.around:  # between the last meridian and the first
            turned += _TURN
        at = [
            int(np.clip(np.searchsorted(self.axes[axis], x, side="right") - 1, 0, sizes[axis] - 1))
            for axis, x in ((0, place.time), (2, place.latitude), (3, turned))
        ]
        count = self._count
        goes_on = self.around and count[3] < sizes[3]
        if goes_on and min(at[1], sizes[2] - 1 - at[1]) < _NEAR * self._count_at_pole[2]:
            count, goes_on = self._count_at_pole, False
        first = [at[0] - 1, 0, at[1] - count[2] // 2 + 1, at[2] - count[3] // 2 + 1]
        clipped = [max(0, min(i, size - n)) for i, n, size in zip(first, count, sizes, strict=True)]
        if goes_on:
            clipped[3] = first[3] % sizes[3]
        return Part(tuple(clipped), count)

    def bounds_of(self, part: Part) -> np.ndarray:
        """Between which coordinates a part is what all files are, shape (4, 2)."""
        bounds = np.tile([-np.inf, np.inf], (4, 1))
        goes_on = self.around and part.length[3] < self.axes[3].size
        for number, one in enumerate(part.ranges):
            nodes, size = self._along(number, one), self.axes[number].size
            open_ended = goes_on and number > 1  # at a meridian, and at a pole
            if one[0] > 0 or open_ended:
                bounds[number, 0] = nodes[1]
            if one[-1] + 1 < size or open_ended:
                bounds[number, 1] = nodes[-2]
        return bounds

    def _along(self, number: int, nodes: range) -> np.ndarray:
        """Coordinates of nodes along an axis; longitudes go on beyond the last."""
        axis, index = self.axes[number], np.asarray(nodes)
        return axis[index % axis.size] + _TURN * (index // axis.size)

    @property
    def height(self) -> float:
        """Latitudes that a part has [rad]."""
        return float(self._count[2] * np.diff(self.axes[2]).min())

    # --- reading ---

    def kept(self, part: Part, make: Callable[[WindGrid], Any]) -> Any:
        """What is made of the winds of a part; the last few are kept."""
        if part not in self._kept:
            report("reading the wind")
            while len(self._kept) >= _PARTS:
                self._kept.popitem(last=False)
            self._kept[part] = make(self._grid(part))
        self._kept.move_to_end(part)
        return self._kept[part]

    def _grid(self, part: Part) -> WindGrid:
        times, _, rows, columns = part.ranges
        levels, new = self._all[1][self._first_level :], self.axes[1]
        grids = []
        for now in times:  # one by one: only the result is all in memory
            fields = self._fields((range(now, now + 1), levels, rows, columns))
            altitude, told = heights_of(fields)
            if altitude is None:
                grids.append(grid_of(fields, told))
            else:
                grids.append(grid_of(fields, told, new, winds_on(new, fields, altitude)))
        names = ["time", "east", "north", "up", *(["air"] if self.has_air else [])]
        found: dict[str, Any] = {
            name: np.concatenate([getattr(grid, name) for grid in grids]) for name in names
        }
        return grids[0]._replace(**found)

    def _fields(self, ranges: _Ranges, *, air_only: bool = False) -> Fields:
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
                one = self._load((*others, range(first, last)), air_only=air_only)  # type: ignore[arg-type]
                turned = (name, one[name].values + 360.0 * turn, one[name].attrs)
                found.append(one.assign_coords({name: turned}))
        return found[0] if len(found) == 1 else xarray.concat(found, name)

    def _load(self, ranges: _Ranges, *, air_only: bool) -> Any:
        parts = []
        for number, file in enumerate(self._files):
            wanted = {
                name: _rows_of(self._own[axis][number], self._source[axis][ranges[axis]])
                for axis, name in enumerate(self._order)
                if name is not None
            }
            names = [name for name in file.data_vars if name in self._air or not air_only]
            if names and all(rows is not None for rows in wanted.values()):
                parts.append(file[names].isel(wanted))
        return load_parts(self.path, parts)

    # --- levels ---

    def _lowest_whole(self) -> int:
        """The lowest level that no mountain reaches."""
        times, levels, rows, columns = self._all
        for level in levels[:-_FEWEST_LEVELS]:
            found = self._select((times[:1], range(level, level + 1), rows, columns))
            if all(np.isfinite(field.values).all() for field in found.data_vars.values()):
                return level
        return 0

    def _common_levels(self) -> np.ndarray:
        """Our levels [m], between which all columns have data at all times."""
        # those of :func:`read_grid` for all files at once
        times, levels = self._all[0], self._all[1][self._first_level :]
        blocks = [*self._heights(times[:1], levels)]
        means = [block[0].mean(axis=(1, 2)) for block in blocks]
        mean = np.average(means, axis=0, weights=[block.shape[2] for block in blocks])
        # by temperature an altitude follows from all levels below
        by_temperature = self._air == [PLACING[-1]]
        ends = levels if by_temperature else levels[:: len(levels) - 1]
        low, high = -np.inf, np.inf
        for block in self._heights(times, ends):
            low, high = max(low, block[:, 0].max()), min(high, block[:, -1].min())
        return new_levels(mean, float(low), float(high))

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


def _rows_of(own: np.ndarray, wanted: np.ndarray) -> Any:
    """Rows of a file that are wanted: a slice where they are one; None for none."""
    rows = np.flatnonzero(np.isin(own, wanted))
    if rows.size == 0:
        return None
    is_slice = rows[-1] - rows[0] + 1 == rows.size
    return slice(int(rows[0]), int(rows[-1]) + 1) if is_slice else rows
