"""Public reports of thermal cameras: Planck's law with the camera's constants, by hand.

`lab/test_thermal_images.py` has the case of https://github.com/gtatters/Thermimage/issues/19.
"""

import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.lab.thermography.flir import read_flir, temperatures
from lightflyer.lab.thermography.thermal_image import parse_scale, read_thermal_image

R1, R2, B, F, ZERO = 14364.633, 0.010603162, 1385.4, 1.0, -5753.0
ROOM = 293.15
ALPHA, BETA, SHARE = (0.006569, 0.01262), (-0.002276, -0.00667), 1.9


def planck(kelvin):
    return R1 / (R2 * (np.exp(B / kelvin) - F)) - ZERO


def half_path(distance, alpha, beta, share, humidity=0.5, celsius=20.0):
    """Transmittance of half of the way through air."""
    water = humidity * np.exp(
        1.5587 + 6.939e-2 * celsius - 2.7816e-4 * celsius**2 + 6.8455e-7 * celsius**3
    )
    root = np.sqrt(0.5 * distance)
    first, second = (
        np.exp(-root * (a + b * np.sqrt(water))) for a, b in zip(alpha, beta, strict=True)
    )
    return share * first + (1.0 - share) * second


def record(pixels, *, emissivity=1.0, distance=0.0, window=1.0, reflected=ROOM, window_at=ROOM,
           alpha=ALPHA, beta=BETA, share=SHARE, png=False):  # fmt: skip
    """FLIR's records (.fff): a signal, and the settings beside it."""
    rows, columns = pixels.shape
    raw = struct.pack("<3H", 2, columns, rows).ljust(32, b"\0")
    raw += of_png(pixels) if png else pixels.astype("<u2").tobytes()
    camera = bytearray(struct.pack("<H", 2).ljust(784, b"\0"))
    for place, value in (
        (32, emissivity), (36, distance), (40, reflected), (44, ROOM), (48, window_at),
        (52, window), (60, 0.5), (88, R1), (92, B), (96, F), (112, alpha[0]), (116, alpha[1]),
        (120, beta[0]), (124, beta[1]), (128, share), (780, R2),
    ):  # fmt: skip
        struct.pack_into("<f", camera, place, value)
    struct.pack_into("<i", camera, 776, int(ZERO))
    at = 64 + 2 * 32
    head = b"FFF\0".ljust(20, b"\0") + struct.pack(">3I", 100, 64, 2)
    entries = b"".join(
        struct.pack(">2H2I2I", kind, 1, 0, 0, place, len(one)).ljust(32, b"\0")
        for kind, place, one in ((1, at, raw), (32, at + len(raw), camera))
    )
    return head.ljust(64, b"\0") + entries + raw + bytes(camera)


def of_png(pixels):
    """A PNG of 16 bits whose bytes stand the other way round."""
    rows, columns = pixels.shape

    def chunk(kind, body):
        return (
            struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        )

    lines = b"".join(b"\0" + row.astype("<u2").tobytes() for row in pixels)
    return b"".join([
        b"\x89PNG\r\n\x1a\n", chunk(b"IHDR", struct.pack(">2I5B", columns, rows, 16, 0, 0, 0, 0)),
        chunk(b"IDAT", zlib.compress(lines)), chunk(b"IEND", b""),
    ])  # fmt: skip


KELVIN = np.linspace(290.0, 420.0, 20).reshape(4, 5)


@pytest.mark.parametrize("png", [False, True])
def test_bytes_of_a_png_stand_the_other_way_round(png):
    """https://github.com/gtatters/ThermImageJ/issues/8

    https://github.com/OSGeo/gdal/pull/12547: FLIR's PNG, and no other of its signals, is so.
    """
    counts = np.round(planck(KELVIN))
    found, settings = read_flir(Path("a.fff"), record(counts, png=png))
    assert found == pytest.approx(counts)
    assert temperatures(found, settings) == pytest.approx(KELVIN, abs=0.05)


@pytest.mark.parametrize(
    "constants",
    [
        {},
        # https://github.com/gtatters/Thermimage/issues/6: a camera's own constants of air
        {"alpha": (1.239e-8, 1.1095e-8), "beta": (0.00318, 0.0031802), "share": 0.732},
    ],
)
def test_the_way_through_air(constants):
    """https://github.com/gtatters/Thermimage/issues/25: air before and behind a window.

    20 m of air, half of them before a window of 90 %, all at room temperature: what is lost of the
    object's light is that of a black body there.
    """
    passed = half_path(20.0, **({"alpha": ALPHA, "beta": BETA, "share": SHARE} | constants))
    whole = 0.9 * passed**2
    counts = whole * planck(KELVIN) + (1.0 - whole) * planck(ROOM)
    content = record(np.round(counts), distance=20.0, window=0.9, **constants)
    found, settings = read_flir(Path("a.fff"), content)
    assert temperatures(found, settings) == pytest.approx(KELVIN, abs=0.1)


def test_an_image_without_temperatures_is_refused(write):
    """https://github.com/LJMUAstroecology/flirpy/issues/108: NaN everywhere, and no reason."""
    path = write(record(np.zeros((4, 5))), "dark.fff")
    with pytest.raises(lf.ConfigurationError, match=r"dark\.fff: .+"):
        read_thermal_image(path)


def test_a_matrix_that_a_program_printed(write):
    """https://github.com/wilhelmzeuschner/arduino_thermal_camera_with_sd_and_img_processing/issues/2

    Rows such as ['24.8', '25.0'] are no matrix; a line says where. Without the marks they are one.
    """
    values = np.round(np.random.default_rng(1).uniform(24.0, 31.0, (8, 8)), 1)
    printed = "".join(f"{[str(one) for one in row]}\n" for row in values)
    path = write(printed, "image.txt")
    with pytest.raises(lf.ConfigurationError, match=r"image\.txt:1: .* is not a number"):
        read_thermal_image(path, scale=parse_scale("°C"))
    path.write_text(printed.translate({ord(mark): None for mark in "[]'"}), encoding="utf-8")
    found = read_thermal_image(path, scale=parse_scale("°C"))
    assert found.temperature == pytest.approx(values + 273.15)
