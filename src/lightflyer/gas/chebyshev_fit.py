"""Published correlations, followed by polynomials that a heat balance evaluates quickly."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, xp
from lightflyer.core.quantity import Temperature
from lightflyer.numerics.horner import polynomial


class ChebyshevFit(NamedTuple):
    """Polynomial in T/(T + middle) that follows a formula."""

    # The formulas have up to seven exponentials and powers; a heat balance, which evaluates them in
    # every step, would take a quarter longer.

    coefficients: tuple[float, ...]  # Lowest power first
    coldest: float  # Range of the formula [K]
    hottest: float  # Range of the formula [K]
    middle: float  # [K]
    slope: tuple[float, ...]  # Coefficients of the polynomial's derivative

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
        slope = np.polynomial.polynomial.polyder(coefficients)
        return cls(tuple(coefficients.tolist()), *ends, middle, tuple(slope.tolist()))

    @kept
    def __call__(self, temperature: Temperature) -> Array:
        """Value at temperatures [K]; beyond the range of the formula its value at the end."""
        within = xp.clip(temperature, self.coldest, self.hottest)
        return polynomial(self.coefficients, within / (within + self.middle))

    def exponent(self, temperature: Temperature) -> Array:
        """Local exponent, d ln(value)/d ln(temperature) [1]; zero beyond the range."""
        share = temperature / (temperature + self.middle)
        growth = polynomial(self.slope, share) / polynomial(self.coefficients, share)
        inside = (temperature >= self.coldest) & (temperature <= self.hottest)
        return xp.where(inside, share * (1.0 - share) * growth, 0.0)
