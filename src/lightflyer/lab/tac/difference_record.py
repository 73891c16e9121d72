"""Records of the difference of two faces: the dataset and the tables."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.lab.tac.difference import TacDifference
from lightflyer.lab.tac.record import tables, to_dataset

if TYPE_CHECKING:
    import xarray as xr


def difference_dataset(found: TacDifference, warnings: Sequence[str] | None = None) -> "xr.Dataset":
    """Rows of all runs, with the coefficients of both faces and their covariance."""
    record = to_dataset(found.fits, found.warnings if warnings is None else warnings)
    names = np.array(["top"] * len(found.top) + ["bottom"] * len(found.bottom))
    pair = found.tac_top, found.tac_bottom
    spread = np.array([one.uncertainty or 0.0 for one in pair])
    related = np.array([[1.0, found.tac_correlation], [found.tac_correlation, 1.0]])
    unit = {"units": "1"}
    return record.assign(
        face_of_row=("row", names[record["run"].values], {"long_name": "face of the sample"}),
        tac=("face", [one.value for one in pair], unit | {"long_name": "TAC"}),
        tac_covariance=(
            ("face", "other_face"), np.outer(spread, spread) * related,
            unit | {"long_name": "covariance of the errors of both TACs"},
        ),
        tac_difference=(
            (), found.difference.value, unit | {"long_name": "TAC of the top less of the bottom"}
        ),
        tac_difference_uncertainty=(
            (), found.difference.uncertainty,
            unit | {"long_name": "its standard uncertainty"},
        ),
    ).assign_coords(face=["top", "bottom"], other_face=["top", "bottom"])  # fmt: skip


def difference_tables(found: TacDifference) -> dict[str, str]:
    """Fitted rows of each run, and the coefficients with their difference, as CSV by file name."""
    pair = found.tac_top, found.tac_bottom, found.difference
    lines = [f"# correlation of the errors of both TACs: {found.tac_correlation:.6g}"]
    lines.append("quantity,value,lower 95 %,upper 95 %,standard uncertainty")
    for name, one in zip(("tac_top", "tac_bottom", "difference"), pair, strict=True):
        numbers = one.value, *one.interval, one.uncertainty or 0.0
        lines.append(",".join([name, *(f"{number:.8g}" for number in numbers)]))
    return tables(found.fits) | {"tac-difference.csv": "\n".join(lines) + "\n"}
