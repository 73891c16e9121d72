r"""Noise of a measured spectrum, whose neighbouring points are correlated.

Zero filling, apodisation and smoothing make the errors of neighbouring points alike. The variance
of a mean with smooth weights :math:`w_i` is then

.. math:: u^2\Bigl(\sum_i w_iy_i\Bigr) = \sum_i w_i^2S_i,\qquad
    S = \sum_{j=-\infty}^{\infty}\operatorname{cov}(y_i,y_{i+j}),

with the noise's spectral density :math:`S` at zero frequency, which is the variance of one point
only if points are independent.

Frequencies along a spectrum are optical path differences. The noise of the detector is the same at
all of them up to the longest one measured, and apodisation reduces it towards that end; zero
filling leaves nothing beyond. What the film itself does to the spectrum is at the shortest path
differences, and in few places of the spectrum. The density is therefore the median over segments of
the spectrum, fitted at the longer path differences and extended to zero.
"""

import numpy as np
from scipy import ndimage, signal, special

LEAST_POINTS = 200  # Points below which correlation is not estimated

_SEGMENTS, _LEAST_SEGMENTS = 24, 4  # of a spectrum, at first and at least
_LEAST_BINS = 24  # of the density with noise; else segments are made longer
_FILM_BINS = 7  # of the density that the film itself may dominate, and the window's main lobe
_REFERENCE_BINS = 5  # behind these, whose median is the reference for the density's end
_END_OF_NOISE = 0.01  # of the reference: no noise is measured beyond
_FITTED_END = 0.85  # of the frequencies with noise, up to which the density is fitted
# density over frequency, 1 - u^a to some power: 2 suits the cosine, Happ-Genzel, Norton-Beer and
# Blackman-Harris functions and 1 the triangle; between the two all are within 15 % of the noise
_SHAPE = 1.6
_POINT_LAGS = (1, 2, 4, 8)
_LOCAL_WINDOWS = 4  # parts of a spectrum for which its noise is told apart
_BEND_VARIANCE = 6.0  # variance of y[i-m] - 2 y[i] + y[i+m] over that of independent y
_MEDIAN_OF_SQUARE = float(special.chdtri(1, 0.5))  # of a standard normal variable


def noise_density(value: np.ndarray) -> np.ndarray:
    """Noise density at zero frequency, at each point of a spectrum [1], shape (n,)."""
    # Below :data:`LEAST_POINTS` points errors are taken as independent. Structure of the film finer
    # than some ten points counts as noise, so the density is then too large. A triangular
    # apodisation makes the noise of a mean 15 % too small, the other usual ones a few per cent.
    #
    # Source: [Welch1967]_ for densities from segments; [Griffiths2007]_ ch. 2 for apodisation and
    # zero filling.
    if len(value) < 3:
        return np.zeros(len(value))
    if len(value) < LEAST_POINTS:
        return np.full(len(value), np.median(_bends(value, 1)))
    density, end = _density_at_zero(value)
    # variance of the noise near each point over that of the whole spectrum
    squares = _bends(value, lag=max(1, round(0.5 / end)))
    whole = float(np.median(squares))
    if not whole > 0.0:
        return np.full(len(value), density)
    window = 2 * (len(value) // (2 * _LOCAL_WINDOWS)) + 1
    # one in several squares is enough for a median, and much faster
    step = max(1, window // 200)
    local = ndimage.median_filter(squares[::step], size=max(1, window // step), mode="nearest")
    middle = np.arange(len(squares))[::step] + 0.5 * (len(value) - len(squares))
    return np.asarray(density * np.interp(np.arange(len(value)), middle, local / whole))


def point_noise(value: np.ndarray) -> float:
    """Standard deviation of the noise of single points, roughly [1]; ``value`` (n,)."""
    lags = [lag for lag in _POINT_LAGS if 2 * lag < len(value)]
    return float(np.sqrt(max((np.median(_bends(value, lag)) for lag in lags), default=0.0)))


def _density_at_zero(value: np.ndarray) -> tuple[float, float]:
    """Density at zero frequency, and the highest frequency with noise [per point]."""
    length = len(value) // _SEGMENTS
    while True:
        # two-sided, the median over overlapping segments
        size = max(length, 2 * (_FILM_BINS + _REFERENCE_BINS))
        frequency, density = signal.welch(
            value, window="blackmanharris", nperseg=size, noverlap=2 * size // 3,
            detrend="linear", average="median",
        )  # fmt: skip
        density = 0.5 * density
        reference = float(np.median(density[_FILM_BINS : _FILM_BINS + _REFERENCE_BINS]))
        last = int(np.flatnonzero(density > _END_OF_NOISE * reference).max(initial=0))
        if last >= _LEAST_BINS or 2 * length > len(value) // _LEAST_SEGMENTS:
            break
        length *= 2
    if not reference > 0.0:
        return 0.0, float(frequency[-1])
    end = max(last, _FILM_BINS)
    share = frequency / frequency[end]
    fitted = (np.arange(len(share)) >= _FILM_BINS) & (share <= _FITTED_END)
    fitted &= density > 0.0
    if np.count_nonzero(fitted) <= 2:
        return reference, float(frequency[end])
    power, at_zero = np.polyfit(np.log1p(-(share[fitted] ** _SHAPE)), np.log(density[fitted]), 1)
    if power < 0.0:  # noise that grows with frequency is taken as even
        at_zero = np.log(density[fitted]).mean()
    return float(np.exp(at_zero)), float(frequency[end])


def _bends(value: np.ndarray, lag: int) -> np.ndarray:
    """Squared second differences over a lag, with the variance of independent points."""
    lag = min(lag, (len(value) - 1) // 2)
    bends = value[: -2 * lag] - 2.0 * value[lag:-lag] + value[2 * lag :]
    return np.asarray(bends**2 / (_MEDIAN_OF_SQUARE * _BEND_VARIANCE))
