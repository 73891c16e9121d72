"""Galactic (GRAMS, Thermo) ``.spc``, new versions 4Bh and 4Ch and old version 4Dh.

After the published description of the format, "The Galactic SPC file format" (SPC.H, Galactic
Industries 1986-1997).
"""

import struct
from typing import NamedTuple

import numpy as np

from lightflyer.lab.readers.formats import MOST_POINTS, RawSpectrum, Source, SpectrumMetadata, plain

FORMAT = "Galactic .spc"

_LITTLE, _BIG, _OLD = 0x4B, 0x4C, 0x4D
_SHORT, _SEVERAL, _LABELS, _OWN_X, _X = 0x01, 0x04, 0x20, 0x40, 0x80  # flags
# flags, version, technique, exponent, points, first and last x, spectra, types of x, y and z
_NEW_HEADER = "BBBbIddIBBB"
_NEW_SIZE, _NEW_RESOLUTION, _NEW_SOURCE, _NEW_COMMENT, _NEW_LABELS = 512, 36, 45, 88, 218
_NEW_LOG = 248
_OLD_HEADER = "<BBhfffBB"  # flags, version, exponent, points, first and last x, types of x and y
_OLD_SIZE, _OLD_RESOLUTION, _OLD_COMMENT, _OLD_LABELS = 224, 24, 64, 194
_SUB_SIZE = 32
_SUB_COUNT = 16  # place of the number of points in the header of one of several spectra
_FLOATS = -128  # exponent of values that are floats
_COMMENT, _LABEL_TEXT = 130, 30
_ABSCISSAE = {1: "cm-1", 2: "um", 3: "nm", 13: "Raman shift"}
_ORDINATES = {0: "arbitrary", 1: "interferogram", 2: "absorbance", 3: "Kubelka-Munk", 4: "counts",
              10: "log(1/R)", 11: "%", 12: "intensity", 13: "relative intensity", 14: "energy",
              128: "transmittance", 129: "reflectance", 130: "single beam",
              131: "emission"}  # fmt: skip


class _Header(NamedTuple):
    flags: int
    exponent: int
    points: int
    first: float
    last: float
    spectra: int
    abscissa: str
    ordinate: str
    order: str  # of bytes
    size: int
    log: int  # where the log behind the spectra starts, 0 without one
    metadata: SpectrumMetadata


def is_spc(source: Source) -> bool:
    """Whether a file is one of GRAMS."""
    return (
        source.suffix == ".spc"
        and len(source.content) > _OLD_SIZE + _SUB_SIZE
        and source.content[1] in (_LITTLE, _BIG, _OLD)
    )


def read_spc(source: Source) -> list[RawSpectrum]:
    """Read all spectra of a GRAMS file; in the order of the file."""
    header = _old(source) if source.content[1] == _OLD else _new(source)
    if not 1 <= header.spectra <= len(source.content) // _SUB_SIZE:
        source.refuse(f"is damaged: it names {header.spectra} spectra")
    curves: list[tuple[np.ndarray, np.ndarray]] = []
    data, at = source.content, header.size
    order = "<" if header.order == "old" else header.order
    own_x = header.flags & _X and header.flags & _OWN_X
    if not own_x:
        _require_count(source, header.points)
        x = np.linspace(header.first, header.last, header.points)
    if header.flags & _X and not own_x:
        x, at = _take(source, at, order + "f4", header.points)
    for _ in range(header.spectra):
        exponent, points = header.exponent, header.points
        if at + _SUB_SIZE > len(data):
            source.refuse("is damaged: it ends before its last spectrum")
        if header.flags & _SEVERAL and exponent != _FLOATS:
            (exponent,) = struct.unpack_from("b", data, at + 1)
        if own_x:
            (points,) = struct.unpack_from(order + "I", data, at + _SUB_COUNT)
            _require_count(source, points)
        at += _SUB_SIZE
        if own_x:
            x, at = _take(source, at, order + "f4", points)
        bits = 16 if header.flags & _SHORT else 32
        if exponent == _FLOATS:
            y, at = _take(source, at, order + "f4", points)
        elif header.order == "old" and bits == 32:  # the words of an integer are exchanged
            pairs, at = _take(source, at, "<u2", 2 * points)
            words = pairs.astype(np.uint32).reshape(-1, 2)
            y = ((words[:, 0] << 16) | words[:, 1]).astype(np.int32)
        else:
            y, at = _take(source, at, f"{order}i{bits // 8}", points)
        y = y.astype(float)
        y = y if exponent == _FLOATS else np.ldexp(y, exponent - bits)
        curves.append((x.astype(float), y))
    end = header.log or len(data)
    notes = (
        ()
        if at == end or header.flags & _OWN_X
        else (f"{end - at} bytes behind its values are not read: is it damaged?",)
    )
    return [
        RawSpectrum(x, y, header.abscissa, header.ordinate, header.metadata, notes=notes)
        for x, y in curves
    ]


def _new(source: Source) -> _Header:
    data = source.content
    order = "<" if data[1] == _LITTLE else ">"
    (flags, _, _, exponent, points, first, last, spectra, x, y, _) = struct.unpack_from(
        order + _NEW_HEADER, data
    )
    metadata = SpectrumMetadata(
        FORMAT,
        instrument=plain(data[_NEW_SOURCE : _NEW_SOURCE + 9]),
        resolution=plain(data[_NEW_RESOLUTION : _NEW_RESOLUTION + 9]),
        sample=plain(data[_NEW_COMMENT : _NEW_COMMENT + _COMMENT]),
    )
    (log,) = struct.unpack_from(order + "I", data, _NEW_LOG)
    named = _names(flags, x, y, data[_NEW_LABELS : _NEW_LABELS + _LABEL_TEXT])
    return _Header(flags, exponent, points, first, last, spectra if flags & _SEVERAL else 1,
                   *named, order, _NEW_SIZE, log, metadata)  # fmt: skip


def _old(source: Source) -> _Header:
    data = source.content
    flags, _, exponent, points, first, last, x, y = struct.unpack_from(_OLD_HEADER, data)
    if flags & _SEVERAL:
        source.refuse("holds several spectra in the old version 4Dh; save it in a newer version")
    if not 2 <= points <= MOST_POINTS:
        source.refuse(f"is damaged: it names {points:g} points")
    metadata = SpectrumMetadata(
        FORMAT,
        resolution=plain(data[_OLD_RESOLUTION : _OLD_RESOLUTION + 8]),
        sample=plain(data[_OLD_COMMENT : _OLD_COMMENT + _COMMENT]),
    )
    named = _names(flags, x & 0x7F, y, data[_OLD_LABELS : _OLD_LABELS + _LABEL_TEXT])
    return _Header(flags & ~(_X | _OWN_X), exponent, int(points), first, last, 1, *named, "old",
                   _OLD_SIZE, 0, metadata)  # fmt: skip


def _names(flags: int, x: int, y: int, labels: bytes) -> tuple[str, str]:
    if flags & _LABELS:
        words = [plain(word) for word in labels.split(b"\x00")]
        if len(words) >= 2 and words[0] and words[1]:
            return words[0], words[1]
    return _ABSCISSAE.get(x, f"unit {x}"), _ORDINATES.get(y, f"ordinate {y}")


def _take(source: Source, at: int, kind: str, count: int) -> tuple[np.ndarray, int]:
    dtype = np.dtype(kind)
    end = at + count * dtype.itemsize
    if end > len(source.content):
        source.refuse(f"is damaged: it ends before its {count} points")
    return np.frombuffer(source.content[at:end], dtype), end


def _require_count(source: Source, count: int) -> None:
    if not 2 <= count <= MOST_POINTS:
        source.refuse(f"is damaged: it names {count} points")
