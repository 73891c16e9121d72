"""Published correlations, followed by polynomials that a heat balance evaluates quickly."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lightflyer.core.quantity import Temperature
from lightflyer.program.horner import polynomial
from lightflyer.pytree.lazy_jax import Array, jnp


class ChebyshevFit(NamedTuple):
    """Polynomial in T/(T + middle) that follows a formula."""

    # The formulas have up to seven exponentials and powers; a heat balance, which evaluates them in
    # every step, would take a quarter longer.

    coefficients: tuple[float, ...]  # Lowest power first
    coldest: float  # Range of the formula [K]
    hottest: float  # Range of the formula [K]
    middle: float  # [K]

    @classmethod
    def of(
        cls,
        formula: Callable[[np.ndarray], np.ndarray],
        ends: tuple[float, float],
        middle: float,
        degree: int,
    ) -> "ChebyshevFit":
        """The polynomial through a formula at Chebyshev's points; ``formula``: of temperatures."""
        domain = np.array(ends)
        fit = np.polynomial.Chebyshev.interpolate(
            lambda share: formula(middle * share / (1.0 - share)),
            degree,
            domain=domain / (domain + middle),
        )
        coefficients = fit.convert(kind=np.polynomial.Polynomial).coef
        return cls(tuple(coefficients.tolist()), *ends, middle)

    def __call__(self, temperature: Temperature) -> Array:
        """Value at temperatures [K]; beyond the range of the formula its value at the end."""
        within = jnp.clip(temperature, self.coldest, self.hottest)
        return polynomial(self.coefficients, within / (within + self.middle))
