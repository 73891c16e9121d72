import dataclasses

import numpy as np
import pytest

import lightflyer as lf


@pytest.fixture
def state():
    return lf.lu2023_earth().state(np.linspace(60e3, 80e3, 9))


def with_light(state, irradiance, **changes):
    radiation = lf.environment.Radiation(irradiance, stefan_boltzmann=5.67e-8, **changes)
    return lf.environment.EnvironmentState(
        state.pressure, state.temperature, state.gravity, state.gas, radiation
    )


@pytest.mark.parametrize(
    "model", [lf.Lu2023(), lf.Lu2023(reading=lf.force.PRINTED), lf.FreeMolecular()]
)
def test_at_the_levitation_irradiance_lift_equals_weight(disk, state, model):
    result = lf.levitate(disk, state, model)
    there = with_light(state, result.irradiance)
    lift = lf.lift(disk, there, model)
    np.testing.assert_allclose(lift, lf.statics.weight(disk, there), rtol=1e-9)
    np.testing.assert_allclose(
        lf.equilibrium(disk, there, model).temperature, result.temperature, rtol=1e-9
    )
    np.testing.assert_allclose(lf.payload(disk, there, model), 0.0, atol=1e-9 * disk.mass)


def test_payload_weighs_down(film, state):
    bare, loaded = lf.Disk(film, 0.01), lf.Disk(film, 0.01, payload=1e-7)
    model = lf.Lu2023()
    assert np.all(
        lf.levitate(loaded, state, model).irradiance > lf.levitate(bare, state, model).irradiance
    )
    # what can be carried does not depend on what is carried
    np.testing.assert_array_equal(lf.payload(loaded, state, model), lf.payload(bare, state, model))


@pytest.mark.parametrize(
    "change", [{"tac_bottom": 0.8}, {"tac_bottom": 0.7}, {"areal_density": 1.0}, {"absorptance": 0}]
)
def test_without_an_upward_difference_nothing_levitates(film, state, change):
    """Nor does what is too heavy for any light, or takes up none."""
    film = dataclasses.replace(film, **change)
    result = lf.levitate(lf.Disk(film, 0.01), state, lf.Lu2023())
    assert not np.any(result.levitates)
    assert np.all(np.isinf(result.irradiance))
    assert np.all(np.isnan(result.temperature))
    assert np.all(result.converged)


def test_heat_radiation_can_suffice(disk, state):
    glowing = with_light(state, 0.0, infrared_above=1e5, infrared_below=1e5)
    result = lf.levitate(disk, glowing, lf.FreeMolecular())
    assert np.all(result.levitates)
    assert result.irradiance.min() == 0.0


def test_irradiance_of_the_state_has_no_effect(disk, state):
    model = lf.Lu2023()
    np.testing.assert_array_equal(
        lf.levitate(disk, with_light(state, 1.0), model).irradiance,
        lf.levitate(disk, with_light(state, 1e4), model).irradiance,
    )


def test_grazing_light_does_not_levitate(disk):
    """At 90° the cosine is 6e-17, not zero: without a limit 1e19 W/m² would levitate the disk."""
    angles = np.radians([0.0, 89.0, 89.999, 90.0])
    state = lf.lu2023_earth(incidence=angles).state(72e3)
    result = lf.levitate(disk, state, lf.Lu2023())
    assert result.levitates.tolist() == [True, True, False, False]
    assert np.all(np.isinf(result.irradiance[2:]))
    assert np.all(np.isnan(result.temperature[2:]))
