"""Texture of surfaces whose autocorrelation is known: white noise filtered by a Gaussian."""

import numpy as np
import pytest
from scipy import ndimage

import lightflyer as lf
from lightflyer.lab.readers.height_map import HeightMap, mask_as_png, read_mask
from lightflyer.lab.surface.heights import texture_of
from lightflyer.lab.surface.reduction import roughness

STEP, WIDTH, RMS = 20e-9, 6.0, 10e-9  # pixel [m], of the filter [pixels], [m]


def surface(seed, shape=(400, 500)):
    """The autocorrelation is exp(-r²/(4 w²)), as the filter's with itself."""
    noise = np.random.default_rng(seed).normal(size=shape)
    found = ndimage.gaussian_filter(noise, WIDTH, mode="wrap")
    return RMS * found / (1.0 / (2.0 * np.sqrt(np.pi) * WIDTH))


@pytest.mark.parametrize("masked", [False, True])
def test_of_a_gaussian_surface(masked):
    height = surface(1)
    mask = np.zeros(height.shape, bool)
    if masked:
        mask[np.random.default_rng(2).random(mask.shape) < 0.05] = True
        height = np.where(mask, 1e-6, height)  # particles far above
    found = texture_of(height, mask, (STEP, STEP))
    assert found.correlation_length == pytest.approx(2.0 * WIDTH * STEP, rel=0.05)
    # the mean square slope is the curvature of the autocorrelation, 1/(2 w²) along each axis
    slope = RMS / (WIDTH * STEP)
    assert found.rms_slope == pytest.approx(slope, rel=0.05)
    assert found.developed_area == pytest.approx(0.5 * slope**2, rel=0.1)
    if not masked:
        # Wiener and Khinchin: π (2 w)² exp(-(2π f w)²) of the power density over frequency
        square = (2.0 * np.pi * found.frequency * WIDTH * STEP) ** 2
        known = RMS**2 * np.pi * (2.0 * WIDTH * STEP) ** 2 * np.exp(-square)
        near = (square < 4.0) & (found.frequency > 8.0 * found.frequency[0])
        assert found.power[near] == pytest.approx(known[near], rel=0.25)
        total = 2.0 * np.pi * np.trapezoid(found.frequency * found.power, found.frequency)
        assert total == pytest.approx(RMS**2, rel=0.05)


def test_an_oblong_pixel_is_no_stretched_surface():
    height = surface(3)[:, ::2]
    found = texture_of(height, np.zeros(height.shape, bool), (STEP, 2.0 * STEP))
    assert found.correlation_length == pytest.approx(2.0 * WIDTH * STEP, rel=0.08)
    assert found.rms_slope == pytest.approx(RMS / (WIDTH * STEP), rel=0.08)


def test_a_steep_ridge_has_the_area_of_its_faces():
    """Faces of 45° over half of the map have √2 times its area."""
    rise = STEP * np.repeat([1.0, -1.0, 0.0], [30, 30, 60])
    height = np.tile(np.append(0.0, np.cumsum(rise)), (50, 1))
    found = texture_of(height, np.zeros(height.shape, bool), (STEP, STEP))
    assert found.developed_area == pytest.approx(0.5 * (np.sqrt(2.0) - 1.0), rel=1e-9)
    assert found.rms_slope == pytest.approx(np.sqrt(0.5), rel=1e-9)


def test_masks_come_in_as_they_went_out(tmp_path):
    mask = np.random.default_rng(4).random((30, 40)) < 0.1
    (tmp_path / "mask.png").write_bytes(mask_as_png(mask))
    np.savetxt(tmp_path / "mask.txt", mask, "%d")
    for name in ("mask.png", "mask.txt"):
        assert np.array_equal(read_mask(tmp_path / name), mask)
    height = 1e-9 * np.random.default_rng(5).normal(size=mask.shape)
    source = HeightMap("map", np.where(mask, 1e-7, height), 1e-6, 0.75e-6)
    found = roughness(source, mask=mask, order=0)
    assert found.parameters["rms_height"].value == pytest.approx(1e9 * height[~mask].std())
    with pytest.raises(lf.ConfigurationError, match="the mask has 40 x 20 and the map 40 x 30 pix"):
        roughness(source, mask=mask[:20])
