"""Files that hold tables as lines of text; sheets of a workbook (``.xlsx``) become lines too."""

import codecs
import csv
import datetime
import io
import re
import warnings
import zipfile
from pathlib import Path
from typing import Any, NamedTuple

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra
from lightflyer.core.text import read_content
from lightflyer.files.number_marks import split_number

_MARKED = (  # UTF-32 first: its mark begins with that of UTF-16
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_LOOKED_AT = 4096  # bytes from which UTF-16 without a mark is told
_LEAST = 4  # letters
_MANY, _FEW = 0.4, 0.05  # of zeros on one side of UTF-16 in western scripts, and on the other
_LINE_END = re.compile(r"\r\n|\n|\r")
_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f\x7f]")
_DOS_END = "\x1a"
_BYTE_ORDER_MARK = "\N{ZERO WIDTH NO-BREAK SPACE}"


def plain_text(content: bytes, name: str) -> str:
    """Text of the content of a file; ``name``: name of the file, for messages."""
    text = _decode(content, name).removeprefix(_BYTE_ORDER_MARK).removesuffix(_DOS_END)
    control = _CONTROL.search(text)
    if control:
        line = len(split_lines(text[: control.start() + 1]))
        what = "zero bytes" if control[0] == "\0" else f"the control character {control[0]!r}"
        raise ConfigurationError(f"{name}:{line}: is not a text file, or damaged: has {what}")
    return text


def split_lines(text: str) -> list[str]:
    """Lines of a text as an editor counts them, whatever ends them."""
    lines = _LINE_END.split(text)
    return lines[:-1] if not lines[-1] else lines


def _decode(content: bytes, name: str) -> str:
    marked = next((code for mark, code in _MARKED if content.startswith(mark)), None)
    encoding, start = marked or "utf-8", content[:_LOOKED_AT]
    pairs = len(start) // 2
    if not marked and pairs >= _LEAST:  # UTF-16 without a mark, by its zeros
        first, second = start[0::2].count(0) / pairs, start[1::2].count(0) / pairs
        if second > _MANY and first < _FEW:
            encoding = "utf-16-le"
        elif first > _MANY and second < _FEW:
            encoding = "utf-16-be"
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        line = 1 + len(_LINE_END.findall(content[: error.start].decode("latin-1")))
        # a mark, or zeros, leave no other encoding
        if encoding != "utf-8" or marked:
            said = f"is not a text file, or damaged: {encoding.upper()} cannot be read"
            raise ConfigurationError(f"{name}:{line}: {said}") from None
    for one in content.splitlines():
        if one.isascii():
            continue
        try:
            one.decode("utf-8")
        except UnicodeDecodeError:
            continue
        raise ConfigurationError(
            f"{name}:{line}: is damaged: most of the file is UTF-8, this line is not"
        )
    try:
        return content.decode("cp1252")
    except UnicodeDecodeError as error:
        line = 1 + content[: error.start].count(b"\n")
        raise ConfigurationError(
            f"{name}:{line}: is not a text file (UTF-8, UTF-16 or Windows-1252)"
        ) from None


SHEET = "#"
"""Between the name of a workbook and that of a sheet."""

DELIMITER = "\t"

AS_TEXT = " (text)"
"""End of a text such as ``1.469``, which may be 1469; cells that are numbers are in no doubt."""

_ZIP, _OLD = b"PK\x03\x04", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
_BOOK, _SHEETS = "xl/workbook.xml", "xl/worksheets/"
_OTHERS = {"content.xml": "an OpenDocument file", "Index/Document.iwa": "an Apple Numbers file"}
_READ = (".xml", ".rels")  # ends of names of what is read: sheets, their texts and styles
_LARGEST = 60_000_000  # bytes of these without compression; a cell takes at least 26
_MERGED = b"<mergeCell "
_PERCENT = 100.0
_SEPARATOR = re.compile(r'^"?sep=(.)"?$', re.I)  # first line, for a spreadsheet
_LITERAL = re.compile(r'"[^"]*"|\\.')  # of a format of numbers


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
    # a sheet is named after its workbook, as in ``runs.xlsx#May 3``
    before, mark, title = str(path).rpartition(SHEET)
    named = mark and before.lower().endswith((".xlsx", ".xlsm")) and not path.exists()
    book, sheet = (Path(before), title) if named else (path, None)
    content = read_content(book)
    if is_workbook(content, str(book)):
        sheets = read_sheets(content, str(book))
        if sheet is not None and sheet not in sheets:
            known = ", ".join(f'"{one}"' for one in sheets)
            raise ConfigurationError(f'{book}: has no table in a sheet "{sheet}"; it has {known}')
        return [
            Lines(f"{book}{SHEET}{title}" if len(sheets) > 1 else str(book), rows, True, DELIMITER,
                  is_sheet=True)
            for title, rows in sheets.items()
            if sheet in (None, title)
        ]  # fmt: skip
    text = plain_text(content, str(path))
    lines, delimiter = split_lines(text), None
    stated = _SEPARATOR.match(lines[0]) if lines else None
    if stated:
        lines[0], delimiter = "", stated[1]
    return [Lines(str(path), lines, text.endswith(("\n", "\r")), delimiter)]


def is_workbook(content: bytes, name: str) -> bool:
    """Whether the content of a file is a workbook that can be read."""
    if content.startswith(_OLD):
        raise ConfigurationError(
            f"{name}: is an old workbook (.xls), or one with a password; save it as .xlsx or .csv"
        )
    if not content.startswith(_ZIP):
        return False
    try:
        parts = zipfile.ZipFile(io.BytesIO(content)).infolist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError, OSError):
        raise ConfigurationError(f"{name}: is a damaged workbook or archive") from None
    names = [part.filename for part in parts]
    if _BOOK in names:
        size = sum(part.file_size for part in parts if part.filename.endswith(_READ))
        if size > _LARGEST:
            raise ConfigurationError(
                f"{name}: is a workbook that unpacks to {size / 1e6:.0f} MB, of at most "
                f"{_LARGEST / 1e6:.0f}; save its table as .csv"
            )
        return True
    kind = next((kind for file, kind in _OTHERS.items() if file in names), "an archive")
    raise ConfigurationError(f"{name}: is {kind}; save the table as .xlsx or .csv")


def read_sheets(content: bytes, name: str) -> dict[str, list[str]]:
    """Sheets that hold anything, as lines delimited by tabs."""
    openpyxl = extra("openpyxl", "reading workbooks (.xlsx)", "lab")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # on styles and the like, which carry no numbers
            formulas = _cells(openpyxl, content, values=False)
            has = any(cell.data_type == "f" for rows in formulas.values() for row in rows
                      for cell in row)  # fmt: skip
            cells = _cells(openpyxl, content, values=True) if has else formulas
            merged = _merged(openpyxl, content)
    except Exception as error:  # the parser has no errors of its own
        said = " ".join(str(error).split())[:80] or type(error).__name__
        raise ConfigurationError(f"{name}: is a damaged workbook: {said}") from None
    sheets = {}
    for sheet, rows in cells.items():
        texts = [
            [_text(cell, formula) for cell, formula in zip(row, below, strict=True)]
            for row, below in zip(rows, formulas[sheet], strict=True)
        ]
        for first, last, column in merged.get(sheet, ()):
            for row in texts[first : last + 1]:
                row += [""] * (column + 1 - len(row))
                row[column] = texts[first - 1][column]
        width = max(
            (1 + place for row in texts for place, text in enumerate(row) if text), default=0
        )
        if width:
            sheets[sheet] = [_line(row, width) for row in texts]
    if not sheets:
        raise ConfigurationError(f"{name}: holds no table")
    return sheets


def _cells(openpyxl: Any, content: bytes, *, values: bool) -> dict[str, list[tuple[Any, ...]]]:
    book = openpyxl.load_workbook(io.BytesIO(content), read_only=True, data_only=values)
    try:
        for sheet in book.worksheets:
            # the stated size may be that of a whole sheet, and is filled with empty cells
            sheet.reset_dimensions()
        return {sheet.title: list(sheet.iter_rows()) for sheet in book.worksheets}
    finally:
        book.close()


def _merged(openpyxl: Any, content: bytes) -> dict[str, list[tuple[int, int, int]]]:
    """Rows below the first of cells that are merged downwards, and their column, from 0; by sheet.

    Only the first of such cells holds what all of them show.
    """
    archive = zipfile.ZipFile(io.BytesIO(content))
    sheets = [name for name in archive.namelist() if name.startswith(_SHEETS)]
    if not any(_MERGED in archive.read(name) for name in sheets):
        return {}
    book = openpyxl.load_workbook(io.BytesIO(content))
    return {
        sheet.title: [
            (one.min_row, one.max_row - 1, one.min_col - 1)
            for one in sheet.merged_cells.ranges
            if one.max_row > one.min_row
        ]
        for sheet in book.worksheets
    }


def _line(cells: list[str], width: int) -> str:
    if not any(cells):
        return ""
    text = io.StringIO()
    row = [*cells, *[""] * (width - len(cells))][:width]
    csv.writer(text, delimiter=DELIMITER, lineterminator="").writerow(row)
    return text.getvalue()


def _text(cell: Any, formula: Any) -> str:
    value = cell.value
    if value is None:
        return f"={str(formula.value).lstrip('=')}" if formula.data_type == "f" else ""
    if isinstance(value, str):
        text = " ".join(value.split())
        number = split_number(text)
        return text + AS_TEXT if number and number.open else text
    if isinstance(value, int | float) and not isinstance(value, bool):
        share = "%" in _LITERAL.sub("", str(cell.number_format))
        return f"{_PERCENT * value:.15g} %" if share else repr(value)
    if isinstance(value, datetime.datetime | datetime.date | datetime.time):
        return value.isoformat()
    return " ".join(str(value).split())
