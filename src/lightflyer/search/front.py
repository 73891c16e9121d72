"""Several objectives at once: the Pareto front, by a genetic algorithm."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.errors import LightflyerError
from lightflyer.core.extras import extra
from lightflyer.core.progress import Counted
from lightflyer.design.outputs import outputs_of
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.files.result_text import Parts, PrintedResult
from lightflyer.force.base import AbstractForceModel
from lightflyer.search.objectives import ObjectiveFunction, diagnose_solution
from lightflyer.search.problem import PROBABILITY, Problem, as_problem

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

POPULATION, GENERATIONS = 100, 150
"""Size of the genetic algorithm by default."""

_NO_VALUE = np.finfo(float).max ** 0.5  # loss of a design that has no value


@dataclass(frozen=True, repr=False)
class Front(PrintedResult):
    """Designs that no other beats in all objectives at once."""

    problem: Problem
    objectives: dict[str, np.ndarray]  #: shape (n,); in SI units, ordered by the first
    designs: dict[str, np.ndarray]  #: shape (n,); free numbers by name, in the units of the design
    evaluations: int  #: Number of designs evaluated
    #: Where the designs at the front's ends are outside the range of the force model or the film
    warnings: tuple[str, ...]

    @property
    def dataset(self) -> "xr.Dataset":
        """Objectives over the dimension ``design``, with the free numbers as coordinates."""
        import xarray as xr

        known = outputs_of(self.problem.design.setup)
        probability = {"units": "1", "long_name": PROBABILITY.replace("_", " ")}
        variables = {
            name: ("design", values, probability if name == PROBABILITY else known[name].attributes)
            for name, values in self.objectives.items()
        }
        coordinates = {
            name: ("design", values, self.problem.design.field(name).attributes)
            for name, values in self.designs.items()
        }
        attributes = {"title": "lightflyer Pareto front", "warnings": "; ".join(self.warnings)}
        return xr.Dataset(variables, coordinates, attributes)

    def plot(self) -> "Figure":
        """Draw the objectives, each against the first."""
        from lightflyer.search.text import front_figure

        return front_figure(self)

    def text_parts(self) -> Parts:
        from lightflyer.search.text import front_parts

        return front_parts(self)

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        return {
            "objectives": {part.name: part.word for part in self.problem.objectives},
            "values": {name: column.tolist() for name, column in self.objectives.items()},
            "designs": {name: column.tolist() for name, column in self.designs.items()},
            "evaluations": self.evaluations,
            "warnings": list(self.warnings),
        }


def pareto(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    maximise: str | Sequence[str] | None = None,
    minimise: str | Sequence[str] | None = None,
    over: Mapping[str, Any] | None = None,
    constraints: Mapping[str, Any] | None = None,
    uncertainty: Mapping[str, Any] | None = None,
    points: int | None = None,
    method: str | None = None,
    seed: int | None = None,
    beyond_range: bool | None = None,
    population: int = POPULATION,
    generations: int = GENERATIONS,
) -> Front:
    """The Pareto front of several objectives, by NSGA-II.

    Parameters
    ----------
    what, environment, model, over, constraints, uncertainty, points, method, seed, beyond_range
        As for :func:`~lightflyer.search.optimiser.optimise`. Designs outside the range of the force
        model are not refused: the front's ``warnings`` tell of them.
    maximise, minimise : str or sequence of str, optional
        The objectives: names of outputs, or ``"probability_of_flying"``.
    population, generations : int
        Size of the genetic algorithm.

    Returns
    -------
    Front

    Raises
    ------
    ConfigurationError
        If a number or an output does not exist or a value is not possible.
    LightflyerError
        If no design satisfies the constraints.
    MissingExtraError
        If pymoo is not installed.

    References
    ----------
    [Deb2002]_ for the algorithm, [Blank2020]_ for its implementation.
    """
    problem = as_problem(
        what,
        environment,
        model,
        maximise=maximise,
        minimise=minimise,
        over=over,
        constraints=constraints,
        uncertainty=uncertainty,
        points=points,
        method=method,
        seed=seed,
        beyond_range=beyond_range,
    )
    function = ObjectiveFunction(problem)
    some = np.random.default_rng(problem.seed).random((population, len(problem.bounds)))
    scores = function.scores_of_many(some)
    known = np.isfinite(scores).all(axis=1)
    function.require_effects(some[known], scores[known])
    core = extra("pymoo.core.problem", "a Pareto front", "optimise")
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.optimize import minimize as search

    count = len(problem.objectives)
    counted = Counted("computing generations of designs", generations)

    class Vectorised(core.Problem):  # type: ignore[name-defined]
        def __init__(self) -> None:
            sides, limits = len(problem.bounds), len(problem.constraints)
            super().__init__(n_var=sides, n_obj=count, n_ieq_constr=limits, xl=0.0, xu=1.0)

        def _evaluate(self, points: np.ndarray, out: dict[str, Any], *_: Any, **__: Any) -> None:
            counted.add()
            scores = function.scores_of_many(points)
            losses = np.where(np.isfinite(scores), -scores, _NO_VALUE)
            out["F"], out["G"] = losses[:, :count], losses[:, count:]

    found = search(
        Vectorised(), NSGA2(pop_size=population), ("n_gen", generations), seed=problem.seed
    )
    if found.X is None:
        raise LightflyerError("no design satisfies the constraints; widen the bounds or the limits")
    places, losses = np.atleast_2d(found.X), np.atleast_2d(found.F)  # points in the unit cube
    order = np.argsort(-problem.objectives[0].sign * losses[:, 0])
    places, losses = places[order], losses[order]
    if function.is_quick:
        function.match(places[len(places) // 2])
        losses = -function.scores_of_many(places)[:, :count]
    designs = {
        bounds.field.name: np.asarray(bounds.value(places[:, row]))
        for row, bounds in enumerate(problem.bounds)
    }
    said = []
    if problem.needs_recompute:
        said.append(
            "the films of the front are computed on a coarse grid, within a few thousandths; in "
            "full at its middle only"
        )
    for word, row in (("first", 0), ("last", -1)):
        design = {name: float(column[row]) for name, column in designs.items()}
        said += [f"{word} design: {text}" for text in diagnose_solution(problem, design)]
    return Front(
        problem=problem,
        objectives={
            part.name: -part.sign * losses[:, row] for row, part in enumerate(problem.objectives)
        },
        designs=designs,
        evaluations=population * generations,
        warnings=tuple(said),
    )
