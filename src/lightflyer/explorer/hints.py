"""Words and examples for the keys of flyer files: those of the files that ``init`` writes.

The templates in ``data/`` explain each key once. The explorer shows the same words beside its
fields, and takes the same values where a key needs one.
"""

import re
import tomllib
from functools import cache
from importlib import resources
from typing import Any, NamedTuple

from lightflyer.config.flyer_file import section_at
from lightflyer.files.section import Alternative, Section
from lightflyer.mission.mission_file import EnsembleSection, LaunchesSection, MissionSection

_HEADER = re.compile(r"^\s*(?:# )?\[([\w.]+)\]")
_ENTRY = re.compile(r"^\s*(?:# )?(\w+) = (.+?)(?:\s{2,}# (.*))?$")
_CONTINUED = re.compile(r"^\s{12,}# (.*)$")
_PREFIX, _SUFFIX = "flyer-", ".toml"
_GUESS = "(guess) "
_FIRST = "earth"
_MISSION = "mission"


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
    found = {name: Template(name, _title(text), tomllib.loads(text)) for name, text in _texts()}
    return {_FIRST: found[_FIRST], **found}


@cache
def hints() -> dict[tuple[str, str], Hint]:
    """What templates say about the keys of a section, the first that has the key."""
    found: dict[tuple[str, str], Hint] = {}
    for _, text in _texts():
        document = tomllib.loads(text)
        for (section, key), hint in _hints_of(text).items():
            kind = _section_of(section, document)
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


def _section_of(section: str, document: dict[str, Any]) -> type[Section] | None:
    """Class of a section; a film within a flyer has words for that flyer alone."""
    if section.partition(".")[0] == _MISSION:
        kinds: dict[str, type[Section]] = {
            _MISSION: MissionSection,
            f"{_MISSION}.ensemble": EnsembleSection,
            f"{_MISSION}.launches": LaunchesSection,
        }
        return kinds.get(section)
    return None if section.startswith("flyer.") else section_at(section, document)


def _texts() -> list[tuple[str, str]]:
    folder = resources.files("lightflyer") / "data"
    names = sorted(entry.name for entry in folder.iterdir())
    chosen = [name for name in names if name.startswith(_PREFIX) and name.endswith(_SUFFIX)]
    texts = [
        (name.removeprefix(_PREFIX).removesuffix(_SUFFIX), (folder / name).read_text("utf-8"))
        for name in chosen
    ]
    mission = (folder / f"{_MISSION}{_SUFFIX}").read_text("utf-8")
    return [*sorted(texts, key=lambda entry: entry[0] != _FIRST), (_MISSION, mission)]


def _title(text: str) -> str:
    """First sentence of a template's first comment."""
    return text.partition("\n")[0].removeprefix("# ").partition(":")[0].rstrip(".")


def _hints_of(text: str) -> dict[tuple[str, str], Hint]:
    found: dict[tuple[str, str], Hint] = {}
    section, last = "", None
    for line in text.splitlines():
        header, entry, more = _HEADER.match(line), _ENTRY.match(line), _CONTINUED.match(line)
        if header:
            section, last = header[1], None
        elif more and last:
            found[last] = found[last]._replace(words=f"{found[last].words} {more[1]}")
        elif entry and section:
            example = _example(entry[2])
            last = None if example is None else (section, entry[1])
            if last:
                found[last] = Hint((entry[3] or "").removeprefix(_GUESS), example)
        else:
            last = None
    return found


def _example(value: str) -> Any:
    try:
        return tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return None  # the beginning of a list, or words
