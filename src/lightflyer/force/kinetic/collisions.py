r"""What collisions of real molecules do beside those of the kinetic model equation.

The tables of the kinetic model solve a model equation. The same problem with the collision operator
of VHS molecules, for small temperature differences, says by which factor collisions take more or
less from force and heat,

.. math::
    \frac1{\hat F} - 1 = r_F\left(\frac1{\hat F_m} - 1\right), \qquad
    \frac1{\hat Q} - 1 = r_Q\left(\frac1{\hat Q_m} - 1\right)

The factors depend on the Knudsen number, on the viscosity exponent and little on the TAC. That they
hold at finite temperature differences is shown by direct simulation: see
``studies/kinetic_collisions``.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.force.fitted import fitted
from lightflyer.force.kinetic.ratios import heating_of, thinness
from lightflyer.gas.base import AbstractGas
from lightflyer.numerics.polynomials import hold_within, polynomial
from lightflyer.numerics.special import root_sum_square

REFERENCE_TAC = 0.9
REFERENCE_EXPONENT = 0.74

_SIMULATED_CONDUCTION = (4.717, -0.646)
"""Conductivity over viscosity and gas constant of the table's diatomic molecules [1]: at an
exponent of 0.74, and its slope in the exponent. Larsen and Borgnakke's rotation conducts less than
a real gas."""

MODEL_CONDUCTION = 4.865  # The same of the model equation's diatomic gas

Collisions = Literal["vhs", "shakhov"]
"""Those of molecules, by the factors here, or those of the model equation alone."""

MODEL_FORCE_ERROR = 0.165
"""Relative standard error of what the model equation's collisions take from the force: half of the
largest deviation from direct simulations of a disk."""

MODEL_HEAT_ERROR = 0.0035
"""Relative standard error of the heat ratio by the model equation, likewise."""


HEATED_RANGE = (0.5, 3.5)
""":math:`T_h/T_c` between which factors change with it [1]: that of the model equation's table."""


class Heated(NamedTuple):
    """How a factor changes with temperature: to the power slope · (neutral − ω) of T_h/T_c."""

    slope: float
    neutral: dict[str, float]

    def __call__(self, kind: str, ratio: Numeric, exponent: Numeric) -> Array:
        """Change for a kind of gas, a temperature ratio and a viscosity exponent [1]."""
        return xp.exp(self.logarithm(kind, ratio, exponent))

    def logarithm(self, kind: str, ratio: Numeric, exponent: Numeric) -> Array:
        """The same as a logarithm [1]."""
        held = hold_within(heating_of(ratio), *np.log(HEATED_RANGE))
        return xp.asarray(self.slope * (self.neutral[kind] - exponent) * held)


# fitted to direct simulations of other gases than nitrogen in studies/kinetic_collisions
FORCE_HEATED = Heated(0.389, {"monatomic": 0.879, "diatomic": 0.838})
HEAT_HEATED = Heated(0.248, {"monatomic": 0.799, "diatomic": 0.721})

FORCE_ERROR, HEAT_ERROR = 0.036, 0.009
"""Standard errors of the factors of force and heat [1]: what is left, beside noise, of 22 direct
simulations to which nothing was fitted."""

HEATED_ERROR = 0.6
"""Standard error of what heating does to the factor of force, relative to itself: it was fitted
where one face hardly accommodates; where TACs are 0.4 to 1, most of it is missing."""


@dataclass(frozen=True)
class CollisionFit:
    """Factors of a kind of gas as smooth functions."""

    # Of the table; beyond it the factors stay what they are there
    knudsen_range: tuple[float, float]
    exponent_range: tuple[float, float]
    tac_range: tuple[float, float]  # TACs between which the factors change with it
    # Coefficients of the factors' logarithms: viscosity exponent less 0.74, TAC less 0.9, Knudsen
    # number
    force: Any
    heat: Any

    def force_factor(self, knudsen: Numeric, exponent: Numeric, tac: Numeric) -> Array:
        """:math:`r_F` of small temperature differences [1]."""
        return self._factor(self.force, knudsen, exponent, tac)

    def heat_factor(self, knudsen: Numeric, exponent: Numeric, tac: Numeric) -> Array:
        """:math:`r_Q` of small temperature differences [1]."""
        return self._factor(self.heat, knudsen, exponent, tac)

    def factors(self, knudsen: Numeric, exponent: Numeric, tac: Numeric) -> tuple[Array, Array]:
        """Both."""
        where = knudsen, exponent, tac
        return self.force_factor(*where), self.heat_factor(*where)

    def _factor(
        self, coefficients: Any, knudsen: Numeric, exponent: Numeric, tac: Numeric
    ) -> Array:
        stiff = hold_within(exponent, *self.exponent_range) - REFERENCE_EXPONENT
        return xp.exp(polynomial(coefficients, stiff, *self._place(knudsen, tac)))

    @kept
    def _place(self, knudsen: Numeric, tac: Numeric) -> tuple[Array, Array]:
        """TAC less its reference, and the place among the table's Knudsen numbers."""
        rough = xp.clip(tac, *self.tac_range) - REFERENCE_TAC
        return rough, thinness(knudsen, self.knudsen_range)


@dataclass(frozen=True)
class HeatedGas:
    """A gas around a flyer of another temperature."""

    gas: AbstractGas
    kind: str  # That of the tables that stands for it
    temperature: Numeric  # Of the gas [K], and of the flyer over it [1]
    ratio: Numeric
    exponent: Numeric  # Exponent of the gas's viscosity between the two [1]

    def force_factor(self, knudsen: Numeric, tac: Numeric) -> Array:
        """Factor of force, :math:`r_F` [1]."""
        factor = collision_fit(self.kind).force_factor(knudsen, self.exponent, tac)
        return factor * FORCE_HEATED(self.kind, self.ratio, self.exponent)

    def heat_factor(self, knudsen: Numeric, tac: Numeric) -> Array:
        """Factor of heat, :math:`r_Q` [1]."""
        factor = collision_fit(self.kind).heat_factor(knudsen, self.exponent, tac)
        if self.kind == "diatomic":
            # conductivity over viscosity and gas constant of the simulated molecules, and of the
            # gas at its temperature: a heat balance then looks it up once
            low, high = collision_fit(self.kind).exponent_range
            value, slope = _SIMULATED_CONDUCTION
            stiff = hold_within(self.exponent, low, high) - REFERENCE_EXPONENT
            own: Numeric = MODEL_CONDUCTION  # a polyatomic gas is scaled by its own elsewhere
            if self.gas.molecules == self.kind:
                own = self.gas.reduced_conductivity(self.temperature)
            factor = factor * ((value + slope * stiff) / own)
        return factor * HEAT_HEATED(self.kind, self.ratio, self.exponent)

    def factors(self, knudsen: Numeric, tac: Numeric) -> tuple[Array, Array]:
        """Both."""
        return self.force_factor(knudsen, tac), self.heat_factor(knudsen, tac)


def force_error(
    of_table: Array, ratio: Array, collisions: Collisions, heated: Numeric = 0.0
) -> Array:
    """Relative standard error of a force, with the table's [1]."""
    # ``heated``: logarithm of what heating does to the factor
    molecules = root_sum_square(FORCE_ERROR, HEATED_ERROR * heated)
    taken = molecules if collisions == "vhs" else MODEL_FORCE_ERROR
    return root_sum_square(of_table, taken * (1.0 - ratio))


def heat_error(of_table: Array, ratio: Array, collisions: Collisions) -> Array:
    """Relative standard error of a heat loss; as :func:`force_error`."""
    own = HEAT_ERROR * (1.0 - ratio) if collisions == "vhs" else MODEL_HEAT_ERROR
    return root_sum_square(of_table, own)


def with_collisions(ratio: Numeric, factor: Numeric) -> Array:
    """A ratio to free molecules where collisions take a factor more [1]."""
    return xp.asarray(ratio / (ratio + factor * (1.0 - ratio)))


@lru_cache
def collision_fit(gas: str = "diatomic") -> CollisionFit:
    """Factors of a kind of gas."""
    return fitted(CollisionFit, "collisions", gas)
