"""Height maps and their files: Asylum's .ibw, Gwyddion's .gwy, and text matrices."""

import io
import math
import re
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.layout import is_comment, split_cells
from lightflyer.foundation.text import read_text
from lightflyer.foundation.units import parse, scale_and_offset

NANOMETRE = 1e-9
"""[m]."""

_LEAST_SIDE = 16  # pixels
_FARTHEST = 0.1  # [m]; far more than any microscope's range
_GWYDDION_LINE = re.compile(r"^#\s*(Channel|Width|Height|Value units)\s*:\s*(.+?)\s*$")
_HEIGHT_CHANNELS = ("height", "zsensor", "topography")
_NO_HEIGHT = re.compile(
    r"phase|ampl|deflect|lateral|friction|current|potential|freq|adhesion|modulus|dissip", re.I
)


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
        Size of the map along its rows and along its columns [m].
    channel : str
        Name in the file.
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
    """Read a height map.

    Parameters
    ----------
    path : str or path
        Igor binary wave (``.ibw``), Gwyddion (``.gwy``), or a text file with a matrix of numbers.
    size : float, optional
        Width of a matrix [m], where the file does not state it; pixels are square.
    unit : str, optional
        Unit of a matrix's heights, where the file does not state it.
    channel : str, optional
        Channel to read; by default the first whose name contains "height". A channel whose name
        says phase, amplitude, deflection or the like is refused.

    Returns
    -------
    HeightMap

    Raises
    ------
    ConfigurationError
        One line that names the file and, for a matrix, the line.
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
        if channel is not None:
            raise ConfigurationError(
                f'{path}: channel "{channel}" has no effect: a matrix is one map; leave it out'
            )
        found = _read_matrix(path, size, unit)
    _require_usable(found)
    return found


def _require_usable(one: HeightMap) -> None:
    wrong = _NO_HEIGHT.search(one.channel)
    if wrong and "height" not in one.channel.lower():
        raise ConfigurationError(
            f'{one.source}: channel "{one.channel}" is not a height; choose one by --channel'
        )
    if one.height.ndim != 2 or min(one.height.shape) < _LEAST_SIDE:
        shape = " x ".join(map(str, one.height.shape))
        raise ConfigurationError(
            f"{one.source}: has {shape} pixels; {_LEAST_SIDE} x {_LEAST_SIDE} or more are needed"
        )
    bad = int((~np.isfinite(one.height)).sum())
    if bad:
        raise ConfigurationError(f"{one.source}: {bad} of its heights are not finite")
    if (farthest := float(np.abs(one.height).max())) > _FARTHEST:
        raise ConfigurationError(
            f"{one.source}: has a height of {farthest:.3g} m; {_FARTHEST:g} m is the most: a "
            "number is damaged, or the unit is wrong"
        )
    sides = np.array([one.width, one.length])
    if not (np.isfinite(sides).all() and (sides > 0.0).all()):
        raise ConfigurationError(f"{one.source}: its size is not positive")


def _content(path: Path) -> io.BytesIO:
    try:
        return io.BytesIO(path.read_bytes())
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from None


def _chosen(path: Path, names: list[str], channel: str | None) -> int:
    """Index of a named channel, or of the first one with heights."""
    if channel is not None:
        matching = [n for n, name in enumerate(names) if name.lower() == channel.lower()]
    else:
        matching = [
            number
            for wanted in _HEIGHT_CHANNELS
            for number, name in enumerate(names)
            if wanted in name.lower()
        ] or [number for number, name in enumerate(names) if name.lower() in ("z", "z trace")]
        matching = matching or ([0] if len(names) == 1 else [])
    if not matching:
        what = f'channel "{channel}"' if channel else "channel of heights"
        raise ConfigurationError(
            f"{path}: has no {what}; choose one by --channel: {', '.join(names)}"
        )
    return matching[0]


def _read_ibw(path: Path, channel: str | None) -> HeightMap:
    binarywave = extra("igor2.binarywave", "reading .ibw files", "lab")
    stream = _content(path)
    try:
        _require_sound_wave(stream.getvalue())
        wave = binarywave.load(stream)["wave"]
        with np.errstate(invalid="ignore"):  # _require_usable finds damaged numbers
            data = np.asarray(wave["wData"], float)
        scales = [float(scale) for scale in wave["wave_header"]["sfA"]]
        labels = [] if data.ndim < 3 else wave["labels"][2]
    except Exception as error:  # the parser has no errors of its own
        raise ConfigurationError(f"{path}: cannot be read as an Igor wave: {error!r}") from None
    if data.ndim not in (2, 3) or not data.size:
        raise ConfigurationError(f"{path}: contains no map")
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


# offsets in an Igor wave of version 5: sizes of its parts, numbers of points, end of the headers
_IGOR_SIZES, _IGOR_DIMENSIONS, _IGOR_HEADERS = (4, "14i"), (64 + 68, "4i"), 64 + 320


def _require_sound_wave(content: bytes) -> None:
    """Raise ValueError if the sizes in the header of an Igor wave do not fit the file.

    igor2 runs for very long on some damaged files.
    """
    if len(content) < _IGOR_HEADERS:
        raise ValueError("the file ends within its header")
    order = {b"\5\0": "<", b"\0\5": ">"}.get(content[:2])
    if order is None:
        raise ValueError("not a wave of version 5")
    sizes = struct.unpack_from(order + _IGOR_SIZES[1], content, _IGOR_SIZES[0])
    counts = struct.unpack_from(order + _IGOR_DIMENSIONS[1], content, _IGOR_DIMENSIONS[0])
    if min(sizes) < 0 or sum(sizes) > len(content):
        raise ValueError("a part is longer than the file")
    if min(counts) < 0 or math.prod(count for count in counts if count) > sizes[0]:
        raise ValueError("the map is larger than the file")


def _read_gwy(path: Path, channel: str | None) -> HeightMap:
    gwyfile = extra("gwyfile", "reading .gwy files", "lab")
    util = extra("gwyfile.util", "reading .gwy files", "lab")
    stream = _content(path)
    content = stream.getvalue()
    if content[:4] != b"GWYP":
        raise ConfigurationError(f"{path}: is not a Gwyddion file")
    try:
        _require_sound(content, 4)
        fields = util.get_datafields(gwyfile.load(stream))
        maps = {str(name): _gwyddion_map(path, str(name), one) for name, one in fields.items()}
    except Exception as error:  # the parser has no errors of its own
        raise ConfigurationError(f"{path}: cannot be read as Gwyddion: {error!r}") from None
    if not maps:
        raise ConfigurationError(f"{path}: contains no map")
    names = list(maps)
    found, unit = maps[names[_chosen(path, names, channel)]]
    if unit != "m":
        raise ConfigurationError(f'{path}: channel "{found.channel}" has the unit "{unit}", not m')
    return found


def _gwyddion_map(path: Path, name: str, field: Any) -> tuple[HeightMap, str]:
    """A channel and its unit."""
    unit = getattr(getattr(field, "si_unit_z", None), "unitstr", "m")
    height = np.asarray(field.data, float)
    return HeightMap(str(path), height, float(field.xreal), float(field.yreal), name), str(unit)


_ITEM_SIZES = {"b": 1, "c": 1, "i": 4, "q": 8, "d": 8}  # of Gwyddion's types


def _require_sound(content: bytes, start: int) -> int:
    """End of an object of a Gwyddion file; ValueError if its parts do not fit its size.

    gwyfile does not return from some damaged files.
    """
    start = content.index(b"\0", start) + 1
    end = start + 4 + int.from_bytes(content[start : start + 4], "little")
    start += 4
    if end > len(content):
        raise ValueError("an object is longer than the file")
    while start < end:
        start = content.index(b"\0", start, end) + 1
        kind = content[start : start + 1].decode("ascii")
        start += 1
        count = 1
        if kind.isupper():
            count = int.from_bytes(content[start : start + 4], "little")
            start += 4
        if kind.lower() in _ITEM_SIZES:
            start += count * _ITEM_SIZES[kind.lower()]
        elif kind.lower() in ("s", "o") and count <= end - start:
            for _ in range(count):
                text = kind.lower() == "s"
                start = (
                    content.index(b"\0", start, end) + 1 if text else _require_sound(content, start)
                )
        else:
            raise ValueError(f"a component of the unknown type {kind!r}")
    if start != end:
        raise ValueError("a component is longer than its object")
    return end


def _read_matrix(path: Path, size: float | None, unit: str | None) -> HeightMap:
    lines = read_text(path).splitlines()
    stated = {
        match[1]: match[2] for line in lines if (match := _GWYDDION_LINE.match(line)) is not None
    }
    rows = [
        (number, line)
        for number, line in enumerate(lines, start=1)
        if line.strip() and not is_comment(line)
    ]
    if not rows:
        raise ConfigurationError(f"{path}: is empty; a matrix of heights is needed")
    height = _numbers(path, rows)
    unit = unit or stated.get("Value units")
    if unit is None:
        raise ConfigurationError(f'{path}: its heights have no unit; state it by --unit "nm"')
    try:
        scale = scale_and_offset(unit, "m")[0]
        width = parse(stated["Width"], "m").value if size is None and "Width" in stated else size
        length = parse(stated["Height"], "m").value if "Height" in stated else None
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from None
    if width is None:
        raise ConfigurationError(f'{path}: has no width; state it by --size "10 um"')
    if length is None or size is not None:
        length = width * height.shape[0] / height.shape[1]
    return HeightMap(str(path), height * scale, width, length, stated.get("Channel", ""))


def _numbers(path: Path, rows: list[tuple[int, str]]) -> np.ndarray:
    """The matrix; all rows must be as long as the first."""
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
                f"{path}:{number}: has {len(matrix[-1])} heights, the first row has "
                f"{len(matrix[0])}"
            )
    return np.array(matrix)


def _reads(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
