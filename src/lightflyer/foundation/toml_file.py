"""Reading a TOML file into sections, with one clear line for every mistake in it."""

import difflib
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import pydantic

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.section import Alternative, Section, alternative_tags
from lightflyer.foundation.text import read_text

FOLDER = "folder"
"""Key of the validation context: the folder that file names in the file are relative to."""

_File = TypeVar("_File", bound=Section)


class FileKind(NamedTuple):
    """Names that messages about a kind of file use.

    Attributes
    ----------
    name : str
        Such as ``"a flyer file"``.
    keys_of : callable
        Names that a section takes, from the section's dotted name and the file's content.
    hint : str
        What to do about an empty file.
    """

    name: str
    keys_of: Callable[[str, Any], list[str]]
    hint: str


def read_file(model: type[_File], path: Path, kind: FileKind) -> tuple[_File, str]:
    """Read and check a TOML file of another kind, with the same lines for its mistakes.

    Parameters
    ----------
    model : type
        Class of the whole file.
    path : Path
    kind : FileKind

    Returns
    -------
    file : instance of ``model``
    text : str
        Of the file, in which :func:`place_of` finds keys.

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    document, text = load(path, kind)
    return validate(model, document, text, path, kind), text


def validate(
    model: type[_File], document: dict[str, Any], text: str, path: Path, kind: FileKind
) -> _File:
    """Check the content of a TOML file.

    Parameters
    ----------
    model : type
        Class of the whole file.
    document : dict
        What the file says.
    text : str
        The file's text, in which lines are found.
    path : Path
    kind : FileKind

    Returns
    -------
    instance of ``model``

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    try:
        return model.model_validate(document, context={FOLDER: path.parent})
    except pydantic.ValidationError as error:
        lines = [_explain(mistake, document, text, path, kind) for mistake in error.errors()]
        raise ConfigurationError("\n".join(lines)) from None


def load(path: Path, kind: FileKind) -> tuple[dict[str, Any], str]:
    """Content and text of a TOML file.

    Parameters
    ----------
    path : Path
    kind : FileKind

    Returns
    -------
    document : dict
    text : str

    Raises
    ------
    ConfigurationError
        If the file cannot be read, is empty or is not TOML.
    """
    text = read_text(path)
    if not text.strip():
        raise ConfigurationError(f"{path}: is empty; {kind.hint}")
    try:
        return tomllib.loads(text), text
    except tomllib.TOMLDecodeError as error:
        raise ConfigurationError(f"{path}: is not valid TOML: {error}") from None


def _explain(mistake: Any, document: dict[str, Any], text: str, path: Path, kind: FileKind) -> str:
    """One line for one of Pydantic's errors."""
    keys = [part for part in mistake["loc"] if part not in alternative_tags()]
    keys += _choosing_key(mistake)
    dotted = ".".join(map(str, keys))
    place = place_of(keys, text, path)
    if mistake["type"] == "extra_forbidden":
        return f"{place}: {_unknown_key(dotted, document, kind)}"
    explain = _EXPLANATIONS.get(mistake["type"], _other_mistake)
    return f"{place}: {explain(mistake, dotted)}"


def _unknown_key(dotted: str, document: dict[str, Any], kind: FileKind) -> str:
    section, _, key = dotted.rpartition(".")
    known = [name for name in kind.keys_of(section, document) if name != key]  # in another kind
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.6)
    where = f"[{section}]" if section else kind.name
    owner = _owner_of(key, known)
    if owner:
        return f"{dotted} belongs to {owner}; remove it, or choose that"
    hint = f'did you mean "{near[0]}"?' if near else f"{where} takes {', '.join(known)}"
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


def _missing_key(_mistake: Any, dotted: str) -> str:
    section, _, key = dotted.rpartition(".")
    return f"[{section}] needs {key}" if section else f"the section [{key}] is missing"


def _alternatives_of(mistake: Any) -> type[Alternative]:
    """Base of the section whose alternative is unknown."""
    expected = set(re.findall("'([^']*)'", mistake["ctx"]["expected_tags"]))
    # others may have been defined since
    return next(base for base in Alternative.__subclasses__() if expected <= set(base.alternatives))


def _choosing_key(mistake: Any) -> list[str]:
    """The key whose value chose an alternative that does not exist."""
    if mistake["type"] != "union_tag_invalid":
        return []
    base, tag = _alternatives_of(mistake), mistake["ctx"]["tag"]
    values = tag.split(" ")
    wrong = (
        key
        for (key, _), value in zip(base.choosing_keys, values, strict=False)
        if value not in base.choices(key, tag)
    )
    return [next(wrong)]


def _unknown_alternative(mistake: Any, dotted: str) -> str:
    base, tag = _alternatives_of(mistake), mistake["ctx"]["tag"]
    key = dotted.rpartition(".")[2]
    found = tag.split(" ")[[name for name, _ in base.choosing_keys].index(key)]
    return f'{dotted} = "{found}" is unknown; choose from {", ".join(base.choices(key, tag))}'


def _other_mistake(mistake: Any, dotted: str) -> str:
    message = mistake["msg"].removeprefix("Value error, ")
    value = mistake["input"]
    if isinstance(value, dict):
        return f"[{dotted}]: {message}" if dotted else message
    shown = f'"{value}"' if isinstance(value, str) else str(value)
    if shown in message:
        return f"{dotted}: {message}"
    return f"{dotted} = {shown}: {message[0].lower()}{message[1:]}"


_EXPLANATIONS: dict[str, Callable[[Any, str], str]] = {
    "missing": _missing_key,
    "union_tag_invalid": _unknown_alternative,
}


def place_of(keys: list[Any], text: str, path: Path) -> str:
    """File and, where it is found, line of a key.

    Parameters
    ----------
    keys : list of str
        The key's sections, outermost first, and the key; a dotted key in its parts.
    text : str
        Of the TOML file.
    path : Path
        Of the TOML file.

    Returns
    -------
    str
        Such as ``"flyer.toml:7"``.
    """
    line = _line_of(keys, text)
    return f"{path}:{line}" if line else f"{path}"


def _line_of(keys: list[Any], text: str) -> int | None:
    """Number of the line where a key, or else its section, stands in a TOML text."""
    if not keys:
        return None
    section, section_line = [], None
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(r"\s*\[\s*([^\[\]]+?)\s*\]", line)
        if header:
            section = [part.strip().strip("\"'") for part in header[1].split(".")]
            if section == [str(key) for key in keys[: len(section)]]:
                section_line = section_line or number
                if section == keys:
                    return number
            continue
        name = line.partition("=")[0]
        path = section + [part.strip().strip("\"'") for part in name.split(".")]
        if "=" in line and path == [str(key) for key in keys[: len(path)]]:
            return number
    return section_line
