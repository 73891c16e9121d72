"""JCAMP-DX: infrared and UV-visible spectra, alone or in linked blocks.

After [McDonaldWilks1988]_.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from lightflyer.lab.readers.formats import Source, one_line
from lightflyer.lab.readers.spectra.jcamp_numbers import (
    Fault,
    Rows,
    last_digit,
    read_pairs,
    read_rows,
)
from lightflyer.lab.readers.spectra.raw import MOST_POINTS, RawSpectrum, SpectrumMetadata

FORMAT = "JCAMP-DX"

_LABEL = re.compile(r"^\s*##([^=\n]{0,60})=(.*)$")
_START = re.compile(r"\s*(?:\$\$[^\n]*\n\s*)*##\s*(?:TITLE|JCAMP-?DX)\s*=", re.I)
_TABLES = {"XYDATA": "a spectrum", "XYPOINTS": "a spectrum", "PEAKTABLE": "a peak table",
           "PEAKASSIGNMENTS": "a peak table", "NTUPLES": "an NTUPLES table",
           "DATATABLE": "an NTUPLES table", "PAGE": "an NTUPLES table"}  # fmt: skip
_KINDS = (("PEAK", "a peak table"), ("RAMAN", "a Raman spectrum"), ("MASS", "a mass spectrum"),
          ("NMR", "an NMR spectrum"), ("INTERFEROGRAM", "an interferogram"))  # fmt: skip
_ROUNDED = 2e-3  # by which stated ordinates may differ from the data, of the largest


class _Entry(NamedTuple):
    """Text of a label, with its line in the file counted from 1."""

    line: int
    text: str
    rows: list[str]  # below it, without comments


@dataclass
class _Block:
    line: int
    entries: dict[str, _Entry] = field(default_factory=dict)

    def entry_of(self, label: str) -> str:
        entry = self.entries.get(label)
        return one_line(entry.text) if entry else ""


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
        what = _what(block)
        if what == "a spectrum":
            found.append(_spectrum(source, block))
        elif what:
            others.append(what)
    left = " and ".join(dict.fromkeys(others))
    if not found:
        source.refuse(f"contains no spectrum{f', but {left}' if left else ''}")
    note = (f"{left} in the same file is left out",) if left else ()
    return [replace(one, notes=one.notes + note) for one in found]


def _blocks(source: Source, lines: list[str]) -> Iterator[_Block]:
    """Blocks that hold data, each closed by its ``##END=``."""
    opened: list[_Block] = []
    entry: _Entry | None = None
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
        entry = _Entry(number, match[2].partition("$$")[0].strip(), [])
        if label == "TITLE" or not opened:
            opened.append(_Block(number))
        if label == "END":
            yield opened.pop()
            ended, entry = not opened, None
            continue
        opened[-1].entries.setdefault(label, entry)
    if opened or not ended:
        source.refuse("ends without ##END=", len(lines))


def _what(block: _Block) -> str:
    """What a block holds; empty for one that only links others."""
    kind = f"{block.entry_of('DATATYPE')} {block.entry_of('DATACLASS')}".upper()
    tables = [what for label, what in _TABLES.items() if label in block.entries]
    named = [what for word, what in _KINDS if word in kind]
    return named[0] if tables and named else next(iter(tables), "")


def _spectrum(source: Source, block: _Block) -> RawSpectrum:
    label = "XYDATA" if "XYDATA" in block.entries else "XYPOINTS"
    table = block.entries[label]
    form = re.sub(r"\s", "", table.text).upper()
    try:
        if re.fullmatch(r"\(X\+\+\(Y\.\.Y\)+", form):
            rows = read_rows(table.rows)
            y = rows.ordinate * _factor(source, block, "YFACTOR")
            x = _even(source, block, rows, table.line)
        elif form == "(XY..XY)":
            x, y = read_pairs(table.rows)
            x, y = x * _factor(source, block, "XFACTOR"), y * _factor(source, block, "YFACTOR")
            _count(source, block, len(x))
        else:
            said = one_line(table.text)[:40]
            source.refuse(f'"{said}" is not (X++(Y..Y)) or (XY..XY)', table.line)
    except Fault as fault:
        source.refuse(str(fault), table.line + 1 + fault.row)
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
        notes=tuple(_extremes(source, block, y)),
    )  # fmt: skip


def _number(source: Source, block: _Block, label: str) -> float | None:
    """Number of a label, None if the label is missing."""
    text = block.entry_of(label)
    if not text:
        return None
    try:
        value = float(text.split()[0].replace(",", "."))
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        source.refuse(f'##{label}= "{text[:20]}" is not a number', block.entries[label].line)
    return value


def _factor(source: Source, block: _Block, label: str) -> float:
    value = _number(source, block, label)
    if value == 0.0:
        source.refuse(f"##{label}= 0 is not a factor", block.entries[label].line)
    return 1.0 if value is None else value


def _count(source: Source, block: _Block, count: int) -> None:
    """The stated number of points, if any, is that of the table."""
    text = block.entry_of("NPOINTS")
    if not text:
        return
    stated = float(text) if re.fullmatch(r"\d{1,12}(?:\.0*)?", text) else np.nan
    if not 0 <= stated <= MOST_POINTS:
        source.refuse(f'##NPOINTS= "{text[:20]}" is not a number of points',
                      block.entries["NPOINTS"].line)  # fmt: skip
    if stated != count:
        source.refuse(
            f"is damaged: ##NPOINTS= {stated:g}, but its table has {count} points",
            block.entries["NPOINTS"].line,
        )


def _even(source: Source, block: _Block, rows: Rows, line: int) -> np.ndarray:
    """Abscissae at equal distances, which the first one of each line confirms."""
    count = len(rows.ordinate)
    _count(source, block, count)
    if count < 2:
        source.refuse(f"has {count} points; a spectrum needs two or more", line)
    factor = _factor(source, block, "XFACTOR")
    first, last = _number(source, block, "FIRSTX"), _number(source, block, "LASTX")
    stated = rows.abscissa * factor
    if first is None:
        first = float(stated[0])
    if last is None:
        step = _number(source, block, "DELTAX")
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


def _extremes(source: Source, block: _Block, y: np.ndarray) -> list[str]:
    """Notes where stated ordinates are not those of the data."""
    if not len(y):
        return []
    found = []
    ends = {"FIRSTY": (y[0],), "MAXY": (np.nanmax(y), np.nanmin(y)),
            "MINY": (np.nanmin(y), np.nanmax(y))}  # fmt: skip
    for label, values in ends.items():
        said = _number(source, block, label)
        tolerance = _ROUNDED * float(np.nanmax(np.abs(y))) + last_digit(block.entry_of(label))
        if said is not None and not any(abs(said - value) <= tolerance for value in values):
            found.append(f"it says ##{label}= {said:g}, the data {values[0]:g}: was it edited?")
    return found
