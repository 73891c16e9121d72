r"""Roughness of a surface from a map of its height, without the particles on it.

A polynomial fitted to the surface between the particles levels the map. With the height :math:`z`
above the mean,

.. math:: S_q^2 = \overline{z^2}, \quad S_a = \overline{|z|}, \quad
    S_{sk} = \overline{z^3}/S_q^3, \quad S_{ku} = \overline{z^4}/S_q^4.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.core.arguments import reads_units
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Fraction
from lightflyer.files.result_text import Parts
from lightflyer.lab.estimate import (
    NORMAL_FACTOR,
    Estimate,
    LabResult,
    estimate_table,
    student_factor,
)
from lightflyer.lab.readers.height_map import NANOMETRE, HeightMap
from lightflyer.lab.record import dataset, joint_warnings
from lightflyer.lab.surface.diagnostics import warnings_of
from lightflyer.lab.surface.intervals import DRAWS, SPECTRUM, spread
from lightflyer.lab.surface.particles import (
    MOST_MASKED,
    THRESHOLD,
    Flatten,
    Objects,
    count_objects,
    fill_missing,
    find_particles,
    flatten_rows,
    kept_power,
    level,
)
from lightflyer.lab.surface.texture import Texture, texture_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEIGHT_ACCURACY = 0.02  # Relative standard uncertainty of the microscope's heights; our assumption
PARAMETERS = ("rms_height", "mean_absolute_height", "skewness", "kurtosis")  # Sq, Sa, Ssk and Sku
Mask = Literal["auto", "none"] | np.ndarray  # Whether particles and holes are masked, or what is

_PERCENT = 100.0
_UNITS = ("nm", "nm", "", "")
_NO_BOUND = (-math.inf, math.inf)
_EIGHT = np.ones((3, 3))
_MICROMETRE = 1e-6
_NAMES = {
    "rms_height": "rms height Sq",
    "mean_absolute_height": "mean absolute height Sa",
}


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
    height_accuracy: float
    patches: float  #: Effective number of independent heights in Sq²
    #: Estimate of the power of the surface that levelling took, over the power left. The intervals
    #: contain it
    lost: float
    texture: Texture  #: Autocorrelation, power spectrum and slopes outside the mask
    warnings: tuple[str, ...] = ()

    @property
    def mask(self) -> np.ndarray:
        """True on particles and in holes, shape (rows, columns)."""
        return self.particles | self.holes

    @property
    def masked_fraction(self) -> float:
        """Share of the map on particles and in holes."""
        return float(self.mask.mean())

    def parts(self) -> Parts:
        """Size of a map, what is masked, and its parameters."""
        rows, columns = self.height.shape
        source = self.source
        channel = f", {source.channel}" if source.channel else ""
        sides = " x ".join(f"{side / _MICROMETRE:.4g}" for side in (source.width, source.length))
        masked = ", ".join(
            f"{count_objects(mask)} {name} ({_PERCENT * mask.mean():.2f} %)"
            for name, mask in (("particles", self.particles), ("holes", self.holes))
        )
        yield (
            f"read {source.source}{channel}: {columns} x {rows} pixels, {sides} µm; {masked} masked"
        )
        named = [(name, self.parameters[key]) for key, name in _NAMES.items()]
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

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the levelled map, as it is and with its mask."""
        from lightflyer.lab.surface.figures import plot_roughness

        return plot_roughness(self, ax)

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object."""
        return {
            **{name: one.to_json() for name, one in self.parameters.items()},
            **{f"{name}_all": one.to_json() for name, one in self.parameters_all.items()},
            "masked_fraction": self.masked_fraction,
            "particles": count_objects(self.particles),
            "particle_fraction": float(self.particles.mean()),
            "holes": count_objects(self.holes),
            "hole_fraction": float(self.holes.mean()),
            "missing_fraction": float(self.source.missing.mean()),
            "independent_patches": self.patches,
            "lost_in_levelling": self.lost,
            "height_accuracy": self.height_accuracy,
            **self.texture.summary(),
            "pixels": list(self.height.shape),
            "size_um": [self.source.width * 1e6, self.source.length * 1e6],
            "channel": self.source.channel,
            "warnings": list(self.warnings),
        }


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
    threshold: float = THRESHOLD,
    order: int = 2,
    flatten: Flatten = "none",
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
    if flatten not in get_args(Flatten):
        raise ParameterError(f'flatten = "{flatten}" is unknown; choose none or rows')
    require_range("threshold", threshold, 1.0)
    require_range("order", order, 0, 5)
    require_range("flatten_order", flatten_order, 0, 1)
    require_range("height_accuracy", height_accuracy, 0.0, 0.5)
    rows = None if flatten == "none" else flatten_order
    missing = source.missing
    raw = fill_missing(source.height)
    if np.ptp(raw) == 0.0:
        raise ConfigurationError(
            f"{source.source}: all heights are equal: this is no map of a surface"
        )
    if rows is not None:
        raw = flatten_rows(raw, rows)
    whole = level(raw, missing, order)
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
        if mask.mean() > MOST_MASKED:
            raise ConfigurationError(
                f"{source.source}: the mask given leaves out more than {MOST_MASKED:.0%} of the "
                "map; what is 1, or not black, is left out"
            )
        found = Objects(level(raw, mask | missing, order), mask, nothing)
    elif mask == "none":
        found = Objects(whole, nothing, nothing)
    elif mask != "auto":
        raise ParameterError(f'mask = "{mask}" is unknown; choose auto, none, or give an array')
    else:
        try:
            found = find_particles(raw, threshold=threshold, order=order)
        except ConfigurationError as error:
            raise ConfigurationError(f"{source.source}: {error}") from None
    if missing.any():
        holes = (found.holes | missing) & ~found.particles
        found = Objects(level(raw, found.particles | holes, order), found.particles, holes)
    masked = found.particles | found.holes
    accuracy = HEIGHT_ACCURACY if height_accuracy is None else height_accuracy
    kept = kept_power(raw.shape, min(*raw.shape, SPECTRUM), order, rows)
    common = (kept, accuracy, seed, source.pixel_aspect)
    inside, lost, patches = _estimates(found.height, masked, *common)
    everything = _estimates(whole, missing, *common)[0]
    said = warnings_of(source, raw, masked, inside["skewness"].value, lost, patches,
                       flattened=rows is not None)  # fmt: skip
    if not isinstance(mask, str) and not mask.any():
        said += ("the mask given is empty: Sq is that of the whole map",)
    if height_accuracy is None:
        said += assumed_accuracies({"heights": f"± {_PERCENT * HEIGHT_ACCURACY:g} %"})
    rows_columns = zip((source.length, source.width), raw.shape, strict=True)
    down, right = (side / count for side, count in rows_columns)
    return Roughness(
        source, found.height, found.particles, found.holes, inside, everything, accuracy, patches,
        lost, texture_of(found.height, masked, (down, right)), said,
    )  # fmt: skip


def _estimates(
    height: np.ndarray, mask: np.ndarray, kept: np.ndarray, accuracy: float, seed: int,
    pixel_aspect: float,
) -> tuple[dict[str, Estimate], float, float]:  # fmt: skip
    """Parameters with intervals, power lost in levelling, independent patches."""
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
    everything = mean_parameters(results, masked=False)
    return {
        **{name: one.to_json() for name, one in mean_parameters(results).items()},
        **{f"{name}_all": one.to_json() for name, one in everything.items()},
        "masked_fraction": float(np.mean([one.masked_fraction for one in results])),
        "height_accuracy": max(one.height_accuracy for one in results),
        "maps": {one.source.source: one.summary() for one in results},
        "warnings": joint_warnings([(one.source.source, one.warnings) for one in results]),
    }


def mean_parameters(results: Sequence[Roughness], *, masked: bool = True) -> dict[str, Estimate]:
    """Means of the parameters over several maps of a surface; ``results``: two or more."""
    accuracy = max(one.height_accuracy for one in results)
    found = [one.parameters if masked else one.parameters_all for one in results]
    return {name: _mean_of_maps([one[name] for one in found], accuracy) for name in PARAMETERS}


def _mean_of_maps(estimates: Sequence[Estimate], accuracy: float) -> Estimate:
    """Mean over maps, with the scatter of the maps' logarithms and the common accuracy."""
    # Each map counts at the middle of its own interval, which allows for the power that levelling
    # took.
    values = np.array([one.value for one in estimates])
    mean, unit = float(values.mean()), estimates[0].unit
    if not all(math.isfinite(end) for one in estimates for end in one.interval):
        return Estimate(mean, _NO_BOUND, unit)
    ends = np.array([one.interval for one in estimates])
    if ends.min() <= 0.0:
        return Estimate(mean, (0.0, float(ends.max())), unit)
    logarithms = np.log(ends).mean(axis=1)
    count = len(estimates)
    error = float(logarithms.std(ddof=1)) / math.sqrt(count)
    half = math.hypot(error * student_factor(count - 1), accuracy * NORMAL_FACTOR)
    low, high = np.exp(logarithms.mean() + half * np.array([-1.0, 1.0]))
    interval = (min(float(low), mean), max(float(high), mean))
    return Estimate(mean, interval, unit, mean * math.hypot(error, accuracy))


def to_dataset(results: Sequence[Roughness]) -> "xr.Dataset":
    """The levelled maps with their masks: 0 on the surface, 1 on particles and 2 in holes."""
    variables: dict[str, Any] = {}
    for number, one in enumerate(results):
        dimensions = (f"y_{number}", f"x_{number}")
        sides = (one.source.length, one.source.width)
        for dimension, side, count in zip(dimensions, sides, one.height.shape, strict=True):
            middle = (np.arange(count) + 0.5) * side / count
            variables[dimension] = (dimension, middle, {"units": "m", "long_name": dimension[0]})
        variables[f"height_{number}"] = (
            dimensions, np.where(one.source.missing, np.nan, one.height),
            {"units": "m", "long_name": "levelled height", "file": one.source.source},
        )  # fmt: skip
        variables[f"mask_{number}"] = (
            dimensions, one.particles.astype("i1") + 2 * one.holes.astype("i1"),
            {"units": "1", "long_name": "0 surface, 1 particle, 2 hole", "file": one.source.source},
        )  # fmt: skip
        found = one.texture
        for dimension, at, units, name, value, of in (
            ("distance", found.distance, "m", "autocorrelation", found.autocorrelation, "1"),
            ("frequency", found.frequency, "m-1", "power_spectral_density", found.power, "m4"),
        ):
            over = f"{dimension}_{number}"
            variables[over] = (over, at, {"units": units, "long_name": dimension})
            variables[f"{name}_{number}"] = (over, value, {"units": of, "long_name": name})
    said = summary(results)["warnings"]
    return dataset("roughness", variables, [one.source.source for one in results], warnings=said)


def finding_parts(parameters: Mapping[str, Estimate]) -> Parts:
    """The roughness in a sentence."""
    yield f"{_NAMES['rms_height']} {parameters['rms_height']}"


def means_parts(means: Mapping[str, Estimate], count: int) -> Parts:
    """Means of the parameters over several maps."""
    yield f"mean of {count} maps"
    yield estimate_table([(name, means[key]) for key, name in _NAMES.items()])
