"""Formats of raw files: how each is recognised, what reads it, and whether a TIFF is sound.

A matrix of numbers in a text file or workbook may be a height map or a thermal image.
"""

import re
import struct
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple, NoReturn

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import load_plugins
from lightflyer.core.text import read_content
from lightflyer.files import number_marks as marks_of
from lightflyer.files.table_file import read_lines
from lightflyer.files.table_layout import is_comment, split_cells
from lightflyer.files.table_rows import Rejected

WORDS: dict[str, Any] = tomllib.loads(
    (Path(__file__).parents[2] / "data" / "instruments.toml").read_text(encoding="utf-8")
)
"""What files of instruments call things, and codes that their makers use."""

_ORDERS = {b"II*\0": "<", b"MM\0*": ">"}
_ENTRY = "HHII"  # code, type, count, value or its place
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4}
"""Bytes of a value of each type, by TIFF 6.0."""
_MOST_PAGES = 1000
_PIXELS = (256, 257)  # codes of width and length

_LEADING_ZERO = re.compile(r"[+-]?0\d+")
_MARKED = re.compile(r"[+-]?\d[\d.,]*(e[+-]?\d+)?|[+-]?,\d+", re.I)
_APART = re.compile(r"\s*,\s+")
_HEAD = 1000  # cells in which a mark may show what it is
_LEAST_AXIS = 8  # numbers; fewer are one where they count 0, 1, 2 or 1, 2, 3
_EVEN = 0.2  # of a step, by which the numbers of an axis may be rounded
_STRAIGHTER = 10.0  # times, that an axis is than the numbers beside it
_SHOWN = 40  # characters of a cell or line in a message


class Source(NamedTuple):
    """A file with its content."""

    path: Path
    content: bytes

    @property
    def text(self) -> str:
        """The content as text."""
        # Unicode marked by a byte-order mark, UTF-8, Shift-JIS as JASCO writes it, else cp1252.
        if self.content.startswith((b"\xff\xfe", b"\xfe\xff")):
            return self.content.decode("utf-16", "replace")
        for encoding in ("utf-8-sig", "cp932"):
            try:
                return self.content.decode(encoding)
            except UnicodeDecodeError:
                continue
        return self.content.decode("cp1252", "replace")

    @property
    def suffix(self) -> str:
        """End of the file's name in small letters, such as ``".csv"``."""
        return self.path.suffix.lower()

    def refuse(self, why: str, line: int | None = None) -> NoReturn:
        """Raise :class:`ConfigurationError`; ``why``: what is wrong; ``line``: counted from 1."""
        place = f"{self.path}" if line is None else f"{self.path}:{line}"
        raise ConfigurationError(f"{place}: {one_line(why)}")


class Format(NamedTuple):
    """A format of spectra, height maps or thermal images."""

    name: str  #: Such as ``"JASCO text"``
    recognises: Callable[[Source], bool]  #: Whether a :class:`Source` is of this format
    #: What a :class:`Source` holds: a list of :class:`RawSpectrum`, a list of :class:`Channel`, or
    #: a :class:`ThermalImage`
    read: Callable[..., Any]
    #: Options of :func:`read_thermal_image` that ``read`` takes by name
    options: tuple[str, ...] = ()


def has_suffix(*suffixes: str) -> Callable[[Source], bool]:
    """How a format is recognised by the file's name."""
    return lambda source: source.suffix in suffixes


def starts_with(magic: bytes) -> Callable[[Source], bool]:
    """How a format is recognised by its first bytes."""
    return lambda source: source.content.startswith(magic)


def read_source(path: Path) -> Source:
    """A file with its content; ConfigurationError if it cannot be read."""
    return Source(path, read_content(path))


def find_format(source: Source, formats: Sequence[Format]) -> Format | None:
    """The first format that knows a file; a plug-in puts its own before or behind the others."""
    load_plugins()
    return next((one for one in formats if one.recognises(source)), None)


def reason(error: Exception) -> str:
    """What another package's reader says of a damaged file."""
    return f"it is damaged: {one_line(str(error)) or type(error).__name__}"


def one_line(text: str) -> str:
    """Words with single spaces and without characters that cannot be printed."""
    return " ".join("".join(one if one.isprintable() else " " for one in text).split())


def require_sound_tiff(content: bytes) -> None:
    """Check the directories of a classic TIFF file."""
    order = _ORDERS.get(content[:4])
    if order is None or len(content) < 8:
        raise ValueError("not a TIFF file")
    seen: set[int] = set()
    place = struct.unpack_from(order + "I", content, 4)[0]
    while place:
        if place in seen or len(seen) >= _MOST_PAGES:
            raise ValueError("its directories go round in a circle")
        seen.add(place)
        if place + 2 > len(content):
            raise ValueError("a directory lies beyond the end of the file")
        count = struct.unpack_from(order + "H", content, place)[0]
        size = struct.calcsize(order + _ENTRY)
        end = place + 2 + count * size
        if end + 4 > len(content):
            raise ValueError("a directory is longer than the file")
        pixels = 1
        for start in range(place + 2, end, size):
            code, kind, values, where = struct.unpack_from(order + _ENTRY, content, start)
            if kind not in _SIZES:
                raise ValueError(f"entry {code} has the unknown type {kind}")
            held = values * _SIZES[kind]
            if held > 4 and where + held > len(content):
                raise ValueError(f"entry {code} lies beyond the end of the file")
            if code in _PIXELS and kind in (3, 4):
                short = struct.unpack_from(order + "H", content, start + 8)[0]
                pixels *= short if kind == 3 else where
        if pixels > 64 * len(content):  # compressed images hold more pixels than bytes
            raise ValueError("an image is larger than the file")
        place = int(struct.unpack_from(order + "I", content, end)[0])


Ordinate = Literal["transmittance", "reflectance"]  # Quantity that a spectrum shows

Collection = Literal["specular", "diffuse", "total"]
"""Light that was collected: the specular beam, what is scattered around it, or both."""

MOST_POINTS = 20_000_000  # Points of a spectrum beyond which a file is taken as damaged


@dataclass(frozen=True)
class SpectrumMetadata(ShortRepr):
    """What a file says of its spectrum, in the file's own words; empty where it says nothing."""

    format: str  #: Such as ``"JASCO text"``
    ordinate: str = ""  #: Such as ``"%T"``
    instrument: str = ""
    resolution: str = ""  #: With its unit, such as ``"4 cm-1"``
    accessory: str = ""
    sample: str = ""
    measured: str = ""  #: Date of the measurement


@dataclass(frozen=True)
class RawSpectrum(ShortRepr):
    """A spectrum as it stands in its file."""

    abscissa: np.ndarray  #: shape (n,); in the file's units
    ordinate: np.ndarray  #: shape (n,); in the file's units
    abscissa_name: str  #: Such as ``"1/CM"`` or ``"nm"``
    ordinate_name: str  #: Such as ``"%T"``
    metadata: SpectrumMetadata
    #: Whether the format fixes the ordinate as per cent, or as a fraction; None if its name and
    #: values must tell
    percent: bool | None = None
    notes: tuple[str, ...] = ()  #: What the reader decided
    rejected: tuple[Rejected, ...] = field(default=())  #: Rejected rows


def plain(text: bytes, encoding: str = "utf-8") -> str:
    """Words from a field of fixed width: up to its first zero byte, on one line."""
    words = text.partition(b"\x00")[0]
    try:
        return one_line(words.decode(encoding))
    except UnicodeDecodeError:
        return one_line(words.decode("cp1252", "replace"))


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
