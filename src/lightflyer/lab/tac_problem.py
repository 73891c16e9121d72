"""Least squares for a heater's conductance: model, derivatives, first guess and minimisation."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.foundation.errors import ConfigurationError, ConvergenceError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.types import Numeric

PARAMETERS = ("tac", "area_ratio", "offset")
"""Fitted parameters: α, δ and C."""

_LEAST_TAC = 1e-6  # bound of the fit
_STARTS = np.geomspace(0.02, 3.0, 60)  # coefficients tried for a first guess
_RANK_TOLERANCE = 1e-7  # of the scaled Jacobian's singular values
_GROUPS = 5_000  # of rows of neighbouring pressure that replace a very long run in its profile


def import_lmfit() -> Any:
    """The module lmfit; raises :class:`MissingExtraError` where it is not installed."""
    return extra("lmfit", "fitting an accommodation coefficient", "lab")


def gas_conductance(tac: Numeric, free_molecular: np.ndarray, continuum: np.ndarray) -> np.ndarray:
    """Conductance of the gas: both limits in series.

    Parameters
    ----------
    tac : float or array
        Accommodation coefficient [1].
    free_molecular : array
        Free-molecular conductance at a coefficient of one [W/(m² K)].
    continuum : array
        Continuum conductance [W/(m² K)].

    Returns
    -------
    array, broadcast shape
        [W/(m² K)].
    """
    kinetic = tac * free_molecular
    return kinetic * continuum / (kinetic + continuum)


@dataclass(frozen=True)
class Problem:
    """Conductances of a run, measured and modelled.

    Attributes
    ----------
    source : str
        Name of the file, for messages.
    conductance : array, shape (m,)
        Measured power per nominal area and temperature difference [W/(m² K)].
    free_molecular, continuum : array, shape (m,)
        Limits of the gas at a coefficient of one [W/(m² K)].
    radiation : array, shape (m,)
        Radiation counted apart from the offset [W/(m² K)].
    weight : array, shape (m,)
        Factor of the residuals [m² K/W].
    """

    source: str
    conductance: np.ndarray
    free_molecular: np.ndarray
    continuum: np.ndarray
    radiation: np.ndarray
    weight: np.ndarray

    def weighted(self, weight: np.ndarray) -> "Problem":
        """The same problem with other weights."""
        return replace(self, weight=weight)

    def model(self, tac: float, area_ratio: float, offset: float) -> np.ndarray:
        """Conductance per nominal area [W/(m² K)], shape (m,)."""
        gas = gas_conductance(tac, self.free_molecular, self.continuum)
        return area_ratio * (gas + self.radiation + offset)

    def residuals(self, tac: float, area_ratio: float, offset: float) -> np.ndarray:
        """Weighted residuals [1], shape (m,)."""
        return (self.model(tac, area_ratio, offset) - self.conductance) * self.weight

    def jacobian(self, tac: float, area_ratio: float, offset: float) -> np.ndarray:
        """Derivatives of the residuals by the parameters, shape (3, m)."""
        gas = gas_conductance(tac, self.free_molecular, self.continuum)
        per_tac = area_ratio * gas**2 / (tac**2 * self.free_molecular)
        columns = (per_tac, gas + self.radiation + offset, np.full_like(gas, area_ratio))
        return np.stack(columns) * self.weight

    @cached_property
    def _groups(self) -> list[np.ndarray]:
        return np.array_split(np.argsort(self.free_molecular, kind="stable"), _GROUPS)

    def grouped(self) -> "Problem":
        """Rows of neighbouring pressure averaged, each group weighted by its size.

        A profile of very many rows would take long. Within a group the model hardly changes, and
        the scatter within it does not depend on the parameters.
        """
        if len(self.conductance) <= 2 * _GROUPS:
            return self
        groups = self._groups
        columns = (self.conductance, self.free_molecular, self.continuum, self.radiation)
        means = [np.array([values[rows].mean() for rows in groups]) for values in columns]
        sizes = np.array([len(rows) for rows in groups])
        weight = np.array([self.weight[rows].mean() for rows in groups]) * np.sqrt(sizes)
        return Problem(self.source, means[0], means[1], means[2], means[3], weight)


def first_guess(problem: Problem) -> tuple[float, float, float]:
    """Best of many coefficients; area ratio and offset by linear least squares for each.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    tac, area_ratio, offset : float
    """
    weight = problem.weight
    best, least = (1.0, 1.0, 0.0), np.inf
    for tac in _STARTS:
        gas = gas_conductance(tac, problem.free_molecular, problem.continuum) + problem.radiation
        design = np.stack([gas * weight, weight], axis=1)
        (ratio, product), *_ = np.linalg.lstsq(design, problem.conductance * weight)
        cost = float(np.sum((design @ (ratio, product) - problem.conductance * weight) ** 2))
        if cost < least and ratio > 0.0:
            best, least = (float(tac), float(ratio), float(product / ratio)), cost
    return best


def require_distinct(problem: Problem, values: Sequence[float]) -> None:
    """Raise unless the pressures determine all three parameters.

    Parameters
    ----------
    problem : Problem
    values : sequence of float
        Parameters near the solution.

    Raises
    ------
    ConfigurationError
        If two of the parameters have nearly the same effect.
    """
    jacobian = problem.jacobian(*values)
    scaled = jacobian / np.maximum(np.linalg.norm(jacobian, axis=1, keepdims=True), 1e-300)
    singular = np.sqrt(np.maximum(np.linalg.eigvalsh(scaled @ scaled.T), 0.0))
    if singular[0] < _RANK_TOLERANCE * singular[-1]:
        raise ConfigurationError(
            f"{problem.source}: its pressures do not determine accommodation coefficient, area "
            "ratio and offset separately; they must reach from free-molecular gas to the plateau"
        )


def minimise(problem: Problem, start: Sequence[float]) -> tuple[Any, Any]:
    """Minimise the sum of squares.

    Parameters
    ----------
    problem : Problem
    start : sequence of float

    Returns
    -------
    minimizer : lmfit.Minimizer
    result : lmfit.minimizer.MinimizerResult

    Raises
    ------
    ConvergenceError
        If there is no minimum.
    MissingExtraError
        If lmfit is not installed.
    """
    lmfit = import_lmfit()
    parameters = lmfit.Parameters()
    for name, value, lowest in zip(PARAMETERS, start, (_LEAST_TAC, 0.0, -np.inf), strict=True):
        parameters.add(name, value=value, min=lowest)

    def residuals(given: Any) -> np.ndarray:
        return problem.residuals(*(float(given[name]) for name in PARAMETERS))

    def jacobian(given: Any) -> np.ndarray:
        rows = problem.jacobian(*(float(given[name]) for name in PARAMETERS))
        return rows[[given[name].vary for name in PARAMETERS]]

    minimizer = lmfit.Minimizer(residuals, parameters, scale_covar=True)
    options = {"Dfun": jacobian, "col_deriv": 1, "ftol": 1e-14, "xtol": 1e-12, "gtol": 1e-14}
    minimizer.kws.update(options)
    result = minimizer.leastsq()
    if result.covar is None or not np.all(np.isfinite(result.covar)):
        raise ConvergenceError(f"{problem.source}: the fit failed: {result.message}")
    return minimizer, result
