"""The table of disks that survive their own lift, made again in part."""

import csv
from pathlib import Path

import pytest

STUDY = Path(__file__).parents[2] / "studies" / "survival"


@pytest.fixture
def study(study_of):
    with study_of("survival", "study") as module:
        yield module


@pytest.mark.parametrize("number", [4, 12])
def test_a_line_of_the_table(study, number, tmp_path):
    with (STUDY / "results.csv").open(encoding="utf-8", newline="") as file:
        heads, *rows = csv.reader(file)
    assert tuple(heads) == study.COLUMNS
    expected = rows[number]
    setup = study.disk_over_earth(tmp_path)
    found = study.row(setup, expected[0], float(expected[1]), float(expected[2]))
    assert found[0] == expected[0]
    numbers = [float(value) for value in expected[1:]]
    assert found[1:] == pytest.approx(numbers, rel=1e-3, nan_ok=True)
