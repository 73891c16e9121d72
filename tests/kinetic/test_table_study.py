"""The tables that ship are those that the study's points give."""

import importlib.util
import sys
from importlib.resources import files
from pathlib import Path

import pytest

STUDY = Path(__file__).parents[2] / "studies" / "kinetic_table" / "study.py"


@pytest.fixture
def study(monkeypatch):
    spec = importlib.util.spec_from_file_location("kinetic_table_study", STUDY)
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, spec.name, module)
    spec.loader.exec_module(module)
    return module


def test_tables_are_made_of_all_points(study, tmp_path, monkeypatch):
    monkeypatch.setattr(study, "DATA", tmp_path)
    found = study.read_kept()
    for part in ("linear", "boundary", "nonlinear"):
        assert study.groups(part, found) == []
    study.write_table(found)
    study.write_boundaries(found)
    for name in ("kinetic.csv", "kinetic_boundary.csv"):
        shipped = files("lightflyer.data").joinpath(name).read_text("utf-8")
        assert (tmp_path / name).read_text() == shipped


def test_a_solved_point_is_that_of_the_study(study):
    """The code as it is gives a line of points.jsonl again."""
    point = study.Point("monatomic", 10.0, 1.0, study.BOUNDARY_TAC, boundary=4.0)  # one mesh only
    (solved,) = study.measure([point]).values()
    kept = study.read_kept()[point]
    assert solved["force_ratio"] == pytest.approx(kept["force_ratio"], rel=1e-6)
    assert solved["heat_ratio"] == pytest.approx(kept["heat_ratio"], rel=1e-6)
