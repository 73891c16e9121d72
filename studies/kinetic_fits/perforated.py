"""Fit of the perforated disk within a reservoir, to the table of studies/schafer2025_table."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from kinetic_fits.common import table_of

from lightflyer.force.membranes.sandwich import FREE_FORCE, PerforatedDiskFit
from lightflyer.numerics.interpolation import Curves

_BEYOND = 2.0  # factor of δ within which the coefficients level off below and above the table
_NOISE = 0.005  # relative scatter of the table, which weighs it against ridges of one
_STEPS = 30  # of Gauss and Newton; five suffice


@dataclass(frozen=True)
class PerforatedDiskTable:
    """The solutions, a row for each open fraction and a column for each rarefaction."""

    open_fraction: np.ndarray  # shape (m,)
    rarefaction: np.ndarray  # shape (n,)
    force_ratio: np.ndarray  # shape (m, n); over the force of free molecules [1]
    # shape (m, n); heat loss over that to free molecules, of two equally hot faces and of two faces
    # that are as hot as they are cold [1]
    common_ratio: np.ndarray
    difference_ratio: np.ndarray


def perforated_disk_table() -> PerforatedDiskTable:
    """The table that comes with the package."""
    numbers = vars(table_of("perforated_disk"))
    open_fraction, rarefaction = np.unique(numbers["beta"]), np.unique(numbers["delta"])
    shape = (open_fraction.size, rarefaction.size)
    force, cross, own = (
        numbers[name].reshape(shape) for name in ("force", "heat_top", "heat_bottom")
    )
    solid = 1.0 - open_fraction[:, None]
    free_heat = solid / np.sqrt(np.pi)
    return PerforatedDiskTable(
        open_fraction,
        rarefaction,
        force / (solid * FREE_FORCE),
        (own + cross) / free_heat,
        (own - cross) / free_heat,
    )


def fit(table: PerforatedDiskTable, kept: np.ndarray | None = None) -> PerforatedDiskFit:
    """Smooth functions through a table; ``kept`` (m, n)."""
    kept = np.ones(table.force_ratio.shape, bool) if kept is None else kept
    columns = [_fit_column(table, index, kept[:, index]) for index in range(kept.shape[1])]
    values, position = np.array(columns), np.log(table.rarefaction)
    # beyond the table: half of the last slope, then level
    step = np.log(_BEYOND)
    secants = np.diff(values, axis=0) / np.diff(position)[:, None]
    before, after = values[0] - 0.5 * step * secants[0], values[-1] + 0.5 * step * secants[-1]
    knots = np.concatenate([[position[0] - step], position, [position[-1] + step]])
    values = np.vstack([before, values, after])
    return PerforatedDiskFit(
        Curves.through(knots, values[:, :2]), Curves.through(knots, values[:, 2:])
    )


def _fit_column(table: PerforatedDiskTable, index: int, kept: np.ndarray) -> np.ndarray:
    """Coefficients at one rarefaction."""
    beta, delta = table.open_fraction[kept], table.rarefaction[index]
    force, common, difference = (
        ratio[kept, index]
        for ratio in (table.force_ratio, table.common_ratio, table.difference_ratio)
    )
    solid, powers = 1.0 - beta, np.stack([np.ones_like(beta), beta, beta**2], axis=1)

    def force_of(yielding: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        ratio = yielding / (yielding + solid * delta)
        return ratio, (1.0 - ratio) / yielding

    def common_of(conduction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        back = 1.0 / (solid + conduction / delta)
        ratio = 1.0 - solid * back
        return ratio, solid * back**2 / (delta * ratio)

    def difference_of(back: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        ratio = 1.0 - solid * back
        return ratio, -solid / ratio

    through = np.stack([np.ones_like(beta), beta / (1.0 + beta)], axis=1)
    edge, flow = _least_squares(force_of, through, force, _start(force, delta))
    conduction = _least_squares(common_of, powers, common, _start(common, delta))
    back = _least_squares(
        difference_of, powers, difference, 1.0 / (1.0 + _start(difference, delta) / delta)
    )
    return np.array(
        [np.log(edge), flow, *conduction, delta * (1.0 / back[0] - 1.0), *(back[1:] / back[0])]
    )


def _start(ratio: np.ndarray, delta: float) -> float:
    return float(delta * ratio[0] / (1.0 - ratio[0]))


def _least_squares(
    model: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    basis: np.ndarray,
    ratio: np.ndarray,
    start: float,
) -> Any:
    """Coefficients of a linear predictor by Gauss and Newton."""
    # Relative deviations count, and with little weight the size of all coefficients but the first:
    # where the table is noise they are zero.
    size = basis.shape[1]
    coefficients = np.concatenate([[start], np.zeros(size - 1)])
    ridge = np.eye(size)[1:]
    for _ in range(_STEPS):
        value, slope = model(basis @ coefficients)
        rows = np.vstack([slope[:, None] * basis / _NOISE, ridge])
        missing = np.concatenate([np.log(ratio / value) / _NOISE, -coefficients[1:]])
        coefficients = coefficients + np.linalg.lstsq(rows, missing, rcond=None)[0]
    return coefficients
