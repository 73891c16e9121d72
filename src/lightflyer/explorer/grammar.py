"""Which fields the page shows: from the declarations of the flyer file's sections.

A flyer, environment or force model that is declared anywhere appears here with its fields, units
and ranges.
"""

import datetime
import types
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from lightflyer.config.flyer_file import PARTS, FlyerFile, sections_in
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.environment.section import EnvironmentSection
from lightflyer.explorer.hints import base_of, hints
from lightflyer.files.section import Alternative, OneOf, Section
from lightflyer.film.media.library import material_names
from lightflyer.film.section import FilmSection
from lightflyer.flyer.section import FlyerSection
from lightflyer.force.section import ForceSection
from lightflyer.mission.mission_file import MissionSection

MISSION = "mission"  # Part of a document that a mission file has beside those of a flyer file

BASES: dict[str, type[Alternative]] = {
    "flyer": FlyerSection,
    "film": FilmSection,
    "environment": EnvironmentSection,
    "force": ForceSection,
}
"""Parts of a flyer file that have alternatives."""

_TITLES = {
    "flyer": "Flyer",
    "film": "Film",
    "environment": "Surroundings",
    "force": "Force model",
    "payload": "Payload's needs",
    MISSION: "Mission",
}
_MATERIAL = "material"


def grammar() -> dict[str, Any]:
    """All sections that a document may have, and their fields."""
    sections: dict[str, Any] = {}
    parts = [
        {"name": name, "title": _TITLES[name], **_reference(kinds_of_part(name), sections)}
        for name in (*PARTS, MISSION)
    ]
    return {
        "parts": parts,
        "bases": {
            name: {tag: _name_of(kind) for tag, kind in base.alternatives.items()}
            for name, base in _bases().items()
        },
        "sections": sections,
        "materials": sorted(material_names()),
    }


def quantity_text(value: Measured, quantity: Quantity) -> str:
    """A number as a flyer file writes it, in SI units; with all digits."""
    spread = "" if value.uncertainty is None else f" ± {_shortest(value.uncertainty)}"
    return f"{_shortest(value.value)}{spread} {quantity.unit}".rstrip()


def _shortest(number: float) -> str:
    return repr(float(number)).removesuffix(".0")


def _bases() -> dict[str, type[Alternative]]:
    return {_name_of(base): base for base in Alternative.__subclasses__()}


def _name_of(kind: type) -> str:
    return f"{kind.__module__}.{kind.__qualname__}"


def kinds_of_part(name: str) -> list[type[Section]]:
    """Classes of sections that a part of a document may be."""
    if name in BASES:
        return list(BASES[name].alternatives.values())
    if name == MISSION:
        return [MissionSection]
    return sections_in(FlyerFile.model_fields[name].annotation)


def _reference(kinds: list[type[Section]], sections: dict[str, Any]) -> dict[str, str]:
    """How a field names its section: by itself, or by the base of its alternatives."""
    base = base_of(kinds[0])
    known = kinds if base is None else list(base.alternatives.values())
    for kind in known:
        _describe(kind, sections)
    return {"section": _name_of(kinds[0])} if base is None else {"base": _name_of(base)}


def _describe(kind: type[Section], sections: dict[str, Any]) -> None:
    name = _name_of(kind)
    if name in sections:
        return
    sections[name] = {}  # so that a section within itself ends here
    base = base_of(kind)
    choosing = [] if base is None else [key for key, _ in base.choosing_keys]
    fields = [
        _field(kind, key, info, sections)
        for key, info in kind.model_fields.items()
        if key not in choosing
    ]
    sections[name] = {
        "about": (kind.__doc__ or "")
        .partition("\n")[0]
        .partition(": ")[2]
        .rstrip(".")
        .replace("``", ""),
        "fields": sorted(fields, key=lambda field: not field["required"]),
    }


def _field(
    kind: type[Section], key: str, info: FieldInfo, sections: dict[str, Any]
) -> dict[str, Any]:
    hint = hints().get((kind.__qualname__, key))
    described: dict[str, Any] = {
        "name": key,
        "label": key.replace("_", " "),
        "words": info.description or (hint.words if hint else ""),
        "required": info.is_required(),
    }
    return described | _kind_of(kind, key, info, sections)


def _kind_of(
    owner: type[Section], key: str, info: FieldInfo, sections: dict[str, Any]
) -> dict[str, Any]:
    annotation, default = info.annotation, info.get_default()
    quantity = owner.quantity(key)
    if quantity is not None:
        given = quantity_text(default, quantity) if isinstance(default, Measured) else ""
        return {
            "kind": "number",
            "unit": quantity.unit,
            "range": quantity.allowed,
            "default": given,
        }
    kinds = sections_in(annotation)
    if kinds:
        many = any(get_origin(part) is tuple for part in (annotation, *get_args(annotation)))
        return {"kind": "list" if many else "section", **_reference(kinds, sections)}
    choices = [choice for part in _members(annotation) for choice in _literals(part)]
    shown = "" if default is None or info.is_required() else str(default)
    if choices:
        return {"kind": "choice", "choices": choices, "default": shown}
    members = _members(annotation)
    if bool in members:
        return {"kind": "choice", "choices": ["true", "false"], "default": shown.lower()}
    if datetime.datetime in members:
        return {"kind": "date", "default": shown}
    suggested = _MATERIAL if key == _MATERIAL else ""
    return {"kind": "text", "default": shown, "suggested": suggested}


def _members(annotation: Any) -> tuple[Any, ...]:
    """Types of a union, or the one type."""
    if get_origin(annotation) in (Union, types.UnionType):
        return tuple(part for part in get_args(annotation) if part is not types.NoneType)
    return (annotation,)


def _literals(annotation: Any) -> tuple[str, ...]:
    """Words that a type allows, empty where it allows others."""
    if get_origin(annotation) is Literal:
        return tuple(map(str, get_args(annotation)))
    named = (part for part in get_args(annotation) if isinstance(part, OneOf))
    return next((tuple(one.registry) for one in named), ())
