"""A mission, and the ends of its flights, as comma-separated values."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.mission.report.dataset import ELAPSED, ENDS, SEVERAL, ends_of

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


def has_several(dataset: "xr.Dataset") -> bool:
    """Whether there are flights beside that of the flyer as it is stated."""
    return any(f"{prefix}end_reason" in dataset for prefix, _ in SEVERAL)


def write_ends_csv(dataset: "xr.Dataset", path: Path) -> None:
    """Write how each flight ended: of the flyer as it is stated, each member and each launch."""
    below = [str(name) for name in dataset if str(name).startswith("below_")]
    names = [*(name for name in ENDS if name != "end_reason"), *below]
    units = [f"{name} [{dataset[name].attrs['units']}]" for name in names]
    lines = [",".join(["flight", "number", *units, "end_reason"])]
    for flight, number, end in ends_of(dataset):
        cells = [_FORMAT % end[name] for name in names]
        which = "" if number is None else str(number)
        lines.append(",".join([flight, which, *cells, end["end_reason"]]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")
