r"""Roughness of a surface from a map of its height, without the particles on it.

A polynomial fitted to the surface between the particles levels the map. With the height :math:`z`
above the mean,

.. math:: S_q^2 = \overline{z^2}, \quad S_a = \overline{|z|}, \quad
    S_{sk} = \overline{z^3}/S_q^3, \quad S_{ku} = \overline{z^4}/S_q^4.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args

import numpy as np

from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Fraction
from lightflyer.files.result_text import Parts
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate, student_factor
from lightflyer.lab.readers.height_map import NANOMETRE, HeightMap
from lightflyer.lab.result import (
    LabResult,
    Reported,
    Series,
    Shown,
    dataset,
    estimate_table,
    joint_warnings,
    plain,
    variables,
)
from lightflyer.lab.surface import heights
from lightflyer.lab.surface.heights import DRAWS, SPECTRUM, Texture, spread, texture_of

if TYPE_CHECKING:
    import xarray as xr

HEIGHT_ACCURACY = 0.02  # Relative standard uncertainty of the microscope's heights; our assumption
PARAMETERS = ("rms_height", "mean_absolute_height", "skewness", "kurtosis")  # Sq, Sa, Ssk and Sku
Mask = Literal["auto", "none"] | np.ndarray  # Whether particles and holes are masked, or what is

_PERCENT = 100.0
_UNITS = ("nm", "nm", "", "")
_NO_BOUND = (-math.inf, math.inf)
_MICROMETRE = 1e-6
_MOST_MASKED = 0.05  # of a map, without a warning
_MOST_LOST = 0.1  # power lost in levelling, over that left
_SKEWED = 1.0
_MOST_CLIPPED = 0.01  # of the pixels at the very highest or lowest value
_SHIFTED = 3.0  # scatter of the steps between rows, over that between columns
_OBLONG = 1.5  # longer side of a pixel over the shorter one
_STEEPEST = 10.0  # slope from pixel to pixel
_ATOMS = 5e-10  # between the lowest and the highest [m]
NAMES = {"rms_height": "rms height Sq", "mean_absolute_height": "mean absolute height Sa"}


@dataclass(frozen=True, repr=False)
class Roughness(LabResult):
    """A levelled map, its mask and its parameters."""

    source: HeightMap
    #: shape (rows, columns); levelled height [m]; its mean outside the mask is zero
    height: np.ndarray
    particles: np.ndarray  #: shape (rows, columns); true where the map stands out above
    #: shape (rows, columns); true where it lies below, as where the tip lost the surface, and where
    #: it has no height
    holes: np.ndarray
    #: Parameters of the surface without particles and holes, by names of :data:`PARAMETERS`;
    #: heights in nm. Skewness and kurtosis are those of the map: their intervals are open, since a
    #: few peaks of the surface decide them
    parameters: dict[str, Estimate]
    parameters_all: dict[str, Estimate]  #: The same for the whole map
    #: Relative standard uncertainty of the heights, contained in the intervals
    height_accuracy: Reported[float]
    #: Effective number of independent heights in Sq²
    patches: Annotated[float, Shown(key="independent_patches")]
    #: Estimate of the power of the surface that levelling took, over the power left. The intervals
    #: contain it
    lost: Annotated[float, Shown(key="lost_in_levelling")]
    texture: Texture  #: Autocorrelation, power spectrum and slopes outside the mask
    warnings: tuple[str, ...] = ()

    _figures = "surface.figures:roughness_figures"
    _drawing = "surface.figures:plot_roughness"

    @property
    def mask(self) -> np.ndarray:
        """True on particles and in holes, shape (rows, columns)."""
        return self.particles | self.holes

    @property
    def masked_fraction(self) -> Reported[float]:
        """Share of the map on particles and in holes."""
        return float(self.mask.mean())

    def parts(self) -> Parts:
        """Size of a map, what is masked, and its parameters."""
        rows, columns = self.height.shape
        source = self.source
        channel = f", {source.channel}" if source.channel else ""
        sides = " x ".join(f"{side / _MICROMETRE:.4g}" for side in (source.width, source.length))
        masked = ", ".join(
            f"{heights.count_objects(mask)} {name} ({_PERCENT * mask.mean():.2f} %)"
            for name, mask in (("particles", self.particles), ("holes", self.holes))
        )
        yield (
            f"read {source.source}{channel}: {columns} x {rows} pixels, {sides} µm; {masked} masked"
        )
        named = [(name, self.parameters[key]) for key, name in NAMES.items()]
        yield estimate_table([*named, ("Sq without a mask", self.parameters_all["rms_height"])])
        skewness, kurtosis = (self.parameters[key].value for key in ("skewness", "kurtosis"))
        found = self.texture
        yield f"of this map: skewness Ssk {skewness:.3g}, kurtosis Sku {kurtosis:.3g}"
        yield (
            f"  correlation length (1/e) {found.correlation_length / _MICROMETRE:.3g} µm, "
            f"rms slope Sdq {found.rms_slope:.3g}\n"
            f"  developed area Sdr {_PERCENT * found.developed_area:.2g} %, "
            f"highest point Sp {found.highest / NANOMETRE:.3g} nm, "
            f"lowest Sv {found.deepest / NANOMETRE:.3g} nm"
        )

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        of_all = {f"{name}_all": one for name, one in self.parameters_all.items()}
        counts = {
            "particles": heights.count_objects(self.particles),
            "particle_fraction": float(self.particles.mean()),
            "holes": heights.count_objects(self.holes),
            "hole_fraction": float(self.holes.mean()),
            "missing_fraction": float(self.source.missing.mean()),
            **self.texture.summary(),
            "pixels": list(self.height.shape),
            "size_um": [self.source.width * 1e6, self.source.length * 1e6],
            "channel": self.source.channel,
        }
        return plain({**self.parameters, **of_all, **counts}) | super().summary()


def surface_parameters(height: np.ndarray) -> np.ndarray:
    """Root-mean-square height Sq, mean absolute height Sa, skewness Ssk and kurtosis Sku [m]."""
    # Source: [ISO25178]_ sections 4.2.1 to 4.2.7.
    deviation = height - height.mean()
    square = deviation**2
    rms = np.sqrt(square.mean())
    with np.errstate(divide="ignore", invalid="ignore"):
        skewness = (square * deviation).mean() / rms**3
        kurtosis = (square**2).mean() / rms**4
    return np.array([rms, np.abs(deviation).mean(), skewness, kurtosis])


@reads_units
def roughness(
    source: HeightMap,
    *,
    mask: Mask = "auto",
    threshold: float = heights.THRESHOLD,
    order: int = 2,
    flatten: heights.Flatten = "none",
    flatten_order: int = 0,
    height_accuracy: Fraction | None = None,
    seed: int = 0,
) -> Roughness:
    """Roughness of a map, without its particles and holes and with them.

    Parameters
    ----------
    source : HeightMap
    mask : {"auto", "none"} or array of bool, shape (rows, columns)
        Whether particles and holes are masked, or what is.
    threshold : float
        Least relief of a particle or hole, in robust standard deviations.
    order : int
        Order of the levelling polynomial, 0 to 5.
    flatten : {"none", "rows"}
        Whether scan lines are shifted to fit their neighbours before.
    flatten_order : int
        0 shifts lines, 1 also tilts them.
    height_accuracy : float, optional
        Relative standard uncertainty of the microscope's heights, part of the intervals; by default
        :data:`HEIGHT_ACCURACY`, with a warning.
    seed : int
        Seed of the draws for the intervals.

    Returns
    -------
    Roughness

    Raises
    ------
    ConfigurationError
        If all heights are equal, more than 90 % of the map is masked, or a mask has another shape.

    Notes
    -----
    Sq is that of the levelled map, as other programs give it. Its interval is for the surface: it
    contains what another place would differ by, the power that levelling takes, and the accuracy
    of the heights.
    """
    for name, value in (("order", order), ("flatten_order", flatten_order)):
        if not isinstance(value, int | np.integer):
            raise ParameterError(f"{name} = {value!r} is not a whole number")
    if flatten not in get_args(heights.Flatten):
        raise ParameterError(f'flatten = "{flatten}" is unknown; choose none or rows')
    require_range("threshold", threshold, 1.0)
    require_range("order", order, 0, 5)
    require_range("flatten_order", flatten_order, 0, 1)
    require_range("height_accuracy", height_accuracy, 0.0, 0.5)
    rows = None if flatten == "none" else flatten_order
    missing = source.missing
    raw = heights.fill_missing(source.height)
    if np.ptp(raw) == 0.0:
        raise ConfigurationError(
            f"{source.source}: all heights are equal: this is no map of a surface"
        )
    if rows is not None:
        raw = heights.flatten_rows(raw, rows)
    whole = heights.level(raw, missing, order)
    nothing = np.zeros(raw.shape, bool)
    if not isinstance(mask, str):
        mask = np.asarray(mask)
        if mask.dtype != bool:
            raise ParameterError(f"a mask is an array of bool, not of {mask.dtype}")
        if mask.shape != source.height.shape:
            sizes = (" x ".join(map(str, one.shape[::-1])) for one in (mask, source.height))
            raise ConfigurationError(
                f"{source.source}: the mask has {' and the map '.join(sizes)} pixels"
            )
        if mask.mean() > heights.MOST_MASKED:
            raise ConfigurationError(
                f"{source.source}: the mask given leaves out more than {heights.MOST_MASKED:.0%} "
                "of the map; what is 1, or not black, is left out"
            )
        found = heights.Objects(heights.level(raw, mask | missing, order), mask, nothing)
    elif mask == "none":
        found = heights.Objects(whole, nothing, nothing)
    elif mask != "auto":
        raise ParameterError(f'mask = "{mask}" is unknown; choose auto, none, or give an array')
    else:
        try:
            found = heights.find_particles(raw, threshold=threshold, order=order)
        except ConfigurationError as error:
            raise ConfigurationError(f"{source.source}: {error}") from None
    if missing.any():
        holes = (found.holes | missing) & ~found.particles
        found = heights.Objects(
            heights.level(raw, found.particles | holes, order), found.particles, holes
        )
    masked = found.particles | found.holes
    accuracy = HEIGHT_ACCURACY if height_accuracy is None else height_accuracy
    kept = heights.kept_power(raw.shape, min(*raw.shape, SPECTRUM), order, rows)
    common = (kept, accuracy, seed, source.pixel_aspect)
    inside, lost, patches = _estimates(found.height, masked, *common)
    everything = _estimates(whole, missing, *common)[0]
    lines = raw if rows is None else None
    said = _warnings(source, masked, inside["skewness"].value, lost, patches, lines)
    if not isinstance(mask, str) and not mask.any():
        said.append("the mask given is empty: Sq is that of the whole map")
    if height_accuracy is None:
        said += assumed_accuracies({"heights": f"± {_PERCENT * HEIGHT_ACCURACY:g} %"})
    rows_columns = zip((source.length, source.width), raw.shape, strict=True)
    down, right = (side / count for side, count in rows_columns)
    return Roughness(
        source, found.height, found.particles, found.holes, inside, everything, accuracy, patches,
        lost, texture_of(found.height, masked, (down, right)), tuple(said),
    )  # fmt: skip


def _warnings(
    source: HeightMap, masked: np.ndarray, skewness: float, lost: float, patches: float,
    lines: np.ndarray | None,
) -> list[str]:  # fmt: skip
    said = list(source.notes)
    if missing := int(source.missing.sum()):
        said.append(
            f"{missing} pixels ({_PERCENT * missing / source.height.size:.2g} %) have no height; "
            "they are left out like holes"
        )
    if max(source.pixel_aspect, 1.0 / source.pixel_aspect) > _OBLONG:
        said.append(
            f"pixels are {source.pixel_aspect:.3g} times as wide as long: particles are searched "
            "for in circles of pixels, which are ellipses on the surface"
        )
    steps = np.diff(source.height, axis=1) * source.height.shape[1] / source.width
    slope = float(np.sqrt(np.nanmean(steps**2)))
    spread = float(np.nanmax(source.height) - np.nanmin(source.height))
    if slope > _STEEPEST or spread < _ATOMS:
        said.append(
            f"its heights lie within {1e9 * spread:.3g} nm, with a slope of {slope:.2g} from pixel "
            "to pixel, which no film has; check --size and --unit"
        )
    share = float(masked.mean())
    known = source.height[np.isfinite(source.height)]
    clipped = float(max((known == known.max()).mean(), (known == known.min()).mean()))
    if clipped > _MOST_CLIPPED:
        said.append(
            f"{_PERCENT * clipped:.1f} % of the heights are exactly the highest or the lowest: "
            "the range of the scanner or of the file may cut the surface off; measure with a "
            "larger range"
        )
    if share > _MOST_MASKED:
        said.append(
            f"{_PERCENT * share:.1f} % of the map is masked; look at the figure, raise the "
            "threshold, use --mask none, or measure a cleaner place"
        )
    if abs(skewness) > _SKEWED:
        said.append(
            f"the surface is skewed (Ssk = {skewness:.2g}): particles no higher than its own peaks "
            "count as surface; look at the figure"
        )
    if lost > _MOST_LOST:
        said.append(
            f"levelling took about {_PERCENT * lost / (1.0 + lost):.0f} % of the surface's power, "
            f"and the map has only about {patches:.0f} independent patches: Sq is that of the "
            "levelled map, the interval that of the surface; a wider map narrows it"
        )
    if lines is not None:
        # neighbouring rows differ by a common step far more than neighbouring columns
        across, along = (
            float(np.std(np.diff(np.median(np.diff(lines, axis=axis), axis=1 - axis))))
            for axis in (0, 1)
        )
        if across > _SHIFTED * along > 0.0:
            said.append("scan lines are shifted against each other; compare with --flatten rows")
    return said


def _estimates(
    height: np.ndarray, mask: np.ndarray, kept: np.ndarray, accuracy: float, seed: int,
    pixel_aspect: float,
) -> tuple[dict[str, Estimate], float, float]:  # fmt: skip
    values = surface_parameters(height[~mask])
    rng = np.random.default_rng(seed)
    ratios, lost, patches = np.ones((2, DRAWS)), 0.0, 0.0
    if values[0] > 0.0:
        ratios, lost, patches = spread(height - height[~mask].mean(), mask, kept, rng, pixel_aspect)
    ratios = ratios * (1.0 + accuracy * rng.standard_normal(DRAWS))
    found = {}
    for index, (name, unit) in enumerate(zip(PARAMETERS, _UNITS, strict=True)):
        if index < len(ratios):
            value = values[index] / NANOMETRE
            found[name] = Estimate.of_draws(float(value), value * ratios[index], unit)
        else:
            found[name] = Estimate(float(np.nan_to_num(values[index])), _NO_BOUND, unit)
    return found, lost, patches


def summary(results: Sequence[Roughness]) -> dict[str, Any]:
    """One map, or the mean of several with each of them, as a JSON object."""
    if len(results) == 1:
        return results[0].summary()
    of_all = mean_parameters(results, masked=False)
    return plain(mean_parameters(results)) | {
        **{f"{name}_all": plain(one) for name, one in of_all.items()},
        "masked_fraction": float(np.mean([one.masked_fraction for one in results])),
        "height_accuracy": max(one.height_accuracy for one in results),
        "maps": {one.source.source: one.summary() for one in results},
        "warnings": joint_warnings([(one.source.source, one.warnings) for one in results]),
    }


def mean_parameters(results: Sequence[Roughness], *, masked: bool = True) -> dict[str, Estimate]:
    """Means of the parameters over several maps of a surface; ``results``: two or more."""
    # With the scatter of the maps' logarithms and the common accuracy. Each map counts at the
    # middle of its own interval, which allows for the power that levelling took.
    accuracy, count = max(one.height_accuracy for one in results), len(results)
    means = {}
    for name in PARAMETERS:
        maps = [(one.parameters if masked else one.parameters_all)[name] for one in results]
        mean, unit = float(np.mean([one.value for one in maps])), maps[0].unit
        ends = np.array([one.interval for one in maps])
        if not np.isfinite(ends).all():
            means[name] = Estimate(mean, _NO_BOUND, unit)
        elif ends.min() <= 0.0:
            means[name] = Estimate(mean, (0.0, float(ends.max())), unit)
        else:
            logarithms = np.log(ends).mean(axis=1)
            error = float(logarithms.std(ddof=1)) / math.sqrt(count)
            half = math.hypot(error * student_factor(count - 1), accuracy * NORMAL_FACTOR)
            low, high = np.exp(logarithms.mean() + half * np.array([-1.0, 1.0]))
            interval = (min(float(low), mean), max(float(high), mean))
            means[name] = Estimate(mean, interval, unit, mean * math.hypot(error, accuracy))
    return means


def to_dataset(results: Sequence[Roughness]) -> "xr.Dataset":
    """The levelled maps with their masks: 0 on the surface, 1 on particles and 2 in holes."""
    found: dict[str, Any] = {}
    for number, one in enumerate(results):
        sides = (f"y_{number}", f"x_{number}")
        for name, side, count in zip(
            sides, (one.source.length, one.source.width), one.height.shape, strict=True
        ):
            middle = (np.arange(count) + 0.5) * side / count
            found |= variables(name, [Series(name, middle, "m", name[0])])
        height = np.where(one.source.missing, np.nan, one.height)
        mask = one.particles.astype("i1") + 2 * one.holes.astype("i1")
        found |= variables(sides, [
            Series(f"height_{number}", height, "m", "levelled height"),
            Series(f"mask_{number}", mask, "", "0 surface, 1 particle, 2 hole"),
        ], file=one.source.source)  # fmt: skip
        texture = one.texture
        for at, of in (
            (Series("distance", texture.distance, "m"),
             Series("autocorrelation", texture.autocorrelation)),
            (Series("frequency", texture.frequency, "m^-1"),
             Series("power_spectral_density", texture.power, "m^4")),
        ):  # fmt: skip
            found |= variables(f"{at.name}_{number}", [
                one._replace(name=f"{one.name}_{number}", label=one.name) for one in (at, of)
            ])  # fmt: skip
    said = summary(results)["warnings"]
    return dataset("roughness", found, [one.source.source for one in results], warnings=said)
