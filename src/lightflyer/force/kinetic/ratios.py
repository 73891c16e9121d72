r"""Kinetic force and heat of a disk as smooth functions of place.

They give, over Knudsen number, temperature ratio and TACs, what fraction of their free-molecular
values the force and the heat loss of a thin disk are. Both fractions fall from one
as the gas gets denser. What is given by polynomials is how much resistance the gas adds, times
the Knudsen number,

.. math::
    \ln\left[\left(\frac{1}{\hat F}-1\right)\mathrm{Kn}\right], \qquad
    \ln\left[\left(\frac{1}{\hat Q}-1\right)\frac{\mathrm{Kn}}{\bar\alpha}\right]

because these vary slowly and tend to constants in thin gas. In dense gas the heat's tends to that
of conduction. The force's tends to a power law, since only the edge of a disk contributes. So they
can be continued beyond the table that ``studies/kinetic_fits`` fits them to.

The film whose spots balance their own heat: colder where the gas takes more, at the edge.

Heat hardly flows along a film thinner than a micrometre. Its temperature then follows from what
each spot absorbs and loses. With the mean of the temperature in place of that of an isothermal
film, force and heat loss are smaller by the shares

.. math::
    D\,\left(\frac{T_h}{T_c}\right)^{-n}\,\frac{s}{s+k(1-s)}, \qquad
    k = \frac{\mathrm{Kn}}{\mathrm{Kn}+\mathrm{Kn}_0}

where the gas takes the share :math:`s` of a small change of the heat: radiation is as strong
everywhere and evens the temperature out. :math:`D(\mathrm{Kn})` are from the solver's linear
problem (``studies/kinetic_chamber``), :math:`n` and :math:`\mathrm{Kn}_0` are fitted to points with
large differences and with radiation.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.disk import Disk
from lightflyer.force.fitted import fitted
from lightflyer.force.free_molecular import disk_conductance
from lightflyer.numerics.polynomials import hold_within, place_between, polynomial, polynomial_once

BOUNDARY_TAC = 0.85  # Mean TAC in the table of walls

TAC_OFFSET = 0.1
"""The variable of the fits is the logarithm of the mean TAC plus this: the force's resistance grows
as the TAC does where it is large, and is constant where walls are smooth."""


COLDEST = 0.1
"""Least :math:`T_h/T_c` of which a logarithm is taken [1]: far below every table, and above zero,
beyond which a heat balance may step."""


class FitPlace(NamedTuple):
    """A place in the table."""

    # Where the Knudsen number is among those of the linear and of the non-linear problem, from −1
    # to 1, shape (...)
    thinness: Array
    hot_thinness: Array
    # Knudsen number over that of the table's end where it lies below it, else 1, shape (...)
    dense: Array
    heating: Array  # ln(T_h/T_c), shape (...)
    tac: Array  # Mean TAC, and the logarithm of it plus TAC_OFFSET, shape (...)
    tac_variable: Array


@dataclass(frozen=True)
class Resistance:
    """Logarithm of the resistance that the gas adds, times the Knudsen number."""

    limit: Any  # Coefficients of the linear problem: TAC, Knudsen number
    heating: Any  # Coefficients of what heating adds: heating, TAC, Knudsen number
    # Coefficients of what the viscosity exponent adds, per unit of it: heating, Knudsen number
    exponent: Any

    def __call__(self, place: FitPlace, exponent_difference: Numeric | None) -> Array:
        """Value at a place, for a viscosity exponent that differs from the table's."""
        heated = polynomial(self.heating, place.heating, place.tac_variable, place.hot_thinness)
        if exponent_difference is not None:
            heated = heated + (
                exponent_difference * polynomial(self.exponent, place.heating, place.hot_thinness)
            )
        return place.heating * heated + polynomial_once(
            self.limit, place.tac_variable, place.thinness
        )


@dataclass(frozen=True)
class Unlikeness:
    r"""What a difference of the faces' TACs adds."""

    # With the share :math:`w=(\Delta\alpha/2\bar\alpha)^2`, the two faces' resistances to the
    # difference of their heat, :math:`R_o`, leave
    #
    # .. math::
    #     \frac1{\hat Q(\Delta\alpha)} = \frac1{\hat Q} + \frac{gw}{1-gw}, \qquad
    #     \frac1{\hat F(\Delta\alpha)} - 1 = (1-kgw)\left(\frac1{\hat F} - 1\right), \qquad
    #     g = \frac{\bar\alpha R_o}{1+\bar\alpha R_o}

    # Coefficients of the logarithm of :math:`R_o\,\mathrm{Kn}` for small temperature differences:
    # Knudsen number, TAC
    resistance: Any
    force: Any  # Coefficients of the logarithm of :math:`k`, likewise
    # Coefficients of what heating adds to these logarithms, per unit of its own
    hot_resistance: Any
    hot_force: Any
    # Of hot faces that are unlike; beyond it what heating adds stays what it is there
    hot_knudsen_range: tuple[float, float]

    def at(self, place: FitPlace, knudsen: Numeric, tac_difference: Numeric) -> tuple[Array, Array]:
        """:math:`gw` and :math:`k` at a place."""
        where, tac = place.thinness, place.tac_variable
        hot = thinness(knudsen, self.hot_knudsen_range)
        logarithm = polynomial_once(self.resistance, where, tac)
        logarithm = logarithm + (place.heating * polynomial_once(self.hot_resistance, hot, tac))
        of_force = polynomial_once(self.force, where, tac)
        of_force = of_force + (place.heating * polynomial_once(self.hot_force, hot, tac))
        resistance = place.tac * xp.exp(logarithm) / knudsen
        apart = xp.minimum(width(tac_difference, place.tac), 1.0)
        return apart * resistance / (1.0 + resistance), xp.exp(of_force)


@dataclass(frozen=True)
class KineticFit:
    """Force and heat ratios as smooth functions, fitted to a table."""

    # Of the linear problem's table; beyond it the limits' power laws continue
    knudsen_range: tuple[float, float]
    # Knudsen numbers of the non-linear problem, T_h/T_c and mean TACs of the table; what heat does,
    # and the ratios, stay beyond them what they are at their ends
    hot_knudsen_range: tuple[float, float]
    ratio_range: tuple[float, float]
    tac_range: tuple[float, float]
    viscosity_exponent: float  # Of the table's gas [1]
    conduction: float  # What the heat's resistance tends to for small differences in dense gas
    force: Resistance
    heat: Resistance
    unlikeness: Unlikeness
    # Coefficients, in the Knudsen number, of the logarithm of the relative standard error of table
    # and fit
    force_error: tuple[float, ...]
    heat_error: tuple[float, ...]
    force_wall: Any  # Coefficients of the effect of walls: inverse distance, Knudsen number
    heat_wall: Any
    wall_knudsen_range: tuple[float, float]  # Knudsen numbers in the table of walls
    nearest_wall: float  # Least distance in the table of walls, in radii [1]

    def force_ratio(
        self,
        knudsen: Numeric,
        ratio: Numeric,
        tac: Numeric,
        tac_difference: Numeric | None = None,
        viscosity_exponent: Numeric | None = None,
    ) -> Array:
        r"""Force over the free-molecular one, :math:`\hat F` [1]."""
        place = self._place(knudsen, ratio, tac)
        fitted = self.force(place, self._exponent_difference(viscosity_exponent))
        # below the table the force is that of the edge, ∝ Kn²
        resistance = xp.exp(fitted) / (place.dense * knudsen)
        if tac_difference is not None:
            gw, k = self.unlikeness.at(place, knudsen, tac_difference)
            resistance = resistance * (1.0 - k * gw)
        return 1.0 / (1.0 + resistance)

    def heat_ratio(
        self,
        knudsen: Numeric,
        ratio: Numeric,
        tac: Numeric,
        tac_difference: Numeric | None = None,
        viscosity_exponent: Numeric | None = None,
    ) -> Array:
        r"""Heat loss over the free-molecular one, :math:`\hat Q` [1]; as :meth:`force_ratio`."""
        place = self._place(knudsen, ratio, tac)
        difference = self._exponent_difference(viscosity_exponent)
        fitted = self.heat(place, difference)
        exponent = self.viscosity_exponent + (0.0 if difference is None else difference)
        conducted = self.conduction - conduction_growth(place.heating, exponent)
        fitted = conducted + (fitted - conducted) * place.dense
        inverse = 1.0 + xp.exp(fitted) * tac / knudsen
        if tac_difference is not None:
            gw, _ = self.unlikeness.at(place, knudsen, tac_difference)
            inverse = inverse + (gw / (1.0 - gw))
        return 1.0 / inverse

    def table_errors(self, knudsen: Numeric) -> tuple[Array, Array]:
        """Relative standard errors of force and heat by the solver and the fit [1]."""
        place = thinness(knudsen, self.knudsen_range)
        return (
            xp.exp(polynomial(self.force_error, place)),
            xp.exp(polynomial(self.heat_error, place)),
        )

    def wall_factors(
        self,
        knudsen: Numeric,
        distance: Numeric,
        tac: Numeric = BOUNDARY_TAC,
        tac_difference: Numeric | None = None,
    ) -> tuple[Array, Array]:
        """Force and heat between walls over those in open space [1]; ``tac``: mean of the faces."""
        # Walls take a share of the gas's resistance to heat that does not depend on the TAC to 1 %,
        # and raise the force over the heat by a factor that does not.
        place = thinness(knudsen, self.wall_knudsen_range)
        nearness = 1.0 / xp.maximum(distance, self.nearest_wall)
        opened = self.heat_ratio(knudsen, 1.0, tac)
        kept = xp.exp(nearness * polynomial(self.heat_wall, nearness, place))
        walled = 1.0 / (1.0 + kept * (1.0 / opened - 1.0))
        like = heat = walled / opened
        if tac_difference is not None:
            # what the difference adds to the resistance is beside the faces, and stays
            unlike = self.heat_ratio(knudsen, 1.0, tac, tac_difference)
            heat = 1.0 / (unlike * (1.0 / walled + 1.0 / unlike - 1.0 / opened))
        beside = polynomial(self.force_wall, nearness, place)
        return like * xp.exp(nearness * beside * denseness(knudsen)), heat

    def _place(self, knudsen: Numeric, ratio: Numeric, tac: Numeric) -> FitPlace:
        return FitPlace(
            thinness(knudsen, self.knudsen_range),
            thinness(knudsen, self.hot_knudsen_range),
            xp.minimum(knudsen / self.knudsen_range[0], 1.0),
            hold_within(heating_of(ratio), *np.log(self.ratio_range)),
            *_tac_variables(tac, self.tac_range),
        )

    def _exponent_difference(self, viscosity_exponent: Numeric | None) -> Numeric | None:
        return None if viscosity_exponent is None else viscosity_exponent - self.viscosity_exponent


@lru_cache
def kinetic_fit(gas: str = "diatomic") -> KineticFit:
    """Smooth functions through the table for a gas."""
    return fitted(KineticFit, "disk", gas)


@kept
def tacs_of(film: FilmProperties) -> tuple[Numeric, Numeric]:
    """Mean TAC of a film's faces, and their difference [1]."""
    return film.tac_mean, film.tac_difference


@kept
def _tac_variables(tac: Numeric, ends: tuple[float, float]) -> tuple[Array, Array]:
    """A mean TAC within the table, and the logarithm of it plus the offset."""
    inside = xp.clip(tac, *ends)
    return inside, xp.log(inside + TAC_OFFSET)


def conduction_growth(heating: Any, exponent: Any) -> Any:
    r"""Logarithm of what a conductivity that grows with temperature adds to conduction."""
    # .. math::
    #     \ln\frac{\int_{T_c}^{T_h} T^\omega\,\mathrm dT}{T_c^\omega\,(T_h-T_c)}
    #     = \frac{\omega t}2 + \ln\frac{\sinh\frac{(\omega+1)\,t}2}{(\omega+1)\sinh\frac t2},
    #     \qquad t = \ln\frac{T_h}{T_c}
    #
    # By its series to :math:`t^4`, which is right to 0.1 % for :math:`|t|` up to 1.25.
    square = heating**2
    second, fourth = (((exponent + 1.0) ** power - 1.0) for power in (2, 4))
    return 0.5 * exponent * heating + square * (second / 24.0 - square * fourth / 2880.0)


def heating_of(ratio: Numeric) -> Array:
    r""":math:`\ln(T_h/T_c)`, also of iterates of a heat balance that are no temperatures."""
    return xp.log(xp.maximum(ratio, COLDEST))


@kept
def thinness(knudsen: Numeric, ends: tuple[float, float]) -> Array:
    """Where among the Knudsen numbers of a table one is, from −1 to 1."""
    low, high = np.log(ends)
    return place_between(xp.clip(xp.log(knudsen), low, high), low, high)


def width(tac_difference: Any, tac: Any) -> Any:
    """:math:`w` of :class:`Unlikeness` [1]."""
    return (0.5 * tac_difference / tac) ** 2


def denseness(knudsen: Any) -> Any:
    """Falls as the effect of collisions does in thin gas."""
    return 1.0 / (1.0 + knudsen)


FilmBalance = Literal["isothermal", "local"]
"""One temperature of the whole film, or one that follows from each spot's balance of heat."""

_HEATING_EXPONENT = 1.57
_KNUDSEN_0 = 0.062
FILM_OF_DIATOMIC = "what a film's local balance of heat does is taken from a diatomic gas"
_HELD = "the table of films that balance their heat locally ends there, and what it says is held"


@dataclass(frozen=True)
class LocalBalanceFit:
    """Shares that a film loses as smooth functions."""

    # Of the table; beyond it the shares stay what they are there
    knudsen_range: tuple[float, float]
    force: Any  # Coefficients of the logarithms of :math:`D` for force and heat loss
    heat: Any

    def ranges(self, knudsen: Numeric) -> Looks:
        """Of the table."""
        yield Validity("the Knudsen number", self.knudsen_range[0], np.inf, _HELD), knudsen

    def kept_shares(
        self,
        disk: Disk,
        state: EnvironmentState,
        excess: Numeric,
        knudsen: Numeric,
        heat_ratio: Numeric,
    ) -> tuple[Numeric, Numeric]:
        """What is kept of an isothermal film's force and heat loss at the same mean temperature."""
        share = gas_share(disk, state, excess, heat_ratio)
        evened = share / (share + (1.0 - share) * knudsen / (knudsen + _KNUDSEN_0))
        scale = evened * xp.exp(-_HEATING_EXPONENT * xp.maximum(heating_of(1.0 + excess), 0.0))
        place = thinness(knudsen, self.knudsen_range)
        force, heat = (xp.exp(polynomial(own, place)) for own in (self.force, self.heat))
        return 1.0 - scale * force, 1.0 - scale * heat


def gas_share(disk: Disk, state: EnvironmentState, excess: Numeric, heat_ratio: Numeric) -> Array:
    """Share of the gas in a small change of the film's heat loss [1]; else it is radiated."""
    film = disk.film
    gas = heat_ratio * disk_conductance(disk, state, excess)
    emittance = film.emittance_top + film.emittance_bottom
    hot = state.temperature * xp.maximum(1.0 + excess, 0.0)
    sent = 4.0 * emittance * state.radiation.stefan_boltzmann * disk.area
    return xp.asarray(gas / (gas + sent * hot**3 * state.temperature))


@lru_cache
def local_balance_fit() -> LocalBalanceFit:
    """Shares that a film loses; the table is for a diatomic gas."""
    return fitted(LocalBalanceFit, "local balance", "diatomic")
