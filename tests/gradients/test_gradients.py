"""Derivatives of the public functions against finite differences, and jit and vmap against
the plain call."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from jax.test_util import check_grads

import lightflyer as lf
from lightflyer.array.transformations import compiled

MODELS = {
    "free-molecular": lf.FreeMolecular(),
    "linear": lf.force.LinearFreeMolecular(),
    "reported": lf.Lu2023(),
    "printed": lf.Lu2023(reading=lf.force.PRINTED),
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
    radiation = lf.environment.Radiation(light, 0.3, infrared_below=200.0, albedo=0.2)
    state = lf.environment.EnvironmentState(pressure, temperature, 9.6, lf.gas.AIR, radiation)
    return lf.Disk(film, radius, payload=1e-9), state


def outcomes(x, model):
    """Lift, temperature, levitation irradiance and payload, scaled to order one."""
    flyer, state = build(x)
    return lf.xp.stack(
        [
            lf.xp.log(lf.lift(flyer, state, model)),
            lf.xp.log(lf.equilibrium(flyer, state, model).temperature),
            lf.xp.log(lf.levitate(flyer, state, model).irradiance),
            lf.payload(flyer, state, model) * 1e6,
        ]
    )


def of_logarithms(model):
    # so that one step suits all inputs
    return lambda y: outcomes(jnp.exp(y), model)


@functools.cache
def reverse_of(name):
    return compiled(jax.jacrev(of_logarithms(MODELS[name])))


@pytest.mark.parametrize("name", MODELS)
def test_derivatives(name):
    for point in np.log(POINTS):
        shifts = 1e-5 * np.eye(point.size)
        ends = [
            outcomes(np.exp(point[:, None] + sign * shifts), MODELS[name]) for sign in (1.0, -1.0)
        ]
        expected = np.asarray(ends[0] - ends[1]) / 2e-5
        scale = np.abs(expected).max()
        slopes = reverse_of(name)(point)
        np.testing.assert_allclose(slopes, expected, rtol=1e-6, atol=1e-8 * scale)


def test_forward_derivatives_are_the_reverse_ones():
    forward = compiled(lambda y, along: jax.jvp(of_logarithms(MODELS["reported"]), (y,), (along,)))
    points, direction = np.log(POINTS), np.linspace(-1.0, 1.0, 9)
    _, slopes = forward(points.T, np.repeat(direction[:, None], len(points), axis=1))
    for point, slope in zip(points, slopes.T, strict=True):
        pulled = reverse_of("reported")(point) @ direction
        np.testing.assert_allclose(slope, pulled, rtol=1e-9)


def test_second_derivatives():
    # of the logarithm of lift in the logarithm of irradiance, by differences of the first
    def slope(log_light):
        point = jnp.asarray(POINTS[0]).at[-1].set(jnp.exp(log_light))
        flyer, state = build(point)
        return jnp.log(lf.lift(flyer, state, lf.Lu2023()))

    @compiled
    def first_and_second(log_light):
        return jax.jvp(jax.grad(slope), (log_light,), (jnp.ones_like(log_light),))

    light, step = np.log(1360.0), 1e-4
    (low, _), (_, second), (high, _) = map(first_and_second, (light - step, light, light + step))
    assert float(second) == pytest.approx(float((high - low) / (2.0 * step)), rel=1e-5)


def test_jit_and_vmap_equal_the_plain_call():
    model = lf.Lu2023()
    plain = [outcomes(point, model) for point in POINTS]
    alone, mapped = (lambda x: outcomes(x, model)), jax.vmap(lambda x: outcomes(x, model))
    with lf.float64():
        single, many = compiled(lambda x: (alone(x[0]), mapped(x)))(POINTS)
    np.testing.assert_allclose(single, plain[0], rtol=1e-10)
    np.testing.assert_allclose(many, plain, rtol=1e-10)


@pytest.mark.parametrize("atmosphere", [lf.environment.US1976(), lf.environment.Lu2023Atmosphere()])
@pytest.mark.parametrize("altitude", [5e3, 31e3, 72e3, 83.2e3, 96e3, 106e3, 119e3])
def test_atmospheres(atmosphere, altitude):
    for quantity in (atmosphere.temperature, atmosphere.pressure, atmosphere.molar_mass_ratio):
        with lf.float64():
            slope = float(jax.grad(quantity)(altitude))
        step = 5.0
        rise = quantity(altitude + step) - quantity(altitude - step)
        # differences of rounded numbers: exact to about 1e-12 of the quantity per step
        assert slope == pytest.approx(rise / (2 * step), rel=1e-4, abs=1e-12)


@pytest.mark.parametrize("gas", [lf.gas.AIR, lf.gas.LU2023_AIR])
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


def test_derivative_in_the_dark_is_that_of_a_faint_light(film):

    def temperature(light):
        radiation = lf.environment.Radiation(light)
        state = lf.environment.EnvironmentState(3.0, 215.0, 9.6, lf.gas.AIR, radiation)
        return lf.equilibrium(lf.Disk(film, 0.01), state, lf.FreeMolecular()).temperature

    with lf.float64():
        dark, faint = (float(jax.grad(temperature)(light)) for light in (0.0, 1e-6))
    assert dark == pytest.approx(faint, rel=1e-6)
    assert dark > 0.0
