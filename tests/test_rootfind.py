import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.foundation.rootfind import MAXIMUM_STEPS, bracketed_newton, implicit_root


def solve(residual, lower, upper, guess):
    with lf.float64():
        root, status = bracketed_newton(
            residual, *(jnp.asarray(end, float) for end in (lower, upper, guess))
        )
    return np.asarray(root), status


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
    found, status = solve(residual, -20.0, 20.0, guess)
    assert bool(status.converged)
    assert abs(float(residual(jnp.asarray(found)))) < 1e-6
    # a residual of 1e-12 leaves a ninth-order root uncertain by 0.05
    assert float(found) == pytest.approx(root, rel=1e-9 if root != 1.0 else 0.06)


def test_elements_are_independent():
    targets = np.array([1e-6, 1.0, 1e6])
    found, status = solve(lambda x: jnp.exp(x) / targets - 1.0, -30.0, 30.0, np.zeros(3))
    assert np.all(status.converged)
    np.testing.assert_allclose(found, np.log(targets), rtol=1e-12)


def test_what_cannot_converge_is_flagged_and_ends():
    found, status = solve(lambda x: x * jnp.nan, -1.0, 1.0, 0.0)
    assert not bool(status.converged)
    assert int(status.steps) == MAXIMUM_STEPS
    assert np.all(np.abs(found) <= 1.0)


def test_derivatives_to_second_order_do_not_unroll_the_loop():
    def square_root(value):
        def search():
            return bracketed_newton(
                lambda x: x * x / value - 1.0, jnp.zeros(()), value + 1.0, 0.5 * value
            )

        return implicit_root(lambda x: x * x - value, search, ())[0]

    with lf.float64():
        first = jax.grad(square_root)(4.0)
        second = jax.grad(jax.grad(square_root))(4.0)
        forward = jax.jvp(square_root, (4.0,), (1.0,))[1]
    assert float(first) == pytest.approx(0.25, rel=1e-12)
    assert float(forward) == pytest.approx(0.25, rel=1e-12)
    assert float(second) == pytest.approx(-1.0 / 32.0, rel=1e-12)
