"""Open balloons by the gas law: the air inside is lighter by what film and payload weigh."""

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.reader import read_design

HEIGHTS = np.linspace(1e3, 40e3, 60)


@pytest.fixture
def setup(tmp_path):
    path = tmp_path / "balloon.toml"

    def of(diameter):
        text = templates()["balloon"].read()
        path.write_text(text.replace('"5.8 m"', f'"{diameter} m"', 1), encoding="utf-8")
        return read_design(path).setup

    return of


@pytest.mark.parametrize("diameter", [5.8, 100, 1000])
def test_balloons_of_any_size_levitate_as_the_gas_law_says(setup, diameter):
    """Where the lift is a thousandth of the air that the balloon displaces, too."""
    made = setup(diameter)
    state = made.environment.state(HEIGHTS)
    found = lf.levitate(made.flyer, state, made.model)
    volume = np.pi / 6.0 * diameter**3
    density = state.pressure / (state.gas.specific_gas_constant * state.temperature)
    within = state.temperature / (1.0 - made.flyer.mass / (density * volume))
    there = found.levitates & (found.irradiance > 0.0)
    assert there.any()
    assert np.all(np.abs(found.residual) <= 1e-10)
    np.testing.assert_allclose(found.temperature[there], within[there], rtol=1e-9)
    prediction = lf.predict(made.flyer, made.environment, made.model)
    assert prediction.verdict


def test_by_jax_they_do_too(setup):
    made = setup(100)
    state = made.environment.state(HEIGHTS[:5])
    with lf.float64():
        found = jax.jit(lambda s: lf.levitate(made.flyer, s, made.model))(state)
    here = lf.levitate(made.flyer, state, made.model)
    np.testing.assert_allclose(found.irradiance, here.irradiance, rtol=1e-10)
    assert np.all(np.abs(found.residual) <= 1e-10)
