r"""Intervals of roughness parameters: few patches, levelling, and the microscope's calibration.

A map is one sample of a surface. The variance of a mean over it, such as :math:`S_q^2`, is the
power of its squared heights at low frequencies over the number of pixels. Eight low cosine modes
measure it, with eight degrees of freedom [Lazarus2018]_.
This holds for any distribution of heights and any correlation shorter than the map.

Levelling takes away the roughness at the longest wavelengths. How much is extrapolated from the
spectrum of what is left.
"""

from typing import NamedTuple

import numpy as np
from scipy import fft

DRAWS = 4000  # Draws of an interval

_MODES = 8  # low cosine modes of the variance of a mean
SPECTRUM = 64  # Cosine modes along each side for the fit of the spectrum

_POWER_FITTED = 0.8  # of the map's; the fit is of the lowest modes that hold it
_FEWEST_FITTED = 24  # modes
_MOST_LOST = 0.5  # of a mode's power; modes that lose more are not fitted
_FALLS = np.geomspace(1e-5, 1.0, 100)  # over the steepest
_EXPONENTS = (1.5, 3.0, 8.0, 50.0)  # exponential autocorrelation to nearly Gaussian
_STEEPEST = (0.93, 0.28, 0.18, 0.16)  # b of an autocorrelation of 1/e at a quarter of the map
_LOST_IN_SQUARES, _MOST_LOST_IN_SQUARES = 8.0, 2.0
"""Loss of low frequencies in the squares, over that in the heights; from simulated surfaces."""

_LEAST_VARIANCE = 2.0  # of the square of one independent height


class Spread(NamedTuple):
    """What a map says of its surface."""

    ratios: np.ndarray  # shape (2, draws); draws of Sq and Sa of the surface over those of the map
    lost: float  # Power that levelling took, over the power left
    patches: float  # Effective number of independent heights in the mean of squares


def spread(
    height: np.ndarray,
    mask: np.ndarray,
    kept: np.ndarray,
    rng: np.random.Generator,
    pixel_aspect: float = 1.0,
) -> Spread:
    """How far a surface's rms and mean absolute height may be from those of its map."""
    # ``height`` [m] is levelled, of mean zero outside the ``mask`` of pixels that do not count, and
    # not zero everywhere; ``kept`` is the share of the power of each mode that levelling keeps. The
    # surface is taken to be isotropic.
    values = height[~mask]
    rms, mean = np.sqrt(np.mean(values**2)), np.abs(values).mean()
    lost = _loss(np.where(mask, 0.0, height / rms), kept, rng, pixel_aspect)
    # levelling takes low frequencies from the squares too
    missing = 1.0 + min(_LOST_IN_SQUARES * float(np.median(lost)), _MOST_LOST_IN_SQUARES)
    scaled = np.stack([(height / rms) ** 2 - 1.0, 2.0 * (np.abs(height) / mean - 1.0)])
    power = np.array([_low_power(np.where(mask, 0.0, one), pixel_aspect) for one in scaled])
    variances = np.maximum(missing * power, _LEAST_VARIANCE) / values.size  # of relative squares
    drawn = variances[:, None] * _MODES / rng.chisquare(_MODES, DRAWS)
    freedom = np.maximum(2.0 / drawn, 1.0)
    return Spread(
        np.sqrt(freedom / rng.chisquare(freedom) + lost),
        float(np.median(lost)),
        float(2.0 / variances[0]),
    )


def _low_power(values: np.ndarray, pixel_aspect: float) -> float:
    """Power of a field in its lowest cosine modes, without the mean."""
    rows, columns = values.shape
    numbers = sorted(
        ((i, j) for i in range(_MODES) for j in range(_MODES) if i + j),
        key=lambda one: (one[0] * pixel_aspect / rows) ** 2 + (one[1] / columns) ** 2,
    )[:_MODES]
    power = _cosine_power(values)
    return float(np.mean([power[one] for one in numbers]))


def _cosine_power(values: np.ndarray) -> np.ndarray:
    """Squares of the lowest orthonormal cosine coefficients; shape (modes, modes)."""
    modes = min(*values.shape, SPECTRUM)
    along = fft.dct(values, axis=0, norm="ortho")[:modes]
    return fft.dct(along, axis=1, norm="ortho")[:, :modes] ** 2


def _loss(
    scaled: np.ndarray, kept: np.ndarray, rng: np.random.Generator, pixel_aspect: float
) -> np.ndarray:
    r"""Draws of the power that levelling took, over the power left."""
    # The spectrum :math:`A (1 + b n^2/m)^{-m}` of the squared mode number is fitted to the modes
    # that levelling leaves; posterior of A for each b and m, with a prior flat in ln A and ln b up
    # to correlation lengths of a quarter of the map.
    power = _cosine_power(scaled)
    rows, columns = np.indices(power.shape)
    aspect = pixel_aspect * scaled.shape[1] / scaled.shape[0]  # width of the map over its length
    square = (rows * aspect) ** 2 + columns**2.0  # of the wave number, in modes of a row
    used = (kept > _MOST_LOST) & (square > 0.0)
    order = np.argsort(square[used])
    numbers, seen = square[used][order], (power[used] / kept[used])[order]
    held = np.searchsorted(np.cumsum(seen), _POWER_FITTED * (scaled**2).sum())
    count = int(min(max(held, _FEWEST_FITTED), len(numbers)))
    numbers, seen = numbers[:count], seen[:count]
    steepest = zip(_STEEPEST, _EXPONENTS, strict=True)
    shapes = np.array([[fall * most, exponent] for most, exponent in steepest for fall in _FALLS])

    def spectrum(at: np.ndarray) -> np.ndarray:
        """Shape (number of shapes, number of modes)."""
        falls, exponents = shapes.T[:, :, None]
        return (1.0 + falls * at / exponents) ** -exponents

    model = spectrum(numbers)
    scales = (seen / model).sum(axis=1)
    likelihood = -0.5 * np.log(model).sum(axis=1) - 0.5 * count * np.log(scales)
    weights = np.exp(likelihood - likelihood.max())
    gone = kept < 1.0 - 1e-3
    unseen = spectrum(square[gone]) @ (1.0 - kept[gone])
    picks = rng.choice(len(weights), DRAWS, p=weights / weights.sum())
    drawn = scales[picks] * unseen[picks] / rng.chisquare(count, DRAWS)
    return drawn / (scaled**2).sum()
