r"""Emittance of a face as a smooth function of its temperature, for the heat balance.

The infrared transmittance of a film is such a function too, of the temperature of a black body
whose radiation passes.
"""

from functools import cache

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.entry_point import entry_point

LOWEST_TEMPERATURE, HIGHEST_TEMPERATURE = 100.0, 1500.0
"""Temperatures between which curves are made [K]."""

NODES = 20
"""Temperatures at which a curve equals the computed emittance. With 20, the curves of all materials
of the library stay within 1e-5 of it between the nodes."""

_BETWEEN_NODES = 0.1  # margin for what a curve does between its nodes


class EmittanceCurve(Module):
    r"""Total emittance of a face, a polynomial of the logarithm of temperature.

    A single polynomial has derivatives of every order, needs few operations, and its difference
    between two temperatures can be formed without cancellation.

    Attributes
    ----------
    coefficients : array, shape (..., NODES)
        In powers of :math:`x`, highest first; :math:`x` goes from -1 to 1 with the logarithm
        of temperature [1].
    lowest, highest : array
        Temperatures of the ends [K]. Beyond them the emittance is held.

    Examples
    --------
    >>> grey = EmittanceCurve.through(np.full(NODES, 0.08))
    >>> print(f"{grey(300.0):.3f}")
    0.080
    """

    coefficients: Numeric
    lowest: Numeric = LOWEST_TEMPERATURE
    highest: Numeric = HIGHEST_TEMPERATURE

    @classmethod
    def through(cls, emittance: Numeric) -> "EmittanceCurve":
        """Curve through the emittances at :func:`node_temperatures`; ``emittance`` (..., NODES)."""
        return cls(coefficients=emittance @ _to_coefficients().T)

    @property
    def at_nodes(self) -> Numeric:
        """The curve at :func:`node_temperatures`, shape (..., NODES) [1]."""
        return self.coefficients @ np.vander(_nodes(), NODES).T

    @entry_point
    def __call__(self, temperature: Numeric) -> Array:
        """Emittance at a temperature [K], any shape."""
        x = self._scale_temperature(temperature)
        coefficients = xp.asarray(self.coefficients)
        value = coefficients[..., 0]
        for place in range(1, NODES):
            value = value * x + coefficients[..., place]
        return value

    @entry_point
    def growth(self, temperature: Numeric, excess: Numeric) -> Array:
        r"""Change of :math:`\varepsilon T^4` over a temperature difference [1]."""
        # .. math:: \varepsilon(T_h)\,(1+\theta)^4-\varepsilon(T),\qquad T_h=T(1+\theta)
        hot, coefficients = temperature * (1.0 + excess), xp.asarray(self.coefficients)
        x, y = self._scale_temperature(hot), self._scale_temperature(temperature)
        # the polynomial at x, and its divided difference between x and y, by Horner's rule
        value, slope = coefficients[..., 0], xp.zeros(())
        for place in range(1, NODES):
            value, slope = value * x + coefficients[..., place], slope * y + value
        inside = (xp.minimum(hot, temperature) >= self.lowest) & (
            xp.maximum(hot, temperature) <= self.highest
        )
        near = 2.0 * xp.log1p(excess) / xp.log(self.highest / self.lowest)
        return value * black_growth(excess) + slope * xp.where(inside, near, x - y)

    def _scale_temperature(self, temperature: Numeric) -> Array:
        span = xp.log(self.highest / self.lowest)
        held = xp.clip(temperature, self.lowest, self.highest)
        return 2.0 * xp.log(held / self.lowest) / span - 1.0


@cache
def _nodes() -> np.ndarray:
    return np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)


@cache
def _to_coefficients() -> np.ndarray:
    """Matrix from values at the nodes to coefficients in powers, highest first."""
    chebyshev = np.polynomial.chebyshev
    to_chebyshev = np.linalg.inv(chebyshev.chebvander(_nodes(), NODES - 1))
    powers = np.zeros((NODES, NODES))
    for degree in range(NODES):
        terms = chebyshev.cheb2poly(np.eye(NODES)[degree])
        powers[: terms.size, degree] = terms
    return (powers @ to_chebyshev)[::-1]


def node_temperatures() -> np.ndarray:
    """Temperatures at which a curve is given [K], shape (NODES,)."""
    middle = np.sqrt(LOWEST_TEMPERATURE * HIGHEST_TEMPERATURE)
    return middle * (HIGHEST_TEMPERATURE / LOWEST_TEMPERATURE) ** (0.5 * _nodes())


def black_growth(excess: Numeric) -> Numeric:
    r"""Growth of a black face's emission, :math:`(1+\theta)^4-1`, without its cancellation."""
    return excess * (4.0 + excess * (6.0 + excess * (4.0 + excess)))


def emittance_at(emittance: Numeric, temperature: Numeric) -> Numeric:
    """Emittance of a face at its temperature, whether constant or a curve [1]."""
    return emittance(temperature) if isinstance(emittance, EmittanceCurve) else emittance


def emission_growth(emittance: Numeric, temperature: Numeric, excess: Numeric) -> Numeric:
    """Growth of a face's emission with its temperature, over that of a black face [1]."""
    if isinstance(emittance, EmittanceCurve):
        return emittance.growth(temperature, excess)
    return emittance * black_growth(excess)


def coefficients_of(emittance: Numeric) -> Numeric:
    """Coefficients of a curve, or of the curve that a constant is, shape (..., NODES) [1]."""
    if isinstance(emittance, EmittanceCurve):
        return emittance.coefficients
    return xp.expand_dims(emittance, -1) * np.eye(NODES)[-1]


def emittance_bounds(emittance: Numeric) -> tuple[Numeric, Numeric]:
    """Bounds of the emittance of a face over all temperatures, whether constant or a curve [1]."""
    if not isinstance(emittance, EmittanceCurve):
        return emittance, emittance
    lowest, highest = (end(emittance.at_nodes, axis=-1) for end in (xp.min, xp.max))
    return (1.0 - _BETWEEN_NODES) * lowest, (1.0 + _BETWEEN_NODES) * highest
