"""Sweeps over labelled arrays, which may be larger than memory where Dask holds them."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.compute.evaluation import Evaluator, Table
from lightflyer.core.checks import is_labelled
from lightflyer.core.errors import ConfigurationError
from lightflyer.design.design import AbstractDesign, Field
from lightflyer.design.outputs import outputs_of
from lightflyer.study.axes import Axis, require
from lightflyer.study.study import Dimension, Study

if TYPE_CHECKING:
    import xarray as xr


def sweep_labelled(
    design: AbstractDesign, entries: Mapping[str, Any], outputs: tuple[str, ...]
) -> "xr.Dataset":
    """Outputs over arrays that broadcast by the names of their dimensions."""
    import xarray as xr

    arrays = {name: _array(design.field(name), entry) for name, entry in entries.items()}
    found = xr.apply_ufunc(
        lambda *columns: _evaluate(design, list(arrays), columns, outputs),
        *arrays.values(),
        output_core_dims=[[] for _ in outputs],
        dask="parallelized",
        output_dtypes=[float] * len(outputs),
    )
    columns = found if isinstance(found, tuple) else (found,)
    dataset = xr.Dataset(dict(zip(outputs, columns, strict=True)))
    known_outputs = outputs_of(design.setup)
    for name, column in dataset.items():
        column.attrs = known_outputs[str(name)].attributes
    dataset = dataset.assign_coords(arrays)
    for name, array in arrays.items():
        dataset[name].attrs = array.attrs | design.field(name).attributes
    return dataset


def _array(known: Field, entry: Any) -> "xr.DataArray":
    import xarray as xr

    if is_labelled(entry):
        array: xr.DataArray = known.quantity.number(known.name, entry)
        return array if is_labelled(array) else xr.DataArray(array)
    if not isinstance(entry, Axis):
        raise ConfigurationError(f"{known.name}: a distribution cannot be combined with DataArrays")
    if entry.single:
        return xr.DataArray(float(entry.values[0]))
    return xr.DataArray(entry.values, dims=[known.name], coords={known.name: entry.values})


def _evaluate(
    design: AbstractDesign,
    names: list[str],
    columns: Sequence[np.ndarray],
    outputs: tuple[str, ...],
) -> Any:
    """Outputs of a block of designs, one for each element of the broadcast columns."""
    columns = np.broadcast_arrays(*columns)
    values: Table = {name: np.ravel(column) for name, column in zip(names, columns, strict=True)}
    for name, column in values.items():
        require(design.field(name), column)
    study = Study(design, (Dimension("design", values),), {}, outputs)
    results: Table = dict.fromkeys(outputs, columns[0])
    if columns[0].size:
        results, _ = Evaluator(study)(0, study.size)
    found = tuple(results[name].reshape(columns[0].shape) for name in outputs)
    return found if len(found) > 1 else found[0]  # xarray takes a tuple for several outputs
