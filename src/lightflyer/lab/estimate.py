r"""Measured numbers with their intervals, and the noise of spectra.

Zero filling, apodisation and smoothing make the errors of a spectrum's neighbouring points alike.
The variance of a mean with smooth weights :math:`w_i` is then

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

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import ndimage, optimize, special, stats

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import require_record

CONFIDENCE = 0.95  # Confidence of every interval of the lab bench

NORMAL_FACTOR = float(stats.norm.ppf(0.5 + 0.5 * CONFIDENCE))
"""Half width of a normal distribution's 95 % interval over its standard deviation [1]."""

_NEGLIGIBLE = 1e-12  # of the variance between estimates

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


@dataclass(frozen=True)
class Estimate(ShortRepr):
    """A measured number."""

    value: float
    #: Ends of the 95 % interval; infinite where the data set no bound
    interval: tuple[float, float]
    unit: str = ""  #: Unit of value, interval and uncertainty; ``""`` for a pure number
    uncertainty: float | None = None  #: Standard uncertainty, if the interval has one

    @classmethod
    def normal(
        cls, value: float, uncertainty: float, unit: str = "", freedom: float = math.inf
    ) -> "Estimate":
        """An estimate with a symmetric interval."""
        half = student_factor(freedom) * uncertainty
        return cls(float(value), (float(value - half), float(value + half)), unit, uncertainty)

    @classmethod
    def covering(cls, value: float, half: float, unit: str = "") -> "Estimate":
        """An estimate whose uncertainty carries its 95 % interval on."""
        # The standard error of few repeats is too small to be used as that of a normal
        # distribution: two repeats need 12.7 of them in place of 1.96. The uncertainty here is that
        # of the normal distribution with the same 95 % interval.
        value, half = float(value), float(half)
        return cls(value, (value - half, value + half), unit, half / NORMAL_FACTOR)

    @classmethod
    def of_draws(cls, value: float, draws: np.ndarray, unit: str = "") -> "Estimate":
        """An estimate with the percentile interval of draws."""
        low, high = map(float, central_interval(draws))
        return cls(value, (min(low, value), max(high, value)), unit, float(draws.std(ddof=1)))

    def clipped(self, low: float, high: float) -> "Estimate":
        """The estimate within what is possible; its uncertainty is unchanged."""
        value, *ends = np.clip([self.value, *self.interval], low, high).tolist()
        return Estimate(value, (ends[0], ends[1]), self.unit, self.uncertainty)

    def to_json(self) -> dict[str, Any]:
        """JSON object of value, interval, uncertainty and unit; what is unknown is null."""
        low, high, spread = (
            float(one) if one is not None and math.isfinite(one) else None
            for one in (*self.interval, self.uncertainty)
        )
        return {
            "value": float(self.value),
            "interval_95": [low, high],
            "standard_uncertainty": spread,
            "unit": self.unit,
        }

    def interval_text(self, digits: int = 4) -> str:
        """The 95 % interval, as tables show it."""
        low, high = self.interval
        return f"{low:.{digits}g} to {high:.{digits}g}"

    def __str__(self) -> str:
        return f"{self.value:.4g} ({self.interval_text()}) {self.unit}".rstrip()


def central_interval(draws: np.ndarray, axis: int = -1) -> np.ndarray:
    """Central 95 % interval of draws, shape (2, ...); lower and upper ends."""
    tail = 0.5 * (1.0 - CONFIDENCE)
    return np.asarray(np.quantile(draws, [tail, 1.0 - tail], axis=axis))


def student_factor(freedom: float) -> float:
    """Half width of the 95 % interval over the standard uncertainty."""
    return float(stats.t.ppf(0.5 + 0.5 * CONFIDENCE, freedom))


def weighted_mean(estimates: Sequence[Estimate], *, common: float = 0.0) -> Estimate:
    r"""Mean of estimates of one quantity, including the variance between them.

    Parameters
    ----------
    estimates : sequence of Estimate
        In the same unit, with standard uncertainties whose errors are independent of each other.
    common : float
        Standard uncertainty of an error that all estimates share, such as that of one gauge, in
        their unit. It is not part of their own uncertainties, and does not average out.

    Returns
    -------
    Estimate
        Its uncertainty is that of the normal distribution with the same 95 % interval.

    Raises
    ------
    ParameterError
        If there is no estimate, or the uncertainty of one of several is missing or zero.

    Notes
    -----
    Estimates are weighted by :math:`w_i=1/(u_i^2+\tau^2)`. Here :math:`\tau^2`, the variance
    between them beyond their own uncertainties, is the one for which
    :math:`Q=\sum w_i(y_i-\bar y)^2` is :math:`k-1` (Paule and Mandel), or zero where they agree.
    The half width is Student's factor for :math:`k-1` degrees of freedom times
    :math:`\sqrt{Q/((k-1)\sum w_i)}` (Hartung and Knapp), but never less than the one of the stated
    uncertainties, :math:`1.96/\sqrt{\sum w_i}`: a few estimates may agree by chance. Where they
    vary by no more than their uncertainties, the interval is wider than it need be. That of two is
    wide in any case: Student's factor is 12.7.

    References
    ----------
    [PauleMandel1982]_, [HartungKnapp2001]_, [Roever2015]_.

    Examples
    --------
    >>> print(weighted_mean([Estimate.normal(one, 0.03) for one in (0.86, 0.92, 0.75, 0.81)]))
    0.835 (0.7199 to 0.9501)
    """
    for one in estimates:
        require_record("an estimate", (Estimate,), one)
    if len(estimates) == 1:
        one = estimates[0]
        if not common:
            return one
        low, high = (math.hypot(end - one.value, NORMAL_FACTOR * common) for end in one.interval)
        uncertainty = None if one.uncertainty is None else math.hypot(one.uncertainty, common)
        return Estimate(one.value, (one.value - low, one.value + high), one.unit, uncertainty)
    if not estimates or not all(one.uncertainty for one in estimates):
        raise ParameterError("a weighted mean needs estimates with uncertainties above zero")
    values = np.array([one.value for one in estimates])
    variances = np.array([one.uncertainty for one in estimates], float) ** 2
    weights = 1.0 / (variances + _variance_between(values, variances))
    mean = float(weights @ values / weights.sum())
    freedom = len(values) - 1
    scatter = float(weights @ (values - mean) ** 2) / freedom
    factor = max(student_factor(freedom) * math.sqrt(scatter), NORMAL_FACTOR)
    half = math.hypot(factor / math.sqrt(weights.sum()), NORMAL_FACTOR * common)
    return Estimate.covering(mean, half, estimates[0].unit)


def _variance_between(values: np.ndarray, variances: np.ndarray) -> float:
    """Variance between estimates beyond their own variances, by Paule and Mandel."""

    def excess(between: float) -> float:
        weights = 1.0 / (variances + between)
        mean = weights @ values / weights.sum()
        return float(weights @ (values - mean) ** 2) - (len(values) - 1)

    highest = float(values.var(ddof=1))  # where the excess is not positive but by rounding
    if excess(0.0) <= 0.0:
        return 0.0
    if excess(highest) >= 0.0:
        return highest
    return float(optimize.brentq(excess, 0.0, highest, xtol=_NEGLIGIBLE * highest))


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
    from scipy import signal  # slow to import

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
