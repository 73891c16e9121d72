r"""Reflection, transmission and absorption of a stack of layers: coherent transfer matrix.

The stack stands free: vacuum above and below. A plane wave comes from above. With the relative
normal wave number :math:`q_j=\sqrt{(n_j+ik_j)^2-\sin^2\theta}` and the admittance
:math:`y_j=q_j` (s polarisation) or :math:`y_j=(n_j+ik_j)^2/q_j` (p), the ratio of upward to
downward tangential electric field is carried from the bottom up,

.. math::
    \Gamma_j=\frac{r_j+\Gamma_{j+1}e^{2i\varphi_{j+1}}}{1+r_j\Gamma_{j+1}e^{2i\varphi_{j+1}}},
    \qquad r_j=\frac{y_j-y_{j+1}}{y_j+y_{j+1}},\qquad
    \varphi_j=\frac{2\pi q_jd_j}{\lambda},

and then the downward field from the top down. It is algebraically the product of transfer
matrices, but only ever multiplies by decaying exponentials: nothing overflows however thick or
opaque a layer is.
"""

from collections.abc import Sequence

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric


class StackOptics(eqx.Module):
    """Shares of the light on a stack that are reflected, transmitted and absorbed.

    The first axis of each field is the polarisation: s, then p.

    Attributes
    ----------
    reflectance, transmittance : array, shape (2, ...)
        [1].
    layer_absorptance : array, shape (layers, 2, ...)
        Absorptance of each layer, the lit side first [1].
    """

    reflectance: Numeric
    transmittance: Numeric
    layer_absorptance: Numeric

    @property
    def absorptance(self) -> Numeric:
        """Absorptance of the stack, shape (2, ...) [1]."""
        return self.layer_absorptance.sum(axis=0)

    def merged(self, sizes: Sequence[int]) -> "StackOptics":
        """The absorptances of neighbouring layers added up.

        Parameters
        ----------
        sizes : sequence of int
            How many layers each group has, the lit side first.
        """
        groups = np.repeat(np.eye(len(sizes)), sizes, axis=1)
        absorptance = _summed(groups, self.layer_absorptance)
        return StackOptics(self.reflectance, self.transmittance, absorptance)

    def unpolarised(self) -> "StackOptics":
        """The mean of both polarisations, without their axis."""
        return StackOptics(
            reflectance=self.reflectance.mean(axis=0),
            transmittance=self.transmittance.mean(axis=0),
            layer_absorptance=self.layer_absorptance.mean(axis=1),
        )


@entry_point
def _summed(groups: Numeric, parts: Numeric) -> Numeric:
    return jnp.tensordot(groups, parts, axes=1)


@entry_point
def stack_optics(
    n: Numeric, k: Numeric, thickness: Numeric, wavelength: Numeric, incidence: Numeric = 0.0
) -> StackOptics:
    """Reflectance, transmittance and absorptance of each layer, for light from above.

    Parameters
    ----------
    n, k : array, shape (layers, ...)
        Real and imaginary part of each layer's refractive index, top layer first [1].
    thickness : array, shape (layers, ...)
        [m].
    wavelength : array, shape (...)
        In vacuum [m].
    incidence : array, shape (...)
        Angle between the light and the stack's normal [rad], below pi/2.

    Returns
    -------
    StackOptics
        The axes behind ``layers`` are broadcast together.

    Notes
    -----
    Differentiable in every argument, except where a layer's index equals the sine of the
    incidence (grazing inside the layer). Values are not checked here; :class:`Film` checks them.

    References
    ----------
    [Byrnes2016]_ for the definitions of absorption; the recursion is Rouard's, [Heavens1955]_.

    Examples
    --------
    >>> optics = stack_optics([1.5], [0.0], [1e-7], 5e-7)
    >>> print(f"{optics.reflectance[0]:.6f} {optics.transmittance[0]:.6f}")
    0.135720 0.864280
    """
    return transfer(n, k, thickness, wavelength, incidence)


def transfer(
    n: Numeric, k: Numeric, thickness: Numeric, wavelength: Numeric, incidence: Numeric
) -> StackOptics:
    """:func:`stack_optics` for use inside other compiled functions.

    Complex numbers are pairs of real ones here: XLA compiles those into far faster loops.
    """
    n, k, thickness = (jnp.asarray(value) for value in (n, k, thickness))
    cosine, sine = jnp.cos(incidence), jnp.sin(incidence)
    outside = jnp.stack(jnp.broadcast_arrays(cosine, 1.0 / cosine, jnp.ones_like(wavelength))[:2])
    permittivity = (n * n - k * k, 2.0 * n * k)
    normal = _root(permittivity[0] - sine * sine, permittivity[1])
    phase = (4.0 * jnp.pi) * thickness / wavelength
    decay = jnp.exp(-phase * normal[1])  # of the power, down through a layer
    turn = phase * normal[0]
    round_trip = jnp.stack([decay * jnp.cos(turn), decay * jnp.sin(turn)], axis=1)
    magnetic = _quotient(permittivity, normal)
    real = jnp.stack(jnp.broadcast_arrays(normal[0], magnetic[0]), axis=1)
    imaginary = jnp.stack(jnp.broadcast_arrays(normal[1], magnetic[1]), axis=1)
    return _recursion((real, imaginary), round_trip, decay, outside)


def _root(real: Array, imaginary: Array) -> tuple[Array, Array]:
    """Square root in the first quadrant of a number in the upper half-plane."""
    modulus = jnp.sqrt(real * real + imaginary * imaginary)
    larger = jnp.sqrt(0.5 * (modulus + jnp.abs(real)))
    smaller = 0.5 * imaginary / larger  # by division, as a difference would cancel
    propagates = real >= 0.0
    return jnp.where(propagates, larger, smaller), jnp.where(propagates, smaller, larger)


def _quotient(over: tuple[Array, Array], under: tuple[Array, Array]) -> tuple[Array, Array]:
    (a, b), (c, d) = over, under
    scale = 1.0 / (c * c + d * d)
    return (a * c + b * d) * scale, (b * c - a * d) * scale


def _interface(
    above: tuple[Array, Array], below: tuple[Array, Array], ratio: tuple[Array, Array]
) -> tuple[tuple[Array, Array], Array]:
    """Upward over downward field above an interface, and the downward power it lets through.

    ``ratio`` is upward over downward field below it; the arguments are complex numbers.
    """
    plus = (above[0] + below[0], above[1] + below[1])
    minus = (above[0] - below[0], above[1] - below[1])
    over = (
        minus[0] + plus[0] * ratio[0] - plus[1] * ratio[1],
        minus[1] + plus[0] * ratio[1] + plus[1] * ratio[0],
    )
    under = (
        plus[0] + minus[0] * ratio[0] - minus[1] * ratio[1],
        plus[1] + minus[0] * ratio[1] + minus[1] * ratio[0],
    )
    gain = 4.0 * (above[0] ** 2 + above[1] ** 2) / (under[0] ** 2 + under[1] ** 2)
    return _quotient(over, under), gain


def _recursion(
    admittance: tuple[Array, Array], round_trip: Array, decay: Array, outside: Array
) -> StackOptics:
    """Carry the field ratio up and the power down; axes (layers, polarisations, ...)."""
    real, imaginary = admittance
    layers = real.shape[0]
    nothing = jnp.zeros_like(outside)
    below, ratio = (outside, nothing), (nothing, nothing)
    gains: list[Array] = []
    ratios: list[tuple[Array, Array]] = []
    for j in range(layers - 1, -1, -1):
        above = (real[j], imaginary[j])
        reflected, gain = _interface(above, below, ratio)
        turn = round_trip[j]
        ratio = (
            reflected[0] * turn[0] - reflected[1] * turn[1],
            reflected[0] * turn[1] + reflected[1] * turn[0],
        )
        below = above
        gains.insert(0, gain)
        ratios.insert(0, ratio)
    reflected, power = _interface((outside, nothing), below, ratio)
    fluxes = []
    for j in range(layers):
        up = ratios[j]
        net = real[j] * (1.0 - up[0] ** 2 - up[1] ** 2) + 2.0 * imaginary[j] * up[1]
        fluxes.append(power * net / outside)
        power = power * decay[j] * gains[j]
    flux = jnp.stack([*fluxes, power])
    return StackOptics(
        reflectance=reflected[0] ** 2 + reflected[1] ** 2,
        transmittance=power,
        layer_absorptance=flux[:-1] - flux[1:],
    )
