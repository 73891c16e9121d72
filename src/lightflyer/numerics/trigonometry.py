"""Sine and cosine of one angle at once, in arithmetic that compilers vectorise."""

import math
from fractions import Fraction

from lightflyer.pytree.lazy_jax import Array, custom_jvp, jnp

_PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459")
_TERMS = 8  # of each series: on ±π/4 what follows is below 1e-18


def _parts_of_quarter_turn() -> tuple[float, float, float]:
    """π/2 as a sum whose first two parts are short enough to be multiplied without rounding."""
    quarter = _PI / 2
    first = Fraction(math.floor(quarter * 2**30), 2**30)
    second = Fraction(math.floor((quarter - first) * 2**62), 2**62)
    return float(first), float(second), float(quarter - first - second)


_QUARTER = _parts_of_quarter_turn()


@custom_jvp
def sine_and_cosine(angle: Array) -> tuple[Array, Array]:
    """Sine and cosine of an angle; ``angle``: traced, float64."""
    # XLA calls the scalar functions of the C library for each element in float64, which take ten
    # times as long.
    #
    # The angle less the nearest multiple of π/2, then Taylor series.
    #
    # Source: [CodyWaite1980]_ for the reduction of the range.
    turns = jnp.round(angle * (2.0 / math.pi))
    rest = angle
    for part in _QUARTER:
        rest = rest - turns * part
    square = rest * rest
    sine, cosine = jnp.zeros_like(rest), jnp.zeros_like(rest)
    for term in range(_TERMS, 0, -1):
        sine = (sine + (-1.0) ** term / math.factorial(2 * term + 1)) * square
        cosine = (cosine + (-1.0) ** term / math.factorial(2 * term)) * square
    sine, cosine = rest + rest * sine, 1.0 + cosine
    quadrant = turns - 4.0 * jnp.floor(0.25 * turns)
    swapped = (quadrant == 1.0) | (quadrant == 3.0)
    first, second = jnp.where(swapped, cosine, sine), jnp.where(swapped, sine, cosine)
    down, left = quadrant >= 2.0, (quadrant == 1.0) | (quadrant == 2.0)
    return jnp.where(down, -first, first), jnp.where(left, -second, second)


@sine_and_cosine.defjvp
def _slopes(
    primals: tuple[Array], tangents: tuple[Array]
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    sine, cosine = sine_and_cosine(*primals)
    (change,) = tangents
    return (sine, cosine), (cosine * change, -sine * change)
