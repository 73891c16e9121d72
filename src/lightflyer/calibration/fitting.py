r"""Force coefficients, film properties and other numbers from measured levitation points.

The model's irradiance to levitate is fitted to the measured one by least squares on

.. math:: r_i = \frac{\ln I_i^\mathrm{measured} - \ln I_i^\mathrm{model}}{\sigma_i}

jointly over all samples. The logarithm of each parameter is fitted, so that all stay positive.
Where the points carry no uncertainty, one relative scatter for all is estimated from the
residuals.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.special import chdtri, fdtri

from lightflyer.calibration.calibration import Calibration, diagnose
from lightflyer.calibration.inputs import instruments
from lightflyer.calibration.least_squares import LeastSquares, from_inputs
from lightflyer.calibration.points import Points, log_uncertainty
from lightflyer.calibration.problem import (
    DEFAULT_FREE,
    UNREACHABLE,
    Parameter,
    Problem,
    problem_of,
)
from lightflyer.config.designs import as_design
from lightflyer.core.checks import require_positive
from lightflyer.core.errors import ConvergenceError, ParameterError
from lightflyer.core.quantity import require_record
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.numerics.residuals import alike_points

CONFIDENCE = 0.95  # Probability of an interval

_RANK_TOLERANCE = 1e-8  # of the Jacobian's singular values
_INVOLVED = 0.03  # share of a direction that names a parameter in a message
_EFFECTIVE_VARIANCE_PASSES = 3
_START_FACTORS = (2.0, 0.5, 5.0, 0.2, 20.0, 0.05, 100.0, 0.01)  # of starting values, in turn
_UNDETERMINED = 1.0  # relative standard uncertainty of a value at the end of its range
_NEAR_END = 1e-3  # distance from there, of a log-parameter
_AT_END = 1e-6  # distance of a log-parameter from the end of its range that counts as none


def calibrate(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    points: Points,
    free: str | Sequence[str] = DEFAULT_FREE,
    pressure_accuracy: float | None = None,
    irradiance_accuracy: float | None = None,
    scale_errors: bool = False,
) -> Calibration:
    """Fit numbers of a design to levitation points of one or more samples.

    Parameters
    ----------
    what : AbstractDesign, Setup, FlyerFile, path of a flyer file, or AbstractFlyer
        Gives everything that is not fitted, and the starting values. The coordinate of its
        environment must be the pressure.
    environment, model : optional
        Where ``what`` is a flyer.
    points : Points
        From :func:`read_points`. Columns such as ``diameter`` or ``emittance`` give the properties
        in which samples differ from the flyer of the design, and ``emittance_uncertainty`` the
        standard uncertainty of one.
    free : sequence of str
        Parameters: names of numbers in full, such as ``"force.c_fm"``, or their last parts, such
        as ``"c_fm"`` or ``"emittance"`` (of both faces), if only one number ends so. A name alone
        is one value for all samples; ``"emittance[Ge 2 cm]"`` is that of one sample.
    pressure_accuracy, irradiance_accuracy : float, optional
        Relative standard uncertainty of the calibration of pressure gauge and light meter, which
        moves all points together. Where none is stated, a warning says what is assumed.
    scale_errors : bool
        Multiply the stated uncertainties of the points by the root of the reduced chi-squared, as
        if only their ratios were known.

    Returns
    -------
    Calibration

    Raises
    ------
    ParameterError
        If a name is unknown or given twice, there are fewer points than parameters, the points
        cannot tell the parameters apart, no irradiance levitates a point from any start, or errors
        cannot be scaled.
    ConvergenceError
        If the fit fails.

    Notes
    -----
    Derivatives are exact, through the root-find. The uncertainty of pressure enters through the
    slope of the fitted curve (effective variance). Intervals are those of the profile likelihood;
    if the scatter is estimated, their threshold is that of Fisher's distribution, and they are
    widened where the residuals show that points scatter unevenly [MacKinnonWhite1985]_. The total
    ones add what the inputs' uncertainties move the fit by; see
    :mod:`lightflyer.calibration.least_squares`. The two half-widths, of the logarithm, add in
    quadrature.

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
    >>> fit = calibrate(disk, chamber, lf.Lu2023(0.5, 2.0), points=points)
    >>> print(f"{fit.values[0]:.2f} {fit.values[1]:.1f}")
    0.40 3.0
    """
    require_record("points", (Points,), points)
    require_positive(pressure=points.pressure, irradiance=points.irradiance)
    free = (free,) if isinstance(free, str) else free
    meters, assumed = instruments(pressure_accuracy, irradiance_accuracy)
    problem = problem_of(points, as_design(what, environment, model), free, meters)
    fit, best, spread = _solve_weighted(problem, _reachable_start(problem))
    here = fit.at(best)
    freedom, cost = len(points) - best.size, fit.cost(best)
    _require_distinct(here.jacobian * fit.weight[:, None], problem.names)
    estimated = not points.has_uncertainty
    scaled = scale_errors and not estimated
    if scaled and not freedom:
        raise ParameterError(
            f"{points.source}: as many parameters as points leave nothing to scale errors by"
        )
    values, residuals = np.exp(best), fit.measured - here.value
    order = np.lexsort((points.pressure, np.array(points.samples)))
    alike = alike_points((residuals * fit.weight)[order])
    scale = cost / freedom if estimated or scaled else 1.0
    variance = alike * scale
    # the cost at the ends of an interval
    quantile = fdtri(1, freedom, CONFIDENCE) if estimated or scaled else chdtri(1, 1.0 - CONFIDENCE)
    limit = cost + float(variance * quantile)
    weighted = here.jacobian * fit.weight[:, None]
    in_logarithms = np.asarray(np.linalg.inv(weighted.T @ weighted)) * variance
    inputs = from_inputs(fit, best)
    steps = np.sqrt(np.diag(in_logarithms))
    at_end = np.abs(best - problem.bounds).min(axis=0) < _NEAR_END
    for row in np.flatnonzero(at_end & (steps > _UNDETERMINED)):
        value = math.exp(best[row])
        raise ParameterError(
            f"the points do not determine {problem.names[row]}: {value:.3g} ± "
            f"{value * steps[row]:.2g}, at the end of its range; fit fewer parameters, or fix it"
        )
    ends = np.array([fit.interval(best, limit, row, step) for row, step in enumerate(steps)])
    if estimated:
        # One scatter for all points is an assumption. The covariance of [MacKinnonWhite1985]_
        # ("HC3"), in which each point has that of its own residual, needs none: where points
        # scatter unevenly, uncertainties are larger.
        inverse = np.linalg.inv(here.jacobian.T @ here.jacobian)
        leverage = np.einsum("ij,jk,ik->i", here.jacobian, inverse, here.jacobian)
        own = residuals / np.maximum(1.0 - leverage, np.finfo(float).eps)
        half, least = inverse @ (here.jacobian.T * own), np.finfo(float).tiny
        ratio = np.diag(half @ half.T) / np.maximum(np.diag(in_logarithms), least)
        wider = np.sqrt(np.maximum(ratio, 1.0))
        in_logarithms = in_logarithms * np.outer(wider, wider)
        ends = best[:, None] + wider[:, None] * (ends - best[:, None])
    ends = _open(ends, problem)
    both = np.hypot(ends - best[:, None], _open(inputs.ends, problem) - best[:, None])
    natural = np.outer(values, values)
    shares = zip(problem.inputs.names, np.abs(inputs.slopes.T), strict=True)
    found = Calibration(
        problem=problem,
        values=values,
        covariance=in_logarithms * natural,
        intervals=_natural(ends, problem.parameters),
        total_covariance=(in_logarithms + inputs.covariance) * natural,
        total_intervals=_natural(best[:, None] + both * [-1.0, 1.0], problem.parameters),
        contributions={name: share for name, share in shares if np.any(share)},
        scatter=float(np.sqrt(np.sum(residuals**2) / freedom)) if freedom else 0.0,
        estimated_scatter=estimated,
        chi_squared=math.nan if estimated else cost,
        freedom=freedom,
        error_scale=math.sqrt(scale) if scaled else 1.0,
        residuals=residuals,
        alike=alike,
        uncertainty=spread * math.sqrt(scale),
        fitted=np.exp(here.value),
        warnings=(),
    )
    return replace(found, warnings=(*points.warnings, *diagnose(found), *assumed))


def _open(ends: np.ndarray, problem: Problem) -> np.ndarray:
    """Ends of intervals of the logarithm, infinite where the search reached its own end."""
    lower, upper = problem.bounds
    low, high = ends.T
    return np.stack(
        [
            np.where(low <= lower + _AT_END, -np.inf, low),
            np.where(high >= upper - _AT_END, np.inf, high),
        ],
        axis=1,
    )


def _natural(ends: np.ndarray, parameters: Sequence[Parameter]) -> np.ndarray:
    """Ends of intervals, cut at what is possible."""
    least, most = np.array([parameter.ends for parameter in parameters]).T
    return np.clip(np.exp(ends), least[:, None], most[:, None])


def _reachable_start(problem: Problem) -> np.ndarray:
    """Log-parameters from which some irradiance levitates every point."""
    points, lower, upper = problem.points, *problem.bounds
    start = problem.start
    out_of_reach = np.flatnonzero(problem.linearise(start).value >= UNREACHABLE)
    if not out_of_reach.size:
        return start
    for factor in _START_FACTORS:
        for moved in (*np.eye(start.size), np.ones(start.size)):
            other = np.clip(start + math.log(factor) * moved, lower, upper - _AT_END)
            if np.all(problem.linearise(other).value < UNREACHABLE):
                return other
    first = out_of_reach[0]
    line = f":{points.lines[first]}" if points.lines else ""
    raise ParameterError(
        f"{points.source}{line}: at the starting values no irradiance levitates "
        f"{points.samples[first]} at {points.pressure[first]:.4g} Pa "
        f"({out_of_reach.size} of {len(points)} points), nor at others tried; check the flyer's "
        "TACs, start from other values, or remove those points"
    )


def _solve_weighted(
    problem: Problem, start: np.ndarray
) -> tuple[LeastSquares, np.ndarray, np.ndarray]:
    """Weighted fit, its best parameters, and the uncertainty of each log-irradiance."""
    points = problem.points
    spread = np.ones(len(points))
    fit = LeastSquares(problem, spread)
    try:
        best, _ = fit.solve(start)
        for _ in range(_EFFECTIVE_VARIANCE_PASSES if points.has_uncertainty else 0):
            spread = log_uncertainty(points.numbers, fit.at(best).slope, points.source)
            fit = LeastSquares(problem, 1.0 / spread)
            best, _ = fit.solve(best)
    except ParameterError:
        raise
    except ValueError as error:
        raise ConvergenceError(f"calibration: {error}") from None
    return fit, best, spread


def _require_distinct(weighted: np.ndarray, names: list[str]) -> None:
    """Raise where the points cannot tell the parameters apart."""
    for name, column in zip(names, weighted.T, strict=True):
        if not np.any(column):
            raise ParameterError(f"{name} has no effect on the light that lifts at these points")
    _, singular, directions = np.linalg.svd(weighted, full_matrices=False)
    if singular[-1] > _RANK_TOLERANCE * singular[0]:
        return
    mixed = [
        name for name, part in zip(names, directions[-1], strict=True) if abs(part) > _INVOLVED
    ]
    raise ParameterError(
        f"the points cannot tell {' and '.join(mixed)} apart; fit fewer parameters"
    )
