"""Holes that are not wide against the wavelength."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.film import am0, blackbody_fraction
from lightflyer.flight.cautions import cautions_at
from lightflyer.flight.setup import Setup
from lightflyer.flyer.diffraction import (
    LARGEST_DEFICIT,
    MEDIAN_WAVELENGTH_BY_TEMPERATURE,
    MEDIAN_WAVELENGTH_OF_SUNLIGHT,
    diffraction_deficit,
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


@pytest.mark.parametrize(("radius", "said"), [(5e-4, []), (1e-5, ["heat radiation"]),
                                              (5e-7, ["light", "heat radiation"])])  # fmt: skip
def test_a_sandwich_says_where_its_holes_are_narrow(radius, said):
    film = lf.FilmProperties(3e-4, 0.3, 0.1, 0.1, 0.8, 0.8, transmittance=0.5)
    sandwich = lf.Sandwich(film, film, 0.01, 1e-4, 0.5, radius, 1e-4, 1.8)
    found = cautions_at(Setup(sandwich, lf.Earth(), lf.Schafer2025()), np.array([60e3, 75e3]))
    narrow = [text for text in found if text.startswith("holes of")]
    assert len(narrow) == len(said)
    for text, kind in zip(narrow, said, strict=True):
        assert f"are narrow for {kind}" in text
