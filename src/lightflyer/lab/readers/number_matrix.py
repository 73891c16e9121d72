"""A matrix of numbers in a text file or workbook: a height map or a thermal image."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.files.number_marks import (
    COMMA,
    POINT,
    Marks,
    find_marks,
    shows_decimal,
    stated_mark,
)
from lightflyer.files.table_file import read_lines
from lightflyer.files.table_layout import is_comment, split_cells

_LEADING_ZERO = re.compile(r"[+-]?0\d+")
_MARKED = re.compile(r"[+-]?\d[\d.,]*(e[+-]?\d+)?|[+-]?,\d+", re.I)
_HEAD = 1000  # cells in which a mark may show what it is
_SHOWN = 40  # characters of a cell or line in a message


class NumberMatrix(NamedTuple):
    """A matrix and what stands above it."""

    values: np.ndarray  # shape (rows, columns); naN where the file has no number
    above: tuple[str, ...]  # The lines above the matrix, comments included
    notes: tuple[str, ...]  # What was left out of the matrix, one line each


class _Row(NamedTuple):
    line: int
    cells: list[str]


def read_number_matrix(path: str | Path, what: str) -> NumberMatrix:
    """Read a matrix of numbers, with any delimiter, decimal points or decimal commas."""
    path = Path(path)
    tables = read_lines(path)
    if len(tables) > 1:
        names = ", ".join(one.name for one in tables)
        raise ConfigurationError(f"{path}: has several sheets, {names}; keep that of the {what}")
    lines = list(enumerate(tables[0].lines if tables else [], start=1))
    written = [(number, line) for number, line in lines if line.strip() and not is_comment(line)]
    if not written:
        raise ConfigurationError(f"{path}: is empty; a matrix of {what} is needed")
    delimiter = _delimiter(written[-1][1])
    rows = [_Row(number, _cells(line, delimiter)) for number, line in written]
    start = _first_row(path, rows)
    body = rows[start:]
    _require_equal_lengths(path, body, what)
    comments = [line for _, line in lines if is_comment(line)]
    values = _numbers(path, body, delimiter, what, comments)
    values, notes = _without_indices(values)
    first = body[0].line
    return NumberMatrix(values, tuple(line for number, line in lines if number < first), notes)


def _delimiter(line: str) -> str | None:
    """That of a row of numbers; None is white space."""
    found = next((mark for mark in ("\t", ";") if mark in line), None)
    if found is None and "," in line and len(line.split(",")) > len(line.split()):
        return ","
    return found


def _cells(line: str, delimiter: str | None) -> list[str]:
    cells = [cell.strip() for cell in split_cells(line, delimiter)]
    if cells and not cells[-1]:
        del cells[-1]  # a delimiter at the end of each row
    return cells


def _is_number(cell: str) -> bool:
    """Whether a cell is a number, in whatever marks."""
    return _reads(cell) or _MARKED.fullmatch(cell) is not None


def _reads(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _first_row(path: Path, rows: list[_Row]) -> int:
    width = len(rows[-1].cells)
    start = next(
        (
            index
            for index, row in enumerate(rows)
            if len(row.cells) > 1 and all(map(_is_number, row.cells))
        ),
        0,
    )
    for row in rows[:start]:  # a damaged row of numbers is not a heading
        numbers = sum(map(_is_number, row.cells))
        if len(row.cells) == width and 2 * numbers >= width and not _counts(row.cells[1:]):
            _refuse_cell(path, row)
    if start == 0 and not all(map(_is_number, rows[0].cells)):
        _refuse_cell(path, rows[0])
    return start


def _refuse_cell(path: Path, row: _Row) -> None:
    bad = next((cell for cell in row.cells if not _is_number(cell)), "")
    raise _no_number(path, row.line, bad)


def _no_number(path: Path, line: int, cell: str) -> ConfigurationError:
    return ConfigurationError(f'{path}:{line}: "{cell[:_SHOWN]}" is not a number')


def _require_equal_lengths(path: Path, body: list[_Row], what: str) -> None:
    for row in body:
        if not all(map(_is_number, row.cells)):
            _refuse_cell(path, row)
        if len(row.cells) != len(body[0].cells):
            raise ConfigurationError(
                f"{path}:{row.line}: has {len(row.cells)} {what}, the first row has "
                f"{len(body[0].cells)}"
            )


def _numbers(
    path: Path, body: list[_Row], delimiter: str | None, what: str, comments: list[str]
) -> np.ndarray:
    cells = [cell for row in body for cell in row.cells]
    if delimiter == ",":
        proof = next((cell for cell in cells if _LEADING_ZERO.fullmatch(cell)), None)
        if proof is not None and not any("." in cell for cell in cells):
            raise ConfigurationError(
                f'{path}: cells such as "{proof}" between commas suggest decimal commas; write '
                "the file with another delimiter"
            )
    elif any("," in cell for cell in cells):
        cells = _with_points(path, body, what, comments)
    try:
        return np.array(cells).astype(float).reshape(len(body), -1)
    except ValueError:
        width = len(body[0].cells)
        at = next(place for place, cell in enumerate(cells) if not _reads(cell))
        row = body[at // width]
        raise _no_number(path, row.line, row.cells[at % width]) from None


def _with_points(path: Path, body: list[_Row], what: str, comments: list[str]) -> list[str]:
    """Cells of a file with commas in its numbers, written with decimal points."""
    cells = [(row.line, cell) for row in body for cell in row.cells]
    stated = stated_mark(comments)
    if stated is None and not any("." in cell for _, cell in cells):
        head = [cell for _, cell in cells[:_HEAD]]
        if shows_decimal(head, COMMA):  # the only mark of the file
            return [cell.replace(",", ".") for _, cell in cells]
    marks = (
        find_marks(str(path), {what: cells}, lambda _name, _value: True, say=False)
        if stated is None
        else Marks(stated, POINT if stated == COMMA else COMMA)
    )
    found = []
    for line, cell in cells:
        value = marks.number(cell)
        if value is None and not _reads(cell):
            raise _no_number(path, line, cell)
        found.append(cell if value is None else repr(value))
    return found


def _counts(cells: list[str]) -> bool:
    """Whether cells are 0, 1, 2 and so on, or 1, 2, 3."""
    if len(cells) < 2 or not all(cell.isdigit() for cell in cells):
        return False
    first = int(cells[0])
    return first in (0, 1) and [int(cell) for cell in cells] == list(
        range(first, first + len(cells))
    )


def _without_indices(values: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """The matrix without numbers of rows and columns, and what is said of that."""
    said = []
    first = values[0, 1:]
    numbered = first.size > 1 and first[0] in (0.0, 1.0) and np.all(np.diff(first) == 1.0)
    if numbered and len(values) > 2 and np.all(np.diff(values[1:, 0]) == 1.0):
        values = values[1:]
        said.append("the first row counts the columns and is left out")
    column = values[:, 0]
    if len(column) > 2 and column[0] in (0.0, 1.0) and np.all(np.diff(column) == 1.0):
        values = values[:, 1:]
        said.append("the first column counts the rows and is left out")
    return values, tuple(said)
