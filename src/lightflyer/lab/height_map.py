"""Maps of height and their files: Asylum's .ibw, Gwyddion's .gwy, and plain matrices."""

import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer._text import read_text
from lightflyer.errors import ConfigurationError
from lightflyer.lab._extra import extra
from lightflyer.lab.layout import COMMENTS, split_cells
from lightflyer.units import parse, scale_and_offset

_LEAST_SIDE = 16  # pixels
_GWYDDION_LINE = re.compile(r"^#\s*(Width|Height|Value units)\s*:\s*(.+?)\s*$")
_HEIGHT_CHANNELS = ("height", "zsensor", "topography", "z")


@dataclass(frozen=True)
class HeightMap:
    """Heights on a regular grid.

    Attributes
    ----------
    source : str
        Name of the file.
    height : array, shape (rows, columns)
        [m].
    width, length : float
        Of the map along its rows and its columns [m].
    channel : str
        What the file calls it.
    """

    source: str
    height: np.ndarray
    width: float
    length: float
    channel: str = ""


def read_height_map(
    path: str | Path,
    *,
    size: float | None = None,
    unit: str | None = None,
    channel: str | None = None,
) -> HeightMap:
    """Read a map of height.

    Parameters
    ----------
    path : str or path
        Igor binary wave (``.ibw``), Gwyddion (``.gwy``), or a text file with a matrix of numbers.
    size : float, optional
        Width of the map [m], where a matrix does not say it; its pixels are square.
    unit : str, optional
        Of a matrix's heights, where it does not say it.
    channel : str, optional
        Of several in the file; by default the first one whose name has "height" in it.

    Returns
    -------
    HeightMap

    Raises
    ------
    ConfigurationError
        One line that names the file and, of a matrix, the line.
    MissingExtraError
        If the package that reads the format is not installed.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".ibw":
        found = _read_ibw(path, channel)
    elif suffix == ".gwy":
        found = _read_gwy(path, channel)
    else:
        found = _read_matrix(path, size, unit)
    _require_usable(found)
    return found


def _require_usable(one: HeightMap) -> None:
    if one.height.ndim != 2 or min(one.height.shape) < _LEAST_SIDE:
        shape = " x ".join(map(str, one.height.shape))
        raise ConfigurationError(
            f"{one.source}: is {shape} pixels; a map takes {_LEAST_SIDE} x {_LEAST_SIDE} or more"
        )
    bad = int((~np.isfinite(one.height)).sum())
    if bad:
        raise ConfigurationError(f"{one.source}: {bad} of its heights are no numbers")
    sides = np.array([one.width, one.length])
    if not (np.isfinite(sides).all() and (sides > 0.0).all()):
        raise ConfigurationError(f"{one.source}: its size is not positive")


def _content(path: Path) -> io.BytesIO:
    try:
        return io.BytesIO(path.read_bytes())
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from None


def _chosen(path: Path, names: list[str], channel: str | None) -> int:
    """Number of the channel asked for, or of the first one of heights."""
    if channel is not None:
        matching = [n for n, name in enumerate(names) if name.lower() == channel.lower()]
    else:
        matching = [
            number
            for wanted in _HEIGHT_CHANNELS
            for number, name in enumerate(names)
            if wanted in name.lower()
        ] or ([0] if len(names) == 1 else [])
    if not matching:
        what = f'channel "{channel}"' if channel else "channel of heights"
        raise ConfigurationError(
            f"{path}: has no {what}; it has {', '.join(names)}; --channel names one"
        )
    return matching[0]


def _read_ibw(path: Path, channel: str | None) -> HeightMap:
    binarywave = extra("igor2.binarywave", "reading .ibw files")
    stream = _content(path)
    try:
        wave = binarywave.load(stream)["wave"]
        data = np.asarray(wave["wData"], float)
        scales = [float(scale) for scale in wave["wave_header"]["sfA"]]
        labels = [] if data.ndim < 3 else wave["labels"][2]
    except Exception as error:  # the parser raises what its statements happen to
        raise ConfigurationError(f"{path}: is not readable as an Igor wave: {error!r}") from None
    if data.ndim not in (2, 3) or not data.size:
        raise ConfigurationError(f"{path}: holds no map")
    names = [bytes(label).decode("utf-8", "replace") for label in labels if label]
    number = 0
    if data.ndim == 3:
        if len(names) != data.shape[2]:
            names = [f"layer {layer}" for layer in range(data.shape[2])]
        number = _chosen(path, names, channel)
        data = data[:, :, number]
    width, length = (abs(scale) * count for scale, count in zip(scales, data.shape, strict=False))
    name = names[number] if names else ""
    return HeightMap(str(path), data.T, width, length, name)


def _read_gwy(path: Path, channel: str | None) -> HeightMap:
    gwyfile = extra("gwyfile", "reading .gwy files")
    util = extra("gwyfile.util", "reading .gwy files")
    if not _content(path).read(4) == b"GWYP":
        raise ConfigurationError(f"{path}: is not a Gwyddion file")
    try:
        fields = util.get_datafields(gwyfile.load(str(path)))
        names = [str(name) for name in fields]
    except Exception as error:  # the parser raises what its statements happen to
        raise ConfigurationError(f"{path}: is not readable as Gwyddion: {error!r}") from None
    if not names:
        raise ConfigurationError(f"{path}: holds no map")
    name = names[_chosen(path, names, channel)]
    field: Any = fields[name]
    unit = getattr(getattr(field, "si_unit_z", None), "unitstr", "m")
    if unit != "m":
        raise ConfigurationError(f'{path}: channel "{name}" is in "{unit}", not in m')
    height = np.asarray(field.data, float)
    return HeightMap(str(path), height, float(field.xreal), float(field.yreal), name)


def _read_matrix(path: Path, size: float | None, unit: str | None) -> HeightMap:
    lines = read_text(path).splitlines()
    stated = {
        match[1]: match[2] for line in lines if (match := _GWYDDION_LINE.match(line)) is not None
    }
    rows = [
        (number, line)
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith(COMMENTS)
    ]
    if not rows:
        raise ConfigurationError(f"{path}: is empty; a map is a matrix of heights")
    height = _numbers(path, rows)
    unit = unit or stated.get("Value units")
    if unit is None:
        raise ConfigurationError(f'{path}: its heights have no unit; write --unit "nm"')
    try:
        scale = scale_and_offset(unit, "m")[0]
        width = parse(stated["Width"], "m").value if size is None and "Width" in stated else size
        length = parse(stated["Height"], "m").value if "Height" in stated else None
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from None
    if width is None:
        raise ConfigurationError(f'{path}: says no width; write --size "10 um"')
    if length is None or size is not None:
        length = width * height.shape[0] / height.shape[1]
    return HeightMap(str(path), height * scale, width, length)


def _numbers(path: Path, rows: list[tuple[int, str]]) -> np.ndarray:
    """The matrix; stops at the first row that differs from the first one."""
    first = rows[0][1]
    delimiter = next((mark for mark in ("\t", ";") if mark in first), None)
    if delimiter is None and "," in first and len(first.split(",")) > len(first.split()):
        delimiter = ","
    comma = delimiter != "," and any("," in line for _, line in rows)
    texts = [line.replace(",", ".") if comma else line for _, line in rows]
    try:
        return np.loadtxt(texts, delimiter=delimiter, comments=None, ndmin=2)
    except ValueError:
        pass
    matrix = []
    for (number, _), text in zip(rows, texts, strict=True):
        cells = split_cells(text, delimiter)
        if cells and not cells[-1]:
            del cells[-1]
        try:
            matrix.append([float(cell) for cell in cells])
        except ValueError:
            bad = next(cell for cell in cells if not _reads(cell))
            raise ConfigurationError(f'{path}:{number}: "{bad[:40]}" is not a number') from None
        if len(matrix[-1]) != len(matrix[0]):
            raise ConfigurationError(
                f"{path}:{number}: has {len(matrix[-1])} heights, the first row {len(matrix[0])}"
            )
    return np.array(matrix)


def _reads(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
