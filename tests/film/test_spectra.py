import numpy as np
import pytest
from scipy.integrate import quad

import lightflyer as lf
from lightflyer.core import constants
from lightflyer.film import (
    Spectrum,
    am0,
    cold_white_led,
    planck,
    spectrum_from_csv,
)
from lightflyer.film.optics.spectra import blackbody_fraction


def test_sunlight_by_band():
    """Cumulated irradiance, from the standard's own column."""
    for micrometres, cumulated in ((1.306, 1117.65), (1.572, 1204.85), (120.0, 1366.0995)):
        _, weight = am0().between(0.0, micrometres * 1e-6)
        assert weight.sum() * am0().total == pytest.approx(cumulated, rel=5e-5)


def test_the_parts_of_a_spectrum_add_up():
    parts = [am0().between(*ends)[1].sum() for ends in ((0, 4e-7), (4e-7, 2e-6), (2e-6, 1))]
    assert sum(parts) == pytest.approx(1.0, rel=1e-12)
    with pytest.raises(lf.ParameterError, match="no power between"):
        cold_white_led().between(2e-6, 3e-6)


@pytest.mark.parametrize("argument", [0.01, 0.3, 0.499, 0.501, 1.0, 3.0, 12.0])
def test_blackbody_fraction_is_the_integral_of_plancks_law(argument):
    c2 = constants.PLANCK * constants.SPEED_OF_LIGHT / constants.BOLTZMANN
    below = quad(lambda x: x**3 / np.expm1(x), 0.0, argument, epsrel=1e-13)[0]
    expected = 1.0 - 15.0 / np.pi**4 * below
    assert blackbody_fraction(c2 / (argument * 300.0), 300.0) == pytest.approx(expected, abs=1e-13)


def test_plancks_law_has_the_stefan_boltzmann_total_and_wiens_peak():
    wavelength = np.geomspace(1e-7, 1e-1, 20001)
    shape = planck(wavelength, 441.0)
    assert np.trapezoid(shape, wavelength) == pytest.approx(1.0, rel=1e-6)
    assert wavelength[shape.argmax()] * 441.0 == pytest.approx(2.897772e-3, rel=1e-3)
    tiny = 1e-9
    h, c, k = constants.PLANCK, constants.SPEED_OF_LIGHT, constants.BOLTZMANN
    exitance = 2 * np.pi * h * c**2 / 1e-5**5 / np.expm1(h * c / (1e-5 * k * 300.0))
    total = constants.STEFAN_BOLTZMANN * 300.0**4
    assert planck(1e-5, 300.0) == pytest.approx(exitance / total, rel=tiny)


def test_the_lamp_has_a_blue_chip_and_a_phosphor():
    lamp = cold_white_led()
    at = dict(zip((lamp.wavelength * 1e9).round().astype(int), lamp.irradiance, strict=True))
    chip = {nm: at[nm] - 0.55 * 2.0 ** (-(((nm - 560) / 60.0) ** 2)) for nm in (440, 450, 560)}
    assert chip[450] == pytest.approx(1.0, rel=1e-9)
    assert chip[440] == pytest.approx(0.5, rel=1e-9)  # half maximum, 10 nm from the peak
    assert chip[560] == pytest.approx(0.0, abs=1e-9)


GOOD = "wavelength [nm],irradiance [W/m^2/nm]\n400,0\n500,2\n600,0\n"


def test_ones_own_lamp(write):
    path = write(GOOD, "lamp.csv")
    assert spectrum_from_csv(path).total == pytest.approx(
        200.0
    )  # W/m²: the unit was left out of it


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("500", "700", "out of order"),
        ("2\n", "-2\n", "irradiance = -2 W/m.2/nm is not"),
        ("500,2\n", "", "zero"),
        ("W/m^2/nm", "mol/(s m^2 nm)", "is unknown; give one that converts to W/m"),
    ],
)
def test_a_bad_lamp_gets_one_clear_line(write, old, new, message):
    path = write(GOOD.replace(old, new, 1), "lamp.csv")
    with pytest.raises(lf.ConfigurationError, match=message):
        spectrum_from_csv(path)


def test_a_spectrum_of_arrays_is_checked():
    with pytest.raises(lf.ParameterError, match="increase"):
        Spectrum("x", np.array([2.0, 1.0]), np.ones(2))
