r"""Weighted least squares over log-parameters, and intervals of the profile likelihood.

What the inputs' uncertainties add: a parameter is a function of the points and of the inputs, since
each input that is moved by its error gives another fit. By first order, with the Jacobians
:math:`J` in the log-parameters and :math:`J_x` in the inputs and the weights :math:`W`,

.. math:: \frac{\mathrm d\ln\theta}{\mathrm dx} = -(J^\mathsf{T} W J)^{-1} J^\mathsf{T} W J_x .

Intervals need more than that: a coefficient that multiplies a difference of two uncertain numbers
grows without limit where the difference vanishes. Their ends are the least and the greatest value
that fits reach within the ellipsoid :math:`x^\mathsf{T}\Sigma^{-1}x \le 1.96^2` of the inputs'
errors, which is the first-order reliability method [HasoferLind1974]_: exact where the parameter
grows steadily with one combination of normal inputs, however bent the relation is.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import OptimizeResult, brentq, least_squares

from lightflyer.calibration.problem import UNREACHABLE, Linearised, Problem
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95

_INTERVAL_STEPS = 40  # growing steps that look for an interval's end

RADIUS = NORMAL_HALF_WIDTH_95  # Radius of the ellipsoid in standard uncertainties, for 95 %

_STEP = 0.125  # of the radius, the longest on the way to the ellipsoid
_SHORTEST = 1e-3  # of the radius: where shorter ones are needed, nothing levitates beyond
_ROUNDS = 20  # on the ellipsoid
_SETTLED = 1e-3  # change of the log-parameter at which the search on the ellipsoid ends
_GAUSS_NEWTON = 8  # steps before the slower search
_CLOSE = 1e-7  # change of the log-parameters at which they end
_INSIDE = 1e-9  # distance of an input from the ends of its range, of its standard uncertainty


@dataclass(frozen=True, eq=False)
class LeastSquares:
    """Sum of squared weighted residuals of log-irradiance."""

    problem: Problem
    weight: np.ndarray  # shape (n,); of each residual, one over its uncertainty
    # shape (k,); errors of the inputs in their standard uncertainties
    shifts: np.ndarray | None = None

    @property
    def measured(self) -> np.ndarray:
        """Measured log-irradiance, shape (n,)."""
        return np.log(self.problem.points.irradiance)

    def cost(self, parameters: np.ndarray) -> float:
        """Sum of squared weighted residuals at log-parameters of shape (p,)."""
        predicted = self.at(parameters).value
        return float(np.sum(((predicted - self.measured) * self.weight) ** 2))

    def at(self, parameters: np.ndarray) -> Linearised:
        """Log-irradiance of the model and its derivatives, at log-parameters of shape (p,)."""
        return self.problem.linearise(parameters, self.shifts)

    def solve(
        self, start: np.ndarray, held: int | None = None, value: float = np.nan
    ) -> tuple[np.ndarray, float]:
        """Log-parameters of least cost; returns ``parameters`` (p,), ``cost``; ``start`` (p,)."""
        free = np.arange(start.size) != held
        if not free.any():
            parameters = np.array([value])
            return parameters, self.cost(parameters)
        lower, upper = self.problem.bounds
        cache: dict[bytes, Linearised] = {}

        def whole(part: np.ndarray) -> np.ndarray:
            parameters = np.where(free, 0.0, value)
            parameters[free] = part
            return parameters

        def evaluate(part: np.ndarray) -> Linearised:
            key = part.tobytes()
            if key not in cache:
                cache.clear()
                cache[key] = self.at(whole(part))
            return cache[key]

        found: OptimizeResult = least_squares(
            lambda part: (evaluate(part).value - self.measured) * self.weight,
            np.clip(start, lower, upper)[free],
            jac=lambda part: evaluate(part).jacobian[:, free] * self.weight[:, None],
            bounds=(lower[free], upper[free]),
            x_scale="jac",
            ftol=1e-12,
            xtol=1e-10,
            gtol=1e-12,
        )
        return whole(found.x), 2.0 * float(found.cost)

    def interval(
        self, best: np.ndarray, limit: float, number: int, scale: float
    ) -> tuple[float, float]:
        """Where the profile of the cost over one log-parameter reaches a limit; ``best`` (p,)."""
        lowest, highest = self.problem.bounds[:, number]
        return (
            self._interval_end(best, limit, number, -scale, lowest),
            self._interval_end(best, limit, number, scale, highest),
        )

    def _interval_end(
        self, best: np.ndarray, limit: float, number: int, step: float, bound: float
    ) -> float:
        start = best
        known: dict[float, float] = {}

        # each value is looked at once: a second search could end in another minimum
        def excess(value: float) -> float:
            nonlocal start
            if value not in known:
                start, cost = self.solve(start, number, value)
                known[value] = cost - limit
            return known[value]

        clip: Callable[[float, float], float] = max if step < 0.0 else min
        inside = float(best[number])
        known[inside] = self.cost(best) - limit
        for _ in range(_INTERVAL_STEPS):
            outside = clip(inside + 2.0 * step, bound)
            if excess(outside) >= 0.0:
                return float(brentq(excess, inside, outside, xtol=1e-5, rtol=1e-8))
            if outside == bound:
                return float(bound)
            inside, step = outside, 1.5 * step
        return inside


@dataclass(frozen=True)
class FromInputs:
    """What the inputs' uncertainties do to the parameters."""

    # shape (p, k); change of each log-parameter by one standard uncertainty of each input, to first
    # order
    slopes: np.ndarray
    # shape (p, p); covariance of the log-parameters by the inputs, to first order
    covariance: np.ndarray
    # shape (p, 2); least and greatest log-parameters within the inputs' ellipsoid; infinite where
    # nothing levitates in a part of it
    ends: np.ndarray


def from_inputs(fit: LeastSquares, best: np.ndarray) -> FromInputs:
    """Find what the inputs' uncertainties do to the parameters; ``best`` (p,)."""
    inputs = fit.problem.inputs
    count = len(inputs.names)
    if not count:
        empty = np.zeros((best.size, 0))
        return FromInputs(empty, np.zeros((best.size,) * 2), np.stack([best, best], axis=1))
    values, vectors = np.linalg.eigh(inputs.correlation)
    factor = np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
    search = _Search(replace(fit, shifts=np.zeros(count)), factor)
    slopes = search.slopes(best, np.zeros(count))
    ends = [[search.end(best, number, sign) for sign in (-1.0, 1.0)] for number in range(best.size)]
    return FromInputs(slopes, slopes @ inputs.correlation @ slopes.T, np.array(ends))


@dataclass(frozen=True, eq=False)
class _Search:
    """Fits at other inputs, and the way to the ellipsoid's end."""

    fit: LeastSquares
    factor: np.ndarray

    def shifts(self, place: np.ndarray) -> np.ndarray:
        """Errors of the inputs at a place among independent ones, within their ranges."""
        low, high = self.fit.problem.inputs.ranges.T
        return np.clip(self.factor @ place, low + _INSIDE, high - _INSIDE)

    def slopes(self, parameters: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Change of the best log-parameters by each input's error, shape (p, k)."""
        here = replace(self.fit, shifts=self.shifts(place)).at(parameters)
        weighted = here.jacobian * self.fit.weight[:, None]
        moved = here.by_inputs * self.fit.weight[:, None]
        # a parameter at its bound or one without effect does not move
        return -np.linalg.pinv(weighted) @ moved

    def refit(self, start: np.ndarray, place: np.ndarray) -> np.ndarray | None:
        """Best log-parameters at a place; None where no irradiance levitates a point."""
        fit = replace(self.fit, shifts=self.shifts(place))
        lower, upper = fit.problem.bounds
        found = np.clip(start, lower, upper)
        for _ in range(_GAUSS_NEWTON):  # the start is close, so a few steps suffice
            here = fit.at(found)
            if np.any(here.value >= UNREACHABLE):
                break
            change, *_ = np.linalg.lstsq(
                here.jacobian * fit.weight[:, None], (fit.measured - here.value) * fit.weight
            )
            found = found + change
            if np.any((found < lower) | (found > upper)):
                break
            if np.max(np.abs(change)) < _CLOSE:
                return found
        start = np.clip(start, lower, upper)
        if np.any(fit.at(start).value >= UNREACHABLE):
            return None
        found, _ = fit.solve(start)
        return None if np.any(fit.at(found).value >= UNREACHABLE) else found

    def end(self, best: np.ndarray, number: int, sign: float) -> float:
        """Least (sign -1) or greatest (sign 1) value of a log-parameter in the ellipsoid."""
        place = np.zeros(self.factor.shape[1])
        parameters, step, radius = best, _STEP * RADIUS, 0.0
        slopes = self.slopes(parameters, place) @ self.factor
        while radius < RADIUS and np.any(slopes[number]):
            further = min(radius + step, RADIUS)
            target = sign * further * _direction(slopes[number])
            found = self.refit(parameters + slopes @ (target - place), target)
            if found is None:
                step *= 0.5
                if step < _SHORTEST * RADIUS:
                    return sign * np.inf
                continue
            place, parameters, radius = target, found, further
            slopes = self.slopes(parameters, place) @ self.factor
        # where the direction of steepest change is that from the centre
        value = float(parameters[number])
        for _ in range(_ROUNDS):
            slopes = self.slopes(parameters, place) @ self.factor
            if not np.any(slopes[number]):
                break
            target = sign * RADIUS * _direction(slopes[number])
            found = self.refit(parameters + slopes @ (target - place), target)
            if found is None:
                return sign * np.inf
            change = sign * (float(found[number]) - value)
            if change < _SETTLED:
                return value + sign * max(change, 0.0)
            place, parameters, value = target, found, float(found[number])
        return value


def _direction(vector: np.ndarray) -> np.ndarray:
    return np.asarray(vector / np.linalg.norm(vector))
