"""Formats of raw files: how each is recognised, what reads it, and whether a TIFF is sound."""

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple, NoReturn

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import load_plugins
from lightflyer.core.text import read_content
from lightflyer.files.table_rows import Rejected

_ORDERS = {b"II*\0": "<", b"MM\0*": ">"}
_ENTRY = "HHII"  # code, type, count, value or its place
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4}
"""Bytes of a value of each type, by TIFF 6.0."""
_MOST_PAGES = 1000
_PIXELS = (256, 257)  # codes of width and length


class Source(NamedTuple):
    """A file with its content."""

    path: Path
    content: bytes

    @property
    def text(self) -> str:
        """The content as text."""
        # Unicode marked by a byte-order mark, UTF-8, Shift-JIS as JASCO writes it, else cp1252.
        if self.content.startswith((b"\xff\xfe", b"\xfe\xff")):
            return self.content.decode("utf-16", "replace")
        for encoding in ("utf-8-sig", "cp932"):
            try:
                return self.content.decode(encoding)
            except UnicodeDecodeError:
                continue
        return self.content.decode("cp1252", "replace")

    @property
    def suffix(self) -> str:
        """End of the file's name in small letters, such as ``".csv"``."""
        return self.path.suffix.lower()

    def refuse(self, why: str, line: int | None = None) -> NoReturn:
        """Raise :class:`ConfigurationError`; ``why``: what is wrong; ``line``: counted from 1."""
        place = f"{self.path}" if line is None else f"{self.path}:{line}"
        raise ConfigurationError(f"{place}: {one_line(why)}")


class Format(NamedTuple):
    """A format of spectra, height maps or thermal images."""

    name: str  #: Such as ``"JASCO text"``
    recognises: Callable[[Source], bool]  #: Whether a :class:`Source` is of this format
    #: What a :class:`Source` holds: a list of :class:`RawSpectrum`, a list of :class:`Channel`, or
    #: a :class:`ThermalImage`
    read: Callable[..., Any]
    #: Options of :func:`read_thermal_image` that ``read`` takes by name
    options: tuple[str, ...] = ()


def has_suffix(*suffixes: str) -> Callable[[Source], bool]:
    """How a format is recognised by the file's name."""
    return lambda source: source.suffix in suffixes


def starts_with(magic: bytes) -> Callable[[Source], bool]:
    """How a format is recognised by its first bytes."""
    return lambda source: source.content.startswith(magic)


def read_source(path: Path) -> Source:
    """A file with its content; ConfigurationError if it cannot be read."""
    return Source(path, read_content(path))


def find_format(source: Source, formats: Sequence[Format]) -> Format | None:
    """The first format that knows a file; a plug-in puts its own before or behind the others."""
    load_plugins()
    return next((one for one in formats if one.recognises(source)), None)


def reason(error: Exception) -> str:
    """What another package's reader says of a damaged file."""
    return f"it is damaged: {one_line(str(error)) or type(error).__name__}"


def one_line(text: str) -> str:
    """Words with single spaces and without characters that cannot be printed."""
    return " ".join("".join(one if one.isprintable() else " " for one in text).split())


def require_sound_tiff(content: bytes) -> None:
    """Check the directories of a classic TIFF file."""
    order = _ORDERS.get(content[:4])
    if order is None or len(content) < 8:
        raise ValueError("not a TIFF file")
    seen: set[int] = set()
    place = struct.unpack_from(order + "I", content, 4)[0]
    while place:
        if place in seen or len(seen) >= _MOST_PAGES:
            raise ValueError("its directories go round in a circle")
        seen.add(place)
        if place + 2 > len(content):
            raise ValueError("a directory lies beyond the end of the file")
        count = struct.unpack_from(order + "H", content, place)[0]
        size = struct.calcsize(order + _ENTRY)
        end = place + 2 + count * size
        if end + 4 > len(content):
            raise ValueError("a directory is longer than the file")
        pixels = 1
        for start in range(place + 2, end, size):
            code, kind, values, where = struct.unpack_from(order + _ENTRY, content, start)
            if kind not in _SIZES:
                raise ValueError(f"entry {code} has the unknown type {kind}")
            held = values * _SIZES[kind]
            if held > 4 and where + held > len(content):
                raise ValueError(f"entry {code} lies beyond the end of the file")
            if code in _PIXELS and kind in (3, 4):
                short = struct.unpack_from(order + "H", content, start + 8)[0]
                pixels *= short if kind == 3 else where
        if pixels > 64 * len(content):  # compressed images hold more pixels than bytes
            raise ValueError("an image is larger than the file")
        place = int(struct.unpack_from(order + "I", content, end)[0])


Ordinate = Literal["transmittance", "reflectance"]  # Quantity that a spectrum shows

Collection = Literal["specular", "diffuse", "total"]
"""Light that was collected: the specular beam, what is scattered around it, or both."""

MOST_POINTS = 20_000_000  # Points of a spectrum beyond which a file is taken as damaged


@dataclass(frozen=True)
class SpectrumMetadata(ShortRepr):
    """What a file says of its spectrum, in the file's own words; empty where it says nothing."""

    format: str  #: Such as ``"JASCO text"``
    ordinate: str = ""  #: Such as ``"%T"``
    instrument: str = ""
    resolution: str = ""  #: With its unit, such as ``"4 cm-1"``
    accessory: str = ""
    sample: str = ""
    measured: str = ""  #: Date of the measurement


@dataclass(frozen=True)
class RawSpectrum(ShortRepr):
    """A spectrum as it stands in its file."""

    abscissa: np.ndarray  #: shape (n,); in the file's units
    ordinate: np.ndarray  #: shape (n,); in the file's units
    abscissa_name: str  #: Such as ``"1/CM"`` or ``"nm"``
    ordinate_name: str  #: Such as ``"%T"``
    metadata: SpectrumMetadata
    #: Whether the format fixes the ordinate as per cent, or as a fraction; None if its name and
    #: values must tell
    percent: bool | None = None
    notes: tuple[str, ...] = ()  #: What the reader decided
    rejected: tuple[Rejected, ...] = field(default=())  #: Rejected rows


def plain(text: bytes, encoding: str = "utf-8") -> str:
    """Words from a field of fixed width: up to its first zero byte, on one line."""
    words = text.partition(b"\x00")[0]
    try:
        return one_line(words.decode(encoding))
    except UnicodeDecodeError:
        return one_line(words.decode("cp1252", "replace"))
