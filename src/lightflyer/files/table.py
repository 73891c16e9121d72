"""Tables in text files and workbooks: units in the header, faulty rows named with their line.

Two kinds of fault are told apart. A row that cannot be read (an empty cell, "OVLD", too few
values) is rejected and named; a strict reader refuses the file instead. A value that is impossible
(a negative irradiance, a unit inside a cell) refuses the file, because all of it is then in doubt.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import stated_convention
from lightflyer.files.table_file import Lines, read_lines
from lightflyer.files.table_layout import (
    PREAMBLE,
    Column,
    Layout,
    find_layout,
    is_comment,
    split_cells,
)
from lightflyer.files.table_rows import Rejected, Row, is_possible, marks_of, read_rows

# of spreadsheets; such a row is no comment
_ERROR_CELL = re.compile(r"^\s*#(?:[A-Z\u00c0-\u00dc]+[!?]|DIV/0!|N/A|NV\b)")


@dataclass(frozen=True)
class Table:
    """The columns that were read from a file."""

    source: str  # Name of the file
    lines: np.ndarray  # shape (n,); line of each row in the file, counted from 1
    numbers: dict[str, np.ndarray]  # shape (n,); columns of numbers in SI units, by name
    texts: dict[str, list[str]] = field(default_factory=dict)  # Columns of text, by name
    rejected: list[Rejected] = field(default_factory=list)  # Rejected rows in the order of the file
    unused: list[str] = field(default_factory=list)  # Unknown columns of the file
    # What a reader of the values must know of how they were read, one line each
    notes: list[str] = field(default_factory=list)

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.lines)

    def not_used(self, option: str, column: str) -> None:
        """Note an option that a column replaces."""
        self.notes.append(f"{option} is not used: {self.source} has the column {column}")

    def without(self, reasons: dict[int, str]) -> "Table":
        """Reject further rows; without these rows, which are added to the rejected ones."""
        keep = np.ones(len(self), bool)
        keep[list(reasons)] = False
        out = [Rejected(self.source, int(self.lines[row]), why) for row, why in reasons.items()]
        return replace(
            self,
            lines=self.lines[keep],
            numbers={name: values[keep] for name, values in self.numbers.items()},
            texts={
                name: [value for value, kept in zip(values, keep, strict=True) if kept]
                for name, values in self.texts.items()
            },
            rejected=sorted([*self.rejected, *out], key=lambda row: row.line),
        )


def read_table(
    path: str | Path,
    columns: Sequence[Column],
    *,
    layout: str | None = None,
    strict: bool = False,
    closed: bool = False,
    preamble: bool | None = None,
) -> Table:
    """Read the known columns of a table; ``layout`` [mTorr]; ``columns``: known columns."""
    first = strict if preamble is None else not preamble

    def layout_of(one: Lines) -> Layout:
        return find_layout(
            one.name, one.lines, columns, option=layout, strict=first, closed=closed,
            delimiter=one.delimiter,
        )  # fmt: skip

    tables, fits, problems = read_lines(Path(path)), [], []
    for one in tables:
        try:
            fits.append((one, layout_of(one)))
        except ConfigurationError as error:
            problems.append(error)
    if not fits:
        raise problems[0]
    if len(fits) > 1:
        names = ", ".join(f'"{one.name}"' for one, _ in fits)
        raise ConfigurationError(f"{path}: has several tables; name one of {names}")
    table = _read(*fits[0], strict=strict)
    left = [one.name for one in tables if one is not fits[0][0]]
    said = [f"{fits[0][0].name} is read; {', '.join(left)}: no known columns"] if left else []
    return replace(table, notes=[*said, *table.notes])


def read_columns(file: Lines, columns: Sequence[Column]) -> Table:
    """Read the known columns of a part of a file, strictly."""
    found = find_layout(file.name, file.lines, columns, strict=True, delimiter=file.delimiter)
    return _read(file, found, strict=True)


def _read(file: Lines, found: Layout, *, strict: bool) -> Table:
    empty = f"{found.delimiter} \t" if found.delimiter else None  # rows of spreadsheets
    rows = [
        (number, line)
        for number, line in enumerate(file.lines[found.first :], start=found.first + 1)
        if line.strip(empty) and not (is_comment(line) and not _ERROR_CELL.match(line))
    ]
    if not rows:
        raise ConfigurationError(f"{file.name}: has a header but no rows")
    timed = any(name.partition("[")[0].strip(' "').casefold() == "time" for name in found.names)
    repeated, before = {}, dict[str, int]()
    for number, line in rows if timed else ():
        if before.setdefault(line, number) != number:
            said = f"repeats line {before[line]}"
            repeated[number] = Rejected(file.name, number, said)
    # A file that ends within a row is refused: more than that row may be missing. One that ends
    # within its last number cannot be told; a note asks for a look at it.
    number, line = rows[-1]
    cells, width = split_cells(line, found.delimiter), len(found.names)
    # without a line end, an empty last cell has been cut off
    cut = not file.ended and len(cells) == width and not cells[-1] and width - 1 in found.columns
    if (len(cells) < width or cut) and len(rows) > 1:
        above = len(split_cells(rows[-2][1], found.delimiter))
        if above >= width:
            raise ConfigurationError(
                f"{file.name}:{number}: the file ends within a row and is incomplete"
            )
    last, notes = found.number_columns.get(len(cells) - 1), []
    if not file.ended and last is not None and number == len(file.lines):
        notes.append(
            f"{file.name}: line {number}, the last, has no line end after its value, "
            f"{last.column.name} = {cells[-1]}; check that it is whole"
        )
    table = _with_si(file, [row for row in rows if row[0] not in repeated], found, say=not strict)
    rejected = sorted([*table.rejected, *repeated.values()], key=lambda row: row.line)
    if strict and rejected:
        raise ConfigurationError(str(rejected[0]))
    table = replace(table, rejected=rejected, notes=[*notes, *table.notes])
    out: dict[int, str] = {}  # gauges' readings below zero; other impossible values refuse the file
    for one in found.number_columns.values():
        column, quantity = one.column, one.column.quantity
        values = table.numbers[column.name]
        for row in np.flatnonzero(~is_possible(values, quantity)):
            why = quantity.implausible(values[row])
            said = why.partition(" ")[2] if why else f"is not {quantity.allowed}"
            written = (float(values[row]) - one.offset) / one.scale  # as in the file
            reason = f"{column.name} = {f'{written:g} {one.unit}'.rstrip()} {said}"
            if column.outside == "stop":
                raise ConfigurationError(f"{table.source}:{table.lines[row]}: {reason}")
            out.setdefault(int(row), reason)
    table = table.without(out) if out else table
    if not len(table):
        raise ConfigurationError(f"{table.rejected[0]}; none of its {len(rows)} rows can be read")
    return table


def shipped_table(name: str) -> Table:
    """Read a CSV file of the package's own data."""
    text = (resources.files("lightflyer") / "data" / name).read_text(encoding="utf-8")
    rows = [
        (number, split_cells(line, ","))
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not is_comment(line)
    ]
    (_, header), *body = rows
    numbers, texts = {}, {}
    for title, cells in zip(header, zip(*(cells for _, cells in body), strict=True), strict=True):
        try:
            numbers[title] = np.array(cells, float)
        except ValueError:
            texts[title] = list(cells)
    return Table(name, np.array([number for number, _ in body]), numbers, texts)


def _with_si(file: Lines, rows: list[Row], layout: Layout, *, say: bool) -> Table:
    """Rows that can be read, in SI units."""
    said_in = [line for line in file.lines[: layout.first + PREAMBLE] if is_comment(line)]
    marks = marks_of(file.name, rows, layout, said_in, in_sheet=file.is_sheet, say=say)
    values = read_rows(file.name, rows, layout, marks)
    known = layout.number_columns.values()
    said = [(one, stated_convention(one.unit)) for one in known]
    spelled = {name: one_spelling(name, texts) for name, texts in values.texts.items()}
    return Table(
        source=file.name,
        lines=values.lines,
        numbers={
            one.column.name: values.numbers[:, index] * one.scale + one.offset
            for index, one in enumerate(known)
        },
        texts={name: texts for name, (texts, _) in spelled.items()},
        rejected=values.rejected,
        unused=[
            name.strip()
            for position, name in enumerate(layout.names)
            if position not in layout.columns and name not in ("", "-")
        ],
        notes=[
            *marks.notes,
            *(note for _, notes in spelled.values() for note in notes),
            *(f"{one.column.name}: {text}" for one, text in said if text),
        ],
    )


def same_text(text: str) -> str:
    """A text without case, and with one plain blank for any number of any kind."""
    return " ".join(text.split()).casefold()


def one_spelling(column: str, texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """Texts that differ in case or blanks only, as the first is written, and what to say."""
    first: dict[str, str] = {}
    plain = [" ".join(text.split()) for text in texts]
    found = [first.setdefault(same_text(text), text) for text in plain]
    other = {text: kept for text, kept in zip(plain, found, strict=True) if text != kept}
    return found, [f'{column} "{text}" is taken for "{kept}"' for text, kept in other.items()]
