"""Thermo (Nicolet) OMNIC: one spectrum (``.spa``) or a group of them (``.spg``).

The layout is that which spectrochempy-omnic (CeCILL-B) documents: a list of entries of 16 bytes,
each with a key and the place and size of what it names.
"""

import re
import struct
from typing import NamedTuple

import numpy as np

from lightflyer.lab.readers.formats import MOST_POINTS, RawSpectrum, Source, SpectrumMetadata, plain

FORMAT = "Thermo OMNIC"

MAGIC = b"Spectral Data File"
_AT_NAME, _AT_COUNT, _AT_ENTRIES = 30, 294, 304
_ENTRY = struct.Struct("<BxII6x")  # key, place, bytes
_NAME = 256
_HEADER, _VALUES, _HISTORY, _TITLE = 2, 3, 27, 107
_END = (0, 1)
_AXIS = struct.Struct("<4xIB3xB3xff")  # points, units of abscissa and ordinate, first, last
_ABSCISSAE = {1: "cm-1", 2: "data points", 3: "nm", 4: "um", 32: "Raman shift"}
_ORDINATES = {11: "%R", 15: "single beam", 16: "%T", 17: "absorbance", 20: "Kubelka-Munk",
              21: "reflectance", 22: "interferogram", 26: "photoacoustic signal",
              31: "Raman intensity"}  # fmt: skip
_AMBIGUOUS = 12  # log(1/R) or Kubelka-Munk: sources differ
_RESOLUTION = re.compile(r"Resolution:?\s*([\d.]+)")


class _Item(NamedTuple):
    key: int
    place: int
    size: int


def read_omnic(source: Source) -> list[RawSpectrum]:
    """Read all spectra of an OMNIC file; in the order of the file."""
    content = source.content
    (count,) = struct.unpack_from("<H", content, _AT_COUNT)
    entries: list[_Item] = []  # whose number stands before them; 0 or 1 ends them too
    at = _AT_ENTRIES
    while at + _ENTRY.size <= len(content) and (len(entries) < count or not count):
        entry = _Item(*_ENTRY.unpack_from(content, at))
        if not count and entry.key in _END:
            break
        entries.append(entry)
        at += _ENTRY.size
    groups = {
        key: [entry for entry in entries if entry.key == key]
        for key in (_HEADER, _VALUES, _TITLE, _HISTORY)
    }
    headers, values = groups[_HEADER], groups[_VALUES]
    if not headers or len(headers) != len(values):
        source.refuse(
            f"is damaged or holds no spectrum: {len(headers)} headers, {len(values)} sets of values"
        )
    name = plain(content[_AT_NAME : _AT_NAME + _NAME])
    titles = [plain(content[one.place : one.place + _NAME]) for one in groups[_TITLE]]
    if len(headers) == 1 or len(titles) != len(headers):
        titles = [name if len(headers) == 1 else ""] * len(headers)
    resolution = ""  # in the history of a single spectrum
    if len(groups[_HISTORY]) == 1:
        _, place, size = groups[_HISTORY][0]
        match = _RESOLUTION.search(content[place : place + size].decode("cp1252", "replace"))
        resolution = f"{match[1]} cm-1" if match else ""
    spectra = []
    for header, value, title in zip(headers, values, titles, strict=True):
        count, unit, ordinate, first, last = _AXIS.unpack_from(content, header.place)
        data = content[value.place : value.place + value.size]
        if not 2 <= count <= MOST_POINTS or len(data) != value.size or value.size != 4 * count:
            source.refuse(f"is damaged: it names {count} points and holds {len(data) // 4}")
        if ordinate == _AMBIGUOUS:
            source.refuse(
                "shows log(1/R) or Kubelka-Munk units, which share a code; export it as %R"
            )
        spectra.append(RawSpectrum(
            np.linspace(first, last, count), np.frombuffer(data, "<f4").astype(float),
            _ABSCISSAE.get(unit, f"unit {unit}"), _ORDINATES.get(ordinate, f"ordinate {ordinate}"),
            SpectrumMetadata(FORMAT, sample=title, resolution=resolution),
        ))  # fmt: skip
    return spectra
