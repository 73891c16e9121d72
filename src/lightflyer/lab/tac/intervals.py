r"""Intervals of a heater's fitted parameters, from their covariance and from the profile.

The scatter of the rows gives the statistical part, with the errors that all rows have in common
held at their best values. The total also includes those errors, each with its prior.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, leastsq

from lightflyer.lab.estimate import Estimate, student_factor
from lightflyer.lab.tac.data import DRIFT
from lightflyer.lab.tac.problem import PARAMETERS, TAC_BOUNDS, HeaterProblem, minimise
from lightflyer.numerics.residuals import alike_points

POSITIVE = ("tac", "area_ratio")  # Parameters whose logarithms have the more nearly normal errors
_WIDTH = len(PARAMETERS)

LAW_ERROR = 2e-3
"""Relative standard error of the law's shape within a decade of pressure [1]: the kinetic law's
heat is within 0.35 % of the solver's, which is divided by √3. What the parameters take up of it is
an error of theirs."""

LAW_OWN = 0.25
"""Share of it that two runs on one bench do not share: at one pressure the error changes by 0.05 %
at most from a coefficient of 0.6 to 0.8, and to 1."""

_ALIKE_TAC = 0.5  # coefficient below which it changes by up to 0.2 %: nothing is taken as shared

_LARGEST_EXPONENT = 300.0
_UNITS = ("", "", "W/(m^2 K)")
_ROUNDING = 1e-10  # relative scatter that is rounding, not noise
_LEAST_SCATTER = 1e-4  # relative; no bench measures a conductance better
_ROUNDS = 6  # of scatter and common errors, each from the other
_MOST_PARTS = 8  # of a decade, in which the law's shape errs by itself
_SAME = 1e-3  # standard errors
_FURTHEST = {"tac": TAC_BOUNDS, "area_ratio": (1e-3, 1e3), "offset": (-1e3, 1e3)}
_GROWTH = 1.7  # of the step outwards until the interval's end is passed
_MOST_STEPS = 40
_LOG_RANGE = 50.0  # of the logarithms of the positive unknowns
_TOLERANCE = 1e-3  # of the distance in standard errors


def profile_interval(
    problem: HeaterProblem, values: Sequence[float], held: int, spread: float, distance: float
) -> tuple[float, float]:
    """Interval of an unknown in which the sum of squares rises by less than a square."""
    # The root of the rise is nearly linear in the parameter, so few minimisations are needed. The
    # logarithms of positive parameters are worked on.
    best, least = np.array(values, float), float(np.sum(problem.residuals(values) ** 2))
    named = np.array([*PARAMETERS * problem.runs, *problem.errors])
    positive = np.flatnonzero(np.isin(named, POSITIVE))
    others, logs = np.delete(np.arange(best.size), held), positive[positive != held]
    # once found, so that a root search sees one function whatever it starts from
    known, start = {float(best[held]): 0.0}, np.zeros(0)

    def outer(inner: np.ndarray, at: float) -> np.ndarray:
        whole = np.insert(inner, held, at)
        whole[logs] = np.exp(np.clip(whole[logs], -_LOG_RANGE, _LOG_RANGE))
        return whole

    def rise(at: float) -> float:
        """Root of the least rise of the sum of squares at a value of the parameter."""
        nonlocal start
        if at in known:
            return known[at]

        def slopes(inner: np.ndarray) -> np.ndarray:
            whole = outer(inner, at)
            rows = problem.jacobian(whole)
            rows[positive] *= whole[positive, None]
            return np.asarray(rows[others])

        # a search that does not settle has run off to where the rise hardly changes any more
        found, *_ = leastsq(
            lambda inner: problem.residuals(outer(inner, at)), start, Dfun=slopes, col_deriv=True,
            full_output=True,
        )  # fmt: skip
        more = float(np.sum(problem.residuals(outer(found, at)) ** 2)) - least
        start = found if np.all(np.isfinite(found)) else start
        known[at] = float(np.sqrt(max(more, 0.0)))
        return known[at]

    ends = []
    for side, furthest in zip((-1.0, 1.0), _FURTHEST[named[held]], strict=True):
        inner = best.copy()
        inner[positive] = np.log(np.maximum(inner[positive], np.finfo(float).tiny))
        start, inside, end = inner[others], best[held], side * np.inf
        step = side * spread * distance
        for _ in range(_MOST_STEPS):
            outside = best[held] + step
            if (outside - furthest) * step >= 0.0:
                outside = furthest
            if rise(float(outside)) > distance:
                tolerance = _TOLERANCE * abs(outside - best[held]) / distance
                end = brentq(lambda at: rise(at) - distance, inside, outside, xtol=tolerance)
                break
            if outside == furthest:
                break
            inside, step = outside, _GROWTH * step
        ends.append(float(end))
    return ends[0], ends[1]


@dataclass(frozen=True)
class HeaterSolution:
    """A fit with its intervals."""

    # The three parameters and the common errors in standard errors, by name
    values: dict[str, float]
    scatter: float  # Relative scatter of the rows [1]
    alike: float  # Rows of neighbouring pressures that deviate from the fit together
    covariance: np.ndarray  # Total, of the three parameters, shape (3, 3)
    total: dict[str, Estimate]  # By names of PARAMETERS, with profile intervals
    statistical: dict[str, Estimate]
    # With the intervals of the covariance, of positive parameters symmetric in the logarithm
    total_normal: dict[str, Estimate]


def solve(
    problems: Sequence[HeaterProblem], guesses: Sequence[Sequence[float]]
) -> tuple[list[HeaterSolution], np.ndarray]:
    """Minimise runs on one bench together, and find all intervals.

    ``guesses``: the three parameters of each run near the minimum. Returns a solution for each
    run, and the total covariance of their coefficients, shape (n, n).
    """
    if len(problems) > 1:  # the plateau of each drifts by itself
        problems = [
            replace(problem, errors={
                f"{DRIFT}_{run}" if name == DRIFT else name: one
                for name, one in problem.errors.items()
            })
            for run, problem in enumerate(problems)
        ]  # fmt: skip
    runs, joint = _minimise_all(problems, guesses)
    solutions = []
    for number, (problem, run) in enumerate(zip(problems, runs, strict=True)):
        best, freedom = run.values, float(len(problem.conductance) - _WIDTH)
        covariance = run.alike * np.asarray(run.result.covar)
        freedoms = dict.fromkeys(PARAMETERS, freedom)
        profiled = normal = _normal(best, covariance, freedoms)
        if run.scatter > _ROUNDING:  # rows without scatter have no profile
            # very many rows are grouped; what scatters within a group is in the scatter already
            rows = _scaled(run.problem, 1.0 / (run.scatter * math.sqrt(run.alike)))
            profiled = _profiles(rows, minimise(rows, best)[0], 0, normal, freedoms)
        total, total_normal, errors = profiled, normal, {}
        if joint is not None:
            place = slice(number * _WIDTH, (number + 1) * _WIDTH)
            best = joint.values[place]
            covariance = np.asarray(joint.result.covar)[place, place]
            # by Welch's formula; those of common errors are infinite
            freedoms = {
                name: freedom / min(normal[name].uncertainty / one, 1.0) ** 4
                for name, one in zip(PARAMETERS, np.sqrt(np.diag(covariance)), strict=True)
            }
            total_normal = _normal(best, covariance, freedoms)
            total = _profiles(joint.problem, joint.values, place.start, total_normal, freedoms)
            errors = {
                DRIFT if name.startswith(DRIFT) else name: joint.common[name]
                for name in problem.errors
            }
        solutions.append(HeaterSolution(
            dict(zip(PARAMETERS, best, strict=True)) | errors, run.scatter, run.alike, covariance,
            total=total, statistical=profiled, total_normal=total_normal,
        ))  # fmt: skip
    if joint is None:
        return solutions, np.diag([one.covariance[0, 0] for one in solutions])
    of_tac = slice(0, _WIDTH * len(problems), _WIDTH)
    return solutions, np.asarray(joint.result.covar)[of_tac, of_tac]


def best_tac(problem: HeaterProblem, guess: Sequence[float]) -> float:
    """Coefficient at the minimum of :func:`solve`, without its intervals."""
    (run,), joint = _minimise_all([problem], [guess])
    return (joint or run).values[0]


class _Minimum(NamedTuple):
    """A fit."""

    problem: HeaterProblem  # With the common errors held at their best, or all in standard errors
    values: list[float]
    result: Any  # of lmfit
    scatter: float = 0.0
    alike: float = 1.0

    @property
    def common(self) -> dict[str, float]:
        """Errors that all rows have in common."""
        count = len(self.problem.errors)
        return dict(zip(self.problem.errors, self.values[len(self.values) - count :], strict=True))


def _minimise_all(
    problems: Sequence[HeaterProblem], guesses: Sequence[Sequence[float]]
) -> tuple[list[_Minimum], _Minimum | None]:
    """Fits of each run with the common errors held, and of all with these free, if any."""
    # Rows that deviate from the fit together count as fewer, or very many would move the common
    # errors far for what the law leaves out. The law's own errors are no part of what is held, or
    # they would take up scatter.
    joint, alike = None, [1.0] * len(problems)
    common = dict.fromkeys((name for one in problems for name in one.errors), 0.0)
    # a smooth error of the law's shape bends within less than a decade as the square of its width;
    # what is straight of it goes into area ratio and offset
    decades = [float(np.log10(one.pressure.max() / one.pressure.min())) for one in problems]
    sharing, law_error = problems, LAW_ERROR * min(max(decades), 1.0) ** 2
    pairs = zip(problems, decades, strict=True)
    dense = [len(one.pressure) / max(wide, 1.0) for one, wide in pairs]  # rows within a decade
    if len(problems) > 1 and common:
        unshared = LAW_OWN if min(guess[0] for guess in guesses) > _ALIKE_TAC else 1.0
        # Several a decade, whose mean over it keeps the law's error: one a decade would leave the
        # shape within a decade exact, by which very good rows would seem to measure the gauge's.
        each = int(np.clip(min(dense), 1.0, _MOST_PARTS))
        levels = [each * np.log10(problem.pressure) for problem in problems]
        lowest = min(level.min() for level in levels)
        size = law_error * math.sqrt(each * (1.0 - unshared**2))
        sharing = [
            replace(problem, errors=problem.errors | {
                f"law_{part}": np.outer((0.0, 0.0, 0.0, size), (level - lowest).astype(int) == part)
                for part in range(int(max(level.max() for level in levels) - lowest) + 1)
            })
            for problem, level in zip(problems, levels, strict=True)
        ]  # fmt: skip
        law_error = unshared * law_error
    starts = [[*guess] for guess in guesses]
    for _ in range(_ROUNDS):
        runs = []
        for problem, start, many in zip(problems, starts, alike, strict=True):
            held = problem.held(common)
            values, result = minimise(held, start)
            scatter = float(np.sqrt(result.chisqr / (len(held.conductance) - _WIDTH)))
            runs.append(_Minimum(held, values, result, scatter, many))
        if not common:
            return [
                one._replace(alike=_alike(problem, one.values))
                for problem, one in zip(problems, runs, strict=True)
            ], None
        weighed = []
        for problem, run, many in zip(sharing, runs, dense, strict=True):
            # the mean over a decade keeps the law's own error, or very many rows would seem to
            # measure the gauge's error by the shape of the curve
            error = np.hypot(run.scatter * np.sqrt(run.alike), law_error * np.sqrt(many))
            weighed.append(_scaled(problem, 1.0 / max(float(error), _LEAST_SCATTER)))
        whole = HeaterProblem.joined(weighed)
        first = [value for run in runs for value in run.values]
        first += [common.get(name, 0.0) for name in whole.errors]
        joint = _Minimum(whole, *minimise(whole, first, scale=False))
        before, common = common, {name: joint.common[name] for name in common}
        starts = np.reshape(joint.values[: _WIDTH * len(problems)], (-1, _WIDTH)).tolist()
        known, alike = alike, [
            max(past, _alike(problem, [*start, *(common[name] for name in problem.errors)]))
            for problem, start, past in zip(problems, starts, alike, strict=True)
        ]  # fmt: skip
        if np.allclose([*before.values()], [*common.values()], atol=_SAME) and alike == known:
            break
    return [one._replace(alike=many) for one, many in zip(runs, alike, strict=True)], joint


def _scaled(problem: HeaterProblem, factor: float) -> HeaterProblem:
    """Groups of rows, their weights multiplied by a factor."""
    rows = problem.group()
    return replace(rows, weight=factor * rows.weight)


def _alike(problem: HeaterProblem, values: Sequence[float]) -> float:
    """Rows of neighbouring pressures that deviate from a fit together, in effect."""
    residuals = (problem.model(values) - problem.conductance) * problem.weight
    return alike_points(residuals[np.argsort(problem.pressure, kind="stable")])


def _normal(
    values: Sequence[float], covariance: np.ndarray, freedoms: Mapping[str, float]
) -> dict[str, Estimate]:
    spread = np.sqrt(np.diag(covariance))[: len(PARAMETERS)]
    found = {}
    for name, value, one, unit in zip(PARAMETERS, values, spread, _UNITS, strict=True):
        make = positive_estimate if name in POSITIVE else Estimate.normal
        found[name] = make(value, float(one), unit, freedoms[name])
    return found


def positive_estimate(
    value: float, uncertainty: float, unit: str = "", freedom: float = math.inf
) -> Estimate:
    """An estimate of a positive number, with an interval symmetric in its logarithm."""
    factor = math.exp(min(student_factor(freedom) * uncertainty / value, _LARGEST_EXPONENT))
    return Estimate(value, (value / factor, value * factor), unit, uncertainty)


def _profiles(
    problem: HeaterProblem, values: Sequence[float], first: int, normal: Mapping[str, Estimate],
    freedoms: Mapping[str, float],
) -> dict[str, Estimate]:  # fmt: skip
    """Estimates with profile intervals; ``first``: place of the first of a run's unknowns."""
    return {
        name: replace(one, interval=profile_interval(
            problem, values, place, one.uncertainty or 0.0, student_factor(freedoms[name])
        ))
        for place, (name, one) in enumerate(normal.items(), start=first)
    }  # fmt: skip
