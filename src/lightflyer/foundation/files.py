"""Writing results: datasets with units, and files that are whole or not there."""

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.foundation.errors import OutputError
from lightflyer.prediction.prediction import AltitudePrediction, ChamberPrediction, Table

if TYPE_CHECKING:
    import xarray as xr

QUANTITIES = {
    "pressure": ("Pa", "gas pressure"),
    "gas_temperature": ("K", "gas temperature"),
    "levitation_irradiance": ("W m-2", "smallest irradiance that levitates the flyer"),
    "levitation_temperature": ("K", "flyer temperature at the levitation irradiance"),
    "temperature": ("K", "flyer temperature in the available light"),
    "lift": ("N", "photophoretic force in the available light"),
    "lift_over_weight": ("1", "lift over weight with payload"),
    "payload": ("kg", "largest payload in the available light"),
    "relative_payload": ("1", "largest payload over the flyer's own mass"),
}
"""Unit and description of each quantity of a prediction's table."""


def to_dataset(
    prediction: AltitudePrediction | ChamberPrediction, configuration: str = ""
) -> "xr.Dataset":
    """A prediction's tables as an xarray dataset.

    Parameters
    ----------
    prediction : AltitudePrediction or ChamberPrediction
    configuration : str
        The flyer file's text, kept in the attributes.

    Returns
    -------
    xarray.Dataset
        Over ``altitude`` [m] or ``pressure`` [Pa]; every variable has ``units`` and
        ``long_name``. NaN stands where no irradiance levitates the flyer.
    """
    import xarray as xr

    attributes = {
        "title": "lightflyer prediction",
        "lightflyer_version": lightflyer.__version__,
        "configuration": configuration,
    }
    if isinstance(prediction, AltitudePrediction):
        coordinate = ("altitude", "m", "geometric altitude", prediction.altitude)
    else:
        coordinate = ("pressure", "Pa", "gas pressure", prediction.pressure)
    dimension, units, long_name, values = coordinate
    dataset = xr.Dataset(_variables(dimension, prediction.table), attrs=attributes)
    dataset.coords[dimension] = (dimension, values, {"units": units, "long_name": long_name})
    if isinstance(prediction, ChamberPrediction):
        _add_map(dataset, prediction)
    return dataset


def _variables(dimension: str, table: Table) -> dict[str, Any]:
    return {
        name: (
            dimension,
            np.where(np.isfinite(table[name]), table[name], np.nan),
            {"units": units, "long_name": long_name},
        )
        for name, (units, long_name) in QUANTITIES.items()
        if name != dimension
    }


def _add_map(dataset: "xr.Dataset", prediction: ChamberPrediction) -> None:
    axes = {
        "map_pressure": ("Pa", "gas pressure", prediction.map_pressure),
        "map_irradiance": ("W m-2", "irradiance", prediction.map_irradiance),
    }
    for name, (units, long_name, values) in axes.items():
        dataset.coords[name] = (name, values, {"units": units, "long_name": long_name})
    dataset["map_temperature"] = (
        tuple(axes),
        prediction.map_temperature,
        {"units": "K", "long_name": "flyer temperature"},
    )


@contextmanager
def output_directory(directory: Path) -> Iterator[Callable[[str], Path]]:
    """Write several files into a directory, all of them or none.

    Parameters
    ----------
    directory : Path
        Made if it does not exist.

    Yields
    ------
    callable
        Takes a final file name, which may lie in a subfolder, returns the temporary path to
        write. When the block ends without an error each file is renamed to its final name;
        otherwise all are removed.

    Raises
    ------
    OutputError
        If the directory cannot be made or written.
    """
    made = not directory.exists()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        staging = tempfile.TemporaryDirectory(prefix=".lightflyer-", dir=directory)
    except OSError as error:
        raise OutputError(f"{directory}: cannot be written: {error.strerror}") from None
    names: list[str] = []

    def stage(name: str) -> Path:
        names.append(name)
        path = Path(staging.name) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    finished = False
    try:
        with staging:
            yield stage
            for name in names:
                (directory / name).parent.mkdir(exist_ok=True)
                os.replace(Path(staging.name) / name, directory / name)
        finished = True
    except OSError as error:
        raise OutputError(f"{directory}: cannot be written: {error.strerror or error}") from None
    finally:
        if made and not finished and directory.exists() and not any(directory.iterdir()):
            directory.rmdir()


def write_csv(prediction: AltitudePrediction | ChamberPrediction, path: Path) -> None:
    """Write a prediction's table as comma-separated values with units in the header.

    Parameters
    ----------
    prediction : AltitudePrediction or ChamberPrediction
    path : Path
    """
    columns = {
        f"{name} [{units}]": prediction.table[name] for name, (units, _) in QUANTITIES.items()
    }
    if isinstance(prediction, AltitudePrediction):
        columns = {"altitude [m]": prediction.altitude, **columns}
    np.savetxt(
        path,
        np.stack(list(columns.values()), axis=1),
        fmt="%.10g",
        delimiter=",",
        header=",".join(columns),
        comments="",
    )
