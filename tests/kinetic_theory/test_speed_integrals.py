"""Speed integrals against quadrature by SciPy and the recurrences of Abramowitz and Stegun."""

import numpy as np
import pytest
from scipy.integrate import quad

from lightflyer.kinetic_theory.grid import rays
from lightflyer.kinetic_theory.grid.rays import speed_integral, spline_table


@pytest.mark.parametrize("power", [1, 4, 8])
@pytest.mark.parametrize("depth", [0.0, 1e-3, 0.7, 6.0, 59.0])
def test_integral_is_what_scipy_finds(power, depth):
    expected = quad(
        lambda c: c**power * np.exp(-c * c - depth / c), 0.0, 12.0, epsabs=0.0, limit=400
    )[0]
    assert speed_integral(power, np.array(depth)) == pytest.approx(expected, rel=1e-10)


def test_recurrence_of_abramowitz_and_stegun():
    z = np.linspace(0.0, 30.0, 50)
    for p in (4, 6, 8):
        right = (p - 1) * speed_integral(p - 2, z) + z * speed_integral(p - 3, z)
        np.testing.assert_allclose(2.0 * speed_integral(p, z), right, rtol=1e-9)


def test_spline_table_is_as_exact_between_its_nodes():
    table, per_unit = spline_table()
    root = np.random.default_rng(3).uniform(0.0, np.sqrt(rays.LARGEST_DEPTH), 500)
    root[:20] *= 1e-3  # the first cell, where a logarithm is worst
    cell = (root * per_unit).astype(int)
    t = (root - cell / per_unit)[:, None]
    rows = table[cell]
    values = ((rows[:, 0] * t + rows[:, 1]) * t + rows[:, 2]) * t + rows[:, 3]
    for column in range(rays.NUMBER):
        exact = speed_integral(column + rays.LOWEST_POWER, root**2)
        np.testing.assert_allclose(values[:, column], exact, atol=4e-10)
