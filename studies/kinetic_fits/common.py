"""What all fits of the kinetic force share: tables, polynomials, and the file of coefficients."""

import json
from collections.abc import Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.files.table import shipped_table
from lightflyer.numerics.polynomials import as_tuples, place_between

DATA = Path(__file__).parents[2] / "src" / "lightflyer" / "data"
ERROR_POWERS = [(0,), (1,), (2,)]

Coefficients = Any
"""Nested tuples, as deep as there are variables."""


def table_of(name: str, gas: str = "") -> SimpleNamespace:
    """Columns of a table that comes with the package, shape (n,) each; for one gas."""
    table = shipped_table(f"{name}.csv")
    rows = np.array(table.texts["gas"]) == gas if gas else slice(None)
    return SimpleNamespace(**{column: values[rows] for column, values in table.numbers.items()})


def some(table: SimpleNamespace, rows: np.ndarray) -> SimpleNamespace:
    """Some rows of a table."""
    return SimpleNamespace(**{name: column[rows] for name, column in vars(table).items()})


def ends_of(values: np.ndarray) -> tuple[float, float]:
    """Smallest and largest value."""
    return float(values.min()), float(values.max())


def place_in(ends: tuple[float, float], values: np.ndarray) -> np.ndarray:
    """Where among Knudsen numbers or rarefactions some are, from −1 to 1."""
    return np.asarray(place_between(np.log(values), *np.log(ends)))


def least_squares(
    values: np.ndarray,
    variables: tuple[np.ndarray, ...],
    powers: Sequence[tuple[int, ...]],
    errors: np.ndarray | float = 1.0,
) -> Coefficients:
    """Coefficients of the polynomial with these powers that fits best."""
    basis = np.stack(
        [np.prod([x**p for x, p in zip(variables, term, strict=True)], axis=0) for term in powers],
        axis=1,
    )
    weights = 1.0 / np.broadcast_to(errors, values.shape)
    fitted = np.linalg.lstsq(basis * weights[:, None], values * weights, rcond=None)[0]
    coefficients = np.zeros(np.max(powers, axis=0) + 1)
    coefficients[tuple(np.transpose(powers))] = fitted
    return as_tuples(coefficients)


def error_fit(bounds: np.ndarray, position: np.ndarray) -> Coefficients:
    """Logarithm of the largest relative standard error at each place, smoothed."""
    places = np.unique(position)
    largest = np.array([bounds[position == place].max() for place in places])
    return least_squares(np.log(largest / NORMAL_HALF_WIDTH_95), (places,), ERROR_POWERS)


def plain(fit: Any) -> Any:
    """A fit as JSON has it."""
    if is_dataclass(fit):
        names = [one.name for one in fields(fit) if one.name != "disk"]  # written once, by itself
        return {name: plain(getattr(fit, name)) for name in names}
    return [plain(one) for one in fit] if isinstance(fit, tuple) else fit


def write(fits: dict[str, dict[str, Any]]) -> None:
    """Write the file that the package reads: by the name of a fit, and by the gas."""
    lines = [
        f'"{name}": {{\n'
        + ",\n".join(f'"{gas}": {json.dumps(plain(fit))}' for gas, fit in by_gas.items())
        + "\n}"
        for name, by_gas in fits.items()
    ]
    text = "{\n" + ",\n".join(lines) + "\n}\n"
    (DATA / "kinetic_fits.json").write_text(text, encoding="utf-8")
