"""Sweeps over labelled arrays, which may be larger than memory where Dask holds them."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.config.sections import FlyerFile
from lightflyer.flight.fields import Field, field
from lightflyer.flight.outputs import OUTPUTS, check_outputs
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.sweeps.axes import Axis, read_entry, require
from lightflyer.sweeps.evaluation import Evaluator, Table
from lightflyer.sweeps.study import Dimension, Study

if TYPE_CHECKING:
    import xarray as xr


def sweep_labelled(
    configuration: FlyerFile, over: Mapping[str, Any], variables: Sequence[str]
) -> "xr.Dataset":
    """Outputs over arrays that broadcast by the names of their dimensions.

    Parameters
    ----------
    configuration : FlyerFile
    over : dict of str to object
        :class:`xarray.DataArray` in the units of the fields (SI, angles in degrees), backed by
        NumPy or Dask; or a value, list or range, which gets a dimension of its own.
    variables : sequence of str

    Returns
    -------
    xarray.Dataset
        Backed by Dask where an input is.

    Raises
    ------
    ConfigurationError
        If a field or an output does not exist or a value is not possible.
    """
    import xarray as xr

    known = {name: field(configuration, name) for name in over}
    arrays = {name: _array(entry, known[name]) for name, entry in over.items()}
    # looks up the outputs and what they need, as for any study
    check_outputs(variables, configuration, list(over))
    found = xr.apply_ufunc(
        lambda *columns: _evaluate(configuration, known, columns, tuple(variables)),
        *arrays.values(),
        output_core_dims=[[] for _ in variables],
        dask="parallelized",
        output_dtypes=[float] * len(variables),
    )
    columns = found if isinstance(found, tuple) else (found,)
    dataset = xr.Dataset(dict(zip(variables, columns, strict=True)))
    for name, column in dataset.items():
        column.attrs = OUTPUTS[str(name)].attributes
    dataset = dataset.assign_coords(arrays)
    for name, array in arrays.items():
        dataset[name].attrs = array.attrs | known[name].attributes
    return dataset


def _array(entry: Any, known: Field) -> "xr.DataArray":
    import xarray as xr

    if isinstance(entry, xr.DataArray):
        return entry
    axis = read_entry(entry, known)
    if not isinstance(axis, Axis):
        raise ConfigurationError(f"{known.name}: a distribution does not mix with DataArrays")
    if axis.single:
        return xr.DataArray(float(axis.values[0]))
    return xr.DataArray(axis.values, dims=[known.name], coords={known.name: axis.values})


def _evaluate(
    configuration: FlyerFile,
    known: Mapping[str, Field],
    columns: Sequence[np.ndarray],
    variables: tuple[str, ...],
) -> tuple[np.ndarray, ...]:
    """Outputs of a block of designs, one for each element of the broadcast columns."""
    columns = np.broadcast_arrays(*columns)
    values: Table = {name: np.ravel(column) for name, column in zip(known, columns, strict=True)}
    for name, column in values.items():
        require(known[name], column)
    study = Study(configuration, (Dimension("design", values),), {}, variables, dict(known))
    if not columns[0].size:
        return tuple(np.empty(columns[0].shape) for _ in variables)
    results, _ = Evaluator(study)(0, study.size)
    return tuple(results[name].reshape(columns[0].shape) for name in variables)
