"""Numbers as spreadsheets of several countries write them; Python's own formatting is the truth."""

import itertools

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.core.quantity import Irradiance, Pressure, Temperature
from lightflyer.files.number_marks import find_marks, split_number
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column

COLUMNS = (
    Column("pressure", Pressure, required=True),
    Column("irradiance", Irradiance, required=True),
)
COUNTRIES = {  # decimal and thousands marks
    "English": (".", ","),
    "German": (",", "."),
    "Swiss": (".", "’"),
    "French": (",", "\N{NARROW NO-BREAK SPACE}"),
    "SI": (".", " "),
    "C": (".", ""),
    "German, plain": (",", ""),
}


def written(value, form, country):
    decimal, thousands = COUNTRIES[country]
    text = format(value, form)
    return text.replace(",", "_").replace(".", decimal).replace("_", thousands)


def table(tmp_path, cells, delimiter):
    quoted = [[f'"{c}"' if delimiter in c else c for c in row] for row in cells]
    rows = [["pressure [Pa]", "irradiance [W/m^2]"], *quoted]
    path = tmp_path / "raw.csv"
    path.write_text("".join(delimiter.join(row) + "\n" for row in rows), encoding="utf-8")
    return path


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
@pytest.mark.parametrize("country", COUNTRIES)
def test_read_right_or_refused(tmp_path, country, delimiter):
    """Whatever the digits after the mark, no value is off, and no row is dropped."""
    rng = np.random.default_rng(1)
    read, refused = 0, []
    forms = [",.0f", ",.1f", ",.3f", ".0f", ".3f", ".4g"]
    for one, two in itertools.product(forms, forms):
        values = np.exp(rng.uniform(np.log([2.0, 200.0]), np.log([40.0, 9000.0]), (6, 2)))
        if "g" in one + two and COUNTRIES[country][1]:
            continue
        cells = [[written(a, one, country), written(b, two, country)] for a, b in values]
        truth = np.array([[float(format(a, one).replace(",", "")),
                           float(format(b, two).replace(",", ""))] for a, b in values])  # fmt: skip
        try:
            found = read_table(table(tmp_path, cells, delimiter), COLUMNS)
        except lf.ConfigurationError as error:
            refused.append(str(error))
            continue
        read += 1
        assert found.rejected == [], (cells, found.rejected)
        np.testing.assert_allclose(found.numbers["pressure"], truth[:, 0], rtol=1e-12)
        np.testing.assert_allclose(found.numbers["irradiance"], truth[:, 1], rtol=1e-12)
    # most of these files can be told: a reader that refuses all is no reader
    assert read > len(refused)
    assert all(" may be " in said for said in refused)


CELLS = [["0.5", "1.469"], ["1.200", "1.533"], ["12.25", "2.012"], ["2.5", "850.125"]]
# a comma for a point in one cell is never a factor of a thousand
CHANGED = [
    [
        [
            cell.replace(".", ",") if (row, place) == changed else cell
            for place, cell in enumerate(cells)
        ]
        for row, cells in enumerate(CELLS)
    ]
    for changed in itertools.product(range(4), range(2))
]


@pytest.mark.parametrize(
    ("cells", "says"),
    [
        # points in one column, thousands commas in the other: each may be the decimal mark
        ([["1.200", "1,469"]], '"1,469" may be 1469 or 1.469'),
        ([["1.200", "1.469"]], '"1.200" may be 1200 or 1.2'),
        ([["1,200", "1,469"]], '"1,200" may be 1200 or 1.2'),
        ([["5", "850"], ["7", "1.234"]], '"1.234" may be 1234 or 1.234'),
        ([["0.5", "1,469"], ["0.5", "2000"]], '"1,469" may be 1469 or 1.469'),
        ([["5", "850"], ["7", "1 234"]], '"1 234" may be 1234 or two numbers'),
        ([["0,5", "1,234.5"]], '"1,234.5" has other marks than "0,5" in line 2'),
        ([["1,234,567", "1.234.567"]], "has other marks"),
        ([["0.5", "1"], ["0,7", "2"]], '"0,7" has other marks than "0.5" in line 2'),
        *((cells, "") for cells in CHANGED),
    ],
)
def test_two_readings_are_refused(tmp_path, cells, says):
    path = table(tmp_path, cells, "\t")
    with pytest.raises(lf.ConfigurationError, match=r"may be|other marks") as error:
        read_table(path, COLUMNS)
    assert says in str(error.value)
    assert str(error.value).startswith(f"{path}:")
    assert "\n" not in str(error.value)


def test_a_line_of_the_file_settles_it(tmp_path):
    path = table(tmp_path, [["1.200", "1,469"]], "\t")
    header, row = path.read_text(encoding="utf-8").splitlines()
    for said, values in (("point", (1.2, 1469.0)), ("comma", (1200.0, 1.469))):
        for lines in (
            [f"# decimal: {said}", header, row],
            [header, f"#decimal = {said}", row],
        ):
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            found = read_table(path, COLUMNS).numbers
            assert (found["pressure"][0], found["irradiance"][0]) == values


def test_structure_settles_it_and_the_table_says_so(tmp_path, write):
    rows = [["0.5", "850"], ["0.7", "1,469"]]
    found = read_table(table(tmp_path, rows, "\t"), COLUMNS)
    assert found.numbers["irradiance"].tolist() == [850.0, 1469.0]
    assert len(found.notes) == 1
    assert '"1,469" is read as 1469' in found.notes[0]
    # where nobody reads notes, it is not settled
    with pytest.raises(lf.ConfigurationError, match="may be 1469 or"):
        read_table(table(tmp_path, rows, "\t"), COLUMNS, strict=True)
    # a camera shows no 150,123 °C; 2300 K are possible
    columns = (Column("temperature", Temperature),)
    hot = read_table(write("temperature [°C]\n150.123\n45.678\n"), columns)
    assert hot.numbers["temperature"] == pytest.approx([423.273, 318.828])
    with pytest.raises(lf.ConfigurationError, match=r"may be 1250 or 1\.25"):
        read_table(write("temperature [K]\n1,250\n2,300\n"), columns)


@pytest.mark.parametrize(
    "cell", ["", "1_000", "٣", "1,23,456", "1.2.3", "1,", ",", ".", "0,123,456", "1 23", "1e",
             "--1", "1,234,567e3", "1’23", "0x1F", "1.234.5", "inf", "1,234 567"]
)  # fmt: skip
def test_no_number(cell):
    assert split_number(cell) is None


def test_marks_of_many_numbers():
    cells = {"x": [(1, "1.469.000"), (2, "−1,5")], "y": [(1, "1d3")]}
    marks = find_marks("a", cells, lambda name, value: True)
    assert [marks.number(cell) for cell in ("-1.469,25", "2.000", "1d3", "3,25", "1.5")] == [
        -1469.25, 2000.0, 1000.0, 3.25, None
    ]  # fmt: skip
    assert (split_number("1.234,5").decimal, split_number("1,234").open) == (",", ",")
