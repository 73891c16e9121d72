r"""Thermal accommodation coefficient from the power of a heater in thin gas.

A disk held at one temperature loses heat to the gas, and to its leads and by radiation. Per area
and temperature difference that is

.. math::
    \frac{P}{A\,\Delta T} = \delta\left[\left(\frac{1}{\alpha h_\mathrm{fm}(p)}
        + \frac{1}{h_\mathrm{cont}(p)}\right)^{-1} + C\right]

with the accommodation coefficient :math:`\alpha`, the ratio :math:`\delta` of effective to
nominal area and an offset :math:`C`. The slope at low pressure is :math:`\delta\alpha`, the
plateau at high pressure :math:`\delta`, what is left without gas :math:`\delta C`: pressures from
one end to the other fix all three.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import stats

from lightflyer.environment.chamber import Chamber
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.disk import Disk
from lightflyer.force.lu2023 import PRINTED, Lu2023, Reading
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ConfigurationError, ConvergenceError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.precision import elementwise_entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.gas import AIR, AbstractGas
from lightflyer.lab.estimate import CONFIDENCE, Estimate, weighted_mean
from lightflyer.lab.record import dataset
from lightflyer.lab.tac_data import TacRun

if TYPE_CHECKING:
    import xarray as xr

LU2023_HEATER_DIAMETER = 24e-3
"""Diameter of the paper's heater [m]; [Lu2023]_ supplement."""

HEATERS = {"lu2023": LU2023_HEATER_DIAMETER}
"""Diameters of heaters that have a name [m]."""

PARAMETERS = ("tac", "area_ratio", "offset")
"""What is fitted: α, δ and C."""

_OFFSET_UNIT = "W/(m^2 K)"
_UNITS = ("", "", _OFFSET_UNIT)
_LEAST_ROWS = 6
_LEAST_TAC = 1e-6  # bound of the fit
_STARTS = np.geomspace(0.02, 3.0, 60)  # coefficients tried for a first guess
_RANK_TOLERANCE = 1e-7  # of the scaled Jacobian's singular values
_GROUPS = 5_000  # of rows of neighbouring pressure, which a profile of very many rows is made of
_ROUNDING = 1e-10  # relative scatter that is rounding, not noise


@dataclass(frozen=True)
class TacFit:
    r"""Accommodation coefficient, area ratio and offset of one run.

    Attributes
    ----------
    run : TacRun
    kept : bool array, shape (n,)
        Rows at constant temperature, which the fit used.
    diameter : float
        Of the heater [m].
    tac, area_ratio, offset : Estimate
        With 95 % profile intervals; the offset in W/(m² K).
    covariance_intervals : dict of str to tuple of float
        95 % intervals from the covariance, by name of the parameter.
    covariance : array, shape (3, 3)
        In the order of :data:`PARAMETERS`.
    scatter : float
        Relative scatter of the measured conductance about the fit [1].
    conductance : array, shape (m,)
        :math:`P/(A\,\Delta T)` of the rows kept [W/(m² K)].
    fitted : array, shape (m,)
        The same of the fit.
    weight : array, shape (m,)
        What residuals of the conductance were multiplied with [m² K/W].
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
        """Pressure of the rows kept [Pa], shape (m,)."""
        return self.run.pressure[self.kept]

    @cached_property
    def order(self) -> np.ndarray:
        """The rows kept in the order of pressure, shape (m,)."""
        return np.argsort(self.pressure, kind="stable")

    @property
    def rows_used(self) -> int:
        """Rows that the fit used."""
        return int(self.kept.sum())

    @property
    def rows_dropped(self) -> int:
        """Rows that were read but not at the constant temperature."""
        return int((~self.kept).sum())

    @property
    def mean_temperature(self) -> float:
        """Mean heater temperature of the rows kept [K]."""
        return float(self.run.heater_temperature[self.kept].mean())

    @property
    def temperature_variation(self) -> float:
        """Coefficient of variation of the heater temperature of the rows kept [1]."""
        return float(self.run.heater_temperature[self.kept].std(ddof=1) / self.mean_temperature)

    @property
    def residual_correlation(self) -> float:
        """Correlation of neighbouring residuals in the order of pressure [1]."""
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
    pressure: Numeric, ambient: Numeric, excess: Numeric, radius: Numeric, model: Lu2023,
    gas: AbstractGas,
) -> tuple[Any, Any]:  # fmt: skip
    """Conductances per nominal area of both limits, at a coefficient of one [W/(m² K)]."""
    film = FilmProperties(1.0, 0.0, 1.0, 1.0, tac_top=1.0, tac_bottom=1.0)
    disk = Disk(film, radius)
    state = Chamber(temperature=ambient, gas=gas).state(pressure)
    free_molecular, continuum = model.heat_conductances(disk, state, excess)
    per_kelvin = disk.area * ambient
    return free_molecular / per_kelvin, continuum / per_kelvin


def gas_conductance(tac: Numeric, free_molecular: np.ndarray, continuum: np.ndarray) -> np.ndarray:
    """Both limits in series [W/(m² K)].

    Parameters
    ----------
    tac : float or array
        Accommodation coefficient [1].
    free_molecular : array
        Free-molecular conductance at a coefficient of one [W/(m² K)].
    continuum : array
        [W/(m² K)].

    Returns
    -------
    array, broadcast shape
    """
    kinetic = tac * free_molecular
    return kinetic * continuum / (kinetic + continuum)


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
    """Power that holds a heater at its temperature: what :func:`fit_tac` turns round.

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
        As for :func:`fit_tac`.

    Returns
    -------
    array, shape (n,)
        [W].
    """
    difference = heater_temperature - ambient_temperature
    limits: Any = _limits(
        pressure, ambient_temperature, difference / ambient_temperature, 0.5 * diameter,
        Lu2023(reading=reading), gas,
    )  # fmt: skip
    conductance = area_ratio * (gas_conductance(tac, *limits) + offset)
    return conductance * _area(diameter) * difference


def _area(diameter: float) -> float:
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
    r"""Accommodation coefficient, area ratio and offset of a run.

    Parameters
    ----------
    run : TacRun
    diameter : float
        Of the heater [m]; by default the paper's.
    tolerance : float
        Rows whose heater temperature is farther than this from the median are dropped [K].
    emissivity : float, optional
        Of the heater, on both faces. Where given, the radiation
        :math:`2\sigma\varepsilon(T_h^4-T_c^4)/\Delta T` is counted by itself and the offset is
        what remains; otherwise the offset holds it.
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
        If there are too few rows at constant temperature, or their pressures cannot tell the
        three parameters apart.
    ConvergenceError
        If the fit fails.
    MissingExtraError
        If lmfit is not installed.

    Notes
    -----
    Least squares on the conductance :math:`P/(A\Delta T)`, all rows with the same relative
    scatter, which is estimated from the residuals: each is divided by the conductance of a first
    fit. Profile intervals end where the sum of squares, minimised over the other two, exceeds its
    least value by Fisher's 95 % point.

    References
    ----------
    [Lu2023]_ supplement, Eqs. (3)-(14).
    """
    require_positive(diameter=diameter, tolerance=tolerance)
    require_range("emissivity", emissivity, 0.0, 1.0)
    kept = _at_constant_temperature(run, tolerance)
    heater, ambient = run.heater_temperature[kept], run.ambient_temperature[kept]
    excess = (heater - ambient) / ambient
    limits: Any = _limits(
        run.pressure[kept], ambient, excess, 0.5 * diameter, Lu2023(reading=reading), gas
    )
    free_molecular, continuum = limits
    radiation = np.zeros_like(heater)
    if emissivity is not None:
        both_faces = 2.0 * constants.STEFAN_BOLTZMANN * emissivity
        radiation = both_faces * (heater + ambient) * (heater**2 + ambient**2)
    conductance = run.power[kept] / (_area(diameter) * (heater - ambient))
    problem = _Problem(
        run.source, conductance, free_molecular, continuum, radiation, 1.0 / conductance
    )
    problem = problem.weighted(1.0 / problem.model(*_first_guess(problem.grouped())))
    return _solve(run, kept, diameter, problem)


def _at_constant_temperature(run: TacRun, tolerance: float) -> np.ndarray:
    """Rows near the median heater temperature; shape (n,)."""
    off = np.abs(run.heater_temperature - np.median(run.heater_temperature))
    kept = off <= tolerance
    if kept.sum() < max(_LEAST_ROWS, 0.5 * len(kept)):
        if len(kept) < _LEAST_ROWS:
            raise ConfigurationError(
                f"{run.source}:{run.table.lines[0]}: has {len(kept)} row{'s' * (len(kept) > 1)} "
                f"that can be used; a fit of three parameters takes {_LEAST_ROWS} or more"
            )
        worst = int(np.argmax(off))
        raise ConfigurationError(
            f"{run.source}:{run.table.lines[worst]}: the heater's temperature is not constant: "
            f"only {kept.sum()} of {len(kept)} rows are within {tolerance:g} K of its median; "
            "--tolerance allows more"
        )
    return kept


@dataclass(frozen=True)
class _Problem:
    source: str
    conductance: np.ndarray
    free_molecular: np.ndarray
    continuum: np.ndarray
    radiation: np.ndarray
    weight: np.ndarray

    def weighted(self, weight: np.ndarray) -> "_Problem":
        return _Problem(self.source, self.conductance, self.free_molecular, self.continuum,
                        self.radiation, weight)  # fmt: skip

    def model(self, tac: float, area_ratio: float, offset: float) -> np.ndarray:
        """Conductance per nominal area [W/(m² K)]."""
        gas = gas_conductance(tac, self.free_molecular, self.continuum)
        return area_ratio * (gas + self.radiation + offset)

    def residuals(self, tac: float, area_ratio: float, offset: float) -> np.ndarray:
        return (self.model(tac, area_ratio, offset) - self.conductance) * self.weight

    def jacobian(self, tac: float, area_ratio: float, offset: float) -> np.ndarray:
        """Of the residuals, shape (3, m)."""
        gas = gas_conductance(tac, self.free_molecular, self.continuum)
        per_tac = area_ratio * gas**2 / (tac**2 * self.free_molecular)
        columns = (per_tac, gas + self.radiation + offset, np.full_like(gas, area_ratio))
        return np.stack(columns) * self.weight

    @cached_property
    def _groups(self) -> list[np.ndarray]:
        return np.array_split(np.argsort(self.free_molecular, kind="stable"), _GROUPS)

    def grouped(self) -> "_Problem":
        """Rows of neighbouring pressure averaged, each group weighted by its size.

        For very many rows, whose profile would take long: within a group the model hardly
        changes, and the scatter within it does not depend on the parameters.
        """
        if len(self.conductance) <= 2 * _GROUPS:
            return self
        groups = self._groups
        columns = (self.conductance, self.free_molecular, self.continuum, self.radiation)
        means = [np.array([values[rows].mean() for rows in groups]) for values in columns]
        sizes = np.array([len(rows) for rows in groups])
        weight = np.array([self.weight[rows].mean() for rows in groups]) * np.sqrt(sizes)
        return _Problem(self.source, means[0], means[1], means[2], means[3], weight)


def _first_guess(problem: _Problem) -> tuple[float, float, float]:
    """Best of many coefficients, with area ratio and offset by linear least squares for each."""
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


def _require_distinct(problem: _Problem, values: Sequence[float]) -> None:
    jacobian = problem.jacobian(*values)
    scaled = jacobian / np.maximum(np.linalg.norm(jacobian, axis=1, keepdims=True), 1e-300)
    singular = np.sqrt(np.maximum(np.linalg.eigvalsh(scaled @ scaled.T), 0.0))
    if singular[0] < _RANK_TOLERANCE * singular[-1]:
        raise ConfigurationError(
            f"{problem.source}: its pressures cannot tell accommodation coefficient, area ratio "
            "and offset apart; they must reach from free-molecular gas to the plateau"
        )


def _solve(run: TacRun, kept: np.ndarray, diameter: float, problem: _Problem) -> TacFit:
    guess = _first_guess(problem.grouped())
    _require_distinct(problem, guess)
    minimizer, result = _minimised(problem, guess)
    values = [float(result.params[name].value) for name in PARAMETERS]
    freedom = len(problem.conductance) - len(PARAMETERS)
    covariance = np.asarray(result.covar)
    spread = np.sqrt(np.diag(covariance))
    by_covariance = {
        name: Estimate.normal(value, float(one), unit, freedom)
        for name, value, one, unit in zip(PARAMETERS, values, spread, _UNITS, strict=True)
    }
    # rows without scatter, as somebody's model makes them, have no profile to follow
    exact = result.chisqr < freedom * _ROUNDING**2
    profile = (
        {name: one.interval for name, one in by_covariance.items()}
        if exact
        else _profile_intervals(problem, minimizer, result)
    )
    estimates = {
        name: Estimate(one.value, profile[name], one.unit, one.uncertainty)
        for name, one in by_covariance.items()
    }
    return TacFit(
        run=run,
        kept=kept,
        diameter=diameter,
        **estimates,
        covariance_intervals={name: one.interval for name, one in by_covariance.items()},
        covariance=covariance,
        scatter=float(np.sqrt(result.chisqr / freedom)),
        conductance=problem.conductance,
        fitted=problem.model(*values),
        weight=problem.weight,
        free_molecular=problem.free_molecular,
        continuum=problem.continuum,
        radiation=problem.radiation,
    )


def _minimised(problem: _Problem, start: Sequence[float]) -> tuple[Any, Any]:
    """Minimizer and result of lmfit."""
    lmfit = extra("lmfit", "fitting an accommodation coefficient", "lab")
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


def _profile_intervals(
    problem: _Problem, minimizer: Any, result: Any
) -> dict[str, tuple[float, float]]:
    lmfit = extra("lmfit", "fitting an accommodation coefficient", "lab")
    grouped = problem.grouped()
    if grouped is not problem:
        values = [float(result.params[name].value) for name in PARAMETERS]
        minimizer, result = _minimised(grouped, values)
        variance = float(np.mean(problem.residuals(*values) ** 2))

        def probability(best: Any, other: Any) -> float:
            return float(stats.chi2.cdf((other.chisqr - best.chisqr) / variance, 1))
    else:

        def probability(best: Any, other: Any) -> float:
            return float(lmfit.confidence.f_compare(best, other))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # an end that is not found is infinite, which says it
        found = lmfit.conf_interval(minimizer, result, sigmas=[CONFIDENCE], prob_func=probability)
    return {name: (float(ends[0][1]), float(ends[-1][1])) for name, ends in found.items()}


def mean_tac(fits: Sequence[TacFit]) -> Estimate:
    """Mean coefficient of several runs.

    Parameters
    ----------
    fits : sequence of TacFit

    Returns
    -------
    Estimate
        See :func:`lightflyer.lab.estimate.weighted_mean`.
    """
    return weighted_mean([fit.tac for fit in fits])


def summary(fits: Sequence[TacFit]) -> dict[str, Any]:
    """One run, or the mean of several with each of them, as a JSON object.

    Parameters
    ----------
    fits : sequence of TacFit

    Returns
    -------
    dict
    """
    if len(fits) == 1:
        return fits[0].summary()
    return {
        **{
            name: weighted_mean([fit.estimates()[name] for fit in fits]).to_json()
            for name in PARAMETERS
        },
        "rows_used": sum(fit.rows_used for fit in fits),
        "rows_dropped": sum(fit.rows_dropped for fit in fits),
        "runs": {fit.run.source: fit.summary() for fit in fits},
    }


def to_dataset(fits: Sequence[TacFit]) -> "xr.Dataset":
    """The rows of all runs, measured and fitted.

    Parameters
    ----------
    fits : sequence of TacFit

    Returns
    -------
    xarray.Dataset
        Over ``row``; ``run`` counts the files that the attribute ``files`` lists.
    """
    per_area = "W m-2 K-1"

    def joined(values: Sequence[np.ndarray], units: str, long_name: str) -> Any:
        return "row", np.concatenate(values), {"units": units, "long_name": long_name}

    run = [np.full(fit.rows_used, number) for number, fit in enumerate(fits)]
    return dataset(
        "thermal accommodation coefficient",
        {
            "run": joined(run, "1", "number of the file, counted from 0"),
            "line": joined([fit.run.table.lines[fit.kept] for fit in fits], "1", "line of it"),
            "pressure": joined([fit.pressure for fit in fits], "Pa", "gas pressure"),
            "conductance": joined(
                [fit.conductance for fit in fits], per_area,
                "power per nominal area and temperature difference",
            ),
            "fitted": joined([fit.fitted for fit in fits], per_area, "the same of the fit"),
        },
        [fit.run.source for fit in fits],
    )  # fmt: skip
