"""The best of a sweep's designs, found without holding all of them."""

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

_AT_ONCE = 2**22  # numbers read at a time


def best_design(
    dataset: "xr.Dataset", name: str, *, least: bool = False
) -> tuple[float, str, list[tuple[str, float, str]]] | None:
    """Largest or least value of an output, and where it is.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of a sweep.
    name : str
        Of the output.
    least : bool
        Whether the least is wanted.

    Returns
    -------
    value : float
    units : str
    where : list of (str, float, str)
        Name, value and units of each coordinate.
        All of it None where the output is NaN everywhere.
    """
    array = dataset[name]
    sign = -1.0 if least else 1.0
    best: tuple[float, tuple[int, ...]] | None = None
    rows = max(1, _AT_ONCE // max(1, int(np.prod(array.shape[1:])))) if array.ndim else 1
    for start in range(0, array.shape[0] if array.ndim else 1, rows):
        part = np.asarray(array[start : start + rows] if array.ndim else array)
        score = np.where(np.isnan(part), -np.inf, sign * part)
        place = np.unravel_index(int(np.argmax(score)), part.shape)
        if np.isfinite(score[place]) and (best is None or score[place] > best[0]):
            first = (int(place[0]) + start, *map(int, place[1:])) if array.ndim else ()
            best = float(score[place]), first
    if best is None:
        return None
    score_found, place_found = best
    there = array.isel(dict(zip(array.dims, place_found, strict=True)))
    order = [*array.dims, *(name for name in there.coords if name not in array.dims)]
    where = [
        (str(name), float(there.coords[name]), _unit(there.coords[name]))
        for name in order
        if name in there.coords
    ]
    return sign * score_found, _unit(array), where


def _unit(array: "xr.DataArray") -> str:
    unit = str(array.attrs.get("units", ""))
    return "" if unit == "1" else unit
