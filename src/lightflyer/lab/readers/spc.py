"""Galactic (GRAMS, Thermo) ``.spc``, new versions 4Bh and 4Ch and old version 4Dh.

After the published description of the format, "The Galactic SPC file format" (SPC.H, Galactic
Industries 1986-1997).
"""

import struct

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


def is_spc(source: Source) -> bool:
    """Whether a file is one of GRAMS."""
    return (
        source.suffix == ".spc"
        and len(source.content) > _OLD_SIZE + _SUB_SIZE
        and source.content[1] in (_LITTLE, _BIG, _OLD)
    )


def read_spc(source: Source) -> list[RawSpectrum]:
    """Read all spectra of a GRAMS file; in the order of the file."""
    data = source.content
    old = data[1] == _OLD
    if old:
        order, log, at, labels = "<", 0, _OLD_SIZE, _OLD_LABELS
        flags, _, exponent, points, first, last, abscissa, ordinate = struct.unpack_from(
            _OLD_HEADER, data
        )
        if flags & _SEVERAL:
            source.refuse(
                "holds several spectra in the old version 4Dh; save it in a newer version"
            )
        if not 2 <= points <= MOST_POINTS:
            source.refuse(f"is damaged: it names {points:g} points")
        flags, points, spectra, abscissa = flags & ~(_X | _OWN_X), int(points), 1, abscissa & 0x7F
        metadata = SpectrumMetadata(
            FORMAT,
            resolution=plain(data[_OLD_RESOLUTION : _OLD_RESOLUTION + 8]),
            sample=plain(data[_OLD_COMMENT : _OLD_COMMENT + _COMMENT]),
        )
    else:
        order, at, labels = "<" if data[1] == _LITTLE else ">", _NEW_SIZE, _NEW_LABELS
        (flags, _, _, exponent, points, first, last, spectra, abscissa, ordinate, _) = (
            struct.unpack_from(order + _NEW_HEADER, data)
        )
        spectra = spectra if flags & _SEVERAL else 1
        (log,) = struct.unpack_from(order + "I", data, _NEW_LOG)
        metadata = SpectrumMetadata(
            FORMAT,
            instrument=plain(data[_NEW_SOURCE : _NEW_SOURCE + 9]),
            resolution=plain(data[_NEW_RESOLUTION : _NEW_RESOLUTION + 9]),
            sample=plain(data[_NEW_COMMENT : _NEW_COMMENT + _COMMENT]),
        )
    names = [plain(word) for word in data[labels : labels + _LABEL_TEXT].split(b"\x00")[:2]]
    if not flags & _LABELS or len(names) < 2 or not all(names):
        names = [
            _ABSCISSAE.get(abscissa, f"unit {abscissa}"),
            _ORDINATES.get(ordinate, f"ordinate {ordinate}"),
        ]
    if not 1 <= spectra <= len(data) // _SUB_SIZE:
        source.refuse(f"is damaged: it names {spectra} spectra")
    curves: list[tuple[np.ndarray, np.ndarray]] = []
    own_x = flags & _X and flags & _OWN_X
    if not own_x:
        _require_count(source, points)
        x = np.linspace(first, last, points)
        if flags & _X:
            x, at = _take(source, at, order + "f4", points)
    for _ in range(spectra):
        of_one, count = exponent, points
        if at + _SUB_SIZE > len(data):
            source.refuse("is damaged: it ends before its last spectrum")
        if flags & _SEVERAL and of_one != _FLOATS:
            (of_one,) = struct.unpack_from("b", data, at + 1)
        if own_x:
            (count,) = struct.unpack_from(order + "I", data, at + _SUB_COUNT)
            _require_count(source, count)
        at += _SUB_SIZE
        if own_x:
            x, at = _take(source, at, order + "f4", count)
        bits = 16 if flags & _SHORT else 32
        if of_one == _FLOATS:
            y, at = _take(source, at, order + "f4", count)
        elif old and bits == 32:  # the words of an integer are exchanged
            pairs, at = _take(source, at, "<u2", 2 * count)
            words = pairs.astype(np.uint32).reshape(-1, 2)
            y = ((words[:, 0] << 16) | words[:, 1]).astype(np.int32)
        else:
            y, at = _take(source, at, f"{order}i{bits // 8}", count)
        y = y.astype(float)
        y = y if of_one == _FLOATS else np.ldexp(y, of_one - bits)
        curves.append((x.astype(float), y))
    end = log or len(data)
    notes = (
        ()
        if at == end or flags & _OWN_X
        else (f"{end - at} bytes behind its values are not read: is it damaged?",)
    )
    return [RawSpectrum(x, y, names[0], names[1], metadata, notes=notes) for x, y in curves]


def _take(source: Source, at: int, kind: str, count: int) -> tuple[np.ndarray, int]:
    dtype = np.dtype(kind)
    end = at + count * dtype.itemsize
    if end > len(source.content):
        source.refuse(f"is damaged: it ends before its {count} points")
    return np.frombuffer(source.content[at:end], dtype), end


def _require_count(source: Source, count: int) -> None:
    if not 2 <= count <= MOST_POINTS:
        source.refuse(f"is damaged: it names {count} points")
