"""Spectra in the formats of Bruker, Thermo, PerkinElmer and Galactic (GRAMS).

Bruker OPUS is parsed by brukeropus (MIT): results of a measurement among its raw channels.

Thermo (Nicolet) OMNIC is one spectrum (``.spa``) or a group of them (``.spg``). The layout is that
which spectrochempy-omnic (CeCILL-B) documents: a list of entries of 16 bytes, each with a key and
the place and size of what it names.

PerkinElmer's ``.sp`` is blocks of tagged values, after At.Matus.IO.PerkinElmerLib (MIT) and specio
(BSD); its ``.asc`` (PEDS text) is a header of lines at fixed places, ``#GR`` with the axes and
``#DATA`` with pairs.

Galactic's ``.spc``, new versions 4Bh and 4Ch and old version 4Dh, is after the published
description, "The Galactic SPC file format" (SPC.H, Galactic Industries 1986-1997).
"""

import re
import struct
import warnings
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.extras import extra
from lightflyer.lab.readers.formats import (
    MOST_POINTS,
    WORDS,
    RawSpectrum,
    Source,
    SpectrumMetadata,
    one_line,
    plain,
)

OPUS = "Bruker OPUS"

OPUS_MAGIC = b"\n\n\xfe\xfe"
_KINDS = WORDS["opus"]["ordinates"]
_ROUNDED = 1e-5  # by which the stated extremes may differ from the data, of the largest
_OPUS_END = b"END"
_PARAMETER = 8  # bytes before a parameter's value

OMNIC = "Thermo OMNIC"

OMNIC_MAGIC = b"Spectral Data File"
_AT_NAME, _AT_COUNT, _AT_ENTRIES = 30, 294, 304
_ENTRY = struct.Struct("<BxII6x")  # key, place, bytes
_NAME = 256
_OMNIC_HEADER, _OMNIC_VALUES, _OMNIC_HISTORY, _TITLE = 2, 3, 27, 107
_END = (0, 1)
_AXIS = struct.Struct("<4xIB3xB3xff")  # points, units of abscissa and ordinate, first, last
_AMBIGUOUS = 12  # log(1/R) or Kubelka-Munk: sources differ
_RESOLUTION = re.compile(r"Resolution:?\s*([\d.]+)")

SP, ASC = "PerkinElmer .sp", "PerkinElmer .asc"

SP_MAGIC = b"PEPE"
_HEADER = len(SP_MAGIC) + 40
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
_ASC_COUNT = 7  # lines behind #GR


SPC = "Galactic .spc"

_LITTLE, _BIG, _OLD = 0x4B, 0x4C, 0x4D
_SHORT, _SEVERAL, _LABELS, _OWN_X, _X = 0x01, 0x04, 0x20, 0x40, 0x80  # flags
# flags, exponent, points, first and last x, spectra, types of x and y, resolution, instrument,
# comment, names of the axes, place of the log
_NEW_HEADER, _NEW_SIZE = "BxxbIddIBB6x9s9s34x130s30sI", 512
# the same of the old version, without number of spectra, instrument and log
_OLD_HEADER, _OLD_SIZE = "<BxhfffBB6x8s32x130s30s", 224
_SUB_SIZE = 32
_SUB_COUNT = 16  # place of the number of points in the header of one of several spectra
_FLOATS = -128  # exponent of values that are floats


def _names(maker: str, abscissa: int, ordinate: int) -> tuple[str, str]:
    """Names of axes by their codes."""
    known = WORDS[maker]
    return (
        known["abscissae"].get(str(abscissa), f"unit {abscissa}"),
        known["ordinates"].get(str(ordinate), f"ordinate {ordinate}"),
    )


def read_opus(source: Source) -> list[RawSpectrum]:
    """Read all spectra of an OPUS file."""
    with warnings.catch_warnings():  # of Python 3.12 about escapes in its docstrings
        warnings.simplefilter("ignore", SyntaxWarning)
        extra("brukeropus.file", "reading Bruker OPUS files", "lab")
    from brukeropus.file.block import FileBlock, pair_data_and_status_blocks
    from brukeropus.file.parse import parse_directory, parse_header

    data = source.content
    _, start, most, _ = parse_header(data)
    size = 12 * most  # type, size and place of each block
    if not 0 < start < len(data) or not 0 < size <= len(data):
        source.refuse("is damaged: its directory is outside the file")
    listed = data[start : start + size]
    blocks = []
    said: dict[str, Any] = {}
    for kind, length, place in parse_directory(listed[: len(listed) // 12 * 12]):
        if length < 0 or place + length > len(data):
            source.refuse(f"is damaged: a block of {length} bytes does not fit into it")
        block = FileBlock(filebytes=data, block_type=kind, size=length, start=place)
        if block.is_data() or (block.is_param() and _ends(block.bytes)):  # or the parser hangs
            block.parse()
        if block.data is not None and not block.parse_error:
            blocks.append(block)
            if block.is_sm_param() and isinstance(block.data, dict):
                said.update(block.data)
    metadata = SpectrumMetadata(
        OPUS,
        instrument=one_line(str(said.get("ins", ""))),
        resolution=f"{said['res']:g} cm-1" if isinstance(said.get("res"), float) else "",
        accessory=one_line(str(said.get("acc", ""))),
        sample=one_line(str(said.get("snm", ""))),
    )
    pairs = pair_data_and_status_blocks(blocks)
    found = [
        _spectrum(source, data, status.data, metadata)
        for data, status in sorted(pairs, key=lambda pair: pair[0].start)
        if data.is_data() and data.get_data_key().rstrip("_2345678") in _KINDS
    ]
    if not found:
        source.refuse("holds no spectrum; a series of spectra must be exported one by one")
    return found


def _ends(parameters: bytes) -> bool:
    """Whether a list of parameters ends: a negative size would lead back."""
    at = 0
    while at + _PARAMETER <= len(parameters) and parameters[at : at + 3] != _OPUS_END:
        (size,) = struct.unpack_from("<h", parameters, at + 6)
        if size < 0:
            return False
        at += _PARAMETER + 2 * size
    return True


def _spectrum(
    source: Source, block: Any, said: dict[str, Any], metadata: SpectrumMetadata
) -> RawSpectrum:
    for key in ("npt", "fxv", "lxv"):
        if not isinstance(said.get(key), int | float):
            source.refuse(f"is damaged: a spectrum has no {key.upper()}")
    count = said["npt"]
    # blocks may be longer than their spectrum
    values = block.data[-count:] if block.is_compact_data() else block.data[:count]
    if not 2 <= count <= MOST_POINTS or len(values) != count:
        source.refuse(f"is damaged: it names {count} points and holds {len(values)}")
    with np.errstate(all="ignore"):
        y = values.astype(float) * said.get("csf", 1.0)
    name = _KINDS[block.get_data_key().rstrip("_2345678")]
    for key, value in (("mny", y.min()), ("mxy", y.max())):
        stated = None if "interferogram" in name else said.get(key)
        if isinstance(stated, float) and not abs(stated - value) <= _ROUNDED * np.abs(y).max():
            source.refuse(
                f"is damaged: it says {key.upper()} {stated:g} of {name}, the data {value:g}"
            )
    words = " ".join(str(said[key]) for key in ("dat", "tim") if key in said)
    return RawSpectrum(
        np.linspace(said["fxv"], said["lxv"], count), y,
        WORDS["opus"]["abscissae"].get(str(said.get("dxu")), str(said.get("dxu"))), name,
        replace(metadata, measured=one_line(words)),
        percent=False if name in ("transmittance", "reflectance") else None,
    )  # fmt: skip


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
        for key in (_OMNIC_HEADER, _OMNIC_VALUES, _TITLE, _OMNIC_HISTORY)
    }
    headers, values = groups[_OMNIC_HEADER], groups[_OMNIC_VALUES]
    if not headers or len(headers) != len(values):
        source.refuse(
            f"is damaged or holds no spectrum: {len(headers)} headers, {len(values)} sets of values"
        )
    name = plain(content[_AT_NAME : _AT_NAME + _NAME])
    titles = [plain(content[one.place : one.place + _NAME]) for one in groups[_TITLE]]
    if len(headers) == 1 or len(titles) != len(headers):
        titles = [name if len(headers) == 1 else ""] * len(headers)
    resolution = ""  # in the history of a single spectrum
    if len(groups[_OMNIC_HISTORY]) == 1:
        _, place, size = groups[_OMNIC_HISTORY][0]
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
            *_names("omnic", unit, ordinate),
            SpectrumMetadata(OMNIC, sample=title, resolution=resolution),
        ))  # fmt: skip
    return spectra


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
        order, at, spectra, instrument, log = "<", _OLD_SIZE, 1, b"", 0
        (flags, exponent, points, first, last, abscissa, ordinate, resolution, comment, labels) = (
            struct.unpack_from(_OLD_HEADER, data)
        )
        if flags & _SEVERAL:
            source.refuse(
                "holds several spectra in the old version 4Dh; save it in a newer version"
            )
        if not 2 <= points <= MOST_POINTS:
            source.refuse(f"is damaged: it names {points:g} points")
        flags, points, abscissa = flags & ~(_X | _OWN_X), int(points), abscissa & 0x7F
    else:
        order, at = "<" if data[1] == _LITTLE else ">", _NEW_SIZE
        (
            flags, exponent, points, first, last, spectra, abscissa, ordinate, resolution,
            instrument, comment, labels, log,
        ) = struct.unpack_from(order + _NEW_HEADER, data)  # fmt: skip
        spectra = spectra if flags & _SEVERAL else 1
    metadata = SpectrumMetadata(
        SPC, instrument=plain(instrument), resolution=plain(resolution), sample=plain(comment)
    )
    names = [plain(word) for word in labels.split(b"\x00")[:2]]
    if not flags & _LABELS or len(names) < 2 or not all(names):
        names = [*_names("spc", abscissa, ordinate)]
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
