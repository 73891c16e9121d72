import numpy as np
import pytest

import lightflyer as lf
from lightflyer.gas.carbon_dioxide import (
    reference_conductivity,
    reference_heat_capacity,
    reference_viscosity,
)

CO2, FROZEN = lf.gas.CARBON_DIOXIDE, lf.gas.FROZEN_CARBON_DIOXIDE


# Wavenumbers of the four vibrations of carbon dioxide [1/cm] (NIST Chemistry WebBook), and the
# second radiation constant [cm K].
WAVENUMBERS = np.array([667.0, 667.0, 1333.0, 2349.0])
SECOND_RADIATION = 1.438777


def rigid_rotor_and_oscillators(temperature):
    """Isobaric heat capacity over the gas constant, from spectroscopy alone."""
    half = 0.5 * SECOND_RADIATION * WAVENUMBERS / np.asarray(temperature)[..., None]
    return 3.5 + np.sum((half / np.sinh(half)) ** 2, axis=-1)


def test_ratio_of_heat_capacities_is_that_of_the_molecules_vibrations():
    temperature = np.array([130.0, 140.0, 170.0, 200.0, 250.0, 300.0, 400.0])
    capacity = rigid_rotor_and_oscillators(temperature)
    found = CO2.heat_capacity_ratio_at(temperature)
    np.testing.assert_allclose(found, capacity / (capacity - 1.0), rtol=5e-4)
    np.testing.assert_allclose(found[[1, 3, 5]], [1.385, 1.346, 1.288], rtol=5e-4)


def test_conductivity_of_cold_gas_keeps_the_eucken_factor():
    temperature = np.array([100.0, 120.0, 149.0, 150.0, 200.0])
    eucken = reference_conductivity(temperature) / (
        reference_viscosity(temperature)
        * (reference_heat_capacity(temperature) - 1.0)
        * CO2.specific_gas_constant
    )
    np.testing.assert_allclose(eucken[:4], eucken[3], rtol=1e-12)
    assert eucken[4] == pytest.approx(eucken[3], rel=0.013)
    # the published fit, which turns up below its data, by CoolProp
    assert 5.4294684345e-03 / reference_conductivity(110.0) > 1.03


def test_followed_formulas_and_their_gentle_continuation():
    temperature = np.linspace(100.0, 1100.0, 1001)
    np.testing.assert_allclose(
        CO2.conductivity(temperature), reference_conductivity(temperature), rtol=1e-5
    )
    assert CO2.conductivity(25.0) == pytest.approx(0.5 * CO2.conductivity(100.0), rel=1e-12)
    assert CO2.viscosity(4400.0) == pytest.approx(2.0 * CO2.viscosity(1100.0), rel=1e-12)


def test_temperatures_beyond_the_correlations_are_said():
    assert CO2.diagnostics(np.array([130.0, 300.0]), 1.0) == ()
    (cold,), (hot,) = CO2.diagnostics(90.0, 1.0), FROZEN.diagnostics(1200.0, 1.0)
    assert "temperature of carbon dioxide is 90" in cold
    assert "above 1.1e+03" in hot


@pytest.mark.parametrize(
    ("gas", "said"),
    [(CO2, "exchange all of the vibration"), (FROZEN, "exchange none"), (lf.gas.AIR, None)],
)
def test_what_walls_exchange_is_said_where_the_gas_is(gas, said):
    text = " ".join(lf.Chamber(gas=gas).assumptions())
    assert said in text if said else "vibration" not in text


def test_no_law_takes_a_single_ratio_of_heat_capacities():
    with pytest.raises(lf.ParameterError, match="heat_capacity_ratio_at"):
        _ = CO2.heat_capacity_ratio
    assert FROZEN.heat_capacity_ratio_at(200.0) == pytest.approx(1.4)
    assert lf.gas.AIR.heat_capacity_ratio_at(200.0) == lf.gas.AIR.heat_capacity_ratio


def test_free_molecular_heat_is_the_energy_that_molecules_carry(disk):
    """Flux of molecules times (2 kT of translation along, and internal energy), in and out."""
    cold, hot, pressure = 140.0, 260.0, 1e-4

    environment = lf.Chamber(temperature=cold, gas=CO2)
    excess = hot / cold - 1.0
    (found,) = lf.FreeMolecular().heat_loss(disk, environment.state(pressure), (excess,))
    temperatures = np.linspace(cold, hot, 2001)
    internal = np.trapezoid(rigid_rotor_and_oscillators(temperatures) - 2.5, temperatures)
    mass_flux = pressure / np.sqrt(2.0 * np.pi * CO2.specific_gas_constant * cold)
    energy = CO2.specific_gas_constant * (2.0 * (hot - cold) + internal)
    assert found == pytest.approx(0.85 * 2.0 * disk.area * mass_flux * energy, rel=3.5e-3)
