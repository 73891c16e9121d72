"""JASCO: text exports of Spectra Manager, and its binary ``.jws`` and ``.jrs``.

The layouts are those that JASCOFiles.jl (MIT) documents, found with files of FT/IR-4600 and V-730
instruments. Binary files are one block (Spectra Manager 2) or an OLE container (1.x). The ordinate
of transmittance and reflectance is per cent, whatever the header's ``YUNITS`` calls it.
"""

import io
import re
import struct

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

TEXT = "JASCO text"

_START = re.compile(r"\s*TITLE\s*[\t,;]", re.I)
_TABLE = re.compile(r"^XYDATA[\t,; ]*\r?$", re.I | re.M)
_ROUNDED = 1e-3  # by which an extreme value of the header may differ from the data, of the largest
_PER_CENT = {"transmittance", "reflectance", "%t", "%r"}

JWS = "JASCO .jws"

_MAGIC = b"L~S "
_OLE_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_LABELS = WORDS["jasco"]["labels"]
_ABSCISSAE, _ORDINATES = WORDS["jasco"]["abscissae"], WORDS["jasco"]["ordinates"]
_GRID = struct.Struct("<iddd")  # points, first, last, step
_AT_GRID, _AT_UNITS, _AT_LENGTH = 0x84, 0xA0, 0xC8
_AT_INSTRUMENT, _AT_TITLE, _AT_DATA = 0x140, 0x180, 0x740
_WORDS = 32  # width of the fields of text
_FLOAT = 4  # bytes of an ordinate
_OLE_GRID = struct.Struct("<6I3d2I")  # version, 2 unknown, channels, 1 unknown, then the grid
_OLE_VERSION = 3
_MARKER = 0x10000100  # of a spectral axis; its unit is in the low byte
_TYPES = {2: "<H", 3: "<I", 4: "<f", 5: "<d"}  # of values in a list of tags; 8 is text
_FTIR_MODULE = 9
_RESOLUTION_TAG = 2


def is_jasco_text(source: Source) -> bool:
    """Whether a file is a text export of JASCO."""
    text = source.text[:20_000]
    return bool(_START.match(text)) and bool(_TABLE.search(source.text))


def read_jasco_text(source: Source) -> list[RawSpectrum]:
    """Read the spectrum of a text export; one."""
    lines = source.text.splitlines()
    start = next(at for at, line in enumerate(lines) if _TABLE.match(line))
    header = _labels(lines[:start])

    def number(key: str) -> float:
        try:
            return float(header.get(key, "").replace(",", "."))
        except ValueError:
            return np.nan

    stated = header.get("NPOINTS")
    if stated is not None and not (stated.isascii() and stated.isdigit()):
        source.refuse(f'NPOINTS "{stated[:20]}" is not a number of points')
    count = None if stated is None else int(stated[:12])
    pairs: list[tuple[float, float]] = []
    end = start + 1
    while end < len(lines) and lines[end].strip() and len(pairs) != count:
        mark = next((one for one in ("\t", ";", ",") if one in lines[end]), None)
        cells = [one.strip() for one in lines[end].split(mark)]
        if mark != ",":
            cells = [one.replace(",", ".") for one in cells]
        end += 1
        if len(cells) > 2:
            source.refuse(f"has {len(cells)} columns; a spectrum has two", end)
        try:
            first, second = map(float, cells)
        except ValueError:
            source.refuse(f'"{lines[end - 1].strip()[:40]}" is not a pair of numbers', end)
        pairs.append((first, second))
    x, y = np.array(pairs, float).reshape(-1, 2).T
    if count is not None and len(x) != count:
        source.refuse(f"has {len(x)} points; its header says NPOINTS {count}", end)
    if len(x) < 2:
        source.refuse(f"has {len(x)} points; a spectrum needs two or more")
    step = float(np.abs(np.diff(x)).max())
    for key, value in (("FIRSTX", x[0]), ("LASTX", x[-1])):
        if abs(number(key) - value) > step:
            source.refuse(f"is damaged: its header says {key} {number(key):g}, the data {value:g}")
    kind = header.get("DATA TYPE", "")
    if "RAMAN" in kind.upper():
        source.refuse(f'is of "{one_line(kind)[:40]}", not transmittance or reflectance')
    said = header | {key: one for key, one in _labels(lines[end:]).items() if key not in header}
    metadata = {
        name: one_line(next((said[key] for key in keys if said.get(key)), ""))[:80]
        for name, keys in _LABELS.items()
        if name != "ordinate"
    }
    named = header.get("YUNITS", "")
    ordinate = next((said[key] for key in _LABELS["ordinate"] if said.get(key)), named)
    per_cent = named.casefold() in _PER_CENT
    return [
        RawSpectrum(
            x, y, header.get("XUNITS", ""),
            # the axis tells %T from a bare "TRANSMITTANCE", but can be in any language
            ordinate if per_cent and "%" in ordinate else named,
            SpectrumMetadata(TEXT, **metadata),
            percent=True if per_cent else None,
            notes=tuple(
                f"its header says {key} {number(key):g}, the data {value:g}: was it edited?"
                for key, value in (("FIRSTY", y[0]), ("MAXY", y.max()), ("MINY", y.min()))
                if abs(number(key) - value) > _ROUNDED * np.abs(y).max()
            ),
        )
    ]  # fmt: skip


def _labels(lines: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for line in lines:
        parts = re.split(r"[\t,;]", line, maxsplit=1)
        key = parts[0].strip()
        if len(parts) == 2 and key:
            found.setdefault(key, parts[1].strip())
    return found


def is_jws(source: Source) -> bool:
    """Whether a file is a binary one of JASCO."""
    ole = source.content.startswith(_OLE_MAGIC)
    return source.content.startswith(_MAGIC) or (ole and source.suffix in (".jws", ".jwb", ".jrs"))


def read_jws(source: Source) -> list[RawSpectrum]:
    """Read a binary file of JASCO; one."""
    if source.content.startswith(_OLE_MAGIC):
        olefile = extra("olefile", "reading .jws files of Spectra Manager 1.x", "lab")
        with olefile.OleFileIO(io.BytesIO(source.content)) as container:
            streams = {
                name: container.openstream(name).read()
                for name in ("DataInfo", "Y-Data", "SampleInfo", "ModuleInfo", "MeasParam")
                if container.exists(name)
            }
            if container.exists("X-Data"):
                source.refuse("has points at unequal distances, as Raman spectra have; export text")
        for name in ("DataInfo", "Y-Data"):
            if name not in streams:
                source.refuse(f"is not a spectrum of JASCO: it has no {name}")
        version, _, _, channels, _, count, first, last, step, axis, mode = _OLE_GRID.unpack_from(
            streams["DataInfo"]
        )
        if version != _OLE_VERSION or axis & ~0xFF != _MARKER:
            source.refuse(f"is of a version ({version}) that is not known; export text")
        if channels != 1:
            source.refuse(f"holds {channels} channels; export the one you want as text")
        if len(streams["Y-Data"]) != _FLOAT * count:
            source.refuse(f"is damaged: it names {count} points and holds other data")
        metadata = SpectrumMetadata(
            JWS,
            instrument=_words(streams.get("ModuleInfo", b""), which=1),
            resolution=_resolution(streams),
            sample=_words(streams.get("SampleInfo", b""), which=0),
        )
        values, unit = streams["Y-Data"], axis & 0xFF
    else:
        data = source.content
        count, first, last, step = _GRID.unpack_from(data, _AT_GRID)
        unit, mode = data[_AT_UNITS], data[_AT_UNITS + 4]
        (length,) = struct.unpack_from("<q", data, _AT_LENGTH)
        values = data[_AT_DATA:]
        if length != _FLOAT * count or len(data) - length != _AT_DATA:
            source.refuse(
                f"is damaged: its {len(data)} bytes do not hold the {count} points it names"
            )
        metadata = SpectrumMetadata(
            JWS,
            instrument=plain(data[_AT_INSTRUMENT : _AT_INSTRUMENT + _WORDS]),
            sample=plain(data[_AT_TITLE : _AT_TITLE + 2 * _WORDS], "cp932"),
        )
    y = np.frombuffer(values, "<f4")
    if not 2 <= count <= MOST_POINTS or len(y) != count:
        source.refuse(f"is damaged: it names {count} points and holds {len(y)}")
    end = first + step * (count - 1)
    if not np.isfinite([first, last, end]).all() or step == 0.0:
        source.refuse(f"is damaged: {first:g} in steps of {step:g} is no abscissa")
    notes = (
        ()
        if abs(end - last) <= abs(step)
        else (f"it says that it ends at {last:g}, its {count} points at {end:g}: was it stopped?",)
    )
    abscissa, ordinate = _ABSCISSAE.get(str(unit)), _ORDINATES.get(str(mode))
    if abscissa is None or ordinate is None:
        source.refuse(f"its axes have the unknown codes {unit} and {mode}; export text")
    x, percent = first + step * np.arange(count), ordinate.startswith("%")
    return [
        RawSpectrum(x, y.astype(float), abscissa, ordinate, metadata, percent=percent, notes=notes)
    ]


def _text(data: bytes, at: int) -> tuple[str, int]:
    """A text with its length before it, and where it ends."""
    (length,) = struct.unpack_from("<I", data, at)
    end = at + 4 + length
    if end > len(data):
        raise struct.error("a text is longer than its block")
    return data[at + 4 : end].decode("utf-16-le", "replace").rstrip("\x00"), end


def _words(stream: bytes, which: int) -> str:
    """Name of the sample, or model of the instrument behind the module's name and number."""
    try:
        text, end = _text(stream, 4)
        return text if which == 0 else _text(stream, end + 4)[0]
    except struct.error:
        return ""


def _resolution(streams: dict[str, bytes]) -> str:
    try:
        _, end = _text(streams["ModuleInfo"], 4)
        (module,) = struct.unpack_from("<H", streams["ModuleInfo"], end + 2)
        stream, at = streams["MeasParam"], 12
        for _ in range(struct.unpack_from("<I", stream, 8)[0] if module == _FTIR_MODULE else 0):
            tag, kind = struct.unpack_from("<IH", stream, at)
            at += 6
            if kind not in _TYPES:
                _, at = _text(stream, at)
                continue
            (value,) = struct.unpack_from(_TYPES[kind], stream, at)
            if tag == _RESOLUTION_TAG:
                return f"{value:g} cm-1"
            at += struct.calcsize(_TYPES[kind])
    except (KeyError, struct.error):
        pass
    return ""
