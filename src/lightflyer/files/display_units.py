"""Units in which figures and tables show numbers: those that suit their size."""

from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.checks import is_concrete
from lightflyer.core.units import dataset_unit, file_unit, scale_and_offset

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
    "s": ((0.0, 1.0, "s"), (3600.0, 1.0 / 3600.0, "h")),
    "degree": ((0.0, 1.0, "°"),),
}
"""By the unit of a dataset: from which largest value on, which factor leads to which unit."""

_SHOWN_NUMBERS = 8  # of an array; a longer one is shown by its ends
_FACES = ("top", "bottom")
_SHORT = {"tac": "TAC"}


def in_words(name: str) -> str:
    """Name of a number of a design, as figures say it; ``name``: dotted."""
    *where, last = name.split(".")
    if len(where) > 1 and where[0] == "flyer":
        where = where[1:]  # its film needs no owner
    words = last.replace("_", " ").split()
    face = f", {words.pop()}" if len(words) > 1 and words[-1] in _FACES else ""
    words = [_SHORT.get(word, word) for word in words]
    return " ".join([*(part.replace("_", " ") for part in where), *words]) + face


def unit_of(array: "xr.DataArray") -> str:
    """Units of an array, empty for a pure number."""
    unit = str(array.attrs.get("units", ""))
    return "" if unit == "1" else unit


def scale_and_label(array: "xr.DataArray") -> tuple[float, str]:
    """Factor and axis label with unit for a coordinate or an output."""
    name, unit, shown = str(array.name), unit_of(array), str(array.attrs.get("shown_units", ""))
    if shown:
        factor, unit = scale_and_offset(file_unit(unit), shown)[0], shown.replace("^2", "²")
    elif unit in _SCALES:
        factor, unit = _suitable(unit, np.asarray(array.values, float))
    else:
        factor = 1.0
    words = in_words(name) if "." in name else str(array.attrs.get("long_name", name))
    return factor, f"{words} [{unit}]" if unit else words


def suitable(unit: str, values: Any) -> tuple[float, str]:
    """Factor and unit that suit some values; returns ``factor``, ``unit``."""
    spelled = dataset_unit(unit)
    if spelled in _SCALES:
        return _suitable(spelled, np.asarray(values, float))
    return 1.0, file_unit(unit).replace("^2", "²").replace("^3", "³")


def amount(value: float, unit: str, digits: int = 6) -> str:
    """A number with the unit that suits it; ``unit``: SI unit; ``digits``: significant digits."""
    factor, shown = suitable(unit, value)
    return f"{value * factor:.{digits}g} {shown}".rstrip()


def number_text(values: Any, unit: str) -> str:
    """A number, or an array by its ends, with its unit; what is traced as JAX has it."""
    if not is_concrete(values):
        return f"{values} {unit}"
    text = np.array2string(
        np.asarray(values), threshold=_SHOWN_NUMBERS, formatter={"float_kind": "{:.6g}".format}
    )
    return f"{text} {unit}".rstrip()


def _suitable(unit: str, values: np.ndarray) -> tuple[float, str]:
    """Factor and unit that suit the largest of some values."""
    finite = np.abs(values[np.isfinite(values)])
    largest = float(finite.max(initial=0.0))
    suitable = [(factor, shown) for least, factor, shown in _SCALES[unit] if largest >= least]
    return suitable[-1]
