"""Special functions of numbers, and parts of complex ones, with derivatives under JAX.

Real and imaginary parts of complex numbers, with all derivatives under JAX.

JAX's own cannot be transposed where the caller of ``jax.grad`` computes in single precision: it
would put a real part in double precision beside an imaginary part in single precision.
"""

import math
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, call, is_jax, load_jax, xp
from lightflyer.array.transformations import real_of_jax

_STEP, _ODD = 0.25, range(-27, 28, 2)


def dawson(x: Numeric) -> Numeric:
    """Dawson's function, by Rybicki's sum [Rybicki1989]_, whose error is below e^{-(π/2h)²}."""
    middle = 2.0 * xp.floor(x / (2.0 * _STEP) + 0.5)
    left = x - middle * _STEP
    parts = [xp.exp(-((left - odd * _STEP) ** 2)) / (middle + odd) for odd in _ODD]
    total: Numeric = sum(parts) / np.sqrt(np.pi)
    return total


def root_sum_square(*values: Any) -> Array:
    """What independent errors amount to together; one of them is not zero."""
    # JAX's own takes ten times as many operations, for numbers whose squares no computer holds
    return xp.sqrt(sum(value**2 for value in values))


def erf(x: Any) -> Array:
    """The error function."""
    if call.jax is not None:
        return call.jax.scipy.special.erf(x)
    if is_jax(x):
        return load_jax().scipy.special.erf(x)
    return _erf(x)  # SciPy's takes half a second to load


_erf = np.vectorize(math.erf, otypes=[float])


def xlogy(x: Any, y: Any) -> Array:
    """Product of x and ln y, zero where x is."""
    nothing = x == 0.0
    return xp.where(nothing, 0.0, x * xp.log(xp.where(nothing, 1.0, y)))


def i0e(x: Any) -> Array:
    """Modified Bessel function of order zero, over e to the size of x."""
    if call.jax is not None:
        return call.jax.scipy.special.i0e(x)
    if is_jax(x):
        return load_jax().scipy.special.i0e(x)
    from scipy import special

    return special.i0e(x)


_PLAIN = (np.ndarray, np.generic, float, complex)


def real(number: Any) -> Any:
    """Real part, of the shape of the number."""
    if isinstance(number, _PLAIN) or not xp.iscomplexobj(number):
        return number.real
    return real_of_jax(number)


def imaginary(number: Any) -> Any:
    """Imaginary part, of the shape of the number."""
    if isinstance(number, _PLAIN) or not xp.iscomplexobj(number):
        return number.imag
    return real(-1j * number)


def magnitude(number: Any) -> Any:
    """Squared magnitude, which has a derivative at zero, too."""
    a, b = real(number), imaginary(number)
    return a * a + b * b


def quotient(number: Any, other: Any) -> Any:
    """Quotient, in half of the time that division of complex numbers takes."""
    product, size = number * other.conj(), magnitude(other)
    return real(product) / size + 1j * (imaginary(product) / size)
