r"""FLIR's radiometric files: JPEG with FLIR's records, and the records alone (.fff).

The signal of a black body at :math:`T` is

.. math:: S(T) = \frac{R_1}{R_2 (e^{B/T} - F)} - O

with the camera's constants. The camera sees the object through air, a window and air,

.. math:: S = \tau\{\tau_w[\tau(\varepsilon S_{obj} + (1 - \varepsilon) S_{refl})
    + (1 - \tau) S_{atm}] + (1 - \tau_w) S_{win}\} + (1 - \tau) S_{atm},

with the transmittance :math:`\tau` of each half of the path.
"""

import io
import math
import struct
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from lightflyer.core.constants import ZERO_CELSIUS
from lightflyer.core.errors import ConfigurationError

WATER = (1.5587, 0.06939, -2.7816e-4, 6.8455e-7)
"""Logarithm of the content of water of saturated air [g/m³] as a polynomial of the temperature in
°C; [Thermimage]_."""

_COLDEST, _HOTTEST = 150.0, 1000.0  # [K]
_FARTHEST = 1e5  # [m]
_MOST_TRANSMITTED = 1.05  # the fit of air exceeds 1 a little where it is dry
_MOST_EXPONENT = 50.0
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
_PLACES = {"emissivity": 32, "distance": 36, "reflected_temperature": 40, "air_temperature": 44,
           "window_temperature": 48, "window_transmittance": 52, "humidity": 60, "r1": 88, "b": 92,
           "f": 96, "r2": 780, "share": 128}  # fmt: skip
_PNG = b"\x89PNG"


@dataclass(frozen=True)
class CameraSettings:
    """What a FLIR camera stores beside its signal."""

    emissivity: float  # Of the object, as set in the camera [1]
    distance: float  # From camera to object [m]
    reflected_temperature: float  # [K]
    air_temperature: float  # [K]
    window_temperature: float  # [K]
    window_transmittance: float  # [1]
    humidity: float  # [1]
    r1: float  # Constants of the camera; b in kelvin
    b: float
    f: float
    o: float
    r2: float
    alpha: tuple[float, float]  # Attenuation by air [m^-1/2] and by water in it
    beta: tuple[float, float]
    share: float  # Weight of the first of the two attenuations [1]

    def problem(self) -> str:
        """What is impossible in them, or nothing."""
        for name, value in (
            ("emissivity", self.emissivity),
            ("transmittance of the window", self.window_transmittance),
        ):
            if not 0.0 < value <= 1.0:
                return f"its {name}, {value:g}, is not between 0 and 1"
        temperatures = (self.reflected_temperature, self.air_temperature, self.window_temperature)
        if not all(_COLDEST <= one <= _HOTTEST for one in temperatures):
            said = ", ".join(f"{one:.4g}" for one in temperatures)
            return f"temperatures of its surroundings, {said} K, are impossible"
        if not 0.0 <= self.humidity <= 1.0 or not 0.0 <= self.distance <= _FARTHEST:
            said = f"its humidity, {self.humidity:g}, or distance, {self.distance:g} m"
            return f"{said}, is impossible"
        constants = (self.r1, self.r2, self.b, self.f)
        if not all(math.isfinite(one) and one > 0.0 for one in constants):
            return "a constant of its calibration is not positive"
        if not 0.0 < self.transmittance <= _MOST_TRANSMITTED:
            return f"the transmittance of its air, {self.transmittance:g}, is impossible"
        return ""

    @property
    def transmittance(self) -> float:
        """Transmittance of half of the path through air [1]."""
        celsius = self.air_temperature - ZERO_CELSIUS
        exponent = sum(one * celsius**power for power, one in enumerate(WATER))
        water = self.humidity * math.exp(min(exponent, _MOST_EXPONENT))
        root = math.sqrt(0.5 * self.distance)
        first, second = (
            math.exp(min(-root * (one + of_water * math.sqrt(water)), _MOST_EXPONENT))
            for one, of_water in zip(self.alpha, self.beta, strict=True)
        )
        return self.share * first + (1.0 - self.share) * second


def signal(kelvin: float, camera: CameraSettings) -> float:
    """Signal of a black body [counts]."""
    return camera.r1 / (camera.r2 * (math.exp(camera.b / kelvin) - camera.f)) - camera.o


def temperatures(counts: np.ndarray, camera: CameraSettings) -> np.ndarray:
    """Temperatures of an image [K]; naN where the signal is below that of absolute zero."""
    # Source: [Thermimage]_.
    half, window = camera.transmittance, camera.window_transmittance
    air = signal(camera.air_temperature, camera)
    at_window = (np.asarray(counts, float) - (1.0 - half) * air) / half
    behind = (at_window - (1.0 - window) * signal(camera.window_temperature, camera)) / window
    leaving = (behind - (1.0 - half) * air) / half
    reflected = (1.0 - camera.emissivity) * signal(camera.reflected_temperature, camera)
    emitted = (leaving - reflected) / camera.emissivity
    with np.errstate(divide="ignore", invalid="ignore"):
        kelvin = camera.b / np.log(camera.r1 / (camera.r2 * (emitted + camera.o)) + camera.f)
    return np.where((emitted + camera.o > 0.0) & (kelvin > 0.0), kelvin, np.nan)


class _WrongError(Exception):
    """What is wrong with a file, in words."""


def read_flir(path: Path, content: bytes) -> tuple[np.ndarray, CameraSettings]:
    """Read the signal of a FLIR camera and its settings; returns ``counts``, ``settings``."""
    # Source: [ExifTool]_.
    try:
        if content[:2] == _JPEG:
            content = _records_of_jpeg(content)
        if content[:4] not in _MAGIC:
            raise _WrongError("it has no FLIR data")
        order = next(
            (one for one in "><" if struct.unpack_from(one + "I", content, 20)[0] in _VERSIONS),
            None,
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
        record = found[_CAMERA]
        order = _order(record)
        if len(record) < _CAMERA_SIZE:
            raise _WrongError("the settings of the camera are too short")

        def number(place: int, kind: str = "f") -> float:
            return float(struct.unpack_from(order + kind, record, place)[0])

        counts = _raw(found[_RAW])
        settings = CameraSettings(
            **{name: number(place) for name, place in _PLACES.items()}, o=number(776, "i"),
            alpha=(number(112), number(116)), beta=(number(120), number(124)),
        )  # fmt: skip
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
        more = "; DJI's own format needs DJI's Thermal SDK: convert it to TIFF"
        raise _WrongError("it has no FLIR data" + more * (b"DJI" in content[:4096]))
    if sorted(pieces) != list(range(count)):
        raise _WrongError(
            f"pieces of its FLIR data are missing: it has {sorted(pieces)}, {count} are due"
        )
    return b"".join(pieces[number] for number in range(count))


def _order(record: bytes) -> str:
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
    size = 2 * rows * columns
    if not body.startswith(_PNG):
        if len(body) < size:
            raise _WrongError(f"{columns} x {rows} pixels are more than its raw signal holds")
        return np.frombuffer(body[:size], order + "u2").reshape(rows, columns).astype(float)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(body), formats=["PNG"]) as image:
                wide, high = image.size
                if (wide, high) != (columns, rows):
                    raise _WrongError(
                        f"its header states {columns} x {rows} pixels, its PNG has {wide} x {high}"
                    )
                if not image.mode.startswith("I"):
                    raise _WrongError(
                        f"its PNG holds colours ({image.mode}), not a signal of 16 bits"
                    )
                values = np.asarray(image).astype(np.uint16)
    except _WrongError:
        raise
    except Exception as error:  # Pillow raises many kinds
        raise _WrongError(f"its PNG cannot be read: {error}") from None
    return values.byteswap().astype(float)  # FLIR writes the bytes in the reverse order
