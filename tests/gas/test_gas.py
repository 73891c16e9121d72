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
    assert lf.gas.AIR.viscosity(288.15) == pytest.approx(1.7894e-5, rel=3e-5)
    assert lf.gas.AIR.conductivity(288.15) == pytest.approx(2.5326e-2, rel=5e-5)


@pytest.mark.parametrize("gas", [lf.gas.AIR, lf.gas.LU2023_AIR])
def test_both_airs_agree_about_air(gas):
    # CODATA-grade air at 300 K: 18.54 uPa s, 26.4 mW/(m K)
    assert gas.viscosity(300.0) == pytest.approx(18.54e-6, rel=0.02)
    assert gas.conductivity(300.0) == pytest.approx(26.4e-3, rel=0.03)


def test_mean_free_path_at_sea_level_and_its_scaling():
    sea_level = lf.gas.mean_free_path(101325.0, 288.15, lf.gas.AIR)
    assert sea_level == pytest.approx(6.366e-8, rel=1e-4)
    assert lf.gas.mean_free_path(101325.0 / 7, 288.15, lf.gas.AIR) == pytest.approx(
        7 * sea_level, rel=1e-12
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
