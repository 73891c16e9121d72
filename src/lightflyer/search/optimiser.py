r"""The best design: gradients from many starts, within bounds and constraints.

A first look over the whole box chooses starts that are good and apart. From each, sequential
quadratic programming (SLSQP) follows exact gradients. At the optimum the Lagrangian

.. math:: L = f - \sum_i \lambda_i\,c_i

tells what would change it: the multiplier of an active constraint is the gain per unit of its
limit, and the derivative of :math:`L` in a number that is not free is the optimum's own
(the envelope theorem), though the best design moves.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.stats import qmc

from lightflyer.foundation.errors import LightflyerError, MissingExtraError
from lightflyer.search.objectives import Landscape
from lightflyer.search.problem import Problem

SCREENED = 512
"""Designs of a look: at first over the whole box, then around the starts."""

AGREEMENT = 1e-6
"""Relative difference up to which the results of two starts are the same."""

FEASIBLE = 1e-6
"""Largest violation of a constraint, over the size of its limit."""

_APART = 0.1  # of the box's side, between starts
_LOOKS = (0.1, 0.03, 0.01)  # half sides of the boxes around the starts
_AT_BOUND = 1e-6  # of the box's side
_STOP = 1e-10  # of the objective's scale: SLSQP's tolerance
_STEPS = 200
_INFEASIBLE = 1e6  # what a design that has no value counts, in scales of the objective


@dataclass(frozen=True)
class Optimum:
    """The best design and what is known of it.

    Attributes
    ----------
    problem : Problem
    value : float
        Of the objective, in SI units.
    design : dict of str to float
        Of the free fields, in SI units (angles in degrees).
    outputs : dict of str to float
        Of all constraints and objectives.
    active_bounds : dict of str to str
        ``"low"`` or ``"high"`` of each free field that lies at its bound.
    active_constraints : dict of str to float
        Gain of the objective per unit of each active limit, by the output's name.
    elasticities : dict of str to float
        Relative change of the objective over that of each number of the flyer file that is not
        free, the best design moving along.
    starts, agreeing : int
        How many searches there were, and how many found this optimum.
    evaluations : int
        Of the objective with its gradient.
    """

    problem: Problem
    value: float
    design: dict[str, float]
    outputs: dict[str, float]
    active_bounds: dict[str, str]
    active_constraints: dict[str, float]
    elasticities: dict[str, float]
    starts: int
    agreeing: int
    evaluations: int

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        return {
            "objective": {self.problem.objectives[0].word: self.problem.objectives[0].name},
            "value": self.value,
            "design": self.design,
            "outputs": self.outputs,
            "active_bounds": self.active_bounds,
            "active_constraints": self.active_constraints,
            "elasticities": self.elasticities,
            "starts": self.starts,
            "agreeing": self.agreeing,
            "evaluations": self.evaluations,
        }


@dataclass(frozen=True)
class Front:
    """Designs that none beats in all objectives at once.

    Attributes
    ----------
    problem : Problem
    objectives : dict of str to array, shape (n,)
        In SI units, ordered by the first.
    designs : dict of str to array, shape (n,)
        Of the free fields, in SI units (angles in degrees).
    evaluations : int
    """

    problem: Problem
    objectives: dict[str, np.ndarray]
    designs: dict[str, np.ndarray]
    evaluations: int

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        return {
            "objectives": {part.name: part.word for part in self.problem.objectives},
            "values": {name: column.tolist() for name, column in self.objectives.items()},
            "designs": {name: column.tolist() for name, column in self.designs.items()},
            "evaluations": self.evaluations,
        }


def pareto(problem: Problem, *, population: int = 100, generations: int = 150) -> Front:
    """The Pareto front of a problem with several objectives, by NSGA-II.

    Parameters
    ----------
    problem : Problem
    population, generations : int
        Of the genetic algorithm.

    Returns
    -------
    Front

    Raises
    ------
    LightflyerError
        If no design keeps the constraints.
    MissingExtraError
        If pymoo is not installed.

    References
    ----------
    [Deb2002]_ for the algorithm, [Blank2020]_ for its implementation.
    """
    try:
        from pymoo.algorithms.moo.nsga2 import NSGA2
        from pymoo.core.problem import Problem as PymooProblem
        from pymoo.optimize import minimize as search
    except ImportError:
        raise MissingExtraError(
            "several objectives need pymoo: pip install 'lightflyer[optimise]'"
        ) from None
    look, count = Landscape(problem).many, len(problem.objectives)

    class Vectorised(PymooProblem):
        def __init__(self) -> None:
            sides, limits = len(problem.bounds), len(problem.constraints)
            super().__init__(n_var=sides, n_obj=count, n_ieq_constr=limits, xl=0.0, xu=1.0)

        def _evaluate(self, places: np.ndarray, out: dict[str, Any], *_: Any, **__: Any) -> None:
            gains = look(places)
            # what has no value is as bad as can be, and forbidden
            losses = np.where(np.isfinite(gains), -gains, np.finfo(float).max ** 0.5)
            out["F"], out["G"] = losses[:, :count], losses[:, count:]

    found = search(
        Vectorised(), NSGA2(pop_size=population), ("n_gen", generations), seed=problem.seed
    )
    if found.X is None:
        raise LightflyerError("no design keeps the constraints; widen the bounds or the limits")
    order = np.argsort(-problem.objectives[0].sign * found.F[:, 0])
    places, losses = np.atleast_2d(found.X)[order], np.atleast_2d(found.F)[order]
    return Front(
        problem=problem,
        objectives={
            part.name: -part.sign * losses[:, row] for row, part in enumerate(problem.objectives)
        },
        designs={
            bounds.field.name: np.asarray(bounds.value(places[:, row]))
            for row, bounds in enumerate(problem.bounds)
        },
        evaluations=population * generations,
    )


def optimise(problem: Problem, landscape: Landscape | None = None) -> Optimum:
    """The best design of a problem with one objective.

    Parameters
    ----------
    problem : Problem
    landscape : Landscape, optional
        Of the problem, if it is there already: it is compiled once.

    Returns
    -------
    Optimum

    Raises
    ------
    LightflyerError
        If no design has a value, or none keeps the constraints.

    References
    ----------
    [Kraft1988]_ for SLSQP, by way of SciPy.
    """
    landscape = landscape or Landscape(problem)
    sides = len(problem.bounds)
    places = qmc.Sobol(sides, rng=problem.seed).random(SCREENED)
    gains = landscape.many(places)
    known = np.isfinite(gains).all(axis=1)
    if not known.any():
        raise LightflyerError(
            f"none of {SCREENED} designs in the box has a {problem.objectives[0].name}: widen it"
        )
    spread = np.ptp(np.percentile(gains[known, 0], [25.0, 100.0]))
    scale = float(spread) or float(np.abs(gains[known, 0]).max()) or 1.0
    starts = _starts(places[known], gains[known], scale, problem.starts)
    for half in _LOOKS:
        starts = _look_around(landscape, starts, half * (2.0 * places - 1.0), scale)
    searches = [_search(landscape, start, scale) for start in starts]
    kept = [found for found in searches if found.violation <= FEASIBLE]
    if not kept:
        least = min(searches, key=lambda found: found.violation)
        raise LightflyerError(
            "no design keeps the constraints: the best misses one by "
            f"{100.0 * least.violation:.3g} % of its limit; widen the bounds or the limits"
        )
    best = max(kept, key=lambda found: found.gain)
    near = AGREEMENT * max(abs(best.gain), scale)
    return _describe(
        landscape,
        best,
        starts=len(searches),
        agreeing=sum(abs(found.gain - best.gain) <= near for found in kept),
        evaluations=sum(found.evaluations for found in searches),
    )


def _starts(places: np.ndarray, gains: np.ndarray, scale: float, most: int) -> np.ndarray:
    """Good places that are apart from each other."""
    chosen: list[np.ndarray] = []
    for place in places[np.argsort(-_merit(gains, scale))]:
        if all(np.abs(place - other).max() >= _APART for other in chosen):
            chosen.append(place)
        if len(chosen) == most:
            break
    return np.array(chosen)


def _merit(gains: np.ndarray, scale: float) -> np.ndarray:
    """What places are worth: those that keep the constraints before all others."""
    violation = np.maximum(-gains[:, 1:], 0.0).sum(axis=1)
    merit = gains[:, 0] / scale - _INFEASIBLE * violation
    return np.where(np.isfinite(merit), merit, -np.inf)


def _look_around(
    landscape: Landscape, starts: np.ndarray, steps: np.ndarray, scale: float
) -> np.ndarray:
    """The best place near each start; a look at hundreds costs what two gradients do."""
    each = len(steps) // len(starts)
    if each <= 1:
        return starts
    near = np.clip(starts[:, None] + steps[:each], 0.0, 1.0)
    near[:, 0] = starts
    flat = near.reshape(-1, starts.shape[1])
    # as many as at first: the function is compiled for that number
    filled = np.concatenate([flat, np.repeat(flat[-1:], len(steps) - len(flat), axis=0)])
    merit = _merit(landscape.many(filled), scale)[: len(flat)].reshape(len(starts), each)
    return near[np.arange(len(starts)), np.argmax(merit, axis=1)]


@dataclass(frozen=True)
class _Found:
    """Where a search ended."""

    place: np.ndarray
    gain: float
    violation: float
    evaluations: int


def _search(landscape: Landscape, start: np.ndarray, scale: float) -> _Found:
    """Climb from one start."""
    seen: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def look(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = place.tobytes()
        if key not in seen:
            gains, slopes = landscape.with_slopes(place)
            known = np.isfinite(gains)[:, None] & np.isfinite(slopes)
            gains = np.where(np.isfinite(gains), gains, -_INFEASIBLE * scale)
            seen[key] = gains, np.where(known, slopes, 0.0)
        return seen[key]

    constraints = [
        {
            "type": "ineq",
            "fun": lambda place, row=row: look(place)[0][row],
            "jac": lambda place, row=row: look(place)[1][row],
        }
        for row in range(1, 1 + len(landscape.problem.constraints))
    ]
    found = minimize(
        lambda place: (-look(place)[0][0] / scale, -look(place)[1][0] / scale),
        start,
        jac=True,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * start.size,
        constraints=constraints,
        options={"ftol": _STOP, "maxiter": _STEPS},
    )
    place = np.clip(found.x, 0.0, 1.0)
    gains, _ = look(place)
    violation = float(np.maximum(-gains[1:], 0.0).max(initial=0.0))
    if not np.isfinite(gains).all() or gains[0] <= -_INFEASIBLE * scale:
        violation = np.inf
    return _Found(place, float(gains[0]), violation, len(seen))


def _describe(
    landscape: Landscape, best: _Found, *, starts: int, agreeing: int, evaluations: int
) -> Optimum:
    problem = landscape.problem
    names = [bounds.field.name for bounds in problem.bounds]
    values = {name: float(value) for name, value in landscape.named(best.place).items()}
    design = {
        name: float(bounds.value(way))
        for name, bounds, way in zip(names, problem.bounds, best.place, strict=True)
    }
    at_bound = {
        name: "low" if way <= _AT_BOUND else "high"
        for name, way in zip(names, best.place, strict=True)
        if not _AT_BOUND < way < 1.0 - _AT_BOUND
    }
    multipliers = _multipliers(landscape, best.place)
    objective = problem.objectives[0]
    return Optimum(
        problem=problem,
        value=objective.sign * best.gain,
        design=design,
        outputs=values,
        active_bounds=at_bound,
        active_constraints={
            part.name: objective.sign * float(multiplier) / part.scale
            for part, multiplier in zip(problem.constraints, multipliers, strict=True)
            if multiplier > 0.0
        },
        elasticities=_elasticities(landscape, best, multipliers),
        starts=starts,
        agreeing=agreeing,
        evaluations=evaluations,
    )


def _multipliers(landscape: Landscape, place: np.ndarray) -> np.ndarray:
    """Gain per scaled unit by which each constraint were loosened, shape (constraints,)."""
    gains, slopes = landscape.with_slopes(place)
    inside = (place > _AT_BOUND) & (place < 1.0 - _AT_BOUND)
    active = np.flatnonzero(gains[1:] <= FEASIBLE)
    multipliers = np.zeros(len(landscape.problem.constraints))
    if active.size and inside.any():
        normals = slopes[1 + active][:, inside].T
        found, *_ = np.linalg.lstsq(normals, -slopes[0][inside], rcond=None)
        multipliers[active] = np.maximum(found, 0.0)
    return multipliers


def _elasticities(landscape: Landscape, best: _Found, multipliers: np.ndarray) -> dict[str, float]:
    """Elasticity of the optimum in every number of the flyer file that is not free."""
    slopes = landscape.slope_in_numbers(best.place, multipliers)
    return {name: float(slope) / best.gain for name, slope in slopes.items() if float(slope)}
