r"""Profile intervals: how far one parameter can go while all others follow."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq, leastsq

from lightflyer.lab.tac.problem import PARAMETERS, TAC_BOUNDS, JointProblem

_POSITIVE = (0, 1)  # places of the positive parameters; their logarithms are worked on
_FURTHEST = {"tac": TAC_BOUNDS, "area_ratio": (1e-3, 1e3), "offset": (-1e3, 1e3)}
_GROWTH = 1.7  # of the step outwards until the interval's end is passed
_MOST_STEPS = 40
_LOG_RANGE = 50.0  # of the logarithms of the positive unknowns
_TOLERANCE = 1e-3  # of the distance in standard errors


def profile_interval(
    problem: JointProblem,
    values: Sequence[float],
    run: int,
    name: str,
    spread: float,
    distance: float,
) -> tuple[float, float]:
    r"""Interval of a run's parameter in which the sum of squares rises by less than a square."""
    # The root of the rise is nearly linear in the parameter, so few minimisations are needed.
    profile = _Profile(problem, values, len(PARAMETERS) * run + PARAMETERS.index(name))
    lowest, highest = _FURTHEST[name]
    return (
        _end(profile, -spread * distance, lowest, distance, -np.inf),
        _end(profile, spread * distance, highest, distance, np.inf),
    )


class _Profile:
    """Root of the least rise of the sum of squares, with one unknown held."""

    def __init__(self, problem: JointProblem, values: Sequence[float], held: int):
        self.problem, self.held = problem, held
        width = len(PARAMETERS)
        places = range(len(problem.parameters))
        self.positive = [place for place in places if place % width in _POSITIVE]
        self.best = np.array(values, float)
        self.least = float(np.sum(problem.residuals(*values) ** 2))
        self.others = np.delete(np.arange(len(self.best)), held)
        self.start = self._inner(self.best)
        # once found, so that a root search sees one function whatever it starts from
        self.known = {float(self.best[held]): 0.0}

    def restart(self) -> None:
        """Search from the minimum again."""
        self.start = self._inner(self.best)

    def _inner(self, values: np.ndarray) -> np.ndarray:
        inner = values.copy()
        positive = np.maximum(inner[self.positive], np.finfo(float).tiny)
        inner[self.positive] = np.log(positive)
        return inner[self.others]

    def _outer(self, inner: np.ndarray, held: float) -> np.ndarray:
        values = np.insert(inner, self.held, held)
        for index in self.positive:
            if index != self.held:
                values[index] = np.exp(np.clip(values[index], -_LOG_RANGE, _LOG_RANGE))
        return values

    def __call__(self, held: float) -> float:
        """Root of the rise at a value of the held unknown."""
        if held not in self.known:
            self.known[held] = self._root_of_rise(held)
        return self.known[held]

    def _root_of_rise(self, held: float) -> float:

        def residuals(inner: np.ndarray) -> np.ndarray:
            return self.problem.residuals(*self._outer(inner, held))

        def jacobian(inner: np.ndarray) -> np.ndarray:
            values = self._outer(inner, held)
            rows = self.problem.jacobian(*values)
            rows[self.positive] *= values[self.positive, None]
            return np.asarray(rows[self.others])

        # a search that does not settle has run off to where the rise hardly changes any more
        found, *_ = leastsq(residuals, self.start, Dfun=jacobian, col_deriv=True, full_output=True)
        rise = float(np.sum(residuals(found) ** 2)) - self.least
        if np.all(np.isfinite(found)):
            self.start = found
        return float(np.sqrt(max(rise, 0.0)))


def _end(profile: _Profile, step: float, furthest: float, distance: float, nowhere: float) -> float:
    """Where the profile reaches the distance, outwards from the minimum."""
    best = float(profile.best[profile.held])
    profile.restart()
    inside = best
    for _ in range(_MOST_STEPS):
        outside = best + step
        if (outside - furthest) * step >= 0.0:
            outside = furthest
        if profile(outside) > distance:
            tolerance = _TOLERANCE * abs(outside - best) / distance
            return float(
                brentq(lambda held: profile(held) - distance, inside, outside, xtol=tolerance)
            )
        if outside == furthest:
            break
        inside, step = outside, _GROWTH * step
    return nowhere
