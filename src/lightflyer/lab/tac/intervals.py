r"""Intervals of a heater's fitted parameters, from their covariance and from the profile.

The scatter of the rows gives the statistical part, with the errors that all rows have in common
held at their best values. The total also includes those errors, each with its prior.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.lab.estimate import Estimate, student_factor
from lightflyer.lab.tac.problem import PARAMETERS, Problem, minimise
from lightflyer.lab.tac.profile import profile_interval
from lightflyer.numerics.residuals import alike_points

POSITIVE = ("tac", "area_ratio")  # Parameters whose logarithms have the more nearly normal errors

LAW_ERROR = 2e-3
"""Relative standard error of the law's shape within a decade of pressure [1]: the kinetic law's
heat is within 0.35 % of the solver's, which is divided by √3. What the parameters take up of it is
an error of theirs."""

_LARGEST_EXPONENT = 300.0
_UNITS = ("", "", "W/(m^2 K)")
_ROUNDING = 1e-10  # relative scatter that is rounding, not noise
_LEAST_SCATTER = 1e-4  # relative; no bench measures a conductance better
_ROUNDS = 6  # of scatter and common errors, each from the other
_SAME = 1e-3  # standard errors


@dataclass(frozen=True)
class Solution:
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


def solve(problem: Problem, guess: tuple[float, float, float]) -> Solution:
    """Minimise, and find all intervals; ``guess``: the three parameters near the minimum."""
    freedom = len(problem.conductance) - len(PARAMETERS)
    held, (_, result), total, alike = _minimise_both(problem, guess)
    scatter = _scatter(result, held)
    freedoms = dict.fromkeys(PARAMETERS, float(freedom))
    normal = _normal(result, freedoms, alike)
    statistical = normal
    if scatter > _ROUNDING:  # rows without scatter have no profile
        # very many rows are grouped; what scatters within a group is in the scatter already
        rows = held.group().scale_weights(1.0 / (scatter * math.sqrt(alike)))
        values = _values(minimise(rows, _values(result, PARAMETERS))[1], PARAMETERS)
        statistical = _profiles(rows, values, normal, freedoms)
    if total is None:
        return Solution(
            _by_name(result, PARAMETERS), scatter, alike, alike * np.asarray(result.covar),
            statistical, statistical, normal,
        )  # fmt: skip
    freedoms = _freedoms(total[1], normal, freedom)
    total_normal = _normal(total[1], freedoms)
    scaled = problem.group().scale_weights(1.0 / _row_error(problem, scatter, alike))
    return Solution(
        values=_by_name(total[1], problem.names),
        scatter=scatter,
        alike=alike,
        covariance=np.asarray(total[1].covar)[: len(PARAMETERS), : len(PARAMETERS)],
        total=_profiles(scaled, _values(total[1], problem.names), total_normal, freedoms),
        statistical=statistical,
        total_normal=total_normal,
    )


def best_tac(problem: Problem, guess: tuple[float, float, float]) -> float:
    """Coefficient at the minimum of :func:`solve`, without its intervals."""
    _, plain, total, _ = _minimise_both(problem, guess)
    return float((plain if total is None else total)[1].params["tac"].value)


def _minimise_both(
    problem: Problem, guess: tuple[float, float, float]
) -> tuple[Problem, tuple[Any, Any], tuple[Any, Any] | None, float]:
    """Fits with the common errors held at their best, and with them free if there are any."""
    # Rows that deviate from the fit together count as fewer, or very many would move the common
    # errors far for what the law leaves out.
    start, total, alike = [*guess], None, 1.0
    common = [0.0] * len(problem.errors.names)
    for _ in range(_ROUNDS):
        held = problem.with_common_errors(common)
        plain = minimise(held, start)
        start = _values(plain[1], PARAMETERS)
        scatter = _scatter(plain[1], held)
        if not common:
            alike = _alike(problem, start)
            break
        row_error = _row_error(problem, scatter, alike)
        total = minimise(
            problem.group().scale_weights(1.0 / row_error), [*start, *common], scale=False
        )
        before, common = common, _values(total[1], problem.errors.names)
        start = _values(total[1], PARAMETERS)
        known, alike = alike, max(alike, _alike(problem, [*start, *common]))
        if np.allclose(before, common, atol=_SAME) and alike == known:
            break
    return held, plain, total, alike


def _alike(problem: Problem, values: Sequence[float]) -> float:
    """Rows of neighbouring pressures that deviate from a fit together, in effect."""
    residuals = (problem.model(*values) - problem.conductance) * problem.weight
    return alike_points(residuals[np.argsort(problem.pressure, kind="stable")])


def _row_error(problem: Problem, scatter: float, alike: float) -> float:
    """Relative error of a row such that the mean over a decade keeps the law's own error [1]."""
    # Without it very many rows would seem to measure the gauge's error by the shape of the curve.
    decades = max(float(np.log10(problem.pressure.max() / problem.pressure.min())), 1.0)
    per_decade = len(problem.pressure) / decades
    both = np.hypot(scatter * np.sqrt(alike), LAW_ERROR * np.sqrt(per_decade))
    return max(float(both), _LEAST_SCATTER)


def _scatter(result: Any, problem: Problem) -> float:
    return float(np.sqrt(result.chisqr / (len(problem.conductance) - len(PARAMETERS))))


def _values(result: Any, names: tuple[str, ...]) -> list[float]:
    return [float(result.params[name].value) for name in names]


def _by_name(result: Any, names: tuple[str, ...]) -> dict[str, float]:
    return dict(zip(names, _values(result, names), strict=True))


def _normal(result: Any, freedoms: Mapping[str, float], alike: float = 1.0) -> dict[str, Estimate]:
    """The three parameters with the intervals of their covariance."""
    spread = np.sqrt(alike * np.diag(np.asarray(result.covar)))[: len(PARAMETERS)]
    found = {}
    for name, value, one, unit in zip(
        PARAMETERS, _values(result, PARAMETERS), spread, _UNITS, strict=True
    ):
        make = positive_estimate if name in POSITIVE else Estimate.normal
        found[name] = make(value, float(one), unit, freedoms[name])
    return found


def positive_estimate(
    value: float, uncertainty: float, unit: str = "", freedom: float = math.inf
) -> Estimate:
    """An estimate of a positive number, with an interval symmetric in its logarithm."""
    factor = math.exp(min(student_factor(freedom) * uncertainty / value, _LARGEST_EXPONENT))
    return Estimate(value, (value / factor, value * factor), unit, uncertainty)


def _freedoms(result: Any, statistical: Mapping[str, Estimate], freedom: int) -> dict[str, float]:
    """Degrees of freedom of the total by Welch's formula; those of common errors are infinite."""
    spread = np.sqrt(np.diag(np.asarray(result.covar)))[: len(PARAMETERS)]
    shares = [
        statistical[name].uncertainty / one for name, one in zip(PARAMETERS, spread, strict=True)
    ]
    return {
        name: freedom / min(share, 1.0) ** 4 for name, share in zip(PARAMETERS, shares, strict=True)
    }


def _profiles(
    problem: Problem, values: Sequence[float], normal: Mapping[str, Estimate],
    freedoms: Mapping[str, float],
) -> dict[str, Estimate]:  # fmt: skip
    """The parameters with profile intervals; residuals of the problem in standard errors."""
    ends = {
        name: profile_interval(
            problem, values, name, one.uncertainty or 0.0, student_factor(freedoms[name])
        )
        for name, one in normal.items()
    }
    return _with_intervals(normal, ends)


def _with_intervals(
    estimates: Mapping[str, Estimate], ends: Mapping[str, tuple[float, float]]
) -> dict[str, Estimate]:
    return {
        name: Estimate(one.value, ends[name], one.unit, one.uncertainty)
        for name, one in estimates.items()
    }
