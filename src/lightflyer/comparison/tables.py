"""A comparison as a dataset with units, and as comma-separated values."""

import csv
import json
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import cell_text
from lightflyer.core.units import dataset_unit
from lightflyer.design.outputs import Output, outputs_of
from lightflyer.design.setup import Setup

if TYPE_CHECKING:
    import xarray as xr

    from lightflyer.comparison.comparison import Comparison

_FLYER = "flyer"
_OR = "; or "  # between what one name stands for


def to_dataset(comparison: "Comparison") -> "xr.Dataset":
    """A comparison's tables as an xarray dataset.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    xarray.Dataset
        Over ``flyer`` and ``altitude`` [m] or ``pressure`` [Pa]. Every variable has ``units`` and
        ``long_name``; ``..._low`` and ``..._high`` are the ends of 95 % bands. NaN stands for what
        a flyer does not have, and where no irradiance levitates it.
    """
    import xarray as xr

    where = comparison.coordinate
    dims = (_FLYER, where.name)
    variables: dict[str, Any] = {}
    for name, (output, low, values, high) in _columns(comparison).items():
        variables[name] = (dims, values, output.attributes)
        for end, column in (("low", low), ("high", high)):
            if column is not None:
                long_name = f"{output.long_name}, {end} end of the 95 % band"
                about = output.attributes | {"long_name": long_name}
                variables[f"{name}_{end}"] = (dims, column, about)
    flyers = comparison.flyers
    return xr.Dataset(
        variables,
        coords={
            _FLYER: [found.name for found in flyers],
            where.name: (
                where.name,
                comparison.coordinates,
                {"units": dataset_unit(where.unit), "long_name": where.long_name},
            ),
            "description": (_FLYER, [found.description for found in flyers]),
        },
        attrs={
            "title": "lightflyer comparison",
            "lightflyer_version": lightflyer.__version__,
            "warnings": "; ".join(comparison.warnings),
            "summary": json.dumps(comparison.summary(), allow_nan=False),
        },
    )


def write_csv(comparison: "Comparison", path: Path) -> None:
    """Write a comparison's tables as comma-separated values, one row a flyer and coordinate.

    Parameters
    ----------
    comparison : Comparison
    path : Path
        The header has units, in brackets. A cell is empty where there is no number.
    """
    where, columns = comparison.coordinate, _columns(comparison)
    header = [_FLYER, f"{where.name} [{dataset_unit(where.unit)}]"]
    stacks: list[np.ndarray] = []
    for name, (output, low, values, high) in columns.items():
        unit = output.attributes["units"]
        for ending, column in (("", values), ("_low", low), ("_high", high)):
            if column is not None:
                header.append(f"{name}{ending} [{unit}]")
                stacks.append(column)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row, found in enumerate(comparison.flyers):
            for place, coordinate in enumerate(comparison.coordinates):
                numbers = (float(stack[row, place]) for stack in stacks)
                writer.writerow([cell_text(found.name), f"{coordinate:.10g}", *map(_cell, numbers)])


def _cell(number: float) -> str:
    return f"{number:.10g}" if np.isfinite(number) else ""


def _columns(
    comparison: "Comparison",
) -> dict[str, tuple[Output, np.ndarray | None, np.ndarray, np.ndarray | None]]:
    """Output, low end, values and high end, each of shape (flyers, n), by name."""
    found = {}
    for name, output in _outputs(comparison).items():
        rows = [_row(flyer.table, name, comparison) for flyer in comparison.flyers]
        bands = [flyer.band(name) for flyer in comparison.flyers]
        low = high = None
        if any(band is not None for band in bands):
            missing = np.full_like(comparison.coordinates, np.nan)
            low, high = (
                np.stack([missing if band is None else band[end] for band in bands])
                for end in (0, 1)
            )
        found[name] = (output, low, np.stack(rows), high)
    return found


def _row(table: dict[str, np.ndarray], name: str, comparison: "Comparison") -> np.ndarray:
    values = table.get(name, np.full_like(comparison.coordinates, np.nan))
    return np.where(np.isfinite(values), values, np.nan)


def _outputs(comparison: "Comparison") -> dict[str, Output]:
    """Outputs that any of the flyers has, but for the coordinate."""
    found: dict[str, Output] = {}
    for flyer in comparison.flyers:
        known = outputs_of(flyer.setup)
        for name in flyer.table:
            found[name] = join_outputs(found.get(name, known[name]), known[name])
    found.pop(comparison.coordinate.name, None)
    return found


def join_outputs(one: Output, other: Output) -> Output:
    """Two flyers' output of one name: it may be another thing for each, in the same unit."""
    if one.unit != other.unit:
        raise ConfigurationError(
            f'"{one.name}" is {one.long_name} [{one.unit or "1"}] of one flyer and '
            f"{other.long_name} [{other.unit or '1'}] of another; they cannot be compared"
        )
    if other.long_name in one.long_name.split(_OR):
        return one
    return replace(one, long_name=f"{one.long_name}{_OR}{other.long_name}")


def require_comparable(setups: Iterable[Setup]) -> None:
    """Raise :class:`ConfigurationError` where an output is in another unit for another flyer."""
    found: dict[str, Output] = {}
    for setup in setups:
        for name, output in outputs_of(setup).items():
            found[name] = join_outputs(found.get(name, output), output)
