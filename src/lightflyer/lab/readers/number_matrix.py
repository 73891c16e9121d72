"""A matrix of numbers in a text file or workbook: a height map or a thermal image."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.files import number_marks as marks_of
from lightflyer.files.table_file import read_lines
from lightflyer.files.table_layout import is_comment, split_cells

_LEADING_ZERO = re.compile(r"[+-]?0\d+")
_MARKED = re.compile(r"[+-]?\d[\d.,]*(e[+-]?\d+)?|[+-]?,\d+", re.I)
_APART = re.compile(r"\s*,\s+")
_HEAD = 1000  # cells in which a mark may show what it is
_LEAST_AXIS = 8  # numbers; fewer are one where they count 0, 1, 2 or 1, 2, 3
_EVEN = 0.2  # of a step, by which the numbers of an axis may be rounded
_STRAIGHTER = 10.0  # times, that an axis is than the numbers beside it
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
    last = written[-1][1]
    delimiter = next((mark for mark in ("\t", ";") if mark in last), None)  # None is white space
    if delimiter is None and "," in last:
        tokens = last.split()
        apart = any(token.endswith(",") for token in tokens[:-1])
        if len(tokens) == 1 or (apart and "." in last):
            delimiter = ","
        elif apart:  # a comma and a blank between numbers with decimal commas
            written = [(number, _APART.sub("\t", line)) for number, line in written]
            delimiter = "\t"
    rows = []
    for number, line in written:
        cells = [cell.strip() for cell in split_cells(line, delimiter)]
        rows.append(_Row(number, cells[:-1] if cells and not cells[-1] else cells))
    width, start = len(rows[-1].cells), 0
    for index, row in enumerate(rows):
        if len(row.cells) > 1 and all(map(_is_number, row.cells)):
            start = index
            break
    for row in rows[:start]:  # a damaged row of numbers is no heading, but an axis may be one
        points = [cell.replace(",", ".") for cell in row.cells[1:]]
        even = len(points) > 1 and all(map(_reads, points))
        if even:
            steps = np.diff(np.array(points, float))
            mean = steps.mean()
            even = bool(np.all(np.abs(steps - mean) <= _EVEN * abs(mean)) and steps.any())
        numbers = sum(map(_is_number, row.cells))
        if len(row.cells) == width and 2 * numbers >= width and not even:
            _require_numbers(path, row)
    body = rows[start:]
    for row in body:
        _require_numbers(path, row)
        if len(row.cells) != len(body[0].cells):
            raise ConfigurationError(
                f"{path}:{row.line}: has {len(row.cells)} {what}, the first row has "
                f"{len(body[0].cells)}"
            )
    comments = [line for _, line in lines if is_comment(line)]
    values = _numbers(path, body, delimiter, what, comments)
    # The first row is an axis where it is far straighter than the rows below, and so is the first
    # column. A corner between both may hold anything.
    said = []
    across = any(_is_axis(values[0, corner:], values) for corner in (0, 1))
    down = any(_is_axis(values[corner:, 0], values.T) for corner in (0, 1))
    across &= down or values.shape[1] > _LEAST_AXIS
    if across:
        ends = values[0, [int(down), -1]]
        said.append(f"the first row, {ends[0]:g} to {ends[1]:g}, is an axis and is left out")
    if down:
        ends = values[[int(across), -1], 0]
        said.append(f"the first column, {ends[0]:g} to {ends[1]:g}, is an axis and is left out")
    above = tuple(line for number, line in lines if number < body[0].line)
    return NumberMatrix(values[int(across) :, int(down) :], above, tuple(said))


def _is_number(cell: str) -> bool:
    return _reads(cell) or _MARKED.fullmatch(cell) is not None


def _reads(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _require_numbers(path: Path, row: _Row) -> None:
    for cell in row.cells:
        if not _is_number(cell):
            raise ConfigurationError(f'{path}:{row.line}: "{cell[:_SHOWN]}" is not a number')


def _numbers(
    path: Path, body: list[_Row], delimiter: str | None, what: str, comments: list[str]
) -> np.ndarray:
    placed = [(row.line, cell) for row in body for cell in row.cells]
    cells = [cell for _, cell in placed]
    if delimiter == ",":
        proof = next((cell for cell in cells if _LEADING_ZERO.fullmatch(cell)), None)
        if proof is not None and not any("." in cell for cell in cells):
            raise ConfigurationError(
                f'{path}: cells such as "{proof}" between commas suggest decimal commas; write '
                "the file with another delimiter"
            )
    elif any("," in cell for cell in cells):
        stated = marks_of.stated_mark(comments)
        only_commas = not any("." in cell for cell in cells)
        if stated is None and only_commas and marks_of.shows_decimal(cells[:_HEAD], marks_of.COMMA):
            cells = [cell.replace(",", ".") for cell in cells]
        else:
            marks = (
                marks_of.find_marks(
                    str(path), {what: placed}, lambda _name, _value: True, say=False
                )
                if stated is None
                else marks_of.Marks(
                    stated, marks_of.POINT if stated == marks_of.COMMA else marks_of.COMMA
                )
            )
            numbers = [marks.number(cell) for cell in cells]
            cells = [
                cell if one is None else repr(one) for cell, one in zip(cells, numbers, strict=True)
            ]
    try:
        return np.array(cells).astype(float).reshape(len(body), -1)
    except ValueError:
        line, cell = placed[next(at for at, cell in enumerate(cells) if not _reads(cell))]
        raise ConfigurationError(f'{path}:{line}: "{cell[:_SHOWN]}" is not a number') from None


def _is_axis(first: np.ndarray, rows: np.ndarray) -> bool:
    """Whether a first row is evenly spaced, and the others are not; shape (n,) and (m, n)."""
    if len(rows) < 3 or len(first) < 3:
        return False
    if len(first) < _LEAST_AXIS:  # three heights may rise evenly by chance
        return first[0] in (0.0, 1.0) and bool(np.all(np.diff(first) == 1.0))
    bend = float(_bends(first[None])[0])
    others = float(np.median(_bends(rows[1:, 1:])))
    return bend * len(first) < _EVEN and others > _STRAIGHTER * bend and others * len(first) > _EVEN


def _bends(rows: np.ndarray) -> np.ndarray:
    """Largest distance of each row from its straight line over the row's rise, shape (m,)."""
    place = np.linspace(-1.0, 1.0, rows.shape[1])
    middle = rows.mean(axis=1, keepdims=True)
    slope = ((rows - middle) @ place / (place @ place))[:, None]
    away = np.abs(rows - middle - slope * place).max(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(away / (2.0 * np.abs(slope[:, 0])), nan=np.inf)
