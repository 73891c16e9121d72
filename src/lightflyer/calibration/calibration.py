r"""Force coefficients, and film properties, from measured levitation points.

The model's irradiance to levitate is fitted to the measured one by least squares on

.. math:: r_i = \frac{\ln I_i^\mathrm{measured} - \ln I_i^\mathrm{model}}{\sigma_i}

jointly over all samples. What is fitted is the logarithm of each parameter, so that all stay
positive. Where the points carry no uncertainty, one relative scatter for all is estimated from
the residuals.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from scipy import stats
from scipy.optimize import OptimizeResult, brentq, least_squares

from lightflyer.calibration.points import Points
from lightflyer.config.sections import Setup
from lightflyer.environment.chamber import Chamber
from lightflyer.film.properties import HIGHEST_TAC, FilmProperties
from lightflyer.flight.levitation import levitate
from lightflyer.flyer.disk import Disk
from lightflyer.force.lu2023 import Lu2023
from lightflyer.foundation.checks import require_positive
from lightflyer.foundation.errors import ConvergenceError, ParameterError
from lightflyer.foundation.precision import quick_entry_point

# Name and largest value of what can be fitted.
FITTABLE = {
    "c_fm": np.inf,
    "c_cont": np.inf,
    "tac_top": HIGHEST_TAC,
    "tac_bottom": HIGHEST_TAC,
    "emittance": 1.0,
    "absorptance": 1.0,
}
"""What can be fitted, with the largest value allowed."""

DEFAULT_FREE = ("c_fm", "c_cont")
"""What is fitted where nothing else is asked for."""

CONFIDENCE = 0.95
"""Of the profile intervals."""

_SMALLEST = 1e-6  # lower bound of every parameter
_UNREACHABLE = 50.0  # log-irradiance that stands for "no irradiance levitates it"
_RANK_TOLERANCE = 1e-8  # of the Jacobian's singular values
_INVOLVED = 0.03  # share of a direction that names a parameter in a message
_INTERVAL_STEPS = 40  # doublings of the step that looks for an interval's end
_EFFECTIVE_VARIANCE_PASSES = 3


class _Problem(eqx.Module):
    """The data as arrays over the points; ``index`` is -1 where a property is not fitted."""

    base: np.ndarray  # (properties, points)
    index: np.ndarray  # (properties, points)
    pressure: np.ndarray
    radius: np.ndarray
    areal_density: np.ndarray
    environment: Chamber
    model: Lu2023


def _predicted(parameters: Any, log_pressure: Any, problem: _Problem) -> jax.Array:
    """Log-irradiance to levitate of log-parameters, shape (points,); can be traced."""
    index = problem.index.astype(int)
    fitted = jnp.exp(parameters)[jnp.maximum(index, 0)]
    values = dict(zip(FITTABLE, jnp.where(index >= 0, fitted, problem.base), strict=True))
    film = FilmProperties(
        areal_density=problem.areal_density,
        absorptance=values["absorptance"],
        emittance_top=values["emittance"],
        emittance_bottom=values["emittance"],
        tac_top=values["tac_top"],
        tac_bottom=values["tac_bottom"],
    )
    model = Lu2023(values["c_fm"], values["c_cont"], problem.model.reading)
    state = problem.environment.state(jnp.exp(log_pressure))
    found = levitate(Disk(film, problem.radius), state, model, throw=False)
    irradiance = jnp.where(found.levitates, found.irradiance, 1.0)
    return jnp.where(found.levitates, jnp.log(irradiance), _UNREACHABLE)


@quick_entry_point
def _log_irradiance(parameters: Any, problem: _Problem) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Log-irradiance to levitate, its Jacobian, and its slope over log-pressure."""
    log_pressure = jnp.log(problem.pressure)
    # forward mode, one direction after another: a loop compiles once what vmap would compile wide
    jacobian = jax.lax.map(
        lambda direction: jax.jvp(
            lambda x: _predicted(x, log_pressure, problem), (parameters,), (direction,)
        )[1],
        jnp.eye(parameters.size),
    ).T
    value, slope = jax.jvp(
        lambda x: _predicted(parameters, x, problem),
        (log_pressure,),
        (jnp.ones_like(log_pressure),),
    )
    return value, jacobian, slope


@dataclass(frozen=True)
class Calibration:
    """A fit of parameters to levitation points.

    Attributes
    ----------
    names : list of str
        Parameters, ``"emittance[Ge 2 cm]"`` where one belongs to one sample alone.
    values : array, shape (p,)
    covariance : array, shape (p, p)
        Of the values, to first order.
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
    points : Points
    """

    names: list[str]
    values: np.ndarray
    covariance: np.ndarray
    intervals: np.ndarray
    scatter: float
    estimated_scatter: bool
    residuals: np.ndarray
    uncertainty: np.ndarray
    fitted: np.ndarray
    points: Points

    @property
    def standard_uncertainties(self) -> np.ndarray:
        """Square roots of the covariance's diagonal, shape (p,)."""
        return np.sqrt(np.diag(self.covariance))

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


class _Fit:
    """Least squares over log-parameters, with any of them held at a value."""

    def __init__(self, problem: _Problem, measured: np.ndarray, bounds: np.ndarray):
        self.problem, self.measured, self.bounds = problem, measured, bounds
        self.weight = np.ones_like(measured)

    def model(self, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return _log_irradiance(parameters, self.problem)  # type: ignore[return-value]

    def solve(
        self, start: np.ndarray, held: int | None = None, value: float = np.nan
    ) -> tuple[np.ndarray, float]:
        """Parameters of least cost, and that cost: the sum of squared weighted residuals."""
        free = np.arange(start.size) != held
        if not free.any():
            parameters = np.array([value])
            return parameters, self.cost(parameters)
        cache: dict[bytes, Any] = {}

        def whole(part: np.ndarray) -> np.ndarray:
            parameters = np.where(free, 0.0, value)
            parameters[free] = part
            return parameters

        def evaluate(part: np.ndarray) -> Any:
            key = part.tobytes()
            if key not in cache:
                cache.clear()
                cache[key] = self.model(whole(part))
            return cache[key]

        found: OptimizeResult = least_squares(
            lambda part: (evaluate(part)[0] - self.measured) * self.weight,
            start[free],
            jac=lambda part: evaluate(part)[1][:, free] * self.weight[:, None],
            bounds=self.bounds[:, free],
            x_scale="jac",
            ftol=1e-12,
            xtol=1e-10,
            gtol=1e-12,
        )
        return whole(found.x), 2.0 * float(found.cost)

    def cost(self, parameters: np.ndarray) -> float:
        """Sum of squared weighted residuals."""
        return float(np.sum(((self.model(parameters)[0] - self.measured) * self.weight) ** 2))


def calibrate(points: Points, setup: Setup, free: Sequence[str] = DEFAULT_FREE) -> Calibration:
    """Fit force coefficients and film properties to levitation points of one or more samples.

    Parameters
    ----------
    points : Points
        From :func:`read_points`. Columns such as ``diameter`` or ``emittance``
        say what a sample is where it differs from the flyer of ``setup``.
    setup : Setup
        Flyer, chamber and :class:`Lu2023` model: what is not fitted, and where the fit starts.
    free : sequence of str
        Names from :data:`FITTABLE`: one value for all samples, or ``"emittance[Ge 2 cm]"`` for
        one sample alone.

    Returns
    -------
    Calibration

    Raises
    ------
    ParameterError
        If a name is unknown or stands twice, there are fewer points than parameters, the points
        cannot tell the parameters apart, or the model cannot levitate a point at the start.
    ConvergenceError
        If the fit fails.

    Notes
    -----
    Gradients are exact, through the root-find. The uncertainty of pressure counts by the slope
    of the fitted curve (effective variance). Intervals are those of the profile likelihood; with
    an estimated scatter their threshold is Fisher's.

    Examples
    --------
    >>> import numpy as np
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> setup = lf.Setup(lf.Disk(film, 0.01), lf.Chamber(), lf.Lu2023(0.5, 2.0), (None, None))
    >>> pressure = np.geomspace(1.0, 20.0, 8)
    >>> truth = lf.Lu2023(0.4, 3.0)
    >>> light = lf.levitate(setup.flyer, setup.environment.state(pressure), truth).irradiance
    >>> light = light * (1.0 + 0.01 * (-1.0) ** np.arange(8))  # synthetic scatter
    >>> numbers = {"pressure": pressure, "irradiance": light}
    >>> fit = calibrate(lf.Points("synthetic", ["disk"] * 8, numbers), setup)
    >>> print(f"{fit.values[0]:.2f} {fit.values[1]:.1f}")
    0.40 3.0
    """
    problem, names, start, bounds = _set_up(points, setup, free)
    fit = _Fit(problem, np.log(points.irradiance), bounds)
    _require_reachable(fit, start, points)
    best, spread = _solve_weighted(fit, start, points)
    predicted, jacobian, _ = fit.model(best)
    weighted = jacobian * fit.weight[:, None]
    _require_distinct(weighted, names)
    freedom = len(points) - len(names)
    cost = fit.cost(best)
    estimated = not _has_uncertainty(points)
    variance = cost / freedom if estimated else 1.0
    threshold = _threshold(variance, freedom, estimated=estimated)
    values = np.exp(best)
    in_logarithms = np.linalg.inv(weighted.T @ weighted) * variance
    intervals = [
        _interval(fit, best, cost + threshold, number, np.sqrt(in_logarithms[number, number]))
        for number in range(len(names))
    ]
    residuals = fit.measured - predicted
    return Calibration(
        names=names,
        values=values,
        covariance=in_logarithms * np.outer(values, values),
        intervals=np.exp(np.array(intervals)),
        scatter=float(np.sqrt(np.sum(residuals**2) / freedom)) if freedom else 0.0,
        estimated_scatter=estimated,
        residuals=residuals,
        uncertainty=np.full(len(points), np.sqrt(variance)) if estimated else spread,
        fitted=np.exp(predicted),
        points=points,
    )


def _has_uncertainty(points: Points) -> bool:
    return bool({"irradiance_uncertainty", "pressure_uncertainty"} & set(points.numbers))


def _threshold(variance: float, freedom: int, *, estimated: bool) -> float:
    """Increase of the cost at the ends of an interval."""
    if estimated:
        return float(variance * stats.f.ppf(CONFIDENCE, 1, freedom))
    return float(stats.chi2.ppf(CONFIDENCE, 1))


def _set_up(
    points: Points, setup: Setup, free: Sequence[str]
) -> tuple[_Problem, list[str], np.ndarray, np.ndarray]:
    """Problem, names, start and bounds of the log-parameters."""
    model, environment = setup.model, setup.environment
    if not isinstance(model, Lu2023) or not isinstance(environment, Chamber):
        raise ParameterError("calibration takes a chamber and the lu2023 force model")
    film, count = setup.flyer.film, len(points)
    stated = {
        "c_fm": model.c_fm,
        "c_cont": model.c_cont,
        "tac_top": film.tac_top,
        "tac_bottom": film.tac_bottom,
        "emittance": 0.5 * film.emittance_sum,
        "absorptance": film.absorptance,
        "areal_density": film.areal_density,
        "diameter": 2.0 * setup.flyer.radius,
    }
    columns = {
        name: points.numbers.get(name, np.full(count, float(value)))
        for name, value in stated.items()
    }
    base = np.stack([columns[name] for name in FITTABLE])
    index = np.full(base.shape, -1.0)
    start, highest = [], []
    for number, text in enumerate(free):
        name, chosen = _chosen(text, points)
        row = list(FITTABLE).index(name)
        if np.any(index[row, chosen] >= 0):
            raise ParameterError(f"{text} is fitted twice")
        index[row, chosen] = number
        start.append(float(np.exp(np.mean(np.log(base[row, chosen])))))
        highest.append(FITTABLE[name])
    if not start:
        raise ParameterError("nothing is free: name at least one parameter")
    needed = len(start) + (0 if _has_uncertainty(points) else 1)
    if count < needed:
        why = "" if needed == len(start) else " and their scatter"
        raise ParameterError(
            f"{points.source}: {count} points cannot fix {len(start)} parameters{why}"
        )
    problem = _Problem(
        base=base,
        index=index,
        pressure=points.pressure,
        radius=0.5 * columns["diameter"],
        areal_density=columns["areal_density"],
        environment=environment,
        model=model,
    )
    bounds = np.log(np.stack([np.full(len(start), _SMALLEST), np.array(highest)]))
    inside = np.minimum(np.log(start), bounds[1] - 1e-6)
    return problem, list(free), inside, bounds


def _chosen(text: str, points: Points) -> tuple[str, np.ndarray]:
    """Name of a parameter and the points that it concerns."""
    name, _, sample = text.partition("[")
    name, sample = name.strip(), sample.removesuffix("]").strip()
    if name not in FITTABLE:
        raise ParameterError(f'"{name}" cannot be fitted; there are: {", ".join(FITTABLE)}')
    if not sample:
        return name, np.ones(len(points), bool)
    chosen = points.of(sample)
    if not chosen.any():
        there = ", ".join(dict.fromkeys(points.samples))
        raise ParameterError(f'{text}: there is no sample "{sample}" in {points.source}: {there}')
    return name, chosen


def _require_reachable(fit: _Fit, start: np.ndarray, points: Points) -> None:
    out_of_reach = np.flatnonzero(fit.model(start)[0] >= _UNREACHABLE)
    if out_of_reach.size:
        first = out_of_reach[0]
        raise ParameterError(
            f"{points.source}: with the starting values no irradiance levitates "
            f"{points.samples[first]} at {points.pressure[first]:.4g} Pa "
            f"({out_of_reach.size} of {len(points)} points): start from other values, or leave "
            "those points out"
        )


def _solve_weighted(fit: _Fit, start: np.ndarray, points: Points) -> tuple[np.ndarray, np.ndarray]:
    """Best parameters, and the uncertainty of each log-irradiance behind their weights."""
    try:
        best, _ = fit.solve(start)
        spread = np.ones(len(points))
        if _has_uncertainty(points):
            for _ in range(_EFFECTIVE_VARIANCE_PASSES):
                spread = _log_uncertainty(points, fit.model(best)[2])
                fit.weight = 1.0 / spread
                best, _ = fit.solve(best)
    except ValueError as error:
        raise ConvergenceError(f"calibration: {error}") from None
    return best, spread


def _log_uncertainty(points: Points, slope: np.ndarray) -> np.ndarray:
    """Uncertainty of log-irradiance, that of pressure included by the curve's slope."""
    nothing = np.zeros(len(points))
    light = points.numbers.get("irradiance_uncertainty", nothing) / points.irradiance
    pressure = points.numbers.get("pressure_uncertainty", nothing) / points.pressure
    spread = np.hypot(light, slope * pressure)
    if np.any(spread == 0.0):
        point = int(np.argmin(spread)) + 1
        raise ParameterError(
            f"{points.source}: point {point} has no uncertainty while others have; give each one"
        )
    require_positive(uncertainty=spread)
    return spread


def _require_distinct(weighted: np.ndarray, names: list[str]) -> None:
    """Raise where the points cannot tell the parameters apart."""
    _, singular, directions = np.linalg.svd(weighted, full_matrices=False)
    if singular[-1] > _RANK_TOLERANCE * singular[0]:
        return
    blurred = [
        name for name, part in zip(names, directions[-1], strict=True) if abs(part) > _INVOLVED
    ]
    raise ParameterError(f"the points cannot tell {' and '.join(blurred)} apart; free fewer")


def _interval(
    fit: _Fit, best: np.ndarray, limit: float, number: int, scale: float
) -> tuple[float, float]:
    """Where the profile of the cost over one log-parameter reaches a limit, or its bounds.

    ``scale`` is the parameter's first-order standard uncertainty, for a first step.
    """
    lower, upper = (
        _interval_end(fit, best, limit, number, direction * scale, bound)
        for direction, bound in ((-1.0, fit.bounds[0][number]), (1.0, fit.bounds[1][number]))
    )
    return lower, upper


def _interval_end(
    fit: _Fit, best: np.ndarray, limit: float, number: int, step: float, bound: float
) -> float:
    start = best

    def excess(value: float) -> float:
        nonlocal start
        start, cost = fit.solve(start, number, value)
        return cost - limit

    inside: float = best[number]
    clip: Callable[[float], float] = (
        (lambda x: max(x, bound)) if step < 0.0 else (lambda x: min(x, bound))
    )
    for _ in range(_INTERVAL_STEPS):
        outside = clip(inside + 2.0 * step)
        if excess(outside) >= 0.0:
            return float(brentq(excess, inside, outside, xtol=1e-5, rtol=1e-8))
        if outside == bound:
            return bound
        inside, step = outside, 1.5 * step
    return inside
