"""Dawson's function and the error function, beside SciPy's."""

import jax
import numpy as np
import scipy.special

import lightflyer as lf
from lightflyer.numerics.special import dawson, erf


def test_both_are_those_of_scipy_and_so_is_the_slope():
    x = np.linspace(-6.0, 6.0, 241)
    with lf.float64():
        found, slope = (np.asarray(part) for part in jax.jvp(erf, (x,), (np.ones_like(x),)))
        sums = np.asarray(dawson(x))
    np.testing.assert_allclose(found, scipy.special.erf(x), atol=1e-15)
    np.testing.assert_allclose(slope, 2.0 / np.sqrt(np.pi) * np.exp(-(x**2)), atol=1e-15)
    np.testing.assert_allclose(sums, scipy.special.dawsn(x), atol=1e-14)
