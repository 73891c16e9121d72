"""Public reports of height maps and thermal images: inputs of our own, values by hand.

Tests of `lab` have the cases of https://github.com/AFM-SPM/TopoStats/issues/862 and pull/779, and
of https://github.com/ContactEngineering/SurfaceTopography/issues/276.
"""

import numpy as np
import pytest

from lightflyer.lab.readers.height_map import read_height_map
from lightflyer.lab.surface.heights import level
from lightflyer.lab.thermography.thermal_image import parse_scale, read_thermal_image

SIDE = 64
X, Y = np.meshgrid(np.linspace(-1.0, 1.0, SIDE), np.linspace(-1.0, 1.0, SIDE))


@pytest.mark.parametrize(
    ("background", "order"),
    [
        (X * Y, 2),  # https://github.com/AFM-SPM/TopoStats/pull/626: a saddle
        (X**2 + 0.3 * Y**2 - X, 2),  # https://github.com/AFM-SPM/TopoStats/pull/351: a bow
        (X**3 - 0.2 * X * Y**2, 3),  # https://github.com/AFM-SPM/TopoStats/issues/716
    ],
)
def test_a_background_of_an_order_vanishes(background, order):
    away = level(1e-7 * background, np.zeros(X.shape, bool), order)
    assert np.abs(away).max() < 1e-18
    below = level(1e-7 * background, np.zeros(X.shape, bool), order - 1)
    assert np.abs(below).max() > 1e-9


def write(folder, text):
    path = folder / "map.txt"
    path.write_text(text, encoding="utf-8")
    return path


def matrix(values):
    return "\n".join("\t".join(f"{one:.9g}" for one in row) for row in values) + "\n"


@pytest.mark.parametrize(("unit", "metres"), [("um", 1e-6), ("µm", 1e-6), ("nm", 1e-9), ("m", 1.0)])
def test_heights_in_any_unit(tmp_path, unit, metres):
    """https://github.com/AFM-SPM/TopoStats/pull/659: only some units were known."""
    heights = 1e-9 / metres * np.random.default_rng(1).normal(size=(20, 20))
    head = f"# Channel: z\n# Width: 5 µm\n# Height: 5 µm\n# Value units: {unit}\n"
    found = read_height_map(write(tmp_path, head + matrix(heights)))
    assert found.height == pytest.approx(metres * heights, rel=1e-6)


@pytest.mark.parametrize("apart", ["   ", ", ", " , ", "; ", "\t"])
@pytest.mark.parametrize("mark", [".", ","])
def test_decimal_commas_whatever_is_between(tmp_path, apart, mark):
    """https://github.com/numpy/numpy/issues/13810: "0,1   0,2" was no number."""
    values = np.round(np.random.default_rng(1).uniform(24.0, 31.0, (8, 8)), 1)
    rows = (apart.join(f"{one:.1f}".replace(".", mark) for one in row) for row in values)
    image = read_thermal_image(write(tmp_path, "\n".join(rows) + "\n"), scale=parse_scale("°C"))
    assert image.temperature == pytest.approx(values + 273.15)


@pytest.mark.parametrize(("scale", "number"), [("0.1 K", 3000.0), ("1 mK", 300000.0)])
def test_counts_of_a_camera_are_what_its_maker_says(tmp_path, scale, number):
    """https://github.com/terraref/computing-pipeline/issues/151: 3000 is 300 K."""
    counts = number * (1.0 + 0.01 * np.random.default_rng(1).uniform(size=(20, 20)))
    image = read_thermal_image(write(tmp_path, matrix(counts)), scale=parse_scale(scale, None))
    assert image.temperature == pytest.approx(counts * 300.0 / number, rel=1e-6)
