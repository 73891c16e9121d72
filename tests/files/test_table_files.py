"""Tables in every encoding and in workbooks, as laboratories have them."""

import datetime
import zipfile

import numpy as np
import openpyxl
import pytest

import lightflyer as lf
from lightflyer.core.quantity import Fraction, Pressure, Quantity, Temperature
from lightflyer.files.table import read_table
from lightflyer.files.table_file import plain_text, split_lines
from lightflyer.files.table_layout import Column

COLUMNS = (
    Column("sample", text=True),
    Column("pressure", Pressure, required=True),
    Column("irradiance", Quantity("W/m^2", 0.0, open_below=True), required=True),
    Column("temperature", Temperature),
    Column("absorptance", Fraction),
)
TEXT = "sample;pressure (µbar);irradiance (mW/cm²);temperature [°C]\nGröße 1;30;1,5;21,5\n"


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le", "utf-16-be", "utf-32"]
)
def test_every_encoding_gives_the_same(tmp_path, encoding, end):
    path = tmp_path / "raw.csv"
    path.write_bytes(TEXT.replace("\n", end).encode(encoding))
    table = read_table(path, COLUMNS)
    assert table.texts["sample"] == ["Größe 1"]
    assert table.lines.tolist() == [2]
    found = [table.numbers[name][0] for name in ("pressure", "irradiance", "temperature")]
    np.testing.assert_allclose(found, [3.0, 15.0, 294.65], rtol=1e-14)


def test_lines_as_an_editor_counts_them():
    assert split_lines("a\r\nb\rc\n\nd") == ["a", "b", "c", "", "d"]
    assert split_lines("a\x0bb\u2028c\n") == ["a\x0bb\u2028c"]


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"a,b\n1,2\n\0\0\0\0\n", "a.csv:3: is not a text file, or damaged: has zero bytes"),
        (b"a\nb\x03\n", "a.csv:2: is not a text file, or damaged: has the control character"),
        (b"a\nb\x81\n", "a.csv:2: is not a text file (UTF-8, UTF-16 or Windows-1252)"),
        ("µ\n".encode() + b"1\n\xb5\n", "a.csv:3: is damaged: most of the file is UTF-8"),
        ("µm, °C\n".encode("utf-16")[:-1], "a.csv:1: is not a text file, or damaged: UTF-16"),
    ],
)
def test_what_is_no_text(content, says):
    with pytest.raises(lf.ConfigurationError) as error:
        plain_text(content, "a.csv")
    assert str(error.value).startswith(says)


HEADER = ["sample", "pressure [mTorr]", "irradiance [kW/m^2]"]


@pytest.fixture
def save(tmp_path):
    def save(change=None, **sheets):
        book = openpyxl.Workbook()
        book.remove(book.active)
        for title, rows in sheets.items():
            sheet = book.create_sheet(title)
            for row in rows:
                sheet.append(row)
        if change:
            change(book)
        path = tmp_path / "runs.xlsx"
        book.save(path)
        return path

    return save


def test_workbook(save):
    # 1.469 is a number of the workbook: no mark of it is in doubt
    rows = [
        ["Run of May"],
        [],
        [*HEADER, "remark"],
        ["1.4", 1.469, 1.5],
        [],
        [2.5, "30.0", 2.5, "x"],
    ]
    table = read_table(save(first=rows, empty=[]), COLUMNS)
    torr = 101325.0 / 760.0
    np.testing.assert_allclose(table.numbers["pressure"], np.array([1.469, 30.0]) * torr / 1e3)
    assert table.numbers["irradiance"].tolist() == [1500.0, 2500.0]
    # names that look like numbers, and a number as a text
    assert (table.texts["sample"], table.lines.tolist()) == (["1.4", "2.5"], [4, 6])
    assert (table.unused, table.notes) == (["remark"], [])


def test_sheets(save):
    path = save(May=[HEADER, ["a", 1.0, 2.0]], June=[HEADER, ["b", 3.0, 4.0]], notes=[["x"]])
    with pytest.raises(lf.ConfigurationError, match=r'several tables; name one of ".*#May", '):
        read_table(path, COLUMNS)
    june = read_table(f"{path}#June", COLUMNS)
    assert (june.texts["sample"], june.source) == (["b"], f"{path}#June")
    with pytest.raises(lf.ConfigurationError, match='no table in a sheet "July"; it has "May"'):
        read_table(f"{path}#July", COLUMNS)
    table = read_table(save(May=[HEADER, ["a", 1.0, 2.0]], notes=[["x"]]), COLUMNS)
    assert table.notes == [f"{path}#May is read; {path}#notes: no known columns"]
    with pytest.raises(lf.ConfigurationError, match="has no known column"):
        read_table(save(notes=[["x"]], more=[["y"]]), COLUMNS)


def merge(book):
    book["S"].merge_cells("B1:C1")


@pytest.mark.parametrize(
    ("rows", "change", "says"),
    [
        ([HEADER, ["a", 1.0, "=B2*2"]], None, ':2: irradiance: the formula "=B2*2" has no value'),
        ([HEADER, ["a", datetime.date(2024, 2, 1), 5]], None, ':2: pressure: "2024-02-01T'),
        ([HEADER, ["a", 30, "1,469"]], None, ':2: irradiance: "1,469" is a text of the workbook'),
        ([HEADER, ["a", 3.5, "1.469"]], None, ':2: irradiance: "1.469" is a text of the workbook'),
        ([HEADER, ["a", 30, 5]], merge, ":1: the column irradiance is missing"),
        ([HEADER, ["a", 30, "=1/0"]], None, "has no value"),
        ([], None, ": holds no table"),
        (b"PK\x03\x04 cut", None, "is a damaged workbook or archive"),
        (
            b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", None,
            "is an old workbook (.xls), or one with a password",
        ),
    ],
)  # fmt: skip
def test_one_clear_line_for_a_workbook(save, write, rows, change, says):
    path = write(rows, "runs.xlsx") if isinstance(rows, bytes) else save(change, S=rows)
    with pytest.raises(lf.ConfigurationError) as error:
        read_table(path, COLUMNS)
    assert str(error.value).startswith(str(path))
    assert says in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "shows", "cell"),
    [
        *((name, "0.0 %", 0.07) for name in ("absorptance", "absorptance [%]")),
        ("absorptance (fraction)", "0.0 %", 0.07),
        ("absorptance [%]", '0.0"%"', 7.0),  # a sign that only shows
    ],
)
def test_a_share_shown_in_percent(save, name, shows, cell):
    """The cell holds 0.07 and shows 7.0 %, whatever the header says."""

    def show(book):
        book["S"]["D2"].number_format = shows

    path = save(show, S=[[*HEADER, name], ["a", 30, 5, cell]])
    assert read_table(path, COLUMNS).numbers["absorptance"] == pytest.approx([0.07], rel=1e-15)


@pytest.mark.parametrize("name", ["transmittance", "transmittance [%]", "%T"])
def test_a_spectrum_shown_in_percent(save, name):
    def change(book):
        for row in (2, 3, 4):
            book["S"][f"B{row}"].number_format = "0.0 %"

    rows = [["wavenumber [cm^-1]", name], [900, 0.8], [1000, 0.75], [1100, 0.5]]
    found = lf.lab.read_spectrum(save(change, S=rows))
    assert found.value == pytest.approx([0.8, 0.75, 0.5], rel=1e-12)


def test_values_of_formulas_are_read(save, monkeypatch):
    """A spreadsheet program stores each formula with its value."""
    path = save(S=[HEADER, ["a", 30, "=1+1.5"]])
    # openpyxl writes none; put one where spreadsheet programs do
    with zipfile.ZipFile(path) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    sheet = "xl/worksheets/sheet1.xml"
    assert b"<v></v>" in parts[sheet] or b"<v />" in parts[sheet] or b"<v/>" in parts[sheet]
    for empty in (b"<v></v>", b"<v />", b"<v/>"):
        parts[sheet] = parts[sheet].replace(empty, b"<v>2.5</v>")
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    assert read_table(path, COLUMNS).numbers["irradiance"].tolist() == [2500.0]


def test_endless_workbook_is_one_line(tmp_path):
    path = tmp_path / "runs.xlsx"
    row = "<row>" + '<c r="A1"><v>1</v></c>' * 2000 + "</row>"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        book.writestr("xl/workbook.xml", "<workbook/>")
        book.writestr("xl/worksheets/sheet1.xml", f"<sheetData>{row * 2000}</sheetData>")
    with pytest.raises(lf.ConfigurationError, match=r"unpacks to 88 MB, .*; save .* \.csv"):
        read_table(path, COLUMNS)


def test_merged_cells_hold_their_text_in_every_row(save):
    """Of merged cells a workbook stores the first one only."""

    def merged(book):
        for cells in ("A1:B1", "A3:A4", "A5:A6"):
            book["S"].merge_cells(cells)

    rows = [["Ge", 1.0], [None, 2.0], ["CNT", 3.0], [None, 4.0]]
    path = save(merged, S=[["points of May", None], ["sample", "pressure [Pa]"], *rows])
    columns = Column("sample", text=True, blank=False), Column("pressure", Pressure)
    table = read_table(path, columns)
    assert table.texts["sample"] == ["Ge", "Ge", "CNT", "CNT"]
    assert table.numbers["pressure"].tolist() == [1.0, 2.0, 3.0, 4.0]


TWO = "pressure [Pa],irradiance [W/m^2]"
SHORT = "has 4 values, the header names 3 columns"
SUNS = "irradiance: 1 sun is taken as 1000 W/m^2"
CUT = "line 3, the last, has no line end after its value, irradiance = 10; check that it is whole"


@pytest.mark.parametrize(
    ("text", "irradiance", "rejected", "notes"),
    [
        # a comma between thousands splits a cell: not to be read as 1 W/m² with a remark
        (f"{TWO},remark\n1,850,\n2,1,469,\n", [850.0], {3: SHORT}, []),
        # errors of spreadsheets are no comments
        (
            f"{TWO}\n#DIV/0!,5\n#NV,6\n#WERT!,7\n# note\n1,8\n", [8.0],
            {2: "pressure", 3: "pressure", 4: "pressure"}, [],
        ),
        (f"{TWO}\n1,8\n2,10", [8.0, 10.0], {}, [CUT]),
        ("sep=|\npressure [Pa]|irradiance [W/m^2]\n1|8.5\n", [8.5], {}, []),
        (f"{TWO.replace('W/m^2', 'suns')}\n1,1.5\n", [1500.0], {}, [SUNS]),
    ],
)  # fmt: skip
def test_rows_and_notes_of_a_file(write, text, irradiance, rejected, notes):
    path = write(text)
    table = read_table(path, COLUMNS)
    assert table.numbers["irradiance"].tolist() == irradiance
    assert [row.line for row in table.rejected] == [*rejected]
    for row, said in zip(table.rejected, rejected.values(), strict=True):
        assert row.reason.startswith(said)
    found = [note.removeprefix(f"{path}: ") for note in table.notes]
    assert [note[: len(said)] for note, said in zip(found, notes, strict=True)] == notes
