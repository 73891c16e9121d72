"""A mission as comma-separated values."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.mission.report.dataset import ELAPSED

if TYPE_CHECKING:
    import xarray as xr

_FORMAT = "%.10g"


def write_csv(dataset: "xr.Dataset", path: Path) -> None:
    """Write the flight of the flyer as it is stated, a row for each moment until its end."""
    known = np.isfinite(dataset.altitude.values)
    names = [name for name, value in dataset.items() if value.dims == (ELAPSED,)]
    dates = np.datetime_as_string(dataset.time.values[known], unit="ms")
    columns = {ELAPSED: dataset[ELAPSED], **{str(name): dataset[name] for name in names}}
    header = ",".join(
        ["time [UTC]", *(f"{name} [{value.attrs['units']}]" for name, value in columns.items())]
    )
    numbers = np.stack([value.values[known] for value in columns.values()], axis=1)
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(f"{header}\n")
        for date, row in zip(dates, numbers, strict=True):
            file.write(f"{date}Z,{','.join(_FORMAT % number for number in row)}\n")
