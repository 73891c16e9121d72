"""Optimisation problems: objectives, free numbers, constraints, and what is uncertain."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.config.designs import as_design
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.design.design import AbstractDesign, AbstractStacks
from lightflyer.design.outputs import check_outputs, outputs_of
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.search.bounds import Bounds, Tolerance, errors_of, read_bounds
from lightflyer.study.axes import Distribution, draw_samples, read_entry, stated_distributions
from lightflyer.study.sections import OptimiseSection, SamplingSection, from_arguments
from lightflyer.study.study import StudySource, errors_at, read_study_file, require_compatible

PROBABILITY = "probability_of_flying"
"""Share of the samples in which a design carries its weight: an objective or a constraint."""

_MARGIN = "lift_over_weight"
_HEAT = "temperature"
# at rest, and with the most that it carries by itself
_HEAT_OF = dict.fromkeys(("lowest_altitude", "highest_altitude", "band_width"), "rest_temperature")
_HEAT_OF |= {"afloat_payload": "afloat_temperature"}
_LIMITS = {"at_least": 1.0, "at_most": -1.0}


@dataclass(frozen=True)
class Objective:
    """An output to be maximised or minimised."""

    name: str
    sign: float  # 1 for an output to be maximised, -1 for one to be minimised

    @property
    def word(self) -> str:
        """``"maximise"`` or ``"minimise"``."""
        return "maximise" if self.sign > 0.0 else "minimise"


@dataclass(frozen=True)
class Constraint:
    """A limit of an output."""

    name: str  # Name of the output
    limit: float  # In the unit of the output
    sign: float  # 1 for "at least", -1 for "at most"
    of_film: bool = False  # Whether it is what the film withstands, which nobody asked for

    @property
    def scale(self) -> float:
        """Size of the limit, by which a violation is measured."""
        return abs(self.limit) or 1.0


@dataclass(frozen=True, eq=False)
class Choice:
    """Stacks of layers among which a film is chosen, and what the search goes on with."""

    stacks: AbstractStacks
    section: OptimiseSection  # What else is asked
    sampling: SamplingSection | None
    source: StudySource | None
    time_limit: float  # Of the choice, infinite where none is set [s]

    def limits(self, problem: "Problem", sequence: Sequence[int]) -> np.ndarray:
        """Limits of a problem's constraints for a stack."""
        highest = self.stacks.limit(sequence)
        return np.array([highest if part.of_film else part.limit for part in problem.constraints])

    def problem_of(self, sequence: Sequence[int]) -> "Problem":
        """The whole problem with one of the stacks, whose thicknesses are free."""
        design, over = self.stacks.choose(sequence)
        changes = {"over": self.section.over | over, "stacks": None}
        section = self.section.model_copy(update=changes)
        return make_problem(design, section, self.sampling, self.source)


@dataclass(frozen=True, eq=False)
class Problem(ShortRepr):
    """An optimisation problem."""

    design: AbstractDesign
    objectives: tuple[Objective, ...]
    bounds: tuple[Bounds, ...]  #: The free numbers
    fixed: dict[str, float]  #: Numbers that have one value, by dotted name
    constraints: tuple[Constraint, ...]
    #: shape (m,); values of the uncertain numbers; empty where there are none. Of a free number
    #: they are its errors in standard uncertainties
    samples: dict[str, np.ndarray]
    #: Quantile of the samples that stands for an output of which more is better; for one of which
    #: less is better, one minus it. None for the mean
    quantile: float | None
    #: Whether an optimum counts that is outside the range of the force model or the film
    beyond_range: bool
    starts: int  #: Number of searches
    seed: int
    #: The stacks of layers among which the film is chosen first, where there are several
    choice: "Choice | None" = None

    @property
    def tolerances(self) -> dict[str, Tolerance]:
        """How exactly free numbers can be made, by name, where it is stated."""
        return {one.field.name: one.tolerance for one in self.bounds if one.tolerance}

    @property
    def needs_recompute(self) -> list[str]:
        """Numbers that have other values than the design's own and change the optics of layers."""
        names = [bounds.field.name for bounds in self.bounds]
        return self.design.needs_recompute(
            list(dict.fromkeys([*names, *self.fixed, *self.samples]))
        )

    def free_numbers(self, point: np.ndarray) -> dict[str, float]:
        """Free numbers at a point of the unit cube, by name, in the units of the design."""
        parts = zip(self.bounds, point, strict=True)
        return {bounds.field.name: float(bounds.value(fraction)) for bounds, fraction in parts}

    def means(self) -> dict[str, float]:
        """Means of the uncertain numbers that are not free, by name."""
        free = {bounds.field.name for bounds in self.bounds}
        return {
            name: float(np.mean(column))
            for name, column in self.samples.items()
            if name not in free
        }

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of all outputs that have to be computed."""
        names = (_MARGIN if name == PROBABILITY else name for name in self.asked)
        return tuple(dict.fromkeys(names))

    @property
    def asked(self) -> tuple[str, ...]:
        """Names of the objectives and constraints."""
        objectives = [part.name for part in self.objectives]
        return tuple(dict.fromkeys([*objectives, *(part.name for part in self.constraints)]))

    def unit_of(self, name: str) -> str:
        """Unit of an objective or constraint, empty for a pure number."""
        return _unit_of(self.design, name)


def _unit_of(design: AbstractDesign, name: str) -> str:
    return "" if name == PROBABILITY else outputs_of(design.setup)[name].unit


def read_problem(path: str | Path) -> Problem:
    """Read the ``[optimise]`` of a study file.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    Problem

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key and what is allowed.
    """
    study, design, source = read_study_file(path)
    if study.optimise is None:
        raise ConfigurationError(
            f'{path}: needs a section [optimise] with maximise = "relative_payload" and '
            "[optimise.over] with the free numbers"
        )
    return make_problem(design, study.optimise, study.sampling, source)


def as_problem(
    what: Any,
    environment: AbstractEnvironment | None,
    model: AbstractForceModel | None,
    *,
    points: int | None = None,
    method: str | None = None,
    seed: int | None = None,
    **asked: Any,
) -> Problem:
    """The problem that the arguments of a search state; ``**asked`` [optimise]."""
    if isinstance(what, Problem):
        further = (environment, model, points, method, seed, *asked.values())
        if any(argument is not None for argument in further):
            raise ParameterError("a Problem already states all that the search needs to know")
        return what
    section = from_arguments(OptimiseSection, seed=seed, **asked)
    sampling = from_arguments(SamplingSection, points=points, method=method, seed=seed)
    return make_problem(as_design(what, environment, model), section, sampling)


def make_problem(
    design: AbstractDesign,
    section: OptimiseSection,
    sampling: SamplingSection | None = None,
    source: StudySource | None = None,
) -> Problem:
    """Look up what an optimisation names, check it, and draw its samples."""
    if section.stacks is not None:
        return _with_choice(design, section, sampling, source)
    given = list(section.over)
    bounds: list[Bounds] = []
    fixed: dict[str, float] = {}
    distributions: list[Distribution] = []
    for name, entry in section.over.items():
        with errors_at(source, "optimise", "over", name):
            known = design.field(name)
            if isinstance(entry, Mapping) and "distribution" not in entry:
                bounds.append(read_bounds(entry, known))
                continue
            found = read_entry(entry, known)
            if isinstance(found, Distribution):
                distributions.append(found)
            elif found.single:
                fixed[name] = float(found.values[0])
            else:
                raise ConfigurationError(
                    'is a list; a free number has bounds, { from = "...", to = "..." }'
                )
    require_compatible(design, list(section.over), source, "optimise", "over")
    with errors_at(source, "optimise"):
        if not bounds:
            raise ConfigurationError(
                'needs over with at least one free number, such as "flyer.diameter" = '
                '{ from = "0.5 cm", to = "5 cm" }'
            )

    objectives = _objectives(design, section, source)
    uncertain = section.uncertainty
    if uncertain is not None:
        errors = [errors_of(one) for one in bounds if one.tolerance is not None]
        distributions = [*(distributions or stated_distributions(design, given)), *errors]
    with errors_at(source, "optimise", "uncertainty"):
        if uncertain is not None and not distributions:
            raise ConfigurationError(
                "no number is uncertain; state an uncertainty in the flyer file, give a "
                'distribution, such as "0.80 ± 0.01", in over, or give a free number an '
                'uncertainty = "5 %"'
            )
    # the optics of a film of layers are not computed in full every time
    for name in design.needs_recompute([*given, *(part.field.name for part in distributions)]):
        with errors_at(source, "optimise", "over", name):
            design.surrogate([name])
    stated = _constraints(design, section, source)
    asked = [*(part.name for part in objectives), *(part.name for part in stated)]
    highest = design.setup.flyer.highest_temperature
    constraints = (*stated, *_limits_of_film(highest, design, section, asked))
    names = {part.name for part in objectives} | {part.name for part in constraints}
    with errors_at(source, "optimise"):
        if PROBABILITY in names and not distributions:
            raise ConfigurationError(f"{PROBABILITY} needs uncertainty")
    sampling = sampling or SamplingSection()
    how = (sampling.points, sampling.method, sampling.seed, design.correlations)
    return Problem(
        design=design,
        objectives=objectives,
        bounds=tuple(bounds),
        fixed=fixed,
        constraints=constraints,
        samples=draw_samples(distributions, *how) if distributions else {},
        quantile=uncertain.quantile if uncertain and uncertain.of == "quantile" else None,
        beyond_range=section.beyond_range,
        starts=section.starts,
        seed=section.seed,
    )


def _with_choice(
    design: AbstractDesign,
    section: OptimiseSection,
    sampling: SamplingSection | None,
    source: StudySource | None,
) -> Problem:
    """The problem of any of the stacks that a section allows."""
    asked = section.stacks
    assert asked is not None  # as looked up
    with errors_at(source, "optimise", "stacks"):
        stacks = design.stacks(asked, source.path.parent if source else None)
        # bounds of each material's thickness, before a long search
        checked: set[int] = set()
        for sequence in stacks.sequences:
            if set(sequence) <= checked:
                continue
            chosen, over = stacks.choose(sequence)
            for name, entry in over.items():
                try:
                    read_bounds(entry, chosen.field(name))
                except ConfigurationError as error:
                    raise ConfigurationError(f"materials: {chosen.label(name)}: {error}") from None
            checked |= set(sequence)
    with errors_at(source, "optimise"):
        if PROBABILITY in (*section.maximise, *section.minimise):
            raise ConfigurationError(f"{PROBABILITY} cannot rank stacks; search with the payload")
        if len(section.maximise) + len(section.minimise) > 1:
            raise ConfigurationError("a search among stacks has one objective")
    limit = math.inf if asked.time_limit is None else float(asked.time_limit.value)
    choice = Choice(stacks, section, sampling, source, limit)
    # without uncertainty: each thickness is a share
    shares = {name: {"from": 0.0, "to": 1.0} for name in stacks.shares}
    sure = {k: v for k, v in section.constraints.items() if k != PROBABILITY}
    entries = {
        name: {key: value for key, value in entry.items() if key != "uncertainty"}
        if isinstance(entry, Mapping) and "distribution" not in entry
        else entry
        for name, entry in section.over.items()
    }
    changes = {"over": shares | entries, "constraints": sure, "uncertainty": None, "stacks": None}
    section = section.model_copy(update=changes)
    problem = make_problem(stacks.design, section, None, source)
    limits = []
    if not any(part.of_film for part in problem.constraints):
        # every stack withstands another temperature
        highest = stacks.limit(stacks.sequences[0])
        limits = [*_limits_of_film(highest, stacks.design, section, problem.asked)]
    return replace(problem, constraints=(*problem.constraints, *limits), choice=choice)


def _objectives(
    design: AbstractDesign, section: OptimiseSection, source: StudySource | None
) -> tuple[Objective, ...]:
    objectives = tuple(
        Objective(name, sign)
        for names, sign in ((section.maximise, 1.0), (section.minimise, -1.0))
        for name in names
    )
    with errors_at(source, "optimise"):
        if not objectives:
            raise ConfigurationError("needs maximise or minimise, the name of an output")
    seen: set[str] = set()
    for objective in objectives:
        with errors_at(source, "optimise", objective.word):
            if objective.name in seen:
                raise ConfigurationError(
                    f"{objective.name} is an objective already; name each output once"
                )
            seen.add(objective.name)
            if objective.name != PROBABILITY:
                check_outputs([objective.name], design.setup, list(section.over))
    return objectives


def _constraints(
    design: AbstractDesign, section: OptimiseSection, source: StudySource | None
) -> tuple[Constraint, ...]:
    found = []
    for name, limits in section.constraints.items():
        with errors_at(source, "optimise", "constraints", name):
            if not (isinstance(limits, Mapping) and limits and set(limits) <= set(_LIMITS)):
                raise ConfigurationError(
                    'is not a limit; write { at_most = "400 K" } or { at_least = ... }'
                )
            if name != PROBABILITY:
                check_outputs([name], design.setup, list(section.over))
            quantity, ends = Quantity(_unit_of(design, name)), {}
            for word, text in limits.items():
                try:
                    ends[word] = float(quantity.read(text).value)
                except ConfigurationError as error:
                    raise ConfigurationError(f"{word}: {error}") from None
            if ends.get("at_least", -math.inf) > ends.get("at_most", math.inf):
                raise ConfigurationError("at_least is above at_most: no design satisfies both")
            found += [Constraint(name, limit, _LIMITS[word]) for word, limit in ends.items()]
    return tuple(found)


def _limits_of_film(
    highest: Any, design: AbstractDesign, section: OptimiseSection, asked: Sequence[str]
) -> Iterator[Constraint]:
    """The film's limit, wherever the flyer is judged and the section names no temperature."""
    if highest is None or section.beyond_range:
        return
    judged = {_HEAT} if design.coordinate_name in section.over else set()
    judged |= {_HEAT_OF[name] for name in asked if name in _HEAT_OF}
    for name in sorted(judged - set(asked)):
        yield Constraint(name, float(highest), -1.0, of_film=True)
