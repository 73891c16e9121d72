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

Walls of a sandwich: what other ones than Maxwell's change in its force.

The table of a sandwich is for Maxwell walls. Where both of its outer faces scatter as Cercignani
and Lampis say, one hot and one cold, the force over that at Maxwell walls of the same TAC is

.. math:: \frac F{F_M} = \frac{1}{\bar\alpha}
    \left(\alpha_n + \frac{\delta}{\delta+\delta_0}\,g(\delta, \beta, \alpha_n, \alpha_t,
    \alpha_r)\right)

with a polynomial :math:`g` through a table of the solver's, for small differences. Without
collisions only the normal motion of the molecules that leave pushes.

A TAC leaves open how the kinds of energy share it. Where they do evenly, as at accommodated walls,
the force is that at Maxwell walls within 1 %, which is taken for the same. Unknown walls reach from
there to two ends. At one tangential motion and rotation accommodate wholly, and normal motion lacks
all that the TAC lacks. At the other molecules that a face does not trap lose half of their normal
energy, and nothing else (:mod:`lightflyer.force.kinetic.walls`).

A difference of two warm faces' TACs pushes as at a disk with these walls.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.force.fitted import fitted
from lightflyer.force.kinetic.collisions import MODEL_FORCE_ERROR, MODEL_HEAT_ERROR
from lightflyer.force.kinetic.ratios import KineticFit, kinetic_fit
from lightflyer.force.kinetic.walls import (
    BOUNCED,
    Accommodations,
    Walls,
    kinds_of,
    left_to_normal,
    scattering_fit,
    sharing_factor,
    uncertain,
    wall_fit,
)
from lightflyer.numerics.polynomials import place_between, polynomial, polynomial_once
from lightflyer.numerics.special import root_sum_square

HIGHEST_OPEN_FRACTION = 0.99  # Where the table ends [1]
RAREFACTION_OF_KNUDSEN = np.sqrt(np.pi) / 4.0  # δ Kn, with the Knudsen number of the diameter

_FIT_ERROR = (0.003, 0.002)
"""Relative standard error of force and heat by the fit: half the largest misfit up to δ = 60."""

_RELATIVE = (False, True, True, False)  # whose value without holes is the disk's
_COLDEST = -0.3  # (T_h − T_c)/T_h down to which the fit's curve in temperature is continued
_SLOPES = (-1.0, 1.0)  # of the logarithm of a resistance that are believed beyond the table


@dataclass(frozen=True)
class SandwichResistance:
    """Logarithm of the resistance that the gas adds, over its factor in thin gas."""

    inside: Any  # Coefficients: what it depends on, then the place in the table
    slope: Any  # Coefficients of its slope in the logarithm of the rarefaction at the dense end

    @kept
    def factor(self, place: Numeric, beyond: Numeric, *variables: Numeric) -> Array:
        """Resistance at a place in the table, or so far beyond it in the logarithm."""
        slope = xp.clip(polynomial(self.slope, *variables), *_SLOPES)
        return xp.exp(polynomial(self.inside, *variables, place) + slope * beyond)


@dataclass(frozen=True)
class SandwichFit:
    r"""Force and heat ratios of a disk with holes as smooth functions, fitted to a table."""

    rarefaction_range: tuple[float, float]  # Of the table
    tac_range: tuple[float, float]  # Of the table
    # Over open fraction (the force's over :math:`\beta/(1+\beta)`) and mean TAC; the heat's over
    # :math:`s\bar\alpha`
    force: SandwichResistance
    tac_force: SandwichResistance
    heat: SandwichResistance
    heat_difference: Any  # Coefficients: open fraction, mean TAC, place
    disk: KineticFit  # Of the disk without holes
    # Coefficients of what heat does to force, force by TACs, heat, and its difference: heating,
    # open fraction, place
    hot: tuple[Any, ...]
    # Largest :math:`1 - T_c/T_h` of the table of hot disks; beyond it the ratios stay constant
    heating_limit: float
    # Rarefactions in the table of hot disks; beyond it what heat does is held
    hot_range: tuple[float, float]
    # Coefficients of the effect of walls, in that order: inverse distance, open
    # fraction, place
    walls: tuple[Any, ...]
    wall_range: tuple[float, float]  # Rarefactions in the table of walls
    nearest_wall: float  # Least distance in it, in radii [1]
    # Coefficients, in the place, of the logarithm of the relative standard error of table and fit
    # together
    force_error: tuple[float, ...]
    heat_error: tuple[float, ...]

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
    ) -> list[Array]:
        """Between walls over open space [1]; ``distance``: of the walls, in radii of the disk."""
        place = place_of(rarefaction, self.wall_range)[0]
        near = 1.0 / xp.maximum(distance, self.nearest_wall)
        return [xp.exp(near * polynomial(one, near, open_fraction, place)) for one in self.walls]

    def _place(self, rarefaction: Numeric) -> tuple[Array, Array]:
        return place_of(rarefaction, self.rarefaction_range)

    @kept
    def places(self, rarefaction: Numeric) -> tuple[Any, ...]:
        """Place in the table, how far beyond it; of the disk without holes, which ends earlier."""
        # Knudsen number, rarefaction and place
        knudsen = xp.maximum(RAREFACTION_OF_KNUDSEN / rarefaction, self.disk.knudsen_range[0])
        there = RAREFACTION_OF_KNUDSEN / knudsen
        return *self._place(rarefaction), knudsen, there, self._place(there)[0]

    @kept
    def mean(self, tac: Numeric) -> Array:
        """A mean TAC, held within the table [1]."""
        return xp.clip(tac, *self.tac_range)


@dataclass(frozen=True)
class Ratios:
    """Over the free-molecular values [1]; each is computed as it is read."""

    fit: SandwichFit
    rarefaction: Numeric
    open_fraction: Numeric
    tac: Numeric
    share: Numeric
    temperature_ratio: Numeric
    viscosity_exponent: Numeric | None = None

    @cached_property
    def force_growth(self) -> Array:
        r"""What heat does to the resistance :math:`1/\hat F-1` [1]."""
        return self._growth(0)

    @cached_property
    def force(self) -> Array:
        """Force by a temperature difference."""
        place, beyond = self._places[:2]
        resistance = self.fit.force.factor(place, beyond, flow(self.open_fraction), self._mean)
        return 1.0 / (1.0 + self.force_growth * self._solid * resistance)

    @cached_property
    def tac_force(self) -> Array:
        """Force by a difference of TACs."""
        place, beyond, knudsen, there, at_disk = self._places
        disk = 1.0 / self.fit.disk.force_ratio(knudsen, *self._hot_disk) - 1.0
        disk = disk / (there * self.fit.tac_force.factor(at_disk, 0.0, 0.0, self._mean))
        resistance = self.fit.tac_force.factor(place, beyond, self.open_fraction, self._mean)
        return 1.0 / (1.0 + disk * self._growth(1) * self._solid * resistance)

    @cached_property
    def heat(self) -> Array:
        """Heat of both faces together."""
        place, beyond, knudsen, there, at_disk = self._places
        disk = 1.0 / self.fit.disk.heat_ratio(knudsen, *self._hot_disk) - 1.0
        thin = self._mean * there * self.fit.heat.factor(at_disk, 0.0, self._mean)
        resistance = self.fit.heat.factor(place, beyond, self.share)
        growth = disk / thin * self._growth(2)
        return 1.0 / (1.0 + growth * self.share * self.rarefaction * resistance)

    @cached_property
    def heat_difference(self) -> Array:
        """Its difference between the faces."""
        where = self.open_fraction, self._mean, self._places[0]
        back = polynomial_once(self.fit.heat_difference, *where)
        cold = 1.0 - back * self._solid * self.tac / (1.0 + self.rarefaction)
        return cold / (cold + self._growth(3) * (1.0 - cold))

    @cached_property
    def _places(self) -> tuple[Any, ...]:
        return self.fit.places(self.rarefaction)

    @cached_property
    def _mean(self) -> Array:
        return self.fit.mean(self.tac)

    @cached_property
    def _solid(self) -> Array:
        return xp.asarray((1.0 - self.open_fraction) * self.rarefaction)

    @cached_property
    def _heating(self) -> Array:
        return xp.clip(1.0 - 1.0 / self.temperature_ratio, _COLDEST, self.fit.heating_limit)

    @cached_property
    def _hot_disk(self) -> tuple[Any, ...]:
        return 1.0 / (1.0 - self._heating), self._mean, None, self.viscosity_exponent

    def _growth(self, which: int) -> Array:
        """What heat does to one of the four resistances, or to it over that without holes."""
        coefficients = self.fit.hot[which]
        place = place_of(self.rarefaction, self.fit.hot_range)[0]
        change = polynomial(coefficients, self._heating, self.open_fraction, place)
        if _RELATIVE[which]:
            change = change - polynomial(coefficients, self._heating, 0.0, place)
        return xp.exp(self._heating * change)


@kept
def place_of(rarefaction: Numeric, ends: tuple[float, float]) -> tuple[Array, Array]:
    """Where in a table a rarefaction is, from −1 to 1, and how far beyond its dense end."""
    low, high = np.log(ends)
    logarithm = xp.log(rarefaction)
    return place_between(xp.clip(logarithm, low, high), low, high), xp.maximum(
        logarithm - high, 0.0
    )


@kept
def flow(open_fraction: Any) -> Any:
    """What the flow through the holes of a dense gas goes with."""
    return open_fraction / (1.0 + open_fraction)


@lru_cache
def sandwich_fit(gas: str = "diatomic") -> SandwichFit:
    """Smooth functions through the table for a gas."""
    return fitted(SandwichFit, "sandwich", gas, disk=kinetic_fit(gas))


_DENSITY = 1.8  # δ at which thin gas gives way to dense, for what is fitted only
UNKNOWN_TACS = (0.6, 1.0)  # between which unknown walls change with the TAC


@dataclass(frozen=True)
class SandwichWallsFit:
    """Pushes of hot and cold faces that scatter alike, over Maxwell's of a TAC of 1, for a gas."""

    rarefaction_range: tuple[float, float]  # Of the table
    ranges: tuple[tuple[float, float], ...]  # Of open fraction and the coefficients in it
    coefficients: Any  # Place in the table, open fraction, accommodation coefficients

    def added(self, rarefaction: Numeric, open_fraction: Numeric, faces: Accommodations) -> Array:
        r"""What collisions add to the push of the normal motion, :math:`\alpha_n` [1]."""
        values = (open_fraction, *faces)[: len(self.ranges)]
        inside = [xp.clip(v, *range_) for v, range_ in zip(values, self.ranges, strict=True)]
        place, _ = place_of(rarefaction, self.rarefaction_range)
        found = polynomial(self.coefficients, place, *inside)
        return xp.asarray(denseness(rarefaction) * found)


def denseness(rarefaction: Any) -> Any:
    """Grows from 0 in thin gas to 1 in dense gas."""
    return rarefaction / (rarefaction + _DENSITY)


@lru_cache
def sandwich_walls_fit(gas: str) -> SandwichWallsFit:
    """Smooth function through the table for a gas."""
    return fitted(SandwichWallsFit, "sandwich walls", gas)


@lru_cache
def ends_fit(gas: str) -> tuple[Any, ...]:
    """Coefficients of what collisions add to the pushes at both :func:`ends`."""
    return fitted(tuple, "sandwich sharing", gas)


def ends(tac: Any, gas: str) -> tuple[Accommodations, Accommodations]:
    """How a face may share its TAC at most: in its normal motion, and in what it traps."""
    kinds = kinds_of(gas)
    bounced = BOUNCED / kinds  # of all energy of a molecule that is not trapped
    trapped = xp.maximum((tac - bounced) / (1.0 - bounced), 0.0)
    return (
        Accommodations(left_to_normal(tac, kinds), 1.0, 1.0),
        Accommodations(trapped + BOUNCED * (1.0 - trapped), trapped, trapped),
    )


def force_factors(
    gas: str,
    place: tuple[Numeric, Numeric, Numeric],
    excess: tuple[Array, ...],
    walls: Walls,
    kept: Numeric,
) -> tuple[Numeric, Numeric]:
    """Force by a difference of temperatures and of TACs over those at Maxwell walls [1].

    Parameters
    ----------
    gas : {"monatomic", "diatomic"}
    place : tuple of array
        Rarefaction, open fraction and TAC [1].
    excess : tuple of array
        :math:`T/T_c-1` of both faces [1].
    walls : Walls
    kept : array
        What is left of what collisions add, where they are not those of the table, in open space
        [1].
    """
    if walls.wall == "maxwell":
        return 1.0, 1.0
    rarefaction, open_fraction, tac = place
    knudsen, mean = RAREFACTION_OF_KNUDSEN / rarefaction, 0.5 * (excess[0] + excess[1])
    free = 0.5 * (xp.sqrt(1.0 + mean) + 1.0) / xp.sqrt(1.0 + tac * mean)
    of_tacs = free * wall_fit(gas).force_factor(knudsen, 1.0 + mean, tac)
    if walls.wall == "cercignani-lampis":
        stated = walls.stated(gas)
        faces = stated.held(tac)
        added = sandwich_walls_fit(gas).added(rarefaction, open_fraction, faces)
        # kinds that are not stated share a difference of TACs; normal motion has the rest
        shared = [k is None for k in (stated.tangential, stated.rotational)]
        weights = scattering_fit(gas).weights(knudsen, faces)
        differences = 3.0 - sum(shared), *(float(one) for one in shared)
        of_tacs = of_tacs * sum(w * d for w, d in zip(weights, differences, strict=True))
        return (_push_of_free(faces.normal, excess) + kept * added) / tac, of_tacs
    # from accommodated walls towards Maxwell's
    way = 0.0 if walls.wall == "accommodated" else 0.5
    of_tacs = uncertain(of_tacs + way * (1.0 - of_tacs), (1.0 - way) * (1.0 - of_tacs), walls.error)
    if walls.sharing is None:
        return 1.0, of_tacs
    share = xp.clip(xp.asarray(walls.sharing) / NORMAL_HALF_WIDTH_95, -1.0, 1.0)
    # over Maxwell walls at both :func:`ends`
    fit = sandwich_walls_fit(gas)
    held, hole = xp.clip(tac, *UNKNOWN_TACS), xp.clip(open_fraction, *fit.ranges[0])
    at = place_of(rarefaction, fit.rarefaction_range)[0], hole, held
    dense = kept * denseness(rarefaction)
    upper, lower = (
        (_push_of_free(end.normal, excess) + dense * polynomial(coefficients, *at)) / held
        for end, coefficients in zip(ends(held, gas), ends_fit(gas), strict=True)
    )
    found = 1.0 + xp.maximum(share, 0.0) * (upper - 1.0) + xp.maximum(-share, 0.0) * (lower - 1.0)
    return found, of_tacs * sharing_factor(gas, knudsen, tac, mean, walls.sharing)


def near_walls(rarefaction: Numeric, distance: Numeric) -> Array:
    """Share that a reservoir leaves of what collisions add [1]; ``distance``: in disk radii."""
    # through solutions at rarefactions of 0.2, 1 and 5 and distances of 3 and 6, within 0.02
    return xp.asarray(1.0 - distance**-1.5 / (1.0 + rarefaction) ** 2)


def _push_of_free(normal: Numeric, excess: tuple[Array, ...]) -> Array:
    """Push of the normal motion, over that at Maxwell walls with a TAC of 1 [1]."""
    maxwell, found = (sum(xp.sqrt(1.0 + one * face) for face in excess) for one in (1.0, normal))
    return xp.asarray(normal * maxwell / found)
