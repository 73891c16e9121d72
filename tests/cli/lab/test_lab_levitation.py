import json
from importlib import resources

import numpy as np
import pytest
import xarray as xr

from lightflyer.config.reader import read_flyer_file


def test_points_to_record_with_model_and_calibration(examples, lab_prints):
    folder = examples("levitation")
    lf_file = folder / "flyer.toml"
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    lf_file.write_text(template.read_text(encoding="utf-8"), encoding="utf-8")
    out = lab_prints(
        "levitation", "levitation.csv", "--flyer", lf_file, "--calibrate", "--update", lf_file,
        "--out", "o", "--draws", "300", "--pressure-unit", "Torr",
    )  # fmt: skip
    assert "Ge 2 cm needs" in out
    curve = np.loadtxt(folder / "o" / "levitation-curve-1.csv", delimiter=",", skiprows=2)
    assert np.all((curve[:, 2] <= curve[:, 1]) & (curve[:, 1] <= curve[:, 3]))
    found = json.loads((folder / "o" / "levitation.json").read_text(encoding="utf-8"))
    low, high = found["samples"]["Ge 2 cm"]["minimum_irradiance"]["interval_95"]
    assert low < 983.1 < high  # stands in the file
    assert found["samples"]["Ge 2 cm"]["optimal_pressure"]["unit"] == "Pa"
    assert found["comparisons"][0]["a"] == "Ge 2 cm"
    assert found["samples"]["CNT 2 cm"]["points"] + found["samples"]["Ge 2 cm"]["points"] == 54
    with xr.open_dataset(folder / "o" / "levitation.nc", engine="h5netcdf") as record:
        assert record.sizes["sample"] == 2
    assert (folder / "o" / "levitation.svg").exists()
    assert read_flyer_file(lf_file).force.c_fm.value == pytest.approx(0.4, rel=0.05)


def test_launchpads_are_compared_and_the_near_floor_named(examples, lab):
    examples("levitation")
    code, out, err = lab("levitation", "launchpads.csv", "--draws", "200", "--json")
    assert code == 0
    found = json.loads(out)
    assert err == ""
    said = "Ge 2 cm on plate is in ground effect: the floor is 5 mm below"
    assert said in " ".join(found["warnings"])
    low, high = found["comparisons"][0]["reduction"]["interval_95"]
    assert low < 0.1 < high


def test_steps_in_the_record(folder, lab_prints):
    rows = [f"{2 + i},{200 * (6 + (i - 4) ** 2)}" for i in range(10)]
    text = "\n".join(["pressure [Pa],irradiance [W/m^2]", *rows]) + "\n"
    (folder / "raw.csv").write_text(text, encoding="utf-8")
    out = lab_prints("levitation", "raw.csv", "--draws", "200")
    assert "warning: the irradiances of raw lie on steps of 200 W/m^2" in out
    out = lab_prints(
        "levitation", "raw.csv", "--draws", "200", "--step", "200 W/m^2", "--json", "--out", "o"
    )
    found = json.loads(out)
    assert found["samples"]["raw"]["step"] == 200.0
    assert not any("steps" in text for text in found["warnings"])
    with xr.open_dataset(folder / "o" / "levitation.nc", engine="h5netcdf") as record:
        assert record.attrs["warnings"] == "; ".join(found["warnings"])


def test_a_heated_gauge_in_the_gas_and_at_the_temperature_of_the_chamber(examples, lab, lab_prints):
    examples("levitation")
    tail = ("--gauge-temperature", "45 °C", "--gauge-tube", "5 mm", "--draws", "200", "--json")

    def pressures(*options):
        samples = json.loads(lab_prints("levitation", "levitation.csv", *options, *tail))["samples"]
        return [one["optimal_pressure"]["value"] for one in samples.values()]

    # thin gas creeps by the root of the temperatures, dense gas not at all; helium is thinner
    air, helium = pressures(), pressures("--gas", "helium", "--gauge-factor", "1")
    assert all(one < other for one, other in zip(helium, air, strict=True))
    warmer = pressures("--ambient", "310 K")
    assert all(one > other for one, other in zip(warmer, air, strict=True))
    same = pressures("--ambient", "45 °C")
    plain = json.loads(lab("levitation", "levitation.csv", "--draws", "200", "--json")[1])[
        "samples"
    ]
    for one, other in zip(same, plain.values(), strict=True):
        assert one == pytest.approx(other["optimal_pressure"]["value"], rel=1e-9)
