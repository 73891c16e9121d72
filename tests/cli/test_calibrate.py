import json
from pathlib import Path

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.core.errors import Doubt


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch, film):
    """A folder with synthetic points of the paper's disk; commands run in it."""
    pressure = np.geomspace(1.5, 20.0, 6)
    disk, state = lf.Disk(film, 0.01), lf.Chamber(temperature=293.0).state(pressure)
    light = lf.levitate(disk, state, lf.Lu2023(0.45, 2.5)).irradiance
    rows = [f"=1+1, {p:.8g}, {i / 1e3:.8g}" for p, i in zip(pressure, light, strict=True)]
    text = "\n".join(["sample, pressure [Pa], irradiance [kW/m^2]", *rows]) + "\n"
    (tmp_path / "points.csv").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_fits_and_writes(folder, prints):
    first = prints("calibrate", "points.csv", "--out", "fit").splitlines()[0]
    assert first.startswith("6 points of 1 sample give c_fm 0.45 (")
    assert " and c_cont 2.5 (" in first
    fit = json.loads((folder / "fit" / "calibration.json").read_text(encoding="utf-8"))
    assert fit["parameters"]["c_fm"]["value"] == pytest.approx(0.45, rel=1e-4)
    assert fit["parameters"]["c_cont"]["value"] == pytest.approx(2.5, rel=1e-4)
    assert np.shape(fit["covariance"]) == (2, 2)
    assert fit["samples"] == ["=1+1"]
    names = {path.name for path in (folder / "fit").iterdir()}
    assert names == {"calibration.json", "residuals.csv", "residuals.png", "residuals.svg"}
    rows = (folder / "fit" / "residuals.csv").read_text(encoding="utf-8").splitlines()[1:]
    assert len(rows) == 6
    assert all(row.startswith("'=1+1,") for row in rows)  # no formula


def test_flyer_file_and_names_in_full(folder, run):
    run("init", "--kind", "chamber", "flyer.toml")
    _, printed, errors = run(
        "calibrate", "points.csv", "--flyer", "flyer.toml", "--free", "force.c_fm, c_cont",
        "--pressure-accuracy", "50 %", "--irradiance-accuracy", "0 %", "--json",
    )  # fmt: skip
    parameters = json.loads(printed)["parameters"]
    assert parameters["force.c_fm"]["value"] == pytest.approx(0.45, rel=1e-4)
    assert "is 50 %: more than of any such instrument" in errors


def test_table_and_json_say_which_interval_is_which(folder, prints):
    prints("init", "--kind", "chamber", "flyer.toml")
    text = (folder / "flyer.toml").read_text(encoding="utf-8")
    for name, value in (("tac_top", 0.8), ("tac_bottom", 0.9)):
        text = text.replace(f"{name} = {value} ", f'{name} = "{value} ± 0.03" ')
    (folder / "flyer.toml").write_text(text, encoding="utf-8")
    shown = prints("calibrate", "points.csv", "--flyer", "flyer.toml")
    assert "given inputs: the points' scatter alone" in shown
    assert "total: also the ± of film.tac_top (30 %" in shown
    assumed = "warning: no accuracy of these is stated, and assumed: pressure gauge ± 5 %, light"
    assert assumed in " ".join(shown.split())
    accuracies = "--pressure-accuracy", "5 %", "--irradiance-accuracy", "5 %"
    printed = prints("calibrate", "points.csv", "--flyer", "flyer.toml", "--json", *accuracies)
    found = json.loads(printed)
    low, high = found["parameters"]["c_fm"]["total_interval_95"]
    assert low < 0.3 < 0.9 < high
    assert found["inputs_in_total"] == [
        "film.tac_top", "film.tac_bottom", "pressure gauge", "light meter",
    ]  # fmt: skip
    assert found["warnings"] == []


def test_reads_what_the_lab_command_reads(folder, prints):
    prints("lab", "example", "levitation")
    shown = prints("calibrate", "levitation.csv")
    assert "rejected levitation.csv:" in shown
    printed = prints("calibrate", "launchpads.csv", "--keep-ground-effect", "--json")
    assert json.loads(printed)["samples"] == ["Ge 2 cm on mesh", "Ge 2 cm on plate"]


def test_the_points_of_the_documentation(folder):
    page = Path(__file__).parents[2] / "docs" / "calibration.md"
    table = page.read_text(encoding="utf-8").split("```text\n")[1].split("```")[0]
    (folder / "points.csv").write_text(table, encoding="utf-8")
    points = lf.calibration.read_points("points.csv")
    assert len({*points.samples}) > 1
    assert {"pressure", "irradiance", "diameter"} <= {*points.numbers}


@pytest.fixture
def changed(folder):
    """A file of the points of two disks, after a change of its rows, beside a flyer file."""
    (folder / "chamber.toml").write_text(templates()["chamber"].read(), encoding="utf-8")
    lines = templates()["points"].read().splitlines()
    head, *rows = [line for line in lines if not line.startswith("#")]
    rows = [row.split(", ") for row in rows]

    def written(change, header=None):
        text = "\n".join([header or head, *(", ".join(row) for row in change(rows))]) + "\n"
        (folder / "some.csv").write_text(text, encoding="utf-8")
        return "some.csv"

    return written


@pytest.fixture
def measured(changed, run):
    """Calibrate a flyer file by some of the points."""

    def calibrated(*options, change=lambda rows: rows):
        code, shown, errors = run("calibrate", changed(change), "--flyer", "chamber.toml",
                                  "--update", "chamber.toml", *options)  # fmt: skip
        return code, shown, errors, Path("chamber.toml").read_text(encoding="utf-8")

    return calibrated


def test_what_fits_is_written_with_its_total_and_origin(measured):
    code, shown, errors, text = measured()
    assert code == 0, errors
    assert 'chamber.toml: force.c_fm = "0.401 ± 0.019"' in shown
    assert 'c_cont = "3.05 ± 0.49"  # measured: calibrate, some.csv, 20' in text
    code, shown, _, text = measured()  # again: the same number, in the same place
    assert (code, text.count("measured: calibrate")) == (0, 2)


@pytest.mark.parametrize(
    ("change", "header", "says"),
    [
        (lambda rows: [row for row in rows if float(row[1]) < 40], None,
         "c_cont limits the force at no point: by at most"),
        (lambda rows: [row for row in rows if float(row[1]) > 50], None,
         "c_fm limits the force at no point: by at most"),
        (lambda rows: [[*row[:3], "1", *row[4:]] for row in rows], None,
         "times as much as their stated uncertainties say"),
        (lambda rows: [rows[0], rows[-1]], None, "nothing shows whether the model fits"),
        (lambda rows: rows + rows, None, "9 of 18 rows are copies of others"),
        # of another unit: all light is a tenth, at the same uncertainties
        (lambda rows: [[row[0], row[1], f"{0.1 * float(row[2])}", f"{0.1 * float(row[3])}",
                        *row[4:]] for row in rows], None, "times as much"),
        (lambda rows: [[row[0], f"{0.1 * float(row[1])}", *row[2:]] for row in rows], None,
         "pressure of least irradiance times diameter = 0.006933 Pa*m is unlikely"),
        # without uncertainties, up and down by half
        (lambda rows: [[row[0], row[1], f"{float(row[2]) * (0.5, 1.5)[number % 2]}", row[4]]
                       for number, row in enumerate(rows)],
         "sample, pressure [mTorr], irradiance [W/m^2], diameter [cm]",
         "scatter of the points 0.5"),
    ],
)  # fmt: skip
def test_what_is_in_doubt_is_said_as_such(changed, change, header, says):
    fit = lf.calibrate(
        "chamber.toml", points=lf.calibration.read_points(changed(change, header)),
        pressure_accuracy=0.0, irradiance_accuracy=0.0,
    )  # fmt: skip
    assert any(isinstance(one, Doubt) and says in one for one in fit.warnings)


def test_what_is_in_doubt_is_written_on_demand_only(measured):
    before, says = Path("chamber.toml").read_text(encoding="utf-8"), "8 of 16 rows are copies"
    code, shown, errors, text = measured("--out", "o", change=lambda rows: 2 * rows[:8])
    assert (code, shown, text) == (2, "", before)
    assert says in errors
    assert "--insist writes it all the same; chamber.toml is unchanged" in errors
    assert len(errors.splitlines()) == 1
    assert not Path("o").exists()
    code, shown, errors, text = measured("--insist", change=lambda rows: 2 * rows[:8])
    assert code == 0, errors
    assert text != before
    assert says in " ".join(shown.split())


def test_what_no_flyer_file_takes_is_a_line(measured, run, refuses):
    code, _, errors, _ = measured("--free", "c_fm[Ge 2 cm]")
    assert code == 2
    assert "c_fm[Ge 2 cm]: of one sample each; a flyer file has one flyer" in errors
    run("init", "kinetic.toml")
    before = Path("kinetic.toml").read_text(encoding="utf-8")
    errors = refuses("calibrate", "some.csv", "--update", "kinetic.toml")
    assert 'force.c_fm belongs to model = "lu2023"' in errors
    assert Path("kinetic.toml").read_text(encoding="utf-8") == before
    assert "--insist needs --update" in refuses("calibrate", "some.csv", "--insist")
