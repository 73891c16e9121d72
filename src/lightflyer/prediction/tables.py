"""A prediction as a dataset with units, and as comma-separated values."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.core.units import dataset_unit
from lightflyer.design.outputs import outputs_of

if TYPE_CHECKING:
    import xarray as xr

    from lightflyer.prediction.prediction import Prediction


def to_dataset(prediction: "Prediction", configuration: str = "") -> "xr.Dataset":
    """A prediction's tables as an xarray dataset.

    Parameters
    ----------
    prediction : Prediction
    configuration : str
        The flyer file's text, kept in the attributes.

    Returns
    -------
    xarray.Dataset
        Over ``altitude`` [m] or ``pressure`` [Pa]; every variable has ``units`` and
        ``long_name``. NaN stands where no irradiance levitates the flyer.
    """
    import xarray as xr

    coords, variables, attributes = columns(prediction, configuration)
    return xr.Dataset(variables, coords, attributes)


def columns(
    prediction: "Prediction", configuration: str = ""
) -> tuple[dict[str, Any], dict[str, Any], dict[str, str]]:
    """Coordinates, variables and attributes of that dataset."""
    where, known = prediction.coordinate, outputs_of(prediction.setup)
    variables: dict[str, Any] = {
        name: (
            where.name,
            np.where(np.isfinite(values), values, np.nan),
            known[name].attributes,
        )
        for name, values in prediction.table.items()
        if name != where.name
    }
    attributes = {
        "title": "lightflyer prediction",
        "lightflyer_version": lightflyer.__version__,
        "flyer": prediction.setup.flyer.describe(),
        "force_model": type(prediction.setup.model).__name__,
        "assumptions": "; ".join(prediction.assumptions),
        "warnings": "; ".join(prediction.warnings),
        "configuration": configuration,
    }
    about = {"units": dataset_unit(where.unit), "long_name": where.long_name}
    coords: dict[str, Any] = {where.name: (where.name, prediction.coordinates, about)}
    if (found := prediction.map) is not None:
        axes = {
            f"map_{where.name}": (dataset_unit(where.unit), where.long_name, found.coordinate),
            "map_irradiance": ("W m-2", "irradiance", found.irradiance),
        }
        for name, (units, long_name, values) in axes.items():
            coords[name] = (name, values, {"units": units, "long_name": long_name})
        about = {"units": "K", "long_name": "flyer temperature"}
        variables["map_temperature"] = (tuple(axes), found.temperature, about)
    return coords, variables, attributes


def write_csv(prediction: "Prediction", path: Path) -> None:
    """Write a prediction's table as comma-separated values with units in the header.

    Parameters
    ----------
    prediction : Prediction
    path : Path
    """
    where, known = prediction.coordinate, outputs_of(prediction.setup)
    columns = {f"{where.name} [{dataset_unit(where.unit)}]": prediction.coordinates}
    for name, values in prediction.table.items():
        columns[f"{name} [{known[name].attributes['units']}]"] = values
    np.savetxt(
        path,
        np.stack(list(columns.values()), axis=1),
        fmt="%.10g",
        delimiter=",",
        header=",".join(columns),
        comments="",
    )
