r"""Temperatures from the signal of a FLIR camera.

The signal of a black body at :math:`T` is

.. math:: S(T) = \frac{R_1}{R_2 (e^{B/T} - F)} - O

with the camera's constants. The camera sees the object through air, a window and air,

.. math:: S = \tau\{\tau_w[\tau(\varepsilon S_{obj} + (1 - \varepsilon) S_{refl})
    + (1 - \tau) S_{atm}] + (1 - \tau_w) S_{win}\} + (1 - \tau) S_{atm},

with the transmittance :math:`\tau` of each half of the path.
"""

import math
from dataclasses import dataclass

import numpy as np

from lightflyer.lab.thermography.data import ZERO_CELSIUS

WATER = (1.5587, 0.06939, -2.7816e-4, 6.8455e-7)
"""Logarithm of the content of water of saturated air [g/m³] as a polynomial of the temperature in
°C; [Thermimage]_."""


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
    b: float  # Constants of the camera; b in kelvin
    f: float  # Constants of the camera; b in kelvin
    o: float  # Constants of the camera; b in kelvin
    r2: float  # Constants of the camera; b in kelvin
    alpha: tuple[float, float]  # Attenuation by air [m^-1/2] and by water in it
    beta: tuple[float, float]
    share: float  # Weight of the first of the two attenuations [1]

    def problem(self) -> str:
        """What is impossible in them, or nothing."""
        shares = {
            "emissivity": self.emissivity,
            "transmittance of the window": self.window_transmittance,
        }
        for name, value in shares.items():
            if not 0.0 < value <= 1.0:
                return f"its {name}, {value:g}, is not between 0 and 1"
        temperatures = (self.reflected_temperature, self.air_temperature, self.window_temperature)
        if not all(_COLDEST <= one <= _HOTTEST for one in temperatures):
            said = ", ".join(f"{one:.4g}" for one in temperatures)
            return f"temperatures of its surroundings, {said} K, are impossible"
        if not 0.0 <= self.humidity <= 1.0 or not 0.0 <= self.distance <= _FARTHEST:
            return (
                f"its humidity, {self.humidity:g}, or distance, {self.distance:g} m, is impossible"
            )
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


_COLDEST, _HOTTEST = 150.0, 1000.0  # [K]
_FARTHEST = 1e5  # [m]
_MOST_TRANSMITTED = 1.05  # the fit of air exceeds 1 a little where it is dry
_MOST_EXPONENT = 50.0


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
