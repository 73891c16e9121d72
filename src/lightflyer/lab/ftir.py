r"""Emissivity, or its upper bound, from infrared transmittance and reflectance.

A film absorbs, and so emits, what it neither transmits nor reflects. Spectra are averaged over a
band, and over Planck's spectrum at a temperature,

.. math:: \bar\tau(T) = \frac{\int B_\nu(T)\,\tau(\nu)\,d\nu}{\int B_\nu(T)\,d\nu},

with both integrals over the measured wavenumbers. Without reflectance, :math:`1-\bar\tau` is an
upper bound of the emissivity.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import special

from lightflyer.film.spectra import SECOND_RADIATION_CONSTANT, blackbody_fraction
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ParameterError, ParameterWarning
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.record import dataset
from lightflyer.lab.spectrum_data import MeasuredSpectrum

if TYPE_CHECKING:
    import xarray as xr

PER_CENTIMETRE = 100.0
"""One reciprocal centimetre [1/m]."""

BAND = (500.0 * PER_CENTIMETRE, 1300.0 * PER_CENTIMETRE)
"""Band of the paper, 900 ± 400 cm⁻¹ [1/m]."""

TEMPERATURES = (300.0, 400.0, 441.0, 500.0)
"""Default temperatures of Planck-weighted means [K]."""

_WIDEST_STEP = 1.0  # of hcν/kT in one piece of the quadrature
_NODES, _FEW_NODES = 8, 2  # Gauss-Legendre, per piece
_FINE = 50_000  # points above which a spectrum is fine enough for few nodes
_NOISE_VARIANCE = 6.0  # variance of y[i-1] - 2 y[i] + y[i+1] over the variance of y
_MEDIAN_OF_SQUARE = float(special.chdtri(1, 0.5))  # of a standard normal variable
_ROUNDING = 1e-9  # fraction of the band below which a gap is rounding


@dataclass(frozen=True)
class Averages:
    """Averages of one quantity over the band and over Planck's spectrum.

    Attributes
    ----------
    band : Estimate
    planck : dict of float to Estimate
        By temperature [K].
    """

    band: Estimate
    planck: dict[float, Estimate]


@dataclass(frozen=True)
class Ftir:
    """Transmittance, reflectance and emissivity of a film from its infrared spectra.

    Attributes
    ----------
    spectra : list of MeasuredSpectrum
        Spectra of transmittance.
    reflectances : list of MeasuredSpectrum
        Spectra of reflectance; empty if none was measured.
    band : tuple of float
        [1/m].
    transmittance : Averages
    reflectance : Averages or None
    uncovered_band : float
        Fraction of the band's width without data [1].
    uncovered : dict of float to float
        Fraction of a black body's power without data [1], by temperature [K].
    accuracy : float
        Standard uncertainty of the instrument's ordinate, included in the intervals [1].
    """

    spectra: list[MeasuredSpectrum]
    reflectances: list[MeasuredSpectrum]
    band: tuple[float, float]
    transmittance: Averages
    reflectance: Averages | None
    uncovered_band: float
    uncovered: dict[float, float]
    accuracy: float = 0.0

    @property
    def upper_bound(self) -> Estimate:
        """Upper bound of the emissivity over the band: that of a film that reflects nothing."""
        return _remainder([self.transmittance.band])

    @property
    def emissivity(self) -> Estimate | None:
        """Emissivity over the band; None if reflectance was not measured."""
        if self.reflectance is None:
            return None
        return _remainder([self.transmittance.band, self.reflectance.band])

    def planck_emissivity(self) -> dict[float, Estimate]:
        """Emissivity by temperature [K], or its upper bound if reflectance was not measured."""
        parts = [one for one in (self.transmittance, self.reflectance) if one is not None]
        return {
            temperature: _remainder([part.planck[temperature] for part in parts])
            for temperature in self.uncovered
        }

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        document: dict[str, Any] = {
            "band_transmittance": self.transmittance.band.to_json(),
            "emissivity_upper_bound": self.upper_bound.to_json(),
            "planck_weighted": _by_temperature(self.transmittance.planck),
            "uncovered_fraction": {
                "band": _exact(self.uncovered_band).to_json(),
                **_by_temperature({t: _exact(share) for t, share in self.uncovered.items()}),
            },
            "band_per_cm": [end / PER_CENTIMETRE for end in self.band],
        }
        emissivity = self.emissivity
        if self.reflectance is None or emissivity is None:
            bound = _by_temperature(self.planck_emissivity())
            return document | {"planck_weighted_emissivity_upper_bound": bound}
        return document | {
            "band_reflectance": self.reflectance.band.to_json(),
            "emissivity": emissivity.to_json(),
            "planck_weighted_reflectance": _by_temperature(self.reflectance.planck),
            "planck_weighted_emissivity": _by_temperature(self.planck_emissivity()),
        }


def _exact(value: float) -> Estimate:
    return Estimate(value, (value, value), "", 0.0)


def _by_temperature(estimates: dict[float, Estimate]) -> dict[str, Any]:
    return {f"{temperature:g}": one.to_json() for temperature, one in estimates.items()}


def _remainder(parts: Sequence[Estimate]) -> Estimate:
    """One minus the parts, with independent errors."""
    value = 1.0 - sum(one.value for one in parts)
    low = float(np.sqrt(sum((one.interval[1] - one.value) ** 2 for one in parts)))
    high = float(np.sqrt(sum((one.value - one.interval[0]) ** 2 for one in parts)))
    spread = float(np.sqrt(sum((one.uncertainty or 0.0) ** 2 for one in parts)))
    return Estimate(value, (value - low, value + high), "", spread)


def reduce_ftir(
    spectra: Sequence[MeasuredSpectrum],
    reflectances: Sequence[MeasuredSpectrum] = (),
    *,
    band: tuple[float, float] = BAND,
    temperatures: Sequence[float] = TEMPERATURES,
    accuracy: float = 0.0,
) -> Ftir:
    """Average a film's spectra for its emissivity, or its upper bound.

    Parameters
    ----------
    spectra : sequence of MeasuredSpectrum
        Spectra of transmittance; several are repeated measurements of one film.
    reflectances : sequence of MeasuredSpectrum
        Spectra of reflectance, likewise.
    band : tuple of float
        Lowest and highest wavenumber of the band [1/m].
    temperatures : sequence of float
        Temperatures of the Planck weighting [K].
    accuracy : float
        Standard uncertainty of the instrument's ordinate, common to a whole spectrum [1].

    Returns
    -------
    Ftir

    Raises
    ------
    ParameterError
        If there is no spectrum, one shows another quantity or has no data in the band, or an
        argument is impossible.

    Warns
    -----
    ParameterWarning
        If part of the band has no data.

    Notes
    -----
    The interval of one spectrum includes its noise, estimated from the second differences of its
    points, and the accuracy; that of several includes the scatter of their means and the accuracy.
    """
    require_positive(temperatures=np.asarray(temperatures, float))
    require_range("accuracy", accuracy, 0.0, 1.0)
    require_range("lower end of the band", band[0], 0.0)
    require_range("upper end of the band", band[1], band[0], open_below=True)
    if not spectra:
        raise ParameterError("a spectrum of transmittance is needed")
    for group, quantity in ((spectra, "transmittance"), (reflectances, "reflectance")):
        for one in group:
            if one.quantity != quantity:
                raise ParameterError(f"{one.source}: shows {one.quantity}, not {quantity}")
    every = [*spectra, *reflectances]
    low = max(one.wavenumber[0] for one in every)
    high = min(one.wavenumber[-1] for one in every)
    if low >= high:
        raise ParameterError("the spectra have no wavenumbers in common")
    uncovered = _uncovered_band(band, low, high, spectra[0].source)

    def averages(group: Sequence[MeasuredSpectrum]) -> Averages:
        inside = (max(band[0], low), min(band[1], high))
        return Averages(
            _combined([_band_mean(one, inside) for one in group], accuracy),
            {
                temperature: _combined(
                    [_planck_mean(one, (low, high), temperature) for one in group], accuracy
                )
                for temperature in map(float, temperatures)
            },
        )

    return Ftir(
        spectra=list(spectra),
        reflectances=list(reflectances),
        band=band,
        transmittance=averages(spectra),
        reflectance=averages(reflectances) if reflectances else None,
        uncovered_band=uncovered,
        uncovered={float(t): uncovered_power((low, high), t) for t in temperatures},
        accuracy=accuracy,
    )


def _uncovered_band(band: tuple[float, float], low: float, high: float, source: str) -> float:
    covered = min(band[1], high) - max(band[0], low)
    width = band[1] - band[0]
    in_cm = [end / PER_CENTIMETRE for end in (*band, low, high)]
    if covered <= 0.0:
        raise ParameterError(
            f"{source}: has no data in the band from {in_cm[0]:g} to {in_cm[1]:g} cm^-1; its data "
            f"extend from {in_cm[2]:.5g} to {in_cm[3]:.5g} cm^-1"
        )
    if covered < width * (1.0 - _ROUNDING):
        warnings.warn(
            f"{source}: data from {in_cm[2]:.5g} to {in_cm[3]:.5g} cm^-1 do not cover "
            f"{1.0 - covered / width:.1%} of the band",
            ParameterWarning,
            stacklevel=3,
        )
    return max(0.0, 1.0 - covered / width)


def uncovered_power(covered: tuple[float, float], temperature: float) -> float:
    """Fraction of a black body's power outside a range of wavenumbers.

    Parameters
    ----------
    covered : tuple of float
        Lowest and highest wavenumber [1/m].
    temperature : float
        [K].

    Returns
    -------
    float
        [1].
    """
    below = 1.0 - blackbody_fraction(1.0 / covered[0], temperature) if covered[0] > 0.0 else 0.0
    return below + blackbody_fraction(1.0 / covered[1], temperature)


def _cut(spectrum: MeasuredSpectrum, ends: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Points of a spectrum between two wavenumbers, including both ends."""
    inside = (spectrum.wavenumber > ends[0]) & (spectrum.wavenumber < ends[1])
    wavenumber = np.concatenate([ends[:1], spectrum.wavenumber[inside], ends[1:]])
    return wavenumber, np.interp(wavenumber, spectrum.wavenumber, spectrum.value)


def _noise(value: np.ndarray) -> float:
    """Standard deviation of a spectrum's noise, from second differences of its points."""
    if len(value) < 3:
        return 0.0
    bends = np.diff(value, 2)
    return float(np.sqrt(np.median(bends**2) / (_MEDIAN_OF_SQUARE * _NOISE_VARIANCE)))


def _band_mean(spectrum: MeasuredSpectrum, ends: tuple[float, float]) -> tuple[float, float]:
    """Mean over a band, linear between points, and its noise."""
    wavenumber, value = _cut(spectrum, ends)
    width = np.diff(wavenumber)
    share = 0.5 * (np.append(width, 0.0) + np.append(0.0, width)) / (ends[1] - ends[0])
    first = value[0]  # subtracted, so that the mean of a flat spectrum is exact
    mean = first + float(share @ (value - first))
    return mean, _noise(value) * float(np.sqrt(share @ share))


def planck_weights(wavenumber: np.ndarray, temperature: float, nodes: int = _NODES) -> np.ndarray:
    r"""Weights of points for a Planck-weighted mean, linear between the points.

    Parameters
    ----------
    wavenumber : array, shape (n,)
        Increasing [1/m].
    temperature : float
        [K].
    nodes : int
        Nodes of Gauss-Legendre quadrature in each piece.

    Returns
    -------
    array, shape (n,)
        Their sum is one.

    Notes
    -----
    The weight of a point is the integral of :math:`B_\nu(T)` times the hat function that is one at
    the point and zero at its neighbours.
    """
    per_metre = SECOND_RADIATION_CONSTANT / temperature
    steps = np.maximum(1, np.ceil(np.diff(wavenumber) * per_metre / _WIDEST_STEP)).astype(int)
    left = np.repeat(np.arange(len(steps)), steps)
    piece = np.arange(len(left)) - np.repeat(np.cumsum(steps) - steps, steps)
    width = np.diff(wavenumber)[left] / steps[left]
    start = wavenumber[left] + piece * width
    weights = np.zeros(len(wavenumber))
    for node, weight in zip(*np.polynomial.legendre.leggauss(nodes), strict=True):
        at = start + 0.5 * (1.0 + node) * width
        x = at * per_metre
        power = 0.5 * weight * width * x**3 * np.exp(-x) / -np.expm1(-x)
        share = (at - wavenumber[left]) / np.diff(wavenumber)[left]
        weights += np.bincount(left, power * (1.0 - share), len(weights))
        weights += np.bincount(left + 1, power * share, len(weights))
    return weights / weights.sum()


def _planck_mean(
    spectrum: MeasuredSpectrum, ends: tuple[float, float], temperature: float
) -> tuple[float, float]:
    """Planck-weighted mean and its noise."""
    wavenumber, value = _cut(spectrum, ends)
    nodes = _FEW_NODES if len(wavenumber) > _FINE else _NODES
    weights = planck_weights(wavenumber, temperature, nodes)
    mean = value[0] + float(weights @ (value - value[0]))
    return mean, _noise(value) * float(np.sqrt(weights @ weights))


def _combined(means: Sequence[tuple[float, float]], accuracy: float) -> Estimate:
    """Mean of repeated spectra."""
    values = np.array([mean for mean, _ in means])
    if len(values) == 1:
        return Estimate.normal(float(values[0]), float(np.hypot(means[0][1], accuracy)))
    scatter = float(values.std(ddof=1) / np.sqrt(len(values)))
    random = Estimate.normal(float(values.mean()), scatter, freedom=len(values) - 1)
    systematic = Estimate.normal(0.0, accuracy)
    half = float(np.hypot(random.interval[1] - random.value, systematic.interval[1]))
    spread = float(np.hypot(scatter, accuracy))
    return Estimate(random.value, (random.value - half, random.value + half), "", spread)


def to_dataset(result: Ftir) -> "xr.Dataset":
    """Dataset of the spectra, each over its own wavenumbers.

    Parameters
    ----------
    result : Ftir

    Returns
    -------
    xarray.Dataset
    """
    variables: dict[str, Any] = {}
    for group in (result.spectra, result.reflectances):
        for number, one in enumerate(group):
            name = f"{one.quantity}_{number}"
            dimension = f"wavenumber_{name}"
            variables[dimension] = (
                dimension, one.wavenumber / PER_CENTIMETRE,
                {"units": "cm-1", "long_name": "wavenumber"},
            )  # fmt: skip
            variables[name] = (
                dimension, one.value,
                {"units": "1", "long_name": one.quantity, "file": one.source},
            )  # fmt: skip
    files = [one.source for one in (*result.spectra, *result.reflectances)]
    return dataset("infrared spectra", variables, files)
