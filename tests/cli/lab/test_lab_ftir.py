import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.config.reader import read_flyer_file
from lightflyer.lab.synthetic.spectra import true_transmittance

FILM = """\
[film]
extrapolation = "hold"
layers = [{material = "Ge", thickness = "20 nm"}, {material = "PET", thickness = "500 nm"}]
"""


def test_jcamp_to_record(examples, lab_prints):
    folder = examples("ftir")
    (folder / "film.toml").write_text(FILM, encoding="utf-8")
    lab_prints("ftir", "film.jdx", "--out", "o", "--film", "film.toml")
    names = {path.name for path in (folder / "o").iterdir()}
    assert names == {"emissivity.csv", *(f"ftir.{end}" for end in ("json", "nc", "png", "svg"))}
    table = lf.lab.read_spectrum(folder / "film.jdx")
    rows = np.loadtxt(folder / "o" / "emissivity.csv", delimiter=",", skiprows=1)
    assert rows[:, 0] == pytest.approx(table.wavenumber / 100.0)
    assert rows[:, 0] * rows[:, 1] == pytest.approx(1e4)
    assert rows[:, 2] == pytest.approx(1.0 - table.value, abs=1e-5)
    found = json.loads((folder / "o" / "ftir.json").read_text(encoding="utf-8"))
    said = "film.toml: the computed spectrum extrapolates Ge: hold beyond 0.4 µm to 15 µm"
    assert said in found["warnings"]
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


def test_reflectance_updates_a_flyer_file(examples, lab_prints, flyer_file):
    examples("ftir")
    path = flyer_file()
    update = ("ftir", "film.csv", "--reflectance", "film-reflectance.csv", "--update", path)
    found = json.loads(lab_prints(*update, "--accuracy", "0.5 %", "--face", "top", "--json"))
    assert found["emissivity"]["value"] == pytest.approx(0.1175, abs=1e-3)
    film = read_flyer_file(path).film
    assert film.emittance_top.value == pytest.approx(0.1175, abs=1e-3)
    assert film.emittance_top.uncertainty == pytest.approx(0.005 * np.sqrt(2.0), rel=0.02)
    assert film.emittance_bottom.value == 0.08
    flyer_file()
    out = lab_prints(*update)  # the default accuracy is written and named
    assert "warning: no accuracy of the spectrometer is stated; ± 1 % of full scale" in out
    assert read_flyer_file(path).film.emittance.uncertainty == pytest.approx(0.0141, abs=2e-4)


def test_a_bound_is_called_a_bound(examples, lab_prints):
    examples("ftir")
    out = lab_prints("ftir", "film.jdx", "--out", "o")
    assert "upper bound: emissivity at most 0.174 (95 %, one-sided)" in out
    with xr.open_dataset("o/ftir.nc", engine="h5netcdf") as record:
        assert "1 % of full scale is assumed" in record.attrs["warnings"]
    found = json.loads(lab_prints("ftir", "film.jdx", "--json"))
    assert "emissivity" not in found
    assert found["emissivity_upper_bound"]["at_most_95"] == pytest.approx(0.174, abs=5e-4)
    assert len(found["warnings"]) == 2


def test_wavenumbers_given_twice_are_said(folder, lab_prints):
    rows = "".join(f"{nu},{80 + more}\n" for nu in range(400, 4002, 2) for more in (0, 2))
    (folder / "t.csv").write_text(f"wavenumber [cm^-1],transmittance [%]\n{rows}")
    found = json.loads(lab_prints("ftir", "t.csv", "--json"))
    assert found["band_transmittance"]["value"] == pytest.approx(0.81)
    said = "t.csv: 3602 points have 1801 wavenumbers; each has their mean"
    assert said in found["warnings"]


def percent(folder, transmittance, reflectance):
    """Files of a flat transmittance and reflectance [%]."""
    for name, value in (("transmittance", transmittance), ("reflectance", reflectance)):
        rows = "".join(f"{nu},{value}\n" for nu in range(400, 4002, 2))
        (folder / f"{name}.csv").write_text(f"wavenumber [cm^-1],{name} [%]\n{rows}")
    return ["ftir", "transmittance.csv", "--reflectance", "reflectance.csv"]


def test_no_impossible_emissivity_leaves(folder, lab_refuses, flyer_file):
    path = flyer_file()
    before = path.read_text(encoding="utf-8")
    err = lab_refuses(*percent(folder, 80, 46), "--update", path)
    assert "emissivity over the band is -0.26" in err
    err = lab_refuses(*percent(folder, 80, 20.5), "--update", path)
    assert "not distinguishable from 0; it is at most 0.0233 (95 %, one-sided)" in err
    assert path.read_text(encoding="utf-8") == before


def test_what_an_instrument_says_is_shown_and_recorded(lab, lab_prints, lab_refuses):
    samples = Path(__file__).parents[2] / "lab" / "spectra"
    file = str(samples / "opus.0")
    out = lab_prints("ftir", file, "--accuracy", "0.5 %")
    assert 'Bruker OPUS with "absorbance", Tensor 27, resolution 4 cm-1, TRANS' in " ".join(
        out.split()
    )
    read = json.loads(lab_prints("ftir", file, "--json"))["read"][0]
    assert (read["format"], read["instrument"], read["resolution"], read["collection"]) == (
        "Bruker OPUS", "Tensor 27", "4 cm-1", None
    )  # fmt: skip
    err = lab_refuses("ftir", str(samples / "linked.jdx"), "--out", "o")
    assert "holds 5 spectra; choose one with --spectrum" in err
    code, _, err = lab("ftir", str(samples / "perkin-elmer-r.sp"))
    assert (code, err.endswith("perkin-elmer-r.sp: shows reflectance, not transmittance\n")) == (
        2,
        True,
    )
