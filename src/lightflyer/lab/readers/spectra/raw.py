"""What a reader of spectra hands on: numbers and words as they stand in the file."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.files.table_rows import Rejected
from lightflyer.lab.readers.formats import one_line

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
