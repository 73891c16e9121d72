"""Means of a spectrum over a band and over Planck's spectrum, with their noise."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lightflyer.film.optics.spectra import SECOND_RADIATION_CONSTANT, blackbody_fraction
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate, student_factor
from lightflyer.lab.readers.spectra.interpretation import MeasuredSpectrum

_WIDEST_STEP = 1.0  # of hcν/kT in one piece of the quadrature
_NODES, _FEW_NODES = 8, 2  # Gauss-Legendre, per piece
_FINE = 50_000  # points above which a spectrum is fine enough for few nodes


class MeanShare(NamedTuple):
    """A mean share with its standard uncertainties, not yet cut at what is possible."""

    value: float  # [1]
    random: float  # Standard uncertainties from noise or scatter, and of the instrument [1]
    freedom: float  # Degrees of freedom of the random one
    accuracy: float

    def estimate(self) -> Estimate:
        half = np.hypot(student_factor(self.freedom) * self.random, NORMAL_FACTOR * self.accuracy)
        return Estimate.covering(self.value, float(half))


def remainder(parts: Sequence[MeanShare]) -> MeanShare:
    """One minus the parts, with independent errors; degrees of freedom after Welch."""
    variances = np.array([part.random**2 for part in parts])
    lost = sum(one**2 / part.freedom for one, part in zip(variances, parts, strict=True))
    return MeanShare(
        1.0 - sum(part.value for part in parts),
        float(np.sqrt(variances.sum())),
        float(variances.sum() ** 2 / lost) if lost > 0.0 else np.inf,
        float(np.sqrt(sum(part.accuracy**2 for part in parts))),
    )


def uncovered_power(covered: tuple[float, float], temperature: float) -> float:
    """Fraction of a black body's power outside a range of wavenumbers [1]; ``covered`` [1/m]."""
    below = 1.0 - blackbody_fraction(1.0 / covered[0], temperature) if covered[0] > 0.0 else 0.0
    return below + blackbody_fraction(1.0 / covered[1], temperature)


def mean_over(
    spectrum: MeasuredSpectrum, noise: np.ndarray, ends: tuple[float, float],
    temperature: float | None = None,
) -> tuple[float, float]:  # fmt: skip
    """Mean over a band, or Planck's spectrum in it, and its standard uncertainty from noise [1].

    Linear between points; ``noise``: density at each point, shape (n,).
    """
    inside = (spectrum.wavenumber > ends[0]) & (spectrum.wavenumber < ends[1])
    wavenumber = np.concatenate([ends[:1], spectrum.wavenumber[inside], ends[1:]])
    value, density = (
        np.interp(wavenumber, spectrum.wavenumber, one) for one in (spectrum.value, noise)
    )
    if temperature is None:
        width = np.diff(wavenumber)
        weights = 0.5 * (np.append(width, 0.0) + np.append(0.0, width)) / (ends[1] - ends[0])
    else:
        nodes = _FEW_NODES if len(wavenumber) > _FINE else _NODES
        weights = planck_weights(wavenumber, temperature, nodes)
    first = value[0]  # subtracted, so that the mean of a flat spectrum is exact
    return first + float(weights @ (value - first)), float(np.sqrt(weights**2 @ density))


def planck_weights(wavenumber: np.ndarray, temperature: float, nodes: int = _NODES) -> np.ndarray:
    r"""Weights of points for a Planck-weighted mean, linear between the points, shape (n,)."""
    # The weight of a point is the integral of :math:`B_\nu(T)` times the hat function that is one
    # at the point and zero at its neighbours.
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


def combine_repeats(means: Sequence[tuple[float, float]], accuracy: float) -> MeanShare:
    """Mean of repeats, with the scatter of the means or the noise of the only one."""
    values = np.array([mean for mean, _ in means])
    if len(values) == 1:
        return MeanShare(float(values[0]), means[0][1], np.inf, accuracy)
    scatter = float(values.std(ddof=1) / np.sqrt(len(values)))
    return MeanShare(float(values.mean()), scatter, len(values) - 1, accuracy)
