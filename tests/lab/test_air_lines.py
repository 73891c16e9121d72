"""Lines of air in spectra of a film whose own transmittance is known."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.lab.ftir.means import parse_ranges, with_straight_lines, without_air
from lightflyer.lab.readers.interpretation import MeasuredSpectrum

AT = np.arange(400.0, 4000.0, 0.5)  # [1/cm]
FILM = 0.85 + 0.05 * np.sin(AT / 300.0)
AMOUNTS = {"CO2": 0.7, "H2O": -0.3}  # less water in the path of the sample than of the background


def absorbance(rng):
    """Lorentzian lines at random places of the bands, as of a metre of air."""
    found = {}
    for gas, (low, high) in {"CO2": (2290.0, 2380.0), "H2O": (1350.0, 1900.0)}.items():
        places, depths = rng.uniform(low, high, 60), rng.uniform(0.02, 0.3, 60)
        found[gas] = (depths[:, None] / (1.0 + ((AT - places[:, None]) / 1.0) ** 2)).sum(axis=0)
    return found


def spectrum(name, value):
    return MeasuredSpectrum(name, "transmittance", 100.0 * AT, value)


def test_the_lines_of_each_gas_are_taken_out(rng):
    lines = absorbance(rng)
    air = spectrum("air", np.exp(-lines["CO2"] - lines["H2O"]))
    noise = 5e-4 * rng.normal(size=AT.size)
    seen = FILM * np.exp(-sum(AMOUNTS[gas] * lines[gas] for gas in lines)) + noise
    found = without_air(spectrum("film", seen), air)
    assert np.abs(seen - FILM).max() > 0.1
    # what is left is noise, and the far wings of lines beyond their gas' range
    assert np.abs(found.value - FILM).max() < 0.01
    amounts = [float(note.split(": ")[1].split(" ± ")[0]) for note in found.notes]
    assert amounts == pytest.approx([0.7, -0.3], abs=0.02)
    assert np.array_equal(found.value[AT < 600.0], seen[AT < 600.0])


def test_air_without_lines_is_refused(rng):
    with pytest.raises(lf.ParameterError, match="has no lines of air"):
        without_air(spectrum("film", FILM), spectrum("air", np.ones_like(AT)))
    mirror = MeasuredSpectrum("air", "reflectance", 100.0 * AT, FILM)
    with pytest.raises(lf.ParameterError, match="not transmittance of air"):
        without_air(spectrum("film", FILM), mirror)


def test_a_straight_line_replaces_what_is_between():
    seen = np.where((AT > 2290.0) & (AT < 2380.0), 0.1, 0.5 + 1e-5 * AT)
    found = with_straight_lines(spectrum("film", seen), parse_ranges("2280-2400 cm^-1"))
    assert found.value == pytest.approx(0.5 + 1e-5 * AT, abs=1e-12)


def test_a_line_beyond_the_data_is_refused():
    with pytest.raises(lf.ParameterError, match=r"3900 to 5000 cm\^-1 is not within its data"):
        with_straight_lines(spectrum("film", FILM), parse_ranges("3900-5000 cm^-1"))
