"""Synthetic spectra and height maps of films, and readings of a thermal camera and a light meter.

Each has an instrument's errors; height maps have particles, and the formats of microscopes. The
camera adds up radiance within its band and shows the temperature of a black body with as much. It
does so here by a sum of its own, not by the code that reduces its readings.
"""

import struct
from importlib import resources
from importlib.util import find_spec

import numpy as np

from lightflyer.core.constants import BOLTZMANN, PLANCK, SPEED_OF_LIGHT, ZERO_CELSIUS
from lightflyer.lab.synthetic import cells, faulty_table, label

_NOISE = 0.002  # of shares
_FIRST, _LAST, _STEP = 400.0, 4000.0, 2.0  # [1/cm]
_LEVEL = 0.89  # transmittance between the bands
# centre, half width [1/cm] and depth of absorption bands, roughly those of PET film
_BANDS = ((728.0, 8.0, 0.30), (1100.0, 25.0, 0.22), (1245.0, 25.0, 0.28), (1725.0, 12.0, 0.40),
          (2960.0, 30.0, 0.05))  # fmt: skip
_REFLECTANCE = 0.04

TRUTH = {"germanium": 31e-9, "porosity": 0.35, "mylar": 512e-9}
"""Thicknesses [m] and porosity [1] of the synthetic film."""

_SCALE = 0.008  # standard deviation of the errors of the ordinates' scales
_SMOOTHED = 5  # points over which the synthetic instrument averages its noise
_VISIBLE = np.arange(420.0, 901.0, 4.0)  # [nm]
_INFRARED = np.arange(700.0, 4001.0, 16.0)  # [1/cm]

REFLECTANCE, TRANSMITTANCE = 0.12, 0.80
"""Properties of the synthetic film in the infrared; its emissivity is 0.08."""

VISIBLE_REFLECTANCE, VISIBLE_TRANSMITTANCE = 0.15, 0.10
"""Properties of the synthetic film in the visible; its absorptivity is 0.75."""

BAND = (7.5e-6, 14e-6)  # Wavelengths that the synthetic camera sees [m]

_HOTPLATE, _AMBIENT = 423.15, 295.15  # [K]
_READ_NOISE = 0.2  # of one reading [K]
_DRIFT = 0.3  # of the camera between one reading and the next, the same in all rows [K]
_GAIN, _OFFSET = 0.02, 0.01  # the camera's errors over radiance, and over that of the ambient
_ROWS = 12
_METER_GAIN, _METER_LINEARITY, _METER_NOISE = 0.03, 0.01, 0.005  # over a reading
_WAVELENGTH = np.linspace(*BAND, 400)

_SIDE = 10e-6  # [m]
_PIXELS = 256
_CORRELATION = 3.0  # correlation length of the surface [pixels]
RMS_HEIGHT = 34.8e-9
"""Rms height of the synthetic surfaces without particles [m]; the paper's germanium film."""

_PARTICLES = 9
_PARTICLE_RADII = (160e-9, 320e-9)  # [m]


def true_transmittance(wavenumber: np.ndarray) -> np.ndarray:
    """True transmittance of the synthetic spectra [1], shape (n,); ``wavenumber`` (n,) [1/cm]."""
    value = np.full_like(wavenumber, _LEVEL)
    for centre, half_width, depth in _BANDS:
        value = value - _LEVEL * depth / (1.0 + ((wavenumber - centre) / half_width) ** 2)
    return value


def ftir_files(seed: int = 0) -> dict[str, str]:
    """Spectra of transmittance as JCAMP-DX and as a table, and a spectrum of reflectance."""
    rng = np.random.default_rng(seed)
    wavenumber = np.arange(_FIRST, _LAST + 0.5 * _STEP, _STEP)
    truth = true_transmittance(wavenumber)
    inside = (wavenumber >= 500.0) & (wavenumber <= 1300.0)
    mean = np.trapezoid(truth[inside], wavenumber[inside]) / 800.0
    lines = label("ftir", f"truth: mean transmittance over 500-1300 cm^-1 {mean:.5f}, "
                          f"reflectance {_REFLECTANCE}")  # fmt: skip
    first, second = (truth + _NOISE * rng.normal(size=len(truth)) for _ in range(2))
    reflected = _REFLECTANCE + _NOISE * rng.normal(size=len(truth))
    rows = cells(".6f .4f", 1e4 / wavenumber[::-1], 100.0 * second[::-1])
    mirror = [",".join(row) for row in cells(".1f .6f", wavenumber, reflected)]
    factor = 1e-6
    whole = np.round(first / factor).astype(int)
    table = [
        f"{wavenumber[start]:.1f} " + " ".join(map(str, whole[start : start + 6]))
        for start in range(0, len(whole), 6)
    ]
    header = {
        "TITLE": lines[0].lstrip("# "), "JCAMP-DX": "4.24", "DATA TYPE": "INFRARED SPECTRUM",
        "ORIGIN": "lightflyer", "OWNER": "public domain", "XUNITS": "1/CM",
        "YUNITS": "TRANSMITTANCE", "XFACTOR": "1.0", "YFACTOR": f"{factor:g}",
        "FIRSTX": f"{wavenumber[0]:g}", "LASTX": f"{wavenumber[-1]:g}",
        "FIRSTY": f"{first[0]:.6f}", "NPOINTS": str(len(whole)), "XYDATA": "(X++(Y..Y))",
    }  # fmt: skip
    labels = [f"##{name}={content}" for name, content in header.items()]
    labels.insert(1, f"$$ {lines[1].lstrip('# ')}")
    return {
        "film.jdx": "\n".join([*labels, *table, "##END="]) + "\n",
        "film.csv": faulty_table(lines, ["Wavelength (µm)", "Transmittance (%)"], rows, rng,
                               delimiter=";", decimal_comma=True),
        "film-reflectance.csv": "\n".join([*lines, "cm-1,reflectance", *mirror]) + "\n",
    }  # fmt: skip


def optics_files(seed: int = 0) -> dict[str, str]:
    """Spectra of a film with noise and errors of their scales, and a sample file."""
    from lightflyer.film.media.library import material
    from lightflyer.film.media.mixture import porous
    from lightflyer.film.optics.stack import Film, Layer

    rng = np.random.default_rng(seed)
    germanium = porous(material("Ge"), TRUTH["porosity"])
    film = Film((Layer(germanium, TRUTH["germanium"]), Layer(material("PET"), TRUTH["mylar"])))
    visible, infrared = film.optics(_VISIBLE * 1e-9), film.optics(0.01 / _INFRARED)
    tilted = film.optics(_VISIBLE * 1e-9, np.deg2rad(8.0))
    made = {
        "visible-transmittance.csv": ("wavelength [nm]", "transmittance [%]", _VISIBLE,
                                      visible.transmittance),
        "visible-reflectance.csv": ("wavelength [nm]", "reflectance [%]", _VISIBLE,
                                    tilted.reflectance),
        "infrared-transmittance.csv": ("wavenumber [cm^-1]", "transmittance [%]", _INFRARED,
                                       infrared.transmittance),
    }  # fmt: skip
    truth = ", ".join(f"{name} {value:g}" for name, value in TRUTH.items())
    lines = label("optics", f"truth: {truth} (m, 1, m)")
    sample = resources.files("lightflyer") / "data" / "optics-sample.toml"
    files = {"sample.toml": sample.read_text(encoding="utf-8")}
    for name, (axis, ordinate, points, share) in made.items():
        scale = _SCALE * rng.normal()
        raw = rng.normal(size=points.size + _SMOOTHED - 1)
        noise = _NOISE * np.convolve(raw, np.ones(_SMOOTHED), mode="valid") / np.sqrt(_SMOOTHED)
        value = share.mean(axis=0) * (1.0 + scale) + noise
        rows = (",".join(row) for row in cells("g .4f", points, 100.0 * value))
        files[name] = "\n".join([*lines, f"{axis},{ordinate}", *rows]) + "\n"
    return files


def camera_radiance(temperature: float) -> float:
    """Radiance of a black body that the synthetic camera sees [W/(m² sr)]."""
    x = PLANCK * SPEED_OF_LIGHT / (_WAVELENGTH * BOLTZMANN * temperature)
    spectral = 2.0 * PLANCK * SPEED_OF_LIGHT**2 / _WAVELENGTH**5 / np.expm1(x)
    return float(np.trapezoid(spectral, _WAVELENGTH))


def apparent_temperature(radiance: float) -> float:
    """Apparent temperature that the synthetic camera shows [K]; ``radiance`` [W/(m² sr)]."""
    from scipy import optimize

    return float(optimize.brentq(lambda kelvin: camera_radiance(kelvin) - radiance, 100.0, 2000.0))


def thermography_files(seed: int = 0) -> dict[str, str]:
    """A table of temperatures, and one of a light meter's readings; text by file name."""
    rng = np.random.default_rng(seed)
    emissivity = 1.0 - REFLECTANCE - TRANSMITTANCE
    said = (f"truth: r {REFLECTANCE}, t {TRANSMITTANCE}, emissivity {emissivity:.2f}, camera of "
            f"{BAND[0] * 1e6:g} to {BAND[1] * 1e6:g} um")  # fmt: skip
    source, background = camera_radiance(_HOTPLATE), camera_radiance(_AMBIENT)
    shares = np.array([1.0, REFLECTANCE, TRANSMITTANCE, 0.0])
    scene = background + shares * (source - background)
    read = scene * (1.0 + _GAIN * rng.normal()) + _OFFSET * background * rng.normal()
    apparent = np.array([apparent_temperature(one) for one in read]) + _DRIFT * rng.normal(size=4)
    kelvin = [
        [one - ZERO_CELSIUS + _READ_NOISE * rng.normal() for one in apparent] for _ in range(_ROWS)
    ]
    names = [f"{name} temperature (°C)" for name in ("Hotplate", "Lower", "Upper", "Ambient")]
    thermal = faulty_table(
        label("thermography", said), names, [[f"{one:.2f}" for one in row] for row in kelvin], rng,
        delimiter=";", decimal_comma=True,
    )  # fmt: skip
    absorbed = 1.0 - VISIBLE_REFLECTANCE - VISIBLE_TRANSMITTANCE
    visible = f"truth: r {VISIBLE_REFLECTANCE}, t {VISIBLE_TRANSMITTANCE}, absorptivity {absorbed}"
    dark, incident = 12.0, 1800.0
    light = incident * np.array([1.0, VISIBLE_REFLECTANCE, VISIBLE_TRANSMITTANCE, 0.0])
    gain = 1.0 + _METER_GAIN * rng.normal()
    shown = dark + light * gain * (1.0 + _METER_LINEARITY * rng.normal(size=4))
    rows = [[f"{one * (1.0 + _METER_NOISE * rng.normal()):.1f}" for one in shown]
            for _ in range(_ROWS)]  # fmt: skip
    columns = ["incident", "reflected", "transmitted", "dark"]
    return {
        "thermal.csv": thermal,
        "light-meter.csv": faulty_table(label("thermography", visible), columns, rows, rng),
    }


def random_surface(
    rng: np.random.Generator, *, pixels: int = _PIXELS, rms_height: float = RMS_HEIGHT
) -> np.ndarray:
    """Level surface with normally distributed heights [m], shape (pixels, pixels)."""
    from scipy import ndimage

    from lightflyer.lab.surface.heights import level

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
    rows = ["\t".join(f"{value:.6e}" for value in row) for row in maps[2]]
    head = [*said, "# Channel: Height", f"# Width: {_SIDE * 1e6:.2f} µm",
            f"# Height: {_SIDE * 1e6:.2f} µm", "# Value units: m"]  # fmt: skip
    matrix: dict[str, str | bytes] = {"germanium.txt": "\n".join([*head, *rows]) + "\n"}
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
