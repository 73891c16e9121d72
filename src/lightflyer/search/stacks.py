"""The best stack of layers: which materials, how many, in which order, and how thick.

All stacks are enumerated. A Sobol sample of thicknesses sorts out most; gradients improve the
thicknesses of the rest; the best few are computed on full grids. One program serves all
stacks, as a stack is no more than its tables of n and k.
"""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import qmc

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import LightflyerError
from lightflyer.core.progress import report
from lightflyer.search.local_search import (
    FEASIBLE,
    INFEASIBLE,
    LocalOptimum,
    maximise_from,
    maximise_in_full,
)
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.problem import Choice, Problem

POINTS = 128  # Films of each stack in the first round

IMPROVED, IN_FULL = 24, 6
"""Stacks in the second and the third round."""

_STARTS = 2  # of each stack in the second round


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
    function = ObjectiveFunction(problem)
    entries, scale = _screen(function, choice, ends)
    if not entries or entries[0].merit <= -INFEASIBLE:
        raise LightflyerError(
            f"none of {len(choice.stacks.sequences)} stacks has a {problem.objectives[0].name} "
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
            f"the time limit ended the search: {screened} of {len(choice.stacks.sequences)} stacks "
            f"were screened, {len(better)} improved and {len(best)} computed in full"
        )
    ranking = Ranking(ranked, screened, len(choice.stacks.sequences), tuple(notes))
    winner = (best or better)[0]
    return choice.problem_of(winner.sequence), ranking


def _screen(function: ObjectiveFunction, choice: Choice, ends: float) -> tuple[list[_Entry], float]:
    """Stacks by the best of a sample of films, the best first, and the scale of the objective."""
    problem, sequences = function.problem, choice.stacks.sequences
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
    if not values.size:
        return [], 1.0
    scale = float(np.ptp(np.percentile(values, [25.0, 100.0]))) or float(np.abs(values).max())
    merits = merit(scores, scale or 1.0)
    entries = [
        _Entry(sequence, points[np.argsort(-row)[:_STARTS]], float(row.max()))
        for sequence, row in zip(sequences, merits, strict=False)
    ]
    return sorted(entries, key=lambda entry: -entry.merit), scale or 1.0


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
