"""Decimal and thousands marks of the numbers in a table.

``1,469`` is 1469 in one country and 1.469 in another. Marks are decided once for a file, from all
of its numbers: in a file a mark is a decimal mark or a thousands mark, never both.

- ``0.5``, ``12.25``, ``1234.567`` and ``1.5e3`` show a decimal mark: thousands are grouped by
  three, and the first group does not lead with zero.
- ``1,234,567`` and ``1,234.5`` show a thousands mark.
- ``1,469`` shows nothing. Where no other number of the file settles its mark, it is settled by the
  values that are possible and by structure (see :func:`find_marks`), by a line
  ``# decimal: point`` of the file, or not at all: then the file is refused.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

from lightflyer.core.errors import ConfigurationError

Cells = Sequence[tuple[int, str]]  # Cells of a column, each with its line

POINT, COMMA = ".", ","
SPACES = " \N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{THIN SPACE}"
APOSTROPHES = "'\N{RIGHT SINGLE QUOTATION MARK}"

_NAMES = {POINT: "point", COMMA: "comma"}
_GROUPERS = SPACES + APOSTROPHES
_NUMBER = re.compile(rf"([-+]?)([\d.,{_GROUPERS}]*)(?:[eEdD]([-+]?\d+))?", re.ASCII)
_SHOWN = re.compile(r"^\s*[#!/]*\s*decimal(?:\s+mark)?\s*[:=]\s*(\w+|[.,])\s*[;,\t]*\s*$", re.I)
_WORDS = {"point": POINT, "dot": POINT, ".": POINT, "comma": COMMA, ",": COMMA}
_GROUP = 3  # digits between thousands marks


class Number(NamedTuple):
    """A number as it is written."""

    sign: str  # Digits without marks. Of a number that is open, those before and after its mark
    whole: str
    fraction: str
    exponent: str
    decimal: str = ""  # Marks that the number itself shows, empty where it shows none
    thousands: str = ""
    open: str = ""  # Mark that may be either

    def value(self, *, grouped: bool = False) -> float:
        """The number, with its open mark as a decimal mark or between thousands."""
        point = "" if self.open and grouped else "."
        return float(f"{self.sign}{self.whole}{point}{self.fraction}e{self.exponent or 0}")


class Marks(NamedTuple):
    """Marks of a file."""

    decimal: str = POINT  # Decimal marks; more than one where columns differ
    thousands: str = ""  # Marks between thousands
    notes: tuple[str, ...] = ()  # What a reader of the values must know, one line each

    def number(self, cell: str) -> float | None:
        """Value of a cell, None if it is no number with these marks."""
        written = split_number(cell)
        if written is None:
            return None
        if written.decimal and written.decimal not in self.decimal:
            return None
        if written.thousands and written.thousands not in self.thousands + APOSTROPHES + SPACES[1:]:
            return None
        if written.open and written.open not in self.decimal + self.thousands:
            return None
        return written.value(grouped=written.open in self.thousands)


def split_number(cell: str) -> Number | None:
    """Parts and marks of a number; none if it is no number, whatever its marks mean."""
    match = _NUMBER.fullmatch(cell.replace("\N{MINUS SIGN}", "-"))
    if match is None:
        return None
    sign, body, exponent = match[1], match[2], match[3] or ""
    marks = [one for one in body if not one.isdigit()]
    if not marks:
        return Number(sign, body, "", exponent) if body else None
    last = marks[-1]
    if len(set(marks)) > 2 or (len(marks) > 1 and marks.count(last) > 1 and len(set(marks)) > 1):
        return None
    if len(marks) > 1 and len(set(marks)) == 1:
        whole = _ungroup(body, last)
        return None if whole is None or exponent else Number(sign, whole, "", "", "", last)
    before, after = body.rsplit(last, 1)
    if len(marks) == 1:
        grouped = not exponent and _ungroup(f"{before}{last}{after}", last) is not None
        if last in _NAMES:
            if not (before or after) or (last == COMMA and not after):
                return None
            if grouped:
                return Number(sign, before, after, "", open=last)
            return Number(sign, before, after, exponent, decimal=last)
        if not grouped:
            return None
        if last == SPACES[0]:  # may also be a lost delimiter
            return Number(sign, before, after, "", open=last)
        return Number(sign, before + after, "", "", thousands=last)
    whole = _ungroup(before, marks[0])
    if whole is None or last not in _NAMES or (last == COMMA and not after):
        return None
    return Number(sign, whole, after, exponent, last, marks[0])


def _ungroup(body: str, mark: str) -> str | None:
    """Digits of a number in groups of three, None if it is in none."""
    first, *rest = body.split(mark)
    if not 1 <= len(first) <= _GROUP or first.startswith("0"):
        return None
    return None if any(len(group) != _GROUP for group in rest) else "".join([first, *rest])


def stated_mark(lines: Iterable[str]) -> str | None:
    """Decimal mark that a file states, as in ``# decimal: comma``."""
    for line in lines:
        match = _SHOWN.match(line)
        if match and match[1].lower() in _WORDS:
            return _WORDS[match[1].lower()]
    return None


class _Evidence:
    """What the numbers of a file show: for each mark its uses, each with place and cell."""

    def __init__(self, source: str, columns: Mapping[str, Cells]):
        self.source = source
        self.decimal: dict[str, tuple[int, str]] = {}
        self.thousands: dict[str, tuple[int, str]] = {}
        self.open: dict[str, dict[str, list[tuple[int, Number]]]] = {}
        self.numbers: dict[str, list[Number]] = {name: [] for name in columns}
        for name, cells in columns.items():
            for line, cell in cells:
                number = split_number(cell)
                if number is not None:
                    self.numbers[name].append(number)
                    if number.decimal:
                        self.decimal.setdefault(number.decimal, (line, cell))
                    if number.thousands:
                        self.thousands.setdefault(number.thousands, (line, cell))
                    if number.open:
                        self.open.setdefault(number.open, {}).setdefault(name, []).append(
                            (line, number)
                        )
            if {one.decimal for one in self.numbers[name]} >= {POINT, COMMA}:
                self._contradict(self.decimal[COMMA], self.decimal[POINT])
        for mark in set(self.thousands) & set(self.decimal):
            self._contradict(self.thousands[mark], self.decimal[mark])
        if {POINT, COMMA} <= set(self.thousands):
            self._contradict(self.thousands[POINT], self.thousands[COMMA])

    def _contradict(self, one: tuple[int, str], other: tuple[int, str]) -> None:
        raise ConfigurationError(
            f'{self.source}:{one[0]}: "{one[1]}" has other marks than "{other[1]}" in line '
            f"{other[0]}; write the file with one decimal mark"
        )

    def continues(self, mark: str) -> bool:
        """Whether in each column whole numbers have the mark from the fourth digit on."""
        for name in self.open[mark]:
            others = [one for one in self.numbers[name] if one.open != mark]
            if any(one.decimal or one.open or one.exponent for one in others):
                return False
            if max((len(one.whole) for one in others if not one.thousands), default=0) != _GROUP:
                return False
        return True

    def impossible(
        self, mark: str, possible: Callable[[str, float], bool], *, grouped: bool
    ) -> bool:
        """Whether most numbers with an open mark are impossible in one reading."""
        numbers = [(name, one) for name, cells in self.open[mark].items() for _, one in cells]
        bad = sum(not possible(name, one.value(grouped=grouped)) for name, one in numbers)
        return mark in _NAMES and 2 * bad > len(numbers)

    def readings(self, mark: str, *, grouped: bool) -> list[str]:
        """How the first number with an open mark is read in each column."""
        return [
            f'{self.source}:{line}: {name}: "{_number_text(one)}" is read as '
            f"{one.value(grouped=grouped):.15g}"
            for name, ((line, one), *_) in self.open[mark].items()
        ]


def shows_decimal(cells: Iterable[str], mark: str) -> bool:
    """Whether one of some numbers shows a decimal mark."""
    return any(number.decimal == mark for number in map(split_number, cells) if number)


def find_marks(
    source: str,
    columns: Mapping[str, Cells],
    possible: Callable[[str, float], bool],
    *,
    by_commas: bool = False,
    in_sheet: bool = False,
    say: bool = True,
) -> Marks:
    """Marks of a file, from all of its numbers; ``source``: name of the file, for messages."""
    # A mark whose use no number shows is settled by the first of these that applies:
    #
    # - Most of its numbers are possible values of their columns in one reading only.
    # - It is a comma, the point is the decimal mark (or the other way round), and in each of its
    #   columns whole numbers of three digits have no mark and longer ones have it. It groups
    #   thousands then, and a note says so.
    # - It is a point, and commas delimit the cells: a decimal mark, as a note says, unless whole
    #   numbers of three digits have none.
    found = _Evidence(source, columns)
    decimal, thousands = "".join(found.decimal), "".join(found.thousands)
    if in_sheet and POINT not in decimal:
        decimal += POINT
    for mark in set(found.open) - set(decimal + thousands):
        if found.impossible(mark, possible, grouped=True):
            decimal += mark
        elif found.impossible(mark, possible, grouped=False):
            thousands += mark
    if not decimal and {POINT, COMMA} & set(thousands):
        # a file groups thousands by one mark only
        decimal = COMMA if POINT in thousands else POINT
    notes: list[str] = []
    order = (POINT if by_commas else COMMA) + POINT + COMMA + SPACES[0]
    for mark in sorted(set(found.open) - set(decimal + thousands), key=order.find):
        continues = found.continues(mark)
        if by_commas and mark == POINT and not decimal and not continues:
            decimal = POINT
        elif continues and say and (decimal or (by_commas and mark == COMMA)):
            thousands += mark
        else:
            name, ((line, number), *_) = next(iter(found.open[mark].items()))
            one, two = number.value(grouped=True), number.value()
            said = f'{source}:{line}: {name}: "{_number_text(number)}" may be {one:.15g} or '
            if mark not in _NAMES:
                raise ConfigurationError(f"{said}two numbers; write {one:.15g}")
            raise ConfigurationError(
                f'{said}{two:g}; write a line "# decimal: point" or "# decimal: comma" above the '
                "header"
            )
        notes += found.readings(mark, grouped=mark in thousands)
    return Marks(decimal or POINT, thousands, tuple(notes))


def _number_text(number: Number) -> str:
    return f"{number.sign}{number.whole}{number.open}{number.fraction}"
