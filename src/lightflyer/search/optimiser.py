r"""The best design: gradients from many starts, within bounds and constraints.

A Sobol sample of the unit cube of free numbers gives starts that are good and apart. From each,
sequential quadratic programming (SLSQP) follows exact gradients. At the optimum the Lagrangian

.. math:: L = f + \sum_i \lambda_i\,c_i

gives its sensitivities: the multiplier of an active constraint is the gain per unit of its limit,
and the derivative of :math:`L` in a number that is not free is that of the optimum (envelope
theorem), although the best design moves with it.
"""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.stats import qmc

from lightflyer.config.designs import as_design
from lightflyer.core.errors import ConfigurationError, LightflyerError
from lightflyer.core.progress import report
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.files.result_text import Parts, PrintedResult
from lightflyer.force.base import AbstractForceModel
from lightflyer.prediction.prediction import Prediction, predict_design
from lightflyer.search.local_search import (
    AGREEMENT,
    FEASIBLE,
    LocalOptimum,
    Ranking,
    Rival,
    choose_stack,
    maximise_from,
    maximise_in_full,
    merit,
    rivals_of,
)
from lightflyer.search.objectives import (
    SCREENED,
    AsMade,
    ObjectiveFunction,
    diagnose_solution,
    simulate_making,
)
from lightflyer.search.problem import Problem, as_problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCREENED_FILMS = 256  # The same where each design has a film of its own: gradients do the rest

_APART = 0.1  # least distance of two starts, in sides of the cube
_HALF_SIDES = (0.1, 0.03, 0.01)  # of the cubes that are sampled around the starts
_AT_BOUND = 1e-6  # distance from a bound, in sides of the cube
# outputs that say whether a flyer lifts its weight, and the least of one that does
_LEAST_OF_FLYING = {"payload": 0.0, "relative_payload": 0.0, "lift_over_weight": 1.0}


@dataclass(frozen=True, repr=False)
class Optimum(PrintedResult):
    """The best design, and how it depends on limits and numbers."""

    problem: Problem
    value: float  #: Objective, in SI units
    #: Free numbers by name, in the units of the design: SI, angles in degrees where a flyer file
    #: gives them so
    design: dict[str, float]
    outputs: dict[str, float]  #: Objectives and constraints by name, in SI units
    #: ``"low"`` or ``"high"`` for each free number that lies at its bound
    active_bounds: dict[str, str]
    #: Gain of the objective per unit of each active limit, by the output's name
    active_constraints: dict[str, float]
    #: Relative change of the objective over that of each number that is not free, while the best
    #: design moves along; the largest first
    elasticities: dict[str, float]
    starts: int  #: Number of searches, and of those that found this optimum
    agreeing: int  #: Number of searches, and of those that found this optimum
    evaluations: int  #: Number of evaluations of the objective with its gradient
    #: Where the best design is outside the range of the force model or of its film
    warnings: tuple[str, ...]
    #: What is lost where the best design is not made exactly: numbers with an ``uncertainty``, and
    #: thicknesses of layers. None where there are none
    as_made: AsMade | None = None
    #: Designs that would be better but for a limit, or that are within a range
    rivals: tuple[Rival, ...] = ()
    #: Other stacks of layers, where the film was chosen among several
    ranking: Ranking | None = None

    @cached_property
    def prediction(self) -> Prediction:
        """What the best design does, over the whole of its surroundings."""
        setup = self.problem.design.build(self.problem.fixed | self.design)
        name = self.problem.design.coordinate_name
        coordinate = self.problem.fixed.get(name, self.design.get(name))
        return predict_design(as_design(setup), () if coordinate is None else (coordinate,))

    def plot(self) -> "Figure":
        """Draw the elasticities; ``prediction.plot()`` draws what the best design does."""
        from lightflyer.search.text import elasticity_figure

        return elasticity_figure(self)

    def text_parts(self) -> Parts:
        from lightflyer.search.text import optimum_parts

        return optimum_parts(self)

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
            "as_made": None if self.as_made is None else self.as_made.summary(),
            "rivals": [dataclasses.asdict(rival) for rival in self.rivals],
            "ranking": None if self.ranking is None else self.ranking.summary(),
            "warnings": list(self.warnings),
        }


def optimise(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    maximise: str | None = None,
    minimise: str | None = None,
    over: Mapping[str, Any] | None = None,
    constraints: Mapping[str, Any] | None = None,
    uncertainty: Mapping[str, Any] | None = None,
    points: int | None = None,
    method: str | None = None,
    starts: int | None = None,
    seed: int | None = None,
    beyond_range: bool | None = None,
    stacks: Mapping[str, Any] | None = None,
) -> Optimum:
    """The best design within bounds and constraints.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path, AbstractDesign or Problem
        What is varied; or all of the problem, from
        :func:`~lightflyer.search.problem.read_problem`.
    environment, model : optional
        Where ``what`` is a flyer.
    maximise, minimise : str, optional
        The objective: the name of an output, or ``"probability_of_flying"``.
    over : dict of str to object
        By the name of a number: bounds ``{"from": "1 cm", "to": "5 cm"}``, perhaps with
        ``"scale": "log"`` and the ``"uncertainty"`` with which it is made, such as ``"5 %"``;
        one value; or a distribution. Thicknesses of layers are numbers such as
        ``"film.layers.0.thickness"``; layer 0 is the top one.
    constraints : dict of str to dict, optional
        By the name of an output, such as ``{"temperature": {"at_most": "330 K"}}``.
    uncertainty : dict, optional
        ``{"of": "mean"}`` or ``{"of": "quantile", "quantile": 0.05}``: what stands for an output
        where numbers are uncertain, by distributions in ``over`` or by those of the design.
    points, method : optional
        Number of samples of uncertain numbers, by default 1024, and how they are drawn; see
        :func:`~lightflyer.parametric.run.sweep`.
    starts : int, optional
        Number of searches, by default 8.
    seed : int, optional
        Default 0.
    beyond_range : bool, optional
        Whether films may get hotter than their ``highest_temperature``. By default they must not,
        where the flyer is judged: at the coordinate given, else where it comes to rest, and with
        ``afloat_payload`` at the peak of lift.
    stacks : dict, optional
        Materials of which the film may be made, instead of its own: ``{"materials": [...],
        "most_layers": 4}``, as in a study file.

    Returns
    -------
    Optimum

    Raises
    ------
    ConfigurationError
        If a number or an output does not exist or a value is not possible.
    LightflyerError
        If no design has a value or none satisfies the constraints.

    References
    ----------
    [Kraft1988]_ for SLSQP, by way of SciPy.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> best = lf.optimise(
    ...     lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023(),
    ...     maximise="payload", over={"altitude": {"from": "60 km", "to": "90 km"}},
    ... )
    >>> print(f"{best.value * 1e6:.4f} mg at {best.design['altitude'] / 1e3:.2f} km")
    0.1855 mg at 72.12 km
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
        starts=starts,
        points=points,
        method=method,
        seed=seed,
        beyond_range=beyond_range,
        stacks=stacks,
    )
    if problem.choice is None:
        return find_optimum(ObjectiveFunction(problem))
    problem, ranking = choose_stack(problem)
    found = find_optimum(ObjectiveFunction(problem))
    return replace(found, ranking=ranking, warnings=(*found.warnings, *ranking.notes))


def find_optimum(function: ObjectiveFunction) -> Optimum:
    """The best design of a problem with one objective."""
    problem = function.problem
    if len(problem.objectives) > 1:
        raise ConfigurationError(
            "several objectives have no single optimum; call pareto for their front"
        )
    starts, scale = _screen(function)
    searches = _climb(function, starts, scale)
    satisfying = [found for found in searches if found.violation <= FEASIBLE]
    notes: tuple[str, ...] = ()
    if not satisfying and any(part.of_film for part in problem.constraints):
        function = function.whatever_films_bear()
        searches = _climb(function, starts, scale)
        satisfying = [found for found in searches if found.violation <= FEASIBLE]
        notes = ("no design within the bounds keeps its film as cool as it must be",)
    if not satisfying:
        least = min(searches, key=lambda found: found.violation)
        raise LightflyerError(
            "no design satisfies the constraints; the best violates that of "
            f"{least.violated} by {100.0 * least.violation:.3g} % of its limit; widen the bounds "
            "or the limits"
        )
    best = max(satisfying, key=lambda found: found.score)
    near = AGREEMENT * max(abs(best.score), scale)
    agreeing = sum(abs(found.score - best.score) <= near for found in satisfying)
    if function.is_quick:
        best = maximise_in_full(function, satisfying, scale)
    rivals, objective = tuple(rivals_of(function, best, scale)), problem.objectives[0]
    design = problem.free_numbers(best.point)
    warnings = [*notes, *diagnose_solution(problem, design)]
    least_of_flying = _LEAST_OF_FLYING.get(objective.name, -np.inf)
    if not problem.samples and objective.sign > 0.0 and best.score < least_of_flying:
        warnings.append(
            "the best design does not lift its weight: none within bounds and constraints flies"
        )
    # gain per scaled unit by which each constraint is loosened
    scores, slopes = function.scores_and_jacobian(best.point)
    inside = (best.point > _AT_BOUND) & (best.point < 1.0 - _AT_BOUND)
    active = np.flatnonzero(scores[1:] <= FEASIBLE)
    multipliers = np.zeros(len(problem.constraints))
    if active.size and inside.any():
        normals = slopes[1 + active][:, inside].T
        gains, *_ = np.linalg.lstsq(normals, -slopes[0][inside], rcond=None)
        multipliers[active] = np.maximum(gains, 0.0)
    gradient = function.parameter_gradient(best.point, multipliers)
    relative = {name: float(slope) / best.score for name, slope in gradient.items() if float(slope)}
    return Optimum(
        problem=problem,
        value=objective.sign * best.score,
        design=design,
        outputs=function.outputs_at(best.point),
        active_bounds={
            bounds.field.name: "low" if fraction <= _AT_BOUND else "high"
            for bounds, fraction, is_inside in zip(problem.bounds, best.point, inside, strict=True)
            if not is_inside
        },
        active_constraints={
            part.name: objective.sign * float(multiplier) / part.scale
            for part, multiplier in zip(problem.constraints, multipliers, strict=True)
            if multiplier > 0.0
        },
        # Some differ by rounding only, as those of irradiance and absorptance: then by name.
        elasticities=dict(
            sorted(relative.items(), key=lambda item: (-float(f"{abs(item[1]):.5e}"), item[0]))
        ),
        starts=len(searches),
        agreeing=agreeing,
        evaluations=sum(found.evaluations for found in searches),
        warnings=tuple(warnings),
        as_made=simulate_making(function, best.point),
        rivals=rivals,
    )


def _climb(function: ObjectiveFunction, starts: np.ndarray, scale: float) -> list[LocalOptimum]:
    """Optima that are reached from some starts."""
    searches: list[LocalOptimum] = []
    for start in starts:
        report("climbing from several starts", len(searches), len(starts))
        searches.append(maximise_from(function, start, scale))
    return searches


def _screen(function: ObjectiveFunction) -> tuple[np.ndarray, float]:
    """Good starts that are apart, and the scale of the objective."""
    problem = function.problem
    report("screening designs")
    count = SCREENED_FILMS if function.is_quick else SCREENED
    points = qmc.Sobol(len(problem.bounds), rng=problem.seed).random(count)
    scores = function.scores_of_many(points)
    known = np.isfinite(scores).all(axis=1)
    if not known.any():
        raise LightflyerError(
            f"none of {count} designs within the bounds has a {problem.objectives[0].name}; "
            "widen them"
        )
    function.require_effects(points[known], scores[known])
    spread = np.ptp(np.percentile(scores[known, 0], [25.0, 100.0]))
    scale = float(spread) or float(np.abs(scores[known, 0]).max()) or 1.0
    chosen: list[np.ndarray] = []
    for point in points[known][np.argsort(-merit(scores[known], scale))]:
        if all(np.abs(point - other).max() >= _APART for other in chosen):
            chosen.append(point)
        if len(chosen) == problem.starts:
            break
    starts = np.array(chosen)
    each = len(points) // len(starts)
    if function.is_quick or each <= 1:
        return starts, scale  # a gradient costs as much as a few designs
    for half in _HALF_SIDES:  # hundreds of points cost as much as two gradients
        near = np.clip(starts[:, None] + half * (2.0 * points[:each] - 1.0), 0.0, 1.0)
        near[:, 0] = starts
        around = function.scores_of_many(near.reshape(-1, starts.shape[1]))
        best = np.argmax(merit(around, scale).reshape(len(starts), each), axis=1)
        starts = near[np.arange(len(starts)), best]
    return starts, scale
