"""`film` and `materials` as a user runs them, and flyer files with layers."""

import json

import numpy as np
import pytest

FILM = """\
[film]
layers = [
  {material = "Al2O3", thickness = "50 ± 2 nm"},
  {material = "Ge", thickness = "20 nm"},
  {material = "mylar", thickness = "500 nm"},
  {material = "Ge", thickness = "20 nm"},
]
"""
FLYER = '[flyer]\ndiameter = "2 cm"\n' + FILM


@pytest.fixture
def film_file(tmp_path):
    def write(old="", new="", text=FILM):
        assert old in text
        path = tmp_path / "film.toml"
        path.write_text(text.replace(old, new, 1) if old else text, encoding="utf-8")
        return path

    return write


def test_film_writes_figures_and_one_json(run, film_file, tmp_path):
    out = tmp_path / "out"
    code, text, errors = run("film", film_file(), "--out", out, "--json", "--at", "550 nm")
    assert (code, errors) == (0, "")
    found = json.loads(text)
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


def test_film_says_what_it_extrapolated(run, film_file):
    path = film_file("[film]\n", '[film]\nextrapolation = "hold"\nspectrum = "cold-white-led"\n')
    code, text, _ = run("film", path, "--json", "--temperatures", "300 K")
    assert code == 0
    found = json.loads(text)
    assert [entry.split(":")[0] for entry in found["extrapolated"]] == ["Al2O3", "Ge", "PET"]
    assert found["spectrum"]["wavelength_um"][-1] == pytest.approx(25.0)
    assert found["lamp"] == "cold-white LED"
    assert found["lamp_absorptance_top"] == pytest.approx(0.721, abs=0.002)


def test_film_prints_a_table(run, film_file):
    code, text, _ = run("film", film_file(), "--temperatures", "441 K")
    assert code == 0
    assert "1.058 g/m²" in text
    assert "0.0752" in text


def test_a_prediction_says_which_value_is_which(run, film_file):
    given = FLYER + 'absorptance = "0.75 ± 0.02"\n'
    code, text, _ = run("predict", film_file(text=given), "--json", "--at", "72 km")
    assert code == 0
    film = json.loads(text)["film"]
    assert film["absorptance"] == {"value": 0.75, "origin": "measured", "uncertainty": 0.02}
    assert film["emittance_top"]["origin"] == "computed"
    assert film["emittance_top"]["value"]["450"] == pytest.approx(0.074, abs=0.002)
    assert film["areal_density"]["origin"] == "computed"
    assert film["tac_bottom"] == {"value": 0.9, "origin": "measured", "uncertainty": 0.05}


def test_materials_lists_range_density_and_source(run):
    code, text, _ = run("materials", "--json")
    assert code == 0
    found = {entry["name"]: entry for entry in json.loads(text)["materials"]}
    assert found["PET"]["wavelength_range_um"] == pytest.approx([0.4, 19.942])
    assert found["Ge"]["density_kg_m3"] == 5323.0
    assert "Zhang" in found["PET"]["source"]
    code, text, _ = run("materials")
    assert code == 0
    assert "polyethylene terephthalate" in text


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"Ge"', '"Gee"', 'material "Gee" is unknown; did you mean Ge'),
        ('"20 nm"', '"0 nm"', "must be positive"),
        ('"20 nm"', '"-5 nm"', "must be positive"),
        ('"20 nm"', '"20"', "has no unit"),
        ('"20 nm"', '"20 kg"', "wrong kind"),
        ('thickness = "20 nm"', 'thicknes = "20 nm"', 'did you mean "thickness"?'),
        ("layers", "layer", "needs a section [film] with layers"),
        ("[film]\n", '[film]\nextrapolation = "guess"\n', "extrapolation"),
        ("[film]\n", '[film]\nspectrum = "sun"\n', 'spectrum "sun" is unknown; choose from AM0'),
        ("[film]\n", '[film]\nspectrum = "none.csv"\n', "cannot be read"),
        ('"Ge"', '"none.csv"', "cannot be read"),
        ('"mylar"', '"SWCNT"', "needs areal_density, or the layer of SWCNT its density"),
    ],
)
def test_bad_films_get_one_clear_line(run, film_file, old, new, message):
    command = "predict" if "SWCNT" in new else "film"
    text = FLYER if command == "predict" else FILM
    code, out, errors = run(command, film_file(old, new, text))
    assert code == 2
    assert out == ""
    lines = errors.strip().splitlines()
    assert message in errors
    assert all(line.startswith("lightflyer: error: ") for line in lines)


def test_a_wavelength_outside_the_range_is_refused(run, film_file):
    code, _, errors = run("film", film_file(), "--at", "0.3 um")
    assert code == 2
    assert "Ge has no data at 0.3 µm, only from 0.4 µm to 15 µm" in errors


def test_a_layer_of_ones_own(run, film_file, tmp_path):
    (tmp_path / "mine.csv").write_text("wavelength [um],n,k\n0.3,3,1\n20,3,0.01\n")
    layer = '{material = "mine.csv", thickness = "20 nm", density = "5 g/cm^3", tac = "0.9 ± 0.04"}'
    path = film_file('{material = "Ge", thickness = "20 nm"},\n]', f"{layer}\n]", FLYER)
    code, text, errors = run("predict", path, "--json", "--at", "72 km")
    assert (code, errors) == (0, "")
    film = json.loads(text)["film"]
    assert film["tac_bottom"] == {"value": 0.9, "origin": "measured", "uncertainty": 0.04}
    assert film["areal_density"]["value"] == pytest.approx(1.058e-3 - 20e-9 * 323.0, rel=1e-4)
    without = layer.replace(', tac = "0.9 ± 0.04"', "")
    path = film_file('{material = "Ge", thickness = "20 nm"},\n]', f"{without}\n]", FLYER)
    code, _, errors = run("predict", path)
    assert code == 2
    assert "needs tac_bottom" in errors
