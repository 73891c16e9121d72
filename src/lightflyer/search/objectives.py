"""Objectives and constraints as compiled functions with derivatives."""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.special import ndtr

from lightflyer.flight.outputs import evaluate
from lightflyer.foundation.precision import float64
from lightflyer.search.problem import PROBABILITY, Constraint, Objective, Problem

_SILVERMAN = 1.06  # width of a kernel over the spread, times n^(1/5)


class ObjectiveFunction:
    """Objectives and constraints of a problem over the unit cube of its free numbers.

    A point has one fraction from 0 to 1 for each free number; see
    :class:`~lightflyer.search.problem.Bounds`. Each function is compiled when it is first used.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem):
        self.problem = problem

    def outputs(self, point: Any, changed: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Outputs at a point, with uncertain ones reduced to one number; to be traced.

        Parameters
        ----------
        point : array, shape (k,)
        changed : dict of str to array, shape ()
            Numbers of the design with other values; for an uncertain one, its mean.

        Returns
        -------
        dict of str to array, shape ()
            The value of a number that is an objective and a constraint is that of the objective.
        """
        parts: tuple[Objective | Constraint, ...] = (
            *self.problem.constraints,
            *self.problem.objectives,
        )
        values = self._values(point, changed)
        return {part.name: values[part.name, part.sign] for part in parts}

    def _values(
        self, point: Any, changed: Mapping[str, Any] | None = None
    ) -> dict[tuple[str, float], Any]:
        """Outputs by name and by whether more (1) or less (-1) is better."""
        problem = self.problem
        judged: tuple[Objective | Constraint, ...] = (*problem.objectives, *problem.constraints)
        parts = {(part.name, part.sign) for part in judged}
        free = {
            bounds.field.name: bounds.value(point[index])
            for index, bounds in enumerate(problem.bounds)
        }
        given = problem.fixed | free | dict(changed or {})
        coordinate = problem.design.coordinate_name

        def of_sample(sample: Mapping[str, Any]) -> dict[str, Any]:
            values = given | dict(sample)
            setup = problem.design.build(values)
            return evaluate(setup, problem.outputs, values.get(coordinate))[0]

        if not problem.samples:
            alone = of_sample({})
            return {(name, sign): alone[name] for name, sign in parts}
        samples = {
            name: values + (given[name] - np.mean(values) if name in given else 0.0)
            for name, values in problem.samples.items()
        }
        table = jax.vmap(of_sample)(samples)
        return {
            (name, sign): _smooth_share(table["lift_over_weight"] - 1.0)
            if name == PROBABILITY
            else self._reduce(table[name], sign)
            for name, sign in parts
        }

    def _reduce(self, column: Any, sign: float) -> Any:
        """The mean of samples, or their quantile on the side that is worse."""
        quantile = self.problem.quantile
        if quantile is None:
            return jnp.mean(column)
        return jnp.quantile(column, quantile if sign > 0.0 else 1.0 - quantile)

    def scores(self, point: Any, changed: Mapping[str, Any] | None = None) -> Any:
        """Objectives, larger is better, then constraints, positive where satisfied; to be traced.

        Parameters
        ----------
        point : array, shape (k,)
        changed : dict of str to array, shape ()
            See :meth:`outputs`.

        Returns
        -------
        array, shape (objectives + constraints,)
            Constraints are in units of their limits.
        """
        values = self._values(point, changed)
        problem = self.problem
        objectives = [part.sign * values[part.name, part.sign] for part in problem.objectives]
        constraints = [
            part.sign * (values[part.name, part.sign] - part.limit) / part.scale
            for part in problem.constraints
        ]
        return jnp.stack([*objectives, *constraints])

    @cached_property
    def scores_of_many(self) -> Callable[[np.ndarray], np.ndarray]:
        """:meth:`scores` at points of shape (n, k); compiled."""
        return _compiled(jax.vmap(self.scores))

    @cached_property
    def outputs_at(self) -> Callable[[np.ndarray], dict[str, np.ndarray]]:
        """:meth:`outputs` at a point; compiled."""
        return _compiled(self.outputs)

    @cached_property
    def scores_and_jacobian(self) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """:meth:`scores` at a point and their derivatives, shape (m, k); compiled."""

        def both(point: Any) -> Any:
            # forwards: there are few free numbers
            scores, push = jax.linearize(self.scores, point)
            return scores, jax.vmap(push, out_axes=1)(jnp.eye(len(self.problem.bounds)))

        return _compiled(both)

    @cached_property
    def parameter_gradient(self) -> Callable[[np.ndarray, np.ndarray], dict[str, np.ndarray]]:
        """Derivatives of the Lagrangian in relative changes of the numbers that are not free.

        Takes a point and the constraints' multipliers; compiled.
        """
        numbers = self._parameters()

        def lagrangian(growth: Mapping[str, Any], point: Any, multipliers: Any) -> Any:
            changed = {name: growth[name] * value for name, value in numbers.items()}
            scores = self.scores(point, changed)
            return scores[0] + jnp.dot(multipliers, scores[1:])

        gradient = _compiled(jax.grad(lagrangian))
        return lambda point, multipliers: gradient(dict.fromkeys(numbers, 1.0), point, multipliers)

    def _parameters(self) -> dict[str, float]:
        """Numbers of the design that are neither free nor zero nor costly, by dotted name."""
        problem, design = self.problem, self.problem.design
        means = {name: float(np.mean(column)) for name, column in problem.samples.items()}
        costly = design.costly(list(design.quantities))
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


def _compiled(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function compiled for NumPy arrays in double precision."""
    compiled: Any = jax.jit(function)

    def call(*arguments: Any) -> Any:
        with float64():
            return jax.tree.map(np.asarray, compiled(*arguments))

    return call


def _smooth_share(margins: Any) -> Any:
    """Share of positive margins, by a kernel estimate so that it has a derivative."""
    spread = jax.lax.stop_gradient(jnp.std(margins))
    width = _SILVERMAN * spread * margins.size**-0.2
    return jnp.mean(ndtr(margins / jnp.maximum(width, np.finfo(float).tiny)))
