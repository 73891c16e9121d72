"""Tables in text files: any delimiter, units in the header, faulty rows named with their line.

Two kinds of fault are told apart. A row that cannot be read (an empty cell, "OVLD", too few
values) is rejected and named; a strict reader refuses the file instead. A value that is impossible
(a negative irradiance, a unit inside a cell) refuses the file, because all of it is then in doubt.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.layout import (
    PREAMBLE,
    Column,
    Layout,
    Placed,
    find_layout,
    is_comment,
    names_columns,
    split_cells,
)
from lightflyer.foundation.text import read_text

_SMALLEST, _LARGEST = 1e-30, 1e30  # of measured values in any unit; powers of others overflow
_BLOCK = 50_000  # rows read at once; a block with a faulty row is read again row by row
_NUMBER_AND_UNIT = re.compile(r"^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*[A-Za-zµμ°Ω%/^]+")


class Rejected(NamedTuple):
    """A row that was rejected.

    Attributes
    ----------
    file : str
    line : int
        Counted from 1.
    reason : str
    """

    file: str
    line: int
    reason: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.reason}"


@dataclass(frozen=True)
class Table:
    """The columns that were read from a file.

    Attributes
    ----------
    source : str
        Name of the file.
    lines : array of int, shape (n,)
        Line of each row in the file, counted from 1.
    numbers : dict of str to array, shape (n,)
        Columns of numbers in SI units, by name.
    texts : dict of str to list of str
        Columns of text, by name.
    rejected : list of Rejected
        Rejected rows in the order of the file.
    unused : list of str
        Unknown columns of the file.
    """

    source: str
    lines: np.ndarray
    numbers: dict[str, np.ndarray]
    texts: dict[str, list[str]] = field(default_factory=dict)
    rejected: list[Rejected] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.lines)

    def without(self, reasons: dict[int, str]) -> "Table":
        """Reject further rows.

        Parameters
        ----------
        reasons : dict of int to str
            Reason by the index of the row.

        Returns
        -------
        Table
            Without these rows, which are added to the rejected ones.
        """
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
    unique: bool = False,
    strict: bool = False,
    closed: bool = False,
) -> Table:
    """Read the known columns of a text file.

    Parameters
    ----------
    path : str or path
        UTF-8 text, delimited by commas, semicolons, tabs or white space. Lines that start with
        ``#``, ``//`` or ``!`` are comments.
    columns : sequence of Column
        Known columns.
    layout : str, optional
        The columns in the order of the file, such as ``"pressure [mTorr], -, heater_power [W]"``,
        in place of its header; ``-`` skips a column.
    unique : bool
        Reject a line that repeats an earlier one. Always so where there is a column ``time``.
    strict : bool
        Refuse the file at the first row that cannot be read, and take its first line that is
        not a comment as the header. Otherwise the header may be a comment and stand below an
        instrument's preamble.
    closed : bool
        Refuse unknown columns.

    Returns
    -------
    Table

    Raises
    ------
    ConfigurationError
        One line that names the file and the line or option: not text, an unknown, missing or
        repeated column, a missing or wrong unit, an impossible value, or no row that can be read.
    """
    path = Path(path)
    text = read_text(path)
    lines = text.splitlines()
    found = find_layout(path, lines, columns, option=layout, strict=strict, closed=closed)
    empty = f"{found.delimiter} \t" if strict and found.delimiter else None  # as spreadsheets do
    rows = [
        (number, line)
        for number, line in enumerate(lines[found.first :], start=found.first + 1)
        if line.strip(empty) and not is_comment(line)
    ]
    if not rows:
        raise ConfigurationError(f"{path}: has a header but no rows")
    timed = any(one.column.name == "time" for one in found.columns.values())
    repeated = _repeated(path, rows) if unique or timed else {}
    _require_whole(path, rows, found, ended=text.endswith(("\n", "\r")))
    table = _read_rows(path, [row for row in rows if row[0] not in repeated], found)
    rejected = sorted([*table.rejected, *repeated.values()], key=lambda row: row.line)
    if strict and rejected:
        raise ConfigurationError(str(rejected[0]))
    table = _possible(replace(table, rejected=rejected), found)
    if not len(table):
        raise ConfigurationError(f"{table.rejected[0]}; none of its {len(rows)} rows can be read")
    return table


def shipped_table(name: str) -> Table:
    """Read a CSV file of the package's own data.

    Parameters
    ----------
    name : str
        File in ``lightflyer/data``, with comments, a header without units, and whole rows.

    Returns
    -------
    Table
        A column is one of numbers, as written, where all of its cells are; otherwise of text.

    Examples
    --------
    >>> shipped_table("us1976_upper.csv").numbers["altitude_km"][:2]
    array([86., 87.])
    """
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


def _repeated(path: Path, rows: list[tuple[int, str]]) -> dict[int, Rejected]:
    if len({line for _, line in rows}) == len(rows):
        return {}
    first: dict[str, int] = {}
    found = {}
    for number, line in rows:
        before = first.setdefault(line, number)
        if before != number:
            found[number] = Rejected(str(path), number, f"repeats line {before}")
    return found


def _require_whole(path: Path, rows: list[tuple[int, str]], layout: Layout, *, ended: bool) -> None:
    """Refuse a file that ends within a row: more than that row may be missing."""
    number, line = rows[-1]
    cells, width = split_cells(line, layout.delimiter), len(layout.names)
    # without a line end, an empty last cell has been cut off
    cut = not ended and len(cells) == width and not cells[-1] and width - 1 in layout.columns
    if (len(cells) < width or cut) and len(rows) > 1:
        before = len(split_cells(rows[-2][1], layout.delimiter))
        if before >= len(layout.names):
            raise ConfigurationError(
                f"{path}:{number}: the file ends within a row and is incomplete"
            )


def _read_rows(path: Path, rows: list[tuple[int, str]], layout: Layout) -> Table:
    known = layout.number_columns
    decimal_comma = layout.delimiter != "," and any("," in line for _, line in rows[:PREAMBLE])
    blocks, rejected = [], []
    texts: dict[str, list[str]] = {one.column.name: [] for one in layout.text_columns.values()}
    lines: list[np.ndarray] = []
    for block in _blocks(rows):
        values = None if texts else _read_block(block, layout, list(known), decimal_comma)
        numbers = [number for number, _ in block]
        if values is None:
            numbers, values, more, wrong = _read_slowly(path, block, layout, decimal_comma)
            rejected += wrong
            for name, cells in more.items():
                texts[name] += cells
        blocks.append(values)
        lines.append(np.array(numbers, int))
    stacked = np.concatenate(blocks) if blocks else np.empty((0, len(known)))
    return Table(
        source=str(path),
        lines=np.concatenate(lines),
        numbers={
            one.column.name: stacked[:, index] * one.scale + one.offset
            for index, one in enumerate(known.values())
        },
        texts=texts,
        rejected=rejected,
        unused=[
            name.strip()
            for position, name in enumerate(layout.names)
            if position not in layout.columns and name not in ("", "-")
        ],
    )


def _blocks(rows: list[tuple[int, str]]) -> Iterator[list[tuple[int, str]]]:
    for start in range(0, len(rows), _BLOCK):
        yield rows[start : start + _BLOCK]


def _read_block(
    block: list[tuple[int, str]], layout: Layout, positions: list[int], decimal_comma: bool
) -> np.ndarray | None:
    """All numbers of a block, or None where one of its rows must be looked at."""
    width, delimiter = len(layout.names), layout.delimiter
    lines = [line for _, line in block]
    if any(_count(line, delimiter) != width for line in lines):
        return None
    if decimal_comma:
        lines = [line.replace(",", ".") for line in lines]
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


def _count(line: str, delimiter: str | None) -> int:
    return len(line.split()) if delimiter is None else line.count(delimiter) + 1


def _read_slowly(
    path: Path, block: list[tuple[int, str]], layout: Layout, decimal_comma: bool
) -> tuple[list[int], np.ndarray, dict[str, list[str]], list[Rejected]]:
    """Line numbers, numbers and texts of the rows that can be read, and the other rows."""
    width = len(layout.names)
    numbers: list[int] = []
    values: list[list[float]] = []
    texts: dict[str, list[str]] = {one.column.name: [] for one in layout.text_columns.values()}
    rejected: list[Rejected] = []
    for number, line in block:
        cells = split_cells(line, layout.delimiter)
        if len(cells) == width + 1 and not cells[-1]:
            del cells[-1]
        if names_columns(layout, cells):
            raise ConfigurationError(
                f"{path}:{number}: is a second header: the rows below may have other units; "
                "split the file here"
            )
        if len(cells) != width:
            count = f"{len(cells)} value{'s' * (len(cells) != 1)}"
            reason = f"has {count}, the header names {width} columns"
            rejected.append(Rejected(str(path), number, reason))
            continue
        row, said = _read_row(cells, layout, decimal_comma, f"{path}:{number}")
        if isinstance(row, str):
            rejected.append(Rejected(str(path), number, row))
            continue
        numbers.append(number)
        values.append(row)
        for name, word in said.items():
            texts[name].append(word)
    shape = len(numbers), len(layout.number_columns)
    return numbers, np.array(values, float).reshape(shape), texts, rejected


def _read_row(
    cells: list[str], layout: Layout, decimal_comma: bool, place: str
) -> tuple[list[float] | str, dict[str, str]]:
    """Numbers and texts of a row; in place of the numbers, why it cannot be read."""
    row: list[float] = []
    said: dict[str, str] = {}
    for position, one in layout.columns.items():
        cell, column = cells[position], one.column
        if column.text:
            if not (cell or column.blank):
                raise ConfigurationError(f"{place}: {column.name} is empty")
            said[column.name] = cell
            continue
        try:
            value = float(cell.replace(",", ".") if decimal_comma else cell)
        except ValueError:
            if _NUMBER_AND_UNIT.match(cell):
                raise ConfigurationError(
                    f'{place}: {column.name}: "{cell}" is more than a number; the unit of a '
                    "column belongs in its header"
                ) from None
            return (f'{column.name}: "{cell}" is not a number' if cell
                    else f"{column.name} is empty"), said  # fmt: skip
        if not math.isfinite(value):
            return f"{column.name} is {cell}", said
        if abs(value) > _LARGEST or not _measurable(abs(value)):
            return f"{column.name} is {cell}, which is no measured value", said
        row.append(value)
    return row, said


def _possible(table: Table, layout: Layout) -> Table:
    """The table without gauges' readings below zero; other impossible values refuse it."""
    out: dict[int, str] = {}
    for one in layout.number_columns.values():
        column, quantity = one.column, one.column.quantity
        values = table.numbers[column.name]
        low = values <= quantity.lowest if quantity.open_below else values < quantity.lowest
        for row in np.flatnonzero(low | (values > quantity.highest)):
            reason = (
                f"{column.name} = {_written(float(values[row]), one)} is not {quantity.allowed}"
            )
            if column.outside == "stop":
                raise ConfigurationError(f"{table.source}:{table.lines[row]}: {reason}")
            out.setdefault(int(row), reason)
    return table.without(out) if out else table


def _written(value: float, one: Placed) -> str:
    """A value in the unit of the file."""
    return f"{(value - one.offset) / one.scale:g} {one.unit}".rstrip()
