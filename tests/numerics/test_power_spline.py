"""Splines as sums of powers, against SciPy's piecewise polynomials."""

import numpy as np
from scipy.interpolate import make_interp_spline

from lightflyer.array.transformations import compiled
from lightflyer.numerics.interpolation import Sums, spline


def test_a_spline_is_scipys(rng):
    knots, degree = np.array([0.0, 0.7, 1.5, 2.0]), 3
    start, jumps = rng.normal(size=3), rng.normal(size=3)
    sums = Sums(tuple(knots), tuple(start), tuple(jumps), degree)
    x = rng.uniform(0.0, 2.6, 400)
    bases = np.maximum(x[:, None] - knots[1:], 0.0) ** degree
    expected = np.polynomial.polynomial.polyval(x, start) + bases @ jumps
    np.testing.assert_allclose(spline(sums, x), expected, atol=1e-13)
    np.testing.assert_allclose(compiled(lambda x: spline(sums, x))(x), expected, atol=1e-13)
    # twice differentiable everywhere: SciPy's spline through its values, with these knots, is it
    ends = np.r_[[0.0] * 4, knots[1:], [2.6] * 4]
    through = np.linspace(0.0, 2.6, len(ends) - degree - 1)
    again = make_interp_spline(through, spline(sums, through), k=degree, t=ends)
    np.testing.assert_allclose(again(x), expected, atol=1e-11)
