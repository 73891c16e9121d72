"""Reading the results of a sweep: slices, the best designs, Pareto fronts."""

import difflib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import file_unit, number_or_text, parse
from lightflyer.design.outputs import OUTPUTS
from lightflyer.files.display_units import amount, suitable, unit_of
from lightflyer.study.distributions import SAMPLE

if TYPE_CHECKING:
    import xarray as xr

COVERAGE = (0.025, 0.975)  # Quantiles of the samples between which bands are drawn

COSTS = {"altitude": -1.0, "levitation_irradiance": 1.0, "temperature": 1.0}
"""What an output may be weighed against; -1 where more of that is better too."""

JUDGED = ("relative_payload", "payload", "band_width", "lift_over_weight")
"""Outputs by which designs are judged: by the first that there is."""

_AT_ONCE = 2**22  # numbers read at a time
_ROUNDING = 1e-9  # relative, of a value in other units
_HALF = 0.5  # of what is one where a design is usable, and zero elsewhere


def less_is_better(name: str) -> bool:
    """Whether the best design has the least of an output, by its name."""
    return name in OUTPUTS and OUTPUTS[name].less_is_better


def find_name(dataset: "xr.Dataset", name: str, *, among: str) -> str:
    """Full name of a field or an output; ``dataset``: A sweep."""
    known = [str(key) for key in (dataset.dims if among == "fields" else dataset.data_vars)]
    if name in known:
        return name
    ends = [full for full in known if full.endswith(f".{name}")]
    if len(ends) == 1:
        return ends[0]
    if ends:
        raise ConfigurationError(f'"{name}" is ambiguous; write one of {", ".join(ends)}')
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    hint = f'did you mean "{near[0]}"?' if near else f"it has {', '.join(known)}"
    raise ConfigurationError(f'the sweep has no "{name}" among its {among}; {hint}')


def parts(array: "xr.DataArray") -> Iterator[tuple[slice, np.ndarray]]:
    """Values of an array in parts along its first dimension that fit into memory."""
    rows = max(1, _AT_ONCE // max(1, int(np.prod(array.shape[1:]))))
    for start in range(0, array.shape[0], rows):
        part = slice(start, start + rows)
        yield part, np.asarray(array[part])


@dataclass(frozen=True)
class BestDesign:
    """The design with the best value of an output."""

    value: float  # Value of the output; with samples, their median
    units: str
    band: tuple[float, float] | None  # Ends of the samples' 95 % band; None without samples
    where: dict[str, tuple[float, str]]  # Value and units of each coordinate
    index: dict[str, int]  # Its place along each dimension

    def __str__(self) -> str:
        at = ", ".join(f"{name} {amount(*where)}" for name, where in self.where.items())
        factor, unit = suitable(self.units, self.value)
        shown = f"{self.value * factor:.4g} {unit}".rstrip()
        if self.band is not None:
            low, high = (end * factor for end in self.band)
            shown += f" (median; 95 % of the samples {low:.4g} to {high:.4g})"
        return shown + (f" at {at}" if at else "")


def best_design(dataset: "xr.Dataset", name: str) -> BestDesign | None:
    """Design at which an output is largest, or smallest where less is better.

    Where the sweep has ``usable``, only designs count that are; unless none is.
    """
    usable = dataset.get("usable")
    if usable is not None and not set(usable.dims) <= set(dataset[name].dims):
        usable = None  # it says nothing of a design without its altitude
    found = None if usable is None else _best(dataset[name], usable)
    return _best(dataset[name], None) if found is None else found


def _best(array: "xr.DataArray", usable: "xr.DataArray | None") -> BestDesign | None:
    # Of uncertain designs the median over the samples counts; a sample without a value is the
    # worst.
    name, array = str(array.name), _samples_last(array)
    able = None if usable is None else _alike(usable, array)
    sign = -1.0 if less_is_better(name) else 1.0
    best = -np.inf
    place: tuple[int, ...] = ()
    for rows, values in parts(array) if array.ndim else [(slice(0, 1), np.asarray(array))]:
        score = _typical(worst_for_nan(sign * values), array)
        if able is not None:
            flies = np.asarray(able[rows] if array.ndim else able, float)
            score = np.where(_typical(flies, array) >= _HALF, score, -np.inf)
        here = np.unravel_index(int(np.argmax(score)), score.shape)
        if score[here] > best:
            best = float(score[here])
            first = [int(here[0]) + rows.start] if score.ndim else []
            place = (*first, *map(int, here[1:]))
    if not np.isfinite(best):
        return None
    dimensions = [dimension for dimension in array.dims if dimension != SAMPLE]
    index = {str(axis): number for axis, number in zip(dimensions, place, strict=True)}
    there = array.isel(index)
    order = [*dimensions, *(key for key in there.coords if key not in dimensions)]
    where = {
        str(key): (float(there.coords[key]), unit_of(there.coords[key]))
        for key in order
        if key in there.coords and not there.coords[key].ndim
    }
    band = None
    if SAMPLE in array.dims:
        drawn = sign * worst_for_nan(sign * np.asarray(there))
        low, high = np.quantile(drawn, COVERAGE, method="nearest")
        band = (float(low), float(high))
    return BestDesign(sign * best, unit_of(array), band, where, index)


def worst_for_nan(score: Any) -> Any:
    """Scores of which more is better, of NumPy or JAX; what has no value is the worst."""
    return score.__array_namespace__().where(_is_missing(score), -np.inf, score)


def _samples_last(array: "xr.DataArray") -> "xr.DataArray":
    """The array with its samples, if it has any, along the last axis."""
    return array.transpose(..., SAMPLE) if SAMPLE in array.dims else array


def _alike(part: "xr.DataArray", array: "xr.DataArray") -> "xr.DataArray":
    """A part with the dimensions of an array, in its order."""
    if part.dims == array.dims:
        return part
    return part.broadcast_like(array).transpose(*array.dims)


def _typical(values: np.ndarray, array: "xr.DataArray") -> np.ndarray:
    """What stands for the samples of a design: the median, for a best draw is no better design."""
    if SAMPLE not in array.dims:
        return values
    return median_of_samples(values)


def median_of_samples(values: Any) -> Any:
    """Median along the last axis, of NumPy or JAX."""
    # Of an even number it is the lower one, so that it is that of a sample and never a mean of
    # infinities.
    return values.__array_namespace__().quantile(values, 0.5, axis=-1, method="lower")


def choose_slice(
    dataset: "xr.Dataset", value: str, kept: list[str], asked: Mapping[str, str]
) -> tuple["xr.Dataset", dict[str, tuple[float, str]]]:
    """Fix all dimensions but some, at asked values or else at the best design."""
    chosen: dict[str, tuple[float, str]] = {}
    for short, text in asked.items():
        name = find_name(dataset, short, among="fields")
        if name in kept:
            raise ConfigurationError(f"--at {short}: {name} is an axis of the map")
        unit = file_unit(unit_of(dataset[name]))
        try:
            wanted = parse(number_or_text(text) if not unit else text, unit).value
        except ConfigurationError as error:
            raise ConfigurationError(f"--at {short}: {error}") from None
        there = dataset[name].values
        low, high = float(there.min()), float(there.max())
        if not low - _ROUNDING * abs(low) <= wanted <= high + _ROUNDING * abs(high):
            raise ConfigurationError(
                f"--at {short}: {text} is outside the sweep's {low:.6g} to {high:.6g} "
                f"{unit_of(dataset[name])}".rstrip()
            )
        number = int(np.argmin(np.abs(there - wanted)))
        chosen[name] = (float(dataset[name][number]), unit_of(dataset[name]))
        dataset = dataset.isel({name: number})
    others = [str(d) for d in dataset[value].dims if d not in kept and d != SAMPLE]
    if others:
        best = best_design(dataset, value)
        for name in others:
            number = best.index[name] if best else 0
            chosen[name] = (float(dataset[name][number]), unit_of(dataset[name]))
            dataset = dataset.isel({name: number})
    return dataset, chosen


def margin(table: Mapping[Any, Any], where: Any = None) -> Any:
    """Whether the designs of a sweep fly, as far as its outputs tell."""
    if where is None:
        import xarray as xr

        where = xr.where
    if "usable" in table:
        return table["usable"] - _HALF
    if "lift_over_weight" in table:
        return table["lift_over_weight"] - 1.0
    for name in ("relative_payload", "payload"):
        if name in table:
            return where(_is_missing(table[name]), -1.0, table[name])
    for name in ("lowest_altitude", "levitation_irradiance"):
        if name in table:
            return where(_is_missing(table[name]), -0.5, 0.5)
    if "band_width" in table:
        return where(table["band_width"] > 0.0, 0.5, -0.5)
    return None


def _is_missing(values: Any) -> Any:
    """Where an array of any kind has no number."""
    return values != values  # as NaN does, whatever kind of array it is in


def pareto_front(
    dataset: "xr.Dataset", gain: str, cost: str, *, sign: float = 1.0
) -> tuple[np.ndarray, np.ndarray]:
    """Designs that no other beats in both of two quantities, shape (n,); ``dataset``: A sweep."""
    # Of uncertain designs the medians over the samples count; a design flies if its median does.
    array, other, able = dataset[gain], dataset[cost], margin(dataset)
    worth = -1.0 if less_is_better(gain) else 1.0
    gains, costs = np.empty(0), np.empty(0)
    array = _samples_last(array)
    other = _alike(other, array)
    able = None if able is None else _alike(able, array)
    for rows, drawn in parts(array):
        values = worth * _typical(worst_for_nan(worth * drawn), array)
        there = -sign * _typical(worst_for_nan(-sign * np.asarray(other[rows])), array)
        known = np.isfinite(values) & np.isfinite(there)
        if able is not None:
            known &= _typical(np.asarray(able[rows], float), array) >= 0.0
        gains = np.concatenate([gains, worth * values[known]])
        costs = np.concatenate([costs, sign * there[known]])
        # cheapest first, and among equals the best; a design no better than a cheaper one is beaten
        order = np.lexsort((-gains, costs))
        gains, costs = gains[order], costs[order]
        if gains.size:
            before = np.concatenate([[-np.inf], np.maximum.accumulate(gains)[:-1]])
            gains, costs = gains[gains > before], costs[gains > before]
    return worth * gains, sign * costs


def over_samples(array: "xr.DataArray") -> dict[str, Any]:
    """Median and ends of the 95 % band of an output over the samples of a sweep."""
    array = array.fillna(np.inf if less_is_better(str(array.name)) else -np.inf)
    low, median, high = (
        array.quantile(level, SAMPLE, method="nearest", keep_attrs=True).drop_vars("quantile")
        for level in (COVERAGE[0], 0.5, COVERAGE[1])
    )
    return {"low": low, "median": median, "high": high}
