"""Levelling of height maps, and the particles and holes on a surface that may itself be skewed.

A skewed surface has high peaks of its own. Two things tell a particle from them: it stands out of
its surroundings by more than the surface does anywhere at that distance, and it does so by more
than the surface's own distribution of heights reaches.
"""

from collections.abc import Iterator
from typing import Literal, NamedTuple

import numpy as np
from scipy import fft, ndimage, stats

from lightflyer.core.errors import ConfigurationError

Flatten = Literal["none", "rows"]  # What is done to the rows of a map before it is levelled
THRESHOLD = 5.0
"""Least relief of a particle or hole, in robust standard deviations at its own scale."""

_RELIEF = 1.5  # least relief in standard deviations of the whole surface
_FLANK = 2.0  # relief of a flank, in standard deviations at its scale
_MARGIN = 2  # pixels by which the mask is widened
_PASSES = 3
MOST_MASKED = 0.9  # fraction of a map
_ROUNDING = 1e-9  # fraction of the raw heights' range below which nothing is a particle
_RINGS = {0: (3, 5, 8, 12), 2: (5, 8, 12, 18, 27, 40), 5: (12, 18, 27, 40)}
"""Radii of the rings that stand for the surroundings, by width of the smoothing [pixels]."""

_DIRECTIONS = 8
_PATCHES = 400.0  # independent patches from which a distribution of heights is known
_MAD_TO_DEVIATION = 1.482602218505602  # for normally distributed heights
_TAILS = np.array([0.10, 0.15, 0.25])  # of the distribution, free of a few per cent of particles
_WINSOR = 3.0
_NEAR_TAIL = 0.01
_EIGHT = np.ones((3, 3))


def level(height: np.ndarray, mask: np.ndarray | None = None, order: int = 2) -> np.ndarray:
    """Subtract the polynomial that fits a map best [m], shape (rows, columns)."""
    # Legendre polynomials are nearly orthogonal on the pixels: well-conditioned normal equations
    rows, columns = (np.linspace(-1.0, 1.0, count) for count in height.shape)
    along = [np.polynomial.Legendre.basis(degree) for degree in range(order + 1)]
    first, second = np.array([(i, j) for i in range(order + 1) for j in range(order + 1 - i)]).T
    ys = np.stack([one(rows) for one in along])
    xs = np.stack([one(columns) for one in along])
    kept = np.ones(height.shape) if mask is None else (~mask).astype(float)
    # separate products over rows and columns avoid a matrix with a row for every pixel
    products = np.einsum("ar,br,rc,dc,ec->abde", ys, ys, kept, xs, xs, optimize=True)
    normal = products[first[:, None], first, second[:, None], second]
    residual = height - height[kept > 0.0].mean()
    for _ in range(2):  # the second pass removes rounding errors of the first
        moments = ys @ (residual * kept) @ xs.T
        coefficients = np.zeros_like(moments)
        coefficients[first, second] = np.linalg.solve(normal, moments[first, second])
        residual = residual - ys.T @ coefficients @ xs
    return residual


def fill_missing(height: np.ndarray) -> np.ndarray:
    """Heights with each missing one replaced by the nearest that is there [m]."""
    missing = np.isnan(height)
    if not missing.any():
        return height
    nearest: np.ndarray = np.asarray(
        ndimage.distance_transform_edt(missing, return_distances=False, return_indices=True)
    )
    return np.asarray(height[nearest[0], nearest[1]])


def flatten_rows(height: np.ndarray, order: int = 0) -> np.ndarray:
    """Shift each row so that the median of its differences from the row before is zero [m]."""
    # A particle changes the median of the differences little, unlike the mean of a row. The tilt is
    # the median of the slopes between pixels half a row apart. Steps and drift between scan lines
    # vanish, and with them the part of the roughness that varies between rows only.
    steps = np.diff(height, axis=0)
    columns = height.shape[1]
    place = np.arange(columns) - 0.5 * (columns - 1)
    correction = np.zeros_like(steps)
    if order:
        half = columns // 2
        slopes = np.median(steps[:, half:] - steps[:, :-half], axis=1) / half
        correction = slopes[:, None] * place
    correction = correction + np.median(steps - correction, axis=1, keepdims=True)
    flat = height.copy()
    flat[1:] -= np.cumsum(correction, axis=0)
    return flat


def kept_power(
    shape: tuple[int, int], modes: int, order: int, rows: int | None = None
) -> np.ndarray:
    """Share of the power of each cosine mode of a surface that levelling keeps."""
    along = [_mode_shares(count, modes, max(order, rows or 0)) for count in shape]
    lost = sum(
        np.outer(along[0][i], along[1][j]) for i in range(order + 1) for j in range(order + 1 - i)
    )
    if rows is not None:
        lost = np.maximum(lost, along[1][: rows + 1].sum(axis=0)[None, :])
    return np.clip(1.0 - lost, 0.0, 1.0)


def _mode_shares(count: int, modes: int, order: int) -> np.ndarray:
    """Squared cosine coefficients of orthonormal polynomials; shape (order + 1, modes)."""
    place = np.linspace(-1.0, 1.0, count)
    polynomials = np.linalg.qr(np.polynomial.legendre.legvander(place, order))[0]
    return fft.dct(polynomials, axis=0, norm="ortho")[:modes].T ** 2


class Objects(NamedTuple):
    """A levelled map and what lies on it."""

    # shape (rows, columns); levelled height [m]; its mean outside the masks is zero
    height: np.ndarray
    # shape (rows, columns); true where the map stands out above or below, with a margin of two
    # pixels
    particles: np.ndarray
    holes: np.ndarray


def find_particles(height: np.ndarray, *, threshold: float = THRESHOLD, order: int = 2) -> Objects:
    """Level a map and mask the particles on it and the holes in it; ``height`` (rows, columns)."""
    # The relief of a pixel is its height less the median on a ring around it, for rings of 3 to 40
    # pixels and three widths of smoothing, and less the median of the map. It is taken after the
    # longer tail of the heights is compressed by the logarithm that makes quantiles at 10 to 25 %
    # and 75 to 90 % symmetric. The standard deviation at each scale is 1.4826 times the median
    # absolute deviation over the whole map, or that of the opposite tail where this is larger; it
    # does not shrink as pixels are masked, so that the mask cannot eat its way into the surface. A
    # map with fewer than 400 independent patches does not show the tail of its distribution: there
    # only rings up to half the correlation length count, within which a surface is smooth.
    # Particles that look like the peaks of a skewed surface are left.
    above = below = np.zeros(height.shape, bool)
    smallest = _ROUNDING * float(np.ptp(height))
    for _ in range(_PASSES):
        levelled = level(height, above | below, order)
        found = _stand_out(levelled, above, below, threshold, smallest)
        same = np.array_equal(found[0], above) and np.array_equal(found[1], below)
        above, below = found
        if same:
            break
        if (above | below).mean() > MOST_MASKED:
            raise ConfigurationError("nearly all of the map would be masked as particles")
    levelled = level(height, above | below, order)
    return Objects(levelled - levelled[~(above | below)].mean(), above, below & ~above)


def independent_patches(height: np.ndarray) -> tuple[float, float]:
    """Correlation length of a map and its number of independent patches."""
    centred = height - height.mean()
    if not centred.any():
        return 1.0, float(height.size)
    padded = tuple(2 * count for count in height.shape)
    power = np.abs(np.fft.rfft2(centred, s=padded)) ** 2
    correlation = np.fft.irfft2(power, s=padded)
    lengths = []
    for line in (correlation[: height.shape[0] // 2, 0], correlation[0, : height.shape[1] // 2]):
        below = np.flatnonzero(line < line[0] / np.e)
        lengths.append(float(below[0]) if below.size else float(len(line)))
    length = float(np.sqrt(lengths[0] * lengths[1]))
    # integral of the squared autocorrelation exp(-2 d²/length²)
    return length, height.size / (0.5 * np.pi * length**2)


def _stand_out(
    levelled: np.ndarray,
    particles: np.ndarray,
    holes: np.ndarray,
    threshold: float,
    smallest: float,
) -> tuple[np.ndarray, np.ndarray]:
    even = _symmetric(levelled)
    if even is None:  # half of the map is exactly flat
        rest = levelled - np.median(levelled)
        return _widen(rest > smallest), _widen(rest < -smallest)
    far = np.abs(levelled - np.median(levelled)) > smallest
    rows, columns = levelled.shape
    above, below = np.zeros((rows, columns), bool), np.zeros((rows, columns), bool)
    # between particles the surface is no hole, and beside a hole it is no particle
    searches = [([(above, 1.0)], holes), ([(below, -1.0)], particles)]
    if not (holes.any() or particles.any()):
        searches = [([(above, 1.0), (below, -1.0)], holes)]
    for signs, others in searches:
        for step, relief in _reliefs(fill_missing(np.where(others, np.nan, even))):
            for mask, sign in signs:
                found = _objects(sign * relief, far[::step, ::step], threshold)
                if found.any():
                    whole = np.repeat(np.repeat(found, step, axis=0), step, axis=1)
                    mask |= whole[:rows, :columns]
    return _widen(above), _widen(below)


def _objects(relief: np.ndarray, far: np.ndarray, threshold: float) -> np.ndarray:
    """Connected regions that rise over their surroundings more than the surface does."""
    opposite = -float(np.quantile(relief, _NEAR_TAIL)) / float(stats.norm.isf(_NEAR_TAIL))
    unit = max(_deviation(relief), opposite)
    peaks = (relief > max(threshold * unit, _RELIEF)) & far
    if not peaks.any():
        return peaks
    flanks = relief > max(_FLANK * unit, 0.5 * _RELIEF)
    return ndimage.binary_propagation(peaks, mask=flanks, structure=_EIGHT)


def _widen(mask: np.ndarray) -> np.ndarray:
    if not mask.any():
        return mask
    return ndimage.binary_dilation(ndimage.binary_fill_holes(mask), iterations=_MARGIN)


def _symmetric(height: np.ndarray) -> np.ndarray | None:
    """Heights in standard deviations, their longer tail compressed; None if half are equal."""
    middle = float(np.median(height))
    low = middle - np.quantile(height, _TAILS)
    high = np.quantile(height, 1.0 - _TAILS) - middle
    if min(low.min(), high.min()) <= 0.0:
        deviation = _deviation(height)
        return (height - middle) / deviation if deviation > 0.0 else None
    normal = stats.norm.isf(_TAILS)
    skew = float(np.median(np.log(high / low) / normal))
    sign = 1.0 if skew >= 0.0 else -1.0
    shorter, longer = (low, high) if skew >= 0.0 else (high, low)
    distance = sign * (height - middle)
    even = distance / np.median(shorter / normal)
    outer = distance > 0.0
    skew = max(abs(skew), _ROUNDING)
    scale = np.median(longer * skew / np.expm1(skew * normal))
    even[outer] = np.log1p(skew * distance[outer] / scale) / skew
    return sign * even


def _reliefs(even: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
    """Height over the surroundings for each smoothing and ring, at every so many pixels."""
    for width, radii in _RINGS.items():
        step = max(1, width - 1)  # a smooth field needs fewer pixels
        whole = np.asarray(ndimage.gaussian_filter(even, width) if width else even)
        smooth = whole[::step, ::step]
        length, patches = independent_patches(np.clip(smooth, -_WINSOR, _WINSOR))
        known = patches >= _PATCHES
        largest = min(smooth.shape) // 4 if known else max(_RINGS[0][0] / step, length / 2)
        for radius in radii:
            if 1 <= radius // step <= largest:
                radius = radius // step
                rows, columns = smooth.shape
                padded = np.pad(smooth, radius, mode="reflect", reflect_type="odd").astype(
                    np.float32
                )
                angles = 2.0 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
                ring = {
                    (radius + round(radius * np.sin(one)), radius + round(radius * np.cos(one)))
                    for one in angles
                }
                heights = [padded[i : i + rows, j : j + columns] for i, j in sorted(ring)]
                middle = len(heights) // 2
                ranked = np.partition(np.stack(heights, axis=-1), (middle - 1, middle), axis=-1)
                yield step, smooth - (0.5 * (ranked[..., middle - 1] + ranked[..., middle]))
        if known:
            yield step, smooth - np.median(smooth)


def _deviation(values: np.ndarray) -> float:
    return _MAD_TO_DEVIATION * float(np.median(np.abs(values - np.median(values))))


def count_objects(mask: np.ndarray) -> int:
    """Number of connected regions; ``mask`` (rows, columns)."""
    return int(ndimage.label(mask, _EIGHT)[1])
