r"""The force from kinetic theory: no fitted constants."""

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.free_molecular import free_molecular_heat_loss
from lightflyer.force.kinetic_table import GASES, kinetic_fit
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.gas import knudsen_number


class Kinetic(AbstractForceModel):
    r"""Force and heat loss of a thin disk from the solved kinetic equation.

    .. math::
        F = \hat F\,\frac{pA}{2}\,\Delta\alpha\left[\sqrt{T_h/T_c}-1\right], \qquad
        Q = \hat Q\,Q_\mathrm{fm}

    with the free-molecular values at walls that re-emit a share :math:`\alpha` of the molecules
    at the wall's temperature and reflect the rest (Maxwell). The ratios
    :math:`\hat F, \hat Q(\mathrm{Kn}, T_h/T_c, \bar\alpha)` come from the package's own solver
    of the kinetic equation (:mod:`lightflyer.kinetic`); the Knudsen number is that of the
    diameter at the gas temperature.

    Attributes
    ----------
    force_error, heat_error : array or None
        Deviation of the truth from the table, in the model's own standard errors [1]: those
        of the table and of the kinetic equation itself. A flyer file gives both as 0 ± 1, so
        that they are part of a prediction's uncertainty. None stands for zero.
    gas : {"diatomic", "monatomic"}
        Kind of the gas in the table. Air is diatomic.

    Raises
    ------
    ParameterError
        If there is no such gas.

    Notes
    -----
    The table ends at Kn = 0.03. In denser gas the heat loss goes on as that of conduction, the
    force as a power law; natural convection is left out. Beyond the table's temperature ratio
    of 2.5 the ratios stay what they are there.

    The table is for small differences of the faces' TACs. At 0.5 and 1 and Kn = 0.1 the heat loss
    comes out 2 % too large and the force 1.4 % too small; at 0.8 and 0.9 the heat is right to
    0.2 %.

    Where the surroundings have a wall (:attr:`EnvironmentState.wall_distance`), force and heat
    are those in a chamber of that radius.

    References
    ----------
    [Shakhov1968]_, [Rykov1975]_; the page on the kinetic force says how far to trust it.
    """

    force_error: Numeric = None
    heat_error: Numeric = None
    gas: str = eqx.field(static=True, default="diatomic")

    def __check_init__(self) -> None:
        if self.gas not in GASES:
            raise ParameterError(f"gas = {self.gas!r} is not one of {', '.join(GASES)}")

    @entry_point
    def heat_loss(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.heat_loss`."""
        fit, knudsen = kinetic_fit(self.gas), _knudsen_number(flyer, state)
        ratio = fit.heat_ratio(knudsen, 1.0 + excess, flyer.film.tac_mean)
        if state.wall_distance is not None:
            ratio *= fit.wall_factors(knudsen, state.wall_distance / flyer.radius)[1]
        if self.heat_error is not None:
            ratio *= 1.0 + self.heat_error * fit.relative_heat_error(knudsen)
        return ratio * free_molecular_heat_loss(flyer, state, excess)

    @entry_point
    def force(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        fit, knudsen = kinetic_fit(self.gas), _knudsen_number(flyer, state)
        ratio = fit.force_ratio(knudsen, 1.0 + excess, flyer.film.tac_mean)
        if state.wall_distance is not None:
            ratio *= fit.wall_factors(knudsen, state.wall_distance / flyer.radius)[0]
        if self.force_error is not None:
            ratio *= 1.0 + self.force_error * fit.relative_force_error(knudsen, ratio)
        return ratio * maxwell_force(flyer, state, excess)


def maxwell_force(flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
    r"""Free-molecular force at Maxwell walls [N], exact.

    .. math:: F = \frac{pA}{2}\,\Delta\alpha\left[\sqrt{1+\theta}-1\right]

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
    growth = excess / (jnp.sqrt(1.0 + excess) + 1.0)  # √(1 + θ) − 1 without cancellation
    return 0.5 * state.pressure * flyer.area * flyer.film.tac_difference * growth


def _knudsen_number(flyer: AbstractFlyer, state: EnvironmentState) -> Array:
    return knudsen_number(state.pressure, state.temperature, flyer.radius, state.gas)
