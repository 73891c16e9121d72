r"""Thermal accommodation coefficient from the power of a heater in thin gas.

A disk held at one temperature loses heat to the gas, to its leads and by radiation. Per area and
temperature difference that is

.. math::
    \frac{P}{A\,\Delta T} = \delta\left[\left(\frac{1}{\alpha h_\mathrm{fm}(p)}
        + \frac{1}{h_\mathrm{cont}(p)}\right)^{-1} + C\right]

with the accommodation coefficient :math:`\alpha`, the ratio :math:`\delta` of effective to
nominal area and an offset :math:`C`. The slope at low pressure is :math:`\delta\alpha`, the
plateau at high pressure :math:`\delta` times a known conductance, and without gas
:math:`\delta C` remains: pressures from one end to the other determine all three.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.force.lu2023 import PRINTED, Reading, heat_conductances
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.precision import elementwise_entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.tac_data import TacRun
from lightflyer.lab.tac_intervals import covariance_estimates, profile_estimates
from lightflyer.lab.tac_problem import (
    PARAMETERS,
    Problem,
    first_guess,
    gas_conductance,
    minimise,
    require_distinct,
)

LU2023_HEATER_DIAMETER = 24e-3
"""Diameter of the paper's heater [m]; [Lu2023]_ supplement."""

HEATERS = {"lu2023": LU2023_HEATER_DIAMETER}
"""Diameters of named heaters [m]."""

_LEAST_ROWS = 6


@dataclass(frozen=True)
class TacFit:
    r"""Accommodation coefficient, area ratio and offset of one run.

    Attributes
    ----------
    run : TacRun
    kept : bool array, shape (n,)
        Rows at constant temperature, which are fitted.
    diameter : float
        Diameter of the heater [m].
    tac, area_ratio, offset : Estimate
        With 95 % profile intervals; the offset in W/(m² K).
    covariance_intervals : dict of str to tuple of float
        95 % intervals from the covariance, by name of the parameter.
    covariance : array, shape (3, 3)
        In the order of :data:`~lightflyer.lab.tac_problem.PARAMETERS`.
    scatter : float
        Relative scatter of the measured conductance about the fit [1].
    conductance : array, shape (m,)
        Measured :math:`P/(A\,\Delta T)` of the fitted rows [W/(m² K)].
    fitted : array, shape (m,)
        Its fitted value [W/(m² K)].
    weight : array, shape (m,)
        Factor of the residuals in the fit [m² K/W].
    free_molecular, continuum, radiation : array, shape (m,)
        Conductances of the model at a coefficient of one [W/(m² K)].
    """

    run: TacRun
    kept: np.ndarray
    diameter: float
    tac: Estimate
    area_ratio: Estimate
    offset: Estimate
    covariance_intervals: dict[str, tuple[float, float]]
    covariance: np.ndarray
    scatter: float
    conductance: np.ndarray
    fitted: np.ndarray
    weight: np.ndarray
    free_molecular: np.ndarray
    continuum: np.ndarray
    radiation: np.ndarray

    @property
    def pressure(self) -> np.ndarray:
        """Pressure of the fitted rows [Pa], shape (m,)."""
        return self.run.pressure[self.kept]

    @cached_property
    def order(self) -> np.ndarray:
        """Indices that sort the fitted rows by pressure, shape (m,)."""
        return np.argsort(self.pressure, kind="stable")

    @property
    def rows_used(self) -> int:
        """Number of fitted rows."""
        return int(self.kept.sum())

    @property
    def rows_dropped(self) -> int:
        """Number of rows dropped because the heater was not at its constant temperature."""
        return int((~self.kept).sum())

    @property
    def mean_temperature(self) -> float:
        """Mean heater temperature of the fitted rows [K]."""
        return float(self.run.heater_temperature[self.kept].mean())

    @property
    def temperature_variation(self) -> float:
        """Coefficient of variation of the heater temperature over the fitted rows [1]."""
        return float(self.run.heater_temperature[self.kept].std(ddof=1) / self.mean_temperature)

    @property
    def residual_correlation(self) -> float:
        """Correlation between residuals at neighbouring pressures [1]."""
        residuals = (self.conductance - self.fitted) * self.weight
        ordered = residuals[self.order]
        power = float(ordered @ ordered)
        return float(ordered[1:] @ ordered[:-1]) / power if power else 0.0

    def estimates(self) -> dict[str, Estimate]:
        """The three estimates by name."""
        return {name: getattr(self, name) for name in PARAMETERS}

    def summary(self) -> dict[str, Any]:
        """The fit as a JSON object."""
        low, high = float(self.pressure.min()), float(self.pressure.max())
        return {
            **{name: estimate.to_json() for name, estimate in self.estimates().items()},
            "rows_used": self.rows_used,
            "rows_dropped": self.rows_dropped,
            "covariance_interval_95": {
                name: list(ends) for name, ends in self.covariance_intervals.items()
            },
            "covariance": self.covariance.tolist(),
            "scatter": self.scatter,
            "residual_correlation": self.residual_correlation,
            "heater_temperature": {"mean_k": self.mean_temperature,
                                   "coefficient_of_variation": self.temperature_variation},
            "pressure_range_pa": [low, high],
        }  # fmt: skip


@elementwise_entry_point
def _limits(
    pressure: Numeric, ambient: Numeric, heater: Numeric, diameter: Numeric, reading: Reading,
    gas: AbstractGas,
) -> tuple[Any, Any]:  # fmt: skip
    """Conductances per nominal area of both limits, at a coefficient of one [W/(m² K)]."""
    free_molecular, continuum = heat_conductances(
        (heater - ambient) / ambient,
        radius=0.5 * diameter,
        tac_mean=1.0,
        pressure=pressure,
        temperature=ambient,
        gravity=constants.STANDARD_GRAVITY,
        gas=gas,
        reading=reading,
    )
    per_kelvin = _area(diameter) * ambient
    return free_molecular / per_kelvin, continuum / per_kelvin


def heater_power(
    pressure: np.ndarray,
    heater_temperature: np.ndarray,
    ambient_temperature: np.ndarray,
    tac: float,
    area_ratio: float,
    offset: float,
    *,
    diameter: float = LU2023_HEATER_DIAMETER,
    reading: Reading = PRINTED,
    gas: AbstractGas = AIR,
) -> np.ndarray:
    """Power that holds a heater at its temperature: the inverse of :func:`fit_tac`.

    Parameters
    ----------
    pressure : array, shape (n,)
        [Pa].
    heater_temperature, ambient_temperature : array, shape (n,)
        [K].
    tac, area_ratio : float
        Accommodation coefficient and ratio of effective to nominal area [1].
    offset : float
        Conductance without gas [W/(m² K)].
    diameter, reading, gas
        See :func:`fit_tac`.

    Returns
    -------
    array, shape (n,)
        [W].
    """
    difference = heater_temperature - ambient_temperature
    limits: Any = _limits(pressure, ambient_temperature, heater_temperature, diameter, reading, gas)
    conductance = area_ratio * (gas_conductance(tac, *limits) + offset)
    return conductance * _area(diameter) * difference


def _area(diameter: Numeric) -> Numeric:
    return 0.25 * np.pi * diameter**2


def fit_tac(
    run: TacRun,
    *,
    diameter: float = LU2023_HEATER_DIAMETER,
    tolerance: float = 1.0,
    emissivity: float | None = None,
    reading: Reading = PRINTED,
    gas: AbstractGas = AIR,
) -> TacFit:
    r"""Fit accommodation coefficient, area ratio and offset to a run.

    Parameters
    ----------
    run : TacRun
    diameter : float
        Diameter of the heater [m]; by default the paper's.
    tolerance : float
        Largest distance of the heater temperature from its median [K]; other rows are dropped.
    emissivity : float, optional
        Emissivity of both faces of the heater [1]. Where given, the radiation
        :math:`2\sigma\varepsilon(T_h^4-T_c^4)/\Delta T` is counted apart from the offset;
        otherwise the offset includes it.
    reading : Reading
        Conventions of the heat loss; :data:`lightflyer.PRINTED` counts the disk's continuum loss
        once, :data:`lightflyer.REPORTED` twice, which doubles α and halves δ.
    gas : AbstractGas

    Returns
    -------
    TacFit

    Raises
    ------
    ParameterError
        If an argument is impossible.
    ConfigurationError
        If there are too few rows at constant temperature, or their pressures do not determine
        all three parameters.
    ConvergenceError
        If the fit fails.
    MissingExtraError
        If lmfit is not installed.

    Notes
    -----
    Least squares on the conductance :math:`P/(A\Delta T)`. All rows have the same relative
    scatter, estimated from the residuals; each residual is divided by the conductance of a first
    fit. A profile interval ends where the sum of squares, minimised over the other two parameters,
    exceeds its minimum by Fisher's 95 % point.

    References
    ----------
    [Lu2023]_ supplement, Eqs. (3)-(14).
    """
    require_positive(diameter=diameter, tolerance=tolerance)
    require_range("emissivity", emissivity, 0.0, 1.0)
    kept = _at_constant_temperature(run, tolerance)
    heater, ambient = run.heater_temperature[kept], run.ambient_temperature[kept]
    limits: Any = _limits(run.pressure[kept], ambient, heater, diameter, reading, gas)
    free_molecular, continuum = limits
    radiation = np.zeros_like(heater)
    if emissivity is not None:
        both_faces = 2.0 * constants.STEFAN_BOLTZMANN * emissivity
        radiation = both_faces * (heater + ambient) * (heater**2 + ambient**2)
    conductance = run.power[kept] / (_area(diameter) * (heater - ambient))
    problem = Problem(
        run.source, conductance, free_molecular, continuum, radiation, 1.0 / conductance
    )
    problem = problem.weighted(1.0 / problem.model(*first_guess(problem.grouped())))
    return _solve(run, kept, diameter, problem)


def _at_constant_temperature(run: TacRun, tolerance: float) -> np.ndarray:
    """Rows near the median heater temperature; shape (n,)."""
    off = np.abs(run.heater_temperature - np.median(run.heater_temperature))
    kept = off <= tolerance
    if kept.sum() < max(_LEAST_ROWS, 0.5 * len(kept)):
        if len(kept) < _LEAST_ROWS:
            raise ConfigurationError(
                f"{run.source}:{run.table.lines[0]}: has {len(kept)} usable row"
                f"{'s' * (len(kept) > 1)}; a fit of three parameters needs {_LEAST_ROWS} or more"
            )
        worst = int(np.argmax(off))
        raise ConfigurationError(
            f"{run.source}:{run.table.lines[worst]}: the heater's temperature is not constant: "
            f"only {kept.sum()} of {len(kept)} rows are within {tolerance:g} K of its median; "
            "--tolerance sets the limit"
        )
    return kept


def _solve(run: TacRun, kept: np.ndarray, diameter: float, problem: Problem) -> TacFit:
    guess = first_guess(problem.grouped())
    require_distinct(problem, guess)
    minimizer, result = minimise(problem, guess)
    freedom = len(problem.conductance) - len(PARAMETERS)
    by_covariance = covariance_estimates(result, freedom)
    return TacFit(
        run=run,
        kept=kept,
        diameter=diameter,
        **profile_estimates(problem, minimizer, result, by_covariance),
        covariance_intervals={name: one.interval for name, one in by_covariance.items()},
        covariance=np.asarray(result.covar),
        scatter=float(np.sqrt(result.chisqr / freedom)),
        conductance=problem.conductance,
        fitted=problem.model(*(one.value for one in by_covariance.values())),
        weight=problem.weight,
        free_molecular=problem.free_molecular,
        continuum=problem.continuum,
        radiation=problem.radiation,
    )
