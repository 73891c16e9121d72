"""Parts of complex numbers and their derivatives, in either precision of the caller."""

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.core.entry_point import entry_point
from lightflyer.numerics.special import imaginary, magnitude, quotient, real


@pytest.fixture
def pairs(rng):
    return rng.normal(size=(2, 50, 2)).view(complex)[..., 0]


def test_plain_numbers_have_their_parts(pairs):
    first, second = pairs
    np.testing.assert_array_equal(real(first), first.real)
    np.testing.assert_array_equal(imaginary(first), first.imag)
    np.testing.assert_allclose(magnitude(first), abs(first) ** 2, rtol=1e-15)
    np.testing.assert_allclose(quotient(first, second), first / second, rtol=1e-14)
    assert (imaginary(2.0), real(3.0 - 2.0j)) == (0.0, 3.0)


@entry_point
def part(x, y):
    """Real part of (x + iy)², less its imaginary part over its squared magnitude."""
    square = (x + 1j * y) ** 2
    return real(square) - imaginary(quotient(square, square * square.conj()))


def slopes(x, y):
    """Of x² - y² - 2xy/(x² + y²)²."""
    size = x * x + y * y
    in_x = 2.0 * x - 2.0 * y / size**2 + 8.0 * x * x * y / size**3
    in_y = -2.0 * y - 2.0 * x / size**2 + 8.0 * x * y * y / size**3
    return np.array([in_x, in_y])


def test_derivatives_in_either_precision(pairs):
    x, y = pairs[0].real, pairs[0].imag
    grad = jax.jit(jax.vmap(jax.grad(part, argnums=(0, 1))))
    with lf.float64():
        np.testing.assert_allclose(grad(x, y), slopes(x, y), rtol=1e-11)
    np.testing.assert_allclose(grad(x, y), slopes(x, y), rtol=3e-5)


def test_squared_magnitude_has_a_slope_at_zero():
    with lf.float64():
        slope = jax.grad(entry_point(lambda x: magnitude(x + 0j)))(0.0)
    assert float(slope) == 0.0
