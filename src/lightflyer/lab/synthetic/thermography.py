"""Synthetic readings of a thermal camera and of a light meter, each with an instrument's errors.

The camera adds up radiance within its band and shows the temperature of a black body with as much.
It does so here by a sum of its own, not by the code that reduces its readings.
"""

import numpy as np
from scipy import optimize

from lightflyer.core.constants import BOLTZMANN, PLANCK, SPEED_OF_LIGHT
from lightflyer.lab.synthetic.faults import faulty_table, label

REFLECTANCE, TRANSMITTANCE = 0.12, 0.80
"""Properties of the synthetic film in the infrared; its emissivity is 0.08."""

VISIBLE_REFLECTANCE, VISIBLE_TRANSMITTANCE = 0.15, 0.10
"""Properties of the synthetic film in the visible; its absorptivity is 0.75."""

BAND = (7.5e-6, 14e-6)  # Wavelengths that the synthetic camera sees [m]

_HOTPLATE, _AMBIENT, _ZERO = 423.15, 295.15, 273.15  # [K]
_NOISE = 0.2  # of one reading [K]
_DRIFT = 0.3  # of the camera between one reading and the next, the same in all rows [K]
_GAIN, _OFFSET = 0.02, 0.01  # the camera's errors over radiance, and over that of the ambient
_ROWS = 12
_METER_GAIN, _METER_LINEARITY, _METER_NOISE = 0.03, 0.01, 0.005  # over a reading
_WAVELENGTH = np.linspace(*BAND, 400)


def camera_radiance(temperature: float) -> float:
    """Radiance of a black body that the synthetic camera sees [W/(m² sr)]."""
    x = PLANCK * SPEED_OF_LIGHT / (_WAVELENGTH * BOLTZMANN * temperature)
    spectral = 2.0 * PLANCK * SPEED_OF_LIGHT**2 / _WAVELENGTH**5 / np.expm1(x)
    return float(np.trapezoid(spectral, _WAVELENGTH))


def apparent_temperature(radiance: float) -> float:
    """Apparent temperature that the synthetic camera shows [K]; ``radiance`` [W/(m² sr)]."""
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
    kelvin = [[one - _ZERO + _NOISE * rng.normal() for one in apparent] for _ in range(_ROWS)]
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
