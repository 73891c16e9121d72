"""The tables that ship are those that the study's points give."""

import csv
from importlib.resources import files

import numpy as np
import pytest

from lightflyer.array.namespace import float64
from lightflyer.force.kinetic.ratios import kinetic_fit


@pytest.fixture(scope="module")
def study(study_of):
    with study_of("kinetic_table", "study") as module:
        yield module


@pytest.fixture(scope="module")
def found(study):
    return study.read_kept()


def rows_of(text):
    return list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))


def test_tables_are_made_of_all_points(study, found, tmp_path, monkeypatch):
    monkeypatch.setattr(study, "DATA", tmp_path)
    for part, points in study.parts().items():
        assert [point for point in points if point not in found] == [], part
    study.write_boundaries(found)
    study.write_table(found)
    for name, exact in (("kinetic.csv", 8), ("kinetic_boundary.csv", 5)):
        shipped = rows_of(files("lightflyer.data").joinpath(name).read_text("utf-8"))
        made = rows_of((tmp_path / name).read_text())
        assert [row[:exact] for row in made] == [row[:exact] for row in shipped]
        # errors are those of a fit, whose last digits are the linear algebra's
        errors = [np.array([row[exact:] for row in rows[1:]], float) for rows in (made, shipped)]
        np.testing.assert_allclose(*errors, rtol=0.2)


def test_a_solved_point_is_that_of_the_study(study, found):
    """The code as it is gives lines of points.jsonl again: linear, and colder than the gas."""
    linear = study.Point(
        "monatomic", 10.0, 1.0, study.BOUNDARY_TAC, study.SMALL, "medium", None, 4.0
    )
    (results,) = study.solved([linear])
    for name, value in results[linear].items():
        assert value == pytest.approx(found[linear][name], rel=1e-6)


def test_fit_holds_where_the_study_checks_it(study, found):
    """Solutions that made no row of the table, corrected for the coarse mesh as rows are."""
    mesh_errors = study.errors_of_growth(found)
    checks = [point for point in study.parts()["checks"] if point.ratio != 1.0]
    assert len(checks) == 12
    for gas in study.GASES:
        rows = [
            (place, study.best(place, found, mesh_errors))
            for place in (study.replace(point, mesh="") for point in checks if point.gas == gas)
        ]
        table, fit = study.as_table(rows), kinetic_fit(gas)
        with float64():
            stated = 3.0 * np.array(fit.table_errors(table.knudsen))
        unlike = table.tac_difference > study.SMALL
        bounds = np.where(unlike, [[0.01], [0.005]], stated)
        assert np.all(abs(study.misfit(fit, table)) < bounds)
