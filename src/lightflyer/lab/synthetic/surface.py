"""Synthetic height maps with particles, in the formats of microscopes."""

import struct
from importlib.util import find_spec

import numpy as np
from scipy import ndimage

from lightflyer.lab.surface.heights import level
from lightflyer.lab.synthetic.faults import label

_SIDE = 10e-6  # [m]
_PIXELS = 256
_CORRELATION = 3.0  # correlation length of the surface [pixels]
RMS_HEIGHT = 34.8e-9
"""Rms height of the synthetic surfaces without particles [m]; the paper's germanium film."""

_PARTICLES = 9
_PARTICLE_RADII = (160e-9, 320e-9)  # [m]


def random_surface(
    rng: np.random.Generator, *, pixels: int = _PIXELS, rms_height: float = RMS_HEIGHT
) -> np.ndarray:
    """Level surface with normally distributed heights [m], shape (pixels, pixels)."""
    height = level(ndimage.gaussian_filter(rng.normal(size=(pixels, pixels)), _CORRELATION))
    return height * rms_height / np.sqrt(np.mean((height - height.mean()) ** 2))


def with_particles(height: np.ndarray, rng: np.random.Generator, count: int) -> np.ndarray:
    """Surface with spherical particles half sunk into it [m], shape (n, n); ``height`` (n, n)."""
    pixels = height.shape[0]
    pitch = _SIDE / pixels
    y, x = np.mgrid[0:pixels, 0:pixels] * pitch
    dirty = height.copy()
    for _ in range(count):
        radius = rng.uniform(*_PARTICLE_RADII)
        distance = np.hypot(*(axis - rng.uniform(0.0, _SIDE) for axis in (x, y)))
        cap = np.sqrt(np.maximum(radius**2 - distance**2, 0.0))
        dirty = np.where(distance < radius, np.maximum(dirty, dirty + cap), dirty)
    return dirty


def roughness_files(seed: int = 0) -> dict[str, str | bytes]:
    """Maps as a matrix and, where they can be read, an Igor wave and a Gwyddion file."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[-1 : 1 : _PIXELS * 1j, -1 : 1 : _PIXELS * 1j]
    bowed = 400e-9 * x - 250e-9 * y + 120e-9 * x**2 + 60e-9 * x * y  # tilt, and bow of the scanner
    maps = [with_particles(random_surface(rng), rng, _PARTICLES) + bowed + 3e-6 for _ in range(3)]
    said = label("roughness", f"truth: rms height {RMS_HEIGHT * 1e9:.1f} nm without particles")
    matrix: dict[str, str | bytes] = {"germanium.txt": _matrix(maps[2], said)}
    if not find_spec("SurfaceTopography"):  # of the extra "afm"
        return matrix
    return {
        "germanium.ibw": igor_wave(maps[0], _SIDE, "; ".join(said)),
        "germanium.gwy": gwyddion(maps[1], _SIDE, "; ".join(said)),
        **matrix,
    }


def igor_wave(height: np.ndarray, side: float, note: str) -> bytes:
    """Igor binary wave of version 5 with the channels height and amplitude."""
    # Source: WaveMetrics, Igor Pro Technical Note 003, *Igor binary format*.
    layers = np.stack([height.T, np.zeros_like(height.T)], axis=2).astype("<f4")
    data = layers.tobytes(order="F")
    names = [b"HeightRetrace", b"AmplitudeRetrace"]
    labels = b"".join(name.ljust(32, b"\0") for name in [b"", *names])
    text = note.encode("utf-8")
    pitch = side / height.shape[1]
    metres = b"m\0\0\0" * 2
    wave = struct.pack(
        "<IIIihh6sh32sii4i4d4d4s16shhddi4i4ii16ihhhbbiihhii",
        0, 0, 0, layers.size, 2, 0, b"", 1, b"synthetic", 0, 0,
        *layers.shape, 0, *(pitch, pitch, 1.0, 1.0), *(0.0,) * 4, b"m", metres.ljust(16, b"\0"),
        0, 0, 0.0, 0.0, 0, *(0,) * 4, *(0,) * 4, 0, *(0,) * 16, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    )  # fmt: skip

    def header(checksum: int) -> bytes:
        return struct.pack(
            "<hhiiii4i4iiii", 5, checksum, len(wave) + len(data), 0, len(text), 0,
            *(0,) * 4, 0, 0, len(labels), 0, 0, 0, 0,
        )  # fmt: skip

    both = header(0) + wave
    total = sum(struct.unpack(f"<{len(both) // 2}h", both))
    checksum = (-total + 0x8000) % 0x10000 - 0x8000  # makes the sum of all words zero
    return header(checksum) + wave + data + text + labels


def gwyddion(height: np.ndarray, side: float, note: str) -> bytes:
    """Gwyddion's own format with one channel, Height."""
    # Source: Gwyddion's user guide, *Gwyddion file format*: parts of a name, a letter and a value.

    def part(name: str, kind: str, value: bytes) -> bytes:
        return name.encode() + b"\0" + kind.encode() + value

    def text(name: str, value: str) -> bytes:
        return part(name, "s", value.encode() + b"\0")

    def whole(name: str, *parts: bytes) -> bytes:
        content = b"".join(parts)
        return name.encode() + b"\0" + struct.pack("<I", len(content)) + content

    unit = whole("GwySIUnit", text("unitstr", "m"))
    rows, columns = height.shape
    field = whole(
        "GwyDataField",
        part("xres", "i", struct.pack("<i", columns)), part("yres", "i", struct.pack("<i", rows)),
        part("xreal", "d", struct.pack("<d", side)), part("yreal", "d", struct.pack("<d", side)),
        part("si_unit_xy", "o", unit), part("si_unit_z", "o", unit),
        part("data", "D", struct.pack("<I", height.size) + height.astype("<f8").tobytes()),
    )  # fmt: skip
    return b"GWYP" + whole(
        "GwyContainer",
        part("/0/data", "o", field),
        text("/0/data/title", "Height"),
        part("/0/meta", "o", whole("GwyContainer", text("note", note))),
    )


def _matrix(height: np.ndarray, said: list[str]) -> str:
    rows = ["\t".join(f"{value:.6e}" for value in row) for row in height]
    head = [*said, "# Channel: Height", f"# Width: {_SIDE * 1e6:.2f} µm",
            f"# Height: {_SIDE * 1e6:.2f} µm", "# Value units: m"]  # fmt: skip
    return "\n".join([*head, *rows]) + "\n"
