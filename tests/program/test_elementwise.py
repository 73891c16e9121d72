"""Polynomials and splines as operations: beside NumPy's and SciPy's, run in every way."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import scipy.interpolate
from numpy.polynomial.polynomial import polyder, polyval3d

import lightflyer as lf
from lightflyer.numerics.curves import Curves
from lightflyer.numerics.polynomials import hold_within
from lightflyer.program.horner import as_tuples, polynomial, trim_zeros
from lightflyer.program.numpy_backend import run
from lightflyer.program.program import Program
from lightflyer.program.scalar.python import compile_numbers
from lightflyer.program.tracing import trace

KNOTS = np.array([-3.0, -2.0, -0.5, 0.0, 0.25, 1.5, 4.0])
SEVERAL = "n0"


@pytest.fixture
def factors(rng):
    """Coefficients in three variables, some powers of which are missing."""
    table = rng.normal(size=(3, 4, 5))
    table[1:, 3] = table[2, :, 3:] = 0.0
    return table


@pytest.fixture
def curves(rng):
    """Two curves, and the same by SciPy."""
    values = rng.normal(size=(KNOTS.size, 2))
    return Curves.through(KNOTS, values), scipy.interpolate.CubicSpline(
        KNOTS, values, bc_type="clamped"
    )


def program_of(function, *shapes):
    with lf.float64():
        return trace(lambda given: function(*given), shapes, [np.dtype(float)] * len(shapes))[0]


def by_xla(function, *given):
    with lf.float64():
        return np.asarray(jax.jit(function)(*given))


def by_numbers(program, *given):
    """The program written in Python, called element by element."""
    call = compile_numbers(program, {}, {})
    rows = np.broadcast_arrays(*given)
    return np.array([call(list(numbers)) for numbers in zip(*rows, strict=True)]).T


def test_a_polynomial_is_one_operation_and_what_numpy_says(rng, factors):
    given = rng.normal(size=7), rng.normal(), rng.normal(size=7)
    expected = polyval3d(*np.broadcast_arrays(*given), factors)
    function = partial(polynomial, trim_zeros(as_tuples(factors)))
    program = program_of(function, (SEVERAL,), (), (SEVERAL,))
    assert [operation.name for operation in program.body.operations] == ["horner"]
    kept = Program.from_bytes(program.to_bytes())
    for found in (
        function(*given),
        by_xla(function, *given),
        run(program, given)[0],
        run(kept, [*map(np.asarray, given)])[0],
        by_numbers(program_of(function, (), (), ()), *given)[0],
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("count", [1, 600, 20_000])
def test_a_polynomial_of_any_length_is_the_same_to_the_last_digit(rng, factors, count):
    given = rng.normal(size=(3, count))
    whole = polynomial(as_tuples(factors), *given)
    assert np.array_equal(whole[-1:], polynomial(as_tuples(factors), *given[:, -1:]))


@pytest.mark.parametrize("place", range(3))
def test_slopes_of_a_polynomial_are_those_of_numpy(rng, factors, place):
    given = [rng.normal(size=7), np.asarray(rng.normal()), rng.normal(size=7)]
    function = partial(polynomial, as_tuples(factors))

    def slope(*given):
        def along(one):
            return function(*given[:place], one, *given[place + 1 :])

        return jax.jvp(along, (given[place],), (jnp.ones_like(given[place]),))[1]

    expected = polyval3d(*np.broadcast_arrays(*given), polyder(factors, axis=place))
    program = program_of(slope, (SEVERAL,), (), (SEVERAL,))
    assert program.names <= {"horner", "mul", "broadcast_in_dim"}
    np.testing.assert_allclose(run(program, given)[0], expected, rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(by_xla(slope, *given), expected, rtol=1e-13, atol=1e-14)
    total = by_xla(jax.grad(lambda *given: function(*given).sum(), place), *given)
    np.testing.assert_allclose(total.sum(), expected.sum(), rtol=1e-13)


def test_a_polynomial_is_mapped_over_some_of_its_variables(rng, factors):
    x, y, z = rng.normal(size=(3, 4))
    function = partial(polynomial, as_tuples(factors))
    rows = jax.vmap(jax.vmap(function, (0, None, None)), (None, None, 1))
    found = by_xla(rows, x, y[0], np.stack([z, 2.0 * z]))
    at = np.stack([z, 2.0 * z]).T[:, None, :]
    grid = np.broadcast_arrays(x[None, :, None], y[0], at)
    np.testing.assert_allclose(found, polyval3d(*grid, factors), rtol=1e-13)


def test_what_a_loop_does_not_change_of_a_polynomial_is_outside_of_it(rng, factors):
    def search(y, z):
        def step(_, x):
            return 0.1 * polynomial(as_tuples(factors), x, y, z)

        return jax.lax.fori_loop(0, 20, step, jnp.zeros_like(y))

    program = program_of(search, (SEVERAL,), (SEVERAL,))
    inside = [part.operations for one in program.body.operations for part in one.blocks]
    assert {"horner"} & {one.name for part in inside for one in part} == set()
    y, z = rng.uniform(0.0, 0.3, size=(2, 5))
    np.testing.assert_allclose(run(program, [y, z])[0], by_xla(search, y, z), rtol=1e-13)


def test_single_precision_stays_single(rng, factors):
    given = rng.normal(size=(3, 7)).astype(np.float32)
    found = jax.jit(partial(polynomial, as_tuples(factors)))(*given)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, polyval3d(*given, factors), rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("order", range(4))
def test_curves_and_their_slopes_are_scipys(curves, order):
    ours, scipys = curves
    function = ours
    for _ in range(order):
        function = partial(lambda of, x: jax.jvp(of, (x,), (jnp.ones_like(x),))[1], function)
    x = np.concatenate([np.linspace(-3.0, 4.0, 57)[1:-1], KNOTS[1:-1]])
    x = x if order < 3 else np.setdiff1d(x, KNOTS)  # where the third derivative jumps
    expected = scipys(x, order).T
    for found in (
        by_xla(function, x),
        np.stack(run(program_of(function, (SEVERAL,)), [x])),
        by_numbers(program_of(function, ()), x),
    ):
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


def test_curves_are_held_beyond_their_ends(curves):
    ours, scipys = curves
    x = np.array([-np.inf, -5.0, 4.5, np.inf])
    expected = scipys(np.clip(x, KNOTS[0], KNOTS[-1])).T
    np.testing.assert_allclose(np.stack(run(program_of(ours, (SEVERAL,)), [x])), expected)
    np.testing.assert_allclose(by_xla(ours, x), expected, rtol=1e-12)


def test_what_is_held_within_ends_is_itself_between_them_and_smooth_beyond():
    x = np.linspace(-2.0, 3.0, 5001)
    held = by_xla(lambda x: hold_within(x, -1.0, 2.0), x)
    between = (x >= -1.0) & (x <= 2.0)
    np.testing.assert_allclose(held[between], x[between], rtol=1e-15)
    assert held.min() == pytest.approx(-1.02, abs=1e-15)
    assert held.max() == pytest.approx(2.02, abs=1e-15)
    slope = by_xla(jax.vmap(jax.grad(lambda x: hold_within(x, -1.0, 2.0))), x)
    np.testing.assert_allclose(slope, np.gradient(held, x), atol=0.03)
    assert np.all((slope >= 0.0) & (slope <= 1.0))
    assert np.abs(np.diff(slope)).max() < 0.04  # no kink: over a thousandth of the range
