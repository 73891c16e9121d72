"""Numbers of a design that a column of points, or a parameter to fit, stands for.

A name is that of a number in full (``"force.c_fm"``, ``"flyer.film.tac_top"``), or its last parts
(``"film.tac_top"``, ``"tac_top"``) if only one number ends so. A name that no number has may be an
alias (:data:`ALIASES`), or stand for a number of both faces, such as ``"emittance"``.
"""

import difflib
import math
from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple, TypeAlias

from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.design.design import AbstractDesign, ObjectDesign

ALIASES = {"diameter": ("radius", 0.5)}
"""Other names of numbers: the number's own name, and the factor to its value."""

FACES = ("top", "bottom")  # Faces, which end the names of their numbers

_FLYER_PARTS = ("flyer", "film")  # first parts of the names of numbers that describe a flyer


Fields: TypeAlias = tuple[str, ...]  # Full names of numbers of a design that have one value


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
            value = _compute(design, field)
        return Target((field,), 1.0, design.quantities[field], value)
    part, dot, last = name.rpartition(".")
    if last in ALIASES:
        other, factor = ALIASES[last]
        field = _only(known, f"{part}{dot}{other}")
        if field is not None:
            value = design.number(field)
            own = None if value is None else value / factor
            return Target((field,), factor, _scale(design.quantities[field], factor), own)
    faces = _faces(known, name)
    if faces:
        return Target(faces, 1.0, design.quantities[faces[0]], _mean(design, faces))
    raise ParameterError(_why_unknown(design, name))


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


def _scale(quantity: Quantity, factor: float) -> Quantity:
    return replace(quantity, lowest=quantity.lowest / factor, highest=quantity.highest / factor)


def _mean(design: AbstractDesign, fields: tuple[str, ...]) -> float | None:
    values = [design.number(field) for field in fields]
    given = [value for value in values if value is not None]
    return math.fsum(given) / len(given) if given and len(given) == len(values) else None


def _compute(design: AbstractDesign, field: str) -> float | None:
    """Value in the setup of a number that a file leaves out, such as a property of layers."""
    built, last = ObjectDesign(design.setup), field.rpartition(".")[2]
    found = [name for name in built.quantities if name.rpartition(".")[2] == last]
    if len(found) != 1 or built.quantities[found[0]].unit != design.quantities[field].unit:
        return None
    return built.number(found[0])


def _why_unknown(design: AbstractDesign, name: str) -> str:
    if name == design.coordinate_name:
        return f"{name} is the coordinate of the points, not a number of the design"
    ends = {field.rpartition(".")[2] for field in design.quantities}
    small = {end.lower(): end for end in ends}
    near = [small[one] for one in difflib.get_close_matches(name.lower(), sorted(small), n=1)]
    if near:
        return f'{name} is not a number of the design; did you mean "{near[0]}"?'
    try:
        design.field(name)
    except ConfigurationError as error:
        return str(error)
    return f"{name} is not a number of the flyer"
