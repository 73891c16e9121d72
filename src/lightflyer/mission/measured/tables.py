"""A comparison as comma-separated values."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.mission.measured.comparison import FIX

if TYPE_CHECKING:
    import xarray as xr


def write_comparison_csv(compared: Sequence["xr.Dataset"], path: Path) -> None:
    """Write a row for each fix of each track; what is not compared is empty."""
    names = [name for name, one in compared[0].items() if one.dims == (FIX,)]
    names.remove("measured_time")
    units = [f"{name} [{compared[0][name].attrs['units']}]" for name in names]
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(",".join(["track", "time [UTC]", *units]) + "\n")
        for one in compared:
            dates = np.datetime_as_string(one.measured_time.values, unit="ms")
            source = '"' + one.attrs["source"].replace('"', '""') + '"'
            numbers = np.stack([one[name].values for name in names], axis=1)
            for date, row in zip(dates, numbers, strict=True):
                cells = (f"{number:.10g}" if np.isfinite(number) else "" for number in row)
                file.write(",".join([source, f"{date}Z", *cells]) + "\n")
