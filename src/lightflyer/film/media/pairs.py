"""Complex numbers as pairs of real ones, (real, imaginary).

XLA compiles them into faster loops than its complex numbers, and gradients may be taken where JAX
computes in single precision, in which it mixes up its two complex types.
"""

from typing import TypeAlias

from lightflyer.core.types import Numeric
from lightflyer.pytree.lazy_jax import Array, jnp

Pair: TypeAlias = tuple[Array, Array]


def times(first: Pair, second: Pair) -> Pair:
    """Product of two complex numbers."""
    return (
        first[0] * second[0] - first[1] * second[1],
        first[0] * second[1] + first[1] * second[0],
    )


def over(dividend: Pair, divisor: Pair) -> Pair:
    """Quotient of two complex numbers."""
    scale = 1.0 / (divisor[0] ** 2 + divisor[1] ** 2)
    return (
        (dividend[0] * divisor[0] + dividend[1] * divisor[1]) * scale,
        (dividend[1] * divisor[0] - dividend[0] * divisor[1]) * scale,
    )


def plus(first: Pair, second: Pair) -> Pair:
    """Sum of two complex numbers."""
    return first[0] + second[0], first[1] + second[1]


def multiply_real(number: Pair, factor: Numeric) -> Pair:
    """Product of a complex number and a real one."""
    return number[0] * factor, number[1] * factor


def sum_first_axis(number: Pair) -> Pair:
    """Sum of complex numbers over the first axis."""
    return number[0].sum(axis=0), number[1].sum(axis=0)


def root(number: Pair) -> Pair:
    """Principal square root of a complex number other than zero."""
    real, imaginary = number
    modulus = jnp.sqrt(real * real + imaginary * imaginary)
    larger = jnp.sqrt(0.5 * (modulus + jnp.abs(real)))
    smaller = 0.5 * jnp.abs(imaginary) / larger  # by division, as a difference would cancel
    right = real >= 0.0
    sign = jnp.where(imaginary < 0.0, -1.0, 1.0)
    return jnp.where(right, larger, smaller), sign * jnp.where(right, smaller, larger)
