"""Units in which figures show numbers, from what a dataset says about them."""

from typing import TYPE_CHECKING

import numpy as np

from lightflyer.foundation.units import file_unit, scale_and_offset
from lightflyer.sweeps.explore import unit_of

if TYPE_CHECKING:
    import xarray as xr

_SCALES = {
    "m": (
        (0.0, 1e9, "nm"),
        (1e-5, 1e6, "µm"),
        (1e-3, 1e2, "cm"),
        (1.0, 1.0, "m"),
        (1e3, 1e-3, "km"),
    ),
    "kg": ((0.0, 1e6, "mg"), (1e-2, 1e3, "g"), (1.0, 1.0, "kg")),
    "N": ((0.0, 1e6, "µN"), (1e-2, 1e3, "mN"), (1.0, 1.0, "N")),
    "kg m-2": ((0.0, 1e3, "g/m²"), (1.0, 1.0, "kg/m²")),
    "W m-2": ((0.0, 1.0, "W/m²"),),
    "degree": ((0.0, 1.0, "°"),),
}
"""By the unit of a dataset: from which largest value on, which factor leads to which unit."""


def scale_and_label(array: "xr.DataArray") -> tuple[float, str]:
    """Factor and axis label with unit for a coordinate or an output.

    Parameters
    ----------
    array : xarray.DataArray
        With ``units`` and ``long_name``.

    Returns
    -------
    factor : float
    label : str
    """
    name, unit, shown = str(array.name), unit_of(array), str(array.attrs.get("shown_units", ""))
    if shown:
        factor, unit = scale_and_offset(file_unit(unit), shown)[0], shown.replace("^2", "²")
    elif unit in _SCALES:
        factor, unit = _shown(unit, np.asarray(array.values, float))
    else:
        factor = 1.0
    words = str(array.attrs.get("long_name", name))
    return factor, f"{words} [{unit}]" if unit else words


def _shown(unit: str, values: np.ndarray) -> tuple[float, str]:
    """Factor and unit that suit the largest of some values."""
    finite = np.abs(values[np.isfinite(values)])
    largest = float(finite.max(initial=0.0))
    suitable = [(factor, shown) for least, factor, shown in _SCALES[unit] if largest >= least]
    return suitable[-1]
