import datetime
import socket
import sys

import jax
import numpy as np
import pytest

import lightflyer as lf

MIDSUMMER = datetime.datetime(2024, 6, 21, 12)


@pytest.fixture
def offline(monkeypatch):
    def refuse(*_args, **_kwargs):
        raise AssertionError("tried to use the network")

    monkeypatch.setattr(socket, "create_connection", refuse)
    monkeypatch.setattr(socket.socket, "connect", refuse)


@pytest.fixture
def nrlmsis(offline):
    return lf.environment.NRLMSIS(MIDSUMMER, latitude=40.0, longitude=-75.0, f107=150.0, ap=4.0)


def hydrostatic_error(atmosphere, altitudes, gas_constant, gravity, step=10.0):
    """Relative error of dp/dh = -p g / (R T), with R following the molar mass."""
    pressure = atmosphere.pressure(altitudes + step), atmosphere.pressure(altitudes - step)
    slope = np.log(pressure[0] / pressure[1]) / (2 * step)
    local_constant = gas_constant / atmosphere.molar_mass_ratio(altitudes)
    expected = -gravity / (local_constant * atmosphere.temperature(altitudes))
    return slope / expected - 1.0


def standard_gravity(altitude):
    return 9.80665 * (6356766.0 / (6356766.0 + altitude)) ** 2


def test_paper_atmosphere_is_hydrostatic():
    altitudes = np.linspace(1e3, 119e3, 60)
    error = hydrostatic_error(lf.environment.Lu2023Atmosphere(), altitudes, 287.05, 9.8)
    assert np.abs(error).max() < 1e-5


def test_standard_atmosphere_is_hydrostatic_through_every_layer():
    altitudes = np.linspace(0.5e3, 150e3, 300)
    error = hydrostatic_error(
        lf.environment.US1976(), altitudes, 8314.32 / 28.9644, standard_gravity(altitudes)
    )
    assert np.abs(error[altitudes < 85.9e3]).max() < 1e-7
    # above, the standard adds up gases computed one by one; its table departs by 2 % around 100 km
    mixing = (altitudes > 93e3) & (altitudes < 110e3)
    assert np.abs(error[(altitudes > 86.1e3) & ~mixing]).max() < 3e-3
    assert np.abs(error[mixing]).max() < 0.03


def test_standard_atmosphere_is_continuous_at_its_seams():
    atmosphere = lf.environment.US1976()
    for seam in (80e3, 86e3, 91e3, 110e3, 120e3):
        for quantity in (atmosphere.temperature, atmosphere.pressure, atmosphere.molar_mass_ratio):
            below, above = quantity(seam - 1e-3), quantity(seam + 1e-3)
            assert below == pytest.approx(above, rel=2e-6)


def test_nrlmsis_matches_pymsis_between_its_nodes_without_network(nrlmsis):
    import pymsis

    heights = np.array([12.3, 50.26, 71.9, 88.25, 101.1, 149.9])
    direct = pymsis.calculate(
        np.datetime64(MIDSUMMER), -75.0, 40.0, heights, 150.0, 150.0, [[4.0] * 7], version=2.1
    ).reshape(heights.size, -1)
    np.testing.assert_allclose(nrlmsis.temperature(heights * 1e3), direct[:, 10], rtol=2e-5)
    pressure = np.nansum(direct[:, 1:10], axis=1) * 1.380649e-23 * direct[:, 10]
    np.testing.assert_allclose(nrlmsis.pressure(heights * 1e3), pressure, rtol=2e-5)


def test_nrlmsis_takes_time_zones(offline):
    eastern = datetime.timezone(datetime.timedelta(hours=-5))
    aware = datetime.datetime(2024, 6, 21, 7, tzinfo=eastern)
    place = {"latitude": 40.0, "longitude": -75.0, "f107": 150.0, "ap": 4.0}
    same = lf.environment.NRLMSIS(MIDSUMMER, **place), lf.environment.NRLMSIS(aware, **place)
    assert same[0].temperature(90e3) == same[1].temperature(90e3)


@pytest.mark.parametrize(
    ("name", "value"), [("latitude", 91.0), ("longitude", -181.0), ("f107", 0.0), ("ap", -1.0)]
)
def test_nrlmsis_rejects_impossible_arguments(name, value):
    arguments = {"latitude": 0.0, "longitude": 0.0, "f107": 150.0, "ap": 4.0, name: value}
    with pytest.raises(lf.ParameterError, match=name):
        lf.environment.NRLMSIS(MIDSUMMER, **arguments)


def test_missing_pymsis_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pymsis", None)
    with pytest.raises(lf.MissingExtraError, match=r"lightflyer\[nrlmsis\]"):
        lf.environment.NRLMSIS(MIDSUMMER, 0.0, 0.0, 150.0, 4.0)


@pytest.mark.parametrize("atmosphere", [lf.environment.US1976(), lf.environment.Lu2023Atmosphere()])
def test_outside_the_range_concrete_raises_and_traced_is_nan(atmosphere):
    earth = lf.Earth(atmosphere=atmosphere)
    beyond = atmosphere.altitude_range[1] + 1.0
    with pytest.raises(lf.ParameterError, match="altitude"):
        earth.state(np.array([50e3, beyond]))
    with pytest.raises(lf.ParameterError, match="altitude"):
        earth.state(-1.0)
    assert np.isnan(jax.jit(atmosphere.pressure)(1.1 * beyond))


def test_gravity_falls_off_unless_given():
    assert lf.Earth().state(0.0).gravity == pytest.approx(9.80665, rel=1e-12)
    assert lf.Earth().state(100e3).gravity == pytest.approx(9.505, rel=3e-5)  # table I
    assert lf.Earth(gravity=9.8).state(86e3).gravity == pytest.approx(9.8, rel=1e-12)


def test_gas_constant_follows_the_composition():
    earth = lf.Earth()
    assert earth.state(70e3).gas.specific_gas_constant == pytest.approx(287.053, rel=1e-6)
    # the standard's mean molar mass at 120 km is 26.20
    assert earth.state(120e3).gas.specific_gas_constant == pytest.approx(8314.32 / 26.20, rel=1e-3)


def test_chamber_states():
    chamber = lf.Chamber(temperature=295.0)
    state = chamber.state(np.array([1.0, 10.0]))
    np.testing.assert_array_equal(state.pressure, [1.0, 10.0])
    with pytest.raises(lf.ParameterError, match="pressure = -1 is not positive"):
        chamber.state(-1.0)
    with pytest.raises(lf.ParameterError, match="pressure_range"):
        lf.Chamber(pressure_range=(10.0, 1.0))
    with pytest.raises(lf.ParameterError, match="temperature"):
        lf.Chamber(temperature=0.0)


def test_radiation_rejects_the_impossible():
    for bad in (
        {"irradiance": -1.0},
        {"zenith_angle": 4.0},
        {"albedo": 1.1},
        {"infrared_above": -1.0},
        {"ground_view": 1.5},
    ):
        with pytest.raises(lf.ParameterError, match=next(iter(bad))):
            lf.environment.Radiation(**bad)
