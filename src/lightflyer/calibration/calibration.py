r"""Force coefficients, film properties and other numbers from measured levitation points.

The model's irradiance to levitate is fitted to the measured one by least squares on

.. math:: r_i = \frac{\ln I_i^\mathrm{measured} - \ln I_i^\mathrm{model}}{\sigma_i}

jointly over all samples. The logarithm of each parameter is fitted, so that all stay positive.
Where the points carry no uncertainty, one relative scatter for all is estimated from the
residuals.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import chdtri, fdtri

from lightflyer.calibration.least_squares import LeastSquares
from lightflyer.calibration.points import Points
from lightflyer.calibration.problem import DEFAULT_FREE, UNREACHABLE, Problem, problem_of
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.flight.design import as_design
from lightflyer.flight.setup import Setup
from lightflyer.force.base import AbstractForceModel
from lightflyer.foundation.checks import require_positive
from lightflyer.foundation.errors import ConvergenceError, ParameterError

CONFIDENCE = 0.95
"""Probability of an interval."""

_RANK_TOLERANCE = 1e-8  # of the Jacobian's singular values
_INVOLVED = 0.03  # share of a direction that names a parameter in a message
_EFFECTIVE_VARIANCE_PASSES = 3


@dataclass(frozen=True)
class Calibration:
    """A fit of parameters to levitation points.

    Attributes
    ----------
    problem : Problem
        Design, points and parameters.
    values : array, shape (p,)
        Fitted parameters, in SI units.
    covariance : array, shape (p, p)
        Covariance of the values, to first order.
    intervals : array, shape (p, 2)
        95 % profile-likelihood intervals; an end at a parameter's bound is that bound.
    scatter : float
        Root of the mean square of the residuals in log-irradiance per degree of freedom [1].
    estimated_scatter : bool
        Whether the points' uncertainty was estimated from their scatter.
    residuals : array, shape (n,)
        Measured minus fitted log-irradiance.
    uncertainty : array, shape (n,)
        Standard uncertainty of each point's log-irradiance, that of pressure included.
    fitted : array, shape (n,)
        Fitted irradiance [W/m²].
    """

    problem: Problem
    values: np.ndarray
    covariance: np.ndarray
    intervals: np.ndarray
    scatter: float
    estimated_scatter: bool
    residuals: np.ndarray
    uncertainty: np.ndarray
    fitted: np.ndarray

    @property
    def names(self) -> list[str]:
        """Names of the parameters, ``"emittance[Ge 2 cm]"`` where one is of one sample alone."""
        return self.problem.names

    @property
    def points(self) -> Points:
        """The points."""
        return self.problem.points

    @property
    def standard_uncertainties(self) -> np.ndarray:
        """Square roots of the covariance's diagonal, shape (p,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def setup(self) -> Setup:
        """The design with the fitted values of the parameters that all samples share."""
        shared = {
            field: parameter.target.factor * float(value)
            for parameter, value in zip(self.problem.parameters, self.values, strict=True)
            if parameter.chosen.all()
            for field in parameter.target.fields
        }
        model = self.problem.model
        return model.design.build(shared, model.prepared)

    def summary(self) -> dict[str, Any]:
        """The fit as a JSON object."""
        return {
            "parameters": {
                name: {
                    "value": float(value),
                    "standard_uncertainty": float(spread),
                    "interval_95": [float(end) for end in interval],
                }
                for name, value, spread, interval in zip(
                    self.names,
                    self.values,
                    self.standard_uncertainties,
                    self.intervals,
                    strict=True,
                )
            },
            "covariance": self.covariance.tolist(),
            "points": len(self.points),
            "samples": list(dict.fromkeys(self.points.samples)),
            "scatter_log_irradiance": self.scatter,
            "scatter_is_estimated": self.estimated_scatter,
        }


def calibrate(
    points: Points,
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    free: Sequence[str] = DEFAULT_FREE,
) -> Calibration:
    """Fit numbers of a design to levitation points of one or more samples.

    Parameters
    ----------
    points : Points
        From :func:`read_points`. Columns such as ``diameter`` or ``emittance`` give the properties
        in which samples differ from the flyer of the design.
    what : AbstractDesign, Setup, FlyerFile, path of a flyer file, or AbstractFlyer
        Gives everything that is not fitted, and the starting values. The coordinate of its
        environment must be the pressure.
    environment, model : optional
        Where ``what`` is a flyer.
    free : sequence of str
        Parameters: names of numbers in full, such as ``"force.c_fm"``, or their last parts, such
        as ``"c_fm"`` or ``"emittance"`` (of both faces), if only one number ends so. A name alone
        is one value for all samples; ``"emittance[Ge 2 cm]"`` is that of one sample.

    Returns
    -------
    Calibration

    Raises
    ------
    ParameterError
        If a name is unknown or given twice, there are fewer points than parameters, the points
        cannot tell the parameters apart, or no irradiance levitates a point at the start.
    ConvergenceError
        If the fit fails.

    Notes
    -----
    Derivatives are exact, through the root-find. The uncertainty of pressure enters through the
    slope of the fitted curve (effective variance). Intervals are those of the profile likelihood;
    if the scatter is estimated, their threshold is that of Fisher's distribution.

    Examples
    --------
    >>> import numpy as np
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk, chamber = lf.Disk(film, 0.01), lf.Chamber()
    >>> pressure = np.geomspace(1.0, 20.0, 8)
    >>> light = lf.levitate(disk, chamber.state(pressure), lf.Lu2023(0.4, 3.0)).irradiance
    >>> light = light * (1.0 + 0.01 * (-1.0) ** np.arange(8))  # synthetic scatter
    >>> numbers = {"pressure": pressure, "irradiance": light}
    >>> points = Points("synthetic", ["disk"] * 8, numbers)
    >>> fit = calibrate(points, disk, chamber, lf.Lu2023(0.5, 2.0))
    >>> print(f"{fit.values[0]:.2f} {fit.values[1]:.1f}")
    0.40 3.0
    """
    problem = problem_of(points, as_design(what, environment, model), free)
    _require_reachable(problem)
    fit, best, spread = _solve_weighted(problem)
    predicted, jacobian, _ = problem.linearised(best)
    weighted = jacobian * fit.weight[:, None]
    _require_distinct(weighted, problem.names)
    freedom = len(points) - best.size
    cost = fit.cost(best)
    estimated = not points.has_uncertainty
    variance = cost / freedom if estimated else 1.0
    limit = cost + _threshold(variance, freedom, estimated=estimated)
    in_logarithms = np.linalg.inv(weighted.T @ weighted) * variance
    intervals = [
        fit.interval(best, limit, number, first_order)
        for number, first_order in enumerate(np.sqrt(np.diag(in_logarithms)))
    ]
    values, residuals = np.exp(best), fit.measured - predicted
    return Calibration(
        problem=problem,
        values=values,
        covariance=in_logarithms * np.outer(values, values),
        intervals=np.exp(np.array(intervals)),
        scatter=float(np.sqrt(np.sum(residuals**2) / freedom)) if freedom else 0.0,
        estimated_scatter=estimated,
        residuals=residuals,
        uncertainty=np.full(len(points), np.sqrt(variance)) if estimated else spread,
        fitted=np.exp(predicted),
    )


def _threshold(variance: float, freedom: int, *, estimated: bool) -> float:
    """Increase of the cost at the ends of an interval."""
    if estimated:
        return float(variance * fdtri(1, freedom, CONFIDENCE))
    return float(chdtri(1, 1.0 - CONFIDENCE))


def _require_reachable(problem: Problem) -> None:
    points = problem.points
    out_of_reach = np.flatnonzero(problem.linearised(problem.start)[0] >= UNREACHABLE)
    if out_of_reach.size:
        first = out_of_reach[0]
        raise ParameterError(
            f"{points.source}: at the starting values no irradiance levitates "
            f"{points.samples[first]} at {points.pressure[first]:.4g} Pa "
            f"({out_of_reach.size} of {len(points)} points); start from other values, or remove "
            "those points"
        )


def _solve_weighted(problem: Problem) -> tuple[LeastSquares, np.ndarray, np.ndarray]:
    """Weighted fit, its best parameters, and the uncertainty of each log-irradiance."""
    points = problem.points
    spread = np.ones(len(points))
    fit = LeastSquares(problem, spread)
    try:
        best, _ = fit.solve(problem.start)
        for _ in range(_EFFECTIVE_VARIANCE_PASSES if points.has_uncertainty else 0):
            spread = _log_uncertainty(points, problem.linearised(best)[2])
            fit = LeastSquares(problem, 1.0 / spread)
            best, _ = fit.solve(best)
    except ParameterError:
        raise
    except ValueError as error:
        raise ConvergenceError(f"calibration: {error}") from None
    return fit, best, spread


def _log_uncertainty(points: Points, slope: np.ndarray) -> np.ndarray:
    """Uncertainty of log-irradiance, that of pressure included by the curve's slope."""
    exact = np.zeros(len(points))
    light = points.numbers.get("irradiance_uncertainty", exact) / points.irradiance
    pressure = points.numbers.get("pressure_uncertainty", exact) / points.pressure
    spread = np.hypot(light, slope * pressure)
    if np.any(spread == 0.0):
        point = int(np.argmin(spread)) + 1
        raise ParameterError(
            f"{points.source}: point {point} has no uncertainty, but others have; give one for each"
        )
    require_positive(uncertainty=spread)
    return spread


def _require_distinct(weighted: np.ndarray, names: list[str]) -> None:
    """Raise where the points cannot tell the parameters apart."""
    _, singular, directions = np.linalg.svd(weighted, full_matrices=False)
    if singular[-1] > _RANK_TOLERANCE * singular[0]:
        return
    mixed = [
        name for name, part in zip(names, directions[-1], strict=True) if abs(part) > _INVOLVED
    ]
    raise ParameterError(
        f"the points cannot tell {' and '.join(mixed)} apart; fit fewer parameters"
    )
