"""Weighted least squares over log-parameters, and intervals of the profile likelihood."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, brentq, least_squares

from lightflyer.calibration.problem import Linearised, Problem

_INTERVAL_STEPS = 40  # growing steps that look for an interval's end


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
