import json
import re

import numpy as np
import openpyxl
import pytest
import xarray as xr

from lightflyer.config.reader import read_flyer_file
from lightflyer.lab.tac.fit import heater_power
from lightflyer.uncertainty import propagate

LU2023_FORCE = """\
model = "lu2023"
reading = "reported"
c_fm = 0.4
c_cont = 3.0
"""
KINETIC_FORCE = (LU2023_FORCE, 'model = "kinetic"\n')


def test_raw_file_to_record_figure_and_flyer_file(examples, lab_prints):
    folder = examples("tac")
    out = lab_prints("tac", "tac-raw.csv", "--calibration", "tac-resistance.csv", "--out", "o")
    assert "rejected tac-raw.csv:42: repeats line 41" in out
    assert "reading kinetic, gas air; the same rows give α = " in out
    names = {path.name for path in (folder / "o").iterdir()}
    assert names == {"tac.json", "tac.nc", "tac.png", "tac.svg", "tac-rows-1.csv"}
    rows = np.loadtxt(folder / "o" / "tac-rows-1.csv", delimiter=",", skiprows=2)
    assert np.abs(rows[:, 2] / rows[:, 3] - 1.0).max() < 0.05
    found = json.loads((folder / "o" / "tac.json").read_text(encoding="utf-8"))
    for name, truth, unit in (
        ("tac", 0.75, ""), ("area_ratio", 1.22, ""), ("offset", 4.09, "W/(m^2 K)")
    ):  # fmt: skip
        low, high = found[name]["interval_95"]
        assert low <= truth <= high
        assert low < found[name]["value"] < high
        assert found[name]["unit"] == unit
        inner_low, inner_high = found["statistical_interval_95"][name]
        assert low < inner_low < inner_high < high
    assert found["accuracy"]["gauge"] == 0.05
    (said,) = found["warnings"]
    assert said == (
        "no accuracy of these is stated, and assumed: pressure gauge ± 5 %, gauge's zero "
        "± 0.01 Pa, power ± 1 %, temperature difference ± 1 K, diameter 24 ± 0.1 mm, plateau ± 5 %"
    )
    assert found["rows_used"] + found["rows_dropped"] == found["read"][0]["rows"]
    assert len(found["read"][0]["rejected"]) == 3
    with xr.open_dataset(folder / "o" / "tac.nc", engine="h5netcdf") as record:
        assert record.sizes["row"] == found["rows_used"]
        assert record.pressure.units == "Pa"
        assert record.attrs["warnings"] == said


def test_several_runs_are_averaged_and_written_into_a_flyer_file(examples, lab_prints, flyer_file):
    examples("tac")
    path = flyer_file(*KINETIC_FORCE)
    out = lab_prints(
        "tac", "tac-raw.csv", "tac-reduced.txt", "--calibration", "tac-resistance.csv",
        "--update", path, "--face", "bottom", "--json",
    )  # fmt: skip
    found = json.loads(out)
    assert set(found["runs"]) == {"tac-raw.csv", "tac-reduced.txt"}
    assert len(found["warnings"]) == 1
    read = read_flyer_file(path).film
    assert read.tac_bottom.value == pytest.approx(found["tac"]["value"], abs=1e-3)
    assert read.tac_top.value == 0.8
    # the gauge and the plateau are in it, and two runs do not halve them
    assert read.tac_bottom.uncertainty > 0.05
    text = path.read_text(encoding="utf-8")
    assert "measured: lab tac, kinetic reading, in air, tac-raw.csv, tac-reduced.txt, " in text


def test_both_faces_are_written_with_their_correlation(examples, lab_prints, flyer_file):
    folder = examples("tac")
    path = flyer_file(*KINETIC_FORCE)
    faces = ("--top", "tac-top.txt", "--bottom", "tac-bottom.txt")
    out = lab_prints("tac", *faces, "--out", "o", "--update", path)
    assert "the errors of both have a correlation of 0.9" in out
    names = {one.name for one in (folder / "o").iterdir()}
    assert {"tac-difference.csv", "tac-difference.png", "tac-rows-1.csv", "tac-rows-2.csv"} < names
    found = json.loads((folder / "o" / "tac.json").read_text(encoding="utf-8"))
    low, high = found["difference"]["interval_95"]
    assert low <= 0.75 - 0.88 <= high
    widths = [np.ptp(found[name]["interval_95"]) for name in ("tac_top", "tac_bottom")]
    assert high - low < 0.5 * min(widths)
    with xr.open_dataset(folder / "o" / "tac.nc", engine="h5netcdf") as record:
        assert set(record.face_of_row.values) == {"top", "bottom"}
        apart = np.array([1.0, -1.0])
        variance = apart @ record.tac_covariance.values @ apart
        assert np.sqrt(variance) == pytest.approx(float(record.tac_difference_uncertainty))
    # bands know of it: the force goes with the difference, however the faces share that
    film = read_flyer_file(path).film
    text = path.read_text(encoding="utf-8")
    text = text.replace('model = "kinetic"', 'model = "kinetic"\nsharing_error = 0')
    path.write_text(text, encoding="utf-8")
    assert film.tac_correlation.value == pytest.approx(found["tac_correlation"], abs=1e-3)
    known = propagate(path, samples=0)
    assert known.tac_correlation == film.tac_correlation.value
    path.write_text(re.sub(r"(?m)^tac_correlation = .*$", "", text), encoding="utf-8")
    unknown = propagate(path, samples=0)
    name = "best.lift_over_weight"
    assert known.first_order[name] < 0.7 * unknown.first_order[name]


def test_accuracy_widens_what_is_written(examples, lab_prints, flyer_file):
    examples("tac")
    written = {}
    for gauge in ("0.25 %", "15 %"):
        path = flyer_file(*KINETIC_FORCE)
        lab_prints(
            "tac", "tac-reduced.txt", "--gauge-accuracy", gauge, "--plateau-accuracy", "1 %",
            "--diameter", "24.0 ± 0.01 mm", "--update", path, "--face", "top",
        )  # fmt: skip
        written[gauge] = read_flyer_file(path).film.tac_top.uncertainty
    assert written["0.25 %"] < 0.03 < 0.09 < written["15 %"]


def test_update_needs_a_face(examples, lab_prints, lab_refuses, flyer_file):
    examples("tac")
    path = flyer_file()
    before = path.read_text(encoding="utf-8")
    err = lab_refuses("tac", "tac-reduced.txt", "--update", path, "--out", "o")
    assert "--update needs --face top, bottom or both: a heater gives one coefficient" in err
    assert path.read_text(encoding="utf-8") == before
    out = lab_prints("tac", "tac-reduced.txt", "--update", path, "--face", "both")
    assert "flyer.toml: the same coefficient on both faces gives a flyer without force" in out


def test_another_reading_of_the_flyer_file_is_told(examples, lab_prints, flyer_file):
    folder = examples("tac")
    path = flyer_file()
    arguments = ("tac", "tac-reduced.txt", "--update", path, "--face", "top")
    out = lab_prints(*arguments, "--out", "o", "--format", "svg")
    says = "its force model lu2023 takes the heat loss by the reading reported, by which the same"
    assert says in out
    with xr.open_dataset(folder / "o" / "tac.nc", engine="h5netcdf") as record:
        assert says in record.attrs["warnings"]
    path = flyer_file(*KINETIC_FORCE)
    stated = ("--gauge-zero", "0.01 Pa", "--power-accuracy", "1 %", "--plateau-accuracy", "5 %",
              "--temperature-accuracy", "1 K", "--gauge-accuracy", "5 %",
              "--diameter", "24 ± 0.1 mm")  # fmt: skip
    assert "warning" not in lab_prints(*arguments, *stated)


def test_another_gas_of_the_flyer_file_is_told(examples, lab_prints, lab_refuses, flyer_file):
    folder = examples("tac")
    path = flyer_file(*KINETIC_FORCE)
    arguments = ("tac", "tac-reduced.txt", "--update", path, "--face", "top", "--gas")
    assert "--gauge-factor 1.7" in lab_refuses(*arguments, "argon", "--out", "o")
    arguments = (*arguments[:2], "--gauge-accuracy", "5 %", *arguments[2:])
    out = lab_prints(*arguments, "argon", "--out", "o", "--format", "svg")
    assert "air, and the coefficient written was measured in argon: a film has another" in out
    with xr.open_dataset(folder / "o" / "tac.nc", engine="h5netcdf") as record:
        assert record.attrs["gas"] == "argon"
    assert "measured in" not in lab_prints(*arguments, "us1976-air")


HEADER = "pressure [Pa],heater_power [W],heater_temperature [K],ambient_temperature [K]\n"


def test_undetermined_coefficient_is_not_written(folder, lab_refuses, flyer_file):
    pressure = np.geomspace(1.0, 2.5, 20)
    noise = 1.0 + 0.02 * np.random.default_rng(3).normal(size=20)
    power = heater_power(pressure, np.full(20, 323.0), np.full(20, 295.0), 0.75, 1.22, 4.09) * noise
    rows = (f"{p:.6g},{w:.6g},323.0,295.0\n" for p, w in zip(pressure, power, strict=True))
    (folder / "raw.csv").write_text(HEADER + "".join(rows), encoding="utf-8")
    path = flyer_file()
    before = path.read_text(encoding="utf-8")
    err = lab_refuses("tac", "raw.csv", "--update", path, "--face", "top", "--out", "o")
    assert "raw.csv: these rows do not determine the accommodation coefficient; they have" in err
    assert "Pa or beyond would determine it; " in err
    assert path.read_text(encoding="utf-8") == before
    assert not (folder / "o").exists()


def test_a_sheet_and_a_clock_before_the_numbers(examples, lab_prints, lab_refuses):
    folder = examples("tac")
    text = (folder / "tac-reduced.txt").read_text(encoding="utf-8-sig")
    rows = [line for line in text.splitlines() if re.match(r"[-\d]", line)]
    clocked = [f"10:{number:02};{row}" for number, row in enumerate(rows)]
    (folder / "clock.csv").write_text("\n".join(clocked), encoding="utf-8")
    columns = "-,pressure [Pa],power [mW],heater_temperature [°C],ambient_temperature [°C]"
    expected, *_ = lab_prints("tac", "tac-reduced.txt").splitlines()
    assert lab_prints("tac", "clock.csv", "--columns", columns).startswith(expected)
    book = openpyxl.Workbook()
    for sheet, lines in (("May 3", rows), ("June", rows[:9])):
        book.create_sheet(sheet)
        book[sheet].append(["p", "q", "t", "u"])
        for line in lines:
            book[sheet].append([as_number(cell) for cell in line.split(";")])
    book.save(folder / "runs.xlsx")
    columns = columns.removeprefix("-,")
    assert lab_prints("tac", "runs.xlsx#May 3", "--columns", columns).startswith(expected)
    assert 'in a sheet "July"; it has' in lab_refuses("tac", "runs.xlsx#July")


def as_number(cell):
    return float(cell.replace(",", ".")) if re.fullmatch(r"[-\d,.]+", cell) else cell
