r"""What a force model must give.

A force model answers two questions about a flyer that is hotter than the gas: how much heat
does the gas take from it, and how strongly does the gas push it? Both are asked in terms of the
relative temperature excess :math:`\theta = (T_h - T_c)/T_c`, which stays exact where flyer and
gas differ by a millikelvin. A new model is one small file with one final class.
"""

import abc

import equinox as eqx
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.foundation.types import Numeric


class AbstractForceModel(eqx.Module):
    """Heat loss to the gas and photophoretic force of a flyer.

    Both methods must be pure JAX functions that broadcast. The solvers rely on two properties:
    the heat loss increases with the excess and is zero at zero excess; the force, where it is
    positive, does not decrease with it.
    """

    @abc.abstractmethod
    def heat_loss(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        r"""Heat that the gas takes from both faces [W].

        Parameters
        ----------
        flyer : AbstractFlyer
        state : EnvironmentState
        excess : array, shape (...)
            :math:`\theta = (T_h - T_c)/T_c > -1` [1].

        Returns
        -------
        array, broadcast shape
        """

    @abc.abstractmethod
    def force(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        r"""Force of the gas on the flyer, upward positive [N].

        Parameters
        ----------
        flyer : AbstractFlyer
        state : EnvironmentState
        excess : array, shape (...)
            :math:`\theta = (T_h - T_c)/T_c > -1` [1].

        Returns
        -------
        array, broadcast shape
        """


def kinetic_conductance(flyer: AbstractFlyer, state: EnvironmentState, speed: Numeric) -> Array:
    r"""Free-molecular heat loss per relative temperature excess [W].

    .. math:: \frac{Q_\mathrm{fm}}{\theta} =
        \frac18\,\frac{\gamma+1}{\gamma-1}\,\bar v\,(2A)\,\bar\alpha\,p

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    speed : array
        :math:`\bar v` times :math:`T_c` over the temperature it belongs to [m/s].

    Returns
    -------
    array, broadcast shape

    References
    ----------
    [Lu2023]_ Eq. (4).
    """
    ratio = state.gas.heat_capacity_ratio
    both_faces = 2.0 * flyer.area
    internal_modes = (ratio + 1.0) / (ratio - 1.0)
    return 0.125 * internal_modes * speed * both_faces * flyer.film.tac_mean * state.pressure
