"""What is kept of a sweep as labelled tables."""

from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.compute.store import empty_dataset
from lightflyer.parametric.explore import less_is_better
from lightflyer.parametric.reduction_plan import Designs, ReductionSpec, samples_of
from lightflyer.parametric.reductions import RESOLUTION, Best, Partial, Spread, histogram, quantiles
from lightflyer.study.distributions import SAMPLE
from lightflyer.study.study import Study

if TYPE_CHECKING:
    import xarray as xr

SHARES = (0.0, 0.001, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 0.975, 0.99, 0.999, 1.0)
"""Shares of designs for which quantiles are given."""

_BINS = 100  # at most
_CELLS_IN_A_BIN = 4  # at least
_MOST_OF_THEM = (
    0.001,
    0.999,
)  # between these quantiles bins are even; the outer ones hold the rest


def to_datatree(
    study: Study,
    evaluator: Any,
    kept: list[ReductionSpec],
    partials: dict[str, Partial],
    failures: int,
) -> "xr.DataTree":
    """Tables of the best designs, the fronts and the distributions of a study."""
    import xarray as xr

    attributes = empty_dataset(study).attrs | {"not_converged": failures}
    del attributes["complete"]  # a file is; and NetCDF has no truth values
    groups: dict[str, Any] = {"/": xr.Dataset(attrs=attributes | {"title": "lightflyer, reduced"})}
    for part in kept:
        partial, reduction = partials[part.name], part.reduction
        if isinstance(reduction, Spread):
            groups[part.name] = _distribution(study, reduction.output, partial)
        else:
            along = "rank" if isinstance(reduction, Best) else "point"
            groups[part.name] = _designs(study, evaluator, partial["designs"], along)
    return xr.DataTree.from_dict(groups)


def _designs(study: Study, evaluator: Any, designs: np.ndarray, along: str) -> "xr.Dataset":
    """Numbers and outputs of some designs; with samples, the medians of the outputs."""
    import xarray as xr

    samples = samples_of(study)
    every = (designs[:, None] * samples + np.arange(samples)).ravel() if samples else designs
    outputs = evaluator.at(every)[0] if every.size else dict.fromkeys(study.outputs, np.empty(0))
    fields, known = study.fields, study.known_outputs
    first = every[:: max(samples, 1)]
    drawn = {
        name
        for dimension in study.dimensions
        if dimension.name == SAMPLE
        for name in dimension.values
    }
    seen = Designs(study, 0, outputs, every)
    dataset = xr.Dataset(attrs={"samples of each design": samples} if samples else {})
    dataset["design"] = (along, designs, {"long_name": "number of the design"})
    for name, values in study.values_at(first).items():
        if name not in drawn:
            dataset.coords[name] = (along, values, fields[name].attributes)
    for name, value in study.fixed.items():
        dataset.coords[name] = ((), value, fields[name].attributes)
    for name in study.outputs:
        values = seen.typical(name, -1.0 if less_is_better(name) else 1.0)
        dataset[name] = (along, values, known[name].attributes)
    return dataset


def _distribution(study: Study, output: str, partial: Partial) -> "xr.Dataset":
    """Quantiles, and a histogram whose outer bins reach to the least and the largest value."""
    import xarray as xr

    attributes = study.known_outputs[output].attributes
    low, high = quantiles(partial, _MOST_OF_THEM)
    # a bin holds several of the cells by which the values were counted
    cells = (high - low) / (RESOLUTION * max(abs(low), abs(high), np.finfo(float).tiny))
    bins = int(np.clip(np.nan_to_num(cells / _CELLS_IN_A_BIN), 1, _BINS))
    edges = np.linspace(low, high, bins + 1)
    edges[[0, -1]] = float(partial["least"]), float(partial["largest"])
    known = int(np.sum(partial["counts"]))
    if known == 0:
        edges, counts = np.full(2, np.nan), np.zeros(1, int)
    elif not np.all(np.diff(edges) > 0.0):  # all of one value, or nearly
        edges = np.array([np.nextafter(edges[0], -np.inf), np.nextafter(edges[-1], np.inf)])
        counts = np.array([known])
    else:
        counts = histogram(partial, edges)
    return xr.Dataset(
        {
            "quantile": ("share", quantiles(partial, SHARES), attributes),
            "count": ("bin", counts, {"long_name": "number of designs", "units": "1"}),
            "lower": ("bin", edges[:-1], attributes | {"long_name": "lower edge of the bin"}),
            "upper": ("bin", edges[1:], attributes | {"long_name": "upper edge of the bin"}),
        },
        coords={"share": ("share", np.array(SHARES), {"units": "1", "long_name": "share"})},
        attrs={
            "designs": known,
            "designs without a value": int(partial["missing"]),
            "relative resolution of quantiles": RESOLUTION,
        },
    )
