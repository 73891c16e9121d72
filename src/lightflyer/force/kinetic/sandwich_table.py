r"""The solver's table of kinetic force and heat of a disk with holes, as smooth functions.

The table gives, over rarefaction, open fraction and mean TAC, what fraction of their free-molecular
values are

- :math:`\hat F`: the force by a temperature difference of the faces,
- :math:`\hat F_\alpha`: the force by a difference of their TACs, where both are warm,
- :math:`\hat Q`: the heat of both faces, equally warm,
- :math:`\hat Q_\Delta`: the difference of the faces' heat, one as warm as the other is cold.

All fall from one as the gas gets denser. With :math:`s = 1-\beta`, what is fitted by polynomials
is the resistance that the gas adds, and for the last what it brings back,

.. math::
    \ln\frac{1/\hat F - 1}{s\,\delta}, \quad
    \ln\frac{1/\hat F_\alpha - 1}{s\,\delta}, \quad
    \ln\frac{1/\hat Q - 1}{s\,\bar\alpha\,\delta}, \quad
    \frac{1 - \hat Q_\Delta}{s\,\bar\alpha}\,\frac{1+\delta}\delta

:math:`\hat Q` depends on :math:`\beta` and :math:`\bar\alpha` by their product
:math:`s\bar\alpha` alone: where both sides are alike, a molecule that passes is one reflected.

What heat does to the resistances :math:`1/\hat F - 1` comes from a second, coarser table. For
:math:`\hat F_\alpha` and :math:`\hat Q` without holes it is that of
:mod:`~lightflyer.force.kinetic.ratios`, which both meet at :math:`\beta = 0`.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.force.fitted import fitted
from lightflyer.force.kinetic.collisions import MODEL_FORCE_ERROR, MODEL_HEAT_ERROR
from lightflyer.force.kinetic.ratios import KineticFit, kinetic_fit
from lightflyer.numerics.horner import polynomial
from lightflyer.numerics.polynomials import place_between
from lightflyer.numerics.special import root_sum_square

HIGHEST_OPEN_FRACTION = 0.99  # Where the table ends [1]
RAREFACTION_OF_KNUDSEN = np.sqrt(np.pi) / 4.0  # δ Kn, with the Knudsen number of the diameter

_FIT_ERROR = (0.003, 0.002)
"""Relative standard error of force and heat by the fit: half the largest misfit up to δ = 60."""

_RELATIVE = (False, True, True, False)  # whose value without holes is the disk's
_COLDEST = -0.3  # (T_h − T_c)/T_h down to which the fit's curve in temperature is continued
_SLOPES = (-1.0, 1.0)  # of the logarithm of a resistance that are believed beyond the table


class Ratios(NamedTuple):
    """Over the free-molecular values [1]."""

    force: Array  # Force by a temperature difference, and by a difference of TACs
    tac_force: Array
    heat: Array  # Heat of both faces together, and its difference
    heat_difference: Array


@dataclass(frozen=True)
class Resistance:
    """Logarithm of the resistance that the gas adds, over its factor in thin gas."""

    inside: Any  # Coefficients: what it depends on, then the place in the table
    slope: Any  # Coefficients of its slope in the logarithm of the rarefaction at the dense end

    def __call__(self, place: Numeric, beyond: Numeric, *variables: Numeric) -> Array:
        """Value at a place in the table, and so far beyond it in the logarithm."""
        slope = xp.clip(polynomial(self.slope, *variables), *_SLOPES)
        return polynomial(self.inside, *variables, place) + slope * beyond


@dataclass(frozen=True)
class SandwichFit:
    r"""Force and heat ratios of a disk with holes as smooth functions, fitted to a table."""

    rarefaction_range: tuple[float, float]  # Of the table
    tac_range: tuple[float, float]  # Of the table
    # Over open fraction (the force's over :math:`\beta/(1+\beta)`) and mean TAC; the heat's over
    # :math:`s\bar\alpha`
    force: Resistance
    tac_force: Resistance
    heat: Resistance
    heat_difference: Any  # Coefficients: open fraction, mean TAC, place
    disk: KineticFit  # Of the disk without holes
    # Coefficients of what heat does, in the order of :class:`Ratios`: heating, open fraction, place
    hot: tuple[Any, ...]
    # Largest :math:`1 - T_c/T_h` of the table of hot disks; beyond it the ratios stay constant
    heating_limit: float
    # Rarefactions in the table of hot disks; beyond it what heat does is held
    hot_range: tuple[float, float]
    # Coefficients of the effect of walls, in the order of :class:`Ratios`: inverse distance, open
    # fraction, place
    walls: tuple[Any, ...]
    wall_range: tuple[float, float]  # Rarefactions in the table of walls
    nearest_wall: float  # Least distance in it, in radii [1]
    # Coefficients, in the place, of the logarithm of the relative standard error of table and fit
    # together
    force_error: tuple[float, ...]
    heat_error: tuple[float, ...]

    def ratios(
        self,
        rarefaction: Numeric,
        open_fraction: Numeric,
        tac: Numeric,
        share: Numeric,
        temperature_ratio: Numeric,
        viscosity_exponent: Numeric | None = None,
    ) -> Ratios:
        r"""Force and heat over their free-molecular values."""
        place, beyond = self._place(rarefaction)
        mean = xp.clip(tac, *self.tac_range)
        heating = self._heating(temperature_ratio)
        hot = 1.0 / (1.0 - heating)
        disk = self._disk_resistance(rarefaction, mean, hot, viscosity_exponent)
        by_force, by_tac, by_heat, by_difference = (
            self._growth(which, rarefaction, open_fraction, heating)
            for which in range(len(self.hot))
        )
        solid = (1.0 - open_fraction) * rarefaction

        def ratio(resistance: Resistance, scale: Numeric, *variables: Numeric) -> Array:
            return 1.0 / (1.0 + scale * xp.exp(resistance(place, beyond, *variables)))

        back = polynomial(self.heat_difference, open_fraction, mean, place)
        cold = 1.0 - back * solid * tac / (1.0 + rarefaction)
        return Ratios(
            ratio(self.force, by_force * solid, flow(open_fraction), mean),
            ratio(self.tac_force, disk[0] * by_tac * solid, open_fraction, mean),
            ratio(self.heat, disk[1] * by_heat * share * rarefaction, share),
            cold / (cold + by_difference * (1.0 - cold)),
        )

    def force_growth(
        self, rarefaction: Numeric, open_fraction: Numeric, temperature_ratio: Numeric
    ) -> Array:
        r"""What heat does to the resistance :math:`1/\hat F-1` [1]."""
        return self._growth(0, rarefaction, open_fraction, self._heating(temperature_ratio))

    def _heating(self, temperature_ratio: Numeric) -> Array:
        return xp.clip(1.0 - 1.0 / temperature_ratio, _COLDEST, self.heating_limit)

    def _growth(
        self, which: int, rarefaction: Numeric, open_fraction: Numeric, heating: Numeric
    ) -> Array:
        """What heat does to one of the four resistances, or to it over that without holes."""
        coefficients = self.hot[which]
        place = place_of(rarefaction, self.hot_range)[0]
        change = polynomial(coefficients, heating, open_fraction, place)
        if _RELATIVE[which]:
            change = change - polynomial(coefficients, heating, 0.0, place)
        return xp.exp(heating * change)

    def _disk_resistance(
        self,
        rarefaction: Numeric,
        tac: Numeric,
        temperature_ratio: Numeric,
        viscosity_exponent: Numeric | None,
    ) -> tuple[Array, Array]:
        """Resistance to force and to heat of a hot disk without holes over that in this table."""
        least = self.disk.knudsen_range[0]
        knudsen = xp.maximum(RAREFACTION_OF_KNUDSEN / rarefaction, least)
        there = RAREFACTION_OF_KNUDSEN / knudsen
        place, _ = self._place(there)
        where = (knudsen, temperature_ratio, tac, None, viscosity_exponent)
        force = 1.0 / self.disk.force_ratio(*where) - 1.0
        heat = 1.0 / self.disk.heat_ratio(*where) - 1.0
        return (
            force / (there * xp.exp(self.tac_force(place, 0.0, 0.0, tac))),
            heat / (tac * there * xp.exp(self.heat(place, 0.0, tac))),
        )

    def relative_force_error(self, rarefaction: Numeric, force_ratio: Numeric) -> Array:
        """Relative standard error of the force: the table's and the equation's [1]."""
        # That of the equation stays for molecules, too: around holes they have not been compared.
        of_table = xp.exp(polynomial(self.force_error, self._place(rarefaction)[0]))
        of_equation = MODEL_FORCE_ERROR * (1.0 - force_ratio)
        return root_sum_square(of_table, _FIT_ERROR[0], of_equation)

    def relative_heat_error(self, rarefaction: Numeric) -> Array:
        """Relative standard error of the heat loss; as :meth:`relative_force_error`."""
        of_table = xp.exp(polynomial(self.heat_error, self._place(rarefaction)[0]))
        return root_sum_square(of_table, _FIT_ERROR[1], MODEL_HEAT_ERROR)

    def wall_factors(
        self, rarefaction: Numeric, open_fraction: Numeric, distance: Numeric
    ) -> Ratios:
        """Between walls over open space [1]; ``distance``: of the walls, in radii of the disk."""
        place = place_of(rarefaction, self.wall_range)[0]
        near = 1.0 / xp.maximum(distance, self.nearest_wall)
        return Ratios(
            *(xp.exp(near * polynomial(one, near, open_fraction, place)) for one in self.walls)
        )

    def _place(self, rarefaction: Numeric) -> tuple[Array, Array]:
        return place_of(rarefaction, self.rarefaction_range)


def place_of(rarefaction: Numeric, ends: tuple[float, float]) -> tuple[Array, Array]:
    """Where in a table a rarefaction is, from −1 to 1, and how far beyond its dense end."""
    low, high = np.log(ends)
    logarithm = xp.log(rarefaction)
    return place_between(xp.clip(logarithm, low, high), low, high), xp.maximum(
        logarithm - high, 0.0
    )


def flow(open_fraction: Any) -> Any:
    """What the flow through the holes of a dense gas goes with."""
    return open_fraction / (1.0 + open_fraction)


@lru_cache
def sandwich_fit(gas: str = "diatomic") -> SandwichFit:
    """Smooth functions through the table for a gas."""
    return fitted(SandwichFit, "sandwich", gas, disk=kinetic_fit(gas))
