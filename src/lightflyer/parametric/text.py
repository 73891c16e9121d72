"""Maps of a sweep in words: the best design, and the best at each place of an axis."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.files.display_units import scale_and_label
from lightflyer.files.result_text import table_of
from lightflyer.parametric.explore import (
    best_design,
    less_is_better,
    margin_of_most,
    over_samples,
)
from lightflyer.study.axes import SAMPLE

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

_ROWS = 12


def map_parts(dataset: "xr.Dataset", fields: list[str], output: str) -> "tuple[str, Table]":
    """The best design that is drawn, and the best at some values of the first field."""
    # ``dataset``: with one or two fields that are not fixed, as it is drawn
    best, word = best_design(dataset, output), "least" if less_is_better(output) else "largest"
    able, values = margin_of_most(dataset), dataset[output]
    if SAMPLE in values.dims:
        values = over_samples(values)["median"]
    values = values.where(np.isfinite(values))
    flying = values if able is None else values.where(able >= 0.0)
    finding = f"no design has a {output}"
    if best is not None:
        where = {name: best.where[name] for name in fields}
        finding = f"{word} {output}: {replace(best, where=where)}"
    if best is not None and not bool(flying.notnull().any()):
        finding = f"no design flies; {finding}"
    x, *others = fields
    places = np.linspace(0, flying.sizes[x] - 1, min(_ROWS, flying.sizes[x])).round().astype(int)
    flying = flying.isel({x: places})
    columns = [flying[x]]
    for y in others:
        columns.append(flying.idxmin(y) if less_is_better(output) else flying.idxmax(y))
        columns[-1].attrs, columns[-1].name = dataset[y].attrs, y
        flying = flying.min(y) if less_is_better(output) else flying.max(y)
    flying.attrs = dataset[output].attrs
    scales, headings = zip(*map(scale_and_label, [*columns, flying]), strict=True)
    rows = (
        [_cell(scale * value) for scale, value in zip(scales, row, strict=True)]
        for row in zip(*(part.values for part in [*columns, flying]), strict=True)
    )
    return finding, table_of(headings, rows, left=(), collapse_padding=True, pad_edge=False)


def _cell(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else "–"
