"""Files that hold tables, text or workbook, as lines of text."""

import re
from pathlib import Path
from typing import NamedTuple

from lightflyer.core.errors import ConfigurationError
from lightflyer.files.encoding import plain_text, read_bytes, split_lines
from lightflyer.files.workbook import DELIMITER, SHEET, is_workbook, read_sheets, split_sheet

_SEPARATOR = re.compile(r'^"?sep=(.)"?$', re.I)  # first line, for a spreadsheet


class Lines(NamedTuple):
    """Lines of a table."""

    name: str  # Name of the file, with that of the sheet where there are several
    lines: list[str]
    ended: bool = True  # Whether the last line has an end
    delimiter: str | None = None  # Delimiter that the file states
    is_sheet: bool = False  # Whether they are of a workbook, whose numbers have decimal points


def read_lines(path: Path) -> list[Lines]:
    """Tables that a file may hold; one, or one for each sheet of a workbook that holds anything."""
    if path.suffix == ".toml":
        raise ConfigurationError(f"{path}: is a TOML file, such as a flyer's, not a table")
    book, sheet = split_sheet(path)
    content = read_bytes(book)
    if is_workbook(content, str(book)):
        return _read_workbook(content, str(book), sheet)
    text = plain_text(content, str(path))
    lines, delimiter = split_lines(text), None
    stated = _SEPARATOR.match(lines[0]) if lines else None
    if stated:
        lines[0], delimiter = "", stated[1]
    return [Lines(str(path), lines, text.endswith(("\n", "\r")), delimiter)]


def _read_workbook(content: bytes, name: str, sheet: str | None) -> list[Lines]:
    sheets = read_sheets(content, name)
    if sheet is not None and sheet not in sheets:
        known = ", ".join(f'"{one}"' for one in sheets)
        raise ConfigurationError(f'{name}: has no table in a sheet "{sheet}"; it has {known}')
    several = len(sheets) > 1
    return [
        Lines(f"{name}{SHEET}{title}" if several else name, lines, True, DELIMITER, True)
        for title, lines in sheets.items()
        if sheet in (None, title)
    ]
