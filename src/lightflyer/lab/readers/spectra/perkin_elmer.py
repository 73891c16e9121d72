"""PerkinElmer's ``.sp`` (blocks of tagged values) and ``.asc`` (PEDS text).

The layout of ``.sp`` is that which At.Matus.IO.PerkinElmerLib (MIT) and specio (BSD) document; that
of ``.asc`` is a header of lines at fixed places, ``#GR`` with the axes and ``#DATA`` with pairs.
"""

import struct
from collections.abc import Iterator

import numpy as np

from lightflyer.lab.readers.formats import RawSpectrum, Source, SpectrumMetadata, one_line

SP, ASC = "PerkinElmer .sp", "PerkinElmer .asc"

MAGIC = b"PEPE"
_HEADER = len(MAGIC) + 40
_BLOCK = struct.Struct("<Hi")  # tag, bytes
_DATA_SET = 120
_RANGE, _STEP, _COUNT, _X_LABEL, _Y_LABEL, _VALUES, _HISTORY = (
    35698, 35700, 35701, 35703, 35704, 35708, 35711
)  # fmt: skip
_NEEDED = {_RANGE: "range of the abscissa", _COUNT: "number of points", _X_LABEL: "abscissa",
           _Y_LABEL: "ordinate", _VALUES: "values"}  # fmt: skip
_DOUBLES = 29974
_DOUBLE = 8
_TEXT = b"#u"  # before a text in the history: tag, size, 0; then the text's length
_FIRST_TAG = 29839  # of the history, less than zero in the file
_METADATA = {5: "sample", 140: "instrument", 218: "accessory", 210: "resolution"}

_ASC_LINES = {"sample": 8, "instrument": 11, "measured": 3}
_ASC_FIRST, _ASC_COUNT = 5, 7  # lines behind #GR


def read_sp(source: Source) -> list[RawSpectrum]:
    """Read a binary spectrum of PerkinElmer; one for each set of data."""
    sets = [data for tag, data in _blocks(source, source.content[_HEADER:]) if tag == _DATA_SET]
    if not sets:
        source.refuse("holds no spectrum (no data set of PerkinElmer)")
    spectra = []
    for members in (dict(_blocks(source, data)) for data in sets):
        for tag, what in _NEEDED.items():
            if tag not in members:
                source.refuse(f"is damaged: its {what} is missing")
        first, last = struct.unpack_from("<2d", members[_RANGE], 2)
        (count,) = struct.unpack_from("<i", members[_COUNT], 2)
        kind, size = struct.unpack_from("<HI", members[_VALUES])
        values = members[_VALUES][6:]
        if kind != _DOUBLES or size != len(values) or size != _DOUBLE * count or count < 2:
            source.refuse(f"is damaged: it names {count} points and holds {len(values) // _DOUBLE}")
        if _STEP in members:
            (step,) = struct.unpack_from("<d", members[_STEP], 2)
            if not abs(abs(step) * (count - 1) - abs(last - first)) <= abs(step):
                source.refuse(
                    f"is damaged: {count} points in steps of {step:g} do not reach from {first:g} "
                    f"to {last:g}"
                )
        names = []
        for label in (members[_X_LABEL], members[_Y_LABEL]):
            (length,) = struct.unpack_from("<h", label, 2)
            names.append(one_line(label[4 : 4 + max(length, 0)].decode("cp1252", "replace")))
        data = members.get(_HISTORY, b"")
        found: dict[str, str] = {}
        at = data.find(_TEXT, 6)
        while at >= 0 and at + 4 <= len(data):
            tag, size, zero = struct.unpack_from("<3h", data, at - 6)
            (length,) = struct.unpack_from("<h", data, at + 2)
            name = _METADATA.get(tag + _FIRST_TAG)
            if zero == 0 and size - length == 4 and length > 0 and name:
                text = one_line(data[at + 4 : at + 4 + length].decode("cp1252", "replace"))
                found.setdefault(name, f"slit {text}" if name == "resolution" else text)
            at = data.find(_TEXT, at + 2)
        metadata = SpectrumMetadata(SP, **found)
        x, y = np.linspace(first, last, count), np.frombuffer(values, "<f8")
        spectra.append(RawSpectrum(x, y, names[0], names[1], metadata))
    return spectra


def _blocks(source: Source, data: bytes) -> Iterator[tuple[int, bytes]]:
    at = 0
    while at + _BLOCK.size <= len(data):
        tag, size = _BLOCK.unpack_from(data, at)
        at += _BLOCK.size
        if size < 0 or at + size > len(data):
            source.refuse(f"is damaged: a block of {size} bytes does not fit into it")
        yield tag, data[at : at + size]
        at += size


def is_asc(source: Source) -> bool:
    """Whether a file is a text export of PerkinElmer."""
    first = source.text[:80].split()
    return first[:1] == ["PE"] and "SUBTECH" in first and "PEDS" in first


def read_asc(source: Source) -> list[RawSpectrum]:
    """Read a text export of PerkinElmer; one."""
    lines = [line.strip() for line in source.text.splitlines()]
    technique = lines[0].split()[1]
    if technique == "FL":
        source.refuse("is a fluorescence spectrum, not transmittance or reflectance", 1)
    for mark in ("#GR", "#DATA"):
        if mark not in lines:
            source.refuse(f"is damaged: its line {mark} is missing")
    axes, start = lines.index("#GR"), lines.index("#DATA") + 1
    pairs = []
    for at, line in enumerate(lines[start:], start + 1):
        if line:
            try:
                first, second = map(float, line.replace(",", ".").split())
            except ValueError:
                source.refuse(f'"{line[:40]}" is not a pair of numbers', at)
            pairs.append((first, second))
    x, y = np.array(pairs, float).reshape(-1, 2).T
    grid = lines[axes + 1 : start]
    if len(grid) > _ASC_COUNT and grid[_ASC_COUNT - 1].isdigit():
        count = int(grid[_ASC_COUNT - 1][:12])
        if count != len(x):
            source.refuse(f"has {len(x)} points; its header says {count}", len(lines))
    said = {name: lines[at] for name, at in _ASC_LINES.items() if at < axes}
    metadata = {
        name: one_line(text)[:80] for name, text in said.items() if not text.startswith("#")
    }
    return [RawSpectrum(x, y, grid[0], grid[1], SpectrumMetadata(ASC, **metadata))]
