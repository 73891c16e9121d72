"""`film` and `materials` as a user runs them, and flyer files with layers."""

import contextlib
import io
import json

import numpy as np
import pytest

from lightflyer.cli import main

FILM = """\
[film]
layers = [
  {material = "Al2O3", thickness = "50 ± 2 nm"},
  {material = "Ge", thickness = "20 nm"},
  {material = "mylar", thickness = "500 nm"},
  {material = "Ge", thickness = "20 nm"},
]
"""
FLYER = '[force]\nmodel = "lu2023"\n[flyer]\ndiameter = "2 cm"\n' + FILM


@pytest.fixture
def film_file(write):
    return lambda old="", new="", text=FILM: write(text, "film.toml", (old, new))


def printed(*words):
    """What a command prints."""
    with contextlib.redirect_stdout(io.StringIO()) as shown, pytest.raises(SystemExit) as end:
        main([str(word) for word in words])
    assert not end.value.code
    return shown.getvalue()


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """Numbers, text and folder of the film."""
    folder = tmp_path_factory.mktemp("film")
    path, out = folder / "film.toml", folder / "out"
    path.write_text(FILM, encoding="utf-8")
    asked = ("film", path, "--at", "550 nm")
    return json.loads(printed(*asked, "--json", "--out", out)), printed(*asked), out


def test_film_writes_figures_and_one_json(reported):
    found, _, out = reported
    assert found == json.loads((out / "film.json").read_text())
    assert found["areal_density_g_m2"] == pytest.approx(1.058, rel=1e-3)
    assert found["solar_absorptance_top"] == pytest.approx(0.427, abs=0.002)
    assert 0.0 < found["solar_absorptance_bottom"] < 1.0
    assert set(found["emittance_top"]) == {"200", "250", "300", "350", "400", "450", "500"}
    assert found["emittance_bottom"]["450"] == pytest.approx(0.077, abs=0.002)
    assert found["extrapolated"] == []
    spectrum = {name: np.array(values) for name, values in found["spectrum"].items()}
    total = spectrum["reflectance"] + spectrum["transmittance"] + spectrum["absorptance"]
    np.testing.assert_allclose(total, 1.0, atol=1e-12)
    np.testing.assert_allclose(spectrum["wavelength_um"][[0, -1]], [0.4, 15.0])
    assert found["at"][0]["wavelength_um"] == pytest.approx(0.55)
    names = sorted(path.name for path in out.iterdir())
    assert names == ["film-layers.png", "film-layers.svg", "film-spectra.png",
                     "film-spectra.svg", "film.json"]  # fmt: skip
    assert "wavelength [µm]" in (out / "film-spectra.svg").read_text(encoding="utf-8")


def test_stated_thicknesses_give_intervals(reported):
    found, text, _ = reported
    low, high = found["interval_95"]["emittance_top"]["300"]
    middle, spread = found["emittance_top"]["300"], found["uncertainty"]["emittance_top"]["300"]
    assert (low, high) == pytest.approx((middle - 1.96 * spread, middle + 1.96 * spread), rel=1e-4)
    # 2 nm of alumina of 3000 kg/m³
    assert found["uncertainty"]["areal_density_g_m2"] == pytest.approx(0.006, rel=1e-6)
    at = found["at"][0]
    assert at["interval_95"]["reflectance"][0] < at["reflectance"]
    said = "no ± is stated for the thickness of Ge, PET: the intervals take it as exact"
    assert found["warnings"][-1] == said
    assert f"{low:.4g} to {high:.4g}" in text
    assert f"warning: {said}" in " ".join(text.split())


def test_what_passes_is_printed_with_interval_and_bounds(reported):
    found, text, _ = reported
    passing = found["solar_transmittance"]
    assert 0.0 < passing < 1.0 - found["solar_absorptance_top"]
    low, high = found["interval_95"]["solar_transmittance"]
    assert low < passing < high
    bounds = found["bounds"]["infrared_transmittance"]
    for temperature, value in found["infrared_transmittance"].items():
        assert bounds["lower"][temperature] <= value <= bounds["upper"][temperature]
        assert value + found["emittance_top"][temperature] < 1.0
    assert f"transmittance     {passing:.4f} (" in text
    for words in ("infrared", "1.058 g/m²", f"{found['emittance_top']['450']:.4f}"):
        assert words in text


def test_film_says_what_it_extrapolated(prints, film_file):
    path = film_file("[film]\n", '[film]\nextrapolation = "hold"\nspectrum = "cold-white-led"\n')
    path.write_text(path.read_text().replace("50 ± 2 nm", "50 nm"))
    found = json.loads(prints("film", path, "--json", "--temperatures", "300 K"))
    assert (found["interval_95"], found["uncertainty"]) == ({}, {})
    assert [entry.split(":")[0] for entry in found["extrapolated"]] == ["Al2O3", "Ge", "PET"]
    assert found["spectrum"]["wavelength_um"][-1] == pytest.approx(25.0)
    assert found["lamp"] == "cold-white LED"
    assert found["lamp_absorptance_top"] == pytest.approx(0.721, abs=0.002)


def test_held_data_are_not_called_data(prints, film_file):
    stack = FILM.replace(" ± 2", "").replace("[film]\n", '[film]\nextrapolation = "hold"\n')
    path = film_file(text=stack)
    found = json.loads(prints("film", path, "--json", "--temperatures", "300 K", "--at", "30 um"))
    for name in ("emittance_top", "emittance_bottom", "emittance_normal_top"):
        bounds = found["bounds"][name]
        assert bounds["covered"]["300"] == pytest.approx(0.564, abs=1e-3)  # to 15 µm
        assert bounds["extrapolated_share"]["300"] == pytest.approx(0.436, abs=1e-3)
        assert bounds["upper"]["300"] - bounds["lower"]["300"] == pytest.approx(0.436, abs=1e-3)
    assert found["bounds"]["solar_absorptance_top"]["extrapolated_share"] > 0.07
    said = "\n".join(found["warnings"])
    assert "43.6% of a black body's radiation (300 K) lies where optical data are extrap" in said
    assert "7.8% of sunlight (AM0) lies where optical data are extrapolated" in said
    assert "at 30 µm optical data are extrapolated: Ge: hold beyond 0.4 µm to 15 µm" in said
    text = prints("film", path, "--temperatures", "300 K")
    assert (text.count("43.6%"), text.count("0.052 to 0.488")) == (3, 1)


def test_densities_have_uncertainties_and_gaps_between_sources_are_named(prints, film_file):
    layers = FILM.replace('"50 ± 2 nm"', '"50 nm", density = "3000 ± 300 kg/m^3"')
    path = film_file(
        '"mylar"', '"polyimide"', layers.replace('20 nm"', '20 nm", density = "5.3 kg/m^3"', 1)
    )
    found = json.loads(prints("film", path, "--json", "--temperatures", "300 K"))
    assert found["uncertainty"]["areal_density_g_m2"] == pytest.approx(0.015, rel=1e-6)
    assert found["uncertainty"]["emittance_top"]["300"] == 0.0
    said = "\n".join(found["warnings"])
    assert "polyimide has no optical data from 1.59 µm to 1.667 µm" in said
    assert "Ge: density = 5.3 kg/m^3 is unlikely" in said


def test_a_prediction_says_which_value_is_which(prints, film_file):
    given = FLYER + 'absorptance = "0.75 ± 0.02"\n'
    film = json.loads(prints("predict", film_file(text=given), "--json", "--at", "72 km"))["film"]
    assert film["absorptance"] == {"value": 0.75, "origin": "measured", "uncertainty": 0.02}
    assert film["emittance_top"]["origin"] == "computed"
    assert film["emittance_top"]["value"]["450"] == pytest.approx(0.074, abs=0.002)
    assert film["areal_density"]["origin"] == "computed"
    assert film["tac_bottom"] == {"value": 0.9, "origin": "measured", "uncertainty": 0.03}


def test_materials_lists_range_density_and_source(prints):
    text = prints("materials", "--json")
    found = {entry["name"]: entry for entry in json.loads(text)["materials"]}
    assert found["PET"]["wavelength_range_um"] == pytest.approx([0.4, 19.942])
    assert found["Ge"]["density_kg_m3"] == 5323.0
    assert "Zhang" in found["PET"]["source"]
    assert "polyethylene terephthalate" in prints("materials")


def test_materials_are_searched(prints, refuses):
    found = json.loads(prints("materials", "--search", "cr", "--json"))
    assert [entry["name"] for entry in found["materials"]] == ["Cr"]
    page = next(entry for entry in found["pages"] if entry["name"] == "main/Cr/Johnson")
    assert page["quantities"] == ["n", "k"]
    assert page["wavelength_range_um"] == pytest.approx([0.188, 1.937])
    assert "Phys. Rev. B 9" in page["reference"]
    assert "main/Ge/Ciesielski-20nm" in prints("materials", "--search", "germanium film")
    text = prints("materials", "--search", "n")
    assert "more pages of refractiveindex.info have it: give more words" in text
    assert "the search is empty" in refuses("materials", "--search", " ")


def test_a_material_without_a_density_needs_it_to_fly(refuses, film_file):
    errors = refuses("predict", film_file('"mylar"', '"SWCNT"', FLYER))
    assert "needs areal_density, or the layer of SWCNT its density" in errors


def test_a_wavelength_outside_the_range_is_refused(refuses, film_file):
    errors = refuses("film", film_file(), "--at", "0.3 um")
    assert "Ge has no data at 0.3 µm, only from 0.4 µm to 15 µm" in errors


def test_a_layer_of_ones_own(prints, refuses, film_file, tmp_path):
    (tmp_path / "mine.csv").write_text("wavelength [um],n,k\n0.3,3,1\n20,3,0.01\n")
    layer = '{material = "mine.csv", thickness = "20 nm", density = "5 g/cm^3", tac = "0.9 ± 0.04"}'
    path = film_file('{material = "Ge", thickness = "20 nm"},\n]', f"{layer}\n]", FLYER)
    film = json.loads(prints("predict", path, "--json", "--at", "72 km"))["film"]
    assert film["tac_bottom"] == {"value": 0.9, "origin": "measured", "uncertainty": 0.04}
    assert film["areal_density"]["value"] == pytest.approx(1.058e-3 - 20e-9 * 323.0, rel=1e-4)
    without = layer.replace(', tac = "0.9 ± 0.04"', "")
    path = film_file('{material = "Ge", thickness = "20 nm"},\n]', f"{without}\n]", FLYER)
    assert "needs tac_bottom" in refuses("predict", path)


SAMPLE = """\
[film]
layers = [{material = "Ge", thickness = "50 nm", roughness = "3 nm"}]
substrate = {material = "Si"}
"""


def test_a_sample_by_angle(prints, film_file, tmp_path):
    out = tmp_path / "out"
    options = ("--angles", "0 deg,60 deg", "--temperatures", "300 K", "--at", "550 nm")
    text = prints("film", film_file(text=SAMPLE), "--out", out, *options)
    assert "below it Si, endless" in text
    assert "warning: the substrate, Si, has no lower face" in text
    assert "tac_top" not in text  # nobody flies it
    found = json.loads((out / "film.json").read_text(encoding="utf-8"))
    assert "emittance_bottom" not in found
    point = found["at"][0]
    shares = ("reflectance", "transmittance", "absorptance", "scattered")
    assert sum(point[name] for name in shares) == pytest.approx(1.0, abs=1e-12)
    light, angles = found["angles"]["light"], found["angles"]["angle_deg"]
    assert angles == pytest.approx([0.0, 60.0])
    assert light["absorptance"]["s"][0] == pytest.approx(found["solar_absorptance_top"], rel=1e-9)
    assert light["absorptance"]["p"][1] > light["absorptance"]["s"][1]
    names = {path.name for path in out.iterdir()}
    assert {"film-angles.csv", "film-angles-spectral.csv", "film-angles.nc",
            "film-angles.png", "film-angles-map.svg"} <= names  # fmt: skip


@pytest.mark.parametrize("asked", ["90 deg", "-1 deg,3 deg", "5 nm", "often"])
def test_angles_that_are_none(refuses, film_file, asked):
    assert "--angles" in refuses("film", film_file(), "--angles", asked)
