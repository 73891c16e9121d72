r"""Roughness of a surface from a map of its height, without the particles on it.

A polynomial fitted to the surface between the particles levels the map; a particle is a region that
rises above the surface by more than a robust threshold. With the height :math:`z` above the mean,

.. math:: S_q^2 = \overline{z^2}, \quad S_a = \overline{|z|}, \quad
    S_{sk} = \overline{z^3}/S_q^3, \quad S_{ku} = \overline{z^4}/S_q^4.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import ndimage

from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterWarning
from lightflyer.lab.estimate import Estimate, central_interval
from lightflyer.lab.height_map import HeightMap
from lightflyer.lab.record import dataset

if TYPE_CHECKING:
    import xarray as xr

NANOMETRE = 1e-9
"""[m]."""

THRESHOLD = 4.5
"""Least height of a particle, in robust standard deviations of the surface."""

LARGEST_MASKED = 0.05
"""Masked fraction of a map above which a warning is issued."""

PARAMETERS = ("rms_height", "mean_absolute_height", "skewness", "kurtosis")
"""Sq, Sa, Ssk and Sku."""

_UNITS = ("nm", "nm", "", "")
_FLANK = 2.0  # least height of a particle's flank, in the same deviations
_MARGIN = 2  # pixels by which the mask is widened
_MAD_TO_DEVIATION = 1.482602218505602  # for normally distributed heights
_PASSES = 25
_MOST_MASKED = 0.9  # fraction of a map
_ROUNDING = 1e-9  # fraction of the raw heights' range below which nothing is a particle
_TILES = 8  # along each side, resampled for the intervals
_DRAWS = 1000


@dataclass(frozen=True)
class Roughness:
    """A levelled map, its mask and its parameters.

    Attributes
    ----------
    source : HeightMap
    height : array, shape (rows, columns)
        Levelled height [m]; its mean outside the mask is zero.
    mask : bool array, shape (rows, columns)
        True on particles.
    parameters : dict of str to Estimate
        Parameters of the surface without the particles, by names of :data:`PARAMETERS`; heights
        in nm.
    parameters_all : dict of str to Estimate
        The same for the whole map.
    masked_fraction : Estimate
    particles : int
        Number of connected regions of the mask.
    """

    source: HeightMap
    height: np.ndarray
    mask: np.ndarray
    parameters: dict[str, Estimate]
    parameters_all: dict[str, Estimate]
    masked_fraction: Estimate
    particles: int

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        return {
            **{name: one.to_json() for name, one in self.parameters.items()},
            **{f"{name}_all": one.to_json() for name, one in self.parameters_all.items()},
            "masked_fraction": self.masked_fraction.to_json(),
            "particles": self.particles,
            "pixels": list(self.height.shape),
            "size_um": [self.source.width * 1e6, self.source.length * 1e6],
            "channel": self.source.channel,
        }


def level(height: np.ndarray, mask: np.ndarray | None = None, order: int = 2) -> np.ndarray:
    """Subtract the polynomial that fits a map best.

    Parameters
    ----------
    height : array, shape (rows, columns)
        [m].
    mask : bool array, shape (rows, columns), optional
        Pixels to exclude from the fit.
    order : int
        Total order of the polynomial: 1 is a plane, 2 adds curvature.

    Returns
    -------
    array, shape (rows, columns)
        [m].
    """
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


def find_particles(
    height: np.ndarray, *, threshold: float = THRESHOLD, order: int = 2
) -> tuple[np.ndarray, np.ndarray]:
    """Level a map and mask the particles on it.

    Parameters
    ----------
    height : array, shape (rows, columns)
        [m].
    threshold : float
        Least height of a particle above the median, in robust standard deviations.
    order : int
        Order of the levelling polynomial.

    Returns
    -------
    levelled : array, shape (rows, columns)
        [m].
    mask : bool array, shape (rows, columns)

    Raises
    ------
    ConfigurationError
        If more than 90 % of the map is masked.

    Notes
    -----
    The standard deviation is 1.4826 times the median absolute deviation outside the mask, which
    particles on a few per cent of the map hardly change. A particle is a connected region that is
    everywhere higher than two deviations and somewhere higher than the threshold, widened by two
    pixels for its foot. Levelling and masking alternate until the mask no longer changes.
    """
    mask = np.zeros(height.shape, bool)
    smallest = _ROUNDING * float(np.ptp(height))
    for _ in range(_PASSES):
        levelled = level(height, mask, order)
        rest = levelled[~mask]
        middle = float(np.median(rest))
        deviation = _MAD_TO_DEVIATION * float(np.median(np.abs(rest - middle)))
        peaks = levelled - middle > max(threshold * deviation, smallest)
        flanks = levelled - middle > max(_FLANK * deviation, smallest)
        found = ndimage.binary_propagation(peaks, mask=flanks, structure=np.ones((3, 3)))
        found = ndimage.binary_dilation(found, iterations=_MARGIN) if found.any() else found
        if np.array_equal(found, mask):
            break
        mask = found
        if mask.mean() > _MOST_MASKED:
            raise ConfigurationError("nearly all of the map would be masked as particles")
    levelled = level(height, mask, order)
    return levelled - levelled[~mask].mean(), mask


def surface_parameters(height: np.ndarray) -> np.ndarray:
    """Root-mean-square height Sq, mean absolute height Sa, skewness Ssk and kurtosis Sku.

    Parameters
    ----------
    height : array
        [m].

    Returns
    -------
    array, shape (4,)
        [m], [m], [1], [1]; the last two are NaN where all heights are equal.

    References
    ----------
    [ISO25178]_ sections 4.2.1 to 4.2.7.
    """
    deviation = height - height.mean()
    square = deviation**2
    rms = np.sqrt(square.mean())
    with np.errstate(divide="ignore", invalid="ignore"):
        skewness = (square * deviation).mean() / rms**3
        kurtosis = (square**2).mean() / rms**4
    return np.array([rms, np.abs(deviation).mean(), skewness, kurtosis])


def roughness(
    source: HeightMap, *, threshold: float = THRESHOLD, order: int = 2, seed: int = 0
) -> Roughness:
    """Roughness of a map, without its particles and with them.

    Parameters
    ----------
    source : HeightMap
    threshold : float
        Least height of a particle, in robust standard deviations of the surface.
    order : int
        Order of the levelling polynomial, 0 to 5.
    seed : int
        Seed of the resampling for the intervals.

    Returns
    -------
    Roughness

    Raises
    ------
    ConfigurationError
        If more than 90 % of the map is masked.

    Warns
    -----
    ParameterWarning
        If more than 5 % of the map is masked.

    Notes
    -----
    Intervals come from resampling 8 x 8 tiles of the map. They show how much another place on the
    same surface would differ, if the map is many correlation lengths wide.
    """
    require_range("threshold", threshold, 1.0)
    require_range("order", order, 0, 5)
    try:
        height, mask = find_particles(source.height, threshold=threshold, order=order)
    except ConfigurationError as error:
        raise ConfigurationError(f"{source.source}: {error}") from None
    share = float(mask.mean())
    if share > LARGEST_MASKED:
        warnings.warn(
            f"{source.source}: {share:.1%} of the map is masked as particles; raise the threshold "
            "or measure a cleaner place",
            ParameterWarning,
            stacklevel=2,
        )
    rng = np.random.default_rng(seed)
    picks = rng.integers(0, _TILES**2, (_DRAWS, _TILES**2))
    everything = level(source.height, None, order)
    fraction = _tile_sums(mask.astype(float), np.ones_like(mask))
    shares = fraction[picks, 1].sum(axis=1) / fraction[picks, 0].sum(axis=1)
    return Roughness(
        source=source,
        height=height,
        mask=mask,
        parameters=_estimates(height, ~mask, picks),
        parameters_all=_estimates(everything, np.ones_like(mask), picks),
        masked_fraction=_with_interval(share, shares, ""),
        particles=int(ndimage.label(mask, np.ones((3, 3)))[1]),
    )


def _tile_sums(values: np.ndarray, kept: np.ndarray) -> np.ndarray:
    """Count, sums of the powers 1 to 4 and of magnitudes in each tile; shape (tiles, 6)."""
    fields = (kept.astype(float), *(np.where(kept, values**power, 0.0) for power in (1, 2, 3, 4)),
              np.where(kept, np.abs(values), 0.0))  # fmt: skip
    starts = [np.linspace(0, count, _TILES, endpoint=False).astype(int) for count in values.shape]
    return np.stack(
        [
            np.add.reduceat(np.add.reduceat(field, starts[0], axis=0), starts[1], axis=1).ravel()
            for field in fields
        ],
        axis=1,
    )


def _estimates(height: np.ndarray, kept: np.ndarray, picks: np.ndarray) -> dict[str, Estimate]:
    """Parameters with intervals from resampled tiles."""
    values = surface_parameters(height[kept])
    rms = float(values[0])
    scale = rms if rms > 0.0 else 1.0
    sums = _tile_sums((height - height[kept].mean()) / scale, kept)[picks].sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        count = sums[:, 0]
        mean, square, cube, fourth = (sums[:, power] / count for power in (1, 2, 3, 4))
        variance = square - mean**2
        deviation = np.sqrt(np.maximum(variance, 0.0))
        third = cube - 3.0 * mean * square + 2.0 * mean**3
        last = fourth - 4.0 * mean * cube + 6.0 * mean**2 * square - 3.0 * mean**4
        draws = (deviation * scale / NANOMETRE, sums[:, 5] / count * scale / NANOMETRE,
                 third / deviation**3, last / deviation**4)  # fmt: skip
    found = (values[0] / NANOMETRE, values[1] / NANOMETRE, values[2], values[3])
    return {
        name: _with_interval(float(np.nan_to_num(value)), np.nan_to_num(drawn), unit)
        for name, value, drawn, unit in zip(PARAMETERS, found, draws, _UNITS, strict=True)
    }


def _with_interval(value: float, draws: np.ndarray, unit: str) -> Estimate:
    low, high = central_interval(draws)
    interval = (min(float(low), value), max(float(high), value))
    return Estimate(value, interval, unit, float(draws.std(ddof=1)))


def summary(results: Sequence[Roughness]) -> dict[str, Any]:
    """One map, or the mean of several with each of them, as a JSON object.

    Parameters
    ----------
    results : sequence of Roughness

    Returns
    -------
    dict
    """
    if len(results) == 1:
        return results[0].summary()

    def mean(picked: Sequence[Estimate]) -> dict[str, Any]:
        values = np.array([one.value for one in picked])
        error = float(values.std(ddof=1) / np.sqrt(len(values)))
        unit = picked[0].unit
        return Estimate.normal(float(values.mean()), error, unit, len(values) - 1).to_json()

    return {
        **{name: mean([one.parameters[name] for one in results]) for name in PARAMETERS},
        **{
            f"{name}_all": mean([one.parameters_all[name] for one in results])
            for name in PARAMETERS
        },
        "masked_fraction": mean([one.masked_fraction for one in results]),
        "maps": {one.source.source: one.summary() for one in results},
    }


def to_dataset(results: Sequence[Roughness]) -> "xr.Dataset":
    """The levelled maps with their masks.

    Parameters
    ----------
    results : sequence of Roughness

    Returns
    -------
    xarray.Dataset
    """
    variables: dict[str, Any] = {}
    for number, one in enumerate(results):
        dimensions = (f"y_{number}", f"x_{number}")
        sides = (one.source.length, one.source.width)
        for dimension, side, count in zip(dimensions, sides, one.height.shape, strict=True):
            middle = (np.arange(count) + 0.5) * side / count
            variables[dimension] = (dimension, middle, {"units": "m", "long_name": dimension[0]})
        variables[f"height_{number}"] = (
            dimensions, one.height,
            {"units": "m", "long_name": "levelled height", "file": one.source.source},
        )  # fmt: skip
        variables[f"mask_{number}"] = (
            dimensions, one.mask.astype("i1"),
            {"units": "1", "long_name": "particle", "file": one.source.source},
        )  # fmt: skip
    return dataset("roughness", variables, [one.source.source for one in results])
