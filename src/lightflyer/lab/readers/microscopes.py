"""Microscopes' own formats, read by SurfaceTopography of the extra ``afm``, and their channels."""

import io
import logging
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra
from lightflyer.core.units import scale_and_offset
from lightflyer.lab.readers.formats import WORDS, Source, one_line, require_sound_tiff

_PREFERRED = ("height", "zsensor", "z-axis", "topography")
"""Parts of the names of channels with heights; the first one found is read."""

_BARE = ("z", "z trace")
_NO_HEIGHT = re.compile(
    r"phase|ampl|deflect|lateral|friction|current|potential|freq|adhesion|modulus|dissip|error"
    r"|deform|stiffness|intensity|bias",
    re.I,
)

_IGOR = "Igor"
_SURF_FIELDS = (164, 212)  # places of the name of the heights and of the unit of their step
_NUMBERED = re.compile(r"\.\d{3}")  # Nanoscope's older files: map.000, map.001
_COMPRESSED = b"DSCOMPRESSED"
_TEXT = b"?*"
_SHOWN = 200  # characters of a parser's message


@dataclass(frozen=True)
class Channel(ShortRepr):
    """A channel of a file, not read yet."""

    name: str
    unit: str  #: Of its values; empty where the file does not state it
    shape: tuple[int, int]  #: Rows and columns
    width: float  #: Size along the rows and along the columns [m]
    length: float  #: Size along the rows and along the columns [m]
    #: Returns the heights [m], shape (rows, columns), NaN where the instrument has none
    read: Callable[[], np.ndarray]

    @property
    def is_height(self) -> bool:
        """Whether neither name nor unit says that its values are something else."""
        name = self.name.lower()
        wrong = _NO_HEIGHT.search(name) and ("height" not in name or "error" in name)
        return not wrong and (not self.unit or metres(self.unit) is not None)

    @property
    def description(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def metres(unit: str) -> float | None:
    """A unit of length in metres; none if it is not a length."""
    try:
        return scale_and_offset(unit, "m")[0] if unit else None
    except ConfigurationError:
        return None


def choose_channel(
    path: Path, channels: Sequence[Channel], wanted: str | None
) -> tuple[Channel, str]:
    """The named channel, or the first with heights; returns ``channel``, ``note``."""
    named = with_different_names(channels)
    listed = ", ".join(one.description for one in named)
    if wanted is not None:
        found = next((one for one in named if one.name.lower() == wanted.lower()), None)
        if found is None:
            raise ConfigurationError(
                f'{path}: has no channel "{wanted}"; choose one by --channel: {listed}'
            )
        if not found.is_height:
            raise ConfigurationError(
                f'{path}: channel "{found.description}" is not a height; choose one by --channel: '
                f"{listed}"
            )
        return found, ""
    heights = [one for one in named if one.is_height]
    lengths = [one for one in heights if one.unit]
    preferred = [
        *(one for part in _PREFERRED for one in heights if part in one.name.lower()),
        *(one for one in heights if one.name.lower() in _BARE),
        *(lengths if len(lengths) == 1 else heights if len(named) == 1 else ()),
    ]
    if not preferred:
        if len(named) == 1:
            raise ConfigurationError(f'{path}: its channel "{listed}" is not a height')
        what = "several channels of heights" if heights else "no channel of heights"
        raise ConfigurationError(f"{path}: has {what}; choose one by --channel: {listed}")
    found = preferred[0]
    others = ", ".join(one.name for one in heights if one is not found)
    note = f"{found.name} is read; other heights in the file, by --channel: {others}"
    return found, note if others else ""


def with_different_names(channels: Sequence[Channel]) -> list[Channel]:
    """The same channels; the second of two with one name gets "(2)" appended."""
    seen: dict[str, int] = {}
    named = []
    for one in channels:
        name = one.name or "channel" * (len(channels) > 1)
        count = seen[name] = seen.get(name, 0) + 1
        named.append(replace(one, name=name if count == 1 else f"{name} ({count})"))
    return named


def _wsxm_channel(content: bytes) -> tuple[str, str]:
    name, unit = (
        match[1].decode("latin-1").strip() if (match := re.search(pattern, content)) else ""
        for pattern in (rb"Acquisition channel: *([^\r\n]*)", rb"Z Amplitude: *\S+ +(\S+)")
    )
    return name, unit


def _surf_channel(content: bytes) -> tuple[str, str]:
    name, unit = (  # fields of fixed width
        content[start : start + 16].split(b"\0")[0].decode("latin-1").strip()
        for start in _SURF_FIELDS
    )
    return name, unit


class Instrument(NamedTuple):
    """A format that SurfaceTopography reads."""

    name: str
    suffixes: tuple[str, ...]
    magic: bytes  # Beginning of its files
    reader: tuple[str, str]  # Module and class in SurfaceTopography.IO
    # Name and unit of the channel of a file that has one, where the reader asks for neither
    single: Callable[[bytes], tuple[str, str]] | None = None


INSTRUMENTS = (
    Instrument("Nanoscope", (".spm", ".di"), b"\\*", ("DI", "DIReader")),
    Instrument("Nanosurf", (".nid", ".ezd"), b"[DataSet]", ("EZD", "EZDReader")),
    Instrument("JPK", (".jpk",), b"", ("JPK", "JPKReader")),
    Instrument("Digital Surf", (".sur",), b"DIGITAL SURF", ("SUR", "SURReader"), _surf_channel),
    Instrument(
        "WSxM",
        (".stp", ".top", ".tom"),
        b"WSxM file copyright",
        ("WSXM", "WSXMReader"),
        _wsxm_channel,
    ),
    Instrument("Agilent", (".mi",), b"fileType", ("MI", "MIReader")),
    Instrument("Gwyddion", (".gwy",), b"GWYP", ("GWY", "GWYReader")),
    Instrument(_IGOR, (".ibw",), b"", ("IBW", "IBWReader")),
)


def instrument_of(source: Source) -> Instrument | None:
    """Format of a file by its beginning, or else by its suffix."""
    content, suffix = source.content, source.suffix
    if curves := WORDS["not_read"]["height_maps"].get(suffix):
        source.refuse(f"contains {curves}, not a map of heights; export the height as .jpk or .gwy")
    if content.startswith(_COMPRESSED):
        source.refuse("is compressed; save it in MountainsMap without compression")
    if content.startswith(_TEXT):
        source.refuse("is a Nanoscope file with heights as text; save it in binary form")
    found = next((one for one in INSTRUMENTS if one.magic and content.startswith(one.magic)), None)
    if found is not None:
        return found
    if _NUMBERED.fullmatch(suffix):
        return INSTRUMENTS[0]
    return next((one for one in INSTRUMENTS if suffix in one.suffixes), None)


def read_channels(source: Source) -> list[Channel]:
    """Channels of a microscope's file."""
    path, content = source
    kind = instrument_of(source)
    assert kind is not None  # as recognised
    module, name = kind.reader
    label, unit = ("", "") if kind.single is None else kind.single(content)
    if unit and metres(unit) is None:
        raise ConfigurationError(f'{path}: its channel "{label} [{unit}]" is not a height')
    with _quiet():
        readers = extra(
            f"SurfaceTopography.IO.{module}", f"reading {kind.name}'s {kind.suffixes[0]}", "afm"
        )
        try:
            if kind.name == "JPK":
                require_sound_tiff(content)
            reader = getattr(readers, name)(io.BytesIO(content))
            found = list(reader.channels)
            channels = [_channel(path, kind, reader, one, len(content)) for one in found]
        except ConfigurationError:
            raise
        except Exception as error:  # a damaged file makes any
            raise _refusal(path, kind, error) from None
    if not channels:
        raise ConfigurationError(f"{path}: contains no map of heights")
    return [replace(one, name=label) for one in channels] if label else channels


def _channel(path: Path, kind: Instrument, reader: Any, info: Any, size: int) -> Channel:
    columns, rows = (int(count) for count in info.nb_grid_pts)
    if min(rows, columns) <= 0 or rows * columns > size:
        raise ConfigurationError(
            f"{path}: its header states {columns} x {rows} pixels, more than the file holds"
        )
    # the unit of a height serves for its sides too; else the two are a pair
    lateral, unit = info.unit if isinstance(info.unit, tuple) else (info.unit, info.data_unit)
    side = metres(lateral or "")
    if side is None:
        raise ConfigurationError(f"{path}: the unit of its sides, {lateral}, is not a length")
    width, length = (float(one) * side for one in info.physical_sizes)

    def read() -> np.ndarray:
        with _quiet():
            try:
                heights = reader.topography(channel_index=info.index).heights()
                values: np.ndarray = np.ma.filled(np.ma.asarray(heights, float), np.nan)
            except Exception as error:  # a damaged file makes any
                raise _refusal(path, kind, error) from None
        rows_first = values.T[::-1] if kind.name == _IGOR else values.T  # which is turned over
        return np.ascontiguousarray(rows_first * (metres(unit) or np.nan))

    # Asylum states metres for all layers, phases too
    shown = "" if kind.name == _IGOR and unit == "m" else unit or "?"
    return Channel(str(info.name), shown, (rows, columns), width, length, read)


@contextmanager
def _quiet() -> Iterator[None]:
    """No warnings and logs of the packages that read: our own line says what is wrong."""
    before = logging.root.manager.disable
    logging.disable()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(before)


def _refusal(path: Path, kind: Instrument, error: Exception) -> ConfigurationError:
    said = one_line(str(error))[:_SHOWN]
    if not type(error).__module__.startswith("SurfaceTopography"):
        said = f"it is damaged or of an unknown version ({type(error).__name__}: {said})"
    a = "an" if kind.name[0] in "AEIO" else "a"
    return ConfigurationError(f"{path}: cannot be read as {a} {kind.name} file: {said}")
