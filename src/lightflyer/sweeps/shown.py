"""Units in which figures show numbers, from what a dataset says about them."""

from typing import TYPE_CHECKING

import numpy as np

from lightflyer.flight.outputs import OUTPUTS
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
        Of a sweep.

    Returns
    -------
    factor : float
    label : str
    """
    name = str(array.name)
    if name in OUTPUTS:
        return output_scale_and_label(name)
    factor, unit = _shown(unit_of(array), np.asarray(array.values, float))
    return factor, _label(str(array.attrs.get("long_name", name)), unit)


def output_scale_and_label(name: str) -> tuple[float, str]:
    """Factor and axis label with unit for an output.

    Parameters
    ----------
    name : str

    Returns
    -------
    factor : float
    label : str
    """
    if name not in OUTPUTS:
        return 1.0, name.replace("_", " ")
    factor, unit = OUTPUTS[name].shown
    return factor, _label(OUTPUTS[name].long_name, unit.replace("^2", "²"))


def _label(words: str, unit: str) -> str:
    return f"{words} [{unit}]" if unit else words


def _shown(unit: str, values: np.ndarray) -> tuple[float, str]:
    """Factor and unit that suit the largest of some values."""
    finite = np.abs(values[np.isfinite(values)])
    largest = float(finite.max(initial=0.0))
    found = 1.0, unit
    for least, factor, shown in _SCALES.get(unit, ()):
        if largest >= least:
            found = factor, shown
    return found
