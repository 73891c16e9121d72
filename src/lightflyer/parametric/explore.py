"""Reading the results of a sweep: slices, the best designs, Pareto fronts."""

import difflib
import itertools
import operator
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.compute.evaluation import Chunks
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.units import file_unit, number_or_text, parse
from lightflyer.design.outputs import OUTPUTS
from lightflyer.files.display_units import amount, suitable, unit_of
from lightflyer.study.axes import SAMPLE

if TYPE_CHECKING:
    import xarray as xr

COVERAGE = (0.025, 0.975)  # Quantiles of the samples between which bands are drawn

COSTS = {"altitude": -1.0, "levitation_irradiance": 1.0, "temperature": 1.0}
"""What an output may be weighed against; -1 where more of that is better too."""

JUDGED = ("relative_payload", "payload", "band_width", "lift_over_weight")
"""Outputs by which designs are judged: by the first that there is."""

_TELLING = ("usable", "lift_over_weight", "relative_payload", "payload", "lowest_altitude",
            "levitation_irradiance", "band_width")  # fmt: skip
"""Outputs that tell whether a design flies: the first that there is."""

SHARES = (0.0, 0.025, 0.05, 0.25, 0.5, 0.75, 0.95, 0.975, 1.0)  # of designs

_AT_ONCE = 2**22  # numbers read at a time
_CELLS = 2**16  # that sixteen bits tell apart
_SIGN = np.uint64(2**63)  # the highest bit of a number
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


class _Results:
    """Results of a sweep, read in parts that fit into memory; designs count in row-major order."""

    def __init__(self, dataset: "xr.Dataset", output: str):
        self.dataset, self.output = dataset, output
        self.worth = -1.0 if less_is_better(output) else 1.0
        self._sizes = {str(name): n for name, n in dataset[output].sizes.items() if name != SAMPLE}
        self._samples = {SAMPLE: dataset.sizes[SAMPLE]} if SAMPLE in dataset[output].dims else {}
        self.dims = list(self._sizes)

    def parts(self, *names: str) -> "Iterator[tuple[dict[str, slice], xr.Dataset]]":
        """Where each part lies along each dimension, and these outputs of it, in memory."""
        needed = self.dataset[[name for name in names if name in self.dataset.data_vars]]
        blocks = dict(self.dataset[self.output].chunksizes)
        places: Iterable[tuple[slice, ...]]
        if blocks:  # Dask's, each of which is computed once
            sizes = [blocks[name] for name in self.dims]
            ends = [np.cumsum(lengths) for lengths in sizes]
            every = ([slice(int(e - n), int(e)) for n, e in zip(*both, strict=True)]
                     for both in zip(sizes, ends, strict=True))  # fmt: skip
            places = itertools.product(*every)
        else:
            at_once = max(_AT_ONCE // self._samples.get(SAMPLE, 1), 1)
            chunks = Chunks.of(tuple(self._sizes.values()), at_once)
            places = map(chunks.part, range(len(chunks)))
        for place in places:
            there = dict(zip(self.dims, place, strict=True))
            yield there, needed.isel(there).load()

    def numbers(self, there: dict[str, slice], local: np.ndarray) -> np.ndarray:
        """Numbers of designs, from those that they have within a part."""
        if not there:
            return local
        sizes = tuple(part.stop - part.start for part in there.values())
        places = np.unravel_index(local, sizes)
        starts = [part.start for part in there.values()]
        moved = tuple(place + start for place, start in zip(places, starts, strict=True))
        return np.ravel_multi_index(moved, tuple(self._sizes.values()))

    def medians(self, part: "xr.Dataset", array: "xr.DataArray", sign: float) -> np.ndarray:
        """``sign`` times a number of a part's designs, (n,); -∞, the worst, where it has none."""
        # Of uncertain designs the median over the samples counts, for a best draw is no better
        # design.
        sizes = {name: part.sizes[name] for name in self.dims} | self._samples
        wide: Any = array.variable
        values = sign * np.asarray(wide.set_dims(sizes), np.float64)
        values = np.where(np.isnan(values), -np.inf, values)
        if self._samples:
            # the lower of two, so that it is that of a sample and never a mean of infinities
            values = np.quantile(values, 0.5, axis=-1, method="lower")
        return values.ravel()

    def places(self, designs: np.ndarray) -> dict[str, np.ndarray]:
        """Places of designs along each dimension."""
        if not self.dims:
            return {}
        places = np.unravel_index(designs, tuple(self._sizes.values()))
        return dict(zip(self.dims, places, strict=True))

    def rows(self, designs: np.ndarray, along: str) -> "xr.Dataset":
        """All outputs and numbers of some designs; ``along``: their dimension."""
        import xarray as xr

        places = {name: xr.DataArray(at, dims=along) for name, at in self.places(designs).items()}
        if not places:  # one design
            return self.dataset.expand_dims(along).isel({along: designs})
        return self.dataset.isel(places)


def _opened(results: "xr.Dataset | str | Path") -> "xr.Dataset":
    """A sweep, from its folder where it is one."""
    if isinstance(results, str | Path):
        from lightflyer.parametric.run import open_sweep

        return open_sweep(results)
    if not hasattr(results, "data_vars"):
        raise ParameterError(
            "results are the folder of a sweep or a Dataset, such as of lf.sweep, not a "
            f"{type(results).__name__}"
        )
    return results


def best_designs(results: "xr.Dataset | str | Path", output: str, count: int = 100) -> "xr.Dataset":
    """The designs of a sweep with the best values of an output.

    Parameters
    ----------
    results : xarray.Dataset or path
        A sweep, or the folder of one, which is read part by part.
    output : str
        More of it is better; less, where it is one such as a temperature.
    count : int
        How many, at most.

    Returns
    -------
    xarray.Dataset
        The same variables along ``rank``, the best first; of equals the first in the sweep. Where
        the sweep has ``usable``, only designs count that are, unless none is. Of uncertain designs
        the medians over the samples decide.

    Raises
    ------
    ConfigurationError
        If the sweep has no such output, or its folder is damaged.
    ParameterError
        If the count is none.

    Examples
    --------
    >>> import xarray as xr
    >>> payload = ("altitude", [1e-6, 3e-6, 2e-6], {"units": "kg"})
    >>> sweep = xr.Dataset({"payload": payload}, {"altitude": [60e3, 70e3, 80e3]})
    >>> best_designs(sweep, "payload", 2).altitude.values
    array([70000., 80000.])
    """
    dataset = _opened(results)
    asked: Any = count
    if isinstance(asked, bool) or not isinstance(asked, int | np.integer) or asked < 1:
        raise ParameterError(f"count = {count} must be a whole number of at least 1")
    found = _Results(dataset, find_name(dataset, output, among="outputs"))
    return found.rows(_best(found, count)[0], "rank")


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
    found = _Results(dataset, name)
    designs, scores = _best(found, 1)
    if not designs.size:
        return None
    index = {axis: int(places[0]) for axis, places in found.places(designs).items()}
    there = dataset[name].isel(index)
    order = [*found.dims, *(key for key in there.coords if key not in found.dims)]
    where = {
        str(key): (float(there.coords[key]), unit_of(there.coords[key]))
        for key in order
        if key in there.coords and not there.coords[key].ndim
    }
    band = None
    if there.ndim:
        drawn = found.worth * np.asarray(there)
        drawn = found.worth * np.where(np.isnan(drawn), -np.inf, drawn)
        low, high = np.quantile(drawn, COVERAGE, method="nearest")
        band = (float(low), float(high))
    return BestDesign(found.worth * float(scores[0]), unit_of(there), band, where, index)


def _best(found: _Results, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the best designs, best first, and their values with the sign of ``worth``."""
    # it says nothing of a design without its altitude
    usable, array = found.dataset.get("usable"), found.dataset[found.output]
    judged = usable is not None and set(usable.dims) <= set(array.dims)
    designs, scores = np.empty(0, int), np.empty(0)
    for only_usable in (True, False) if judged else (False,):
        for there, part in found.parts(found.output, "usable"):
            score = found.medians(part, part[found.output], found.worth)
            if only_usable:
                able = found.medians(part, part["usable"], 1.0) >= _HALF
                score = np.where(able, score, -np.inf)
            known = np.flatnonzero(np.isfinite(score))
            if known.size > count:
                last = np.partition(score[known], known.size - count)[known.size - count]
                known = known[score[known] >= last]
            designs = np.concatenate([designs, found.numbers(there, known)])
            scores = np.concatenate([scores, score[known]])
            order = np.lexsort((designs, -scores))[:count]
            designs, scores = designs[order], scores[order]
        if designs.size:
            break
    return designs, scores


def choose_slice(
    dataset: "xr.Dataset", value: str, kept: list[str], asked: Mapping[str, str]
) -> tuple["xr.Dataset", dict[str, tuple[float, str]]]:
    """Fix all dimensions but some, at asked values or else at the best design; those rise."""
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
    # figures and tables follow the axes, lists of values need not
    return dataset.sortby(kept), chosen


def margin(dataset: "xr.Dataset") -> "xr.DataArray | None":
    """What is positive where designs fly, as far as outputs tell; NaN where that is not known."""
    name = next((name for name in _TELLING if name in dataset), None)
    if name is None:
        return None
    values = dataset[name]
    if name == "usable":
        return values - _HALF
    if name == "lift_over_weight":
        return values - 1.0
    if name in ("relative_payload", "payload"):
        able = values.fillna(-1.0)
    elif name == "band_width":
        able = (values > 0.0) - _HALF
    else:
        able = values.notnull() - _HALF
    if dataset.attrs.get("complete", True):
        return able
    # a design that has no number at all is not computed yet
    there = [one.notnull() for one in dataset.data_vars.values() if one.dims == values.dims]
    return able.where(reduce(operator.or_, there))


def margin_of_most(dataset: "xr.Dataset") -> "xr.DataArray | None":
    """As :func:`margin`; where designs are uncertain, the share that flies less a half."""
    able = margin(dataset)
    if able is None or SAMPLE not in able.dims:
        return able
    return (able >= 0.0).where(able.notnull()).mean(SAMPLE) - _HALF


def pareto_front(results: "xr.Dataset | str | Path", output: str, cost: str) -> "xr.Dataset":
    """Designs of a sweep that no other beats in both of two quantities.

    Parameters
    ----------
    results : xarray.Dataset or path
        A sweep, or the folder of one, which is read part by part.
    output : str
        More of it is better; less, where it is one such as a temperature.
    cost : str
        Another output, or a varied number. Less of it is better, but of the altitude more.

    Returns
    -------
    xarray.Dataset
        The same variables along ``point``, the cheapest first; of designs that are equal in both
        the first in the sweep. Only designs that fly, as far as the outputs tell. Of uncertain
        designs the medians over the samples decide.

    Raises
    ------
    ConfigurationError
        If the sweep has no such quantity, or its folder is damaged.
    ParameterError
        If both are the same.

    Examples
    --------
    >>> import xarray as xr
    >>> payload = ("altitude", [1e-6, 3e-6, 2e-6], {"units": "kg"})
    >>> sweep = xr.Dataset({"payload": payload}, {"altitude": [60e3, 70e3, 80e3]})
    >>> pareto_front(sweep, "payload", "altitude").altitude.values
    array([80000., 70000.])
    """
    dataset = _opened(results)
    name = find_name(dataset, output, among="outputs")
    if cost not in dataset.data_vars:
        cost = find_name(dataset, cost, among="fields")
    if cost == name:
        raise ParameterError(f"a front weighs {name} against something else, not against itself")
    return _Results(dataset, name).rows(front(dataset, name, cost)[0], "point")


def front(dataset: "xr.Dataset", gain: str, cost: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of a front's designs, and their medians of output and cost, (n,) each."""
    found, price = _Results(dataset, gain), COSTS.get(cost, 1.0)
    designs, gains, costs = np.empty(0, int), np.empty(0), np.empty(0)
    for place, part in found.parts(gain, cost, *_TELLING):
        values = found.medians(part, part[gain], found.worth)
        there = -found.medians(part, part[cost], -price)
        known = np.isfinite(values) & np.isfinite(there)
        able = margin(part)
        if able is not None:
            known &= found.medians(part, able, 1.0) >= 0.0
        # most are beaten by the front so far: few are left to be sorted
        best = np.concatenate([[-np.inf], gains])[np.searchsorted(costs, there, side="right")]
        known &= values > best
        designs = np.concatenate([designs, found.numbers(place, np.flatnonzero(known))])
        gains = np.concatenate([gains, values[known]])
        costs = np.concatenate([costs, there[known]])
        # cheapest first, and among equals the best; a design no better than a cheaper one is beaten
        order = np.lexsort((designs, -gains, costs))
        designs, gains, costs = designs[order], gains[order], costs[order]
        before = np.concatenate([[-np.inf], np.maximum.accumulate(gains)])[: gains.size]
        designs, gains, costs = (column[gains > before] for column in (designs, gains, costs))
    return designs, found.worth * gains, price * costs


def quantiles(
    results: "xr.Dataset | str | Path", output: str, shares: Sequence[float] = SHARES
) -> "xr.DataArray":
    """Values that shares of a sweep's designs do not exceed.

    Parameters
    ----------
    results : xarray.Dataset or path
        A sweep, or the folder of one, which is read part by part, four times.
    output : str
    shares : sequence of float
        From 0, the least value, to 1, the largest.

    Returns
    -------
    xarray.DataArray
        Along ``share``: values of designs, of all samples where the sweep has any. Its attributes
        say of how many designs, and how many have no value.

    Raises
    ------
    ConfigurationError
        If the sweep has no such output, or its folder is damaged.

    Examples
    --------
    >>> import xarray as xr
    >>> payload = ("altitude", [1e-6, 3e-6, 2e-6], {"units": "kg"})
    >>> sweep = xr.Dataset({"payload": payload}, {"altitude": [60e3, 70e3, 80e3]})
    >>> quantiles(sweep, "payload", [0.0, 0.5]).values
    array([1.e-06, 2.e-06])
    """
    import xarray as xr

    dataset = _opened(results)
    name = find_name(dataset, output, among="outputs")
    asked = np.atleast_1d(np.asarray(shares, float))
    if not np.all((asked >= 0.0) & (asked <= 1.0)):
        raise ConfigurationError("shares are numbers from 0 to 1")
    found = _Results(dataset, name)
    # The bits of numbers, the others way round where they are negative, are ordered as the numbers
    # are. So a quantile is found sixteen bits at a time, by counting.
    first, rank, known, missing = np.zeros(asked.size, np.uint64), np.ones(asked.size), 0, 0
    for shift in (48, 32, 16, 0):
        counts = {start: np.zeros(_CELLS, np.int64) for start in first.tolist()}
        missing = 0
        for _, part in found.parts(name):
            every = np.asarray(part[name], float).ravel()
            values = every[~np.isnan(every)]
            bits = np.where(values < 0.0, ~values.view(np.uint64), values.view(np.uint64) | _SIGN)
            bits = bits >> shift
            for start, count in counts.items():
                cells = bits - (start << 16)  # beyond all cells where it is another start
                count += np.bincount(cells[cells < _CELLS].astype(int), minlength=_CELLS)
            missing += every.size - values.size
        if shift == 48:
            known = int(sum(counts[0]))
            rank = np.clip(np.ceil(asked * known), 1, known)
        for place, start in enumerate(first.tolist() if known else ()):
            below = np.cumsum(counts[start])
            cell = int(np.searchsorted(below, rank[place]))
            rank[place] -= below[cell] - counts[start][cell]
            first[place] = (start << 16) + cell
    values = np.where(first >= _SIGN, (first & ~_SIGN).view(float), (~first).view(float))
    return xr.DataArray(
        values if known else np.full(asked.size, np.nan),
        {"share": asked},
        "share",
        name,
        dict(dataset[name].attrs) | {"designs": known, "designs without a value": missing},
    )


def over_samples(array: "xr.DataArray") -> dict[str, Any]:
    """Median and ends of the 95 % band of an output over the samples of a sweep."""
    array = array.fillna(np.inf if less_is_better(str(array.name)) else -np.inf)
    low, median, high = (
        array.quantile(level, SAMPLE, method="nearest", keep_attrs=True).drop_vars("quantile")
        for level in (COVERAGE[0], 0.5, COVERAGE[1])
    )
    return {"low": low, "median": median, "high": high}
