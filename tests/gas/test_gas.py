import numpy as np
import numpy_model
import pytest

import lightflyer as lf

TEMPERATURES = np.linspace(150.0, 900.0, 16)


def test_paper_gas_matches_its_equations():
    gas = lf.gas.LU2023_AIR
    np.testing.assert_allclose(
        gas.viscosity(TEMPERATURES), numpy_model.viscosity(TEMPERATURES), rtol=1e-13
    )
    np.testing.assert_allclose(
        gas.conductivity(TEMPERATURES), numpy_model.conductivity(TEMPERATURES), rtol=1e-13
    )
    np.testing.assert_allclose(
        gas.heat_capacity(TEMPERATURES), numpy_model.heat_capacity(TEMPERATURES), rtol=1e-13
    )


def test_paper_heat_capacity_is_that_of_air_only_with_the_corrected_coefficient():
    assert lf.gas.LU2023_AIR.heat_capacity(300.0) == pytest.approx(1005.0, rel=5e-3)


def test_standard_air_against_the_standards_own_values():
    # US Standard Atmosphere 1976, sea level: viscosity and conductivity
    assert lf.gas.US1976_AIR.viscosity(288.15) == pytest.approx(1.7894e-5, rel=3e-5)
    assert lf.gas.US1976_AIR.conductivity(288.15) == pytest.approx(2.5326e-2, rel=5e-5)


# CoolProp 8.0.0, fluid "Air" in the limit of low density: temperature [K], viscosity [Pa s],
# conductivity [W/(m K)], isobaric heat capacity over the molar gas constant [1].
COOLPROP = np.array(
    [
        (100.0, 7.0955949784e-06, 9.3590248669e-03, 3.4914228203),
        (205.0, 1.3597211036e-05, 1.8872853673e-02, 3.4922209493),
        (300.0, 1.8522999164e-05, 2.6352903981e-02, 3.5003628213),
        (500.0, 2.7080280074e-05, 3.9926689445e-02, 3.5860856253),
        (1000.0, 4.3274572874e-05, 6.7668768659e-02, 3.9745978447),
        (1500.0, 5.6321950396e-05, 9.1776209471e-02, 4.2187442627),
        (2000.0, 6.8065672648e-05, 1.1448240755e-01, 4.3551271346),
    ]
).T


def test_air_matches_an_independent_implementation_of_its_references():
    temperature, viscosity, conductivity, heat_capacity = COOLPROP
    air = lf.gas.AIR
    np.testing.assert_allclose(air.viscosity(temperature), viscosity, rtol=1e-5)
    np.testing.assert_allclose(air.conductivity(temperature), conductivity, rtol=1e-5)
    per_constant = air.heat_capacity(temperature) / air.specific_gas_constant
    np.testing.assert_allclose(per_constant, heat_capacity, rtol=1e-5)
    # the formulas themselves, to the digits
    published = air.correlations
    np.testing.assert_allclose(published.viscosity(temperature), viscosity, rtol=1e-9)
    np.testing.assert_allclose(published.conductivity(temperature), conductivity, rtol=1e-9)
    np.testing.assert_allclose(published.heat_capacity(temperature), heat_capacity, rtol=2e-8)


def test_air_has_the_published_check_values():
    # Lemmon & Jacobsen (2004), table of check values at zero density
    for temperature, viscosity, conductivity in (
        (100.0, 7.09559, 9.35902),
        (300.0, 18.5230, 26.3529),
    ):
        assert lf.gas.AIR.viscosity(temperature) * 1e6 == pytest.approx(viscosity, rel=1e-5)
        assert lf.gas.AIR.conductivity(temperature) * 1e3 == pytest.approx(conductivity, rel=1e-5)


def test_air_follows_the_published_formulas_and_continues_gently_beyond_their_range():
    temperature = np.linspace(60.0, 2000.0, 3001)
    air = lf.gas.AIR
    per_constant = air.heat_capacity(temperature) / air.specific_gas_constant
    for found, published in (
        (air.viscosity(temperature), air.correlations.viscosity),
        (air.conductivity(temperature), air.correlations.conductivity),
        (per_constant, air.correlations.heat_capacity),
    ):
        np.testing.assert_allclose(found, published(temperature), rtol=1e-5)
    assert air.heat_capacity(1e5) == pytest.approx(air.heat_capacity(2000.0), rel=1e-12)
    assert air.heat_capacity(1.0) == pytest.approx(3.49 * 287.053, rel=2e-3)
    assert air.viscosity(8000.0) == pytest.approx(2.0 * air.viscosity(2000.0), rel=1e-12)
    assert air.conductivity(15.0) == pytest.approx(0.5 * air.conductivity(60.0), rel=1e-12)


def test_heat_capacity_follows_the_gas_constant_of_the_composition():
    thin = lf.Earth().state(120e3).gas
    assert thin.heat_capacity(300.0) / thin.specific_gas_constant == pytest.approx(
        3.50036, rel=1e-5
    )


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
