"""Work done ahead of a function's calls."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.foundation.ahead import ahead

POINT = jax.ShapeDtypeStruct((3,), float)


@pytest.fixture(autouse=True)
def double_precision():
    with lf.float64():
        yield


@jax.jit
def clipped(x, limit):
    return jnp.where(x > limit, jnp.exp(limit), jnp.exp(x))


def curve(x, y, parameter):
    known = clipped(parameter, 1.0) * jnp.linspace(1.0, 2.0, 3)
    return known * jnp.sin(x) + clipped(y, parameter), {"known": known, "x": x}


def test_results_are_those_of_the_function():
    x, y = jnp.array([0.1, 0.2, 0.3]), 0.7
    split = ahead(lambda *point: curve(*point, 0.4), POINT, POINT)
    for found, expected in zip(
        jax.tree.leaves(split(x, y)), jax.tree.leaves(curve(x, y, 0.4)), strict=True
    ):
        np.testing.assert_allclose(found, np.broadcast_to(expected, (3,)), rtol=1e-15)


def test_what_is_known_is_not_computed_again():
    split = ahead(lambda x: jnp.sum(jnp.exp(jnp.ones(50))) * x, POINT)
    left = {equation.primitive.name for equation in jax.make_jaxpr(split)(jnp.ones(3)).eqns}
    assert "mul" in left
    assert not {"exp", "reduce_sum"} & left


@pytest.mark.parametrize("derivative", [jax.jacfwd, jax.jacrev])
def test_derivatives_reach_what_is_closed_over(derivative):
    x, y = jnp.array([0.1, 0.2, 0.3]), jnp.array([0.3, 0.5, 0.7])

    def through(parameter, x):
        return ahead(lambda *point: curve(*point, parameter), POINT, POINT)(x, y)[0]

    found = derivative(through, argnums=(0, 1))(0.4, x)
    expected = derivative(lambda p, x: curve(x, y, p)[0], argnums=(0, 1))(0.4, x)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-14)


def test_works_inside_jit_and_vmap():
    x = jnp.array([0.1, 0.2, 0.3])
    split = jax.jit(jax.vmap(lambda p: ahead(lambda x: curve(x, 0.7, p)[0], POINT)(x)))
    parameters = jnp.array([0.2, 0.9])
    expected = np.stack([curve(x, 0.7, p)[0] for p in parameters])
    np.testing.assert_allclose(split(parameters), expected, rtol=1e-15)
