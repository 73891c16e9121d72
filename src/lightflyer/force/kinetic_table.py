r"""The solver's table of kinetic force and heat, as smooth functions.

The table gives, over Knudsen number, temperature ratio and mean TAC, what fraction of their
free-molecular values the force and the heat loss of a thin disk are. Both fractions fall from one
as the gas gets denser. What is fitted by polynomials is how much resistance the gas adds, times
the Knudsen number,

.. math::
    \ln\left[\left(\frac{1}{\hat F}-1\right)\mathrm{Kn}\right], \qquad
    \ln\left[\left(\frac{1}{\hat Q}-1\right)\frac{\mathrm{Kn}}{\bar\alpha}\right]

because these vary slowly and tend to constants at both ends (the force's to a power law where the
gas is dense), so they can be continued beyond the table.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.foundation.constants import NORMAL_HALF_WIDTH_95
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.table import shipped_table
from lightflyer.foundation.types import Numeric

GASES = ("monatomic", "diatomic")

# powers of heating, TAC and Knudsen number: many for the limit of small differences, few for what
# changes with them
_LIMIT_POWERS = [(0, tac, knudsen) for tac in range(3) for knudsen in range(9)]
_HEATING_POWERS = [
    (heating, tac, knudsen) for heating in (1, 2) for tac in range(3) for knudsen in range(6)
]
_POWERS = _LIMIT_POWERS + _HEATING_POWERS
_WALL_POWERS = [(nearness, knudsen) for nearness in range(4) for knudsen in range(6)]
_ERROR_POWERS = [(0,), (1,), (2,)]
# errors that weigh the rows, in what is fitted: bounds are smooth, not noise, so that even a row
# with a large one says how its neighbours go on
_WEIGHTS = (3e-3, 2e-2)
COLLISION_ERROR = 0.165
"""Relative standard error of what collisions take from the force, 1/F̂ − 1, by the kinetic equation
beside full collision dynamics: half of the largest deviation from the direct simulations of
docs/kinetic.md. All of them agree with the table within two of these and their own noise."""

HEAT_EQUATION_ERROR = 0.0035
"""Relative standard error of the heat ratio by the kinetic equation, likewise."""

_STEEPEST = (-1.5, 0.0)  # slopes of the force's function that are believed below the table
_COLDEST = -0.3  # (T_h − T_c)/T_h down to which the fit's curve in temperature is continued


@dataclass(frozen=True)
class Table:
    r"""The solver's results for one gas, a row each.

    Attributes
    ----------
    knudsen : array, shape (n,)
        :math:`\lambda(T_c)/(2r)` [1].
    temperature_ratio : array, shape (n,)
        :math:`T_h/T_c` [1]; 1 stands for the limit of small differences.
    tac : array, shape (n,)
        Mean TAC of the faces [1].
    force_ratio, heat_ratio : array, shape (n,)
        Over the free-molecular values at Maxwell walls [1].
    heat_ratio_slope : array, shape (n,)
        Difference of the faces' heat ratios, top minus bottom, per difference of their TACs [1].
    force_ratio_error, heat_ratio_error : array, shape (n,)
        Absolute 95 % bounds of the solver's error [1].
    """

    knudsen: np.ndarray
    temperature_ratio: np.ndarray
    tac: np.ndarray
    force_ratio: np.ndarray
    heat_ratio: np.ndarray
    heat_ratio_slope: np.ndarray
    force_ratio_error: np.ndarray
    heat_ratio_error: np.ndarray


@dataclass(frozen=True)
class WallTable:
    """Effect of a chamber's walls on the linear problem, for one gas, a row each.

    Attributes
    ----------
    knudsen, boundary : array, shape (n,)
        Knudsen number and distance of the wall in radii of the disk [1].
    force_factor, heat_factor : array, shape (n,)
        Over the values in open space [1].
    """

    knudsen: np.ndarray
    boundary: np.ndarray
    force_factor: np.ndarray
    heat_factor: np.ndarray


@lru_cache
def kinetic_table(gas: str = "diatomic") -> Table:
    """The solver's table for a gas.

    Parameters
    ----------
    gas : {"diatomic", "monatomic"}

    Returns
    -------
    Table

    Raises
    ------
    ParameterError
        For another gas.
    """
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


@dataclass(frozen=True)
class KineticFit:
    """Force and heat ratios as smooth functions, fitted to a table.

    Attributes
    ----------
    knudsen_range : tuple of float
        Of the table; beyond it the limits' power laws continue.
    force, heat : nested tuple of float
        Coefficients: heating, TAC, Knudsen number.
    force_slope : nested tuple of float
        Coefficients of the force's slope at the table's low end: heating, TAC.
    heating_limit : float
        Largest :math:`1 - T_c/T_h` of the table; beyond it the ratios stay constant.
    tac_range : tuple of float
        Of the table, likewise.
    force_error, heat_error : tuple of float
        Coefficients, in the Knudsen number, of the logarithm of the table's relative standard
        error.
    force_wall, heat_wall : nested tuple of float
        Coefficients of the effect of walls: inverse distance, Knudsen number.
    nearest_wall : float
        Least distance in the table of walls, in radii [1].
    """

    knudsen_range: tuple[float, float]
    force: Any
    heat: Any
    force_slope: Any
    heating_limit: float
    tac_range: tuple[float, float]
    force_error: tuple[float, ...]
    heat_error: tuple[float, ...]
    force_wall: Any
    heat_wall: Any
    nearest_wall: float

    def force_ratio(self, knudsen: Numeric, ratio: Numeric, tac: Numeric) -> Array:
        r"""Force over the free-molecular one, :math:`\hat F` [1].

        Parameters
        ----------
        knudsen, ratio, tac : array, shape (...)
            Knudsen number at the gas temperature, :math:`T_h/T_c` and mean TAC [1].

        Returns
        -------
        array, broadcast shape
        """
        position, below = self._position(knudsen)
        others = self._others(ratio, tac)
        slope = jnp.clip(polynomial(self.force_slope, *others), *_STEEPEST)
        fitted = polynomial(self.force, *others, position) + slope * below
        return 1.0 / (1.0 + jnp.exp(fitted) / knudsen)

    def heat_ratio(self, knudsen: Numeric, ratio: Numeric, tac: Numeric) -> Array:
        r"""Heat loss over the free-molecular one, :math:`\hat Q` [1]; as :meth:`force_ratio`."""
        position, _ = self._position(knudsen)
        fitted = polynomial(self.heat, *self._others(ratio, tac), position)
        return 1.0 / (1.0 + jnp.exp(fitted) * tac / knudsen)

    def relative_force_error(self, knudsen: Numeric, force_ratio: Numeric) -> Array:
        """Relative standard error of the force: the table's and the equation's [1].

        Parameters
        ----------
        knudsen, force_ratio : array, shape (...)

        Returns
        -------
        array, broadcast shape
        """
        of_table = jnp.exp(polynomial(self.force_error, self._position(knudsen)[0]))
        return jnp.hypot(of_table, COLLISION_ERROR * (1.0 - force_ratio))

    def relative_heat_error(self, knudsen: Numeric) -> Array:
        """Relative standard error of the heat loss; as :meth:`relative_force_error`."""
        of_table = jnp.exp(polynomial(self.heat_error, self._position(knudsen)[0]))
        return jnp.hypot(of_table, HEAT_EQUATION_ERROR)

    def wall_factors(self, knudsen: Numeric, distance: Numeric) -> tuple[Array, Array]:
        """Force and heat between walls over those in open space [1].

        Parameters
        ----------
        knudsen : array, shape (...)
        distance : array, shape (...)
            Of the walls, in radii of the disk [1].

        Returns
        -------
        force, heat : array, broadcast shape
        """
        position, _ = self._position(knudsen)
        nearness = 1.0 / jnp.maximum(distance, self.nearest_wall)
        force, heat = self.force_wall, self.heat_wall
        return (
            jnp.exp(nearness * polynomial(force, nearness, position)),
            jnp.exp(nearness * polynomial(heat, nearness, position)),
        )

    def _position(self, knudsen: Numeric) -> tuple[Array, Array]:
        """Where in the table a Knudsen number is, from −1 to 1, and how far below it."""
        low, high = np.log(self.knudsen_range)
        logarithm = jnp.log(knudsen)
        inside = jnp.clip(logarithm, low, high)
        return scaled(inside, low, high), jnp.minimum(logarithm - low, 0.0)

    def heating(self, ratio: Numeric) -> Array:
        """(T_h − T_c)/T_h of a temperature ratio, within the table's range [1]."""
        return jnp.clip(1.0 - 1.0 / ratio, _COLDEST, self.heating_limit)

    def _others(self, ratio: Numeric, tac: Numeric) -> tuple[Array, Array]:
        return self.heating(ratio), jnp.clip(tac, *self.tac_range)


def scaled(value: Any, low: float, high: float) -> Any:
    """Place of a value between two ends, from −1 to 1."""
    return (2.0 * value - low - high) / (high - low)


def polynomial(coefficients: Any, *variables: Any) -> Any:
    """Polynomial in several variables by Horner's rule; the first one's powers come last."""
    if not variables:
        return coefficients
    first, *others = variables
    result: Any = 0.0
    for coefficient in reversed(coefficients):
        result = result * first + polynomial(coefficient, *others)
    return result


def least_squares(
    values: np.ndarray,
    variables: tuple[np.ndarray, ...],
    powers: Sequence[tuple[int, ...]],
    errors: np.ndarray | float = 1.0,
) -> Any:
    """Coefficients of the polynomial with these powers that fits best, as nested tuples."""
    basis = np.stack(
        [np.prod([x**p for x, p in zip(variables, term, strict=True)], axis=0) for term in powers],
        axis=1,
    )
    weights = 1.0 / np.broadcast_to(errors, values.shape)
    fitted = np.linalg.lstsq(basis * weights[:, None], values * weights, rcond=None)[0]
    coefficients = np.zeros(np.max(powers, axis=0) + 1)
    coefficients[tuple(np.transpose(powers))] = fitted
    return as_tuples(coefficients)


def as_tuples(array: np.ndarray) -> Any:
    """An array as nested tuples of float, which can be hashed."""
    return tuple(map(as_tuples, array)) if array.ndim else float(array)


@lru_cache
def kinetic_fit(gas: str = "diatomic") -> KineticFit:
    """Smooth functions through the table for a gas.

    Parameters
    ----------
    gas : {"diatomic", "monatomic"}

    Returns
    -------
    KineticFit
    """
    return fit(kinetic_table(gas), wall_table(gas))


def fit(table: Table, walls: WallTable) -> KineticFit:
    """Smooth functions through tables, weighted by the table's errors.

    Parameters
    ----------
    table : Table
    walls : WallTable

    Returns
    -------
    KineticFit
    """
    knudsen_range = (float(table.knudsen.min()), float(table.knudsen.max()))
    low, high = np.log(knudsen_range)

    def position(knudsen: np.ndarray) -> np.ndarray:
        return np.asarray(scaled(np.log(knudsen), low, high))

    where = position(table.knudsen)
    heating = 1.0 - 1.0 / table.temperature_ratio
    variables = (heating, table.tac, where)

    def resistance(ratio: np.ndarray, bounds: np.ndarray, scale: np.ndarray | float) -> Any:
        """Fit of the logarithm of what the gas takes away, times the Knudsen number."""
        errors = np.clip(bounds / (ratio * (1.0 - ratio)), *_WEIGHTS)
        values = np.log((1.0 / ratio - 1.0) * table.knudsen / scale)
        return least_squares(values, variables, _POWERS, errors)

    force = resistance(table.force_ratio, table.force_ratio_error, 1.0)
    powers = np.arange(1, len(force[0][0]))
    slope = np.asarray(force)[..., 1:] @ (powers * (-1.0) ** (powers - 1))  # at −1
    by_distance = (1.0 / walls.boundary, position(walls.knudsen))

    def wall(factor: np.ndarray) -> Any:
        return least_squares(np.log(factor) * walls.boundary, by_distance, _WALL_POWERS)

    return KineticFit(
        knudsen_range=knudsen_range,
        force=force,
        heat=resistance(table.heat_ratio, table.heat_ratio_error, table.tac),
        force_slope=as_tuples(slope * 2.0 / (high - low)),
        heating_limit=float(heating.max()),
        tac_range=(float(table.tac.min()), float(table.tac.max())),
        force_error=error_fit(table.force_ratio_error / table.force_ratio, where),
        heat_error=error_fit(table.heat_ratio_error / table.heat_ratio, where),
        force_wall=wall(walls.force_factor),
        heat_wall=wall(walls.heat_factor),
        nearest_wall=float(walls.boundary.min()),
    )


def error_fit(bounds: np.ndarray, position: np.ndarray) -> Any:
    """Logarithm of the largest relative standard error at each Knudsen number, smoothed."""
    places = np.unique(position)
    largest = np.array([bounds[position == place].max() for place in places])
    return least_squares(np.log(largest / NORMAL_HALF_WIDTH_95), (places,), _ERROR_POWERS)
