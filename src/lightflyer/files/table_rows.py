"""Rows of a table as numbers and texts, and what is wrong with the rows that cannot be read."""

import math
import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity
from lightflyer.files.number_marks import (
    APOSTROPHES,
    COMMA,
    POINT,
    SPACES,
    Marks,
    find_marks,
    shows_decimal,
    stated_mark,
)
from lightflyer.files.table_file import AS_TEXT
from lightflyer.files.table_layout import Layout, names_columns, split_cells

_SMALLEST, _LARGEST = 1e-30, 1e30  # of measured values in any unit; powers of others overflow
_BLOCK = 50_000  # rows read at once; a block with a faulty row is read again row by row
_HEAD = 200  # rows that settle the marks of most files
_NUMBER_AND_UNIT = re.compile(r"^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*[A-Za-zµμ°Ω%/^]+")
_MONTH = "(?:jan|feb|mar|mär|mrz|apr|may|mai|jun|jul|aug|sep|oct|okt|nov|dec|dez)[a-z]*"
_DATE = re.compile(
    r"\d{4}-\d\d-\d\d(?:[T ][\d:.]+)?$|\d\d:\d\d:\d\d|\d{1,2}[./-]\d{1,2}[./-]\d{4}$"
    rf"|\d{{1,2}}[. -]+{_MONTH}\.?(?:[. -]*\d{{2,4}})?$|{_MONTH}[. -]+\d{{2,4}}$",
    re.I,
)
_SPACED = re.compile(rf"\d[{SPACES}{APOSTROPHES}]\d")
_PERCENT = 100.0

Row = tuple[int, str]  # Line of a row, counted from 1, and its text


class Rejected(NamedTuple):
    """A row that was rejected."""

    file: str
    line: int  # Counted from 1
    reason: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.reason}"


class Values(NamedTuple):
    """What the rows of a file hold."""

    lines: np.ndarray  # shape (n,); line of each row that was read
    numbers: np.ndarray  # shape (n, m); known columns of numbers, as the file writes them
    texts: dict[str, list[str]]  # Columns of text
    rejected: list[Rejected]  # Rows that cannot be read


def marks_of(
    source: str, rows: Sequence[Row], layout: Layout, comments: Sequence[str], *,
    in_sheet: bool = False, say: bool = True,
) -> Marks:  # fmt: skip
    """Decimal and thousands marks of a file; ``source``: name of the file, for messages."""
    stated = stated_mark(comments)
    if stated:
        return Marks(stated, (COMMA if stated == POINT else POINT) + SPACES[0])
    present = {
        mark
        for mark in (POINT, COMMA, '"')
        if mark != layout.delimiter and any(mark in line for _, line in rows)
    }
    spaced = layout.delimiter is not None and any(_SPACED.search(line) for _, line in rows)
    if not spaced and (not present or (present == {POINT} and in_sheet)):
        return Marks()
    if not spaced and len(present) == 1:
        (mark,) = present
        if shows_decimal((cell for _, _, cell in _cells(rows[:_HEAD], layout)), mark):
            return Marks(mark)
    columns: dict[str, list[Row]] = {}
    for line, name, cell in _cells(rows, layout):
        columns.setdefault(name, []).append((line, cell))
    placed = {one.column.name: one for one in layout.number_columns.values()}
    return find_marks(
        source,
        columns,
        lambda name, value: is_possible(
            value * placed[name].scale + placed[name].offset, placed[name].column.quantity
        ),
        by_commas=layout.delimiter == COMMA,
        in_sheet=in_sheet,
        say=say,
    )


def is_possible(values: Any, quantity: Quantity) -> Any:
    """Whether values in SI units are within the range of a quantity, and of a plausible size."""
    above = values > quantity.lowest if quantity.open_below else values >= quantity.lowest
    smallest, largest = quantity.sizes
    sizes = np.abs(values)
    plausible = (sizes <= largest) & ((sizes >= smallest) | (sizes == 0.0))
    return above & (values <= quantity.highest) & plausible


def _cells(rows: Sequence[Row], layout: Layout) -> Iterator[tuple[int, str, str]]:
    known = [(place, one.column.name) for place, one in layout.number_columns.items()]
    for line, text in rows:
        cells = split_cells(text, layout.delimiter)
        for place, name in known:
            if place < len(cells):
                yield line, name, cells[place]


def read_rows(source: str, rows: Sequence[Row], layout: Layout, marks: Marks) -> Values:
    """Numbers and texts of the rows; ``source``: name of the file, for messages."""
    texts: dict[str, list[str]] = {one.column.name: [] for one in layout.text_columns.values()}
    delimiter, width = layout.delimiter, len(layout.names)
    if delimiter is not None:
        # A delimiter at the end of every row. Where some have one only, cells may have been split:
        # ``30,1,469,`` is 30 and 1469.
        split = (split_cells(line, delimiter) for _, line in rows)
        if all(len(cells) == width + 1 and not cells[-1] for cells in split):
            rows = [(number, line[: line.rindex(delimiter)]) for number, line in rows]
    found = []
    for start in range(0, len(rows), _BLOCK):
        block = rows[start : start + _BLOCK]
        numbers = None if texts else _read_block(block, layout, marks)
        if numbers is None:
            found.append(_read_slowly(source, block, layout, marks))
        else:
            found.append(Values(np.array([line for line, _ in block], int), numbers, {}, []))
    for block_values in found:
        for name, cells in block_values.texts.items():
            texts[name] += cells
    return Values(
        np.concatenate([one.lines for one in found]),
        np.concatenate([one.numbers for one in found]),
        texts,
        [row for one in found for row in one.rejected],
    )


def _read_block(block: Sequence[Row], layout: Layout, marks: Marks) -> np.ndarray | None:
    """All numbers of a block, or None where one of its rows must be looked at."""
    width, delimiter = len(layout.names), layout.delimiter
    lines = [line for _, line in block]
    if any(
        (len(line.split()) if delimiter is None else line.count(delimiter) + 1) != width
        for line in lines
    ):
        return None
    other = COMMA if marks.decimal == POINT else POINT
    if len(marks.decimal) > 1 or (other != delimiter and any(other in line for line in lines)):
        return None
    if marks.decimal == COMMA:
        lines = [line.replace(COMMA, POINT) for line in lines]
    positions = list(layout.number_columns)
    try:
        values = np.loadtxt(
            lines, delimiter=delimiter, usecols=positions, comments=None, ndmin=2, dtype=float
        )
    except ValueError:
        return None
    sizes = np.abs(values)
    if len(values) != len(block) or not ((sizes <= _LARGEST) & _measurable(sizes)).all():
        return None
    return values


def _measurable(size: Any) -> Any:
    """Whether a magnitude is zero, or not too small for a measured value."""
    return (size == 0.0) | (size >= _SMALLEST)


def _read_slowly(source: str, block: Sequence[Row], layout: Layout, marks: Marks) -> Values:
    """Line numbers, numbers and texts of the rows that can be read, and the other rows."""
    width = len(layout.names)
    lines: list[int] = []
    values: list[list[float]] = []
    texts: dict[str, list[str]] = {one.column.name: [] for one in layout.text_columns.values()}
    rejected: list[Rejected] = []
    for line, text in block:
        cells = split_cells(text, layout.delimiter)
        if names_columns(layout, cells):
            raise ConfigurationError(
                f"{source}:{line}: is a second header: the rows below may have other units; "
                "split the file here"
            )
        if len(cells) != width:
            count = f"{len(cells)} value{'s' * (len(cells) != 1)}"
            reason = f"has {count}, the header names {width} columns"
            rejected.append(Rejected(source, line, reason))
            continue
        row: list[float] = []
        said: dict[str, str] = {}
        place, reason = f"{source}:{line}", ""
        for position, one in layout.columns.items():
            cell, column = cells[position], one.column
            if column.text:
                if not (cell or column.blank):
                    raise ConfigurationError(f"{place}: {column.name} is empty")
                said[column.name] = cell.removesuffix(AS_TEXT)
                continue
            value = marks.number(cell)
            if value is None and cell.endswith("%") and not column.quantity.unit:
                # such as ``75 %`` in a column of pure numbers, in the column's unit
                value = marks.number(cell[:-1].rstrip())
                value = value if value is None or column.any_unit else value / _PERCENT / one.scale
            if value is None:
                reason = _not_a_number(cell, column.name, place)
                break
            if abs(value) > _LARGEST or not _measurable(abs(value)):
                reason = f"{column.name} is {cell}, which is no measured value"
                break
            row.append(value)
        if reason:
            rejected.append(Rejected(source, line, reason))
            continue
        lines.append(line)
        values.append(row)
        for name, word in said.items():
            texts[name].append(word)
    shape = len(lines), len(layout.number_columns)
    return Values(np.array(lines, int), np.array(values, float).reshape(shape), texts, rejected)


def _not_a_number(cell: str, name: str, place: str) -> str:
    """What a cell is instead; those that put the whole file in doubt are refused."""
    if _NUMBER_AND_UNIT.match(cell) and not _DATE.match(cell):
        raise ConfigurationError(
            f'{place}: {name}: "{cell}" is more than a number; the unit of a column belongs in its '
            "header"
        )
    if cell.startswith("="):
        raise ConfigurationError(
            f'{place}: {name}: the formula "{cell}" has no value; open the file in a spreadsheet '
            "program and save it"
        )
    if cell.endswith(AS_TEXT):
        text = cell.removesuffix(AS_TEXT)
        raise ConfigurationError(
            f'{place}: {name}: "{text}" is a text of the workbook, of which the mark may group '
            "thousands; make it a number there"
        )
    if not cell:
        return f"{name} is empty"
    if _DATE.match(cell):
        return f'{name}: "{cell}" is a date or a time of day, as spreadsheets make of 5.3 or 5-3'
    try:
        known = not math.isfinite(float(cell))
    except ValueError:
        known = False
    return f"{name} is {cell}" if known else f'{name}: "{cell}" is not a number'
