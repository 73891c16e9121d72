import numpy as np
import numpy_model
import pytest

import lightflyer as lf

TEMPERATURES = np.linspace(150.0, 900.0, 16)


@pytest.mark.parametrize("name", ["viscosity", "conductivity", "heat_capacity"])
def test_paper_gas_matches_its_equations(name):
    found, expected = getattr(lf.gas.LU2023_AIR, name), getattr(numpy_model, name)
    np.testing.assert_allclose(found(TEMPERATURES), expected(TEMPERATURES), rtol=1e-13)


def test_standard_air_against_the_standards_own_values():
    # US Standard Atmosphere 1976, sea level: viscosity and conductivity
    assert lf.gas.US1976_AIR.viscosity(288.15) == pytest.approx(1.7894e-5, rel=3e-5)
    assert lf.gas.US1976_AIR.conductivity(288.15) == pytest.approx(2.5326e-2, rel=5e-5)


def test_heat_capacity_follows_the_gas_constant_of_the_composition():
    thin = lf.Earth().state(120e3).gas
    per_constant = thin.heat_capacity(300.0) / thin.specific_gas_constant
    assert per_constant == pytest.approx(3.50036, rel=1e-5)


def test_every_gas_of_a_flyer_file_stays_physical_over_all_temperatures_a_search_visits():
    temperature = np.geomspace(30.0, 1e4, 200)
    for name, gas in lf.gas.GASES.items():
        if name == "lu2023-air":
            temperature = temperature[temperature < 2500.0]  # its cubic turns down
        for property_ in (gas.viscosity, gas.conductivity):
            assert np.all(np.diff(property_(temperature)) > 0.0)
        assert np.all(gas.heat_capacity(temperature) > 0.0)


AIRS = {name: gas for name, gas in lf.gas.GASES.items() if name.endswith("air")}


@pytest.mark.parametrize("gas", AIRS.values(), ids=list(AIRS))
def test_all_airs_agree_about_air(gas):
    # CODATA-grade air at 300 K: 18.54 uPa s, 26.4 mW/(m K)
    assert gas.viscosity(300.0) == pytest.approx(18.54e-6, rel=0.02)
    assert gas.conductivity(300.0) == pytest.approx(26.4e-3, rel=0.03)
    assert gas.heat_capacity(300.0) == pytest.approx(1005.0, rel=2e-3)


def test_mean_free_path_of_one_atmosphere_and_its_scaling():
    # 18.523e-6 / 101325 * sqrt(pi * 287.053 * 300 / 2)
    one_atmosphere = lf.gas.mean_free_path(101325.0, 300.0, lf.gas.AIR)
    assert one_atmosphere == pytest.approx(6.7235e-8, rel=1e-4)
    assert lf.gas.mean_free_path(101325.0 / 7, 300.0, lf.gas.AIR) == pytest.approx(
        7 * one_atmosphere, rel=1e-12
    )


def test_arrays_equal_scalars():
    pressures = np.geomspace(1e-3, 1e5, 5)[:, None]
    together = lf.gas.knudsen_number(pressures, TEMPERATURES, 0.01, lf.gas.AIR)
    assert together.shape == (5, 16)
    one = lf.gas.knudsen_number(float(pressures[3, 0]), float(TEMPERATURES[4]), 0.01, lf.gas.AIR)
    assert together[3, 4] == pytest.approx(one, rel=1e-14)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_impossible_states_raise(bad):
    with pytest.raises(lf.ParameterError, match=r"pressure = .* is not positive"):
        lf.gas.mean_free_path(bad, 300.0, lf.gas.AIR)
    with pytest.raises(lf.ParameterError, match="temperature"):
        lf.gas.mean_free_path(1.0, np.array([300.0, bad]), lf.gas.AIR)
    with pytest.raises(ValueError, match="radius"):
        lf.gas.knudsen_number(1.0, 300.0, bad, lf.gas.AIR)
