"""The uncertain numbers that a calibration takes as given, and how numbers of a design are named.

The inputs are the ± of the design, those of the samples in the points' own columns, and the
calibration of the two instruments. Each has an error in its own standard uncertainties, zero as
stated.

A name is that of a number in full (``"force.c_fm"``, ``"flyer.film.tac_top"``), or its last parts
(``"film.tac_top"``, ``"tac_top"``) if only one number ends so. A name that no number has may be an
alias (:data:`ALIASES`), or stand for a number of both faces, such as ``"emittance"``.
"""

import difflib
import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from lightflyer.calibration.points import Points
from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError, ParameterWarning
from lightflyer.core.quantity import Fraction, Quantity
from lightflyer.design.design import AbstractDesign, ObjectDesign
from lightflyer.uncertainty.inputs import Change, Inputs, uncertain_inputs

ALIASES = {"diameter": ("radius", 0.5)}
"""Other names of numbers: the number's own name, and the factor to its value."""

FACES = ("top", "bottom")  # Faces, which end the names of their numbers

_FLYER_PARTS = ("flyer", "film")  # first parts of the names of numbers that describe a flyer

Fields: TypeAlias = tuple[str, ...]  # Full names of numbers of a design that have one value

PRESSURE_GAUGE, LIGHT_METER = "pressure gauge", "light meter"
"""Names of the instruments' inputs."""

INSTRUMENTS = (PRESSURE_GAUGE, LIGHT_METER)
"""Instruments whose calibration moves all points together."""

PRESSURE_ACCURACY = 0.05
"""Relative standard uncertainty of a pressure gauge where none is stated: an assumption, the
accuracy that makers state for Pirani gauges with a piezo sensor."""

IRRADIANCE_ACCURACY = 0.05
"""Relative standard uncertainty of a light meter where none is stated: an assumption, about the
accuracy that makers state for thermal power sensors."""

_PERCENT = 100.0
_LARGEST_USUAL = 0.3  # relative accuracy of such instruments
_SCATTER, _COEFFICIENTS = "force.force_error", {"force.c_fm", "force.c_cont"}
"""What the published coefficients of a force model scatter by, and those coefficients."""


class Target(NamedTuple):
    """Numbers of a design that one name stands for."""

    fields: Fields  # Full names of the numbers, which all have the same value
    factor: float  # Ratio of that value to the value under the name
    quantity: Quantity  # Unit and range under the name
    value: float | None  # Value in the design under the name, None where there is none


def target_of(design: AbstractDesign, name: str, *, describes_flyer: bool = False) -> Target:
    """Numbers of a design that a name stands for."""
    known = [
        field
        for field in design.quantities
        if not describes_flyer or field.partition(".")[0] in _FLYER_PARTS
    ]
    field = _only(known, name)
    if field is not None:
        value = design.number(field)
        if value is None:
            value = _mean(design, _faces(known, name))
        if value is None:
            # what the setup has, where a file leaves it out, such as a property of layers
            built, last = ObjectDesign(design.setup), field.rpartition(".")[2]
            alike = [one for one in built.quantities if one.rpartition(".")[2] == last]
            unit = design.quantities[field].unit
            if len(alike) == 1 and built.quantities[alike[0]].unit == unit:
                value = built.number(alike[0])
        return Target((field,), 1.0, design.quantities[field], value)
    part, dot, last = name.rpartition(".")
    if last in ALIASES:
        other, factor = ALIASES[last]
        field = _only(known, f"{part}{dot}{other}")
        if field is not None:
            value = design.number(field)
            own = None if value is None else value / factor
            kind = design.quantities[field]
            kind = replace(kind, lowest=kind.lowest / factor, highest=kind.highest / factor)
            return Target((field,), factor, kind, own)
    faces = _faces(known, name)
    if faces:
        return Target(faces, 1.0, design.quantities[faces[0]], _mean(design, faces))
    if name == design.coordinate_name:
        raise ParameterError(f"{name} is the coordinate of the points, not a number of the design")
    small = {end.lower(): end for end in (one.rpartition(".")[2] for one in design.quantities)}
    near = [small[one] for one in difflib.get_close_matches(name.lower(), sorted(small), n=1)]
    if near:
        raise ParameterError(f'{name} is not a number of the design; did you mean "{near[0]}"?')
    try:
        design.field(name)
    except ConfigurationError as error:
        raise ParameterError(str(error)) from None
    raise ParameterError(f"{name} is not a number of the flyer")


def _only(known: Iterable[str], name: str) -> str | None:
    """The number that has a name, None where none has."""
    found = [field for field in known if field == name]
    found = found or [field for field in known if field.endswith(f".{name}")]
    if len(found) > 1:
        raise ParameterError(f'"{name}" is ambiguous: {", ".join(found)}')
    return found[0] if found else None


def _faces(known: Iterable[str], name: str) -> tuple[str, ...]:
    """Numbers of both faces that a name without a face stands for; empty where there are none."""
    found = tuple(_only(known, f"{name}_{face}") for face in FACES)
    return tuple(field for field in found if field is not None) if all(found) else ()


def _mean(design: AbstractDesign, fields: tuple[str, ...]) -> float | None:
    values = [design.number(field) for field in fields]
    given = [value for value in values if value is not None]
    return math.fsum(given) / len(given) if given and len(given) == len(values) else None


@reads_units
def instruments(
    pressure_accuracy: Fraction | None, irradiance_accuracy: Fraction | None
) -> tuple[dict[str, float], tuple[str, ...]]:
    """Accuracies of the instruments, those assumed where none are stated."""
    found, assumed = {}, {}
    for name, instrument, stated, usual in (
        ("pressure_accuracy", PRESSURE_GAUGE, pressure_accuracy, PRESSURE_ACCURACY),
        ("irradiance_accuracy", LIGHT_METER, irradiance_accuracy, IRRADIANCE_ACCURACY),
    ):
        require_range(name, stated, 0.0, 1.0)
        if stated is not None and stated > _LARGEST_USUAL:
            warnings.warn(
                f"{name} = {stated:g} is {_PERCENT * stated:g} %: more than of any such "
                'instrument; per cent are written "0.5 %"',
                ParameterWarning,
                stacklevel=2,
            )
        found[instrument] = usual if stated is None else stated
        if stated is None:
            assumed[instrument] = f"± {_PERCENT * usual:g} %"
    return found, assumed_accuracies(assumed)


def assumed_accuracies(assumed: Mapping[str, str]) -> tuple[str, ...]:
    """What a reader must know of instruments whose accuracy is not stated."""
    if not assumed:
        return ()
    if len(assumed) == 1:
        ((name, value),) = assumed.items()
        return (f"no accuracy of the {name} is stated; {value} is assumed",)
    pairs = ", ".join(f"{name} {value}" for name, value in assumed.items())
    return (f"no accuracy of these is stated, and assumed: {pairs}",)


@dataclass(frozen=True)
class _Input:
    """One uncertain number: its name, its range in standard uncertainties, and what it moves."""

    name: str
    range: tuple[float, float] = (-np.inf, np.inf)
    moves: Mapping[Fields, np.ndarray] = field(default_factory=dict)
    gain: tuple[float, float] = (0.0, 0.0)  # of log-pressure and log-irradiance


@dataclass(frozen=True)
class FitInputs:
    """The uncertain numbers that are not fitted, in their standard uncertainties."""

    inputs: tuple[_Input, ...]
    correlation: np.ndarray  # shape (k, k)
    targets: dict[Fields, Target]  # Numbers of the design that only inputs move
    # Changes of a design's costly part by some of the inputs' errors, in their standard
    # uncertainties
    changes: dict[int, Change]
    # Numbers of the design whose ± has no effect here, because a column or parameter of another
    # name replaces them
    left_out: tuple[str, ...]

    @property
    def names(self) -> list[str]:
        """Names, such as ``"film.tac_top"``, ``"emittance[Ge 2 cm]"`` or ``"light meter"``."""
        return [one.name for one in self.inputs]

    @property
    def ranges(self) -> np.ndarray:
        """Possible errors in standard uncertainties, shape (k, 2)."""
        return np.array([one.range for one in self.inputs]).reshape(-1, 2)

    @property
    def gains(self) -> np.ndarray:
        """What each moves log-pressure and log-irradiance by, shape (k, 2)."""
        return np.array([one.gain for one in self.inputs]).reshape(-1, 2)

    def moves(self, rows: Sequence[Fields], points: int) -> np.ndarray:
        """What each moves numbers of the design by, shape (k, r, points)."""
        moves = np.zeros((len(self.inputs), len(rows), points))
        for number, one in enumerate(self.inputs):
            for fields, change in one.moves.items():
                moves[number, rows.index(fields)] = change
        return moves


def fit_inputs(
    points: Points,
    design: AbstractDesign,
    columns: Mapping[str, Target],
    index: Mapping[Fields, np.ndarray],
    meters: Mapping[str, float],
) -> FitInputs:
    """Find the uncertain numbers that a fit takes as given; ``index`` (n,)."""
    replaced = {target.fields for target in columns.values()}
    of_design = uncertain_inputs(design)
    own, targets, left_out = _design_inputs(design, of_design, replaced, index, len(points))
    samples = []
    for name, target in columns.items():
        spread = points.numbers.get(f"{name}_uncertainty", np.zeros(len(points)))
        for sample in dict.fromkeys(points.samples):
            here = points.of(sample) & (index[target.fields] < 0.0) & (spread > 0.0)
            if here.any():
                value, unit = points.numbers[name][here], spread[here]
                low = float(np.max((target.quantity.lowest - value) / unit))
                high = float(np.min((target.quantity.highest - value) / unit))
                moves = {target.fields: np.where(here, spread, 0.0)}
                samples.append(_Input(f"{name}[{sample}]", (low, high), moves))
    read_by = [
        _Input(name, gain=(spread, 0.0) if name == PRESSURE_GAUGE else (0.0, spread))
        for name, spread in meters.items()
        if spread > 0.0
    ]
    every = (*own, *samples, *read_by)
    # of inputs that move the design's costly part, its change by their error
    changes = {}
    if of_design is not None:
        spreads = dict(zip(of_design.names, of_design.spreads, strict=True))
        for number, one in enumerate(own):
            if one.name in of_design.changes:
                changes[number] = of_design.changes[one.name].in_unit(float(spreads[one.name]))
    # correlated as the design states it, within one sample where columns do
    keys = []
    for one in every:
        name, _, sample = one.name.partition("[")
        field_of = columns[name].fields[0] if sample and name in columns else name
        keys.append((field_of, sample))
    correlation = np.eye(len(every))
    for (first, second), coefficient in design.correlations.items():
        for row, (name, sample) in enumerate(keys):
            if name == first and (second, sample) in keys:
                column = keys.index((second, sample))
                correlation[row, column] = correlation[column, row] = coefficient
    return FitInputs(every, correlation, targets, changes, left_out)


def _design_inputs(
    design: AbstractDesign,
    inputs: Inputs | None,
    replaced: set[Fields],
    index: Mapping[Fields, np.ndarray],
    count: int,
) -> tuple[list[_Input], dict[Fields, Target], tuple[str, ...]]:
    """Inputs with a ± in the design, targets of those without a row, and names left out."""
    found: list[_Input] = []
    targets: dict[Fields, Target] = {}
    left_out: list[str] = []
    if inputs is None:
        return found, targets, ()
    grouped = [name for fields in index for name in fields]
    for name, value, spread, ends in zip(
        inputs.names, inputs.values, inputs.spreads, inputs.ranges, strict=True
    ):
        fields = (name,)
        if fields in replaced:
            continue  # the points say it
        if name == _SCATTER and _COEFFICIENTS.intersection(grouped):
            continue  # about the coefficients that are fitted anew
        low, high = (ends - value) / spread
        if name in inputs.open_names:
            found.append(_Input(name, (float(low), float(high))))
            continue
        if fields not in index:
            if name in grouped or design.conflict([name, *grouped]) is not None:
                left_out.append(name)
                continue
            targets[fields] = Target(fields, 1.0, design.quantities[name], float(value))
        free = index.get(fields, np.full(count, -1.0)) < 0.0
        if not free.any():
            continue  # it is fitted
        found.append(_Input(name, (float(low), float(high)), {fields: spread * free}))
    return found, targets, tuple(left_out)
