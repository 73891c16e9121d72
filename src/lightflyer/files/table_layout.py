"""Layout of a table in a text file: its delimiter, and the names and units of its columns."""

import csv
import re
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity, quantity_of
from lightflyer.core.units import scale_and_offset, spell_unit

PREAMBLE = 200  # Lines in which the header is looked for

COMMENTS = ("#", "//", "!")
"""Beginnings of comment lines."""

_COMMA_IN_NUMBER = re.compile(r"^\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*$")
_IN_BRACKETS = r"\[[^\[\]]*\]|\((?:[^()]|\([^()]*\))*\)"  # round ones stand in units too
_NAME_AND_UNIT = re.compile(rf"^(.*?)\s*({_IN_BRACKETS})?$")
_NAME_AND_SUFFIX = re.compile(r"^(.*[^\s_])[\s_]+(\S+)$")
_SPACED_CELL = re.compile(rf"[^\s\[(]+(?:\s*(?:{_IN_BRACKETS}))?")
_NO_UNIT = ("1", "-", "fraction", "a.u.", "arb. units")
_ERRORS = ("err", "error", "std", "stdev", "sd", "sigma", "se", "unc", "uncertainty", "u", "min",
           "max", "low", "high", "lower", "upper", "plus", "minus")  # fmt: skip
_STANDARD = ("unc", "std", "sigma", "sd")  # words for a standard uncertainty, not for any error
_DELIMITERS = ("\t", ";", ",")

# as spectrometers write their headers
_WHOLE_NAMES = {"cm-1": ("wavenumber", "cm^-1"), "cm^-1": ("wavenumber", "cm^-1"),
                "%t": ("transmittance", "%"),
                "%r": ("reflectance", "%"), "t%": ("transmittance", "%"),
                "nm": ("wavelength", "nm"), "um": ("wavelength", "um"),
                "\N{GREEK SMALL LETTER MU}m": ("wavelength", "um"),
                "ev": ("photon_energy", "eV")}  # fmt: skip


@lru_cache(maxsize=4096)
def _normal(name: str) -> str:
    plain = unicodedata.normalize("NFKC", name)  # subscripts as digits
    return re.sub(r"[\s\-.]+", "_", plain.strip().strip('"').casefold())


@dataclass(frozen=True)
class Column:
    """A column that a reader of tables knows."""

    name: str  # Such as ``"heater_power"``
    # SI unit and possible range of the values: a :class:`~lightflyer.core.quantity.Quantity`, or an
    # alias of one such as ``Pressure``. By default any pure number
    kind: Any = None
    aliases: tuple[str, ...] = ()  # Other names that headers may use
    required: bool = False  # Whether a file without the column is refused
    # What an impossible value does: refuse the file, or reject the row (a pressure gauge that reads
    # below zero does not cast doubt on the whole file)
    outside: Literal["stop", "reject"] = "stop"
    text: bool = False  # Whether the column holds text
    blank: bool = True  # Whether a text may be empty
    difference: bool = False  # Whether the values are differences, for which 1 °C is 1 K
    any_unit: bool = False  # Take values as written, whatever the header adds to the name
    assumed_unit: str = ""  # Unit of the values where the header names none
    suggested_unit: str = ""  # Unit that messages propose, in place of the SI unit

    @property
    def quantity(self) -> Quantity:
        """SI unit and possible range."""
        return quantity_of(self.kind) or Quantity()

    @cached_property
    def headers(self) -> tuple[str, ...]:
        """Names that headers may use, in lower case and with underscores."""
        return tuple(_normal(name) for name in (self.name, *self.aliases))

    @property
    def with_unit(self) -> str:
        """The name as a header would write it, such as ``"pressure [Pa]"``."""
        unit = self.suggested_unit or self.quantity.unit
        return f"{self.name} [{unit}]" if unit else self.name

    def uncertainty(self) -> "Column":
        kind = Quantity(self.quantity.unit, 0.0)
        names = [f"{name}_{word}" for name in (self.name, *self.aliases) for word in _STANDARD]
        return Column(f"{self.name}_uncertainty", kind, tuple(names), difference=True)


class Placed(NamedTuple):
    """A known column of a file: the unit it is written in, and scale and offset to SI."""

    column: Column
    unit: str
    scale: float
    offset: float


class Layout(NamedTuple):
    """Layout of a file."""

    delimiter: str | None  # None for white space
    names: list[str]  # Names of all columns, as the file or the option writes them
    first: int  # Index of the first row among the lines of the file
    columns: dict[int, Placed]  # Known columns by position

    @property
    def number_columns(self) -> dict[int, Placed]:
        """Known columns that hold numbers, by position."""
        return {position: one for position, one in self.columns.items() if not one.column.text}

    @property
    def text_columns(self) -> dict[int, Placed]:
        """Known columns that hold text, by position."""
        return {position: one for position, one in self.columns.items() if one.column.text}


def split_cells(line: str, delimiter: str | None) -> list[str]:
    """Stripped cells of a line; ``delimiter``: none for white space."""
    if delimiter is None:
        return line.split()
    if '"' in line:
        cells = next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
        return [cell.strip() for cell in cells]
    return [cell.strip() for cell in line.split(delimiter)]


def is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip().startswith(COMMENTS)


def find_layout(
    path: str | Path,
    lines: list[str],
    columns: Sequence[Column],
    *,
    option: str | None = None,
    strict: bool = False,
    closed: bool = False,
    delimiter: str | None = None,
) -> Layout:
    """Layout of a file, from an option, its first line, or the line that is most like a header."""
    known = ", ".join(column.with_unit for column in columns)
    written = [index for index, line in enumerate(lines) if line.strip()]
    rows = [index for index in written if not is_comment(lines[index])]
    if not written:
        raise ConfigurationError(f"{path}: is empty; known columns: {known}")
    if option:  # names every column, from the first row of numbers on
        names = [name.strip() for name in option.split(",")]
        read = next((place for place, name in enumerate(names) if name != "-"), 0)
        for first in rows:
            line = lines[first]
            width = len(names)
            marked = delimiter or next((mark for mark in ("\t", ";") if mark in line), None)
            stated = marked if marked or len(line.split()) == width or "," not in line else ","
            cells = split_cells(lines[first], stated)
            if len(cells) > read and _is_number(cells[read]):
                place = f"--columns of {path}"
                return Layout(stated, names, first, _place(columns, names, place, closed=True))
        raise ConfigurationError(
            f"{path}: has no row that starts with a number if split into the {len(names)} "
            "columns of --columns; name every column, those that are not needed as -"
        )
    if strict and not rows:
        raise ConfigurationError(f"{path}: has comments only; known columns: {known}")
    header, best = rows[0] if strict else -1, 0
    for index, line in enumerate([] if strict else lines[:PREAMBLE]):
        # the line with the most known columns, above the first row of numbers
        _, cells, score = _header_cells(line, columns, delimiter)
        if any(cells) and all(_is_number(cell) or not cell for cell in cells):
            break
        if score > best:
            header, best = index, score
    if header < 0:
        raise ConfigurationError(
            f"{path}:{written[0] + 1}: has no known column; name its columns in a header or by "
            f"--columns: {known}"
        )
    delimiter, names, _ = _header_cells(lines[header], columns, delimiter)
    # the line below has the units that columns lack
    below = lines[header + 1] if header + 1 < len(lines) else ""
    text = below.lstrip("#/! ") if is_comment(lines[header]) else below
    units = [cell.strip("[]() ") for cell in split_cells(text, delimiter)]
    lacking = {
        position: column
        for position, (column, unit) in _matches(columns, names).items()
        if not (unit or column.text or column.any_unit)
    }
    needed = any(one.quantity.unit and not one.assumed_unit for one in lacking.values())
    with_units = needed and len(units) == len(names) and not any(map(_is_number, units))
    if with_units:
        names = [
            f"{name} [{unit}]" if unit and place in lacking else name
            for place, (name, unit) in enumerate(zip(names, units, strict=True))
        ]
    found = _place(columns, names, f"{path}:{header + 1}", closed=closed and strict)
    return Layout(delimiter, names, header + 1 + with_units, found)


def names_columns(layout: Layout, cells: Sequence[str]) -> bool:
    """Whether a row of a file repeats its header."""
    known = layout.number_columns
    numbers = [cells[position] for position in known if position < len(cells)]
    return bool(_matches([one.column for one in known.values()], numbers))


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return bool(_COMMA_IN_NUMBER.match(cell))
    return True


def _header_cells(
    line: str, columns: Sequence[Column], stated: str | None
) -> tuple[str | None, list[str], int]:
    """Delimiter and names by which a line has the most known columns, and how many."""
    text = line if stated else line.strip()
    text = text.lstrip("#/! ") if is_comment(text) else text
    best: tuple[str | None, list[str], int] | None = None
    for delimiter in (stated,) if stated else (*_DELIMITERS, None):
        if delimiter and delimiter not in text:
            continue
        cells = split_cells(text, delimiter) if delimiter else _SPACED_CELL.findall(text)
        cells = cells[:-1] if len(cells) > 1 and not cells[-1] and not stated else cells
        score = len(_matches(columns, cells))
        # names with spaces in them are no columns of their own
        if best is None or (score > best[2] and delimiter):
            best = delimiter, cells, score
    return best or (stated, [text.strip()], 0)


def _matches(columns: Sequence[Column], cells: Sequence[str]) -> dict[int, tuple[Column, str]]:
    """Known columns of a header with the units it names, by position."""
    by_name: dict[str, list[Column]] = {}
    for one in columns:
        for name in one.headers:
            by_name.setdefault(name, []).append(one)
    found: dict[int, tuple[Column, str]] = {}
    for position, cell in enumerate(cells):
        # name and unit of "pressure [Pa]", "Pressure (Pa)" or "pressure / Pa"
        text = cell.strip().strip('"')
        match = _NAME_AND_UNIT.match(text)
        base, unit = (match[1], (match[2] or "")[1:-1].strip()) if match else (text, "")
        for mark in (",", "/", " in "):
            if not unit and mark in base:
                base, _, unit = base.partition(mark)
        unit = "" if unit.strip() in _NO_UNIT else unit.strip()
        base, unit = _WHOLE_NAMES.get(spell_unit(text, "").casefold(), (base, unit))
        named = by_name.get(_normal(base), [])
        # p may be a pressure or a power: the unit tells
        column = next((one for one in named if len(named) == 1 or _fits(one, unit)), None)
        if column and not (column.any_unit and _normal(unit) in _ERRORS):
            found[position] = (column, unit)
    missing = [one for one in columns if not any(one is column for column, _ in found.values())]
    spelled = [(place, cell) for place, cell in enumerate(cells) if cell[:1].isalpha()]
    for column in missing if spelled else ():
        for position, cell in spelled:
            suffix = None if position in found else _suffix(column, cell)
            if suffix is not None:
                found[position] = (column, suffix)
                break
    return found


def _fits(column: Column, unit: str) -> bool:
    """Whether a column may have a unit; the first of a name may have none."""
    try:
        return not unit or bool(scale_and_offset(unit, column.quantity.unit))
    except ConfigurationError:
        return False


def _suffix(column: Column, cell: str) -> str | None:
    """Unit in a header such as ``pressure_mTorr``; None where it is of another column."""
    text = cell.strip().strip('"')
    names = column.headers
    if not _normal(text).startswith(names):
        return None
    if column.any_unit:
        rest = [_normal(text).removeprefix(f"{name}_").strip("()[]") for name in names]
        return "" if any(one not in (_normal(text), *_ERRORS) for one in rest) else None
    match = _NAME_AND_SUFFIX.match(text)
    if match is None or _normal(match[1]) not in names or not column.quantity.unit:
        return None
    return match[2] if _fits(column, match[2]) else None


def _place(
    columns: Sequence[Column], names: Sequence[str], place: str, *, closed: bool = False
) -> dict[int, Placed]:
    """Known columns by position."""
    matches = _matches(columns, names)
    for position, name in enumerate(names):
        if closed and position not in matches and name not in ("", "-"):
            known = ", ".join(column.with_unit for column in columns)
            raise ConfigurationError(f'{place}: column "{name}" is unknown; known columns: {known}')
    placed: dict[int, Placed] = {}
    for position in sorted(matches):
        column, unit = matches[position]
        if any(column is one.column for one in placed.values()):
            raise ConfigurationError(f"{place}: column {column.name} appears twice")
        if column.text or column.any_unit:
            placed[position] = Placed(column, "", 1.0, 0.0)
            continue
        unit = unit or column.assumed_unit
        if column.quantity.unit and not unit:
            raise ConfigurationError(
                f'{place}: column {column.name} has no unit; write "{column.with_unit}"'
            )
        try:
            scale, offset = scale_and_offset(unit, column.quantity.unit)
        except ConfigurationError as error:
            said = str(error).removeprefix(f'"{unit}": ')
            raise ConfigurationError(f"{place}: column {column.name}: {said}") from None
        placed[position] = Placed(column, unit, scale, 0.0 if column.difference else offset)
    required = [column for column in columns if column.required]
    for column in required:
        if not any(column is one.column for one in placed.values()):
            needed = ", ".join(one.with_unit for one in required)
            raise ConfigurationError(
                f"{place}: the column {column.name} is missing; needed: {needed}; found: "
                f"{', '.join(filter(None, names))}"
            )
    if not placed:
        known = ", ".join(column.with_unit for column in columns)
        raise ConfigurationError(f"{place}: has no known column; known columns: {known}")
    return placed
