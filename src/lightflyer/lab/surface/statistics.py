r"""Statistics of a levelled map: intervals of its parameters, autocorrelation, spectrum and slopes.

A map is one sample of a surface. The variance of a mean over it, such as :math:`S_q^2`, is the
power of its squared heights at low frequencies over the number of pixels. Eight low cosine modes
measure it, with eight degrees of freedom [Lazarus2018]_.
This holds for any distribution of heights and any correlation shorter than the map. Levelling takes
away the roughness at the longest wavelengths; how much is extrapolated from the spectrum of what is
left.

The power spectrum is that of [ISO25178]_ over spatial frequencies, averaged over directions:
:math:`S_q^2 = 2\pi\int f\,C(f)\,df`.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

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
_FEWEST_PAIRS = 0.2  # share of the map's pixels, from which a mean over pairs is taken


class Spread(NamedTuple):
    """What a map says of its surface."""

    ratios: np.ndarray  # shape (2, draws); draws of Sq and Sa of the surface over those of the map
    lost: float  # Power that levelling took, over the power left
    patches: float  # Effective number of independent heights in the mean of squares


def spread(
    height: np.ndarray, mask: np.ndarray, kept: np.ndarray, rng: np.random.Generator,
    pixel_aspect: float = 1.0,
) -> Spread:  # fmt: skip
    """How far a surface's rms and mean absolute height may be from those of its map."""
    # ``height`` [m] is levelled, of mean zero outside the ``mask`` of pixels that do not count, and
    # not zero everywhere; ``kept`` is the share of the power of each mode that levelling keeps. The
    # surface is taken to be isotropic.
    values = height[~mask]
    rms, mean = np.sqrt(np.mean(values**2)), np.abs(values).mean()
    lost = _loss(np.where(mask, 0.0, height / rms), kept, rng, pixel_aspect)
    # levelling takes low frequencies from the squares too
    missing = 1.0 + min(_LOST_IN_SQUARES * float(np.median(lost)), _MOST_LOST_IN_SQUARES)
    rows, columns = height.shape
    lowest = sorted(
        ((i, j) for i in range(_MODES) for j in range(_MODES) if i + j),
        key=lambda one: (one[0] * pixel_aspect / rows) ** 2 + (one[1] / columns) ** 2,
    )[:_MODES]
    power = []
    for scaled in ((height / rms) ** 2 - 1.0, 2.0 * (np.abs(height) / mean - 1.0)):
        of_modes = _cosine_power(np.where(mask, 0.0, scaled))
        power.append(np.mean([of_modes[one] for one in lowest]))
    # of relative squares
    variances = np.maximum(missing * np.array(power), _LEAST_VARIANCE) / values.size
    freedom = np.maximum(2.0 / (variances[:, None] * _MODES / rng.chisquare(_MODES, DRAWS)), 1.0)
    return Spread(
        np.sqrt(freedom / rng.chisquare(freedom) + lost),
        float(np.median(lost)),
        float(2.0 / variances[0]),
    )


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


@dataclass(frozen=True)
class Texture:
    """How heights of a map follow each other."""

    distance: np.ndarray  #: shape (n,); [m]
    autocorrelation: np.ndarray  #: shape (n,); of heights at that distance, over all directions [1]
    frequency: np.ndarray  #: shape (k,); spatial [1/m]
    power: np.ndarray  #: shape (k,); power spectral density, mean over directions [m⁴]
    #: Where the autocorrelation falls to 1/e [m]; NaN where it does not within half of the map
    correlation_length: float
    rms_slope: float  #: Sdq [1]
    developed_area: float  #: Sdr, area over that of the plane, less one [1]
    deepest: float  #: Sv, depth of the lowest point [m]
    highest: float  #: Sp, height of the highest point [m]

    def summary(self) -> dict[str, Any]:
        """The numbers as a JSON object."""
        length = 1e6 * self.correlation_length
        return {
            "correlation_length_um": length if np.isfinite(length) else None,
            "rms_slope": self.rms_slope,
            "developed_area": self.developed_area,
            "maximum_pit_depth_nm": 1e9 * self.deepest,
            "maximum_peak_height_nm": 1e9 * self.highest,
        }


def texture_of(height: np.ndarray, mask: np.ndarray, steps: tuple[float, float]) -> Texture:
    """Texture of a levelled map; ``height`` [m] and ``mask`` (rows, columns), ``steps`` [m]."""
    known = height[~mask]
    flat = np.where(mask, 0.0, height - known.mean())
    # mean product of heights at a distance, over pairs without a masked one
    twice = [2 * count for count in flat.shape]

    def products(values: np.ndarray) -> np.ndarray:
        return np.asarray(fft.irfft2(np.abs(fft.rfft2(values, twice)) ** 2, twice))

    pairs = products((~mask).astype(float))
    away = [
        np.minimum(np.arange(two), two - np.arange(two)) * step
        for two, step in zip(twice, steps, strict=True)
    ]
    radius, widest = np.hypot(away[0][:, None], away[1]), max(steps)
    sides = [count * step for count, step in zip(flat.shape, steps, strict=True)]
    used = (radius <= 0.5 * min(sides)) & (pairs > _FEWEST_PAIRS * mask.size)
    distance, (product, count) = _rings(radius[used] / widest, products(flat)[used], pairs[used])
    auto = product / count
    auto = auto / auto[0] if auto[0] > 0.0 else np.ones_like(auto)
    distance *= widest
    below, length = np.flatnonzero(auto < np.exp(-1.0)), np.nan
    if below.size and below[0]:
        pair = slice(below[0] - 1, below[0] + 1)
        length = float(np.interp(-np.exp(-1.0), -auto[pair], distance[pair]))
    down, right = np.diff(height, axis=0) / steps[0], np.diff(height, axis=1) / steps[1]
    first = down[:, :-1] ** 2 + right[:-1] ** 2
    second = down[:, 1:] ** 2 + right[1:] ** 2
    free = ~(mask[:-1, :-1] | mask[1:, :-1] | mask[:-1, 1:] | mask[1:, 1:])
    slopes = np.concatenate([first[free], second[free]])
    window = np.outer(*(np.hanning(count + 2)[1:-1] for count in flat.shape))
    power = np.abs(fft.fft2(flat * window)) ** 2 * steps[0] * steps[1]
    power /= np.sum(window[~mask] ** 2)
    along = [fft.fftfreq(count, step) for count, step in zip(flat.shape, steps, strict=True)]
    radius = np.hypot(along[0][:, None], along[1])
    least = max(1.0 / side for side in sides)
    used = (radius >= least) & (radius <= 0.5 / widest)
    at, (whole, count) = _rings(radius[used] / least, power[used], np.ones(used.sum()))
    return Texture(
        distance, auto, at[1:] * least, whole[1:] / count[1:], length,
        float(np.sqrt(slopes.mean())), float(np.mean(np.sqrt(1.0 + slopes)) - 1.0),
        float(known.mean() - known.min()), float(known.max() - known.mean()),
    )  # fmt: skip


def _rings(radius: np.ndarray, *values: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Mean radius of rings of a width of one, and sums of values in each."""
    ring = np.rint(radius).astype(int).ravel()
    count = np.maximum(np.bincount(ring), 1)
    return np.bincount(ring, radius.ravel()) / count, [
        np.bincount(ring, one.ravel()) for one in values
    ]
