"""Holes that are not wide against the wavelength."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.design.diagnostics import diagnose_at
from lightflyer.design.setup import Setup
from lightflyer.film import am0
from lightflyer.film.optics.spectra import blackbody_fraction
from lightflyer.film.optics.waves import (
    LARGEST_DEFICIT,
    MEDIAN_WAVELENGTH_BY_TEMPERATURE,
    MEDIAN_WAVELENGTH_OF_SUNLIGHT,
    diffraction_deficit,
    largest_deficit,
    narrow_channels,
    narrow_holes,
)


def test_half_of_the_radiation_lies_beyond_the_median_wavelengths():
    assert blackbody_fraction(MEDIAN_WAVELENGTH_BY_TEMPERATURE / 300.0, 300.0) == pytest.approx(
        0.5, abs=1e-4
    )
    light = am0()
    _, weight = light.between(light.wavelength[0], MEDIAN_WAVELENGTH_OF_SUNLIGHT)
    assert weight.sum() == pytest.approx(0.5, abs=2e-3)


def test_limits_of_wide_and_narrow_holes():
    wide = np.array([1e-3, 1e-2])
    expected = 10e-6 / (4.0 * np.pi * wide)
    np.testing.assert_allclose(diffraction_deficit(wide, 10e-6), expected, rtol=0.05)
    ka = 0.02  # of a narrow hole, which passes (ka)²/3 by Kirchhoff
    narrow = 1.0 - diffraction_deficit(ka * 10e-6 / (2.0 * np.pi), 10e-6)
    assert narrow == pytest.approx(ka**2 / 3.0, rel=1e-3)
    falling = diffraction_deficit(np.geomspace(1e-7, 1e-4, 200), 10e-6)
    assert np.all((falling > 0.0) & (falling < 1.0))
    assert falling[-1] < LARGEST_DEFICIT < falling[0]
    radius = np.geomspace(1e-7, 1e-3, 2000)
    share = diffraction_deficit(radius, 10e-6) / largest_deficit(radius, 10e-6)
    assert share.max() == pytest.approx(1.0, abs=1e-5)
    assert np.all(share < 1.0)


def test_what_is_missing_goes_with_the_edge_of_a_channel():
    """A square has as much edge for its area as the circle within it."""
    for width in (3e-6, 30e-6):
        square = [text.partition(" are ")[2] for text in narrow_channels(width, width, 250.0)]
        assert square == [text.partition(" are ")[2] for text in narrow_holes(width / 2, 250.0)]
    # of a long slot it is half of that of a square
    assert len(list(narrow_channels(40e-6, 40e-6, 250.0))) == 1
    assert not list(narrow_channels(40e-6, 1.0, 250.0))


CLEAR = lf.FilmProperties(2e-4, 0.05, 0.1, 0.1, 0.8, 0.8, transmittance=0.9)
DARK = lf.FilmProperties(3e-4, 0.9, 0.1, 0.1, 0.8, 0.8)


@pytest.mark.parametrize(
    "flyer",
    [
        lf.Plate(CLEAR, DARK, 4e-3, 10e-6, 500e-6, 50e-6, 100e-6, 50e-9, 1.8),
        lf.HollowBody(CLEAR, DARK, 0.1, 0.02, 0.5, 10e-6, 10e-6, 5e-8, 1.8),
    ],
)
def test_channels_of_a_wall_that_are_narrow(flyer):
    (text,) = flyer.diagnostics(lf.Earth().state(np.array([60e3, 75e3])), 300.0)
    assert text.startswith("channels of 10 µm are narrow for heat radiation")


@pytest.mark.parametrize(("radius", "said"), [(5e-4, []), (1e-5, ["heat radiation"]),
                                              (5e-7, ["light", "heat radiation"])])  # fmt: skip
def test_a_sandwich_says_where_its_holes_are_narrow(radius, said):
    film = lf.FilmProperties(3e-4, 0.3, 0.1, 0.1, 0.8, 0.8, transmittance=0.5)
    sandwich = lf.Sandwich(film, film, 0.01, 1e-4, 0.5, radius, 1e-4, 1.8)
    setup = Setup(sandwich, lf.Earth(), lf.Schafer2025())
    found = diagnose_at(setup, np.array([60e3, 75e3]), np.full(2, 350.0))
    narrow = [text for text in found if text.startswith("holes of")]
    assert len(narrow) == len(said)
    for text, kind in zip(narrow, said, strict=True):
        assert f"are narrow for {kind}" in text
