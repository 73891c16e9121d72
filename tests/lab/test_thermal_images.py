"""Thermal images of cameras: flyr reads some of them too, formulas are inverted by hand."""

import struct
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, TiffImagePlugin

import lightflyer as lf
from lightflyer.lab.thermography import flir
from lightflyer.lab.thermography.flir import CameraSettings, signal, temperatures
from lightflyer.lab.thermography.thermal_image import (
    ThermalImage,
    parse_regions,
    parse_scale,
    read_thermal_image,
    region_temperatures,
    setting_warnings,
)

from .damage import read_damaged

FILES = Path(__file__).parent / "thermal_images"
CELSIUS = 273.15

# of the FLIR camera that Thermimage takes as its example
CAMERA = CameraSettings(
    1.0, 0.0, 293.15, 293.15, 293.15, 1.0, 0.5, r1=21106.77, b=1501.0, f=1.0, o=-7340.0,
    r2=0.012545258, alpha=(0.006569, 0.01262), beta=(-0.002276, -0.00667), share=1.9,
)  # fmt: skip


def test_a_flir_jpeg_as_another_package_reads_it():
    flyr = pytest.importorskip("flyr")
    theirs = flyr.unpack(str(FILES / "flir-ax8.jpg")).kelvin
    found = read_thermal_image(FILES / "flir-ax8.jpg")
    assert found.temperature.shape == (60, 80)
    # flyr rounds the temperatures of its settings
    assert np.abs(found.temperature - theirs).max() < 1e-4
    assert (found.emissivity, found.reflected_temperature) == pytest.approx((0.95, 293.15))


@pytest.mark.parametrize(
    ("name", "emissivity", "coldest", "hottest"),
    [
        ("zenmuse-xt.jpg", 0.7, 10.0, 70.0),
        ("research-ir.fff", 0.95, 20.0, 32.0),
        ("tau-2.fff", 0.94, 5.0, 15.0),
    ],
)
def test_other_byte_orders_are_read(name, emissivity, coldest, hottest):
    """Files that flyr 5.1 does not read: little-endian directories, and records alone."""
    found = read_thermal_image(FILES / name)
    assert found.temperature.shape == (48, 64)
    assert found.emissivity == pytest.approx(emissivity, abs=1e-3)
    assert coldest < found.temperature.min() - CELSIUS
    assert found.temperature.max() - CELSIUS < hottest


def test_raw_signals_of_either_byte_order_agree():
    content = bytearray((FILES / "tau-2.fff").read_bytes())
    place, size = struct.unpack_from(">2I", content, 64 + 12)
    record = bytes(content[place : place + size])
    assert struct.unpack("<3H", record[:6]) == (2, 64, 48)
    pixels = np.frombuffer(record[32:], "<u2")
    big = struct.pack(">3H", 2, 64, 48) + record[6:32] + pixels.astype(">u2").tobytes()
    content[place : place + size] = big
    found = flir.read_flir(Path("a.fff"), bytes(content))[0]
    assert np.array_equal(found.ravel(), pixels)


def test_published_temperatures():
    """Thermimage's example: raw 18109, all settings of a black body."""
    kelvin = float(temperatures(np.array(18109.0), CAMERA))
    by_hand = 1501.0 / np.log(21106.77 / (0.012545258 * (18109.0 - 7340.0)) + 1.0)
    assert kelvin == pytest.approx(by_hand, rel=1e-12)


def test_what_the_camera_sees_is_undone():
    """Radiation of the object, reflected, of the air and of the window, added up by hand."""
    camera = replace(CAMERA, emissivity=0.8, distance=30.0, reflected_temperature=310.0,
                     air_temperature=285.0, window_temperature=300.0,
                     window_transmittance=0.9)  # fmt: skip
    half = camera.transmittance
    assert 0.85 < half < 0.99
    counts = 0.8 * signal(350.0, camera) + 0.2 * signal(310.0, camera)
    counts = half * counts + (1.0 - half) * signal(285.0, camera)
    counts = 0.9 * counts + 0.1 * signal(300.0, camera)
    counts = half * counts + (1.0 - half) * signal(285.0, camera)
    assert float(temperatures(np.array(counts), camera)) == pytest.approx(350.0, abs=1e-9)
    assert np.isnan(temperatures(np.array(0.0), camera))


def test_another_emissivity_may_be_set():
    own = read_thermal_image(FILES / "zenmuse-xt.jpg")
    apparent = read_thermal_image(FILES / "zenmuse-xt.jpg", emissivity=1.0)
    assert apparent.emissivity == 1.0
    warm = own.temperature > own.reflected_temperature + 5.0
    assert warm.any()
    assert (apparent.temperature[warm] < own.temperature[warm] - 1.0).all()
    cold = own.temperature < own.reflected_temperature - 1.0
    assert (apparent.temperature[cold] > own.temperature[cold]).all()
    moved = read_thermal_image(FILES / "zenmuse-xt.jpg", reflected_temperature=280.0)
    assert (moved.temperature > own.temperature).all()
    with pytest.raises(lf.ParameterError, match="emissivity = 0"):
        read_thermal_image(FILES / "zenmuse-xt.jpg", emissivity=0.0)


def test_settings_that_do_not_cancel_are_said():
    image = read_thermal_image(FILES / "flir-ax8.jpg")
    assert setting_warnings(image, 293.15) == ()
    assert "cancel only if" in setting_warnings(image, 296.15)[0]
    assert setting_warnings(replace(image, emissivity=1.0), 310.0) == ()
    assert "does not state the emissivity" in setting_warnings(
        ThermalImage("a.csv", image.temperature), 293.15
    )[0]  # fmt: skip


MATRIX = 20.0 + np.arange(12.0).reshape(3, 4) / 8.0


def lines(delimiter, comma, *above, matrix=MATRIX):
    rows = [delimiter.join(f"{value:.4g}" for value in row) for row in matrix]
    text = "\n".join([*above, *(row.replace(".", ",") if comma else row for row in rows)])
    return text + "\n"


@pytest.mark.parametrize(
    ("text", "unit", "emissivity"),
    [
        (lines(",", False, "File:,C:\\FLIR0123.jpg", "", "Object Parameters,Value",
               "Emissivity:,0.95", "Refl. temp.:,20 °C", ""), None, 0.95),
        (lines(";", True, "Temperature [C]", "Emissivity;0,98"), None, 0.98),
        (lines("\t", False), "°C", None),
        (lines(";", True), "°C", None),
        (lines(" ", False, "# Kelvin", matrix=MATRIX + CELSIUS), None, None),
        (lines(",", False, matrix=1.8 * MATRIX + 32.0), "°F", None),
        (";1;2;3;4\n" + "".join(
            f"{n};{line}\n" for n, line in enumerate(lines(";", True).splitlines(), 1)
        ), "°C", None),
    ],
)  # fmt: skip
def test_matrices_as_cameras_export_them(write, text, unit, emissivity):
    path = write(text, "a.csv")
    found = read_thermal_image(path, scale=None if unit is None else parse_scale(unit))
    np.testing.assert_allclose(found.temperature - CELSIUS, MATRIX, atol=0.051)
    assert found.emissivity == emissivity


def tiff(path, values, **tags):
    directory = TiffImagePlugin.ImageFileDirectory_v2()
    for code, text in tags.items():
        directory[int(code[1:])] = text
        directory.tagtype[int(code[1:])] = 2
    Image.fromarray(values).save(path, tiffinfo=directory)


GDAL = (
    '<GDALMetadata><Item name="SCALE" sample="0" role="scale">0.1</Item>'
    '<Item name="OFFSET" sample="0" role="offset">-100</Item>'
    '<Item name="UNITTYPE" sample="0" role="unittype">°C</Item></GDALMetadata>'
)


def test_scales_of_tiff(tmp_path):
    kelvin = MATRIX + CELSIUS
    for name, values, scale in [
        ("centi.tiff", np.round(kelvin / 0.01).astype(np.uint16), parse_scale("0.01 K")),
        ("celsius.tif", MATRIX.astype(np.float32), parse_scale("°C")),
        ("optris.tif", np.round(10 * (MATRIX + 100)).astype(np.uint16),
         parse_scale("0.1 °C", "-100 °C")),
    ]:  # fmt: skip
        tiff(tmp_path / name, values)
        found = read_thermal_image(tmp_path / name, scale=scale).temperature
        np.testing.assert_allclose(found, kelvin, atol=0.051)
    raw = np.round(10 * (MATRIX + 100)).astype(np.uint16)
    raw[0, 0] = 65535
    tiff(tmp_path / "gdal.tif", raw, t42112=GDAL.replace("°C", "degC"), t42113="65535")
    found = read_thermal_image(tmp_path / "gdal.tif").temperature
    assert np.isnan(found[0, 0])
    np.testing.assert_allclose(found.ravel()[1:], kelvin.ravel()[1:], atol=0.051)
    with pytest.raises(lf.ConfigurationError, match="1 of 4 pixels of region lower have no"):
        region_temperatures(found, parse_regions("lower=0:2,0:2"), "gdal.tif")


def test_a_tiff_of_flir_needs_its_step():
    with pytest.raises(lf.ConfigurationError, match="does not state what its numbers mean"):
        read_thermal_image(FILES / "flir-vue.tiff")
    found = read_thermal_image(FILES / "flir-vue.tiff", scale=parse_scale("0.04 K"))
    assert 265.0 < found.temperature.min() < found.temperature.max() < 285.0
    with pytest.raises(lf.ConfigurationError, match="the unit or the scale is wrong"):
        read_thermal_image(FILES / "flir-vue.tiff", scale=parse_scale("0.01 K"))


@pytest.mark.parametrize(
    "name", ["flir-ax8.jpg", "zenmuse-xt.jpg", "research-ir.fff", "flir-vue.tiff", "matrix.csv"]
)
def test_damage_gives_an_image_or_one_line(name, tmp_path):
    text = lines(";", True, "Temperature [C]", "Emissivity;0,98").encode()
    content = text if name == "matrix.csv" else (FILES / name).read_bytes()
    path = tmp_path / f"damaged{Path(name).suffix}"
    scale = parse_scale("0.04 K") if name == "flir-vue.tiff" else None
    read = partial(read_thermal_image, scale=scale)
    found = read_damaged(read, path, content, np.random.default_rng(2), 900)
    assert all(200.0 <= np.nanmedian(one.temperature) <= 2300.0 for one, _ in found)
    assert 0 < len(found) < 180
