"""What constructors and functions make of texts, quantities, lists and of what is no number."""

import numpy as np
import pint
import pytest
import xarray as xr

import lightflyer as lf

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
OTHER_REGISTRY = pint.UnitRegistry()


@pytest.mark.parametrize(
    "radius",
    [
        0.01,
        "1 cm",
        "10 mm",
        OTHER_REGISTRY.Quantity(1, "cm"),
        np.float64(0.01),
        np.asarray(0.01),
    ],
)
def test_a_number_in_any_writing_is_the_same_disk(radius):
    assert lf.Disk(FILM, radius).own_mass == pytest.approx(np.pi * 1e-7, rel=1e-12)


@pytest.mark.parametrize(
    "radii",
    [
        [0.01, 0.02],
        (0.01, 0.02),
        np.array([0.01, 0.02]),
        xr.DataArray([0.01, 0.02], dims="radius"),
        OTHER_REGISTRY.Quantity([1, 2], "cm"),
    ],
)
def test_several_numbers_in_any_writing_are_an_array(radii):
    state = lf.Earth().state("72 km")
    found = lf.payload(lf.Disk(FILM, radii), state, lf.Lu2023())
    expected = [lf.payload(lf.Disk(FILM, radius), state, lf.Lu2023()) for radius in (0.01, 0.02)]
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_every_record_reads_units():
    film = lf.FilmProperties("1 g/m^2", "75 %", 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    assert film.areal_density == pytest.approx(1e-3)
    assert film.absorptance == pytest.approx(0.75)
    assert lf.Chamber(temperature="20 degC").temperature == pytest.approx(293.15)
    assert lf.Chamber().state("30 mTorr").pressure == pytest.approx(3.99967, rel=1e-5)
    assert np.shape(lf.Earth().state([70e3, 72e3]).pressure) == (2,)
    assert lf.Disk(FILM, "1 cm", payload="0.1 mg").payload == pytest.approx(1e-7)


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("2 kg", r'radius = "2 kg": unit "kg" is of the wrong kind; give one that converts to m'),
        ("2", r'radius = "2" has no unit; write "2 m"'),
        ("wide", r'radius = "wide" is not a number with a unit, such as "1 m"'),
        ("2 ± 1 cm", r"radius = 0.02: an object takes no ±; give uncertainties to a flyer file"),
        (lf.Measured(0.02, 0.01), r"radius = 0.02: an object takes no ±"),
        (OTHER_REGISTRY.Quantity(2, "kg"), r"radius = 2 kg does not convert to m"),
        (None, r'radius must be a number or an array of numbers \[m\], or a text such as "1 m"'),
        (True, "radius must be a number"),
        (1j, "radius must be a number"),
        ({}, "radius must be a number"),
        ([0.01, "x"], "radius must be a number"),
        ([[0.01], [0.01, 0.02]], "radius must be a number"),
        ("-2 cm", "radius = -0.02 is not positive"),
        (np.nan, "radius = nan is not positive"),
    ],
)
def test_what_is_no_length_is_one_clear_line(value, message):
    with pytest.raises(lf.ParameterError, match=message) as caught:
        lf.Disk(FILM, value)
    assert "\n" not in str(caught.value)


def test_what_is_of_the_wrong_class_is_one_clear_line():
    disk, state = lf.Disk(FILM, 0.01), lf.Earth().state(72e3)
    with pytest.raises(lf.ParameterError, match="film must be of class FilmProperties, not str"):
        lf.Disk("germanium", 0.01)
    with pytest.raises(lf.ParameterError, match="attitude must be of class Attitude or None"):
        lf.Disk(FILM, 0.01, attitude=0.3)
    for function in (lf.payload, lf.lift, lf.levitate, lf.equilibrium, lf.flight.force_vector):
        with pytest.raises(lf.ParameterError, match="state must be of class EnvironmentState"):
            function(disk, 72e3, lf.Lu2023())
        with pytest.raises(lf.ParameterError, match="model must be of class AbstractForceModel"):
            function(disk, state, "kinetic")
    with pytest.raises(lf.ParameterError, match="environment must be of class AbstractEnv"):
        lf.levitation_band(disk, "earth", lf.Lu2023())


def test_functions_take_lists_and_refuse_units():
    paths = lf.gas.mean_free_path([1.0, 2.0], 300.0, lf.gas.AIR)
    assert paths[0] == pytest.approx(2.0 * paths[1])
    with pytest.raises(lf.ParameterError, match=r"mean_free_path\(\) takes numbers in SI units"):
        lf.gas.mean_free_path("1 Pa", 300.0, lf.gas.AIR)
