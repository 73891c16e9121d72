"""Designs that stand beside the best one: without a limit that it keeps, or within a range."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from lightflyer.core.progress import report
from lightflyer.search.diagnostics import range_passed
from lightflyer.search.local_search import AGREEMENT, FEASIBLE, LocalOptimum, maximise_from
from lightflyer.search.objectives import SCREENED, ObjectiveFunction

_AT_ONCE = 32  # designs whose bands are found at once


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
