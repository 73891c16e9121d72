import json
from pathlib import Path

import pytest
import xarray as xr

ASSUMED = "no accuracy of the heights is stated; ± 2 % is assumed"


def test_two_maps_to_one_record(examples, lab_prints):
    folder = examples("roughness")
    names = ["germanium.ibw", "germanium.gwy"]
    out = lab_prints("roughness", *names, "--out", "o")
    assert "germanium.ibw, HeightRetrace: 256 x 256 pixels, 10 x 10 µm" in out
    found = json.loads((folder / "o" / "roughness.json").read_text(encoding="utf-8"))
    low, high = found["rms_height"]["interval_95"]
    assert low < 34.8 < high
    assert found["rms_height"]["unit"] == "nm"
    assert found["rms_height_all"]["value"] > found["rms_height"]["value"]
    assert set(found["maps"]) == set(names)
    assert 0.0 < found["maps"]["germanium.gwy"]["masked_fraction"] < 0.06
    with xr.open_dataset(folder / "o" / "roughness.nc", engine="h5netcdf") as record:
        assert record.height_0.shape == (256, 256)
        assert record.height_0.units == "m"
        assert record.attrs["warnings"] == "; ".join(found["warnings"]) == ASSUMED  # once
    assert (folder / "o" / "roughness.png").exists()


def test_mask_rows_and_accuracy_are_options(examples, lab):
    examples("roughness")
    code, out, _ = lab("roughness", "germanium.ibw", "--json")
    masked = json.loads(out)
    assert (code, masked["warnings"]) == (0, [ASSUMED])
    options = ["--mask", "none", "--flatten", "rows", "--flatten-order", "1"]
    code, out, _ = lab(
        "roughness", "germanium.ibw", *options, "--height-accuracy", "10 %", "--json"
    )
    whole = json.loads(out)
    assert (code, whole["masked_fraction"], whole["height_accuracy"]) == (0, 0.0, 0.1)
    assert ASSUMED not in whole["warnings"]
    assert whole["rms_height"]["value"] > masked["rms_height"]["value"]
    width = [one["rms_height"]["interval_95"] for one in (masked, whole)]
    assert width[1][1] - width[1][0] > 2.0 * (width[0][1] - width[0][0])


FILES = Path(__file__).parents[2] / "lab" / "height_maps"


def test_channels_of_a_microscope(lab, lab_prints, lab_refuses):
    pytest.importorskip("SurfaceTopography")
    path = str(FILES / "nanoscope-9.1.spm")
    out = lab_prints("roughness", path, "--list-channels")
    assert "ZSensor [nm]: 48 x 40 pixels\n" in out
    assert "Phase [?]: 48 x 40 pixels, not a height" in out
    found = json.loads(lab("roughness", path, "--list-channels", "--json")[1])[path]
    assert [one["name"] for one in found if one["is_height"]] == ["ZSensor", "Height"]
    out = lab_prints("roughness", path, "--channel", "zsensor", "--json")
    assert json.loads(out)["channel"] == "ZSensor"
    err = lab_refuses("roughness", path, "--channel", "Phase")
    assert 'channel "Phase [?]" is not a height; choose one by --channel: ZSensor [nm]' in err
