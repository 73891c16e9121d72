r"""Texture of a surface without what is masked: autocorrelation, power spectrum and slopes.

The power spectrum is that of [ISO25178]_ over spatial frequencies, averaged over directions:
:math:`S_q^2 = 2\pi\int f\,C(f)\,df`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import fft

_FEWEST_PAIRS = 0.2  # share of the map's pixels, from which a mean over pairs is taken
_MICROMETRE = 1e-6


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
        length = self.correlation_length / _MICROMETRE
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
    distance, auto = _autocorrelation(flat, mask, steps)
    below = np.flatnonzero(auto < np.exp(-1.0))
    length = np.nan
    if below.size and below[0]:
        pair = slice(below[0] - 1, below[0] + 1)
        length = float(np.interp(-np.exp(-1.0), -auto[pair], distance[pair]))
    down, right = np.diff(height, axis=0) / steps[0], np.diff(height, axis=1) / steps[1]
    first = down[:, :-1] ** 2 + right[:-1] ** 2
    second = down[:, 1:] ** 2 + right[1:] ** 2
    free = ~(mask[:-1, :-1] | mask[1:, :-1] | mask[:-1, 1:] | mask[1:, 1:])
    slopes = np.concatenate([first[free], second[free]])
    window = np.outer(*(np.hanning(count + 2)[1:-1] for count in flat.shape))
    area = steps[0] * steps[1]
    power = np.abs(fft.fft2(flat * window)) ** 2 * area / np.sum(window[~mask] ** 2)
    along = [fft.fftfreq(count, step) for count, step in zip(flat.shape, steps, strict=True)]
    radius = np.hypot(along[0][:, None], along[1])
    least = max(1.0 / (count * step) for count, step in zip(flat.shape, steps, strict=True))
    used = (radius >= least) & (radius <= 0.5 / max(steps))
    at, sums = _rings(radius[used] / least, [power[used], np.ones(used.sum())])
    return Texture(
        distance, auto, at[1:] * least, sums[0][1:] / sums[1][1:], length,
        float(np.sqrt(slopes.mean())), float(np.mean(np.sqrt(1.0 + slopes)) - 1.0),
        float(known.mean() - known.min()), float(known.max() - known.mean()),
    )  # fmt: skip


def _autocorrelation(
    flat: np.ndarray, mask: np.ndarray, steps: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Mean product of heights at a distance, over pairs without a masked one."""
    shape = [2 * count for count in flat.shape]

    def products(values: np.ndarray) -> np.ndarray:
        return np.asarray(fft.irfft2(np.abs(fft.rfft2(values, shape)) ** 2, shape))

    pairs = products((~mask).astype(float))
    away = [
        np.minimum(np.arange(two), two - np.arange(two)) * step
        for two, step in zip(shape, steps, strict=True)
    ]
    radius = np.hypot(away[0][:, None], away[1])
    step, most = (
        max(steps),
        0.5 * min(count * one for count, one in zip(flat.shape, steps, strict=True)),
    )
    used = (radius <= most) & (pairs > _FEWEST_PAIRS * mask.size)
    at, sums = _rings(radius[used] / step, [products(flat)[used], pairs[used]])
    auto = sums[0] / sums[1]
    return at * step, auto / auto[0] if auto[0] > 0.0 else np.ones_like(auto)


def _rings(radius: np.ndarray, values: list[np.ndarray]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Mean radius of rings of a width of one, and sums of values in each."""
    ring = np.rint(radius).astype(int).ravel()
    count = np.maximum(np.bincount(ring), 1)
    return np.bincount(ring, radius.ravel()) / count, [
        np.bincount(ring, one.ravel()) for one in values
    ]
