"""Intervals of ``lab roughness``.

Surfaces are white noise filtered by a Gaussian in a wider area, so that none is cut to a mean or a
plane, with heights that are normal or skewed by a known transformation. Their rms and mean absolute
height come from the filter and the distribution, not from the map. The microscope's heights are
wrong by its stated accuracy. Some maps carry particles or lost pixels.
"""

from typing import NamedTuple

import numpy as np
from scipy import fft, stats
from trial import Trial

from lightflyer.lab.readers.height_map import HeightMap
from lightflyer.lab.surface.reduction import HEIGHT_ACCURACY, roughness

COMMAND = "lab roughness"

_PIXELS = 256
_RMS = 34.8  # [nm]
_PITCH = 10e-6 / _PIXELS  # [m]


class Case(NamedTuple):
    """One kind of map: width of the filter [pixels], skewness, particles, lost pixels."""

    width: float
    skewness: float = 0.0
    particles: int = 0
    lost_pixels: int = 0

    def __str__(self) -> str:
        said = f"{self.width:g} pixels"
        said += f" skewness {self.skewness:g}" if self.skewness else ""
        said += f" {self.particles} particles" if self.particles else ""
        return said + (f" {self.lost_pixels} lost pixels" if self.lost_pixels else "")


CASES = (
    Case(3), Case(10), Case(25), Case(3, 1.0), Case(3, 2.2), Case(10, 1.0),
    Case(3, 0.0, 9), Case(3, 0.0, 0, 4),
)  # fmt: skip


def trials(seed: int) -> list[Trial]:
    """Sq and Sa of each kind of map."""
    rng = np.random.default_rng([seed, 17])
    found = []
    for case in CASES:
        unit, mean_absolute = _surface(rng, case)
        height = _with_objects(rng, case, _RMS * 1e-9 * unit)
        height = height * (1.0 + HEIGHT_ACCURACY * rng.standard_normal()) + 3e-6
        side = _PITCH * _PIXELS
        result = roughness(HeightMap("case", height, side, side), seed=seed)
        truths = {"rms_height": ("Sq", _RMS), "mean_absolute_height": ("Sa", _RMS * mean_absolute)}
        for key, (name, truth) in truths.items():
            found.append(Trial(f"{name}, {case}", truth, *result.parameters[key].interval))
    return found


def _surface(rng: np.random.Generator, case: Case) -> tuple[np.ndarray, float]:
    """Heights of unit variance, and the mean of their magnitudes."""
    wide = fft.next_fast_len(_PIXELS + int(10 * case.width))
    frequency = np.hypot(*np.meshgrid(fft.fftfreq(wide), fft.rfftfreq(wide), indexing="ij"))
    gain = np.exp(-2.0 * (np.pi * frequency * case.width) ** 2)
    weight = np.where((np.arange(gain.shape[1]) % (wide / 2)) == 0, 1.0, 2.0)
    gain /= np.sqrt((weight * gain**2).sum()) / wide
    normal = fft.irfft2(fft.rfft2(rng.standard_normal((wide, wide))) * gain, s=(wide, wide))
    normal = normal[:_PIXELS, :_PIXELS]
    if not case.skewness:
        return normal, float(np.sqrt(2.0 / np.pi))
    shape = 4.0 / case.skewness**2
    gamma = stats.gamma(shape)
    # mean |x - shape| of a gamma variate, from its distribution function
    mean_absolute = 2.0 * shape * (gamma.cdf(shape) - stats.gamma(shape + 1.0).cdf(shape))
    table = np.linspace(-6.5, 6.5, 4001)
    heights = np.interp(normal, table, gamma.isf(stats.norm.sf(table)))
    return (heights - shape) / np.sqrt(shape), float(mean_absolute / np.sqrt(shape))


def _with_objects(rng: np.random.Generator, case: Case, height: np.ndarray) -> np.ndarray:
    """With particles, half-sunk spheres, and lost pixels at the bottom of the range."""
    y, x = np.mgrid[:_PIXELS, :_PIXELS] * _PITCH
    for _ in range(case.particles):
        radius = rng.uniform(160e-9, 320e-9)
        place = rng.uniform(0.0, _PIXELS * _PITCH, 2)
        square = (y - place[0]) ** 2 + (x - place[1]) ** 2
        height = height + np.sqrt(np.maximum(radius**2 - square, 0.0))
    for _ in range(case.lost_pixels):
        height[tuple(rng.integers(0, _PIXELS, 2))] = -3e-6
    return height
