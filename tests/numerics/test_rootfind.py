import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array.namespace import by_jax, by_numpy
from lightflyer.numerics.rootfind import (
    RootOutcome,
    SolverStatus,
    describe_status,
    find_power_root,
    find_root,
    implicit_root,
)


def solve(residual, lower, upper, guess):
    """By NumPy and by JAX, which give the same."""
    ends = [np.asarray(end, float) for end in (lower, upper, guess)]
    with by_numpy(), lf.float64():
        root, outcome = find_root(lambda x: np.asarray(residual(x)), *ends)
    with by_jax():
        traced, ending = jax.jit(lambda *ends: find_root(residual, *ends))(*ends)
    np.testing.assert_array_equal(outcome.status, ending.status)
    np.testing.assert_allclose(root, traced, rtol=1e-6, atol=1e-12)
    return np.asarray(root), outcome


@pytest.mark.parametrize(
    ("residual", "root"),
    [
        (lambda x: x**3 - 2.0, 2.0 ** (1 / 3)),
        (lambda x: jnp.arctan(x - 0.7), 0.7),  # Newton alone diverges from the ends
        (lambda x: jnp.sign(x - 0.3) * jnp.sqrt(jnp.abs(x - 0.3)), 0.3),  # infinite slope
        (lambda x: jnp.expm1(5.0 * (x - 1.5)), 1.5),
        (lambda x: (x - 1.0) ** 9, 1.0),  # flat: Newton alone crawls
    ],
)
@pytest.mark.parametrize("guess", [-20.0, 0.0, 20.0])
def test_finds_the_root_of_awkward_functions(residual, root, guess):
    found, outcome = solve(residual, -20.0, 20.0, guess)
    assert bool(outcome.converged)
    assert abs(float(residual(jnp.asarray(found)))) < 1e-6
    # a residual of 1e-12 leaves a ninth-order root uncertain by 0.05
    assert float(found) == pytest.approx(root, rel=1e-9 if root != 1.0 else 0.06)


def test_elements_are_independent():
    targets = np.array([1e-6, 1.0, 1e6])
    found, outcome = solve(lambda x: jnp.exp(x) / targets - 1.0, -30.0, 30.0, np.zeros(3))
    assert np.all(outcome.converged)
    np.testing.assert_allclose(found, np.log(targets), rtol=1e-12)


def test_what_cannot_converge_is_flagged_and_ends():
    found, outcome = solve(lambda x: x * jnp.nan, -1.0, 1.0, 0.0)
    assert not bool(outcome.converged)
    assert int(outcome.steps) < 5  # the same point again would give the same
    assert np.all(np.abs(found) <= 1.0)


def test_says_why_each_search_ended():
    root = np.array([0.7, np.nan, -1.0, 0.0, 0.7])
    guess = np.array([0.9, 0.9, 0.9, 0.5, np.nan])
    found, outcome = solve(lambda x: x - root, 0.0, 1.0, guess)
    # a bracket that begins at zero can be halved for ever
    why = [
        SolverStatus.CONVERGED,
        SolverStatus.NOT_FINITE,
        SolverStatus.STEP_LIMIT,
        SolverStatus.CONVERGED,
        SolverStatus.CONVERGED,
    ]
    np.testing.assert_array_equal(outcome.status, why)
    np.testing.assert_array_equal(outcome.converged, [True, False, False, True, True])
    np.testing.assert_allclose(found[[0, 3, 4]], root[[0, 3, 4]], atol=1e-12)


def test_a_bracket_with_nothing_left_in_it_counts_as_converged():
    found, outcome = solve(lambda x: x + 1.0, 1.0, 2.0, 1.5)
    assert SolverStatus(int(outcome.status)) is SolverStatus.CONVERGED
    assert float(found) == pytest.approx(1.0, rel=1e-15)


@pytest.mark.parametrize("bad", ["target", "lower", "upper"])
def test_nan_inputs_end_as_not_finite(bad):
    inputs = {"target": np.full(2, 8.0), "lower": np.full(2, 1e-3), "upper": np.full(2, 1e3)}
    inputs[bad][1] = np.nan
    with by_numpy():
        found, outcome = find_power_root(lambda x: x**3, **inputs, guess=1.0)
    np.testing.assert_array_equal(outcome.status, [SolverStatus.CONVERGED, SolverStatus.NOT_FINITE])
    assert float(found[0]) == pytest.approx(2.0, rel=1e-12)


def test_saturating_laws_take_few_steps_however_near_the_asymptote():
    targets = np.array([1e-3, 0.5, 0.999, 1.0 - 1e-6])
    with by_numpy():
        found, outcome = find_power_root(
            lambda x: x / (1.0 + x), targets, 1e-9 * np.ones(4), 1e9 * np.ones(4), guess=1.0
        )
    np.testing.assert_allclose(found, targets / (1.0 - targets), rtol=1e-9)
    assert int(outcome.steps) <= 6


def cube_root(value):
    def search():
        return find_power_root(lambda x: x**3, value, 0.1 * value, value + 1.0, value)

    return implicit_root(lambda x: x**3 - value, search)


def test_the_ending_passes_through_every_transformation():
    values = np.array([8.0, np.nan, 27.0])
    expected = [SolverStatus.CONVERGED, SolverStatus.NOT_FINITE, SolverStatus.CONVERGED]
    with by_numpy():
        plain = cube_root(values)[1]
    with by_jax():
        compiled = jax.jit(cube_root)(values)[1]
        mapped = jax.vmap(cube_root)(values)[1]
        slopes, outcome = jax.grad(
            lambda v: (jnp.nansum(cube_root(v)[0]), cube_root(v)[1]), has_aux=True
        )(values)
    for found in (plain, compiled, mapped, outcome):
        assert isinstance(found, RootOutcome)
        assert jnp.issubdtype(found.status.dtype, jnp.integer)
        np.testing.assert_array_equal(found.status, expected)
    np.testing.assert_allclose(np.asarray(slopes)[[0, 2]], [1.0 / 12.0, 1.0 / 27.0], rtol=1e-12)


def test_endings_in_words():
    assert describe_status(np.array(SolverStatus.NOT_FINITE)) == "met a number that is not finite"
    several = [
        SolverStatus.STALLED,
        SolverStatus.SINGULAR,
        SolverStatus.STALLED,
        SolverStatus.STEP_LIMIT,
    ]
    assert describe_status(np.array(several)) == (
        "2 stalled where no step reduces the residual, 1 met a singular Jacobian, "
        "1 reached the limit of steps"
    )
    assert len({status.describe() for status in SolverStatus}) == len(SolverStatus)


def test_derivatives_to_second_order_do_not_unroll_the_loop():
    def square_root(value):
        def search():
            return find_root(lambda x: x * x / value - 1.0, jnp.zeros(()), value + 1.0, 0.5 * value)

        return implicit_root(lambda x: x * x - value, search)[0]

    with by_jax():
        first = jax.grad(square_root)(4.0)
        second = jax.grad(jax.grad(square_root))(4.0)
        forward = jax.jvp(square_root, (4.0,), (1.0,))[1]
    assert float(first) == pytest.approx(0.25, rel=1e-12)
    assert float(forward) == pytest.approx(0.25, rel=1e-12)
    assert float(second) == pytest.approx(-1.0 / 32.0, rel=1e-12)
