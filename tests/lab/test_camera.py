import numpy as np
import pytest
from scipy import constants, integrate

import lightflyer as lf
from lightflyer.lab import flat_band
from lightflyer.lab.thermography.data import CameraBand, parse_band


def radiance(temperature, shortest, longest, response=lambda _: 1.0):
    """In-band radiance by adaptive quadrature of Planck's law."""
    h, c, k = constants.h, constants.c, constants.k

    def spectral(wavelength):
        planck = 2 * h * c**2 / wavelength**5 / np.expm1(h * c / (wavelength * k * temperature))
        return response(wavelength) * planck

    return integrate.quad(spectral, shortest, longest, epsabs=0.0, epsrel=1e-13, limit=400)[0]


@pytest.mark.parametrize("temperature", [200.0, 295.15, 423.15, 2300.0])
@pytest.mark.parametrize("ends", [(7.5e-6, 14e-6), (3e-6, 5e-6), (0.9e-6, 1.7e-6), (1e-6, 1e-4)])
def test_radiance_by_another_quadrature(ends, temperature):
    found = flat_band(*ends)
    assert found.radiance(temperature) == pytest.approx(radiance(temperature, *ends), rel=1e-10)
    step = 1e-3
    slope = radiance(temperature + step, *ends) - radiance(temperature - step, *ends)
    assert found.slope(temperature) == pytest.approx(slope / (2.0 * step), rel=1e-6)


def test_many_temperatures_are_as_exact_as_few(rng):
    band = flat_band(7.5e-6, 14e-6)
    many = rng.uniform(200.0, 2300.0, (4, 1000))
    expected = [band.radiance(one) for one in many]
    np.testing.assert_allclose(band.radiance(many), expected, rtol=1e-10)
    np.testing.assert_allclose(band.radiance(np.full(3000, 300.0)), band.radiance(300.0))
    assert np.all(np.diff(band.radiance(np.linspace(200.0, 2300.0, 5000))) > 0.0)


def test_response_of_a_file(write):
    path = write("wavelength [um],response [%]\n14,0\n12,80\n8,100\n7,0\n", "response.csv")
    found = parse_band(str(path))
    table = np.array([7e-6, 8e-6, 12e-6, 14e-6]), np.array([0.0, 100.0, 80.0, 0.0])
    pieces = zip(table[0][:-1], table[0][1:], strict=True)
    expected = sum(radiance(350.0, *ends, lambda one: np.interp(one, *table)) for ends in pieces)
    assert found.radiance(350.0) == pytest.approx(expected, rel=1e-10)
    assert found.name == "7 to 14 µm"
    assert not found.assumed


@pytest.mark.parametrize("text", ["7.5-14 um", "7.5 – 14 µm", "7500 to 14000 nm"])
def test_bands_in_words(text):
    np.testing.assert_allclose(parse_band(text).wavelength, [7.5e-6, 14e-6])
    assert parse_band(" total ") is None


def test_impossible_temperatures_and_bands():
    for temperature in (0.0, -1.0, np.nan):
        with pytest.raises(lf.ParameterError, match="temperature"):
            flat_band(8e-6, 14e-6).radiance(temperature)
    with pytest.raises(lf.ParameterError, match="two or more"):
        CameraBand(np.array([8e-6]), np.array([1.0]))
