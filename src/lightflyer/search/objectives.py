"""Objectives and constraints of many designs at once, and their derivatives."""

import copy
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import ndtr

from lightflyer.array import tree
from lightflyer.array.namespace import number
from lightflyer.core.errors import ConfigurationError, ParameterWarning
from lightflyer.core.quantity import impossible_as_nan
from lightflyer.design.outputs import outputs_of
from lightflyer.design.tables import evaluate
from lightflyer.files.result_text import listed
from lightflyer.search.problem import PROBABILITY, Constraint, Objective, Problem

SCREENED = 512  # Designs looked at together: first over the whole cube, then around the starts

_ELEMENTS, _ELEMENTS_OVER_BAND = 8192, 64
"""Samples of designs evaluated at once, so that NumPy's arrays stay in the processor's cache."""

_COMPARED, _SAME = 16, 1e-12  # designs by which a number is told to have no effect; relative
_STEP = 1e-4  # of a free number's range, over which slopes are taken
_GROWTH = 1e-4  # relative, of a number that is not free
_ANY_HEAT = 1e6  # above any temperature [K]
_SILVERMAN = 1.06  # width of a kernel over the spread, times n^(1/5)


@dataclass(frozen=True)
class Context:
    """What the films of layers of a search are computed with."""

    tables: Any  # See :class:`~lightflyer.design.design.Surrogate`; None where no film changes
    # Films computed in full less those on a coarse grid, where the two were last compared; None
    # before, and where no film changes
    shift: Any
    limits: np.ndarray  # shape (constraints,); limits, which may depend on the film


@dataclass(frozen=True)
class _Films:
    """Films of some designs, and how they change with the errors of uncertain thicknesses."""

    # shape (1 + 2 u, n, ...); nominal, then with each error at plus and at minus one standard
    # uncertainty
    films: Any
    uncertain: tuple[str, ...]  # Names of the u numbers

    def at(self, errors: Mapping[str, np.ndarray]) -> Any:
        """Films at some errors, in standard uncertainties, of second order in each of them.

        ``errors`` (s,); arrays of shape (n, s, ...). Without errors (n, ...).
        """
        # Products of two errors are left out.

        def moved(leaf: np.ndarray) -> np.ndarray:
            if not errors:
                return leaf[0]
            found = leaf[0][:, None]
            for place, name in enumerate(self.uncertain):
                above, below = leaf[1 + 2 * place][:, None], leaf[2 + 2 * place][:, None]
                error = errors[name].reshape(-1, *[1] * (leaf.ndim - 2))
                bend = above - 2.0 * leaf[0][:, None] + below
                found = found + 0.5 * error * (above - below) + 0.5 * error * error * bend
            return found

        return tree.map_leaves(moved, self.films)


class ObjectiveFunction:
    """Objectives and constraints of a problem over the unit cube of its free numbers."""

    # A point has one fraction from 0 to 1 for each free number; see
    # :class:`~lightflyer.search.problem.Bounds`. Scores are the objectives, larger is better, then
    # the constraints, positive where satisfied.

    def __init__(self, problem: Problem):
        self.problem = problem
        costly = problem.needs_recompute
        self._quick = problem.design.surrogate(costly) if costly else None
        limits = np.array([part.limit for part in problem.constraints])
        self._context = Context(None if self._quick is None else self._quick.tables, None, limits)
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

    def turn_to(
        self, tables: Any, limits: np.ndarray, exact: Callable[[Mapping[str, float]], Any]
    ) -> None:
        """Go on with another film."""
        self._context = Context(tables, None, limits)
        self._exact = exact

    def match(self, point: np.ndarray) -> None:
        """Compute the films at a point in full; from now on all are shifted by the difference."""
        coordinate = self.problem.design.coordinate_name
        values = {
            name: float(value)
            for name, value in self.all_values(np.asarray(point)).items()
            if name != coordinate
        }
        exact, quick = self._exact(values), self._quick_films(values)
        shift = tree.map_leaves(lambda one, other: np.asarray(one - other), exact, quick)
        self._context = replace(self._context, shift=shift)

    def _quick_films(self, values: Mapping[str, float]) -> Any:
        with impossible_as_nan():
            return self._quick(values, self._context.tables)  # type: ignore[misc]

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
        limits = self._context.limits
        limited = {
            part.name: float(limit + part.sign * scale * score)
            for part, limit, scale, score in zip(
                problem.constraints, limits, _scales(limits), scores[count:], strict=True
            )
        }
        return limited | {
            part.name: float(part.sign * score)
            for part, score in zip(problem.objectives, scores[:count], strict=True)
        }

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
        stated = self._parameters()
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
        limits = np.where(of_film, _ANY_HEAT, self._context.limits)
        function._context = replace(self._context, limits=limits)
        return function

    def without_errors(self) -> "ObjectiveFunction":
        """The objective of designs as they are drawn, with the same films."""
        if not self.problem.samples:
            return self
        nominal = replace(self.problem, samples={}, quantile=None, constraints=())
        function = ObjectiveFunction(nominal)
        function._context = self._context
        return function

    def _scores(self, given: Mapping[str, np.ndarray]) -> np.ndarray:
        """Scores of a few designs, shape (n, m); ``given`` (n,)."""
        problem, limits = self.problem, self._context.limits
        judged: Sequence[Objective | Constraint] = (*problem.objectives, *problem.constraints)
        values = self._values(given, {(part.name, part.sign) for part in judged})
        columns = [part.sign * values[part.name, part.sign] for part in problem.objectives]
        for part, limit, scale in zip(problem.constraints, limits, _scales(limits), strict=True):
            columns.append(part.sign * (values[part.name, part.sign] - limit) / scale)
        return np.stack(columns, axis=1)

    def _values(
        self, given: Mapping[str, np.ndarray], parts: set[tuple[str, float]]
    ) -> dict[tuple[str, float], np.ndarray]:
        """Outputs, (n,), by name and by whether more (1) or less (-1) is better."""
        errors, films, design = self._errors(), self._films(given), self.problem.design
        values: dict[str, Any] = dict(given)
        if errors:  # samples are the last axis
            values = {name: column[:, None] for name, column in given.items()}
            for name, error in errors.items():
                values[name] = values[name] + self._spread(name, values) * error
        shape = np.broadcast_shapes(*map(np.shape, values.values()))
        with impossible_as_nan(), warnings.catch_warnings():
            warnings.simplefilter("ignore", ParameterWarning)
            prepared = None if films is None else films.at(errors)
            setup = tree.map_leaves(number, design.build(values, prepared))
            coordinate = values.get(design.coordinate_name)
            table, _ = evaluate(setup, self.problem.outputs, coordinate)
            found = {name: np.broadcast_to(column, shape) for name, column in table.items()}
            if not errors:
                return {(name, sign): found[name] for name, sign in parts}
            return {
                (name, sign): _smooth_share(found["lift_over_weight"] - 1.0)
                if name == PROBABILITY
                else self._reduce(found[name], sign)
                for name, sign in parts
            }

    def _films(self, given: Mapping[str, np.ndarray]) -> _Films | None:
        """Films of designs, and how they change with the errors of uncertain thicknesses."""
        if self._quick is None:
            return None
        problem, coordinate = self.problem, self.problem.design.coordinate_name
        uncertain = tuple(problem.design.needs_recompute(list(problem.samples)))
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
        if self._context.shift is not None:
            stacked = tree.map_leaves(np.add, stacked, self._context.shift)
        return _Films(stacked, uncertain)

    def _spread(self, name: str, given: Mapping[str, Any]) -> Any:
        """Standard uncertainty of a number."""
        tolerance = self.problem.tolerances.get(name)
        if tolerance is not None:
            return tolerance.spread(given[name])
        return float(np.std(self.problem.samples[name])) or 1.0

    def _errors(self) -> dict[str, np.ndarray]:
        """Errors of the uncertain numbers in their standard uncertainties, by name, (s,)."""
        tolerances = self.problem.tolerances
        return {
            name: column
            if name in tolerances
            else (column - np.mean(column)) / self._spread(name, {})
            for name, column in self.problem.samples.items()
        }

    def _reduce(self, columns: np.ndarray, sign: float) -> np.ndarray:
        """The mean of samples, or their quantile on the side that is worse, (n,)."""
        quantile = self.problem.quantile
        if quantile is None:
            return np.mean(columns, axis=-1)
        side = quantile if sign > 0.0 else 1.0 - quantile
        return np.asarray(np.quantile(columns, side, axis=-1))

    def _parameters(self) -> dict[str, float]:
        """Numbers of the design that are neither free nor zero nor costly, by dotted name."""
        problem, design = self.problem, self.problem.design
        means = problem.means()
        costly = design.needs_recompute(list(design.quantities))
        if self._quick is not None:
            costly = [name for name in costly if not self._quick.knows(name)]
        stated = {
            name: value
            for name in design.quantities
            if name not in costly and (value := design.number(name))
        }
        free = {bounds.field.name for bounds in problem.bounds}
        return {
            name: value
            for name, value in (stated | problem.fixed | means).items()
            if name not in free and name != design.coordinate_name
        }


def _scales(limits: Any) -> Any:
    """Sizes of limits, by which violations of constraints are measured."""
    return abs(limits) + (limits == 0.0)


def _smooth_share(margins: np.ndarray) -> np.ndarray:
    """Share of positive margins, (n,), by a kernel estimate so that it has a derivative."""
    width = _SILVERMAN * np.std(margins, axis=-1, keepdims=True) * margins.shape[-1] ** -0.2
    return np.mean(ndtr(margins / np.maximum(width, np.finfo(float).tiny)), axis=-1)
