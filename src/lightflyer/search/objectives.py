"""Objectives and constraints as functions with derivatives."""

import copy
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.core.precision import float64
from lightflyer.design.tables import evaluate
from lightflyer.numerics.batches import in_batches
from lightflyer.program.entry_point import entry_point
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import jax, jnp, special
from lightflyer.pytree.module import Module, field
from lightflyer.search.problem import PROBABILITY, Constraint, Objective, Problem

SCREENED = 512  # Designs evaluated at once: first over the whole cube, then around the starts

_BATCH_OF_FILMS = 128  # designs evaluated at once where each has a film of its own

_ANY_HEAT = 1e6  # above any temperature [K]
_SILVERMAN = 1.06  # width of a kernel over the spread, times n^(1/5)


class Context(Module):
    """What the films of layers of a search are computed with."""

    tables: Any  # See :class:`~lightflyer.design.design.Surrogate`; None where no film changes
    # Films computed in full less those on a coarse grid, where the two were last compared; zero
    # before. None where no film changes
    shift: Any
    limits: Any  # shape (constraints,); limits of the constraints, which may depend on the film


class _Moving(Module):
    """Films, and how they change with the errors of uncertain thicknesses."""

    # shape (1 + 2 n, ...); nominal, then with each error at plus and at minus one standard
    # uncertainty
    films: Any
    uncertain: tuple[str, ...] = field(static=True)  # Names of the n numbers

    def at(self, errors: Mapping[str, Any]) -> Any:
        """Films at some errors, in standard uncertainties: of second order in each of them."""
        # Products of two errors are left out.

        def moved(leaf: Any) -> Any:
            found = leaf[0]
            for number, name in enumerate(self.uncertain):
                above, below = leaf[1 + 2 * number], leaf[2 + 2 * number]
                error = errors[name]
                bend = above - 2.0 * leaf[0] + below
                found = found + 0.5 * error * (above - below) + 0.5 * error * error * bend
            return found

        return tree.map_leaves(moved, self.films)


class ObjectiveFunction:
    """Objectives and constraints of a problem over the unit cube of its free numbers."""

    # A point has one fraction from 0 to 1 for each free number; see
    # :class:`~lightflyer.search.problem.Bounds`.

    def __init__(self, problem: Problem):
        self.problem = problem
        costly = problem.needs_recompute
        self._quick = problem.design.surrogate(costly) if costly else None
        limits = np.array([part.limit for part in problem.constraints])
        self._context = Context(None if self._quick is None else self._quick.tables, None, limits)
        if self._quick is not None:
            # zeros of the same structure, or the first match would compile everything anew
            self._context = Context(self._context.tables, self._nothing(), limits)
        self._exact: Callable[[Mapping[str, float]], Any] = problem.design.precompute

    @property
    def is_quick(self) -> bool:
        """Whether films of layers change, which are then computed on a coarse grid."""
        return self._quick is not None

    def turn_to(
        self, tables: Any, limits: np.ndarray, exact: Callable[[Mapping[str, float]], Any]
    ) -> None:
        """Go on with another film, for which nothing has to be compiled anew."""
        self._context = Context(tables, self._nothing(), limits)
        self._exact = exact

    def _nothing(self) -> Any:
        middle = np.full(len(self.problem.bounds), 0.5)
        with float64():
            shapes = jax.eval_shape(
                self._quick,  # type: ignore[arg-type]
                self._given_film(middle),
                self._context.tables,
            )
        return tree.map_leaves(lambda leaf: np.zeros(leaf.shape), shapes)

    def _given_film(self, point: np.ndarray) -> dict[str, float]:
        """Values at a point, without the coordinate."""
        coordinate = self.problem.design.coordinate_name
        given = self.all_values(point).items()
        return {name: float(value) for name, value in given if name != coordinate}

    def match(self, point: np.ndarray) -> None:
        """Compute the films at a point in full; from now on all are shifted by the difference."""
        values = self._given_film(np.asarray(point))
        exact = self._exact(values)
        quick = self._quick_films(values)
        shift = tree.map_leaves(lambda one, other: np.asarray(one - other), exact, quick)
        self._context = Context(self._context.tables, shift, self._context.limits)

    @cached_property
    def _quick_films(self) -> Callable[[Mapping[str, Any]], Any]:
        films = entry_point(lambda values, tables: self._quick(values, tables))  # type: ignore[misc]
        return lambda values: films(values, self._context.tables)

    def all_values(self, point: Any, changed: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Values of all numbers that are free, fixed or uncertain, at a point; may be traced."""
        problem = self.problem
        free = {
            bounds.field.name: bounds.value(point[index])
            for index, bounds in enumerate(problem.bounds)
        }
        return problem.means() | problem.fixed | free | dict(changed or {})

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

    def _films(self, given: Mapping[str, Any], context: "Context") -> "_Moving | None":
        """Films at some values, and how they change with the errors of uncertain thicknesses."""
        if self._quick is None:
            return None
        quick, problem = self._quick, self.problem
        uncertain = problem.design.needs_recompute(list(problem.samples))
        rows = [dict(given)]
        for name in uncertain:
            step = self._spread(name, given)
            rows += [{**given, name: given[name] + sign * step} for sign in (1.0, -1.0)]
        coordinate = problem.design.coordinate_name
        table = {
            name: jnp.stack([jnp.asarray(row[name], float) for row in rows])
            for name in given
            if name != coordinate
        }
        films = jax.lax.map(lambda values: quick(values, context.tables), table)
        films = tree.map_leaves(jnp.add, films, context.shift)
        return _Moving(films, tuple(uncertain))

    def _spread(self, name: str, given: Mapping[str, Any]) -> Any:
        """Standard uncertainty of a number."""
        tolerance = self.problem.tolerances.get(name)
        if tolerance is not None:
            return tolerance.spread(given[name])
        return float(np.std(self.problem.samples[name])) or 1.0

    def _values(
        self, given: Mapping[str, Any], films: "_Moving | None"
    ) -> dict[tuple[str, float], Any]:
        """Outputs by name and by whether more (1) or less (-1) is better."""
        problem = self.problem
        judged: tuple[Objective | Constraint, ...] = (*problem.objectives, *problem.constraints)
        parts = {(part.name, part.sign) for part in judged}
        coordinate = problem.design.coordinate_name

        def of_sample(errors: Mapping[str, Any]) -> dict[str, Any]:
            values = dict(given) | {
                name: given[name] + self._spread(name, given) * error
                for name, error in errors.items()
            }
            prepared = None if films is None else films.at(errors)
            setup = problem.design.build(values, prepared)
            return evaluate(setup, problem.outputs, values.get(coordinate))[0]

        if not problem.samples:
            alone = of_sample({})
            return {(name, sign): alone[name] for name, sign in parts}
        table = jax.vmap(of_sample)(self._errors())
        return {
            (name, sign): _smooth_share(table["lift_over_weight"] - 1.0)
            if name == PROBABILITY
            else self._reduce(table[name], sign)
            for name, sign in parts
        }

    def _errors(self) -> dict[str, np.ndarray]:
        """Errors of the uncertain numbers in their standard uncertainties, by name."""
        tolerances = self.problem.tolerances
        return {
            name: column
            if name in tolerances
            else (column - np.mean(column)) / self._spread(name, {})
            for name, column in self.problem.samples.items()
        }

    def _reduce(self, column: Any, sign: float) -> Any:
        """The mean of samples, or their quantile on the side that is worse."""
        quantile = self.problem.quantile
        if quantile is None:
            return jnp.mean(column)
        return jnp.quantile(column, quantile if sign > 0.0 else 1.0 - quantile)

    def scores(
        self, point: Any, changed: Mapping[str, Any] | None = None, context: "Context | None" = None
    ) -> Any:
        """Objectives, larger is better, then constraints, positive where satisfied; traced."""
        given = self.all_values(point, changed)
        context = self._context if context is None else context
        return self._scores(given, self._films(given, context), context)

    def _scores(self, given: Mapping[str, Any], films: "_Moving | None", context: "Context") -> Any:
        values = self._values(given, films)
        problem = self.problem
        objectives = [part.sign * values[part.name, part.sign] for part in problem.objectives]
        limits = jnp.asarray(context.limits)
        scales = _scales(limits)
        constraints = [
            part.sign * (values[part.name, part.sign] - limits[number]) / scales[number]
            for number, part in enumerate(problem.constraints)
        ]
        return jnp.stack([*objectives, *constraints])

    @property
    def batch(self) -> int:
        """Designs evaluated at once."""
        return _BATCH_OF_FILMS if self.is_quick else SCREENED

    def scores_of_many(self, points: np.ndarray, size: int | None = None) -> np.ndarray:
        """:meth:`scores` at points, shape (n, objectives + constraints); ``points`` (n, k)."""
        free = {
            bounds.field.name: np.asarray(bounds.value(column))
            for bounds, column in zip(self.problem.bounds, points.T, strict=True)
        }
        others = (self.problem.means() | self.problem.fixed).items()
        columns = {name: np.full(len(points), value) for name, value in others}
        return self.scores_of_designs(columns | free, size)

    def scores_of_designs(
        self, designs: Mapping[str, np.ndarray], size: int | None = None
    ) -> np.ndarray:
        """:meth:`scores` of designs, by all numbers that are free, fixed or uncertain."""
        names = list(designs)
        found: np.ndarray = in_batches(
            lambda *columns: self._many(dict(zip(names, columns, strict=True)), self._context),
            list(designs.values()),
            self.batch if size is None else size,
        )
        return found

    @cached_property
    def _many(self) -> Callable[..., np.ndarray]:
        def many(designs: Mapping[str, Any], context: Context) -> Any:
            return jax.vmap(lambda one: self._scores(one, self._films(one, context), context))(
                designs
            )

        return entry_point(many)

    def whatever_films_bear(self) -> "ObjectiveFunction":
        """The same function without the limits of its films; what is compiled, it shares."""
        function = copy.copy(self)
        of_film = np.array([part.of_film for part in self.problem.constraints], bool)
        limits = np.where(of_film, _ANY_HEAT, self._context.limits)
        function._context = Context(self._context.tables, self._context.shift, limits)
        return function

    def without_errors(self) -> "ObjectiveFunction":
        """The objective of designs as they are drawn, with the same films."""
        if not self.problem.samples:
            return self
        nominal = replace(self.problem, samples={}, quantile=None, constraints=())
        function = ObjectiveFunction(nominal)
        function._context = self._context
        return function

    def scores_and_jacobian(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """:meth:`scores` at a point and their derivatives, shape (m, k)."""
        found: tuple[np.ndarray, np.ndarray] = self._both(point, self._context)
        return found

    @cached_property
    def _both(self) -> Callable[..., Any]:
        def both(point: Any, context: Context) -> Any:
            def scores(one: Any) -> Any:
                return self.scores(one, None, context)

            count = len(self.problem.bounds)
            if self.is_quick and len(self.problem.asked) < count:
                found, pull = jax.vjp(scores, point)
                return found, jax.vmap(pull)(jnp.eye(found.size))[0]
            # forwards: there are few free numbers
            found, push = jax.linearize(scores, point)
            return found, jax.vmap(push, out_axes=1)(jnp.eye(count))

        return entry_point(both)

    def parameter_gradient(
        self, point: np.ndarray, multipliers: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Derivatives of the Lagrangian in relative changes of the numbers that are not free."""
        growth = dict.fromkeys(self._parameters(), 1.0)
        found: dict[str, np.ndarray] = self._gradient(growth, point, multipliers, self._context)
        return found

    @cached_property
    def _gradient(self) -> Callable[..., Any]:
        numbers = self._parameters()

        def lagrangian(
            growth: Mapping[str, Any], point: Any, multipliers: Any, context: Context
        ) -> Any:
            changed = {name: growth[name] * value for name, value in numbers.items()}
            scores = self.scores(point, changed, context)
            return scores[0] + jnp.dot(multipliers, scores[1:])

        return entry_point(jax.grad(lagrangian))

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


def _smooth_share(margins: Any) -> Any:
    """Share of positive margins, by a kernel estimate so that it has a derivative."""
    spread = jax.lax.stop_gradient(jnp.std(margins))
    width = _SILVERMAN * spread * margins.size**-0.2
    return jnp.mean(special.ndtr(margins / jnp.maximum(width, np.finfo(float).tiny)))
