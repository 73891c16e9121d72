"""How a table is laid out: its delimiter, its columns, their names and units."""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.units import scale_and_offset

PREAMBLE = 200  # lines in which the header is looked for
COMMENTS = ("#", "//", "!")
_COMMA_IN_NUMBER = re.compile(r"^\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*$")
_NAME_AND_UNIT = re.compile(r"^(.*?)\s*(?:[\[(]\s*([^\[\]()]*?)\s*[\])])?$")
_SPACED_CELL = re.compile(r"[^\s\[(]+(?:\s*[\[(][^\])]*[\])])?")
_UNIT_SPELLINGS = {
    "C": "°C", "deg C": "°C", "deg. C": "°C", "Celsius": "°C", "Kelvin": "K", "torr": "Torr",
    "mtorr": "mTorr", "\N{GREEK CAPITAL LETTER OMEGA}": "ohm", "\N{OHM SIGN}": "ohm",
    "Ohm": "ohm", "micron": "um", "microns": "um", "1/cm": "cm^-1", "cm⁻¹": "cm^-1",
    "1/m": "m^-1", "volts": "V", "amps": "A", "1": "", "-": "", "fraction": "", "a.u.": "",
}  # fmt: skip


# what spectrometers head their columns with
_WHOLE_NAMES = {"cm-1": ("wavenumber", "cm^-1"), "%t": ("transmittance", "%"),
                "%r": ("reflectance", "%"), "t%": ("transmittance", "%")}  # fmt: skip


@dataclass(frozen=True)
class Column:
    """What a measurement knows of one of its columns.

    Attributes
    ----------
    name : str
        As in ``heater_power``.
    unit : str
        SI unit that its values are turned into, ``""`` for a pure number.
    aliases : tuple of str
        Other names that headers give it.
    lowest, highest : float
        Possible values, in SI units.
    open_below : bool
        Exclude ``lowest`` itself.
    outside : {"stop", "reject"}
        What an impossible value does; gauges that read below their zero are no reason to stop.
    text : bool
        Holds text, not numbers.
    unit_of_bare : str
        Unit taken where the header names none.
    """

    name: str
    unit: str = ""
    aliases: tuple[str, ...] = ()
    lowest: float = -math.inf
    highest: float = math.inf
    open_below: bool = False
    outside: Literal["stop", "reject"] = "stop"
    text: bool = False
    unit_of_bare: str = ""


class Layout(NamedTuple):
    """How a file is laid out."""

    delimiter: str | None  # None: white space
    names: list[str]  # of its columns, as it writes them
    place: str  # of those names, for messages
    first: int  # index of the first row among the file's lines
    columns: dict[int, tuple[Column, float, float]]  # by position, with scale and offset to SI


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return bool(_COMMA_IN_NUMBER.match(cell))
    return True


def split_cells(line: str, delimiter: str | None) -> list[str]:
    """Cells of a line, stripped; ``None`` delimits by white space."""
    if delimiter is None:
        return line.split()
    if '"' in line:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter))]
    return [cell.strip() for cell in line.split(delimiter)]


def _delimiter(line: str) -> str | None:
    return next((mark for mark in ("\t", ";", ",") if mark in line), None)


def _normal(name: str) -> str:
    return re.sub(r"[\s\-.]+", "_", name.strip().strip('"').casefold())


def layout_from_option(
    path: Path, lines: list[str], columns: Sequence[Column], layout: str
) -> Layout:
    """Layout by the names that ``--columns`` gives, from the first row of numbers on."""
    names = [name.strip() for name in layout.split(",")]
    first = next(
        (
            index
            for index, line in enumerate(lines)
            if line.strip()
            and not line.lstrip().startswith(COMMENTS)
            and _is_number(split_cells(line, _delimiter_of_row(line, len(names)))[0])
        ),
        None,
    )
    if first is None:
        raise ConfigurationError(f"{path}: has no row that starts with a number")
    delimiter = _delimiter_of_row(lines[first], len(names))
    known = _known_columns(columns, names, f"--columns of {path}", strict=True)
    return Layout(delimiter, names, "--columns", first, known)


def _delimiter_of_row(line: str, width: int) -> str | None:
    marked = next((mark for mark in ("\t", ";") if mark in line), None)
    return marked if marked or len(line.split()) == width else _delimiter(line)


def layout_from_header(path: Path, lines: list[str], columns: Sequence[Column]) -> Layout:
    """Layout by the line that names the most known columns, before the first row of numbers."""
    best: tuple[int, list[str], int] | None = None
    for index, line in enumerate(lines[:PREAMBLE]):
        text = line.strip().lstrip("#/! ")
        delimiter = _delimiter(text)
        cells = split_cells(text, delimiter) if delimiter else _SPACED_CELL.findall(text)
        cells = cells[:-1] if cells and not cells[-1] else cells
        if cells and all(_is_number(cell) for cell in cells):
            break
        score = len(_matches(columns, cells))
        if score and (best is None or score > best[2]):
            best = (index, cells, score)
    if best is None:
        known = ", ".join(_with_unit(column) for column in columns)
        if not any(line.strip() for line in lines):
            raise ConfigurationError(f"{path}: is empty; it may have the columns {known}")
        first = next(number for number, line in enumerate(lines, 1) if line.strip())
        raise ConfigurationError(
            f"{path}:{first}: no column is known; name them by --columns or a header with {known}"
        )
    header, names, _ = best
    place = f"{path}:{header + 1}"
    delimiter = _delimiter(lines[header].strip().lstrip("#/! "))
    return Layout(delimiter, names, place, header + 1, _known_columns(columns, names, place))


def _matches(columns: Sequence[Column], cells: Sequence[str]) -> dict[int, tuple[Column, str]]:
    """Column and unit of the cells of a header that are known, by position."""
    by_name = {_normal(name): one for one in columns for name in (one.name, *one.aliases)}
    found = {}
    for position, cell in enumerate(cells):
        base, unit = _split_name(cell)
        if _normal(base) in by_name:
            found[position] = (by_name[_normal(base)], unit)
    return found


def names_columns(layout: Layout, cells: Sequence[str]) -> bool:
    """Whether a row of a file names columns of its layout once more."""
    return bool(_matches([column for column, _, _ in layout.columns.values()], cells))


def _split_name(cell: str) -> tuple[str, str]:
    """Name and unit of ``pressure [Pa]``, ``Pressure (Pa)`` or ``pressure / Pa``."""
    if cell.strip().strip('"').lower() in _WHOLE_NAMES:
        return _WHOLE_NAMES[cell.strip().strip('"').lower()]
    match = _NAME_AND_UNIT.match(cell.strip().strip('"'))
    base, unit = (match[1], match[2] or "") if match else (cell, "")
    if not unit and "/" in base:
        base, _, unit = base.partition("/")
    return base, _UNIT_SPELLINGS.get(unit.strip(), unit.strip())


def _with_unit(column: Column) -> str:
    return f"{column.name} [{column.unit}]" if column.unit else column.name


def _known_columns(
    columns: Sequence[Column], names: Sequence[str], place: str, *, strict: bool = False
) -> dict[int, tuple[Column, float, float]]:
    """Known columns by position, with the scale and offset that make their values SI."""
    known: dict[int, tuple[Column, float, float]] = {}
    matches = _matches(columns, names)
    for position, name in enumerate(names):
        if strict and position not in matches and name not in ("", "-"):
            raise ConfigurationError(
                f'{place}: column "{name}" is unknown; there are: '
                + ", ".join(_with_unit(column) for column in columns)
            )
    for position, (column, unit) in matches.items():
        if any(column is one for one, _, _ in known.values()):
            raise ConfigurationError(f"{place}: column {column.name} stands twice")
        known[position] = (column, *_to_si(column, unit, place))
    return known


def _to_si(column: Column, unit: str, place: str) -> tuple[float, float]:
    if column.text:
        return 1.0, 0.0
    unit = unit or column.unit_of_bare
    if column.unit and not unit:
        raise ConfigurationError(
            f'{place}: column {column.name} has no unit; write "{_with_unit(column)}"'
        )
    try:
        scale, offset = scale_and_offset(unit, column.unit)
    except ConfigurationError as error:
        raise ConfigurationError(f"{place}: column {column.name}: {error}") from None
    # an uncertainty is a difference, in which the offset of a temperature scale drops out
    return scale, 0.0 if column.name.endswith("_uncertainty") else offset
