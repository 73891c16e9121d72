"""What the page holds: a document, which is a flyer file, and its forms as URL and as TOML.

Everything that a page sends passes through the parser of flyer files, with its messages. Python's
warnings about a design are gathered for the request in whose thread they are given: a library
warns a whole process.
"""

import datetime
import json
import re
import threading
import tomllib
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any
from urllib.parse import parse_qsl, urlencode

from lightflyer.config.flyer_file import PARTS, FileDesign, section_at
from lightflyer.config.reader import FLYER_FILE, design_of_text
from lightflyer.core.errors import ConfigurationError, ParameterWarning
from lightflyer.core.extras import extra
from lightflyer.core.text import read_text
from lightflyer.explorer.grammar import MISSION, templates
from lightflyer.files.section import Alternative
from lightflyer.files.toml_file import parse_toml
from lightflyer.mission.mission_file import MissionFile, mission_of_text

Document = dict[str, Any]
"""Content of a flyer file, with numbers as the user wrote them and dates as texts."""

KEPT = 64  # Designs whose programs and optics are kept between requests
MOST_PINS = 4  # Designs that can be pinned beside the one that is moved

_PIN, _AT = "pin", "at"
_MOST_TEXT = 200_000  # characters of a URL or of a document
_DEEPEST = 12  # sections within sections
_MOST_ENTRIES = 40  # of all lists, such as layers, which cost time and memory
_KEY = re.compile(r"^[A-Za-z0-9_-]{1,60}$")
_DATE = re.compile(r"^\d{4}-\d{2}-\d{2}(?:[Tt ]\d{2}:\d{2}.*)?$")

_HERE = threading.local()


@dataclass(frozen=True)
class View:
    """What the URL of a page holds."""

    document: Document
    at: str = ""  # Altitude or pressure at which results are listed, empty where the best is
    pins: tuple[Document, ...] = ()  # Documents pinned beside it


@dataclass(frozen=True)
class Workplace:
    """Where documents are read: the folder whose files they may name."""

    folder: Path
    name: str  # Of the flyer file, in messages and downloads
    # The document that the page opens with; files that it names may be anywhere
    initial: Document = field(hash=False)

    @classmethod
    def of_file(cls, path: Path | None) -> "Workplace":
        """The workplace of a flyer or mission file, by default of the first template."""
        if path is None:
            first = next(iter(templates().values()))
            return cls(Path.cwd(), "flyer.toml", plain(first.document))
        text = read_text(path)
        document = parse_toml(text, path, FLYER_FILE)
        read: Callable[[str, Path], Any] = design_of_text
        if MISSION in document:
            read = mission_of_text
        read(text, path)  # its mistakes end the command, with their lines
        return cls(path.parent, path.name, plain(document))

    def design(self, document: Document) -> FileDesign:
        """What a document describes, without its mission."""
        return self._described(document)[0]

    def diagnostics(self, document: Document) -> tuple[str, ...]:
        """Warnings about the numbers of a document, such as a TAC above one."""
        return self._described(document)[1]

    def _described(self, document: Document) -> tuple[FileDesign, tuple[str, ...]]:
        """A design, and the warnings that came up when it was read."""
        content = {name: entry for name, entry in document.items() if name != MISSION}
        return self._designs(self._confined_toml(content))

    def mission(self, document: Document) -> MissionFile:
        return self._missions(self._confined_toml(document))

    @cached_property
    def _designs(self) -> Callable[[str], tuple[FileDesign, tuple[str, ...]]]:
        def described(text: str) -> tuple[FileDesign, tuple[str, ...]]:
            before, _HERE.gathered = getattr(_HERE, "gathered", None), []
            try:
                design = self._read(design_of_text, text)
                design.setup  # noqa: B018  # built here, where its warnings are gathered
                return design, tuple(_HERE.gathered)
            finally:
                _HERE.gathered = before

        return lru_cache(KEPT)(described)

    @cached_property
    def _missions(self) -> Any:
        return lru_cache(KEPT)(lambda text: self._read(mission_of_text, text))

    def _read(self, reader: Any, text: str) -> Any:
        path = self.folder / self.name
        try:
            return reader(text, path)
        except ConfigurationError as error:
            place = re.compile(rf"^{re.escape(str(path))}(?::\d+)?: ", re.MULTILINE)
            raise ConfigurationError(place.sub("", str(error))) from None

    def _confined_toml(self, document: Document) -> str:
        """The document as TOML, unless it names files elsewhere."""
        for _, text in walk(document):
            known = not isinstance(text, str) or text in self._trusted
            if not known and _leaves(self.folder, text.strip()):
                raise ConfigurationError(
                    f'"{text}" is outside the folder of the flyer file: put it there and give its '
                    "name, or name it in the file that explore opens"
                )
        return to_toml(document)

    @cached_property
    def _trusted(self) -> frozenset[str]:
        return frozenset(text for _, text in walk(self.initial) if isinstance(text, str))

    def from_toml(self, text: str, name: str) -> Document:
        """Document of a file that was uploaded; ``name``: of the file, for messages."""
        document = plain(parse_toml(text, Path(name or "the file"), FLYER_FILE))
        require_document(document)
        self.mission(document) if MISSION in document else self.design(document)
        return document


def plain(content: Any) -> Any:
    """Content of a TOML file as JSON has it: dates become texts."""
    if isinstance(content, Mapping):
        return {key: plain(entry) for key, entry in content.items()}
    if isinstance(content, list | tuple):
        return [plain(entry) for entry in content]
    is_date = isinstance(content, datetime.date | datetime.time)
    return content.isoformat() if is_date else content


def require_document(document: Any) -> None:
    """Raise unless a page's document can be a flyer file; ``document``: from JSON."""
    if not isinstance(document, dict):
        raise ConfigurationError("a design is a table of sections")
    if len(json.dumps(document)) > _MOST_TEXT:
        raise ConfigurationError(f"a design has at most {_MOST_TEXT} characters")
    _require_keys(document, 0)
    if entries_of(document) > _MOST_ENTRIES:
        raise ConfigurationError(
            f"a design has at most {_MOST_ENTRIES} layers here; lightflyer predict takes more"
        )
    unknown = [name for name in document if name not in (*PARTS, MISSION)]
    if unknown:
        raise ConfigurationError(
            f"[{unknown[0]}] is not a section of a design; choose from "
            f"{', '.join((*PARTS, MISSION))}"
        )


def _require_keys(content: Any, depth: int) -> None:
    if depth > _DEEPEST:
        raise ConfigurationError(f"a design has at most {_DEEPEST} sections within each other")
    if isinstance(content, dict):
        for key, entry in content.items():
            if not _KEY.match(key):
                raise ConfigurationError(f'"{key[:60]}" cannot be a key')
            _require_keys(entry, depth + 1)
    elif isinstance(content, list):
        for entry in content:
            _require_keys(entry, depth + 1)
    elif isinstance(content, str) and any("\ud800" <= letter <= "\udfff" for letter in content):
        raise ConfigurationError(
            "a text of the design has half a character, which no file can hold"
        )


def walk(content: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """All that stands within a document, sections and lists included, by dotted name."""
    inner = enumerate(content) if isinstance(content, list) else content.items()
    for key, entry in inner:
        yield f"{prefix}{key}", entry
        if isinstance(entry, Mapping | list):
            yield from walk(entry, f"{prefix}{key}.")


def entries_of(content: Any) -> int:
    """Number of entries of all lists of a document."""
    return sum(len(entry) for _, entry in walk(content) if isinstance(entry, list))


def to_toml(document: Document) -> str:
    """A document as the text of a flyer file, which the command line reads to the last digit."""
    writer = extra("tomli_w", "the explorer", "explorer")
    names = [name for name in (*PARTS, MISSION) if name in document]
    written: str = writer.dumps({name: _type_text(document[name]) for name in names})
    return written


def _type_text(content: Any) -> Any:
    """What TOML writes without quotes as such, and nothing where a field is empty."""
    if isinstance(content, Mapping):
        kept = {key: _type_text(entry) for key, entry in content.items()}
        return {key: entry for key, entry in kept.items() if entry not in ("", None)}
    if isinstance(content, list | tuple):
        return [_type_text(entry) for entry in content if entry is not None]
    return _value(content.strip()) if isinstance(content, str) else content


def _value(text: str) -> Any:
    """Number, truth value or date that a text stands for, else the text."""
    if not (text in ("true", "false") or _DATE.match(text) or text[:1] in set("+-.0123456789")):
        return text
    try:
        value = tomllib.loads(f"value = {text}")
    except (tomllib.TOMLDecodeError, ValueError):
        return text
    return value["value"] if set(value) == {"value"} else text


def to_url(view: View) -> str:
    """What follows the ``#`` of the page's address."""
    entries = list(_entries(view.document))
    if view.at:
        entries.append((_AT, view.at))
    entries += [(_PIN, json.dumps(pin, ensure_ascii=False)) for pin in view.pins]
    return urlencode(entries)


def _entries(content: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for key, entry in content.items():
        if isinstance(entry, Mapping) and entry:
            yield from _entries(entry, f"{prefix}{key}.")
        elif isinstance(entry, str) and entry[:1] not in set('[{"'):
            if entry:
                yield f"{prefix}{key}", entry
        elif entry is not None:
            yield f"{prefix}{key}", json.dumps(entry, ensure_ascii=False)


def from_url(text: str) -> View:
    """What the part of an address after ``#`` holds; inverse of :func:`to_url`."""
    if len(text) > _MOST_TEXT:
        raise ConfigurationError(f"the address has more than {_MOST_TEXT} characters")
    try:
        entries = parse_qsl(
            text, keep_blank_values=True, strict_parsing=True, errors="strict", max_num_fields=2000
        )
        document: Document = {}
        at, pins = "", []
        for name, value in entries:
            if name == _AT:
                at = value
            elif name == _PIN:
                pins.append(_from_json(name, value))
            else:
                is_json = value[:1] in set('[{"')
                _put(document, name, _from_json(name, value) if is_json else plain(_value(value)))
        for one in (document, *pins):
            require_document(one)
    except (ValueError, RecursionError) as error:
        if isinstance(error, ConfigurationError):
            raise
        raise ConfigurationError(
            "the address does not hold a design: it consists of key=value, separated by &"
        ) from None
    if len(pins) > MOST_PINS:
        raise ConfigurationError(f"the address pins more than {MOST_PINS} designs")
    return View(document, at, tuple(pins))


def _from_json(name: str, text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        raise ConfigurationError(f"the address: {name[:60]} is not valid JSON") from None


def _put(document: Document, name: str, value: Any) -> None:
    *sections, key = name.split(".")
    place = document
    for section in sections[:_DEEPEST]:
        place = place.setdefault(section, {})
        if not isinstance(place, dict):
            raise ConfigurationError(
                f"the address: {section[:60]} is a value and a section at once"
            )
    if not sections or key in place:
        reason = "is given twice" if sections else "belongs to no section"
        raise ConfigurationError(f"the address: {name[:60]} {reason}")
    place[key] = value


def _leaves(folder: Path, text: str) -> bool:
    """Whether a text, read as a path by any system, names what lies outside a folder."""
    paths = PurePosixPath(text), PureWindowsPath(text)
    outside = any(path.is_absolute() or path.drive or ".." in path.parts for path in paths)
    if outside or text.startswith(("~", "\\\\")):
        return True
    try:
        return not (folder / text).resolve().is_relative_to(folder.resolve())  # by a link
    except (OSError, ValueError):
        return False  # no system has such a path


def tags_of(document: Document) -> dict[str, str]:
    """Which alternative each section of a document is, by dotted name."""
    found: dict[str, str] = {}
    for name, content in walk(document):
        first, *inner = name.split(".")
        within_list = any(map(str.isdigit, inner))
        if isinstance(content, Mapping) and first != MISSION and not within_list:
            kind = section_at(name, document)
            if kind is not None and issubclass(kind, Alternative):
                found[name] = kind.tag_of(content)
    return found


@contextmanager
def keeping_warnings() -> Iterator[None]:
    """Gather warnings about parameters for as long as the server runs."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", ParameterWarning)
        usual = warnings.showwarning

        def show(message: Warning | str, *rest: Any, **named: Any) -> None:
            gathered = getattr(_HERE, "gathered", None)
            if gathered is None:
                usual(message, *rest, **named)
            elif str(message) not in gathered:
                gathered.append(str(message))

        warnings.showwarning = show
        yield
