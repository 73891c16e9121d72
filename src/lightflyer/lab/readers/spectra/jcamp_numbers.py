"""Numbers of JCAMP-DX tables: free (AFFN), packed, squeezed, difference and duplicate forms.

After [McDonaldWilks1988]_. The checksums of the difference form are checked.
"""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lightflyer.lab.readers.spectra.raw import MOST_POINTS

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


class Fault(Exception):  # noqa: N818
    """A table that cannot be read: what is wrong, and its line in the table, counted from 0."""

    def __init__(self, why: str, row: int) -> None:
        super().__init__(why)
        self.row = row


class Rows(NamedTuple):
    """A table of ordinates."""

    ordinate: np.ndarray  # shape (n,)
    abscissa: np.ndarray  # shape (m,); first one of each line
    place: np.ndarray  # shape (m,); index of the ordinate at it
    digit: np.ndarray  # shape (m,); unit of the last digit of the abscissa


class _State:
    """Ordinates read so far, and the last difference."""

    def __init__(self) -> None:
        self.values: list[float] = []
        self.difference: float | None = None


def read_rows(lines: Sequence[str]) -> Rows:
    """Read a table ``(X++(Y..Y))``."""
    state = _State()
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
        checked = state.difference is not None
        places.append(len(state.values) - checked)
        _read_line(state, line[match.end() :], row, checked=checked)
    return Rows(np.array(state.values), np.array(starts), np.array(places, int), np.array(digits))


def last_digit(number: str) -> float:
    """Unit of the last digit of a number as it is written; 0 if it is none."""
    if not re.fullmatch(_NUMBER, number):
        return 0.0
    mantissa, _, exponent = number.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(10.0 ** (int(exponent or 0) - decimals))


def _read_line(state: _State, text: str, row: int, *, checked: bool) -> None:
    """Read the ordinates of a line; the first one repeats the last of a line with differences."""
    at = 0
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise Fault(f'"{text[at : at + 20].strip()}" is no number of JCAMP-DX', row)
        at = match.end()
        number, squeezed, rest, difference, more, duplicate, count, missing = match.groups()
        if number or squeezed or missing:
            value = float(number or (_SQUEEZED[squeezed] + rest if squeezed else "nan"))
            state.difference = None
            if checked:
                _check(state, value, row)
                checked = False
                continue
            state.values.append(value)
        elif difference:
            if not state.values:
                raise Fault("starts with a difference", row)
            state.difference = float(_DIFFERENCES[difference] + more)
            state.values.append(state.values[-1] + state.difference)
        elif duplicate:
            _repeat(state, int(_DUPLICATES[duplicate] + count[:12]), row)


def _check(state: _State, value: float, row: int) -> None:
    last = state.values[-1]
    if not abs(value - last) <= _CHECK:
        raise Fault(
            f"fails its checksum: it starts with {value:g}, the line above ends at {last:g}", row
        )


def _repeat(state: _State, count: int, row: int) -> None:
    if not state.values or count < 1:
        raise Fault("repeats nothing", row)
    if len(state.values) + count > MOST_POINTS:
        raise Fault("repeats a value too often", row)
    step = state.difference or 0.0
    last = state.values[-1]
    state.values += [last + step * (number + 1) for number in range(count - 1)]


def read_pairs(lines: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Read a table ``(XY..XY)``, shape (n,)."""
    found: list[float] = []
    for row, line in enumerate(lines):
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
    return pairs[:, 0], pairs[:, 1]
