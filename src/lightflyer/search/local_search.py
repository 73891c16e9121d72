"""From a start to an optimum, also where films of layers change on the way; rivals and stacks.

A rival stands beside the best design: without a limit that this keeps, or within the range of the
force model and the film.

The best stack says which materials, how many, in which order, and how thick. All stacks are
enumerated. A Sobol sample of thicknesses sorts out most; gradients improve the thicknesses of the
rest; the best few are computed on full grids. One program serves all stacks, as a stack is no more
than its tables of n and k.
"""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import LightflyerError
from lightflyer.core.progress import report
from lightflyer.search.objectives import SCREENED, ObjectiveFunction, range_passed
from lightflyer.search.problem import Choice, Problem

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

POINTS = 128  # Films of each stack in the first round

IMPROVED, IN_FULL = 24, 6
"""Stacks in the second and the third round."""

_STARTS = 2  # of each stack in the second round


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


@dataclass(frozen=True)
class RankedStack(ShortRepr):
    """A stack that came into the last rounds."""

    materials: tuple[str, ...]  #: Top to bottom
    thickness: np.ndarray  #: shape (layers,); of the best film [m]
    value: float  #: Objective of the nominal film, in SI units
    in_full: bool  #: Whether the film was computed on the full grids, not within a few thousandths

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        return {
            "materials": list(self.materials),
            "thickness": self.thickness.tolist(),
            "value": self.value,
            "in_full": self.in_full,
        }


@dataclass(frozen=True)
class Ranking(ShortRepr):
    """Stacks by their best films."""

    stacks: tuple[RankedStack, ...]  #: The best first
    screened: int  #: Stacks that were looked at, and all that the study allows
    allowed: int  #: Stacks that were looked at, and all that the study allows
    notes: tuple[str, ...]  #: What a reader must know, one line each

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        return {
            "stacks": [stack.summary() for stack in self.stacks],
            "screened": self.screened,
            "allowed": self.allowed,
        }


@dataclass
class _Entry:
    """A stack on its way through the rounds."""

    sequence: tuple[int, ...]
    points: np.ndarray  # the best first
    merit: float
    found: LocalOptimum | None = None
    in_full: bool = False


def choose_stack(problem: Problem) -> tuple[Problem, Ranking]:
    """The problem with the best stack of layers; returns ; ``problem``: with a choice."""
    choice = problem.choice
    assert choice is not None  # the caller looked
    ends = time.monotonic() + choice.time_limit
    function, sequences = ObjectiveFunction(problem), choice.stacks.sequences
    # the best of a sample of films of each stack, the best stack first
    points = qmc.Sobol(len(problem.bounds), rng=problem.seed).random(POINTS)
    table = []
    for number, sequence in enumerate(sequences):
        if number and time.monotonic() > ends:
            break
        report("screening stacks", number, len(sequences), "stacks")
        function.turn_to(choice, sequence)
        table.append(function.scores_of_many(points))
    scores = np.array(table)
    values = scores[..., 0][np.isfinite(scores).all(axis=-1)]
    entries, scale = list[_Entry](), 1.0
    if values.size:
        spread = float(np.ptp(np.percentile(values, [25.0, 100.0])))
        scale = spread or float(np.abs(values).max()) or 1.0
        for sequence, row in zip(sequences, merit(scores, scale), strict=False):
            few = points[np.argsort(-row)[:_STARTS]]
            entries.append(_Entry(sequence, few, float(row.max())))
        entries.sort(key=lambda entry: -entry.merit)
    if not entries or entries[0].merit <= -INFEASIBLE:
        raise LightflyerError(
            f"none of {len(sequences)} stacks has a {problem.objectives[0].name} "
            "within the constraints; widen the bounds or the limits"
        )
    screened = len(entries)
    better = _improve(function, choice, entries[:IMPROVED], scale, ends, in_full=False)
    best = _improve(function, choice, better[:IN_FULL], scale, ends, in_full=True)
    ranked = tuple(
        RankedStack(
            materials=choice.stacks.labels(entry.sequence),
            thickness=choice.stacks.thicknesses(entry.sequence, entry.found.point),
            value=problem.objectives[0].sign * entry.found.score,
            in_full=entry.in_full,
        )
        for entry in (*best, *better[len(best) :])
        if entry.found is not None
    )
    notes = [*choice.stacks.notes]
    if time.monotonic() > ends:
        notes.append(
            f"the time limit ended the search: {screened} of {len(sequences)} stacks "
            f"were screened, {len(better)} improved and {len(best)} computed in full"
        )
    ranking = Ranking(ranked, screened, len(sequences), tuple(notes))
    winner = (best or better)[0]
    return choice.problem_of(winner.sequence), ranking


def merit(scores: np.ndarray, scale: float) -> np.ndarray:
    """Objective less a penalty, by which points that satisfy the constraints come first."""
    violation = np.maximum(-scores[..., 1:], 0.0).sum(axis=-1)
    found = scores[..., 0] / scale - INFEASIBLE * violation
    return np.where(np.isfinite(found), found, -np.inf)


def _improve(
    function: ObjectiveFunction, choice: Choice, entries: list[_Entry], scale: float, ends: float,
    *, in_full: bool,
) -> list[_Entry]:  # fmt: skip
    """Stacks with the best thicknesses on the coarse grid or the full ones, the best first."""

    def merit_of(found: LocalOptimum) -> float:
        penalty = INFEASIBLE * found.violation if found.violation > FEASIBLE else 0.0
        return found.score / scale - penalty

    done = []
    for number, entry in enumerate(entries):
        if number and time.monotonic() > ends:
            break
        doing = "computing stacks in full" if in_full else "improving thicknesses"
        report(doing, number, len(entries), "stacks")
        function.turn_to(choice, entry.sequence)
        if in_full and entry.found is not None:
            entry.found = maximise_in_full(function, [entry.found], scale)
        else:
            searches = [maximise_from(function, point, scale) for point in entry.points]
            entry.found = max(searches, key=merit_of)
        entry.merit, entry.in_full = merit_of(entry.found), in_full
        done.append(entry)
    return sorted(done, key=lambda entry: -entry.merit)
