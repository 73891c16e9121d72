"""Polynomials in several variables, against NumPy's own."""

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval, polyval2d, polyval3d

from lightflyer.array.transformations import compiled
from lightflyer.numerics.polynomials import as_tuples, polynomial


@pytest.mark.parametrize(
    ("shape", "theirs"), [((5,), polyval), ((4, 3), polyval2d), ((3, 1, 4), polyval3d)]
)
@pytest.mark.parametrize("size", [1, 70_000])
def test_polynomials_are_numpys(shape, theirs, size, rng):
    table = rng.normal(size=shape)
    variables = rng.uniform(-1.0, 1.0, (len(shape), size))
    coefficients = as_tuples(table)
    expected = theirs(*variables, table)
    np.testing.assert_allclose(polynomial(coefficients, *variables), expected, atol=1e-13)
    by_jax = compiled(lambda *values: polynomial(coefficients, *values))(*variables)
    np.testing.assert_allclose(by_jax, expected, atol=1e-13)


def test_variables_broadcast(rng):
    table = rng.normal(size=(3, 4))
    x, y = rng.uniform(-1.0, 1.0, (6, 1)), rng.uniform(-1.0, 1.0, 5)
    found = polynomial(as_tuples(table), x, y)
    np.testing.assert_allclose(found, polyval2d(*np.broadcast_arrays(x, y), table), atol=1e-13)
