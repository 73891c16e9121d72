import json

import numpy as np
import pytest
import xarray as xr

from lightflyer.config.reader import read_flyer_file
from lightflyer.lab.synthetic.ftir import true_transmittance

FILM = """\
[film]
extrapolation = "hold"
layers = [{material = "Ge", thickness = "20 nm"}, {material = "PET", thickness = "500 nm"}]
"""


def test_jcamp_to_record(examples, lab):
    folder = examples("ftir")
    (folder / "film.toml").write_text(FILM, encoding="utf-8")
    code, _, err = lab("ftir", "film.jdx", "--out", "o", "--film", "film.toml")
    assert (code, err) == (0, "")
    assert {path.suffix for path in (folder / "o").iterdir()} == {".json", ".nc", ".png", ".svg"}
    found = json.loads((folder / "o" / "ftir.json").read_text(encoding="utf-8"))
    fine = np.linspace(500.0, 1300.0, 100_001)
    truth = np.trapezoid(true_transmittance(fine), fine) / 800.0
    low, high = found["band_transmittance"]["interval_95"]
    assert low - 1e-4 < truth < high + 1e-4  # the points are coarser than the bands by a little
    assert found["emissivity_upper_bound"]["value"] == pytest.approx(1.0 - truth, abs=1e-3)
    assert set(found["planck_weighted"]) == {"300", "400", "441", "500"}
    assert found["uncovered_fraction"]["300"]["value"] == pytest.approx(0.1656, abs=1e-4)
    assert found["uncovered_fraction"]["band"]["value"] == 0.0
    with xr.open_dataset(folder / "o" / "ftir.nc", engine="h5netcdf") as record:
        assert record.transmittance_0.size == 1801


def test_reflectance_updates_a_flyer_file(examples, lab, flyer_file):
    examples("ftir")
    path = flyer_file()
    code, out, _ = lab("ftir", "film.csv", "--reflectance", "film-reflectance.csv", "--update",
                       path, "--accuracy", "0.5 %", "--face", "top", "--json")  # fmt: skip
    assert code == 0
    found = json.loads(out)
    assert found["emissivity"]["value"] == pytest.approx(0.1175, abs=1e-3)
    film = read_flyer_file(path).film
    assert film.emittance_top.value == pytest.approx(0.1175, abs=1e-3)
    assert film.emittance_top.uncertainty == pytest.approx(0.005 * np.sqrt(2.0), rel=0.02)
    assert film.emittance_bottom.value == 0.08


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["missing.jdx"], "missing.jdx: cannot be read"),
        (["film.jdx", "--update", "a.toml"], "upper bound"),
        (["film.jdx", "--band", "900 cm^-1"], "has no width"),
        (["film.jdx", "--band", "9000 ± 400 cm^-1"], "no data in the band"),
        (["film.jdx", "--temperatures", "0 K"], "temperatures = 0 is not positive"),
        (["film-reflectance.csv"], "shows reflectance, not transmittance"),
    ],
)
def test_bad_input(examples, lab, arguments, says):
    folder = examples("ftir")
    code, out, err = lab("ftir", *arguments, "--out", "o")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert says in err
    assert not (folder / "o").exists()
