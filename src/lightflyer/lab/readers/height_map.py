"""Height maps and their files, by format in :mod:`lightflyer.lab.readers.height_maps`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.arguments import reads_units
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Length
from lightflyer.lab.readers.formats import Format, Source, find_format, read_source
from lightflyer.lab.readers.height_maps import instruments, text
from lightflyer.lab.readers.height_maps.channel import Channel, choose_channel, with_different_names

NANOMETRE = 1e-9  # [m]
MOST_MISSING = 0.25  # Share of pixels without a height above which a map is refused; our choice

HEIGHT_MAP_FORMATS = [
    Format(
        "microscope",
        lambda source: instruments.instrument_of(source) is not None,
        instruments.read_channels,
    ),
]
"""All formats but matrices in text files. A plug-in adds its own."""

_LEAST_SIDE = 16  # pixels
_FARTHEST = 0.1  # [m]; far more than any microscope's range
_LEAST_HEIGHT = 1e-11  # [m]
_WIDEST = 1.0  # [m]


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
        matrix, notes = text.read_matrix(source.path, size, unit)
        channels = [matrix]
    else:
        _refuse_options(source, size, unit)
        channels = kind.read(source)
    found, note = choose_channel(source.path, channels, channel)
    if note:
        notes = (*notes, note)
    one = HeightMap(str(source.path), found.read(), found.width, found.length, found.name, notes)
    _require_usable(one)
    return one


def list_channels(path: str | Path) -> list[Channel]:
    """Channels of a height map's file."""
    source = read_source(Path(path))
    kind = find_format(source, HEIGHT_MAP_FORMATS)
    if kind is None:
        source.refuse("a matrix in a text file has no channels")
    return with_different_names(kind.read(source))


def _refuse_options(source: Source, size: float | None, unit: str | None) -> None:
    for option, value in (("--size", size), ("--unit", unit)):
        if value is not None:
            source.refuse(
                f"states its sizes and units itself; {option} is for a matrix in a text file; "
                "leave it out"
            )


def _require_usable(one: HeightMap) -> None:
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
