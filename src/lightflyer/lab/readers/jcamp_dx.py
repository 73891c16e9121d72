"""JCAMP-DX: infrared and UV-visible spectra, alone or in linked blocks; checksums are checked.

After [McDonaldWilks1988]_.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from lightflyer.lab.readers.formats import (
    MOST_POINTS,
    WORDS,
    RawSpectrum,
    Source,
    SpectrumMetadata,
    one_line,
)

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]\d{1,3}(?!\d))?"
_TOKEN = re.compile(
    rf"({_NUMBER})|([@A-Ia-i])([\d.]*)|([%J-Rj-r])([\d.]*)|([S-Zs])(\d*)|(\?)|[\s,;]+"
)
_PAIR_TOKEN = re.compile(rf"({_NUMBER})|(\?)|[\s,;()]+")
_SQUEEZED = {letter: str(digit) for digit, letter in enumerate("@ABCDEFGHI")} | {
    letter: f"-{digit}" for digit, letter in enumerate("abcdefghi", 1)
}
_DIFFERENCES = {letter: str(digit) for digit, letter in enumerate("%JKLMNOPQR")} | {
    letter: f"-{digit}" for digit, letter in enumerate("jklmnopqr", 1)
}
_DUPLICATES = {letter: str(digit) for digit, letter in enumerate("STUVWXYZs", 1)}
_CHECK = 0.5  # of the last digit, by which the repeated ordinate may differ
FORMAT = "JCAMP-DX"
_LABEL = re.compile(r"^\s*##([^=\n]{0,60})=(.*)$")
_START = re.compile(r"\s*(?:\$\$[^\n]*\n\s*)*##\s*(?:TITLE|JCAMP-?DX)\s*=", re.I)
_ROUNDED = 2e-3  # by which stated ordinates may differ from the data, of the largest


class Fault(Exception):  # noqa: N818
    """A table that cannot be read: what is wrong, and its line in the table, counted from 0."""

    def __init__(self, why: str, row: int) -> None:
        super().__init__(why)
        self.row = row


class OrdinateRows(NamedTuple):
    """A table of ordinates."""

    ordinate: np.ndarray  # shape (n,)
    abscissa: np.ndarray  # shape (m,); first one of each line
    place: np.ndarray  # shape (m,); index of the ordinate at it
    digit: np.ndarray  # shape (m,); unit of the last digit of the abscissa


def read_rows(lines: Sequence[str]) -> OrdinateRows:
    """Read a table ``(X++(Y..Y))``."""
    values: list[float] = []
    step: float | None = None  # the last difference
    starts: list[float] = []
    places: list[int] = []
    digits: list[float] = []
    for row, line in enumerate(lines):
        if not line.strip():
            continue
        match = re.match(rf"\s*({_NUMBER})", line)
        if match is None:
            raise Fault(f'"{line.strip()[:30]}" does not start with an abscissa', row)
        starts.append(float(match[1]))
        digits.append(last_digit(match[1]))
        repeated = step is not None  # after differences the first ordinate repeats the last one
        places.append(len(values) - repeated)
        at = match.end()
        while at < len(line):
            match = _TOKEN.match(line, at)
            if match is None:
                raise Fault(f'"{line[at : at + 20].strip()}" is no number of JCAMP-DX', row)
            at = match.end()
            number, squeezed, rest, difference, more, duplicate, count, missing = match.groups()
            if number or squeezed or missing:
                value = float(number or (_SQUEEZED[squeezed] + rest if squeezed else "nan"))
                step = None
                if not repeated:
                    values.append(value)
                elif not abs(value - values[-1]) <= _CHECK:
                    raise Fault(
                        f"fails its checksum: it starts with {value:g}, the line above ends at "
                        f"{values[-1]:g}", row,
                    )  # fmt: skip
                repeated = False
            elif difference:
                if not values:
                    raise Fault("starts with a difference", row)
                step = float(_DIFFERENCES[difference] + more)
                values.append(values[-1] + step)
            elif duplicate:
                times = int(_DUPLICATES[duplicate] + count[:12])
                if not values or times < 1:
                    raise Fault("repeats nothing", row)
                if len(values) + times > MOST_POINTS:
                    raise Fault("repeats a value too often", row)
                last = values[-1]
                values += [last + (step or 0.0) * (one + 1) for one in range(times - 1)]
    return OrdinateRows(np.array(values), np.array(starts), np.array(places, int), np.array(digits))


def last_digit(number: str) -> float:
    """Unit of the last digit of a number as it is written; 0 if it is none."""
    if not re.fullmatch(_NUMBER, number):
        return 0.0
    mantissa, _, exponent = number.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - decimals))


class _Label(NamedTuple):
    """Text of a label, with its line in the file counted from 1."""

    line: int
    text: str
    rows: list[str]  # below it, without comments


@dataclass
class _DataBlock:
    source: Source
    entries: dict[str, _Label] = field(default_factory=dict)

    def entry_of(self, label: str) -> str:
        entry = self.entries.get(label)
        return one_line(entry.text) if entry else ""

    def number(self, label: str) -> float | None:
        text = self.entry_of(label)
        if not text:
            return None
        try:
            value = float(text.split()[0].replace(",", "."))
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            self.source.refuse(
                f'##{label}= "{text[:20]}" is not a number', self.entries[label].line
            )
        return value

    def factor(self, label: str) -> float:
        value = self.number(label)
        if value == 0.0:
            self.source.refuse(f"##{label}= 0 is not a factor", self.entries[label].line)
        return 1.0 if value is None else value

    def require_count(self, count: int) -> None:
        text = self.entry_of("NPOINTS")
        if not text:
            return
        line = self.entries["NPOINTS"].line
        stated = float(text) if re.fullmatch(r"\d{1,12}(?:\.0*)?", text) else np.nan
        if not 0 <= stated <= MOST_POINTS:
            self.source.refuse(f'##NPOINTS= "{text[:20]}" is not a number of points', line)
        if stated != count:
            self.source.refuse(
                f"is damaged: ##NPOINTS= {stated:g}, but its table has {count} points", line
            )


def is_jcamp(source: Source) -> bool:
    """Whether a file is JCAMP-DX, by its name or its first label."""
    named = source.suffix in (".jdx", ".dx", ".jcamp", ".jcm")
    return named or bool(_START.match(source.text[:5000]))


def read_jcamp(source: Source) -> list[RawSpectrum]:
    """Read all spectra of a JCAMP-DX file."""
    text = source.text
    if not _START.match(text):
        source.refuse("is not JCAMP-DX: does not start with ##TITLE=", 1)
    found: list[RawSpectrum] = []
    others: list[str] = []
    for block in _blocks(source, text.splitlines()):
        # what a block holds; nothing where it only links others
        kind = f"{block.entry_of('DATATYPE')} {block.entry_of('DATACLASS')}".upper()
        tables = [one for label, one in WORDS["jcamp"]["tables"].items() if label in block.entries]
        named = [one for word, one in WORDS["jcamp"]["kinds"].items() if word in kind]
        what = named[0] if tables and named else next(iter(tables), "")
        if what == "a spectrum":
            found.append(_spectrum(source, block))
        elif what:
            others.append(what)
    left = " and ".join(dict.fromkeys(others))
    if not found:
        source.refuse(f"contains no spectrum{f', but {left}' if left else ''}")
    note = (f"{left} in the same file is left out",) if left else ()
    return [replace(one, notes=one.notes + note) for one in found]


def _blocks(source: Source, lines: list[str]) -> Iterator[_DataBlock]:
    opened: list[_DataBlock] = []
    entry: _Label | None = None
    ended = False
    for number, line in enumerate(lines, start=1):
        match = _LABEL.match(line)
        if match is None:
            if line.strip() and not line.lstrip().startswith("$$") and entry is not None:
                entry.rows.append(line.partition("$$")[0])
            elif entry is not None:
                entry.rows.append("")  # keeps the lines' numbers
            continue
        label = re.sub(r"[\s\-/_.]", "", match[1]).upper()
        entry = _Label(number, match[2].partition("$$")[0].strip(), [])
        if label == "TITLE" or not opened:
            opened.append(_DataBlock(source))
        if label == "END":
            yield opened.pop()
            ended, entry = not opened, None
            continue
        opened[-1].entries.setdefault(label, entry)
    if opened or not ended:
        source.refuse("ends without ##END=", len(lines))


def _spectrum(source: Source, block: _DataBlock) -> RawSpectrum:
    label = "XYDATA" if "XYDATA" in block.entries else "XYPOINTS"
    table = block.entries[label]
    form = re.sub(r"\s", "", table.text).upper()
    try:
        if re.fullmatch(r"\(X\+\+\(Y\.\.Y\)+", form):
            rows = read_rows(table.rows)
            y = rows.ordinate * block.factor("YFACTOR")
            x = _even(source, block, rows, table.line)
        elif form == "(XY..XY)":
            found: list[float] = []
            for row, line in enumerate(table.rows):
                at = 0
                while at < len(line):
                    match = _PAIR_TOKEN.match(line, at)
                    if match is None:
                        raise Fault(f'"{line[at : at + 20].strip()}" is not a number', row)
                    at = match.end()
                    if match[1] or match[2]:
                        found.append(float(match[1] or "nan"))
                if len(found) % 2:
                    raise Fault("has an abscissa without its ordinate", row)
            pairs = np.array(found).reshape(-1, 2)
            x, y = pairs[:, 0], pairs[:, 1]
            x, y = x * block.factor("XFACTOR"), y * block.factor("YFACTOR")
            block.require_count(len(x))
        else:
            source.refuse(
                f'"{one_line(table.text)[:40]}" is not (X++(Y..Y)) or (XY..XY)', table.line
            )
    except Fault as fault:
        source.refuse(str(fault), table.line + 1 + fault.row)
    notes = []
    for name, values in (
        {
            "FIRSTY": (y[0],),
            "MAXY": (np.nanmax(y), np.nanmin(y)),
            "MINY": (np.nanmin(y), np.nanmax(y)),
        }.items()
        if len(y)
        else ()
    ):
        said = block.number(name)
        tolerance = _ROUNDED * float(np.nanmax(np.abs(y))) + last_digit(block.entry_of(name))
        if said is not None and not any(abs(said - value) <= tolerance for value in values):
            notes.append(f"it says ##{name}= {said:g}, the data {values[0]:g}: was it edited?")
    unit = block.entry_of("XUNITS")
    resolution = block.entry_of("RESOLUTION")[:40]
    if resolution.replace(".", "").isdigit():
        resolution += f" {unit}"
    return RawSpectrum(
        x, y, unit, block.entry_of("YUNITS"),
        SpectrumMetadata(
            FORMAT,
            instrument=(block.entry_of("SPECTROMETERDATASYSTEM") or block.entry_of("ORIGIN"))[:80],
            resolution=resolution,
            accessory=block.entry_of("SAMPLINGPROCEDURE")[:80],
            sample=block.entry_of("TITLE")[:80],
            measured=(block.entry_of("LONGDATE") or block.entry_of("DATE"))[:40],
        ),
        notes=tuple(notes),
    )  # fmt: skip


def _even(source: Source, block: _DataBlock, rows: OrdinateRows, line: int) -> np.ndarray:
    """Abscissae at equal distances, which the first one of each line confirms."""
    count = len(rows.ordinate)
    block.require_count(count)
    if count < 2:
        source.refuse(f"has {count} points; a spectrum needs two or more", line)
    factor = block.factor("XFACTOR")
    first, last = block.number("FIRSTX"), block.number("LASTX")
    stated = rows.abscissa * factor
    if first is None:
        first = float(stated[0])
    if last is None:
        step = block.number("DELTAX")
        if step is None and len(stated) > 1 and rows.place[-1] > 0:
            step = float((stated[-1] - stated[0]) / rows.place[-1])
        if step is None:
            source.refuse("has neither ##LASTX= nor ##DELTAX=", line)
        last = first + step * (count - 1)
    x = np.linspace(first, last, count)
    # abscissae of lines are rounded, and some writers cut them off
    tolerance = abs(last - first) / (count - 1) + np.abs(factor) * rows.digit
    off = np.abs(stated - x[rows.place]) > tolerance
    if off.any():
        at = int(np.argmax(off))
        source.refuse(
            f"is damaged: a line starts at {stated[at]:g}, where the ends and the number of points "
            f"say {x[rows.place[at]]:g}", line
        )  # fmt: skip
    return x
