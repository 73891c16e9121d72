import json
import struct
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from lightflyer.config.reader import read_flyer_file


def test_table_to_record_and_flyer_file(examples, lab_prints, flyer_file):
    folder = examples("thermography")
    path = flyer_file()
    lab_prints("thermography", "thermal.csv", "--accuracy", "0.5 K", "--out", "o",
               "--update", path)  # fmt: skip
    found = json.loads((folder / "o" / "thermography.json").read_text(encoding="utf-8"))
    assert found["band_um"] == pytest.approx([7.5, 14.0])
    for name, truth in (("reflectance", 0.12), ("transmittance", 0.80), ("emissivity", 0.08)):
        low, high = found[name]["interval_95"]
        assert low < truth < high
        assert found["monte_carlo"][name]["unit"] == ""
    film = read_flyer_file(path).film
    assert film.emittance.value == pytest.approx(found["emissivity"]["value"], abs=1e-3)
    said = "measured: lab thermography, within 7.5 to 14 µm, near normal, thermal.csv"
    assert said in path.read_text(encoding="utf-8")
    with xr.open_dataset(folder / "o" / "thermography.nc", engine="h5netcdf") as record:
        assert record.hotplate_temperature.units == "K"
        assert record.attrs["warnings"] == "; ".join(found["warnings"])
    assert (folder / "o" / "thermography.png").exists()


def test_light_meter_gives_the_absorptance(examples, lab_prints, flyer_file):
    examples("thermography")
    path = flyer_file()
    out = lab_prints("thermography", "light-meter.csv", "--light-meter", "--json", "--update",
                     path, "--face", "top")  # fmt: skip
    found = json.loads(out)["absorptivity"]
    low, high = found["interval_95"]
    assert low < 0.75 < high
    absorptance = read_flyer_file(path).film.absorptance
    assert absorptance.value == pytest.approx(found["value"], abs=1e-3)
    # 0.00037 where the meter is taken to be exact
    assert absorptance.uncertainty == pytest.approx(0.0036, rel=0.1)
    out = lab_prints("thermography", "light-meter.csv", "--light-meter", "--accuracy", "3 %")
    assert "standard uncertainties of the readings: incident 52" in out


GIVEN = ["--hotplate", "150 °C", "--lower", "50 °C", "--upper", "130 °C", "--ambient", "22 °C"]


def test_one_row_without_uncertainty(folder, lab_prints):
    names = ("hotplate", "lower", "upper", "ambient")
    header = ",".join(f"{name}_temperature [K]" for name in names)
    (folder / "one.csv").write_text(f"{header}\n423.15,318.15,403.15,295.15\n")
    out = lab_prints("thermography", "one.csv", "--accuracy", "0 K", "--out", "out")
    assert "warning: no reading states an uncertainty: the interval of one row has no width" in out
    assert (folder / "out" / "thermography.png").exists()
    out = lab_prints("thermography", "one.csv")
    assert "hotplate 1.7, lower 1.2, upper 1.5, ambient 1.2 K" in out


def test_the_band_is_stated_assumed_or_none(folder, lab, lab_prints):
    (folder / "response.csv").write_text("wavelength [um],response\n7.5,1\n14,1\n")
    arguments = [*GIVEN, "--accuracy", "1 K", "--json"]
    found = {
        band: json.loads(lab("thermography", *arguments, *(["--band", band] if band else []))[1])
        for band in ("", "7.5-14 um", "response.csv", "total")
    }
    same = [found[band]["emissivity"]["value"] for band in ("", "7.5-14 um", "response.csv")]
    assert same == pytest.approx([same[0]] * 3)
    assert any("band is assumed to be 7.5 to 14 µm" in said for said in found[""]["warnings"])
    assert not any("band" in said for said in found["7.5-14 um"]["warnings"])
    total = found["total"]
    assert total["band_um"] is None
    assert total["emissivity"]["value"] == pytest.approx(0.0952, abs=1e-3)
    assert any("T⁴ is no camera's response" in said for said in total["warnings"])
    out = lab_prints("thermography", *GIVEN, "--film-temperature", "30 ± 5 °C",
                     "--hotplate-emissivity", "0.97 ± 0.01")  # fmt: skip
    assert "film is taken" not in out


FLIR = Path(__file__).parents[2] / "lab" / "thermal_images" / "tau-2.fff"


def flir_image(kelvin, emissivity, reflected):
    """A record of a real camera with the signal of given temperatures, for 0 m of air."""
    content = bytearray(FLIR.read_bytes())
    (raw, _), (settings, _) = (
        struct.unpack_from(">2I", content, 64 + 32 * number + 12) for number in (0, 1)
    )
    r1, b, f = struct.unpack_from("<3f", content, settings + 88)
    o, r2 = struct.unpack_from("<if", content, settings + 776)

    def counts(temperature):
        return r1 / (r2 * (np.exp(b / temperature) - f)) - o

    struct.pack_into("<3f", content, settings + 32, emissivity, 0.0, reflected)
    signal = emissivity * counts(kelvin) + (1.0 - emissivity) * counts(reflected)
    content[raw + 32 : raw + 32 + 2 * kelvin.size] = np.round(signal).astype("<u2").tobytes()
    return bytes(content)


def test_settings_of_a_flir_image_are_shown_and_may_be_replaced(
    folder, lab, lab_prints, lab_refuses
):
    shown = np.full((48, 64), 295.15)
    for place, kelvin in ((5, 423.15), (20, 317.95), (35, 403.94)):
        shown[place : place + 8, 10:50] = kelvin
    (folder / "a.fff").write_bytes(flir_image(shown, 0.95, 293.15))
    regions = "hotplate=6:12,12:48; lower=21:27,12:48; upper=36:42,12:48"
    arguments = ["thermography", "a.fff", "--regions", regions, "--ambient", "22 °C",
                 "--band", "7.5-14 um", "--accuracy", "0.5 K"]  # fmt: skip
    out = lab_prints(*arguments, "--out", "out")
    assert (
        "read a.fff: 64 x 48 pixels, for an emissivity of 0.95, reflected temperature 20 °C" in out
    )
    assert "take apparent temperatures by --image-emissivity 1" in " ".join(out.split())
    assert (folder / "out" / "thermography.png").exists()
    own = json.loads((folder / "out" / "thermography.json").read_text(encoding="utf-8"))
    assert own["image"]["emissivity"] == pytest.approx(0.95)
    apparent = json.loads(lab(*arguments, "--image-emissivity", "1", "--json")[1])
    assert apparent["image"]["emissivity"] == 1.0
    # by radiances: the share of the surroundings falls out of differences, but for 22 less 20 °C
    assert apparent["emissivity"]["value"] == pytest.approx(own["emissivity"]["value"], abs=3e-3)
    assert not any("cancel" in said for said in apparent["warnings"])
    assert any("was set to an emissivity of 0.95" in said for said in apparent["warnings"])
    err = lab_refuses(*arguments, "--image-unit", "K")
    assert "states its scale itself; leave --image-unit out" in err


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "utf-16"])
def test_a_matrix_with_regions_is_an_image(folder, lab, lab_prints, lab_refuses, encoding):
    shown = np.full((40, 40), 22.0)
    shown[:10], shown[12:20], shown[22:30] = 150.0, 44.8, 130.79
    text = "Temperature [°C]\n" + "\n".join(";".join(f"{v:.2f}" for v in row) for row in shown)
    (folder / "m.csv").write_text(text.replace(".", ","), encoding=encoding)
    regions = "hotplate=0:9,5:35; lower=13:19,5:35; upper=23:29,5:35; ambient=32:39,5:35"
    arguments = ["thermography", "m.csv", "--regions", regions, "--band", "7.5-14 um", "--json"]
    found = json.loads(lab_prints(*arguments, "--accuracy", "0.5 K"))
    assert any("does not state the emissivity" in said for said in found["warnings"])
    kelvin = [str(v) + " °C" for v in (150.0, 44.8, 130.79, 22.0)]
    named = zip(("hotplate", "lower", "upper", "ambient"), kelvin, strict=True)
    options = [part for name, value in named for part in (f"--{name}", value)]
    same = json.loads(lab("thermography", *options, *arguments[-3:], "--accuracy", "0.5 K")[1])
    assert found["emissivity"]["value"] == pytest.approx(same["emissivity"]["value"], abs=1e-6)
    err = lab_refuses(*arguments[:3], regions.replace("upper", "uper"))
    assert '--regions: "uper" is none of hotplate, lower, upper, ambient' in err
    err = lab_refuses("thermography", "m.csv", "--image-unit", "K", "--ambient", "22 °C")
    assert "--image-unit needs --regions" in err
