"""Reading a flyer file, with one clear line for every mistake in it."""

import difflib
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import pydantic

from lightflyer.config.sections import FlyerFile, alternative_tags, known_keys
from lightflyer.film.layered_section import FOLDER, LayeredFilmSection
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import Section
from lightflyer.foundation.text import read_text


def read_flyer_file(path: str | Path) -> FlyerFile:
    """Read and check a flyer file.

    Parameters
    ----------
    path : str or path
        A TOML file; ``lightflyer init`` writes a commented one.

    Returns
    -------
    FlyerFile

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    document, text = _load(Path(path))
    return _validate(FlyerFile, document, text, Path(path))


def read_film_file(path: str | Path) -> LayeredFilmSection:
    """Read the layers of a film.

    Parameters
    ----------
    path : str or path
        A TOML file with a section ``[film]`` that has ``layers``; a flyer file will do, its
        other sections play no part.

    Returns
    -------
    LayeredFilmSection

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    path = Path(path)
    document, text = _load(path)
    film = document.get("film")
    if not isinstance(film, dict) or "layers" not in film:
        example = '{material = "Ge", thickness = "20 nm"}'
        raise ConfigurationError(f"{path}: needs a section [film] with layers = [{example}, ...]")
    return _validate(_FilmFile, {"film": film}, text, path).film


class _FilmFile(Section):
    film: LayeredFilmSection


_File = TypeVar("_File", bound=Section)


class FileKind(NamedTuple):
    """What messages about a kind of file need to know.

    Attributes
    ----------
    name : str
        Such as ``"a flyer file"``.
    keys_of : callable
        Names that a section takes, by the section's name and content.
    hint : str
        What to do about an empty file.
    """

    name: str
    keys_of: Callable[[str, Any], list[str]]
    hint: str


_FLYER_FILE = FileKind("a flyer file", known_keys, "'lightflyer init' writes an example")


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
    document, text = _load(path, kind)
    return _validate(model, document, text, path, kind), text


def _validate(
    model: type[_File],
    document: dict[str, Any],
    text: str,
    path: Path,
    kind: FileKind = _FLYER_FILE,
) -> _File:
    try:
        return model.model_validate(document, context={FOLDER: path.parent})
    except pydantic.ValidationError as error:
        lines = [_explain(mistake, document, text, path, kind) for mistake in error.errors()]
        raise ConfigurationError("\n".join(lines)) from None


def _load(path: Path, kind: FileKind = _FLYER_FILE) -> tuple[dict[str, Any], str]:
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
    keys += _deciding_key(mistake)
    dotted = ".".join(map(str, keys))
    place = place_of(keys, text, path)
    if mistake["type"] == "extra_forbidden":
        return f"{place}: {_unknown_key(dotted, document, kind)}"
    explain = _EXPLANATIONS.get(mistake["type"], _other_mistake)
    return f"{place}: {explain(mistake, dotted, document)}"


def _unknown_key(dotted: str, document: dict[str, Any], kind: FileKind) -> str:
    section, _, key = dotted.rpartition(".")
    known = kind.keys_of(section, document.get(section))
    near = difflib.get_close_matches(key, known, n=1, cutoff=0.6)
    where = f"[{section}]" if section else kind.name
    hint = f'did you mean "{near[0]}"?' if near else f"{where} takes {', '.join(known)}"
    return f"{dotted} is not a key of {where}; {hint}"


def _missing_key(_mistake: Any, dotted: str, _document: dict[str, Any]) -> str:
    section, _, key = dotted.rpartition(".")
    return f"[{section}] needs {key}" if section else f"the section [{key}] is missing"


def _unknown_alternative(mistake: Any, dotted: str, _document: dict[str, Any]) -> str:
    # a tag is a kind, or a kind and what further divides it
    *first, found = mistake["ctx"]["tag"].split(" ", 1)
    tags = mistake["ctx"]["expected_tags"].replace("'", "").split(", ")
    if first:
        known = [tag.removeprefix(f"{first[0]} ") for tag in tags if tag.startswith(first[0])]
    else:
        known = list(dict.fromkeys(tag.split(" ")[0] for tag in tags))
    return f'{dotted} = "{found}" is unknown; there are: {", ".join(known)}'


def _deciding_key(mistake: Any) -> list[str]:
    """The key whose value chose an alternative that does not exist."""
    if mistake["type"] != "union_tag_invalid":
        return []
    divided = " " in mistake["ctx"]["tag"]
    return {"force": ["model"], "environment": ["atmosphere" if divided else "kind"]}[
        mistake["loc"][0]
    ]


def _other_mistake(mistake: Any, dotted: str, _document: dict[str, Any]) -> str:
    message = mistake["msg"].removeprefix("Value error, ")
    value = mistake["input"]
    if isinstance(value, dict):
        return f"[{dotted}]: {message}" if dotted else message
    shown = f'"{value}"' if isinstance(value, str) else str(value)
    if shown in message:
        return f"{dotted}: {message}"
    return f"{dotted} = {shown}: {message[0].lower()}{message[1:]}"


_EXPLANATIONS: dict[str, Callable[[Any, str, dict[str, Any]], str]] = {
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
