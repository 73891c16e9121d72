import json

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.files.result_text import as_text, unwrap
from lightflyer.prediction.text import SampleShares, verdict_lines
from lightflyer.uncertainty.text import band_parts

FILE = """\
[flyer]
diameter = "2 cm"
[film]
areal_density = "1.0 g/m^2"
absorptance = "0.9 ± 0.03"
transmittance = 0.05
emittance = "0.08 ± 0.01"
tac_top = "0.8 ± 0.01"
tac_bottom = "0.9 ± 0.01"
tac_correlation = 0.5
[environment]
atmosphere = "lu2023"
altitude_min = "55 km"
altitude_max = "90 km"
[force]
model = "lu2023"
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "flyer.toml").write_text(FILE, encoding="utf-8")
    return tmp_path


def test_bands_for_a_file_with_uncertainties(prints, folder):
    flyer, out = folder / "flyer.toml", folder / "out"
    text = prints("predict", flyer, "--out", out, "--samples", "100", "--verbose")
    told = text[: text.index("wrote ")]
    bands = told[told.index("95 % band of") : told.index("from the ±")].splitlines()
    assert any(line.split()[:2] == ["payload", "[mg]"] and "%" in line for line in bands)
    assert max(len(line) for line in bands) <= 80
    assert "correlated by 0.5" in told.replace("\n", " ")
    summary = json.loads((folder / "out" / "prediction.json").read_text(encoding="utf-8"))
    assert {"altitude_band_km", "minimum_irradiance", "best", "at", "uncertainty"} <= set(summary)
    (warning,) = summary["uncertainty"]["warnings"]  # of films that absorb and pass more than all
    assert "were drawn again (transmittance = 0.05 and absorptance = 0.9" in warning
    assert f"warning: {warning}" in unwrap(told)
    share = summary["uncertainty"]["share_that_levitates"]
    edge = summary["uncertainty"]["results"]["altitude_band_km.lower"]["monte_carlo"]
    assert share == pytest.approx(edge["share_of_samples"], abs=0.011)  # a sample at the margin
    assert summary["uncertainty"]["share_that_survives"] is None  # no limit is stated
    assert f"It flies, in {100.0 * share:.0f} % of 100 samples, from" in told
    payload = summary["uncertainty"]["results"]["best.payload_mg"]
    assert payload["value"] == summary["best"]["payload_mg"]
    assert payload["monte_carlo"]["low"] < payload["value"] < payload["monte_carlo"]["high"]
    assert payload["first_order"]["low"] < payload["value"] < payload["first_order"]["high"]
    with xr.open_dataset(folder / "out" / "prediction.nc", engine="h5netcdf") as dataset:
        assert dataset["payload_low"].units == "kg"
        assert float((dataset["payload_low"] < dataset["payload_high"]).all())


def test_errors_of_the_force_model_are_told_from_those_of_the_file():
    """A file without any ± has bands where the force model is uncertain by itself."""
    told = {
        "inputs": {"film.tac_top": 0.01, "force.force_error": 1.0, "force.c_fm": 0.1},
        "between_bounds": [], "tac_correlation": None, "samples": 0, "warnings": [],
        "share_that_levitates": None, "share_that_survives": None, "results": {},
    }  # fmt: skip
    assert unwrap(as_text(band_parts(told)))[-1] == (
        "from the ± of film.tac_top, force.c_fm, and the force model's own errors "
        "(force.force_error)"
    )


def test_in_how_many_samples_a_film_survives(flyer_file):
    text = FILE.replace("[film]", '[film]\nhighest_temperature = "400 K"')
    found = lf.propagate(flyer_file(text=text), samples=100)
    rest = found.sampled["verdict.rest.temperature_k"]
    assert found.share_that_survives == np.sum(rest <= 400.0) / 100
    for flies, survives, words in (
        (0.8, 0.3, ("It flies, in 80 % of 100 samples, from", "survives in 30 % of the samples.")),
        (1.0, None, ("It flies from", "its film withstands 400 K.")),
    ):
        told = " ".join(verdict_lines(found.prediction, {}, SampleShares(100, flies, survives)))
        assert all(text in told for text in words)
    assert found.shares == (100, found.share_that_levitates, found.share_that_survives)


def test_first_order_alone(prints, folder):
    text = prints("predict", folder / "flyer.toml", "--json", "--samples", "0")
    results = json.loads(text)["uncertainty"]["results"]
    assert "monte_carlo" not in results["best.payload_mg"]


@pytest.mark.parametrize(("highest", "has_bands"), [("520 K", True), ("300 K", False)])
def test_brackets_are_explained_where_there_are_any(prints, folder, highest, has_bands):
    text = FILE.replace("[environment]", f'highest_temperature = "{highest}"\n[environment]')
    (folder / "flyer.toml").write_text(text, encoding="utf-8")
    out = prints("predict", folder / "flyer.toml", "--samples", "0")
    assert ("brackets: 95 % bands" in out) == has_bands == ("(" in out)
