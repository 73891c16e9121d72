"""From a start to an optimum, also where films of layers change on the way, and its rivals.

A rival stands beside the best design: without a limit that this keeps, or within the range of the
force model and the film.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from lightflyer.core.progress import report
from lightflyer.design.diagnostics import TOO_HOT, diagnose_design, diagnose_designs
from lightflyer.search.objectives import SCREENED, ObjectiveFunction
from lightflyer.search.problem import Problem

FEASIBLE = 1e-6  # Largest violation of a constraint, over the size of its limit
INFEASIBLE = 1e6  # Loss of a design that has no value, in scales of the objective
AGREEMENT = 1e-6  # Relative difference up to which the results of two starts are the same

_STOP = 1e-10  # tolerance of SLSQP, in scales of the objective
_STEPS = 200
_COARSE = 0.02  # difference that a coarse grid may make between optima, in scales of the objective
_RIVALS = 3  # optima that are compared with films computed in full
_REPEATS = 5  # of a search whose films are shifted anew
_AT_REST = 1e-5  # change of the best design at which it repeats itself, in sides of the cube

_AT_ONCE = 32  # designs whose bands are found at once


@dataclass(frozen=True)
class LocalOptimum:
    """Where a search ended."""

    point: np.ndarray
    score: float
    violation: float
    violated: str  # the output whose constraint is violated most
    evaluations: int


def maximise_from(function: ObjectiveFunction, start: np.ndarray, scale: float) -> LocalOptimum:
    """Follow gradients from a start to an optimum; ``start`` (k,); ``scale``: of the objective."""
    evaluations: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def evaluate(point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = point.tobytes()
        if key not in evaluations:
            scores, slopes = function.scores_and_jacobian(point)
            known = np.isfinite(scores)[:, None] & np.isfinite(slopes)
            scores = np.where(np.isfinite(scores), scores, -INFEASIBLE * scale)
            evaluations[key] = scores, np.where(known, slopes, 0.0)
        return evaluations[key]

    constraints = [
        {
            "type": "ineq",
            "fun": lambda point, row=row: evaluate(point)[0][row],
            "jac": lambda point, row=row: evaluate(point)[1][row],
        }
        for row in range(1, 1 + len(function.problem.constraints))
    ]
    found = minimize(
        lambda point: (-evaluate(point)[0][0] / scale, -evaluate(point)[1][0] / scale),
        start,
        jac=True,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * start.size,
        constraints=constraints,
        options={"ftol": _STOP, "maxiter": _STEPS},
    )
    point = np.clip(found.x, 0.0, 1.0)
    scores, _ = evaluate(point)
    violation = float(np.maximum(-scores[1:], 0.0).max(initial=0.0))
    if not np.isfinite(scores).all() or scores[0] <= -INFEASIBLE * scale:
        violation = np.inf
    names = [one.name for one in function.problem.constraints]
    violated = names[int(np.argmin(scores[1:]))] if names else ""
    return LocalOptimum(point, float(scores[0]), violation, violated, len(evaluations))


def maximise_in_full(
    function: ObjectiveFunction, searches: Sequence[LocalOptimum], scale: float
) -> LocalOptimum:
    """The best optimum with films computed in full, from optima with films on a coarse grid."""
    # The search goes on from the best of them with all films shifted by what the coarse grid lacks
    # there, until the optimum repeats itself.
    ranked = sorted(searches, key=lambda found: -found.score)
    rivals: list[LocalOptimum] = []
    for found in ranked:
        apart = all(abs(found.score - one.score) > AGREEMENT * scale for one in rivals)
        if apart and ranked[0].score - found.score <= _COARSE * scale:
            rivals.append(found)
    ends = []
    for number, found in enumerate(rivals[:_RIVALS]):
        report("computing films in full", number, min(len(rivals), _RIVALS))
        for _ in range(_REPEATS):
            function.match(found.point)
            again = maximise_from(function, found.point, scale)
            moved, found = float(np.abs(again.point - found.point).max()), again
            if moved <= _AT_REST:
                break
        function.match(found.point)
        scores, _ = function.scores_and_jacobian(found.point)
        ends.append(replace(found, score=float(scores[0])))
    satisfying = [found for found in ends if found.violation <= FEASIBLE]
    best = max(satisfying or ends, key=lambda found: found.score)
    if len(ends) > 1:
        function.match(best.point)
    return best


def diagnose_solution(problem: Problem, design: Mapping[str, float]) -> tuple[str, ...]:
    """What a reader must know of a design, with uncertain numbers at their means."""
    return diagnose_design(problem.design, _values(problem, design))


def range_passed(problem: Problem, designs: Sequence[Mapping[str, float]]) -> list[tuple[str, ...]]:
    """Diagnostics of designs that others of the search might not have; of heat the search knows."""
    several = [_values(problem, design) for design in designs]
    found = []
    for values, said in zip(several, diagnose_designs(problem.design, several), strict=True):
        # what is said of data that end holds for every thickness: no other design would avoid it
        own = problem.design.warnings_for(values)
        found.append(
            tuple(text for text in said if text not in own and not text.startswith(TOO_HOT))
        )
    return found


def _values(problem: Problem, design: Mapping[str, float]) -> dict[str, float]:
    return problem.means() | problem.fixed | dict(design)


@dataclass(frozen=True)
class Rival:
    """Another design, and what makes it worth knowing."""

    words: str  #: Such as ``"whatever the film withstands"``
    value: float  #: Objective, in SI units
    design: dict[str, float]  #: Free numbers by name, in the units of the design


def rivals_of(function: ObjectiveFunction, best: LocalOptimum, scale: float) -> Iterator[Rival]:
    """Rivals of the best design of a problem with one objective."""
    problem, sign = function.problem, function.problem.objectives[0].sign
    if any(part.of_film for part in problem.constraints):
        report("the best design whatever its film withstands")
        found = maximise_from(function.whatever_films_bear(), best.point, scale)
        if found.violation <= FEASIBLE and found.score - best.score > AGREEMENT * scale:
            design = problem.free_numbers(found.point)
            yield Rival("whatever the film withstands", sign * found.score, design)
    (passed,) = range_passed(problem, [problem.free_numbers(best.point)])
    if function.is_quick or problem.beyond_range or not passed:
        return
    report("designs within the range of the force model")
    points = qmc.Sobol(len(problem.bounds), rng=problem.seed).random(SCREENED)
    scores = function.scores_of_many(points)
    satisfying = np.isfinite(scores).all(axis=1) & (scores[:, 1:] >= -FEASIBLE).all(axis=1)
    points, scores = points[satisfying], scores[satisfying, 0]
    order = np.argsort(-scores)
    for first in range(0, order.size, _AT_ONCE):
        chosen = order[first : first + _AT_ONCE]
        designs = [problem.free_numbers(point) for point in points[chosen]]
        for number, passed in enumerate(range_passed(problem, designs)):
            if not passed:
                words = f"the best of {SCREENED} designs within the force model's range"
                yield Rival(words, sign * float(scores[chosen[number]]), designs[number])
                return
