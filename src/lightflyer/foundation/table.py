"""Reading tables that laboratories write: any delimiter, units in the header, rows with faults.

What a row can be missing is told apart from what it must not say. A row that cannot be read (an
empty cell, "OVLD", too few values) is left out and named; a value that cannot be true (a negative
irradiance, a unit in a cell) stops with one line, because the whole file is then in doubt.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lightflyer.foundation.checks import allowed
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.text import read_text
from lightflyer.lab.layout import (
    COMMENTS,
    PREAMBLE,
    Column,
    Layout,
    layout_from_header,
    layout_from_option,
    names_columns,
    split_cells,
)

_BLOCK = 50_000  # rows that are read in one go; one with a fault is read again row by row
_NUMBER_AND_UNIT = re.compile(r"^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?\s*[A-Za-zµμ°Ω%/^]+")


class Rejected(NamedTuple):
    """A row that was left out.

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
    """The rows of a file that could be read.

    Attributes
    ----------
    source : str
        Name of the file.
    lines : array of int, shape (n,)
        Line of the file that each row stands in, counted from 1.
    numbers : dict of str to array, shape (n,)
        Columns with numbers, in SI units, by name.
    texts : dict of str to list of str
        Columns with text, by name.
    rejected : list of Rejected
        Rows that were left out, in the order of the file.
    unused : list of str
        Columns of the file that nothing was read from.
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
        """The table less some rows, which are named among the rejected.

        Parameters
        ----------
        reasons : dict of int to str
            Why, by the row's number among those read, counted from 0.

        Returns
        -------
        Table
        """
        keep = np.ones(len(self), bool)
        keep[list(reasons)] = False
        out = [Rejected(self.source, int(self.lines[row]), why) for row, why in reasons.items()]
        return Table(
            source=self.source,
            lines=self.lines[keep],
            numbers={name: values[keep] for name, values in self.numbers.items()},
            texts={
                name: [value for value, kept in zip(values, keep, strict=True) if kept]
                for name, values in self.texts.items()
            },
            rejected=sorted([*self.rejected, *out], key=lambda row: row.line),
            unused=self.unused,
        )


def read_table(
    path: str | Path,
    columns: Sequence[Column],
    *,
    layout: str | None = None,
    unique: bool = False,
) -> Table:
    """Read the columns that a measurement knows.

    Parameters
    ----------
    path : str or path
        Text, UTF-8, with values delimited by commas, semicolons, tabs or white space. Lines
        that start with ``#``, ``//`` or ``!`` are comments; the header may be one.
    columns : sequence of Column
        What to look for.
    layout : str, optional
        The columns in the order of the file, such as ``"pressure [mTorr], -, heater_power [W]"``,
        in place of its header; ``-`` stands for a column to leave out.
    unique : bool
        Leave out a line that has stood before. Always so where there is a column ``time``.

    Returns
    -------
    Table

    Raises
    ------
    ConfigurationError
        One line that names file and line or option: no text, no known column, a unit that is
        missing, unknown or of another kind, an impossible value, or no row that can be read.
    """
    path = Path(path)
    text = read_text(path)
    lines = text.splitlines()
    found = layout_from_option(path, lines, columns, layout) if layout else None
    found = found or layout_from_header(path, lines, columns)
    rows = [
        (number, line)
        for number, line in enumerate(lines[found.first :], start=found.first + 1)
        if line.strip() and not line.lstrip().startswith(COMMENTS)
    ]
    if not rows:
        raise ConfigurationError(f"{path}: has a header but no rows")
    timed = any(column.name == "time" for column, _, _ in found.columns.values())
    repeated = _repeated(path, rows) if unique or timed else {}
    _require_whole(path, rows, found, ended=text.endswith(("\n", "\r")))
    kept = [row for row in rows if row[0] not in repeated]
    table = _read_rows(path, kept, found)
    rejected = sorted([*table.rejected, *repeated.values()], key=lambda row: row.line)
    if not len(table):
        raise ConfigurationError(f"{rejected[0]}; none of its {len(rows)} rows can be read")
    return Table(table.source, table.lines, table.numbers, table.texts, rejected, table.unused)


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
    """Stop at a file that ends within a row: more than that row may be missing."""
    number, line = rows[-1]
    cells, width = split_cells(line, layout.delimiter), len(layout.names)
    # without a line end, an empty last cell is one that was cut off
    cut = not ended and len(cells) == width and not cells[-1] and width - 1 in layout.columns
    if (len(cells) < width or cut) and len(rows) > 1:
        before = len(split_cells(rows[-2][1], layout.delimiter))
        if before >= len(layout.names):
            raise ConfigurationError(
                f"{path}:{number}: the file ends within a row: it is not whole"
            )


def _read_rows(path: Path, rows: list[tuple[int, str]], layout: Layout) -> Table:
    positions = {p: one for p, one in layout.columns.items() if not one[0].text}
    texts = {p: column for p, (column, _, _) in layout.columns.items() if column.text}
    decimal_comma = layout.delimiter != "," and any("," in line for _, line in rows[:PREAMBLE])
    blocks, rejected = [], []
    words: dict[str, list[str]] = {column.name: [] for column in texts.values()}
    lines: list[np.ndarray] = []
    for block in _blocks(rows):
        values = None if texts else _read_block(block, layout, list(positions), decimal_comma)
        numbers = [number for number, _ in block]
        if values is None:
            numbers, values, said, wrong = _read_slowly(path, block, layout, decimal_comma)
            rejected += wrong
            for name, more in said.items():
                words[name] += more
        blocks.append(values)
        lines.append(np.array(numbers, int))
    stacked = np.concatenate(blocks) if blocks else np.empty((0, len(positions)))
    table = Table(
        source=str(path),
        lines=np.concatenate(lines),
        numbers={
            column.name: stacked[:, index] * scale + offset
            for index, (column, scale, offset) in enumerate(positions.values())
        },
        texts=words,
        rejected=rejected,
        unused=[
            name.strip()
            for position, name in enumerate(layout.names)
            if position not in layout.columns and name not in ("", "-")
        ],
    )
    return _possible(table, [column for column, _, _ in positions.values()], str(path))


def _blocks(rows: list[tuple[int, str]]) -> Iterator[list[tuple[int, str]]]:
    for start in range(0, len(rows), _BLOCK):
        yield rows[start : start + _BLOCK]


def _read_block(
    block: list[tuple[int, str]], layout: Layout, positions: list[int], decimal_comma: bool
) -> np.ndarray | None:
    """All numbers of a block, or None where a row of it needs a closer look."""
    width, delimiter = len(layout.names), layout.delimiter
    lines = [line for _, line in block]
    if delimiter is not None and any(line.count(delimiter) != width - 1 for line in lines):
        return None
    if decimal_comma:
        lines = [line.replace(",", ".") for line in lines]
    try:
        values = np.loadtxt(
            lines, delimiter=delimiter, usecols=positions, comments=None, ndmin=2, dtype=float
        )
    except ValueError:
        return None
    if len(values) != len(block) or not np.isfinite(values).all():
        return None
    return values


def _read_slowly(
    path: Path, block: list[tuple[int, str]], layout: Layout, decimal_comma: bool
) -> tuple[list[int], np.ndarray, dict[str, list[str]], list[Rejected]]:
    """Line numbers, numbers and texts of the rows that can be read, and the other rows."""
    width = len(layout.names)
    numbers: list[int] = []
    values: list[list[float]] = []
    words: dict[str, list[str]] = {
        column.name: [] for column, _, _ in layout.columns.values() if column.text
    }
    rejected: list[Rejected] = []
    for number, line in block:
        cells = split_cells(line, layout.delimiter)
        if len(cells) == width + 1 and not cells[-1]:
            del cells[-1]
        if names_columns(layout, cells):
            raise ConfigurationError(
                f"{path}:{number}: names columns once more: rows below it may have other units; "
                "split the file there"
            )
        if len(cells) != width:
            reason = f"has {len(cells)} values, the header names {width} columns"
            rejected.append(Rejected(str(path), number, reason))
            continue
        row, said = _read_row(cells, layout, decimal_comma, f"{path}:{number}")
        if isinstance(row, str):
            rejected.append(Rejected(str(path), number, row))
            continue
        numbers.append(number)
        values.append(row)
        for name, word in said.items():
            words[name].append(word)
    count = sum(not column.text for column, _, _ in layout.columns.values())
    return numbers, np.array(values, float).reshape(-1, count), words, rejected


def _read_row(
    cells: list[str], layout: Layout, decimal_comma: bool, place: str
) -> tuple[list[float] | str, dict[str, str]]:
    """Numbers and texts of a row; in place of the numbers, why it cannot be read."""
    row: list[float] = []
    said: dict[str, str] = {}
    for position, (column, _, _) in layout.columns.items():
        cell = cells[position]
        if column.text:
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
        row.append(value)
    return row, said


def _possible(table: Table, columns: list[Column], path: str) -> Table:
    """The table without rows of gauges below their zero; stops at any other impossible value."""
    out: dict[int, str] = {}
    for column in columns:
        values = table.numbers[column.name]
        low = values <= column.lowest if column.open_below else values < column.lowest
        bad = low | (values > column.highest)
        for row in np.flatnonzero(bad):
            reason = f"{column.name} = {values[row]:g} {column.unit}".rstrip()
            reason += f" is not {allowed(column.lowest, column.highest, column.open_below)}"
            if column.outside == "stop":
                raise ConfigurationError(f"{path}:{table.lines[row]}: {reason}")
            out.setdefault(int(row), reason)
    return table.without(out) if out else table
