import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lightflyer as lf
from lightflyer.core.quantity import Fraction, Pressure, Quantity, Temperature
from lightflyer.files.table import read_table, shipped_table
from lightflyer.files.table_layout import Column

COLUMNS = (
    Column("pressure", Pressure, ("p",), outside="reject"),
    Column("irradiance", Quantity("W/m^2", 0.0, open_below=True)),
    Column("temperature", Temperature),
    Column("sample", text=True),
    Column("time", Quantity("s"), assumed_unit="s"),
)


@pytest.mark.parametrize(
    "text",
    [
        "pressure [mTorr],irradiance [kW/m^2]\n30,1.5\n20,2.5\n",
        "Pressure (mTorr), Irradiance (kW/m2)\n30, 1.5\n20, 2.5\n",
        "pressure/mTorr;irradiance/kW m-2\n30;1,5\n20;2,5\n",
        "\N{ZERO WIDTH NO-BREAK SPACE}# note\np [mTorr]\tirradiance [W/m^2]\n30\t1500\n20\t2500\n",
        "Instrument: X\nRun 3\n# pressure [mTorr] irradiance [kW/m^2]\n30 1.5\n\n20 2.5\n",
        '"remark","pressure [mTorr]","irradiance [W/m^2]"\n"a, b",30,1500\n,20,2500\n',
        "pressure [mTorr],irradiance [kW/m^2]\r\n30,1.5,\r\n20,2.5,\r\n",
        "pressure_mTorr,irradiance kW/m2\n30,1.5\n20,2.5\n",
        "Pressure, mTorr;Irradiance, kW/m2\n30;1,5\n20;2,5\n;;\n;\n",
        "Run 5,,\n,,\nPressure (mTorr),Irradiance (kW/m2),Comment\n30,1.5,\n20,2.5,ok\n,,\n",
    ],
)
def test_every_layout_gives_the_same(write, text):
    table = read_table(write(text), COLUMNS)
    torr = 101325.0 / 760.0
    np.testing.assert_allclose(table.numbers["pressure"], [0.030 * torr, 0.020 * torr], rtol=1e-14)
    np.testing.assert_allclose(table.numbers["irradiance"], [1500.0, 2500.0], rtol=1e-14)
    assert table.rejected == []


@pytest.mark.parametrize(
    ("header", "pascals"),
    [
        ("Pressure (TORR)", 133.3224), ("pressure_torr", 133.3224), ("Pressure [mTORR]", 0.1333224),
        ("pressure / micron", 0.1333224), ("pressure [microns Hg]", 0.1333224),
        ("Pressure (in. Hg)", 3386.389), ("Pressure in Pascal", 1.0), ("pressure, hPa", 100.0),
        ("PRESSURE_hPa", 100.0), ("p (µbar)", 0.1), ("p (\N{GREEK SMALL LETTER MU}bar)", 0.1),
        ("p [N m⁻²]", 1.0), ("p [N·m^-2]", 1.0),
        ("p [N/(m m)]", 1.0), ("p (N/(m m))", 1.0),
    ],
)  # fmt: skip
def test_units_of_headers(write, header, pascals):
    found = read_table(write(f"{header}\ttemperature [℉]\n1.5\t32\n"), COLUMNS).numbers
    assert found["pressure"] == pytest.approx([1.5 * pascals], rel=5e-7)
    assert found["temperature"] == pytest.approx([273.15])


@pytest.mark.parametrize(
    "text",
    [
        "time\tPressure\tIrradiance\tremark\nmin\tmTorr\tkW/m²\t\n2\t30\t1.5\tx\n",
        "# time;pressure;irradiance\n# [min];[mTorr];[kW/m^2]\n2;30;1,5\n",
        "time,pressure,irradiance [W/m^2]\nmin,mTorr,\n2,30,1500\n",
    ],
)
def test_units_in_the_line_below_the_names(write, text):
    found = read_table(write(text), COLUMNS).numbers
    assert found["pressure"] == pytest.approx([0.03 * 101325.0 / 760.0])
    assert found["irradiance"] == pytest.approx([1500.0])
    assert found["time"] == pytest.approx([120.0])


def test_columns_by_option(write):
    table = read_table(write("30 x 1.5\n20 y 2.5\n"), COLUMNS,
                       layout="pressure [Pa], -, irradiance [kW/m^2]")  # fmt: skip
    np.testing.assert_array_equal(table.numbers["irradiance"], [1500.0, 2500.0])
    for layout, says in (
        ("pressure [Pa], density", 'column "density" is unknown'),
        ("-, -", "--columns of .* has no known column"),
    ):
        with pytest.raises(lf.ConfigurationError, match=says):
            read_table(write("30 1\n"), COLUMNS, layout=layout)


def test_celsius_and_its_uncertainty(write):
    column = Column("t", Temperature)
    columns = (column, column.uncertainty())
    table = read_table(write("t [°C],t_uncertainty [°C]\n20,0.5\n"), columns)
    assert table.numbers["t"] == pytest.approx(293.15)
    assert table.numbers["t_uncertainty"] == pytest.approx(0.5)


def test_unreadable_rows_are_named(write):
    text = (
        "time,pressure [Pa],irradiance [W/m^2]\n0,1,10\n1,OVLD,10\n2,,10\n3,nan,10\n4,4\n"
        "5,-1e-3,10\n0,1,10\n6,7,10\n"
    )
    table = read_table(write(text), COLUMNS)
    assert [row.line for row in table.rejected] == [3, 4, 5, 6, 7, 8]
    assert [row.reason for row in table.rejected] == [
        'pressure: "OVLD" is not a number', "pressure is empty", "pressure is nan",
        "has 2 values, the header names 3 columns", "pressure = -0.001 Pa is not positive",
        "repeats line 2",
    ]  # fmt: skip
    np.testing.assert_array_equal(table.lines, [2, 9])
    np.testing.assert_array_equal(table.numbers["pressure"], [1.0, 7.0])


HEADER = "pressure [Pa],irradiance [W/m^2]\n"
SAMPLES = (
    Column("sample", text=True, required=True, blank=False),
    Column("pressure", Pressure, required=True),
    Column("share", Fraction),
    Column("signal", Quantity("", 0.0), any_unit=True),
)
N, SHARE = (Column("n", Quantity("", 0.0), any_unit=True),), (Column("share", Fraction),)
STRICT = {"strict": True, "closed": True}


MISTAKES = [
    ("", "", "is empty"),
    (b"\x00\n\xff\xfe", ":1", "not a text file"),
    ("\n\nfoo,bar\n1,2\n", ":3", "has no known column"),
    ("Größe,Fluß\n1,2\n", ":1", "has no known column"),
    (HEADER, "", "has a header but no rows"),
    ("pressure,irradiance [W/m^2]\n1,2\n", ":1", "column pressure has no unit"),
    ("pressure,irradiance\nOVLD,OVLD\n1,2\n", ":1", 'column pressure: unit "OVLD" is unknown'),
    ("pressure [W],irradiance [W/m^2]\n1,2\n", ":1", "of the wrong kind"),
    ("pressure [Pa],pressure [Torr]\n1,2\n", ":1", "appears twice"),
    (HEADER + "1,2\n3,-4\n", ":3", "irradiance = -4 W/m^2 is not positive"),
    (HEADER + "1,2\n3 mTorr,4\n5,6\n", ":3", '"3 mTorr" is more than a number'),
    (HEADER + "1,2\npressure [Torr],irradiance [W/m^2]\n3,4\n", ":3", "is a second header"),
    (HEADER + "1,2\n3,4\n5", ":4", "the file ends within a row"),
    (HEADER + "1,2\n3,4\n5,", ":4", "the file ends within a row"),
    (HEADER + "nan,nan\nnan,nan\n", ":2", "none of its 2 rows can be read"),
    (HEADER + "1,5,2\n2,5,3\n", ":2", "none of its 2 rows"),
]
STRICT_MISTAKES = [
    ("# sample, pressure [Pa]\n", "", "has comments only"),
    ("-,-\n1,2\n", ":1", "sample is missing"),
    ("note\nsample,pressure [Pa]\na,1\n", ":1", 'column "note" is unknown'),
    ("sample,share\na,1\n", ":1", "column pressure is missing; needed: sample, pressure [Pa]"),
    ("sample,pressure [Pa]\na,1\nb,OVLD\n", ":3", '"OVLD" is not a number'),
    ("sample,pressure [Pa]\na,1\nb\nc,3\n", ":3", "has 1 value, the header names 2"),
    ("sample,pressure [Pa]\na,1\n,2\n", ":3", "sample is empty"),
    ("sample,pressure [mTorr]\na,-30\n", ":2", "pressure = -30 mTorr is not positive"),
    ("sample,pressure [Pa],share [%]\na,1,120\n", ":2", "share = 120 % is not between"),
]


@pytest.mark.parametrize(
    ("text", "place", "says", "columns", "options"),
    [
        *((*mistake, COLUMNS, {}) for mistake in MISTAKES),
        *((*mistake, SAMPLES, STRICT) for mistake in STRICT_MISTAKES),
        # columns of errors are not values
        *(
            (f"{name},x\n1,2\n", ":1", "has no known column", N, {"strict": True})
            for name in ("n_err", "n std", "n (err)", "n_uncertainty", "n_max")
        ),
        ("1,2\n3,4\n", ":1", "has no known column; known columns: sh", SHARE, {"strict": True}),
    ],
)
def test_one_clear_line_for_each_mistake(write, text, place, says, columns, options):
    path = write(text)
    with pytest.raises(lf.ConfigurationError) as error:
        read_table(path, columns, **options)
    assert str(error.value).startswith(f"{path}{place}: ")
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_strict_reader_takes_all_or_nothing(write):
    text = "# pressure [Torr], share\nsample, pressure [Pa], signal (V)\n\npressure, 1, 2\n,,\n"
    table = read_table(write(text), SAMPLES, **STRICT)
    assert table.texts == {"sample": ["pressure"]}
    assert {name: values.tolist() for name, values in table.numbers.items()} == {
        "pressure": [1.0], "signal": [2.0]
    }  # fmt: skip
    assert table.lines.tolist() == [4]
    # names alone are a table too
    assert read_table(write("name\na\n"), (Column("name", text=True),)).texts == {"name": ["a"]}


def test_shipped_table():
    table = shipped_table("kinetic_boundary.csv")
    assert set(table.texts["gas"]) == {"monatomic", "diatomic"}
    assert table.numbers["heat_factor"].dtype == float
    # lines of the file itself, its comments counted
    assert (table.texts["gas"][0], table.numbers["boundary"][0], table.lines[0]) == (
        "monatomic", 2.0, 8
    )  # fmt: skip
    assert "gas" not in table.numbers


CELLS = st.one_of(
    st.floats().map(repr),
    st.sampled_from(["", "1,5", "OVLD", "3 mTorr", '"', '"a,b"', "1_0", "٣"]),
    st.text(max_size=5),
)
ROWS = st.lists(st.lists(CELLS, max_size=3), max_size=6)


@st.composite
def nearly_tables(draw):
    delimiter = draw(st.sampled_from([",", ";", "\t", " "]))
    rows = [["pressure [Pa]", "irradiance [W/m^2]"], *draw(ROWS)]
    return "\n".join(delimiter.join(row) for row in rows)


TEXTS = st.one_of(st.text(max_size=200), nearly_tables())


@settings(max_examples=150, deadline=None)
@given(
    st.one_of(
        st.binary(max_size=200), TEXTS.map(lambda text: text.encode("utf-8", "surrogatepass"))
    ),
    st.booleans(),
)
def test_no_content_gives_a_traceback(tmp_path_factory, content, strict):
    path = tmp_path_factory.getbasetemp() / "fuzz.csv"
    path.write_bytes(content)
    try:
        table = read_table(path, COLUMNS, strict=strict)
    except lf.ConfigurationError as error:
        said = str(error)
        assert said.startswith(str(path))
        return
    for values in table.numbers.values():
        assert np.isfinite(values).all()


@pytest.mark.parametrize("cell", ["05. Mrz", "5-Mar", "Mar-05", "05.03.2024", "12:30:00"])
def test_a_date_of_a_spreadsheet_rejects_its_row(write, cell):
    """In any form; "05. Mrz" was a number with a unit, which refused the file."""
    path = write(f"row;p [Pa]\n1;5.1\n2;{cell}\n3;5.4\n")
    table = read_table(path, (Column("pressure", Quantity("Pa"), ("p",)),))
    assert table.numbers["pressure"] == pytest.approx([5.1, 5.4])
    assert "is a date or a time of day" in table.rejected[0].reason


@pytest.mark.parametrize(
    "stamp",
    ["2024-05-03 23:59:{:02d}", "23:59:{:02d}", "11:59:{:02d} PM", "05/03/2024 23:59:{:02d}",
     "03.05.2024 23:59:{:02d}", "2024-10-27T02:59:{:02d}+02:00"],
)  # fmt: skip
def test_no_stamp_of_a_logger_refuses_a_file(write, stamp):
    """Their rows count in their order, across midnight and the end of summer time too."""
    columns = (Column("pressure", Quantity("Pa"), ("p",)), Column("power", Quantity("W"), ("p",)))
    first, second, third, fourth = (stamp.format(one) for one in (30, 59, 0, 1))
    text = (
        f"Time,p (Pa),P (mW)\n{first},5.1,100\n{second},5.2,110\n"
        f"{third},2024-03-05,120\n{fourth},5.4,130\n"
    )
    table = read_table(write(text), columns)
    assert table.numbers["pressure"] == pytest.approx([5.1, 5.2, 5.4])
    assert table.numbers["power"] == pytest.approx([0.1, 0.11, 0.13])  # by its unit
    (row,) = table.rejected
    assert row.line == 4
    assert "is a date or a time of day" in row.reason
