"""What an optimisation asks: objectives, free fields, constraints, and what is uncertain."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.config.sections import FlyerFile
from lightflyer.flight.fields import Field, dataset_unit, field, shape_film
from lightflyer.flight.outputs import OUTPUTS, check_outputs
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import Quantity
from lightflyer.sweeps.axes import Axis, Distribution, draw, read_ends, read_entry
from lightflyer.sweeps.sections import OptimiseSection, SamplingSection
from lightflyer.sweeps.study import Source, located, read_study

PROBABILITY = "probability_of_flying"
"""Share of the samples in which a design carries its weight: an objective or a constraint."""

_MARGIN = "lift_over_weight"
_BOUNDS = ("from", "to", "scale")
_LIMITS = ("at_least", "at_most")


@dataclass(frozen=True)
class Bounds:
    """A field that is free between two ends.

    Attributes
    ----------
    field : Field
    low, high : float
        In the unit of the field.
    logarithmic : bool
        Whether the search goes by the logarithm.
    """

    field: Field
    low: float
    high: float
    logarithmic: bool

    def value(self, way: Any) -> Any:
        """Value at a way from the low end (0) to the high one (1); may be traced."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** way
        return self.low + way * (self.high - self.low)

    def way(self, value: float) -> float:
        """Inverse of :meth:`value`."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Objective:
    """An output that is wanted large or small."""

    name: str
    sign: float

    @property
    def word(self) -> str:
        """``"maximise"`` or ``"minimise"``."""
        return "maximise" if self.sign > 0.0 else "minimise"


@dataclass(frozen=True)
class Constraint:
    """An output that must not be above, or below, a limit.

    Attributes
    ----------
    name : str
        Of the output.
    limit : float
        In SI units.
    sign : float
        1 for "at least", -1 for "at most".
    """

    name: str
    limit: float
    sign: float

    @property
    def scale(self) -> float:
        """Size of the limit, by which a violation is measured."""
        return abs(self.limit) or 1.0


@dataclass(frozen=True, eq=False)
class Problem:
    """An optimisation.

    Attributes
    ----------
    configuration : FlyerFile
    objectives : tuple of Objective
    bounds : tuple of Bounds
        The free fields.
    fixed : dict of str to float
        Fields that have one value, by dotted name.
    constraints : tuple of Constraint
    samples : dict of str to array, shape (m,)
        Values of the uncertain fields; empty where nothing is uncertain.
    quantile : float or None
        Which quantile of the samples stands for an output; None for the mean.
    fields : dict of str to Field
    starts, seed : int
    """

    configuration: FlyerFile
    objectives: tuple[Objective, ...]
    bounds: tuple[Bounds, ...]
    fixed: dict[str, float]
    constraints: tuple[Constraint, ...]
    samples: dict[str, np.ndarray]
    quantile: float | None
    fields: dict[str, Field]
    starts: int
    seed: int

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
    study, configuration, source = read_study(path)
    if study.optimise is None:
        raise ConfigurationError(
            f'{path}: needs a section [optimise] with maximise = "relative_payload" and '
            "[optimise.over] with the free fields"
        )
    return make_problem(configuration, study.optimise, study.sampling, source)


def make_problem(
    configuration: FlyerFile,
    section: OptimiseSection,
    sampling: SamplingSection | None = None,
    source: Source | None = None,
) -> Problem:
    """Look up what an optimisation names, check it, and draw its samples.

    Parameters
    ----------
    configuration : FlyerFile
    section : OptimiseSection
    sampling : SamplingSection, optional
    source : Source, optional
        Names file and line in errors.

    Returns
    -------
    Problem

    Raises
    ------
    ConfigurationError
        Naming the key and what is wrong with it.
    """
    bounds, fixed, distributions, fields = _read_over(configuration, section, source)
    _refuse_layers(configuration, list(section.over), source)
    objectives = tuple(
        Objective(name, sign)
        for names, sign in ((section.maximise, 1.0), (section.minimise, -1.0))
        for name in names
    )
    if not objectives:
        raise located(source, ["optimise"], ": needs maximise or minimise, an output's name")
    given = list(section.over)
    for objective in objectives:
        if objective.name != PROBABILITY:
            key = ["optimise", objective.word]
            _check_output(configuration, objective.name, given, key, source)
    uncertain = section.uncertainty
    if uncertain is not None and not distributions:
        distributions = stated_distributions(configuration, given)
        _refuse_layers(configuration, [part.field.name for part in distributions], source)
        fields |= {part.field.name: part.field for part in distributions}
    if uncertain is not None and not distributions:
        raise located(
            source,
            ["optimise", "uncertainty"],
            ': nothing is uncertain; write "0.80 ± 0.01" in the flyer file or in [optimise.over]',
        )
    constraints = tuple(
        _constraint(configuration, name, limit, given, source)
        for name, limits in section.constraints.items()
        for limit in _limits(name, limits, source)
    )
    sampling = sampling or SamplingSection()
    how = (sampling.method, sampling.seed, configuration.film.tac_correlation.value)
    problem = Problem(
        configuration=configuration,
        objectives=objectives,
        bounds=bounds,
        fixed=fixed,
        constraints=constraints,
        samples=draw(distributions, sampling.points, *how) if distributions else {},
        quantile=uncertain.quantile if uncertain and uncertain.of == "quantile" else None,
        fields=fields,
        starts=section.starts,
        seed=section.seed,
    )
    if PROBABILITY in problem.asked and not problem.samples:
        raise located(source, ["optimise"], f": {PROBABILITY} needs [optimise.uncertainty]")
    return problem


def _read_over(
    configuration: FlyerFile, section: OptimiseSection, source: Source | None
) -> tuple[tuple[Bounds, ...], dict[str, float], list[Distribution], dict[str, Field]]:
    bounds: list[Bounds] = []
    fixed: dict[str, float] = {}
    distributions: list[Distribution] = []
    fields: dict[str, Field] = {}
    for name, entry in section.over.items():
        try:
            fields[name] = field(configuration, name)
        except ConfigurationError as error:
            message = str(error).removeprefix(name)
            raise located(source, ["optimise", "over", name], message) from None
        try:
            found = _read_free(entry, fields[name])
        except ConfigurationError as error:
            raise located(source, ["optimise", "over", name], f": {error}") from None
        if isinstance(found, Bounds):
            bounds.append(found)
        elif isinstance(found, Distribution):
            distributions.append(found)
        else:
            fixed[name] = float(found.values[0])
    if not bounds:
        raise located(
            source,
            ["optimise"],
            ': needs [optimise.over] with a line such as "flyer.diameter" = '
            '{ from = "0.5 cm", to = "5 cm" }',
        )
    return tuple(bounds), fixed, distributions, fields


def _refuse_layers(configuration: FlyerFile, names: list[str], source: Source | None) -> None:
    """Raise where the optics of a film of layers would have to be computed at every step."""
    for name in shape_film(configuration, names):
        raise located(
            source,
            ["optimise", "over", name],
            " changes the optics of the layers, which no step of the search can afford; give it "
            "one value in the flyer file, or sweep it",
        )


def _read_free(entry: Any, known: Field) -> Bounds | Axis | Distribution:
    if isinstance(entry, Mapping) and "distribution" not in entry:
        low, high, logarithmic = read_ends(entry, known, _BOUNDS)
        return Bounds(known, low, high, logarithmic)
    found = read_entry(entry, known)
    if isinstance(found, Axis) and not found.single:
        raise ConfigurationError('is a list; a free field is { from = "...", to = "..." }')
    return found


def stated_distributions(configuration: FlyerFile, given: Sequence[str]) -> list[Distribution]:
    """The flyer file's own uncertainties, as normal distributions.

    Parameters
    ----------
    configuration : FlyerFile
    given : sequence of str
        Fields that have values already, by dotted name.

    Returns
    -------
    list of Distribution
        Of all other fields that have a ± and can be varied.
    """
    found = []
    for name, spread in configuration.uncertainties().items():
        if name not in given and spread > 0.0:
            try:
                known = field(configuration, name)
            except ConfigurationError:
                continue  # it cannot be varied, and nothing depends on it
            found.append(Distribution(known, "normal", number(configuration, name), spread))
    return found


def number(configuration: FlyerFile, name: str) -> float:
    """A number of a flyer file by its dotted name."""
    part: Any = configuration
    for key in name.split("."):
        part = part[int(key)] if key.isdigit() else getattr(part, key)
    return float(part.value)


def _check_output(
    configuration: FlyerFile,
    name: str,
    given: Sequence[str],
    keys: list[str],
    source: Source | None,
) -> None:
    try:
        check_outputs([name], configuration, given)
    except ConfigurationError as error:
        raise located(source, keys, f": {error}") from None


def _limits(name: str, limits: Any, source: Source | None) -> list[tuple[str, Any]]:
    known = isinstance(limits, Mapping) and limits and all(key in _LIMITS for key in limits)
    if not known:
        message = ' is not such as { at_most = "400 K" } or { at_least = ... }'
        raise located(source, ["optimise", "constraints", name], message)
    return list(limits.items())


def _constraint(
    configuration: FlyerFile,
    name: str,
    limit: tuple[str, Any],
    given: Sequence[str],
    source: Source | None,
) -> Constraint:
    keys = ["optimise", "constraints", name]
    if name != PROBABILITY:
        _check_output(configuration, name, given, keys, source)
    unit = "" if name == PROBABILITY else dataset_unit(OUTPUTS[name].units)
    word, text = limit
    try:
        value = Quantity(unit).read(text).value
    except ConfigurationError as error:
        raise located(source, keys, f": {word}: {error}") from None
    return Constraint(name, value, 1.0 if word == "at_least" else -1.0)
