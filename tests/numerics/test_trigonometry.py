"""Sine and cosine against the C library's, and their derivatives."""

import jax
import numpy as np

import lightflyer as lf
from lightflyer.numerics.trigonometry import sine_and_cosine


def test_sine_and_cosine_are_those_of_the_c_library():
    rng = np.random.default_rng(3)
    quarters = np.arange(-50.0, 50.0) * np.pi / 4
    angles = np.concatenate(
        [quarters, np.nextafter(quarters, 9.0), rng.normal(0.0, 10.0, 1000),
         10.0 ** rng.uniform(-12.0, 6.0, 1000)]
    )  # fmt: skip
    with lf.float64():
        found = jax.jit(sine_and_cosine)(angles)
        slopes = jax.jit(lambda x: jax.jvp(sine_and_cosine, (x,), (2.0 + 0.0 * x,))[1])(angles)
    expected = np.sin(angles), np.cos(angles)
    for ours, theirs in zip(found, expected, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=2.5e-16)
        near_zero = (np.abs(theirs) < 1e-3) & (np.abs(theirs) > 1e-300)
        np.testing.assert_allclose(ours[near_zero], theirs[near_zero], rtol=1e-9)
    np.testing.assert_allclose(slopes[0], 2.0 * expected[1], atol=5e-16)
    np.testing.assert_allclose(slopes[1], -2.0 * expected[0], atol=5e-16)


def test_angles_of_many_turns_keep_their_rounding():
    angles = 10.0 ** np.random.default_rng(4).uniform(6.0, 10.0, 1000)
    with lf.float64():
        sine, _ = sine_and_cosine(angles)
    assert np.all(np.abs(np.asarray(sine) - np.sin(angles)) < 4e-16 * (1.0 + angles))
