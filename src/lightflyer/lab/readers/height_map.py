"""Height maps and their files: microscopes' own, matrices in text, and masks."""

import io
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from lightflyer.array.records import ShortRepr
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Length
from lightflyer.core.units import parse, scale_and_offset
from lightflyer.lab.readers import microscopes
from lightflyer.lab.readers.formats import Format, find_format, read_number_matrix, read_source
from lightflyer.lab.readers.microscopes import Channel, choose_channel, with_different_names

_GWYDDION = ("Channel", "Width", "Height", "Value units")  # the lines of its header
_SIDES, _ROUNDED = ("Width", "Height"), 1e-3
_GWYDDION_LINE = re.compile(r"^#\s*([^:]+?)\s*:\s*(.+?)\s*$")
_DECIMAL_COMMA = re.compile(r"(:\s*\d+),(?=\d+\s)")
_UNIT_IN_BRACKETS = re.compile(r"[\[(]\s*([^\])]+?)\s*[\])]")
_LEAST_PLACES = 2  # places of a list along x and along y
_UNEVEN = 0.2  # of a step, by which the places of a list may be rounded
NANOMETRE = 1e-9  # [m]
MOST_MISSING = 0.25  # Share of pixels without a height above which a map is refused; our choice
HEIGHT_MAP_FORMATS = [
    Format(
        "microscope",
        lambda source: microscopes.instrument_of(source) is not None,
        microscopes.read_channels,
    )
]
"""All formats but matrices in text files. A plug-in adds its own."""

_LEAST_SIDE = 16  # pixels
_FARTHEST = 0.1  # [m]; far more than any microscope's range
_LEAST_HEIGHT = 1e-11  # [m]
_WIDEST = 1.0  # [m]


def read_mask(path: Path) -> np.ndarray:
    """Mask in a picture, where it is not black, or in a matrix of 0 and 1, (rows, columns)."""
    if path.suffix.lower() != ".png":
        values = read_number_matrix(path, "numbers of a mask").values
        if not np.isin(values, (0.0, 1.0)).all():
            raise ConfigurationError(f"{path}: a mask has 0 and 1, and nothing else")
        return values == 1.0
    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("L")) > 0
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror or error}") from None
    except Image.DecompressionBombError:
        raise ConfigurationError(f"{path}: has more pixels than any height map") from None


def mask_as_png(mask: np.ndarray) -> bytes:
    """Picture of a mask, white where it masks."""
    content = io.BytesIO()
    Image.fromarray(np.where(mask, 255, 0).astype(np.uint8)).save(content, "PNG")
    return content.getvalue()


def read_matrix(
    path: Path, size: float | None, unit: str | None
) -> tuple[Channel, tuple[str, ...]]:
    """Read a matrix of heights; returns ``channel``, ``notes``."""
    matrix = read_number_matrix(path, "heights")
    stated = _stated(matrix.above)
    values, said, aspect = matrix.values, matrix.notes, 1.0  # of a pixel, length over width
    if values.shape[1] == 3 and len(values) >= _LEAST_PLACES**2:  # a list of x, y and height
        (x, column), (y, row) = (np.unique(values[:, axis], return_inverse=True) for axis in (0, 1))
        if len(x) * len(y) != len(values) or len(np.unique(row * len(x) + column)) != len(values):
            raise ConfigurationError(
                f"{path}: has three columns, as a list of x, y and height, but no full grid of "
                f"{len(x)} x {len(y)} places; export a matrix"
            )
        steps = [np.diff(one) for one in (x, y)]
        if len(x) < _LEAST_PLACES or len(y) < _LEAST_PLACES or any(
            np.ptp(one) > _UNEVEN * one.mean() for one in steps
        ):  # fmt: skip
            raise ConfigurationError(f"{path}: its list of x, y and height is not an even grid")
        units = _UNIT_IN_BRACKETS.findall(matrix.above[-1]) if matrix.above else []
        if len(units) == 3:
            across = f"{len(x) * steps[0].mean():.9g} {units[0]}"
            stated = {"Width": across, "Value units": units[2]} | stated
        heights = values[:, 2]
        values = np.empty((len(y), len(x)))
        values[row, column] = heights
        said += (f"a list of x, y and height is read as {len(x)} x {len(y)} pixels",)
        aspect = float(steps[1].mean() / steps[0].mean())
    unit = unit or stated.get("Value units")
    if unit is None:
        raise ConfigurationError(f'{path}: its heights have no unit; state it by --unit "nm"')
    try:
        scale = scale_and_offset(unit, "m")[0]
        sides = [parse(stated[one], "m").value if one in stated else None for one in _SIDES]
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from None
    written, length = sides
    width = written if size is None else size
    if width is None:
        raise ConfigurationError(f'{path}: has no width; state it by --size "10 um"')
    if written is not None and abs(width - written) > _ROUNDED * written:
        text = f"its width is {1e6 * width:g} µm as stated by --size; the file says "
        said += (f"{text}{stated['Width']}",)
    rows, columns = values.shape
    if length is None or size is not None:
        length = width * rows / columns * aspect
    return Channel(stated.get("Channel", ""), unit, (rows, columns), width, length,
                   lambda: values * scale), said  # fmt: skip


def _stated(above: tuple[str, ...]) -> dict[str, str]:
    """What Gwyddion's header says, by its English words; it is written in the user's language."""
    plain = (_DECIMAL_COMMA.sub(r"\1.", line) for line in above)
    said = [match.groups() for line in plain if (match := _GWYDDION_LINE.match(line))]
    english = {name: text for name, text in said if name in _GWYDDION}
    for at in range(len(said) - 1):
        # the two lengths are width and height, whatever they are called
        if not english and all(_is_length(text) for _, text in said[at : at + 2]):
            texts = [text for _, text in said[max(at - 1, 0) : at + 3]]
            return dict(zip(_GWYDDION[0 if at else 1 :], texts, strict=False))
    return english


def _is_length(text: str) -> bool:
    try:
        return parse(text, "m").value > 0.0 and text[:1].isdigit() and not text[-1:].isdigit()
    except ConfigurationError:
        return False


@dataclass(frozen=True)
class HeightMap(ShortRepr):
    """Heights on a regular grid."""

    source: str  #: Name of the file
    height: np.ndarray  #: shape (rows, columns); [m]; NaN where the instrument has none
    width: float  #: Size of the map along its rows and along its columns [m]
    length: float  #: Size of the map along its rows and along its columns [m]
    channel: str = ""  #: Name in the file
    notes: tuple[str, ...] = ()  #: What a reader of the map must know of its file

    @property
    def missing(self) -> np.ndarray:
        """True where the instrument has no height, shape (rows, columns)."""
        return np.isnan(self.height)

    @property
    def pixel_aspect(self) -> float:
        """Width of a pixel over its length [1]."""
        rows, columns = self.height.shape
        return (self.width / columns) / (self.length / rows)


@reads_units
def read_height_map(
    path: str | Path,
    *,
    size: Length | None = None,
    unit: str | None = None,
    channel: str | None = None,
) -> HeightMap:
    """Read a height map.

    Parameters
    ----------
    path : str or path
        Igor binary wave (``.ibw``), Gwyddion (``.gwy``), Nanoscope (``.spm``, ``.001``),
        Nanosurf (``.nid``), JPK (``.jpk``), Digital Surf (``.sur``), WSxM (``.stp``, ``.top``),
        Agilent (``.mi``), or a text file with a matrix of numbers.
    size : float, optional
        Width of a matrix [m], where the file does not state it; pixels are square.
    unit : str, optional
        Unit of a matrix's heights, where the file does not state it.
    channel : str, optional
        Channel to read; by default the first whose name contains "height" and whose unit is a
        length. A channel whose name says phase, amplitude, deflection or the like is refused,
        and so is one in volts or degrees.

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
    source = read_source(Path(path))
    kind = find_format(source, HEIGHT_MAP_FORMATS)
    notes: tuple[str, ...] = ()
    if kind is None:
        if channel is not None:
            source.refuse(f'channel "{channel}" has no effect: a matrix is one map; leave it out')
        matrix, notes = read_matrix(source.path, size, unit)
        channels = [matrix]
    else:
        for option, value in (("--size", size), ("--unit", unit)):
            if value is not None:
                source.refuse(
                    f"states its sizes and units itself; {option} is for a matrix in a text file; "
                    "leave it out"
                )
        channels = kind.read(source)
    found, note = choose_channel(source.path, channels, channel)
    if note:
        notes = (*notes, note)
    one = HeightMap(str(source.path), found.read(), found.width, found.length, found.name, notes)
    if one.height.ndim != 2 or min(one.height.shape) < _LEAST_SIDE:
        shape = " x ".join(map(str, one.height.shape))
        raise ConfigurationError(
            f"{one.source}: has {shape} pixels; {_LEAST_SIDE} x {_LEAST_SIDE} or more are needed"
        )
    share = float(one.missing.mean())
    if share > MOST_MISSING:
        raise ConfigurationError(
            f"{one.source}: {int(one.missing.sum())} of its heights are missing; a share of "
            f"{MOST_MISSING:g} is the most"
        )
    farthest = float(np.nanmax(np.abs(one.height)))
    if not farthest <= _FARTHEST:
        raise ConfigurationError(
            f"{one.source}: has a height of {farthest:.3g} m; {_FARTHEST:g} m is the most: a "
            "number is damaged, or the unit is wrong"
        )
    spread = float(np.ptp(one.height[~one.missing]))
    if 0.0 < spread < _LEAST_HEIGHT:
        raise ConfigurationError(
            f"{one.source}: all heights are within {spread:.2g} m; atoms are larger, the unit is "
            "wrong"
        )
    sides = np.array([one.width, one.length])
    if not (np.isfinite(sides).all() and (sides > 0.0).all() and sides.max() <= _WIDEST):
        raise ConfigurationError(
            f"{one.source}: its size, {one.width:.3g} m x {one.length:.3g} m, is not between 0 and "
            f"{_WIDEST:g} m"
        )
    return one


def list_channels(path: str | Path) -> list[Channel]:
    """Channels of a height map's file."""
    source = read_source(Path(path))
    kind = find_format(source, HEIGHT_MAP_FORMATS)
    if kind is None:
        source.refuse("a matrix in a text file has no channels")
    return with_different_names(kind.read(source))
