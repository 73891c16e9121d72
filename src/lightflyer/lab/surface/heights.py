r"""Heights of a map: levelling, particles and holes, and statistics of what is left.

A skewed surface has high peaks of its own. Two things tell a particle from them: it stands out of
its surroundings by more than the surface does anywhere at that distance, and it does so by more
than the surface's own distribution of heights reaches.

A map is one sample of a surface. The variance of a mean over it, such as :math:`S_q^2`, is the
power of its squared heights at low frequencies over the number of pixels. Eight low cosine modes
measure it, with eight degrees of freedom [Lazarus2018]_. This holds for any distribution of heights
and any correlation shorter than the map. Levelling takes away the roughness at the longest
wavelengths; how much is extrapolated from the spectrum of what is left.

The power spectrum is that of [ISO25178]_ over spatial frequencies, averaged over directions:
:math:`S_q^2 = 2\pi\int f\,C(f)\,df`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, NamedTuple

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
_TAILS = np.array([0.10, 0.15, 0.25])  # of the distribution, free of a few per cent of particles
_WINSOR = 3.0
_NEAR_TAIL = 0.01
_EIGHT = np.ones((3, 3))

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


def level(height: np.ndarray, mask: np.ndarray | None = None, order: int = 2) -> np.ndarray:
    """Subtract the polynomial that fits a map best [m], shape (rows, columns)."""
    # Legendre polynomials are nearly orthogonal on the pixels: well-conditioned normal equations
    rows, columns = (np.linspace(-1.0, 1.0, count) for count in height.shape)
    first, second = np.array([(i, j) for i in range(order + 1) for j in range(order + 1 - i)]).T
    ys, xs = (np.polynomial.legendre.legvander(one, order).T for one in (rows, columns))
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
    along = []
    for count in shape:
        # squared cosine coefficients of orthonormal polynomials, shape (order + 1, modes)
        place, most = np.linspace(-1.0, 1.0, count), max(order, rows or 0)
        polynomials = np.linalg.qr(np.polynomial.legendre.legvander(place, most))[0]
        along.append(fft.dct(polynomials, axis=0, norm="ortho")[:modes].T ** 2)
    lost = sum(
        np.outer(along[0][i], along[1][j]) for i in range(order + 1) for j in range(order + 1 - i)
    )
    if rows is not None:
        lost = np.maximum(lost, along[1][: rows + 1].sum(axis=0)[None, :])
    return np.clip(1.0 - lost, 0.0, 1.0)


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
                # regions that rise over their surroundings more than the surface does
                rise = sign * relief
                opposite = -float(np.quantile(rise, _NEAR_TAIL)) / float(stats.norm.isf(_NEAR_TAIL))
                unit = max(_deviation(rise), opposite)
                peaks = (rise > max(threshold * unit, _RELIEF)) & far[::step, ::step]
                if peaks.any():
                    flanks = rise > max(_FLANK * unit, 0.5 * _RELIEF)
                    found = ndimage.binary_propagation(peaks, mask=flanks, structure=_EIGHT)
                    whole = np.repeat(np.repeat(found, step, axis=0), step, axis=1)
                    mask |= whole[:rows, :columns]
    return _widen(above), _widen(below)


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


_deviation = partial(stats.median_abs_deviation, axis=None, scale="normal")


def count_objects(mask: np.ndarray) -> int:
    """Number of connected regions; ``mask`` (rows, columns)."""
    return int(ndimage.label(mask, _EIGHT)[1])


def spread(
    height: np.ndarray, mask: np.ndarray, kept: np.ndarray, rng: np.random.Generator,
    pixel_aspect: float = 1.0,
) -> tuple[np.ndarray, float, float]:  # fmt: skip
    """How far a surface's rms and mean absolute height may be from those of its map.

    Returns draws of Sq and Sa of the surface over those of the map, shape (2, draws), the power
    that levelling took over the power left, and the independent heights in the mean of squares.
    """
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
    ratios = np.sqrt(freedom / rng.chisquare(freedom) + lost)
    return ratios, float(np.median(lost)), float(2.0 / variances[0])


def _cosine_power(values: np.ndarray) -> np.ndarray:
    """Squares of the lowest orthonormal cosine coefficients; shape (modes, modes)."""
    modes = min(*values.shape, SPECTRUM)
    return np.asarray(fft.dctn(values, norm="ortho")[:modes, :modes] ** 2)


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
