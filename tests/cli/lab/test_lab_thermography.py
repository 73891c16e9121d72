import json

import pytest
import xarray as xr

from lightflyer.config.reader import read_flyer_file


def test_table_to_record_and_flyer_file(examples, lab, flyer_file):
    folder = examples("thermography")
    path = flyer_file()
    code, _, err = lab("thermography", "thermal.csv", "--accuracy", "0.5 K", "--out", "o",
                       "--update", path)  # fmt: skip
    assert (code, err) == (0, "")
    found = json.loads((folder / "o" / "thermography.json").read_text(encoding="utf-8"))
    for name, truth in (("reflectance", 0.12), ("transmittance", 0.80), ("emissivity", 0.08)):
        low, high = found[name]["interval_95"]
        assert low < truth < high
        assert found["monte_carlo"][name]["unit"] == ""
    film = read_flyer_file(path).film
    assert film.emittance.value == pytest.approx(found["emissivity"]["value"], abs=1e-3)
    with xr.open_dataset(folder / "o" / "thermography.nc", engine="h5netcdf") as record:
        assert record.hotplate_temperature.units == "K"
    assert (folder / "o" / "thermography.png").exists()


def test_light_meter_gives_the_absorptance(examples, lab, flyer_file):
    examples("thermography")
    path = flyer_file()
    code, out, _ = lab("thermography", "light-meter.csv", "--light-meter", "--json", "--update",
                       path, "--face", "top")  # fmt: skip
    assert code == 0
    assert json.loads(out)["absorptivity"]["value"] == pytest.approx(0.75, abs=2e-3)
    assert read_flyer_file(path).film.absorptance.value == pytest.approx(0.75, abs=2e-3)


GIVEN = ["--hotplate", "150 °C", "--lower", "50 °C", "--upper", "130 °C", "--ambient", "22 °C"]


def test_one_row_without_uncertainty(folder, lab):
    names = ("hotplate", "lower", "upper", "ambient")
    header = ",".join(f"{name}_temperature [K]" for name in names)
    (folder / "one.csv").write_text(f"{header}\n423.15,320.15,406.15,295.15\n")
    code, out, _ = lab("thermography", str(folder / "one.csv"), "--out", str(folder / "out"))
    assert code == 0
    assert "the interval of one row has no width" in out
    assert (folder / "out" / "thermography.png").exists()


def test_scalars(lab):
    code, out, _ = lab("thermography", *GIVEN, "--accuracy", "0.5 °C", "--json")
    assert code == 0
    found = json.loads(out)["emissivity"]
    assert found["value"] == pytest.approx(0.0952, abs=1e-3)
    assert found["interval_95"][1] - found["value"] == pytest.approx(0.0178, rel=0.1)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "give a file, or also hotplate_temperature"),
        (["missing.csv"], "missing.csv: cannot be read"),
        (["missing.jpg", "--regions", "a=1:2,3:4"], "missing.jpg: cannot be read"),
        (["missing.jpg"], "an image needs --regions"),
        ([*GIVEN[:-1], "160 °C"], "hotplate_temperature is not above ambient_temperature"),
        ([*GIVEN[:-1], "22"], "--ambient: "),
        (["--light-meter", *GIVEN], "--light-meter needs a file"),
    ],
)
def test_bad_input(folder, lab, arguments, says):
    code, out, err = lab("thermography", *arguments, "--out", "o")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert says in err
    assert not (folder / "o").exists()
