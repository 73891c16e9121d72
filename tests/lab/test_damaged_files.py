"""A sample of the damaged files of ``studies/damaged_files``, reduced by every command."""

import pytest

from lightflyer.core.quantity import Pressure
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column

FIRST, EACH = 0, 1  # seeds; the study runs 2,000


@pytest.fixture(scope="module")
def check(study_of):
    with study_of("damaged_files", "check") as module:
        yield module


def test_no_traceback_and_no_impossible_number(check):
    cases = check.cases()
    wrong = []
    for seed in range(FIRST, FIRST + EACH * len(cases)):
        case = cases[seed % len(cases)]
        said, damages, _ = check.findings(case, seed)
        wrong += [f"{case.name}, seed {seed}, {damages}: {text}" for text in said]
    assert not wrong, "\n".join(wrong)


def estimate(value, low, high, unit=""):
    return {"value": value, "interval_95": [low, high], "unit": unit}


@pytest.mark.parametrize(
    ("document", "says"),
    [
        ({"emissivity": estimate(-1.4e9, -2e9, -1e9)}, "not between 0 and 1"),
        ({"emissivity": estimate(0.1, -0.01, 0.2)}, "the interval leaves 0 to 1"),
        ({"transmittance": estimate(0.5, 0.6, 0.7)}, "leaves the value out"),
        ({"samples": {"a": {"tac": estimate(5.6e5, 1.0, None)}}}, "no accommodation"),
        ({"rms_height": estimate(-1.0, -2.0, 0.0, "nm")}, "negative"),
        ({"slope": float("nan")}, "is nan"),
    ],
)
def test_the_check_sees_impossible_numbers(check, document, says):
    assert any(says in text for text in check.impossible(document))
    sound = {"emissivity": estimate(0.1, 0.0, 0.2), "tac": estimate(0.8, None, None)}
    assert not list(check.impossible(sound))


@pytest.mark.parametrize("cell", ["1e308", "-1e40", "1e-320", "nan"])
def test_a_number_that_is_no_measurement_is_rejected(write, cell):
    path = write(f"pressure [Pa]\n1\n{cell}\n2\n", "table.csv")
    table = read_table(path, [Column("pressure", Pressure)])
    assert table.numbers["pressure"].tolist() == [1.0, 2.0]
    assert [row.line for row in table.rejected] == [3]
    assert cell in table.rejected[0].reason
