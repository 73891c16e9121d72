"""The solver's tables of kinetic force and heat; studies/kinetic_table makes them."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.files.table import shipped_table

GASES = ("monatomic", "diatomic")


@dataclass(frozen=True)
class Table:
    """The solver's results for one gas, a row each."""

    knudsen: np.ndarray  # λ(T_c)/(2r) [1], shape (n,)
    # T_h/T_c [1]; 1 stands for the limit of small differences, shape (n,)
    temperature_ratio: np.ndarray
    tac: np.ndarray  # Mean TAC of the faces and their difference [1], shape (n,)
    tac_difference: np.ndarray
    viscosity_exponent: np.ndarray  # ω of µ ∝ T^ω [1], shape (n,)
    # Over the free-molecular values at Maxwell walls, the heat of both faces together [1], shape
    # (n,)
    force_ratio: np.ndarray
    heat_ratio: np.ndarray
    # Absolute 95 % bounds of the error of solver and fit together [1], shape (n,)
    force_ratio_error: np.ndarray
    heat_ratio_error: np.ndarray


@dataclass(frozen=True)
class WallTable:
    """Effect of a chamber's walls on the linear problem, for one gas, a row each."""

    # shape (n,); knudsen number and distance of the wall in radii of the disk [1]
    knudsen: np.ndarray
    boundary: np.ndarray
    force_factor: np.ndarray  # shape (n,); over the values in open space, at a mean TAC of 0.85 [1]
    heat_factor: np.ndarray


@lru_cache
def kinetic_table(gas: str = "diatomic") -> Table:
    """The solver's table for a gas."""
    return Table(**_columns("kinetic.csv", gas))


@lru_cache
def wall_table(gas: str = "diatomic") -> WallTable:
    """The solver's table of the effect of walls for a gas; see :func:`kinetic_table`."""
    return WallTable(**_columns("kinetic_boundary.csv", gas))


def _columns(name: str, gas: str) -> dict[str, np.ndarray]:
    if gas not in GASES:
        raise ParameterError(f"gas = {gas!r} is not one of {', '.join(GASES)}")
    table = shipped_table(name)
    kept = np.array(table.texts["gas"]) == gas
    return {column: values[kept] for column, values in table.numbers.items()}
