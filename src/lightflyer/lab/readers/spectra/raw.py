"""What a reader of spectra hands on: numbers and words as they stand in the file."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, NamedTuple, NoReturn

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.files.table import Rejected

Ordinate = Literal["transmittance", "reflectance"]
"""Quantity that a spectrum shows."""

Collection = Literal["specular", "diffuse", "total"]
"""Light that was collected: the specular beam, what is scattered around it, or both."""

MOST_POINTS = 20_000_000
"""Points of a spectrum beyond which a file is taken as damaged."""


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

    def refuse(self, why: str, line: int | None = None) -> NoReturn:
        """Refuse the file; ``why``: what is wrong; ``line``: counted from 1."""
        place = f"{self.path}" if line is None else f"{self.path}:{line}"
        raise ConfigurationError(f"{place}: {one_line(why)}")


@dataclass(frozen=True)
class SpectrumMetadata:
    """What a file says of its spectrum, in the file's own words; empty where it says nothing.

    Attributes
    ----------
    format : str
        Such as ``"JASCO text"``.
    ordinate : str
        Such as ``"%T"``.
    instrument : str
    resolution : str
        With its unit, such as ``"4 cm-1"``.
    accessory : str
    sample : str
    measured : str
        Date of the measurement.
    """

    format: str
    ordinate: str = ""
    instrument: str = ""
    resolution: str = ""
    accessory: str = ""
    sample: str = ""
    measured: str = ""


@dataclass(frozen=True)
class RawSpectrum:
    """A spectrum as it stands in its file."""

    abscissa: np.ndarray  # shape (n,); in the file's units
    ordinate: np.ndarray  # shape (n,); in the file's units
    abscissa_name: str  # Such as ``"1/CM"`` or ``"nm"``
    ordinate_name: str  # Such as ``"%T"``
    metadata: SpectrumMetadata
    # Whether the format fixes the ordinate as per cent, or as a fraction; None if its name and
    # values must tell
    percent: bool | None = None
    notes: tuple[str, ...] = ()  # What the reader decided
    rejected: tuple[Rejected, ...] = field(default=())  # Rejected rows


def plain(text: bytes, encoding: str = "utf-8") -> str:
    r"""Words from a field of fixed width: up to its first zero byte, on one line.

    Examples
    --------
    >>> plain(b"Nicolet  iS50\x00\x07\x07")
    'Nicolet iS50'
    """
    words = text.partition(b"\x00")[0]
    try:
        return one_line(words.decode(encoding))
    except UnicodeDecodeError:
        return one_line(words.decode("cp1252", "replace"))


def one_line(text: str) -> str:
    """Words with single spaces and without characters that cannot be printed."""
    return " ".join("".join(one if one.isprintable() else " " for one in text).split())
