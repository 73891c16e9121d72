"""Residuals in the order of a coordinate: whether they follow it, and over how many points."""

from math import comb

import numpy as np
from scipy.special import chdtri, ndtri

LEAST_PROBABILITY = 0.02
"""Probability of so few runs below which residuals are said to follow the coordinate."""

_MOST_MEANS = 40  # means of neighbours that very many residuals are replaced by
_LEAST_INDEPENDENT = 2.0
_ROUNDING = 1e-6  # relative, of residuals of points that a model computed


def correlation_length(residual: np.ndarray) -> tuple[float, float]:
    r"""Number of points in which residuals are alike; returns ``length``, ``freedom``."""
    # .. math:: \left(1+\frac{2W+1}{n}\right)\left(1 + 2\sum_{k=1}^W\rho_k\right)
    #
    # with the autocorrelations up to where they are no longer positive. The first factor removes
    # the bias of a sum of few autocorrelations of few points.
    #
    # Source: [Geyer1992]_ for the end of the sum, [Wolff2004]_ for its bias and its variance.
    size = len(residual)
    power = np.abs(np.fft.rfft(residual, 2 * size)) ** 2
    auto = np.fft.irfft(power)[:size]
    if not auto[0] > 0.0:
        return 1.0, float(size)
    auto = auto / auto[0]
    # an even and the next odd lag together: noise makes single ones negative too early
    pairs = auto[: 2 * (size // 2)].reshape(-1, 2).sum(axis=1)
    negative = np.flatnonzero(pairs <= 0.0)
    last = negative[0] if negative.size else len(pairs)
    window = 4 * last - 1  # 2W + 1, as the last lag of the sum is 2 last - 1
    bias = 1.0 + window / size
    return float(max(1.0, bias * (2.0 * pairs[:last].sum() - 1.0))), float(size / window)


def alike_points(residuals: np.ndarray) -> float:
    """Number of points in which residuals are alike, in their order: one if nothing shows it."""
    # Means of neighbours bring out what very many points follow together, below their scatter. They
    # show it by long runs of one sign, by their serial correlation (whose standard error is
    # 1/√n), or by scattering more than those of independent points.
    parts = np.array_split(residuals, min(residuals.size, _MOST_MEANS))
    means = np.array([one.mean() for one in parts])
    per_mean = residuals.size / means.size
    scatter = float(np.mean(residuals**2))
    if scatter < _ROUNDING**2:
        return 1.0
    excess = per_mean * float(np.mean(means**2)) / scatter
    usual = chdtri(means.size, LEAST_PROBABILITY) / means.size
    serial = float(means[1:] @ means[:-1]) / float(means @ means)
    if (
        runs_probability(means) >= LEAST_PROBABILITY
        and serial < ndtri(1.0 - LEAST_PROBABILITY) / np.sqrt(means.size)
        and excess < usual
    ):
        return 1.0
    length = max(excess, 1.0) * correlation_length(means)[0]
    return float(min(length, residuals.size / _LEAST_INDEPENDENT))


def runs_probability(residuals: np.ndarray) -> float:
    """Probability of no more runs of one sign than these, if the signs stand in any order."""
    # Source: [WaldWolfowitz1940]_.
    above = residuals > 0.0
    first, second = int(above.sum()) - 1, int((~above).sum()) - 1
    if first < 0 or second < 0:
        return 1.0

    def orders(runs: int) -> int:
        less, more = (runs - 2) // 2, (runs - 1) // 2
        return comb(first, less) * comb(second, more) + comb(first, more) * comb(second, less)

    found = 1 + int(np.sum(above[1:] != above[:-1]))
    return sum(map(orders, range(2, found + 1))) / comb(first + second + 2, first + 1)
