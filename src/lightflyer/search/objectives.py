"""Objectives and constraints of many designs at once, their derivatives, and designs as made."""

import copy
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from lightflyer.array import tree
from lightflyer.array.namespace import number
from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError, ParameterWarning
from lightflyer.core.quantity import impossible_as_nan
from lightflyer.design.diagnostics import TOO_HOT, diagnose_design, diagnose_designs
from lightflyer.design.outputs import outputs_of
from lightflyer.design.tables import evaluate
from lightflyer.files.result_text import listed
from lightflyer.search.bounds import Tolerance
from lightflyer.search.problem import PROBABILITY, Choice, Constraint, Objective, Problem

SCREENED = 512  # Designs looked at together: first over the whole cube, then around the starts

_ELEMENTS, _ELEMENTS_OVER_BAND = 8192, 64
"""Samples of designs evaluated at once, so that NumPy's arrays stay in the processor's cache."""

_COMPARED, _SAME = 16, 1e-12  # designs by which a number is told to have no effect; relative
_STEP = 1e-4  # of a free number's range, over which slopes are taken
_GROWTH = 1e-4  # relative, of a number that is not free
_ANY_HEAT = 1e6  # above any temperature [K]
_SILVERMAN = 1.06  # width of a kernel over the spread, times n^(1/5)

ASSUMED = Tolerance(0.05, relative=True)
"""Standard uncertainty of a layer's thickness where a study states none: evaporated and sputtered
layers are usually within a few per cent."""

LOW = 0.05  # Share of the made flyers that are worse than the low quantile
SAMPLES = 512  # Flyers that are made, to see what becomes of a design


class ObjectiveFunction:
    """Objectives and constraints of a problem over the unit cube of its free numbers."""

    # A point has one fraction from 0 to 1 for each free number; see
    # :class:`~lightflyer.search.problem.Bounds`. Scores are the objectives, larger is better, then
    # the constraints, positive where satisfied.

    def __init__(self, problem: Problem):
        self.problem = problem
        costly = problem.needs_recompute
        # :class:`~lightflyer.design.design.Surrogate` of the films of layers, with its tables, and
        # films computed in full less its own where the two were last compared; None where no film
        # changes
        self._quick = problem.design.surrogate(costly) if costly else None
        self._tables = None if self._quick is None else self._quick.tables
        self._shift: Any = None
        self._limits = np.array([part.limit for part in problem.constraints])
        self._exact: Callable[[Mapping[str, float]], Any] = problem.design.precompute
        known = outputs_of(problem.design.setup)
        searched = any(known[name].over_band for name in problem.outputs)
        samples = max((column.size for column in problem.samples.values()), default=1)
        elements = _ELEMENTS_OVER_BAND if searched else _ELEMENTS
        self._at_once = max(1, elements // samples)  # designs

    @property
    def is_quick(self) -> bool:
        """Whether films of layers change, which are then computed on a coarse grid."""
        return self._quick is not None

    def turn_to(self, choice: Choice, sequence: tuple[int, ...]) -> None:
        """Go on with another stack of layers."""
        self._tables, self._shift = choice.stacks.tables(sequence), None
        self._limits = choice.limits(self.problem, sequence)
        self._exact = partial(choice.stacks.exact, sequence)

    def match(self, point: np.ndarray) -> None:
        """Compute the films at a point in full; from now on all are shifted by the difference."""
        coordinate = self.problem.design.coordinate_name
        values = {
            name: float(value)
            for name, value in self.all_values(np.asarray(point)).items()
            if name != coordinate
        }
        exact, quick = self._exact(values), self._quick_films(values)
        self._shift = tree.map_leaves(lambda one, other: np.asarray(one - other), exact, quick)

    def _quick_films(self, values: Mapping[str, float]) -> Any:
        with impossible_as_nan():
            return self._quick(values, self._tables)  # type: ignore[misc]

    def all_values(self, point: Any) -> dict[str, Any]:
        """Values of all numbers that are free, fixed or uncertain, at points (..., k)."""
        problem = self.problem
        free = {
            bounds.field.name: bounds.value(np.asarray(point)[..., place])
            for place, bounds in enumerate(problem.bounds)
        }
        return problem.means() | problem.fixed | free

    def outputs_at(self, point: np.ndarray) -> dict[str, float]:
        """Outputs at a point, with uncertain ones reduced to one number; ``point`` (k,)."""
        scores, _ = self.scores_and_jacobian(point)
        problem, count = self.problem, len(self.problem.objectives)
        found = {}
        for part, limit, score in zip(
            problem.constraints, self._limits, scores[count:], strict=True
        ):
            found[part.name] = float(limit + part.sign * (abs(limit) or 1.0) * score)
        for one, score in zip(problem.objectives, scores[:count], strict=True):
            found[one.name] = float(one.sign * score)
        return found

    def scores_of_many(self, points: np.ndarray) -> np.ndarray:
        """Scores at points, shape (n, objectives + constraints); ``points`` (n, k)."""
        return self.scores_of_designs(self.all_values(points))

    def require_effects(self, points: np.ndarray, scores: np.ndarray) -> None:
        """Raise where one of several numbers changes no score: no value of it is the best."""
        points, scores, idle = points[:_COMPARED], scores[:_COMPARED], []
        for column, bounds in enumerate(self.problem.bounds):
            moved = points.copy()
            moved[:, column] = 1.0 - moved[:, column]
            if points.size and np.allclose(self.scores_of_many(moved), scores, _SAME, 0.0):
                idle.append(bounds.field.name)
        if 0 < len(idle) < len(self.problem.bounds):
            one = len(idle) == 1
            raise ConfigurationError(
                f"{listed(idle)} {'is' if one else 'are'} free and {'has' if one else 'have'} no "
                f"effect on {' or '.join(dict.fromkeys(self.problem.asked))}: no value is the "
                f"best; leave {'it' if one else 'them'} out of the free numbers"
            )

    def scores_of_designs(self, designs: Mapping[str, Any]) -> np.ndarray:
        """Scores of designs, by all numbers that are free, fixed or uncertain, each (n,) or ()."""
        count = max(map(np.size, designs.values()))
        columns = {name: np.broadcast_to(value, count) for name, value in designs.items()}
        parts = [
            self._scores({name: column[start : start + self._at_once]
                          for name, column in columns.items()})
            for start in range(0, count, self._at_once)
        ]  # fmt: skip
        return np.concatenate(parts)

    def scores_and_jacobian(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Scores at a point and their derivatives, shape (m, k)."""
        steps = _STEP * np.eye(len(point))
        below, above = np.maximum(point - steps, 0.0), np.minimum(point + steps, 1.0)
        here, *moved = self.scores_of_many(np.concatenate([point[None], below, above]))
        low, high = np.split(np.array(moved), 2)
        width = np.diagonal(above - below)[:, None]
        return here, ((high - low) / width).T

    def parameter_gradient(
        self, point: np.ndarray, multipliers: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Derivatives of the Lagrangian in relative changes of the numbers that are not free."""
        problem, design = self.problem, self.problem.design
        costly = design.needs_recompute(list(design.quantities))
        if self._quick is not None:
            costly = [name for name in costly if not self._quick.knows(name)]
        known = {name: design.number(name) for name in design.quantities if name not in costly}
        numbers = {name: value for name, value in known.items() if value}
        apart = {design.coordinate_name, *(bounds.field.name for bounds in problem.bounds)}
        every = numbers | problem.fixed | problem.means()
        stated = {name: value for name, value in every.items() if name not in apart}
        moved = np.array([1.0 - _GROWTH, 1.0 + _GROWTH])
        columns = {name: np.full(2 * len(stated), value) for name, value in
                   (self.all_values(point) | stated).items()}  # fmt: skip
        for place, name in enumerate(stated):
            columns[name][2 * place : 2 * place + 2] *= moved
        scores = self.scores_of_designs(columns)
        lagrangian = scores[:, 0] + scores[:, 1:] @ multipliers
        slopes = (lagrangian[1::2] - lagrangian[::2]) / (2.0 * _GROWTH)
        return dict(zip(stated, slopes, strict=True))

    def whatever_films_bear(self) -> "ObjectiveFunction":
        """The same function without the limits of its films."""
        function = copy.copy(self)
        of_film = np.array([part.of_film for part in self.problem.constraints], bool)
        function._limits = np.where(of_film, _ANY_HEAT, self._limits)
        return function

    def without_errors(self) -> "ObjectiveFunction":
        """The objective of designs as they are drawn, with the same films."""
        if not self.problem.samples:
            return self
        nominal = replace(self.problem, samples={}, quantile=None, constraints=())
        function = ObjectiveFunction(nominal)
        function._tables, function._shift = self._tables, self._shift
        return function

    def _scores(self, given: Mapping[str, np.ndarray]) -> np.ndarray:
        """Scores of a few designs, shape (n, m); ``given`` (n,)."""
        problem, design = self.problem, self.problem.design
        errors = {  # of the uncertain numbers in their standard uncertainties, (s,)
            name: column
            if name in problem.tolerances
            else (column - np.mean(column)) / self._spread(name, {})
            for name, column in problem.samples.items()
        }
        values: dict[str, Any] = dict(given)
        if errors:  # samples are the last axis
            values = {name: column[:, None] for name, column in given.items()}
            for name, error in errors.items():
                values[name] = values[name] + self._spread(name, values) * error
        shape = np.broadcast_shapes(*map(np.shape, values.values()))
        films = self._films(given, errors)
        with impossible_as_nan(), warnings.catch_warnings():
            warnings.simplefilter("ignore", ParameterWarning)
            setup = tree.map_leaves(number, design.build(values, films))
            coordinate = values.get(design.coordinate_name)
            table, _ = evaluate(setup, problem.outputs, coordinate)
        found = {name: np.broadcast_to(column, shape) for name, column in table.items()}

        def reduced(part: Objective | Constraint) -> np.ndarray:
            """An output, or of its samples the mean, or the quantile on the side that is worse."""
            if not errors:
                return found[part.name]
            if part.name == PROBABILITY:  # by a kernel estimate, which has a derivative
                margins = found["lift_over_weight"] - 1.0
                width = np.std(margins, axis=-1, keepdims=True) * margins.shape[-1] ** -0.2
                width = np.maximum(_SILVERMAN * width, np.finfo(float).tiny)
                return np.mean(ndtr(margins / width), axis=-1)
            if problem.quantile is None:
                return np.mean(found[part.name], axis=-1)
            side = problem.quantile if part.sign > 0.0 else 1.0 - problem.quantile
            return np.asarray(np.quantile(found[part.name], side, axis=-1))

        columns = [part.sign * reduced(part) for part in problem.objectives]
        for part, limit in zip(problem.constraints, self._limits, strict=True):
            columns.append(part.sign * (reduced(part) - limit) / (abs(limit) or 1.0))
        return np.stack(columns, axis=1)

    def _films(self, given: Mapping[str, np.ndarray], errors: Mapping[str, np.ndarray]) -> Any:
        """Films of designs, of shape (n, ...), at errors of shape (s,) of shape (n, s, ...)."""
        # of second order in each error, of a film at plus and minus one standard uncertainty;
        # products of two errors are left out
        if self._quick is None:
            return None
        problem, coordinate = self.problem, self.problem.design.coordinate_name
        uncertain = problem.design.needs_recompute(list(problem.samples))
        names = [name for name in given if name != coordinate]
        films = []
        for row in zip(*(given[name] for name in names), strict=True):
            values = dict(zip(names, row, strict=True))
            cases = [values]
            for name in uncertain:
                step = self._spread(name, values)
                cases += [{**values, name: values[name] + sign * step} for sign in (1.0, -1.0)]
            quick = [self._quick_films(case) for case in cases]
            films.append(tree.map_leaves(lambda *leaves: np.stack(leaves), *quick))
        stacked = tree.map_leaves(lambda *leaves: np.stack(leaves, axis=1), *films)
        if self._shift is not None:
            stacked = tree.map_leaves(np.add, stacked, self._shift)

        def moved(leaf: np.ndarray) -> np.ndarray:
            if not errors:
                return leaf[0]
            found = leaf[0][:, None]
            for place, name in enumerate(uncertain):
                above, below = leaf[1 + 2 * place][:, None], leaf[2 + 2 * place][:, None]
                error = errors[name].reshape(-1, *[1] * (leaf.ndim - 2))
                bend = above - 2.0 * leaf[0][:, None] + below
                found = found + 0.5 * error * (above - below) + 0.5 * error * error * bend
            return found

        return tree.map_leaves(moved, stacked)

    def _spread(self, name: str, given: Mapping[str, Any]) -> Any:
        """Standard uncertainty of a number."""
        tolerance = self.problem.tolerances.get(name)
        if tolerance is not None:
            return tolerance.spread(given[name])
        return float(np.std(self.problem.samples[name])) or 1.0


@dataclass(frozen=True)
class Effect(ShortRepr):
    """What an error of one number does to the objective."""

    spread: float  #: Standard uncertainty of the number, in the unit of the design
    assumed: bool  #: Whether no study states it
    #: Change of the objective, in SI units, where the number is one standard uncertainty too small
    #: and too large
    less: float
    #: Change of the objective, in SI units, where the number is one standard uncertainty too small
    #: and too large
    more: float


@dataclass(frozen=True)
class AsMade(ShortRepr):
    """The objective over many flyers, each made with errors of its own."""

    effects: dict[str, Effect]  #: By the name of the number
    mean: float  #: In SI units
    low: float  #: Quantile beyond which :data:`LOW` of the flyers are worse
    samples: int

    @property
    def low_share(self) -> float:
        """Share of the flyers that are worse than :attr:`low`."""
        return LOW

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        effects = {name: vars(effect) for name, effect in self.effects.items()}
        return {
            "effects": effects,
            "mean": self.mean,
            "low": self.low,
            "low_share": self.low_share,
            "samples": self.samples,
        }


def simulate_making(function: ObjectiveFunction, point: np.ndarray) -> AsMade | None:
    """What becomes of a design that is made with errors; ``point`` (k,)."""
    from scipy.stats import qmc  # slow to import

    # The errors are normal and independent. Each flyer's films are computed with all errors at
    # once.
    problem = function.problem
    # those stated, and assumed ones of free thicknesses
    names = [bounds.field.name for bounds in problem.bounds]
    thicknesses = [name for name in names if name.endswith(".thickness")]
    assumed = dict.fromkeys(problem.design.needs_recompute(thicknesses), ASSUMED)
    tolerances = assumed | problem.tolerances
    if not tolerances or problem.objectives[0].name == PROBABILITY:
        return None
    given = {name: float(value) for name, value in function.all_values(point).items()}
    spreads = {name: float(one.spread(given[name])) for name, one in tolerances.items()}
    # the nominal design, each number one standard uncertainty off, and drawn ones
    count = len(spreads)
    steps = np.zeros((2 * count, count))
    steps[0::2], steps[1::2] = -np.eye(count), np.eye(count)
    drawn = ndtri(qmc.Sobol(count, rng=problem.seed).random(SAMPLES))
    errors = np.concatenate([np.zeros((1, count)), steps, drawn])
    table = {name: np.full(len(errors), value) for name, value in given.items()}
    for column, (name, spread) in enumerate(spreads.items()):
        table[name] = table[name] + spread * errors[:, column]
    values = problem.objectives[0].sign * function.without_errors().scores_of_designs(table)[:, 0]
    nominal, moved, drawn = values[0], values[1 : 1 + 2 * len(spreads)], values[-SAMPLES:]
    stated = problem.tolerances
    effects = {
        name: Effect(spread, name not in stated, *(float(one - nominal) for one in pair))
        for (name, spread), pair in zip(spreads.items(), moved.reshape(-1, 2), strict=True)
    }
    share = LOW if problem.objectives[0].sign > 0.0 else 1.0 - LOW
    low = float(np.quantile(drawn, share))
    return AsMade(effects, float(np.mean(drawn)), low, SAMPLES)


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
