import json

import pytest
import xarray as xr

from lightflyer.config.reader import read_flyer_file


def test_raw_file_to_record_figure_and_flyer_file(examples, lab):
    folder = examples("tac")
    code, out, err = lab("tac", "tac-raw.csv", "--calibration", "tac-resistance.csv", "--out", "o")
    assert (code, err) == (0, "")
    assert "rejected tac-raw.csv:42: repeats line 41" in out
    names = {path.name for path in (folder / "o").iterdir()}
    assert names == {"tac.json", "tac.nc", "tac.png", "tac.svg"}
    found = json.loads((folder / "o" / "tac.json").read_text(encoding="utf-8"))
    for name, truth, unit in (
        ("tac", 0.75, ""), ("area_ratio", 1.22, ""), ("offset", 4.09, "W/(m^2 K)")
    ):  # fmt: skip
        low, high = found[name]["interval_95"]
        assert low <= truth <= high
        assert low < found[name]["value"] < high
        assert found[name]["unit"] == unit
    assert found["rows_used"] + found["rows_dropped"] == found["read"][0]["rows"]
    assert len(found["read"][0]["rejected"]) == 3
    with xr.open_dataset(folder / "o" / "tac.nc", engine="h5netcdf") as record:
        assert record.sizes["row"] == found["rows_used"]
        assert record.pressure.units == "Pa"


def test_several_runs_are_averaged_and_written_into_a_flyer_file(examples, lab, flyer_file):
    examples("tac")
    path = flyer_file()
    code, out, err = lab(
        "tac", "tac-raw.csv", "tac-reduced.txt", "--calibration", "tac-resistance.csv",
        "--update", path, "--face", "bottom", "--json",
    )  # fmt: skip
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert set(found["runs"]) == {"tac-raw.csv", "tac-reduced.txt"}
    read = read_flyer_file(path).film
    assert read.tac_bottom.value == pytest.approx(found["tac"]["value"], abs=1e-3)
    assert read.tac_top.value == 0.8
    assert "measured: lab tac, printed reading, tac-raw.csv, tac-reduced.txt, " in path.read_text(
        encoding="utf-8"
    )


HEADER = "pressure [Pa],heater_power [W],heater_temperature [K],ambient_temperature [K]\n"


@pytest.mark.parametrize(
    ("text", "arguments", "says"),
    [
        ("", [], "raw.csv: is empty"),
        (HEADER + "1,1,320,295\n", [], "raw.csv:2: has 1 usable row;"),
        (HEADER + "1,0.05,320,295\n" * 9, [], "raw.csv: its pressures do not determine"),
        (HEADER + "1,-0.05,320,295\n", [], "raw.csv:2: heater_power = -0.05 W is not positive"),
        (HEADER + "1,0.05,290,295\n", [], "raw.csv:2: the heater at 290.00 K is not warmer"),
        (HEADER.replace("pressure", "Größe"), [], "raw.csv: has a header but no rows"),
        ("pressure [Pa],heater_power [W]\n1,2\n", [], "raw.csv: needs the column heater_temp"),
        (HEADER + "1,1,320,295\n", ["--diameter", "24"], "--diameter: "),
        (HEADER + "1,1,320,295\n", ["--emissivity", "2"], "emissivity = 2 is not between"),
        (HEADER + "1,1,320,295\n", ["--update", "none.toml"], ""),
    ],
)
def test_bad_input(folder, lab, text, arguments, says):
    (folder / "raw.csv").write_text(text, encoding="utf-8")
    code, out, err = lab("tac", "raw.csv", "--out", "o", *arguments)
    assert code == 2
    assert says in err
    assert err.count("\n") == 1
    assert err.startswith("lightflyer: error: ")
    assert out == ""
    assert not (folder / "o").exists()
