import csv
import json
import math

import pytest

import lightflyer as lf
from lightflyer.lab.collection import collect_records, table_text

NUMBER = {"value": 0.7, "interval_95": [0.6, None], "standard_uncertainty": 0.05, "unit": ""}


def write(folder, name, content):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(json.dumps(content), encoding="utf-8")


def test_numbers_of_nested_records(tmp_path):
    write(tmp_path / "b", "tac.json", {"tac": NUMBER, "warnings": ["a", "b"]})
    samples = {"samples": {'Ge, "2 cm"': {"optimal_pressure": NUMBER | {"unit": "Pa"}}}}
    write(tmp_path / "a" / "deep", "levitation.json", samples | {"warnings": []})
    write(tmp_path, "prediction.json", {"tac": NUMBER})
    first, second = collect_records([tmp_path])
    assert (first.quantity, first.warnings) == ('samples, Ge, "2 cm", optimal_pressure', 0)
    assert (second.folder, second.command, second.warnings) == (str(tmp_path / "b"), "tac", 2)
    assert second.estimate.interval == (0.6, math.inf)
    rows = list(csv.DictReader(table_text([first, second]).splitlines()))
    assert rows[0]["quantity"] == first.quantity
    assert [(row["value"], row["unit"]) for row in rows] == [("0.7", "Pa"), ("0.7", "1")]
    assert [row["standard uncertainty"] for row in rows] == ["0.05", "0.05"]


@pytest.mark.parametrize("content", ["{", "[]", '{"tac": {"value": 1, "interval_95": 3}}'])
def test_a_damaged_record_is_named(tmp_path, content):
    (tmp_path / "tac.json").write_text(content, encoding="utf-8")
    with pytest.raises(lf.ConfigurationError, match=r"tac\.json: is not a record of lightflyer"):
        collect_records([tmp_path])


def test_a_folder_without_records(tmp_path):
    with pytest.raises(lf.ConfigurationError, match="has no record of the lab bench"):
        collect_records([tmp_path])
    with pytest.raises(lf.ConfigurationError, match="folders must be paths"):
        collect_records([3])
    with pytest.raises(lf.ConfigurationError, match="is not a folder"):
        collect_records([tmp_path / "none"])


def test_what_a_measurement_is_made_for_stands_out(tmp_path):
    """A run of a heater also has the numbers of its scatter and of its parts."""
    record = {"tac": NUMBER, "slope": NUMBER, "runs": {"a": {"tac": NUMBER}}, "warnings": []}
    write(tmp_path, "tac.json", record)
    write(tmp_path, "optics.json", {"numbers": {"layers.0.thickness": NUMBER}, "warnings": []})
    write(tmp_path, "force.json", {"measured_over_predicted": NUMBER, "warnings": []})
    found = {one.quantity for one in collect_records(tmp_path) if one.is_headline}
    assert found == {"tac", "numbers, layers.0.thickness", "measured_over_predicted"}
