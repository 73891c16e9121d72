from importlib import resources

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.calibration.points import doubts, read_points
from lightflyer.lab.levitation.data import read_lift_offs
from lightflyer.lab.synthetic import example_files

GOOD = """\
# a comment
sample, pressure [mTorr], irradiance [kW/m^2], irradiance_uncertainty [W/m^2], diameter [cm]
Ge 2 cm, 30, 1.5, 40, 2

CNT, 20, 2.5, 50, 3
"""


def test_reads_units_comments_and_blank_lines(write):
    points = read_points(write(GOOD))
    assert points.samples == ["Ge 2 cm", "CNT"]
    assert points.pressure[0] == pytest.approx(30e-3 * 101325.0 / 760.0)
    assert points.irradiance.tolist() == [1500.0, 2500.0]
    assert points.numbers["irradiance_uncertainty"].tolist() == [40.0, 50.0]
    assert points.numbers["diameter"].tolist() == pytest.approx([0.02, 0.03])
    assert points.of("CNT").tolist() == [False, True]


HEADER = "sample,pressure [Pa],irradiance [W/m^2]"


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("", None, "is empty"),
        (HEADER + "\n", None, "no rows"),
        ("sample,pressure [Pa]\na,1\n", 1, "irradiance is missing"),
        ("sample,pressure,irradiance [W/m^2]\na,1,2\n", 1, "has no unit"),
        ("sample,pressure [K],irradiance [W/m^2]\na,1,2\n", 1, "wrong kind"),
        ("sample,pressure [furlong],irradiance [W/m^2]\na,1,2\n", 1, "unknown"),
        ("sample,presure [Pa],irradiance [W/m^2]\na,1,2\n", 1, '"presure [Pa]" is unknown'),
        (HEADER + ",irradiance [W/m^2]\na,1,2,3\n", 1, "appears twice"),
        (HEADER + "\na,-1,2\n", 2, "pressure = -1 Pa is not positive"),
        (HEADER + "\na,1,0\n", 2, "irradiance = 0 W/m^2 is not positive"),
        (HEADER + "\na,nan,2\n", 2, "pressure is nan"),
        (HEADER + "\na,1,2\nb,many,2\n", 3, '"many" is not a number'),
        (HEADER + "\na,1\n", 2, "has 2 values"),
        (HEADER + "\n,1,2\n", 2, "sample is empty"),
        (HEADER + ",tac_top\na,1,2,1.5\n", 2, "tac_top = 1.5 is not between 0 (excluded) and 1.3"),
        (HEADER + ",figure\na,1,2,7\n", 2, 'figure = "7" is not one of'),
    ],
)
def test_one_clear_line_for_each_mistake(write, text, line, says):
    path = write(text)
    with pytest.raises(lf.ConfigurationError) as error:
        read_points(path, strict=True)
    message = str(error.value)
    assert "\n" not in message
    assert message.startswith(f"{path}:{line}: " if line else f"{path}: ")
    assert says in message


def test_missing_file(tmp_path):
    with pytest.raises(lf.ConfigurationError, match="cannot be read"):
        read_points(tmp_path / "nothing.csv")


EXAMPLES = {
    "points.csv": (resources.files("lightflyer") / "data" / "points.csv").read_text("utf-8"),
    **example_files("levitation").files,
}


@pytest.mark.parametrize("name", EXAMPLES)
def test_calibration_and_lab_bench_read_the_same(tmp_path, name):
    """The package's own examples, as text of spreadsheets."""
    text = EXAMPLES[name].lstrip("\N{ZERO WIDTH NO-BREAK SPACE}")
    path = tmp_path / name
    path.write_text(text, encoding="utf-16")
    points = read_points(path)
    samples, table = read_lift_offs(path)
    assert [row.line for row in points.rejected] == [row.line for row in table.rejected]
    for column in ("pressure", "irradiance"):
        joined = np.concatenate([getattr(sample, column) for sample in samples])
        np.testing.assert_array_equal(np.sort(joined), np.sort(getattr(points, column)))


def test_what_must_be_known_of_the_reading_is_a_warning(write):
    points = read_points(write("pressure [Pa],irradiance [suns]\n1,1.5\n2,2.5"))
    assert points.irradiance.tolist() == [1500.0, 2500.0]
    said = "\n".join(points.warnings)
    assert "1 sun is taken as 1000 W/m^2" in said
    assert "irradiance = 2.5; check that it is whole" in said
    assert points.where(points.pressure > 1.0).warnings == points.warnings


def test_assumed_accuracies_in_words():
    said = assumed_accuracies({"power": "± 1 %"})
    assert said == ("no accuracy of the power is stated; ± 1 % is assumed",)


def test_light_that_may_be_least_beyond_the_pressures_is_in_no_doubt():
    """Points of dense gas alone, or of thin gas alone, have no optimum of a wrong unit."""
    pressure = np.array([40.0, 60.0, 80.0])
    assert doubts(pressure, np.array([900.0, 1500.0, 2500.0]), 0.02) == []
    assert doubts(pressure, np.array([1500.0, 900.0, 2500.0]), 0.02)
    thin = np.array([0.1, 0.2, 0.3])
    assert doubts(thin, np.array([2500.0, 1500.0, 900.0]), 0.02) == []
    assert doubts(thin, np.array([900.0, 1500.0, 2500.0]), 0.02)
