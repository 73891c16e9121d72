r"""The paper's model: two limits joined by interpolation, with two fitted coefficients.

The paper's equations as printed do not give the paper's own predictions. One other choice of
conventions does. Both are here, as :data:`PRINTED` and :data:`REPORTED`; neither is the truth.
"""

import math

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel, kinetic_conductance
from lightflyer.foundation.checks import require_positive
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric

_THERMAL_CREEP = 1.14  # κ_s of [Lu2023] Eq. (20)
_DISK_NUSSELT = 8.0 / math.pi  # isothermal disk at rest, [Lu2023] Eq. (7)
_CONVECTION = 0.417  # Rayleigh-number term of [Lu2023] Eq. (7)


class Reading(eqx.Module):
    """The conventions in which the two readings of the paper differ.

    A weight of 0 stands for the gas temperature, 1 for the mean of gas and disk, 2 for the disk.

    Attributes
    ----------
    heat_weight : float
        Temperature at which Eq. (4) takes the molecules' mean speed.
    continuum_faces : float
        How often Eq. (5) is counted. The isothermal disk's 8rκΔT is for both faces already.
    force_weight : float
        Temperature that divides the difference in Eq. (19).
    creep_weight : float
        Temperature in the numerator of Eq. (20).
    """

    heat_weight: float = eqx.field(static=True)
    continuum_faces: float = eqx.field(static=True)
    force_weight: float = eqx.field(static=True)
    creep_weight: float = eqx.field(static=True, default=2.0)


PRINTED = Reading(heat_weight=1.0, continuum_faces=1.0, force_weight=0.0)
"""The equations as printed."""

REPORTED = Reading(heat_weight=0.0, continuum_faces=2.0, force_weight=1.0)
"""The conventions that give the numbers the paper reports."""

READINGS = {"printed": PRINTED, "reported": REPORTED}
"""Readings by the name they have in a flyer file."""


class Lu2023(AbstractForceModel):
    r"""Interpolation between free-molecular and continuum limits for a disk.

    .. math::
        \frac1{Q} = \frac1{Q_\mathrm{fm}} + \frac1{Q_\mathrm{cont}}, \qquad
        \frac1{F} = \frac1{C_\mathrm{fm}F_\mathrm{fm}} + \frac1{C_\mathrm{cont}F_\mathrm{cont}}

    Attributes
    ----------
    c_fm, c_cont : array
        Coefficients of the force's limits [1]. The paper fits 0.4 and 3 to its experiments;
        aerosols have 1 and 1.
    reading : Reading
        Default :data:`REPORTED`.

    Raises
    ------
    ParameterError
        If a concrete coefficient is not positive.

    Notes
    -----
    With :data:`REPORTED` the force saturates as the disk gets hotter, so a flyer may be unable
    to levitate at any irradiance.

    References
    ----------
    [Lu2023]_ Eqs. (3)-(10) and (18)-(20), with their misprints corrected (see the errata).
    """

    c_fm: Numeric = 0.4
    c_cont: Numeric = 3.0
    reading: Reading = REPORTED

    def __check_init__(self) -> None:
        require_positive(c_fm=self.c_fm, c_cont=self.c_cont)

    @entry_point
    def heat_loss(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.heat_loss`."""
        return excess * _in_series(*self.heat_conductances(flyer, state, excess))

    @entry_point
    def heat_conductances(
        self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric
    ) -> tuple[Array, Array]:
        """Heat loss per relative temperature excess in the two limits [W].

        Parameters
        ----------
        flyer : AbstractFlyer
        state : EnvironmentState
        excess : array, shape (...)
            Relative temperature excess [1].

        Returns
        -------
        free_molecular, continuum : array, broadcast shape
            The first is proportional to the mean TAC, the second does not depend on it.
        """
        stretch = 1.0 + 0.5 * self.reading.heat_weight * excess
        speed = state.gas.mean_speed(state.temperature) / jnp.sqrt(stretch)
        free_molecular = kinetic_conductance(flyer, state, speed)
        continuum = self.reading.continuum_faces * _continuum_conductance(flyer, state, excess)
        return free_molecular, continuum

    @entry_point
    def force(self, flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        stretch = 1.0 + 0.5 * self.reading.force_weight * excess
        free_molecular = 0.25 * flyer.area * state.pressure / stretch
        creep_temperature = state.temperature * (1.0 + 0.5 * self.reading.creep_weight * excess)
        continuum = _creep_stiffness(flyer, state, excess, creep_temperature)
        per_difference = _in_series(self.c_fm * free_molecular, self.c_cont * continuum)
        return flyer.film.tac_difference * excess * per_difference


def _in_series(first: Array, second: Array) -> Array:
    """Conductances in series: zero where either is."""
    return first * second / (first + second)


def _mean_temperature(state: EnvironmentState, excess: Numeric) -> Array:
    return state.temperature * (1.0 + 0.5 * excess)


def rayleigh_number(flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
    r"""Rayleigh number of the disk, from the size of the temperature difference.

    .. math:: \mathrm{Ra} = \frac{g}{\bar T}\,\frac{\rho\,(2r)^3\,|\Delta T|}{\mu D},
        \qquad D = \frac{\kappa}{\rho c_p}, \quad \rho = \frac{p}{R\bar T}

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    excess : array, shape (...)
        Relative temperature excess [1].

    Returns
    -------
    array, broadcast shape

    References
    ----------
    [Lu2023]_ Eqs. (8)-(10), with (9) corrected.
    """
    mean, gas = _mean_temperature(state, excess), state.gas
    density = gas.density(state.pressure, mean)
    viscosity, conductivity = gas.viscosity(mean), gas.conductivity(mean)
    diameter = 2.0 * flyer.radius
    difference = state.temperature * jnp.abs(excess)
    buoyancy = state.gravity * density * diameter**3 * difference
    return buoyancy * density * gas.heat_capacity(mean) / (mean * viscosity * conductivity)


def _continuum_conductance(flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
    """Continuum heat loss per relative temperature excess [W]; [Lu2023]_ Eqs. (5) and (7)."""
    rayleigh = rayleigh_number(flyer, state, excess)
    # the fourth root has no derivative at zero; its product with the excess there is zero
    still = rayleigh == 0.0
    fourth_root = jnp.where(still, 0.0, jnp.sqrt(jnp.sqrt(jnp.where(still, 1.0, rayleigh))))
    nusselt = _DISK_NUSSELT + _CONVECTION * fourth_root
    conductivity = state.gas.conductivity(_mean_temperature(state, excess))
    return nusselt * jnp.pi * flyer.radius * conductivity * state.temperature


def _creep_stiffness(
    flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric, creep_temperature: Numeric
) -> Array:
    r"""Continuum force per relative temperature excess and TAC difference [N].

    .. math:: \frac{F_\mathrm{cont}}{\Delta\alpha\,\theta} = 16\mu \cdot 6\kappa_s \frac\mu\rho
        \cdot \frac{T_h\kappa}{r p\bar v}\cdot\frac{\gamma-1}{\gamma+1}\cdot\frac1{\bar\alpha}

    [Lu2023]_ Eq. (20), with the factor μ that its misprint lost and the temperature that the
    reading chooses for :math:`T_h`.
    """
    mean, gas = _mean_temperature(state, excess), state.gas
    viscosity = gas.viscosity(mean)
    kinematic = viscosity / gas.density(state.pressure, mean)
    creep = 16.0 * viscosity * 6.0 * _THERMAL_CREEP * kinematic
    flux = creep_temperature * gas.conductivity(mean)
    thermal = flux / (flyer.radius * state.pressure * gas.mean_speed(mean))
    internal_modes = (gas.heat_capacity_ratio - 1.0) / (gas.heat_capacity_ratio + 1.0)
    return creep * thermal * internal_modes / flyer.film.tac_mean
