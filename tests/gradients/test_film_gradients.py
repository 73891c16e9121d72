"""Derivatives of film optics against finite differences; jit and vmap against the plain call."""

import jax
import jax.numpy as jnp
import numpy as np
import tmm
from jax.test_util import check_grads

import lightflyer as lf
from lightflyer.film import (
    Film,
    Layer,
    absorptance,
    emittance,
    emittance_curve,
    material,
    stack_optics,
)
from lightflyer.film.optics.transfer_matrix import transfer

# n and k of two layers, thickness / 100 nm, wavelength / 500 nm, incidence
POINT = np.array([1.7, 3.5, 0.02, 0.8, 1.3, 0.4, 1.1, 0.7])


def outcomes(x):
    optics = stack_optics(x[:2], x[2:4], 1e-7 * x[4:6], 5e-7 * x[6], x[7])
    return jnp.concatenate(
        [jnp.ravel(part) for part in (optics.reflectance, optics.transmittance, optics.absorptance)]
    )


def test_optics():
    with lf.float64():
        check_grads(jax.jit(outcomes), (jnp.asarray(POINT),), 1, modes=["rev"], rtol=1e-5)


def test_optics_under_jit_and_vmap(compiled):
    points = POINT * np.linspace(0.9, 1.1, 5)[:, None]
    with lf.float64():
        plain = np.array([outcomes(point) for point in points])
        mapped = compiled(jax.vmap(outcomes))(points)
    np.testing.assert_allclose(mapped, plain, rtol=1e-12, atol=1e-15)


# as POINT: absorbing, clear, opaque below one without thickness, with total reflection inside, and
# where the square of the normal wave number has no real part
EDGES = np.array(
    [
        POINT,
        [1.7, 3.5, 0.0, 0.0, 1.3, 0.4, 1.1, 0.7],
        [1.7, 3.5, 0.02, 4.0, 0.0, 5e3, 1.1, 0.0],
        [0.4, 1.9, 1e-9, 1e-9, 1.3, 0.4, 1.1, 0.9],
        [2.0, 3.5, 2.0, 0.8, 1.3, 0.4, 1.1, 0.0],
    ]
)


def shares(x):
    """R and T of s, then of p."""
    found = transfer(x[:2], x[2:4], 1e-7 * x[4:6], 5e-7 * x[6], x[7], inside=False)
    return jnp.concatenate([found.reflectance, found.transmittance])


def shares_of_tmm(x):
    index, depth = [1.0, *(x[:2] + 1j * x[2:4]), 1.0], [np.inf, *(1e-7 * x[4:6]), np.inf]
    found = [tmm.coh_tmm(one, index, depth, x[7], 5e-7 * x[6]) for one in "sp"]
    return np.array([one[name] for name in "RT" for one in found])


def test_slopes_are_those_of_tmm(compiled):
    """Central differences of tmm, which are good to 1e-7 of the largest."""
    step = 1e-5
    with lf.float64():
        forward = compiled(jax.vmap(jax.jacfwd(shares)))(EDGES)
        reverse = compiled(jax.vmap(jax.jacrev(shares)))(EDGES)
    np.testing.assert_allclose(forward, reverse, rtol=1e-10, atol=1e-12)
    inner = [0, 1, 4, 5, 6]  # tmm refuses gain, and incidence below zero
    for point, slopes in zip(EDGES, reverse, strict=True):
        for place in inner:
            shift = step * np.eye(8)[place]
            rise = shares_of_tmm(point + shift) - shares_of_tmm(point - shift)
            np.testing.assert_allclose(slopes[:, place], rise / (2.0 * step), rtol=1e-5, atol=1e-7)


COARSE = 60  # wavelengths per factor e: enough for derivatives, which are those of the sum


def film(thickness):
    return Film((Layer(material("Ge"), thickness[0]), Layer(material("PET"), thickness[1])))


def averages(x):
    one = film(1e-8 * x)
    curve = emittance_curve(one, points_per_e_fold=COARSE)
    return jnp.stack([absorptance(one, incidence=0.4).value, 10.0 * curve(300.0)])


def test_averages_in_thickness():
    with lf.float64():
        x = jnp.array([2.0, 30.0])
        check_grads(jax.jit(averages), (x,), 1, modes=["rev"], rtol=1e-5, eps=1e-4)


def face(x):
    return emittance(film(x), 300.0, side="bottom", points_per_e_fold=COARSE).value


def test_averages_traced_equal_concrete():
    with lf.float64():
        traced = jax.jit(face)(jnp.array([2e-8, 3e-7]))
    concrete = face(np.array([2e-8, 3e-7]))
    np.testing.assert_allclose(traced, concrete, rtol=1e-12)


def test_the_flyers_temperature_in_thickness():
    """Through layers, emittance curve and heat balance at once."""

    def temperature(x):
        one = film(1e-8 * x)
        curve = emittance_curve(one, points_per_e_fold=COARSE)
        properties = lf.FilmProperties(one.areal_density, 0.5, curve, curve, 0.8, 0.9)
        state = lf.lu2023_earth().state(75e3)
        flyer = lf.Disk(properties, 0.01)
        return lf.equilibrium(flyer, state, lf.Lu2023(), throw=False).temperature / 300.0

    with lf.float64():
        x = jnp.array([2.0, 30.0])
        check_grads(temperature, (x,), order=1, modes=["rev"], rtol=1e-4, eps=1e-3)
