"""Derivatives of the public functions against finite differences, and jit and vmap against
the plain call."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.test_util import check_grads

import lightflyer as lf

MODELS = {
    "free-molecular": lf.FreeMolecular(),
    "linear": lf.LinearFreeMolecular(),
    "reported": lf.Lu2023(),
    "printed": lf.Lu2023(reading=lf.PRINTED),
}
# radius, areal density, absorptance, emittance, top TAC, bottom TAC, pressure, temperature,
# irradiance: each at several points of the operating range
POINTS = np.array(
    [
        [0.01, 1e-3, 0.75, 0.08, 0.80, 0.90, 3.4, 215.0, 1360.0],
        [0.002, 4e-4, 0.50, 0.30, 0.60, 0.95, 40.0, 270.0, 3000.0],
        [0.03, 1e-4, 0.90, 0.05, 0.75, 0.98, 0.2, 190.0, 900.0],
    ]
)


def build(x):
    radius, areal_density, absorptance, emittance, top, bottom, pressure, temperature, light = x
    film = lf.FilmProperties(areal_density, absorptance, emittance, emittance, top, bottom)
    radiation = lf.Radiation(light, 0.3, infrared_bottom=200.0, albedo=0.2)
    state = lf.EnvironmentState(pressure, temperature, 9.6, lf.AIR, radiation)
    return lf.Disk(film, radius, payload=1e-9), state


def log_lift(x, model):
    return jnp.log(lf.lift(*build(x), model))


def log_temperature(x, model):
    return jnp.log(lf.equilibrium(*build(x), model).temperature)


def log_levitation(x, model):
    return jnp.log(lf.levitate(*build(x), model).irradiance)


def scaled_payload(x, model):
    return lf.payload(*build(x), model) * 1e6


FUNCTIONS = [log_lift, log_temperature, log_levitation, scaled_payload]


def central_differences(function, points, step=1e-5):
    """Slope of a function of a vector in each component, shape (points, components)."""
    steps = step * jnp.eye(points.shape[1])
    shifted = jnp.stack([points[:, None, :] + steps, points[:, None, :] - steps])
    high, low = jax.jit(jax.vmap(jax.vmap(jax.vmap(function))))(shifted)
    return (high - low) / (2.0 * step)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS.keys())
@pytest.mark.parametrize("function", FUNCTIONS)
def test_forward_and_reverse_derivatives(function, model):
    # in logarithms of the inputs, so that one step suits all of them
    def of_logarithms(y):
        return function(jnp.exp(y), model)

    with lf.float64():
        points = jnp.log(jnp.asarray(POINTS))
        expected = np.asarray(central_differences(of_logarithms, points))
        forward = np.asarray(jax.jit(jax.vmap(jax.jacfwd(of_logarithms)))(points))
        reverse = np.asarray(jax.jit(jax.vmap(jax.jacrev(of_logarithms)))(points))
    scale = np.abs(expected).max()
    assert np.all(np.abs(expected).max(axis=0) > 1e-6 * scale) or function is log_levitation
    np.testing.assert_allclose(forward, expected, rtol=1e-6, atol=1e-8 * scale)
    np.testing.assert_allclose(reverse, forward, rtol=1e-10, atol=1e-14 * scale)


def test_second_derivatives():
    with lf.float64():
        check_grads(
            lambda y: log_lift(jnp.exp(y), lf.Lu2023()),
            (jnp.log(jnp.asarray(POINTS[0])),),
            order=2,
            modes=("rev",),
            rtol=1e-4,
            atol=1e-5,
        )


@pytest.mark.parametrize("function", FUNCTIONS)
def test_jit_and_vmap_equal_the_plain_call(function):
    model = lf.Lu2023()
    with lf.float64():
        plain = [float(function(point, model)) for point in POINTS]
        compiled = jax.jit(lambda x: function(x, model))
        np.testing.assert_allclose([compiled(point) for point in POINTS], plain, rtol=1e-10)
        mapped = jax.vmap(lambda x: function(x, model))(jnp.asarray(POINTS))
    np.testing.assert_allclose(mapped, plain, rtol=1e-10)


@pytest.mark.parametrize("atmosphere", [lf.US1976(), lf.Lu2023Atmosphere()])
@pytest.mark.parametrize("altitude", [5e3, 31e3, 72e3, 83.2e3, 96e3, 106e3, 119e3])
def test_atmospheres(atmosphere, altitude):
    for quantity in (atmosphere.temperature, atmosphere.pressure, atmosphere.molar_mass_ratio):
        with lf.float64():
            slope = float(jax.grad(quantity)(altitude))
        step = 5.0
        rise = quantity(altitude + step) - quantity(altitude - step)
        # differences of rounded numbers: exact to about 1e-12 of the quantity per step
        assert slope == pytest.approx(rise / (2 * step), rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("gas", [lf.AIR, lf.LU2023_AIR])
def test_gases(gas):
    for quantity in (gas.viscosity, gas.conductivity, gas.heat_capacity, gas.mean_speed):
        with lf.float64():
            check_grads(lambda y, q=quantity: jnp.log(q(jnp.exp(y))), (5.5,), 1, rtol=1e-6)


def test_a_flyer_that_cannot_levitate_poisons_no_gradient():
    # one hopeless element in a batch must not turn the others' derivatives into NaN
    def total(tac_bottom):
        film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, tac_bottom)
        result = lf.levitate(lf.Disk(film, 0.01), lf.lu2023_earth().state(72e3), lf.Lu2023())
        return jnp.where(result.levitates, result.irradiance, 0.0).sum()

    with lf.float64():
        slope = np.asarray(jax.grad(total)(jnp.array([0.9, 0.8, 0.7])))
    assert np.all(np.isfinite(slope))
    assert slope[0] < 0.0
    assert slope[1] == slope[2] == 0.0


def test_derivative_in_the_dark_is_that_of_a_faint_light():
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, 0.9)

    def temperature(light):
        radiation = lf.Radiation(light)
        state = lf.EnvironmentState(3.0, 215.0, 9.6, lf.AIR, radiation)
        return lf.equilibrium(lf.Disk(film, 0.01), state, lf.FreeMolecular()).temperature

    with lf.float64():
        dark, faint = (float(jax.grad(temperature)(light)) for light in (0.0, 1e-6))
    assert dark == pytest.approx(faint, rel=1e-6)
    assert dark > 0.0
