"""Reading a TOML file into sections, with one clear line for every mistake in it."""

import re
import tomllib
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import pydantic

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import read_text
from lightflyer.files.section import Alternative, Section
from lightflyer.files.validation_messages import choosing_key, did_you_mean, format_error, nearest

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
        meant = set(filter(None, (_intended_key(mistake, document, kind) for mistake in mistakes)))
        missing: dict[tuple[Any, ...], Any] = {}
        relevant: list[Any] = []  # missing keys of a section once, and none that is misspelt
        for mistake in mistakes:
            if mistake["type"] == "too_short" and _has_wrong_entries(mistake, mistakes):
                continue
            if mistake["type"] != "missing":
                relevant.append(mistake)
            elif _dotted_name(mistake) not in meant:
                *section, key = mistake["loc"]
                if section and tuple(section) in missing:
                    missing[tuple(section)]["keys"].append(key)
                else:
                    relevant.append({**mistake, "keys": [key]})
                    missing[tuple(section)] = relevant[-1]
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
    if document is None or not _is_flat_enough(document):
        raise ConfigurationError(f"{path}: lists or tables are nested too deeply")
    return document


def _is_flat_enough(document: dict[str, Any]) -> bool:
    """Whether what is nested can be followed by functions that call themselves."""
    level: list[Any] = [document]
    for _ in range(_DEEPEST):
        within = (one.values() if isinstance(one, dict) else one for one in level)
        level = [part for parts in within for part in parts if isinstance(part, dict | list)]
        if not level:
            return True
    return False


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


def _has_wrong_entries(short: Any, mistakes: Sequence[Any]) -> bool:
    """Whether a list is short because its wrong entries, which have lines, do not count."""
    place = short["loc"]
    return any(other["loc"][: len(place)] == place and other is not short for other in mistakes)


def _dotted_name(mistake: Any) -> str:
    """Dotted name of the key that a mistake is about."""
    return ".".join(map(str, mistake["loc"]))


def _intended_key(mistake: Any, document: dict[str, Any], kind: FileKind) -> str:
    """Dotted name of the key that a misspelt one stands for, else empty."""
    if mistake["type"] != "extra_forbidden":
        return ""
    section, _, key = _dotted_name(mistake).rpartition(".")
    near = nearest(key, kind.keys_of(section, document))
    return ".".join(filter(None, (section, near)))


def _explain(mistake: Any, document: dict[str, Any], text: str, path: Path, kind: FileKind) -> str:
    """One line for one of Pydantic's errors."""
    keys = [*mistake["loc"], *choosing_key(mistake)]
    keys = keys or named_keys(mistake["msg"])
    dotted = ".".join(map(str, keys))
    place = place_of(keys, text, path)
    if mistake["type"] == "extra_forbidden":
        return f"{place}: {_unknown_key(dotted, document, kind)}"
    return f"{place}: {format_error(mistake, dotted)}"


def _unknown_key(dotted: str, document: dict[str, Any], kind: FileKind) -> str:
    section, _, key = dotted.rpartition(".")
    known = [name for name in kind.keys_of(section, document) if name != key]
    near = nearest(key, known)
    where = f"[{section}]" if section else kind.name
    owner = _owner_of(key, known)
    if owner:
        return f"{dotted} belongs to {owner}; remove it, or choose that"
    hint = did_you_mean(key, near) if near else f"{where} takes {', '.join(known)}"
    return f"{dotted} is not a key of {where}; {hint}"


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
    """File and, where it is found, line of a key; ``text``: of the TOML file."""
    line = _line_of(keys, text)
    return f"{path}:{line}" if line else f"{path}"


def _line_of(keys: list[Any], text: str) -> int | None:
    """Number of the line where a key, or else its section, stands in a TOML text."""
    if not keys:
        return None
    keys = [str(key) for key in keys]
    section, section_line = [], None
    entries: Counter[str] = Counter()  # of arrays of tables, so far
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(r"\s*(\[\[?)\s*([^\[\]]+?)\s*\]", line)
        if header:
            section = [part.strip().strip("\"'") for part in header[2].split(".")]
            if header[1] == "[[":
                section.append(str(entries[header[2]]))
                entries[header[2]] += 1
            if section == keys[: len(section)]:
                section_line = section_line or number
                if section == keys:
                    return number
            continue
        name = line.partition("=")[0]
        path = section + [part.strip().strip("\"'") for part in name.split(".")]
        if "=" in line and path == keys[: len(path)]:
            return number
    return section_line
