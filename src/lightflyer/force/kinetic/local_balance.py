r"""The film whose spots balance their own heat: colder where the gas takes more, at the edge.

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

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.disk import Disk
from lightflyer.force.fitted import fitted
from lightflyer.force.free_molecular import disk_conductance
from lightflyer.force.kinetic.ratios import heating_of, thinness
from lightflyer.numerics.horner import polynomial

FilmBalance = Literal["isothermal", "local"]
"""One temperature of the whole film, or one that follows from each spot's balance of heat."""

_HEATING_EXPONENT = 1.57
_KNUDSEN_0 = 0.062
FILM_OF_DIATOMIC = "what a film's local balance of heat does is taken from a diatomic gas"
_HELD = "the table of films that balance their heat locally ends there, and what it says is held"


class RemainingShares(NamedTuple):
    """Factors of force and heat loss at the same mean temperature [1]."""

    force: Numeric
    heat: Numeric


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
    ) -> RemainingShares:
        """What is kept of the isothermal film's force and heat loss."""
        share = gas_share(disk, state, excess, heat_ratio)
        evened = share / (share + (1.0 - share) * knudsen / (knudsen + _KNUDSEN_0))
        scale = evened * xp.exp(-_HEATING_EXPONENT * xp.maximum(heating_of(1.0 + excess), 0.0))
        place = thinness(knudsen, self.knudsen_range)
        force, heat = (xp.exp(polynomial(own, place)) for own in (self.force, self.heat))
        return RemainingShares(1.0 - scale * force, 1.0 - scale * heat)


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
