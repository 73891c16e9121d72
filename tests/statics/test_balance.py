from typing import ClassVar

import jax
import numpy as np
import numpy_model
import pytest
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.statics.balance import require_converged


def state(pressure, temperature=220.0, **radiation):
    radiation.setdefault("stefan_boltzmann", 5.67e-8)
    return lf.environment.EnvironmentState(
        pressure, temperature, 9.8, lf.gas.LU2023_AIR, lf.environment.Radiation(**radiation)
    )


@pytest.mark.parametrize("pressure", [1e-4, 1e-2, 1.0, 100.0, 1e5])
def test_temperature_equals_brentq_on_the_numpy_equations(disk, pressure):
    absorbed = 0.75 * 1360.0 * np.pi * 1e-4
    expected = brentq(
        lambda hot: numpy_model.lost_power(hot, 220.0, pressure, 0.01, 0.85, 0.08) - absorbed,
        220.0 + 1e-9,
        3000.0,
        xtol=1e-11,
    )
    result = lf.equilibrium(disk, state(pressure, irradiance=1360.0), lf.Lu2023())
    assert result.temperature == pytest.approx(expected, rel=1e-11)


def test_energy_closes(disk):
    result = lf.equilibrium(disk, state(np.geomspace(1e-4, 1e5, 50)), lf.Lu2023())
    lost = result.gas_power + result.radiated_power
    np.testing.assert_allclose(lost, result.absorbed_power, rtol=1e-11)
    assert np.all(np.abs(result.residual) < 1e-10)


def test_without_light_the_flyer_is_as_warm_as_the_gas(disk):
    result = lf.equilibrium(disk, state(np.array([1e-4, 1.0, 1e5]), irradiance=0.0), lf.Lu2023())
    np.testing.assert_array_equal(result.temperature, 220.0)
    np.testing.assert_array_equal(result.residual, 0.0)


def test_a_faint_light_in_dense_gas_keeps_its_digits(disk):
    # the flyer is microkelvins warmer than the gas: the excess must not drown in rounding
    result = lf.equilibrium(disk, state(1e5, irradiance=1e-5), lf.Lu2023())
    lost = result.gas_power + result.radiated_power
    assert 0.0 < result.excess < 1e-6
    assert lost == pytest.approx(result.absorbed_power, rel=1e-11)


def test_a_cold_sky_cools_below_the_gas(disk):
    sky = {"irradiance": 0.0, "infrared_above": 0.0, "infrared_below": 0.0}
    cold = lf.equilibrium(disk, state(np.array([1e-9, 1.0, 1e5]), **sky), lf.Lu2023())
    assert np.all(np.diff(cold.temperature) > 0.0)
    assert cold.temperature[0] < 100.0
    assert cold.temperature[2] == pytest.approx(220.0, rel=1e-2)
    assert np.all(np.abs(cold.residual) < 1e-10)


def test_surroundings_at_gas_temperature_are_the_default_written_out(disk):
    black = 5.67e-8 * 220.0**4
    told = lf.equilibrium(disk, state(3.0, infrared_above=black, infrared_below=black), lf.Lu2023())
    default = lf.equilibrium(disk, state(3.0), lf.Lu2023())
    assert told.temperature == pytest.approx(default.temperature, rel=1e-13)


def test_faces_have_their_own_emittance_surroundings_and_albedo():
    film = lf.FilmProperties(1e-3, 0.75, 0.05, 0.4, 0.8, 0.9, absorptance_bottom=0.3)
    radiation = {"infrared_above": 10.0, "infrared_below": 240.0, "albedo": 0.3}
    vacuum = state(1e-13, irradiance=1000.0, zenith_angle=np.pi / 3, **radiation)
    found = lf.equilibrium(lf.Disk(film, 0.01), vacuum, lf.FreeMolecular()).temperature
    light = 1000.0 * 0.5 * (0.75 + 0.3 * 0.3)
    heat = 0.05 * 10.0 + 0.4 * 240.0
    assert found == pytest.approx(((light + heat) / (5.67e-8 * 0.45)) ** 0.25, rel=1e-9)


def test_arrays_of_any_shape_broadcast(film):
    disk = lf.Disk(film, radius=np.array([0.005, 0.01, 0.02]))
    grid = lf.equilibrium(disk, state(np.geomspace(0.1, 10, 4)[:, None]), lf.Lu2023())
    assert grid.temperature.shape == (4, 3)
    one = lf.equilibrium(lf.Disk(film, 0.02), state(10.0), lf.Lu2023())
    assert grid.temperature[3, 2] == pytest.approx(one.temperature, rel=1e-13)


def test_non_convergence_raises_unless_asked_not_to(disk):
    class Broken(lf.AbstractForceModel):
        flyers: ClassVar = (lf.Disk,)

        def heat_loss(self, flyer, state, unknowns):
            return (-1e3 * unknowns[0],)

        def force(self, flyer, state, unknowns):
            return unknowns[0]

    with pytest.raises(lf.ConvergenceError, match="1 of 1 not converged"):
        lf.equilibrium(disk, state(1.0), Broken())
    result = lf.equilibrium(disk, state(1.0), Broken(), throw=False)
    assert not result.converged
    assert result.status == SolverStatus.TOLERANCE_MISSED


def test_nan_input_is_flagged_not_returned_in_silence(disk):
    broken = np.array([1.0, np.nan])
    poisoned = tree.replace_at(lambda state: state.pressure, state(1.0), broken)
    with pytest.raises(lf.ConvergenceError, match="1 of 2"):
        lf.equilibrium(disk, poisoned, lf.Lu2023())
    result = lf.equilibrium(disk, poisoned, lf.Lu2023(), throw=False)
    np.testing.assert_array_equal(result.converged, [True, False])
    np.testing.assert_array_equal(result.status, [SolverStatus.CONVERGED, SolverStatus.NOT_FINITE])


def test_under_jit_the_flag_is_the_only_word(disk):
    solve = jax.jit(lambda p: lf.equilibrium(disk, state(p), lf.Lu2023()).converged)
    np.testing.assert_array_equal([solve(np.nan), solve(1.0)], [False, True])


def test_only_concrete_failures_raise_and_say_why():
    status = np.array([SolverStatus.CONVERGED, SolverStatus.STEP_LIMIT])
    with pytest.raises(lf.ConvergenceError, match=r"search: 1 of 2 not converged \(.*limit"):
        require_converged("search", status, np.array([0.0, 0.5]))
    assert require_converged("search", status[:1], np.array([0.0])) is None
