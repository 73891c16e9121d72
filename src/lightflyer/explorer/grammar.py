"""Which fields the page shows: from the declarations of the flyer file's sections.

A flyer, environment or force model that is declared anywhere appears here with its fields, units
and ranges. Words and examples beside the fields are those of the files that ``init`` writes: the
templates in ``data/`` explain each key once.
"""

import datetime
import re
import tomllib
import types
from contextlib import suppress
from functools import cache
from importlib import resources
from typing import Any, Literal, NamedTuple, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from lightflyer.config.flyer_file import BASES, PARTS, FlyerFile, section_at, sections_in
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.files.section import Alternative, OneOf, Section
from lightflyer.film.media.library import material_names
from lightflyer.mission.mission_file import EnsembleSection, LaunchesSection, MissionSection

_HEADER = re.compile(r"^\s*(?:# )?\[([\w.]+)\]")
_ENTRY = re.compile(r"^\s*(?:# )?(\w+) = (.+?)(?:\s{2,}# (.*))?$")
_CONTINUED = re.compile(r"^\s{12,}# (.*)$")
_PREFIX, _SUFFIX = "flyer-", ".toml"
_GUESS = "(guess) "
_FIRST = "earth"

MISSION = "mission"  # Part of a document that a mission file has beside those of a flyer file

_TITLES = {
    "flyer": "Flyer",
    "film": "Film",
    "environment": "Surroundings",
    "force": "Force model",
    "payload": "Payload's needs",
    MISSION: "Mission",
}
_MATERIAL = "material"


class Hint(NamedTuple):
    """What a template says about a key."""

    words: str  # Its comment; may be empty
    example: Any  # The value that it gives, or names in a comment


class Template(NamedTuple):
    """A file to start from."""

    name: str  # Such as ``"earth"``
    title: str  # What it describes, in words
    document: dict[str, Any]  # What it says


@cache
def templates() -> dict[str, Template]:
    """Flyer files that come with the package, and the mission, by name."""
    found = {}
    for name, text in _texts():
        # the first sentence of the first comment
        title = text.partition("\n")[0].removeprefix("# ").partition(":")[0].rstrip(".")
        found[name] = Template(name, title, tomllib.loads(text))
    return {_FIRST: found[_FIRST], **found}


@cache
def hints() -> dict[tuple[str, str], Hint]:
    """What templates say about the keys of a section, the first that has the key."""
    found: dict[tuple[str, str], Hint] = {}
    of_mission: dict[str, type[Section]] = {
        MISSION: MissionSection,
        f"{MISSION}.ensemble": EnsembleSection,
        f"{MISSION}.launches": LaunchesSection,
    }
    for _, text in _texts():
        document = tomllib.loads(text)
        words: dict[tuple[str, str], Hint] = {}
        section, last = "", None
        for line in text.splitlines():
            header, entry, more = _HEADER.match(line), _ENTRY.match(line), _CONTINUED.match(line)
            if header:
                section, last = header[1], None
            elif more and last:
                words[last] = words[last]._replace(words=f"{words[last].words} {more[1]}")
            else:
                last = None
                # where it is no value it is the beginning of a list, or words
                with suppress(tomllib.TOMLDecodeError):
                    if entry and section:
                        value = tomllib.loads(f"value = {entry[2]}")["value"]
                        last = section, entry[1]
                        words[last] = Hint((entry[3] or "").removeprefix(_GUESS), value)
        for (section, key), hint in words.items():
            if section.partition(".")[0] == MISSION:
                kind = of_mission.get(section)
            elif section.startswith("flyer."):  # a film within a flyer has words for it alone
                kind = None
            else:
                kind = section_at(section, document)
            base = None if kind is None else base_of(kind)
            for owner in filter(None, (kind, base)):
                found.setdefault((owner.__qualname__, key), hint)
    return found


def example(kind: type[Section], key: str) -> Any:
    """A value for a key of a section, from a template; None where there is none."""
    for owner in filter(None, (kind, base_of(kind))):
        if (owner.__qualname__, key) in hints():
            return hints()[owner.__qualname__, key].example
    return None


def base_of(kind: type[Section]) -> type[Alternative] | None:
    """Base of a section that is an alternative, None for any other."""
    for part in kind.__mro__:
        if Alternative in part.__bases__:
            found: type[Alternative] = part
            return found
    return None


def _texts() -> list[tuple[str, str]]:
    folder = resources.files("lightflyer") / "data"
    names = sorted(entry.name for entry in folder.iterdir())
    chosen = [name for name in names if name.startswith(_PREFIX) and name.endswith(_SUFFIX)]
    texts = [
        (name.removeprefix(_PREFIX).removesuffix(_SUFFIX), (folder / name).read_text("utf-8"))
        for name in chosen
    ]
    mission = (folder / f"{MISSION}{_SUFFIX}").read_text("utf-8")
    return [*sorted(texts, key=lambda entry: entry[0] != _FIRST), (MISSION, mission)]


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
            for name, base in ((_name_of(one), one) for one in Alternative.__subclasses__())
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
    fields: list[dict[str, Any]] = []
    for key, info in kind.model_fields.items():
        if key not in choosing:
            hint = hints().get((kind.__qualname__, key))
            fields.append({
                "name": key,
                "label": key.replace("_", " "),
                "words": info.description or (hint.words if hint else ""),
                "required": info.is_required(),
                **_kind_of(kind, key, info, sections),
            })  # fmt: skip
    sections[name] = {
        "about": (kind.__doc__ or "")
        .partition("\n")[0]
        .partition(": ")[2]
        .rstrip(".")
        .replace("``", ""),
        "fields": sorted(fields, key=lambda field: not field["required"]),
    }


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
    members, choices = _members(annotation), list[str]()
    for part in members:
        if get_origin(part) is Literal:
            choices += map(str, get_args(part))
        else:  # words that it allows, none where it allows others
            named = (one for one in get_args(part) if isinstance(one, OneOf))
            choices += next((one.registry for one in named), ())
    shown = "" if default is None or info.is_required() else str(default)
    if choices:
        return {"kind": "choice", "choices": choices, "default": shown}
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
