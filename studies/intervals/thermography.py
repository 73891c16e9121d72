"""``lab thermography`` with a camera: its band, its accuracy, few repeats.

The camera adds up radiance within a flat band, by a sum over wavelengths that shares nothing with
the package. All of its readings share an error of gain and one of offset, which cancel unless the
hotplate's temperature is a thermometer's; each reading has an error of its own, with the standard
uncertainty that follows from makers' specifications, and noise in every row. The hotplate's
temperature wanders between rows. Readings without a band (T⁴) are not in the table: they are biased
by the camera's band, for which no interval of the readings can account, and the command says so.
"""

import numpy as np
from trial import Trial

from lightflyer import lab
from lightflyer.core.units import Measured
from lightflyer.lab.thermography.data import standard_uncertainties

COMMAND = "lab thermography"

H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
REPEATS = (2, 3, 5, 12)
FEW = (2, 3)  # where scatter is all that there is
DRAWS = 20_000
NOISE, WANDER = 0.2, 0.5  # [K]
GAIN, OFFSET = 0.02, 0.02  # over radiance, and over that of the ambient
LEAST, SHARE = 2.0, 0.02  # limits of a camera's error [K] and over the reading in °C
EVENLY = 3.0**-0.5  # standard deviation over the limits of an error evenly distributed


class Camera:
    """Flat band between two wavelengths [m]."""

    def __init__(self, shortest: float, longest: float) -> None:
        self.ends = shortest, longest
        wavelength = np.linspace(shortest, longest, 300)
        self._table = np.linspace(250.0, 600.0, 3501)
        x = H * C / (wavelength * K * self._table[:, None])
        self._seen = np.trapezoid(wavelength**-5.0 / np.expm1(x), wavelength)

    def radiance(self, temperature: np.ndarray) -> np.ndarray:
        """Radiance at temperatures [K], in any unit."""
        return np.exp(np.interp(temperature, self._table, np.log(self._seen)))

    def apparent_temperature(self, radiance: np.ndarray) -> np.ndarray:
        """Apparent temperature [K] of radiances."""
        return np.interp(np.log(radiance), np.log(self._seen), self._table)


def film(rng: np.random.Generator) -> np.ndarray:
    """Reflectance, transmittance and emissivity."""
    remainder = rng.uniform(0.1, 0.5)
    reflectance = rng.uniform(0.1, 0.3)
    return np.array([reflectance, 1.0 - reflectance - remainder, remainder])


def rows(
    rng: np.random.Generator, camera: Camera, truth: np.ndarray, count: int,
    ambient: float, emissivity: float = 1.0, warmth: float = 0.0,
) -> np.ndarray:  # fmt: skip
    """Readings, shape (4, count) [K]: a hotplate's own temperature where it is not black."""
    reflectance, transmittance, remainder = truth
    hot = rng.uniform(400.0, 450.0) + WANDER * rng.normal(size=count)
    cold = np.full(count, camera.radiance(ambient))
    plate = emissivity * camera.radiance(hot) + (1.0 - emissivity) * cold
    own = camera.radiance(ambient + warmth)
    lower = reflectance * plate + transmittance * cold + remainder * own
    upper = transmittance * plate + reflectance * cold + remainder * own
    radiance = np.stack([plate, lower, upper, cold])
    if emissivity < 1.0:
        shown = camera.apparent_temperature(radiance)
        shown[0] = hot  # by a thermometer
    else:
        radiance = radiance * (1.0 + GAIN * rng.normal()) + OFFSET * cold[0] * rng.normal()
        shown = camera.apparent_temperature(radiance)
    return shown + NOISE * rng.normal(size=shown.shape)


def with_errors(rng: np.random.Generator, shown: np.ndarray) -> np.ndarray:
    """Readings with an error for each of the four, the same in all rows [K]."""
    spread = EVENLY * np.maximum(LEAST, SHARE * (shown - 273.15).mean(axis=1))
    return shown + (spread * rng.normal(size=4))[:, None]


def judged(
    values: np.ndarray, scene: lab.Scene, truth: np.ndarray, condition: str,
    accuracy: float | None = None,
) -> list[Trial]:  # fmt: skip
    """Intervals that the command prints, beside the truth."""
    spread = standard_uncertainties(lab.THERMAL, values.mean(axis=1), accuracy)
    readings = lab.Readings(lab.THERMAL, values, spread, scene)
    result = lab.reduce_readings(readings, draws=DRAWS)
    return [
        Trial(f"{name}, {way}, {condition}", true, *estimates[name].interval)
        for way, estimates in (("first order", result.first_order),
                               ("Monte Carlo", result.monte_carlo))
        for name, true in zip(result.first_order, truth, strict=True)
    ]  # fmt: skip


def trials(seed: int) -> list[Trial]:
    """One film before one camera, with several numbers of repeats."""
    rng = np.random.default_rng([seed, 9])
    found = []
    camera = Camera(rng.uniform(7e-6, 8.5e-6), rng.uniform(12e-6, 14.5e-6))
    band = lab.flat_band(*camera.ends)
    ambient = rng.uniform(290.0, 300.0)
    for count in REPEATS:
        truth = film(rng)
        values = with_errors(rng, rows(rng, camera, truth, count, ambient))
        found += judged(values, lab.Scene(band), truth, f"{count} repeats")
    for count in FEW:
        truth = film(rng)
        values = rows(rng, camera, truth, count, ambient)
        found += judged(values, lab.Scene(band), truth, f"{count} repeats, exact camera", 0.0)
    truth, emissivity, warmth = film(rng), 0.93, rng.uniform(5.0, 20.0)
    values = with_errors(rng, rows(rng, camera, truth, 5, ambient, emissivity, warmth))
    scene = lab.Scene(
        band,
        Measured(emissivity + 0.02 * rng.normal(), 0.02),
        Measured(ambient + warmth + 5.0 * rng.normal(), 5.0),
    )
    return found + judged(values, scene, truth, "warm film and grey hotplate")
