"""JASCO's binary ``.jws`` and ``.jrs``: Spectra Manager 2 (one block) and 1.x (an OLE container).

The layouts are those that JASCOFiles.jl (MIT) documents, found with files of FT/IR-4600 and V-730
instruments and their text exports. Values are per cent or absorbance.
"""

import io
import struct

import numpy as np

from lightflyer.core.extras import extra
from lightflyer.lab.readers.formats import Source
from lightflyer.lab.readers.spectra.raw import MOST_POINTS, RawSpectrum, SpectrumMetadata, plain

FORMAT = "JASCO .jws"

_MAGIC = b"L~S "
_OLE_MAGIC = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_ABSCISSAE = {0x00: "1/CM", 0x01: "Raman shift", 0x03: "NANOMETERS"}
_ORDINATES = {0x00: "%T", 0x02: "%R", 0x03: "Abs", 0x08: "single beam (background)",
              0x09: "single beam (reference)", 0x0A: "single beam (sample)",
              0x0E: "Raman intensity"}  # fmt: skip
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


def is_jws(source: Source) -> bool:
    """Whether a file is a binary one of JASCO."""
    ole = source.content.startswith(_OLE_MAGIC)
    return source.content.startswith(_MAGIC) or (ole and source.suffix in (".jws", ".jwb", ".jrs"))


def read_jws(source: Source) -> list[RawSpectrum]:
    """Read a binary file of JASCO; one."""
    if source.content.startswith(_OLE_MAGIC):
        return [_from_container(source)]
    data = source.content
    count, first, last, step = _GRID.unpack_from(data, _AT_GRID)
    unit, mode = data[_AT_UNITS], data[_AT_UNITS + 4]
    (length,) = struct.unpack_from("<q", data, _AT_LENGTH)
    if length != _FLOAT * count or len(data) - length != _AT_DATA:
        source.refuse(f"is damaged: its {len(data)} bytes do not hold the {count} points it names")
    y = np.frombuffer(data[_AT_DATA:], "<f4")
    metadata = SpectrumMetadata(
        FORMAT,
        instrument=plain(data[_AT_INSTRUMENT : _AT_INSTRUMENT + _WORDS]),
        sample=plain(data[_AT_TITLE : _AT_TITLE + 2 * _WORDS], "cp932"),
    )
    return [_spectrum(source, y, (count, first, last, step), (unit, mode), metadata)]


def _spectrum(
    source: Source, y: np.ndarray, grid: tuple[int, float, float, float], codes: tuple[int, int],
    metadata: SpectrumMetadata,
) -> RawSpectrum:  # fmt: skip
    count, first, last, step = grid
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
    unit, mode = codes
    if unit not in _ABSCISSAE or mode not in _ORDINATES:
        source.refuse(f"its axes have the unknown codes {unit} and {mode}; export text")
    ordinate = _ORDINATES[mode]
    return RawSpectrum(
        first + step * np.arange(count), y.astype(float), _ABSCISSAE[unit], ordinate, metadata,
        percent=ordinate.startswith("%"), notes=notes,
    )  # fmt: skip


def _from_container(source: Source) -> RawSpectrum:
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
        FORMAT,
        instrument=_words(streams.get("ModuleInfo", b""), which=1),
        resolution=_resolution(streams),
        sample=_words(streams.get("SampleInfo", b""), which=0),
    )
    y = np.frombuffer(streams["Y-Data"], "<f4")
    return _spectrum(source, y, (count, first, last, step), (axis & 0xFF, mode), metadata)


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
    """Resolution of an infrared instrument; other modules use other tags."""
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
