"""Intervals of ``lab ftir``: band means and Planck-weighted means of spectra with correlated noise.

A spectrum is made as a spectrometer makes it: an interferogram with white noise, apodised, zero
filled and transformed. The film's transmittance and reflectance are Lorentzian bands, whose means
over the band and Planck's spectrum are the truth, by quadrature. The ordinate has a slow error of
the stated accuracy: a wave of a random phase along the spectrum, longer than its range, the same in
all repeats.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.fft import dct
from trial import Trial

from lightflyer.lab.ftir.reduction import reduce_ftir
from lightflyer.lab.readers.spectrum_data import MeasuredSpectrum

COMMAND = "lab ftir"
BAND = (500.0, 1300.0)  # [1/cm], as the command's default
MEASURED = (400.0, 4000.0)  # [1/cm]
TEMPERATURES = (300.0, 441.0)

_LASER = 7899.0  # highest wavenumber of the transform [1/cm]
_NOISE = 0.002  # of a point of the spectrum without apodisation
_DRIFT_PERIOD = 4e4  # of the slow error [1/cm]
_SECOND_RADIATION_CONSTANT = 1.438776877  # [K cm], CODATA 2018
# centre and half width [1/cm], share of the light between the bands that is absorbed
_BANDS = ((728.0, 10.0, 0.30), (1100.0, 25.0, 0.22), (1245.0, 25.0, 0.28), (1725.0, 14.0, 0.40),
          (2960.0, 30.0, 0.05))  # fmt: skip
_TRANSMITTANCE, _REFLECTANCE = 0.80, 0.12


class Case(NamedTuple):
    """How spectra are made.

    Attributes
    ----------
    name : str
    filling : int
        Factor of zero filling.
    apodisation : tuple of float
        Coefficients of cos(j π x), with x from 0 to 1 along the interferogram.
    accuracy : float
        Standard uncertainty of the ordinate.
    repeats : int
    """

    name: str
    filling: int
    apodisation: tuple[float, ...]
    accuracy: float
    repeats: int = 1


_BOXCAR, _HAPP_GENZEL = (1.0,), (0.54, 0.46)
CASES = (
    Case("white noise only", 1, _BOXCAR, 0.0),
    Case("noise only, zero-filled twice", 2, _BOXCAR, 0.0),
    Case("noise only, zero-filled four times", 4, _BOXCAR, 0.0),
    Case("noise only, Happ-Genzel, zero-filled twice", 2, _HAPP_GENZEL, 0.0),
    Case("Happ-Genzel, zero-filled twice, accuracy 1e-4", 2, _HAPP_GENZEL, 1e-4),
    Case("Happ-Genzel, zero-filled twice, accuracy 1 %", 2, _HAPP_GENZEL, 0.01),
    Case("three repeats, noise only", 2, _HAPP_GENZEL, 0.0, 3),
    Case("three repeats, accuracy 1 %", 2, _HAPP_GENZEL, 0.01, 3),
    Case("three repeats, scatter like accuracy", 2, _HAPP_GENZEL, 6e-5, 3),
)  # fmt: skip


def trials(seed: int) -> list[Trial]:
    """Intervals of one film under all conditions."""
    return [one for number, case in enumerate(CASES) for one in _trials(case, seed, number)]


def _trials(case: Case, seed: int, number: int) -> list[Trial]:
    rng = np.random.default_rng([seed, number])
    result = reduce_ftir(
        _spectra(rng, case, "transmittance"), _spectra(rng, case, "reflectance"),
        band=(BAND[0] * 100.0, BAND[1] * 100.0), temperatures=TEMPERATURES, accuracy=case.accuracy,
    )  # fmt: skip
    ends = result.spectra[0].wavenumber[[0, -1]] / 100.0
    means = truth(float(ends[0]), float(ends[1]))
    found = [
        ("transmittance over the band", means["band"], result.transmittance.band.interval),
        ("emissivity over the band", 1.0 - means["band"] - _REFLECTANCE,
         result.emissivity.interval),
        ("1 - transmittance, one-sided limit", 1.0 - means["band"],
         (0.0, result.summary()["emissivity_upper_bound"]["at_most_95"])),
    ]  # fmt: skip
    for temperature in TEMPERATURES:
        mean = means[temperature]
        found.append((f"transmittance at {temperature:g} K", mean,
                      result.transmittance.planck[temperature].interval))  # fmt: skip
        found.append((f"emissivity at {temperature:g} K", 1.0 - mean - _REFLECTANCE,
                      result.planck_emissivity[temperature].interval))  # fmt: skip
    return [Trial(f"{name}, {case.name}", value, *span) for name, value, span in found]


def transmittance(wavenumber: np.ndarray) -> np.ndarray:
    """True transmittance of the film over wavenumber [1/cm]."""
    value = np.full_like(wavenumber, _TRANSMITTANCE)
    for centre, width, share in _BANDS:
        value -= _TRANSMITTANCE * share / (1.0 + ((wavenumber - centre) / width) ** 2)
    return value


@cache
def truth(lowest: float, highest: float) -> dict[str | float, float]:
    """Means of the true transmittance over the band, and over Planck's spectrum as measured."""
    fine = np.linspace(lowest, highest, 400_001)
    inside = np.linspace(*BAND, 100_001)
    found: dict[str | float, float] = {"band": float(np.mean(transmittance(inside)))}
    for temperature in TEMPERATURES:
        power = fine**3 / np.expm1(_SECOND_RADIATION_CONSTANT * fine / temperature)
        found[temperature] = float(power @ transmittance(fine) / power.sum())
    return found


def _spectra(rng: np.random.Generator, case: Case, quantity: str) -> list[MeasuredSpectrum]:
    """Repeated spectra whose slow error is one and the same."""
    points = 3950  # of the interferogram: 2 per cm between independent points
    path = np.arange(points) / points
    window = sum(part * np.cos(j * np.pi * path) for j, part in enumerate(case.apodisation))
    wavenumber = np.linspace(0.0, _LASER, points * case.filling + 1)
    kept = (wavenumber > MEASURED[0]) & (wavenumber < MEASURED[1])
    wavenumber = wavenumber[kept]
    clean = transmittance(wavenumber) if quantity == "transmittance" else _REFLECTANCE
    phase = 2.0 * np.pi * wavenumber / _DRIFT_PERIOD
    slow = case.accuracy * (rng.normal() * np.cos(phase) + rng.normal() * np.sin(phase))
    found = []
    for _ in range(case.repeats):
        signal = np.zeros(points * case.filling + 1)
        signal[:points] = window * rng.normal(size=points)
        noise = _NOISE * dct(signal, type=1)[kept] / np.sqrt(2.0 * points)
        value = np.round(clean + slow + noise, 6)  # digits of a file
        found.append(MeasuredSpectrum("synthetic", quantity, wavenumber * 100.0, value))
    return found
