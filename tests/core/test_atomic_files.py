import os
import time

import pytest

from lightflyer.core.atomic_files import TEMPORARY, output_directory
from lightflyer.core.errors import ParameterWarning


def write(folder, *names):
    with output_directory(folder) as stage:
        for name in names:
            stage(name).write_text("x", encoding="utf-8")


def test_results_of_another_run_are_named(tmp_path):
    write(tmp_path, "tac.json", "tac.svg")
    (tmp_path / "rows.csv").write_text("an input", encoding="utf-8")
    write(tmp_path, "tac.json", "tac.svg")
    with pytest.warns(ParameterWarning, match=r"tac\.svg are not of this run"):
        write(tmp_path, "tac.json", "tac.png")
    assert {path.name for path in tmp_path.iterdir()} == {
        "rows.csv", "tac.json", "tac.png", "tac.svg"
    }  # fmt: skip


def test_a_table_of_another_run_is_named(tmp_path):
    write(tmp_path, "prediction.json", "prediction.csv")
    with pytest.warns(ParameterWarning, match=r"prediction\.csv are not of this run"):
        write(tmp_path, "prediction.json")


@pytest.mark.parametrize(("age", "stays"), [(3600.0, True), (2 * 86400.0, False)])
def test_what_a_killed_run_left_is_removed_after_a_day(tmp_path, age, stays):
    left = tmp_path / f"{TEMPORARY}abc"
    left.mkdir()
    (left / "half.nc").write_text("x", encoding="utf-8")
    then = time.time() - age
    os.utime(left, (then, then))
    write(tmp_path, "tac.json")
    assert left.exists() == stays
