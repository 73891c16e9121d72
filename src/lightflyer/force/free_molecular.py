"""The limit of gas so thin that molecules meet the flyer and not each other."""

import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel, kinetic_conductance
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric


class FreeMolecular(AbstractForceModel):
    r"""Free-molecular heat loss and force, exact for any temperature difference.

    .. math::
        Q = \frac18\,\frac{\gamma+1}{\gamma-1}\,\frac{\bar v(T_c)}{T_c}\,(2A)\,\bar\alpha\,p\,
            \Delta T, \qquad
        F = \frac{pA}{2}\left[\sqrt{1+\alpha_b\theta} - \sqrt{1+\alpha_t\theta}\right]

    for molecules that leave each face at one accommodated temperature. Right for Kn much
    greater than one only: at the pressures of flight it exaggerates force and heat loss.

    References
    ----------
    [Lu2023]_ Eqs. (4) and (19), without their small-difference approximation.
    """

    @entry_point
    def heat_loss(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.heat_loss`."""
        return free_molecular_heat_loss(flyer, state, excess)

    @entry_point
    def force(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        film = flyer.film
        bottom = jnp.sqrt(1.0 + film.tac_bottom * excess)
        top = jnp.sqrt(1.0 + film.tac_top * excess)
        # the difference of the roots, written without cancellation
        difference = film.tac_difference * excess / (bottom + top)
        return 0.5 * state.pressure * flyer.area * difference


class LinearFreeMolecular(AbstractForceModel):
    r"""Free-molecular force to first order in the temperature difference.

    .. math:: F = A\,p\,\Delta\alpha\,\frac{\Delta T}{4T_c}

    The heat loss is that of :class:`FreeMolecular`, which is linear already. The force is 20 %
    too large at θ = 0.57 and 40 % at θ = 1.2.

    References
    ----------
    [Lu2023]_ Eqs. (4) and (19).
    """

    @entry_point
    def heat_loss(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.heat_loss`."""
        return free_molecular_heat_loss(flyer, state, excess)

    @entry_point
    def force(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        return 0.25 * flyer.area * state.pressure * flyer.film.tac_difference * excess


def free_molecular_heat_loss(
    flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric
) -> Array:
    """Free-molecular heat loss of both faces [W], exact; [Lu2023]_ Eq. (4) at T_c.

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    excess : array, shape (...)
        Relative temperature excess [1].

    Returns
    -------
    array, broadcast shape
    """
    speed = state.gas.mean_speed(state.temperature)
    return kinetic_conductance(flyer, state, speed) * excess
