"""What a problem asks of a place in its box, with derivatives, compiled."""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jax.scipy.special import ndtr

from lightflyer.flight.fields import fields
from lightflyer.flight.outputs import evaluate
from lightflyer.foundation.precision import float64
from lightflyer.search.problem import PROBABILITY, Problem, number

_SILVERMAN = 1.06  # width of a kernel over the spread, times n^(1/5)


class Landscape:
    """Objectives and constraints as compiled functions of the place in the box.

    A place has one coordinate from 0 to 1 for each free field.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem):
        self.problem = problem

    def values(self, place: Any, moved: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Outputs at a place, what is uncertain reduced to one number; to be traced.

        Parameters
        ----------
        place : array, shape (k,)
        moved : dict of str to array, shape ()
            Numbers of the flyer file with other values; of an uncertain one, its mean.

        Returns
        -------
        dict of str to array, shape ()
        """
        problem = self.problem
        free = {
            bounds.field.name: bounds.value(place[index])
            for index, bounds in enumerate(problem.bounds)
        }
        given = problem.fixed | free | dict(moved or {})

        def outputs(samples: Mapping[str, Any]) -> dict[str, Any]:
            return evaluate(problem.configuration, problem.outputs, given | dict(samples))[0]

        if not problem.samples:
            return outputs({})
        samples = {
            name: values + (given[name] - np.mean(values) if name in given else 0.0)
            for name, values in problem.samples.items()
        }
        table = jax.vmap(outputs)(samples)
        reduced = {name: self._reduce(column) for name, column in table.items()}
        if "lift_over_weight" in table:
            reduced[PROBABILITY] = _smooth_share(table["lift_over_weight"] - 1.0)
        return reduced

    def _reduce(self, column: Any) -> Any:
        quantile = self.problem.quantile
        return jnp.mean(column) if quantile is None else jnp.quantile(column, quantile)

    def gains(self, place: Any, moved: Mapping[str, Any] | None = None) -> Any:
        """Objectives, larger is better, then constraints, positive where they are kept.

        Parameters
        ----------
        place : array, shape (k,)
        moved : dict of str to array, shape ()

        Returns
        -------
        array, shape (objectives + constraints,)
        """
        values = self.values(place, moved)
        problem = self.problem
        gains = [part.sign * values[part.name] for part in problem.objectives]
        kept = [
            part.sign * (values[part.name] - part.limit) / part.scale
            for part in problem.constraints
        ]
        return jnp.stack([*gains, *kept])

    @cached_property
    def many(self) -> Callable[[np.ndarray], np.ndarray]:
        """:meth:`gains` at many places, shape (n, k); compiled."""
        return _compiled(jax.vmap(self.gains))

    @cached_property
    def named(self) -> Callable[[np.ndarray], dict[str, np.ndarray]]:
        """:meth:`values` at a place; compiled."""
        return _compiled(self.values)

    @cached_property
    def with_slopes(self) -> Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """:meth:`gains` at a place and their derivatives, shape (m, k); compiled."""

        def both(place: Any) -> Any:
            # forwards: there are few free fields
            gains, push = jax.linearize(self.gains, place)
            return gains, jax.vmap(push, out_axes=1)(jnp.eye(len(self.problem.bounds)))

        return _compiled(both)

    @cached_property
    def slope_in_numbers(self) -> Callable[[np.ndarray, np.ndarray], dict[str, np.ndarray]]:
        """Derivatives of the Lagrangian in relative changes of the numbers that are not free.

        Of a place and the constraints' multipliers; compiled.
        """
        free = {bounds.field.name for bounds in self.problem.bounds}
        means = {name: float(np.mean(column)) for name, column in self.problem.samples.items()}
        numbers = {
            name: stated
            for name, stated in (given_numbers(self.problem) | self.problem.fixed | means).items()
            if name not in free and name not in ("altitude", "pressure")
        }

        def lagrangian(growth: Mapping[str, Any], place: Any, multipliers: Any) -> Any:
            moved = {name: growth[name] * value for name, value in numbers.items()}
            gains = self.gains(place, moved)
            return gains[0] + jnp.dot(multipliers, gains[1:])

        slopes = _compiled(jax.grad(lagrangian))
        return lambda place, multipliers: slopes(dict.fromkeys(numbers, 1.0), place, multipliers)


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


def given_numbers(problem: Problem) -> dict[str, float]:
    """Numbers of the flyer file that are not zero and that designs can be built from when traced.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    dict of str to float
        By dotted name.
    """
    found = {}
    for name in fields(problem.configuration):
        if name in ("altitude", "pressure") or name.startswith("film.layers."):
            continue
        try:
            value = number(problem.configuration, name)
        except AttributeError:
            continue  # an optional field that is not given
        if value:
            found[name] = value
    return found
