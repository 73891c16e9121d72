"""Reading a TOML file into sections, with one clear line for every mistake in it."""

import difflib
import re
import tomllib
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import pydantic

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import in_toml, read_text, shortened
from lightflyer.files.section import UNKNOWN, Alternative, Section


def format_error(mistake: Any, dotted: str) -> str:
    """One line for a mistake that is not an unknown key; key, what is wrong and what is allowed."""
    return _EXPLANATIONS.get(mistake["type"], _other_mistake)(mistake, dotted)


_MEANT = {
    "radius": ("diameter", ", twice the radius"),
    "west": ("east", " with the other sign"),
    "south": ("north", " with the other sign"),
    "down": ("up", " with the other sign"),
    "emissivity": ("emittance", ""),
    "absorptivity": ("absorptance", ""),
}
"""Known keys for what others call so, and how the value changes."""


def did_you_mean(key: str, near: str) -> str:
    """Ask for the known key that stands for another one."""
    meant, how = _MEANT.get(key, ("", ""))
    return f'did you mean "{near}"{how if near == meant else ""}?'


def nearest(key: str, known: Sequence[str]) -> str:
    """The known key that a misspelt one stands for, else empty."""
    if key in _MEANT and _MEANT[key][0] in known:
        return _MEANT[key][0]
    others = [name for name in known if name != key]  # in another kind of file
    return next(iter(difflib.get_close_matches(key, others, n=1, cutoff=0.6)), "")


def _missing_key(mistake: Any, dotted: str) -> str:
    section, _, key = dotted.rpartition(".")
    keys = mistake.get("keys", [key])
    key = " and ".join(filter(None, (", ".join(keys[:-1]), keys[-1])))
    return f"[{section}] needs {key}" if section else f"the section [{key}] is missing"


def _unknown_alternative(mistake: Any, dotted: str) -> str:
    base, tag = mistake["ctx"]["base"], mistake["ctx"]["tag"]
    key = dotted.rpartition(".")[2]
    found = tag.split(" ")[[name for name, _ in base.choosing_keys].index(key)]
    choices = base.choices(key, tag)
    near = nearest(found, choices)
    hint = f'; did you mean "{near}"?' if near else ""
    return f'{dotted} = "{found}" is unknown; choose from {", ".join(choices)}{hint}'


def _other_mistake(mistake: Any, dotted: str) -> str:
    message = mistake["msg"].removeprefix("Value error, ")
    value = mistake["input"]
    if isinstance(value, dict):
        return f"[{dotted}]: {message}" if dotted else message
    shown = in_toml(value)
    if isinstance(value, str) and shown in message:
        return f"{dotted}: {message}"
    first = message.partition(" ")[0]  # a name of a file keeps its capitals
    text = message[0].lower() + message[1:] if first == first.capitalize() else message
    return f"{dotted} = {shortened(shown)}: {text}"


def _explain_by(words: str) -> Callable[[Any, str], str]:
    """Explanation of a value, with the numbers that its limit has."""

    def format_error(mistake: Any, dotted: str) -> str:
        said = words.format(**mistake.get("ctx", {}))
        return f"{dotted} = {shortened(in_toml(mistake['input']))}: {said}"

    return format_error


def _unknown_word(mistake: Any, dotted: str) -> str:
    known = re.findall("'([^']*)'", mistake["ctx"]["expected"])
    value = mistake["input"]
    near = nearest(value, known) if isinstance(value, str) else ""
    hint = did_you_mean(value, near) if near else f"choose from {', '.join(known)}"
    return f"{dotted} = {shortened(in_toml(value))} is unknown; {hint}"


def _too_few(mistake: Any, dotted: str) -> str:
    least = mistake["ctx"]["min_length"]
    entries = "entry" if least == 1 else "entries"
    return f"{dotted} = {shortened(in_toml(mistake['input']))}: needs at least {least} {entries}"


_EXPLANATIONS: dict[str, Callable[[Any, str], str]] = {
    "missing": _missing_key,
    UNKNOWN: _unknown_alternative,
    "literal_error": _unknown_word,
    "greater_than_equal": _explain_by("must be at least {ge}"),
    "greater_than": _explain_by("must be above {gt}"),
    "less_than_equal": _explain_by("must be at most {le}"),
    "less_than": _explain_by("must be below {lt}"),
    "too_short": _too_few,
    **dict.fromkeys(("tuple_type", "list_type"), _explain_by("is not a list, such as [ ... ]")),
    **dict.fromkeys(
        ("model_type", "model_attributes_type", "dict_type", "mapping_type"),
        _explain_by("is not a section, such as [section] followed by its keys"),
    ),
    "string_type": _explain_by("is not a text in quotes"),
    **dict.fromkeys(
        ("int_type", "int_parsing", "int_from_float"), _explain_by("is not a whole number")
    ),
    **dict.fromkeys(("float_type", "float_parsing"), _explain_by("is not a number")),
    **dict.fromkeys(("bool_type", "bool_parsing"), _explain_by("is not true or false")),
    **dict.fromkeys(
        ("datetime_type", "datetime_parsing", "datetime_from_date_parsing"),
        _explain_by("is not a date, such as 2026-06-21T12:00:00"),
    ),
}


_DEEPEST = 50  # tables and lists within each other; files of ours have six

FOLDER = "folder"
"""Key of the validation context: the folder that file names in the file are relative to."""


def file_beside(name: str, info: pydantic.ValidationInfo) -> str:
    """Path of a file that is named relative to the file that names it."""
    folder = (info.context or {}).get(FOLDER)
    return str(Path(folder, name)) if folder else name


_File = TypeVar("_File", bound=Section)


class FileKind(NamedTuple):
    """Names that messages about a kind of file use."""

    name: str  # Such as ``"a flyer file"``
    # Names that a section takes, from the section's dotted name and the file's content
    keys_of: Callable[[str, Any], list[str]]
    hint: str  # What to do about an empty file
    # What a file is instead and what to do with it, from its content; empty where it may be one of
    # this kind
    mistaken_for: Callable[[dict[str, Any]], str] = lambda _: ""


def read_file(model: type[_File], path: Path, kind: FileKind) -> tuple[_File, str]:
    """Read and check a TOML file of another kind, with the same lines for its mistakes."""
    document, text = load(path, kind)
    return validate(model, document, text, path, kind), text


def validate(
    model: type[_File], document: dict[str, Any], text: str, path: Path, kind: FileKind
) -> _File:
    """Check the content of a TOML file; ``model``: class of the whole file."""
    found, mistakes = check(model, document, text, path, kind)
    if found is None:
        raise ConfigurationError("\n".join(mistakes))
    return found


def check(
    model: type[_File], document: dict[str, Any], text: str, path: Path, kind: FileKind
) -> tuple[_File | None, list[str]]:
    """What the content of a TOML file is, or None, and a line for each mistake in it."""
    other = kind.mistaken_for(document)
    if other:
        return None, [f"{path}: is {other}"]
    try:
        return model.model_validate(document, context={FOLDER: path.parent}), []
    except pydantic.ValidationError as error:
        mistakes: list[Any] = [*error.errors()]
        meant = set()  # dotted names of the keys that misspelt ones stand for
        for mistake in mistakes:
            if mistake["type"] == "extra_forbidden":
                section, _, key = ".".join(map(str, mistake["loc"])).rpartition(".")
                near = nearest(key, kind.keys_of(section, document))
                meant.add(".".join(filter(None, (section, near))))
        missing: dict[tuple[Any, ...], Any] = {}
        relevant: list[Any] = []  # missing keys of a section once, and none that is misspelt
        for mistake in mistakes:
            place = mistake["loc"]
            # a list may be short because its wrong entries, which have lines, do not count
            within = [one for one in mistakes if one["loc"][: len(place)] == place]
            if mistake["type"] == "too_short" and len(within) > 1:
                continue
            if mistake["type"] != "missing":
                relevant.append(mistake)
            elif ".".join(map(str, place)) not in meant:
                if place[:-1] and place[:-1] in missing:
                    missing[place[:-1]]["keys"].append(place[-1])
                else:
                    relevant.append({**mistake, "keys": [place[-1]]})
                    missing[place[:-1]] = relevant[-1]
        return None, [_explain(mistake, document, text, path, kind) for mistake in relevant]


def load(path: Path, kind: FileKind) -> tuple[dict[str, Any], str]:
    """Content and text of a TOML file; returns ``document``, ``text``."""
    text = read_text(path)
    return parse_toml(text, path, kind), text


def parse_toml(text: str, path: Path, kind: FileKind) -> dict[str, Any]:
    """Content of a TOML text; ``path``: that messages name."""
    if not text.strip():
        raise ConfigurationError(f"{path}: is empty; {kind.hint}")
    try:
        document = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(_not_toml(str(error), text, path)) from None
    except RecursionError:
        document = None
    level: list[Any] = [document]  # functions that call themselves follow what is nested
    for _ in range(_DEEPEST):
        within = (one.values() if isinstance(one, dict) else one for one in level if one)
        level = [part for parts in within for part in parts if isinstance(part, dict | list)]
    if document is None or level:
        raise ConfigurationError(f"{path}: lists or tables are nested too deeply")
    return document


def named_keys(message: str) -> list[str]:
    """Key with its sections that a message begins with, such as ``force.model = ...``."""
    named = _NAMED.match(message)
    return (named[1] or named[2]).split(".") if named else []


def _not_toml(said: str, text: str, path: Path) -> str:
    """One line for a mistake in the grammar: place, what is wrong, and what to write instead."""
    lines = text.splitlines()
    found = re.search(r" \(at (?:line (\d+), column \d+|end of document)\)$", said)
    number = int(found[1]) if found and found[1] else len(lines)
    what = said[: found.start()] if found else said
    what = re.sub(r"\('(.*?)',?\)", lambda match: f"[{match[1].replace(chr(39), '')}]", what)
    what = _GRAMMAR.get(what, what)
    line = lines[number - 1] if number <= len(lines) else ""
    unquoted = re.match(r"\s*([\w.]+)\s*=\s*([^\s\"'#\[{][^\"#]*?)\s*(?:#.*)?$", line)
    if unquoted and _DATE.match(unquoted[2]):
        return f"{path}:{number}: {unquoted[1]} = {unquoted[2]}: there is no such date or time"
    hint = f'; texts need quotes: {unquoted[1]} = "{unquoted[2]}"' if unquoted else ""
    if what == _TWICE:
        hint = "; remove one of the two"
        what = what.replace("a key", line.partition("=")[0].strip() or "a key")
    elif unquoted and re.match(r"[-+]?\d+,\d", unquoted[2]):
        is_number = re.fullmatch(r"[-+\d.,eE]+", unquoted[2])
        hint = "; write a point before decimals, and nothing between thousands"
        hint += "" if is_number else ", and quotes around a number with a unit"
    return f"{path}:{number}: is not valid TOML: {what[0].lower()}{what[1:]}{hint}"


_NAMED = re.compile(r"(?:Value error, )?(?:(\w+(?:\.\w+)*) = |\[(\w+(?:\.\w+)*)\])")
_DATE = re.compile(r"\d{4}-\d{2}-\d{2}(?!\d)|\d{2}:\d{2}(?!\d)")
_TWICE = "a key is given twice"
_GRAMMAR = {
    "Cannot overwrite a value": _TWICE,
    "Illegal character '\\n'": "a text is not closed by quotes",
}


def _explain(mistake: Any, document: dict[str, Any], text: str, path: Path, kind: FileKind) -> str:
    """One line for one of Pydantic's errors."""
    keys = [*mistake["loc"]]
    if mistake["type"] == UNKNOWN:  # the key whose value chose an alternative that does not exist
        base, tag = mistake["ctx"]["base"], mistake["ctx"]["tag"]
        pairs = zip(base.choosing_keys, tag.split(" "), strict=False)
        keys.append(next(k for (k, _), value in pairs if value not in base.choices(k, tag)))
    keys = keys or named_keys(mistake["msg"])
    dotted = ".".join(map(str, keys))
    place = place_of(keys, text, path)
    if mistake["type"] != "extra_forbidden":
        return f"{place}: {format_error(mistake, dotted)}"
    section, _, key = dotted.rpartition(".")
    known = [name for name in kind.keys_of(section, document) if name != key]
    owner = _owner_of(key, known)
    if owner:
        return f"{place}: {dotted} belongs to {owner}; remove it, or choose that"
    near, where = nearest(key, known), f"[{section}]" if section else kind.name
    hint = did_you_mean(key, near) if near else f"{where} takes {', '.join(known)}"
    return f"{place}: {dotted} is not a key of {where}; {hint}"


def _owner_of(key: str, known: list[str]) -> str:
    """The choice in a file of which a key is, where another one was made; else empty."""
    for base in Alternative.__subclasses__():
        kinds = [set(kind.model_fields) for kind in base.alternatives.values()]
        owners = [tag for tag, kind in base.alternatives.items() if key in kind.model_fields]
        if owners and any(set(known) <= fields for fields in kinds):
            names = [name for name, _ in base.choosing_keys]
            first = {tag.split(" ")[0] for tag in owners}
            chosen = owners[0].split(" ") if len(owners) == 1 else sorted(first)[:1]
            pairs = zip(names, chosen, strict=False)
            return ", ".join(f'{name} = "{value}"' for name, value in pairs)
    return ""


def place_of(keys: list[Any], text: str, path: Path) -> str:
    """File and, where it is found, line of a key, or else its section; ``text``: of the file."""
    keys = [str(key) for key in keys]
    section, section_place = [], f"{path}"
    entries: Counter[str] = Counter()  # of arrays of tables, so far
    for number, line in enumerate(text.splitlines() if keys else (), start=1):
        header = re.match(r"\s*(\[\[?)\s*([^\[\]]+?)\s*\]", line)
        if header:
            section = [part.strip().strip("\"'") for part in header[2].split(".")]
            if header[1] == "[[":
                section.append(str(entries[header[2]]))
                entries[header[2]] += 1
            if section == keys:
                return f"{path}:{number}"
            if section == keys[: len(section)] and section_place == f"{path}":
                section_place = f"{path}:{number}"
            continue
        name = line.partition("=")[0]
        named = section + [part.strip().strip("\"'") for part in name.split(".")]
        if "=" in line and named == keys[: len(named)]:
            return f"{path}:{number}"
    return section_place
