r"""Intervals of a heater's fitted parameters, from their covariance and from the profile.

The scatter of the rows gives the statistical part, with the errors that all rows have in common
held at their best values. The total also includes those errors, each with its prior.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq, leastsq

from lightflyer.lab.estimate import Estimate, student_factor
from lightflyer.lab.tac.data import DRIFT, CommonErrors
from lightflyer.lab.tac.problem import PARAMETERS, TAC_BOUNDS, HeaterProblem, JointProblem, minimise
from lightflyer.numerics.residuals import alike_points

POSITIVE = ("tac", "area_ratio")  # Parameters whose logarithms have the more nearly normal errors

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
_POSITIVE = (0, 1)  # places of the positive parameters; their logarithms are worked on
_FURTHEST = {"tac": TAC_BOUNDS, "area_ratio": (1e-3, 1e3), "offset": (-1e3, 1e3)}
_GROWTH = 1.7  # of the step outwards until the interval's end is passed
_MOST_STEPS = 40
_LOG_RANGE = 50.0  # of the logarithms of the positive unknowns
_TOLERANCE = 1e-3  # of the distance in standard errors


def profile_interval(
    problem: JointProblem, values: Sequence[float], run: int, one: str, spread: float,
    distance: float,
) -> tuple[float, float]:  # fmt: skip
    r"""Interval of a run's parameter in which the sum of squares rises by less than a square."""
    # The root of the rise is nearly linear in the parameter, so few minimisations are needed.
    held = len(PARAMETERS) * run + PARAMETERS.index(one)
    best, least = np.array(values, float), float(np.sum(problem.residuals(*values) ** 2))
    positive = np.array([
        place for place in range(len(problem.parameters)) if place % len(PARAMETERS) in _POSITIVE
    ])  # fmt: skip
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
            rows = problem.jacobian(*whole)
            rows[positive] *= whole[positive, None]
            return np.asarray(rows[others])

        # a search that does not settle has run off to where the rise hardly changes any more
        found, *_ = leastsq(
            lambda inner: problem.residuals(*outer(inner, at)), start, Dfun=slopes, col_deriv=True,
            full_output=True,
        )  # fmt: skip
        more = float(np.sum(problem.residuals(*outer(found, at)) ** 2)) - least
        start = found if np.all(np.isfinite(found)) else start
        known[at] = float(np.sqrt(max(more, 0.0)))
        return known[at]

    ends = []
    for side, furthest in zip((-1.0, 1.0), _FURTHEST[one], strict=True):
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
    given, problems = problems, _with_own_drifts(problems)
    found = _minimise_all(problems, guesses)
    statistical = []  # intervals of the scatter, by covariance and by profile
    for held, plain, alike, scatter in zip(
        found.held, found.plain, found.alike, found.scatter, strict=True
    ):
        freedoms = dict.fromkeys(PARAMETERS, float(len(held.conductance) - len(PARAMETERS)))
        best = _values(plain, PARAMETERS)
        profiled = normal = _normal(best, alike * np.asarray(plain.covar), freedoms)
        if scatter > _ROUNDING:  # rows without scatter have no profile
            # very many rows are grouped; what scatters within a group is in the scatter already
            rows = _scaled(held, 1.0 / (scatter * math.sqrt(alike)))
            best = _values(minimise(rows, best), PARAMETERS)
            profiled = _profiles(JointProblem((rows,)), best, 0, normal, freedoms)
        statistical.append((normal, profiled))
    if found.total is None:
        alone = [
            HeaterSolution(
                dict(zip(PARAMETERS, _values(plain, PARAMETERS), strict=True)), scatter, alike,
                alike * np.asarray(plain.covar), profiled, profiled, normal,
            )
            for plain, scatter, alike, (normal, profiled) in zip(
                found.plain, found.scatter, found.alike, statistical, strict=True
            )
        ]  # fmt: skip
        return alone, np.diag([one.covariance[0, 0] for one in alone])
    joint, total = found.joint, found.total
    values, whole = _values(total, joint.names), np.asarray(total.covar)
    common = dict(zip(joint.names, values, strict=True))
    solutions, width = [], len(PARAMETERS)
    for number, (problem, (normal, profiled)) in enumerate(zip(given, statistical, strict=True)):
        place = slice(number * width, (number + 1) * width)
        covariance = whole[place, place]
        # by Welch's formula; those of common errors are infinite
        shares = {
            name: normal[name].uncertainty / one
            for name, one in zip(PARAMETERS, np.sqrt(np.diag(covariance)), strict=True)
        }
        freedom = len(problem.conductance) - width
        freedoms = {name: freedom / min(share, 1.0) ** 4 for name, share in shares.items()}
        total_normal = _normal(values[place], covariance, freedoms)
        errors = {
            name: common[name if name in common else f"{name}_{number}"]
            for name in problem.errors.names
        }
        solutions.append(HeaterSolution(
            dict(zip(PARAMETERS, values[place], strict=True)) | errors, found.scatter[number],
            found.alike[number], covariance,
            total=_profiles(joint, values, number, total_normal, freedoms),
            statistical=profiled, total_normal=total_normal,
        ))  # fmt: skip
    return solutions, whole[: width * len(problems) : width, : width * len(problems) : width]


def best_tac(problem: HeaterProblem, guess: Sequence[float]) -> float:
    """Coefficient at the minimum of :func:`solve`, without its intervals."""
    found = _minimise_all([problem], [guess])
    result = found.plain[0] if found.total is None else found.total
    return float(result.params["tac"].value)


@dataclass(frozen=True)
class _JointMinimum:
    """Fits with the common errors held at their best, and with them free if there are any."""

    held: list[HeaterProblem]  # The runs with the common errors held
    plain: list[Any]  # Their fits by lmfit
    scatter: list[float]
    alike: list[float]
    joint: JointProblem  # Residuals in standard errors
    total: Any | None  # Its fit by lmfit, of all unknowns


def _minimise_all(
    problems: Sequence[HeaterProblem], guesses: Sequence[Sequence[float]]
) -> _JointMinimum:
    # Rows that deviate from the fit together count as fewer, or very many would move the common
    # errors far for what the law leaves out. The law's own errors are no part of what is held, or
    # they would take up scatter.
    starts, total, alike = [[*guess] for guess in guesses], None, [1.0] * len(problems)
    last, instruments = len(PARAMETERS) * len(problems), len(problems[0].errors.names)
    # a smooth error of the law's shape bends within less than a decade as the square of its width;
    # what is straight of it goes into area ratio and offset
    sharing, law_error = problems, LAW_ERROR * min(max(map(_decades, problems)), 1.0) ** 2
    if len(problems) > 1 and instruments:
        unshared = LAW_OWN if min(guess[0] for guess in guesses) > _ALIKE_TAC else 1.0
        # Several a decade, whose mean over it keeps the law's error: one a decade would leave the
        # shape within a decade exact, by which very good rows would seem to measure the gauge's.
        most = min(len(problem.pressure) / max(_decades(problem), 1.0) for problem in problems)
        each = int(np.clip(most, 1.0, _MOST_PARTS))
        levels = [each * np.log10(problem.pressure) for problem in problems]
        lowest = min(level.min() for level in levels)
        parts = np.arange(int(max(level.max() for level in levels) - lowest) + 1)
        size = law_error * math.sqrt(each * (1.0 - unshared**2))
        found, nothing = [], np.zeros(len(parts))
        for problem, level in zip(problems, levels, strict=True):
            errors, effects = problem.errors, (level - lowest).astype(int) == parts[:, None]
            errors = CommonErrors(
                (*errors.names, *(f"law_{part}" for part in parts)),
                np.concatenate([errors.log_pressure, nothing]),
                np.concatenate([errors.zero, nothing]),
                np.concatenate([errors.log_continuum, np.zeros(effects.shape)]),
                np.concatenate([errors.log_conductance, size * effects]),
            )
            found.append(replace(problem, errors=errors))
        sharing, law_error = found, unshared * law_error
    joint = JointProblem(tuple(sharing))
    of_law = [0.0] * (len(joint.names) - last - instruments)
    common = [0.0] * instruments
    for _ in range(_ROUNDS):
        held = [problem.with_common_errors(common) for problem in problems]
        plain = [minimise(one, start) for one, start in zip(held, starts, strict=True)]
        starts = [_values(one, PARAMETERS) for one in plain]
        scatter = [
            float(np.sqrt(fit.chisqr / (len(one.conductance) - len(PARAMETERS))))
            for fit, one in zip(plain, held, strict=True)
        ]
        if not common:
            alike = [_alike(*one) for one in zip(problems, starts, strict=True)]
            break
        runs = []
        for problem, noise, count in zip(sharing, scatter, alike, strict=True):
            # the mean over a decade keeps the law's own error, or very many rows would seem to
            # measure the gauge's error by the shape of the curve
            per_decade = len(problem.pressure) / max(_decades(problem), 1.0)
            error = np.hypot(noise * np.sqrt(count), law_error * np.sqrt(per_decade))
            runs.append(_scaled(problem, 1.0 / max(float(error), _LEAST_SCATTER)))
        joint = JointProblem(tuple(runs))
        total = minimise(joint, [*np.ravel(starts), *common, *of_law], scale=False)
        values = _values(total, joint.names)
        before, common = common, values[last : last + instruments]
        starts = np.reshape(values[:last], (len(problems), -1)).tolist()
        known, alike = alike, [
            max(past, _alike(problem, [*start, *common]))
            for problem, start, past in zip(problems, starts, alike, strict=True)
        ]  # fmt: skip
        if np.allclose(before, common, atol=_SAME) and alike == known:
            break
    return _JointMinimum(held, plain, scatter, alike, joint, total)


def _with_own_drifts(problems: Sequence[HeaterProblem]) -> Sequence[HeaterProblem]:
    """Runs whose plateaus drift each by itself: as many unknowns as runs, each of one run."""
    names = problems[0].errors.names
    if len(problems) == 1 or DRIFT not in names:
        return problems
    shared = [place for place, name in enumerate(names) if name != DRIFT]
    places = [*shared, *[names.index(DRIFT)] * len(problems)]
    words = *(names[place] for place in shared), *(f"{DRIFT}_{n}" for n in range(len(problems)))
    whose = np.concatenate([np.ones((len(problems), len(shared))), np.eye(len(problems))], axis=1)
    return [
        replace(
            problem,
            errors=CommonErrors(
                words, problem.errors.log_pressure[places], problem.errors.zero[places],
                has[:, None] * problem.errors.log_continuum[places],
                problem.errors.log_conductance[places],
            ),
        )
        for problem, has in zip(problems, whose, strict=True)
    ]  # fmt: skip


def _scaled(problem: HeaterProblem, factor: float) -> HeaterProblem:
    """Groups of rows, their weights multiplied by a factor."""
    rows = problem.group()
    return replace(rows, weight=factor * rows.weight)


def _alike(problem: HeaterProblem, values: Sequence[float]) -> float:
    """Rows of neighbouring pressures that deviate from a fit together, in effect."""
    residuals = (problem.model(*values) - problem.conductance) * problem.weight
    return alike_points(residuals[np.argsort(problem.pressure, kind="stable")])


def _decades(problem: HeaterProblem) -> float:
    return float(np.log10(problem.pressure.max() / problem.pressure.min()))


def _values(result: Any, names: tuple[str, ...]) -> list[float]:
    return [float(result.params[name].value) for name in names]


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
    joint: JointProblem, values: Sequence[float], run: int, normal: Mapping[str, Estimate],
    freedoms: Mapping[str, float],
) -> dict[str, Estimate]:  # fmt: skip
    return {
        name: replace(one, interval=profile_interval(
            joint, values, run, name, one.uncertainty or 0.0, student_factor(freedoms[name])
        ))
        for name, one in normal.items()
    }  # fmt: skip
