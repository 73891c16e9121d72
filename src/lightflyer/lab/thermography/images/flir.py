"""FLIR's radiometric files: JPEG with FLIR's records, and the records alone (.fff)."""

import io
import struct
import warnings
from pathlib import Path

import numpy as np
from PIL import Image

from lightflyer.core.errors import ConfigurationError
from lightflyer.lab.thermography.images.radiometry import CameraSettings

# the layout of FLIR's records is described in [ExifTool]
_MAGIC = (b"FFF\0", b"AFF\0")
_JPEG = b"\xff\xd8"
_APP1, _START_OF_SCAN = 0xE1, 0xDA
_CHUNK = b"FLIR\0"
_VERSIONS = range(100, 200)
_RAW, _CAMERA = 1, 32  # types of records
_ENTRY = 32  # bytes
_PIXELS_AT = 32  # in the record of raw data
_CAMERA_SIZE = 784  # bytes
_PNG = b"\x89PNG"


class _WrongError(Exception):
    """What is wrong with a file, in words."""


def read_flir(path: Path, content: bytes) -> tuple[np.ndarray, CameraSettings]:
    """Read the signal of a FLIR camera and its settings; returns ``counts``, ``settings``."""
    # Source: [ExifTool]_.
    try:
        if content[:2] == _JPEG:
            content = _records_of_jpeg(content)
        records = _records(content)
        counts, settings = _raw(records[_RAW]), _settings(records[_CAMERA])
        if wrong := settings.problem():
            raise _WrongError(wrong)
    except _WrongError as error:
        raise ConfigurationError(f"{path}: is not a radiometric FLIR image: {error}") from None
    except struct.error:
        raise ConfigurationError(
            f"{path}: is not a radiometric FLIR image: a record ends too early"
        ) from None
    return counts, settings


def _records_of_jpeg(content: bytes) -> bytes:
    """FLIR's records, which a JPEG holds in pieces."""
    pieces, count, place = {}, 0, len(_JPEG)
    while place + 4 <= len(content) and content[place] == 0xFF:
        marker, size = content[place + 1], int.from_bytes(content[place + 2 : place + 4], "big")
        body = content[place + 4 : place + 2 + size]
        if marker == _APP1 and body.startswith(_CHUNK) and len(body) > 8:
            pieces[body[6]], count = body[8:], body[7] + 1
        if marker == _START_OF_SCAN or size < 2:
            break
        place += 2 + size
    if not pieces:
        of_dji = b"DJI" in content[:4096]
        said = "it has no FLIR data"
        more = "; DJI's own format needs DJI's Thermal SDK: convert it to TIFF" if of_dji else ""
        raise _WrongError(said + more)
    if sorted(pieces) != list(range(count)):
        raise _WrongError(
            f"pieces of its FLIR data are missing: it has {sorted(pieces)}, {count} are due"
        )
    return b"".join(pieces[number] for number in range(count))


def _records(content: bytes) -> dict[int, bytes]:
    """First record of each type that is needed."""
    if content[:4] not in _MAGIC:
        raise _WrongError("it has no FLIR data")
    order = next(
        (one for one in "><" if struct.unpack_from(one + "I", content, 20)[0] in _VERSIONS), None
    )
    if order is None:
        raise _WrongError("its FLIR data have an unknown version")
    start, count = struct.unpack_from(order + "2I", content, 24)
    if start + count * _ENTRY > len(content):
        raise _WrongError("its directory is longer than the file")
    found: dict[int, bytes] = {}
    for place in range(start, start + count * _ENTRY, _ENTRY):
        kind = struct.unpack_from(order + "H", content, place)[0]
        at, size = struct.unpack_from(order + "2I", content, place + 12)
        if kind in (_RAW, _CAMERA) and kind not in found:
            if at + size > len(content):
                raise _WrongError("a record ends beyond the end of the file")
            found[kind] = content[at : at + size]
    for kind, what in ((_RAW, "raw signal"), (_CAMERA, "settings of the camera")):
        if kind not in found:
            raise _WrongError(f"it has no {what}")
    return found


def _order(record: bytes) -> str:
    """Byte order of a record, which begins with the number 2."""
    start = struct.unpack_from("<H", record)[0]
    if start not in (0x0002, 0x0200):
        raise _WrongError("the byte order of a record is unknown")
    return "<" if start == 2 else ">"


def _raw(record: bytes) -> np.ndarray:
    order = _order(record)
    columns, rows = struct.unpack_from(order + "2H", record, 2)
    body = record[_PIXELS_AT:]
    if not rows * columns:
        raise _WrongError("its image has no pixels")
    if body.startswith(_PNG):
        return _png(body, rows, columns)
    size = 2 * rows * columns
    if len(body) < size:
        raise _WrongError(f"{columns} x {rows} pixels are more than its raw signal holds")
    return np.frombuffer(body[:size], order + "u2").reshape(rows, columns).astype(float)


def _png(body: bytes, rows: int, columns: int) -> np.ndarray:
    """Signal in a PNG, whose bytes FLIR writes in the reverse order."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(body), formats=["PNG"]) as image:
                size, mode = image.size, image.mode
                if size != (columns, rows):
                    raise _WrongError(
                        f"its header states {columns} x {rows} pixels, its PNG has {size[0]} x "
                        f"{size[1]}"
                    )
                if not mode.startswith("I"):
                    raise _WrongError(f"its PNG holds colours ({mode}), not a signal of 16 bits")
                values = np.asarray(image).astype(np.uint16)
    except _WrongError:
        raise
    except Exception as error:  # Pillow raises many kinds
        raise _WrongError(f"its PNG cannot be read: {error}") from None
    return values.byteswap().astype(float)


def _settings(record: bytes) -> CameraSettings:
    order = _order(record)
    if len(record) < _CAMERA_SIZE:
        raise _WrongError("the settings of the camera are too short")

    def number(place: int, kind: str = "f") -> float:
        return float(struct.unpack_from(order + kind, record, place)[0])

    emissivity, distance, reflected, air, window, transmittance = (
        number(32 + 4 * place) for place in range(6)
    )
    return CameraSettings(
        emissivity, distance, reflected, air, window, transmittance, number(60),
        r1=number(88), b=number(92), f=number(96), o=number(776, "i"), r2=number(780),
        alpha=(number(112), number(116)), beta=(number(120), number(124)), share=number(128),
    )  # fmt: skip
