r"""The force from kinetic theory: no fitted constants."""

import math
from typing import Any, ClassVar, Literal

import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.free_molecular import disk_conductance
from lightflyer.force.kinetic_table import KineticFit, kinetic_fit
from lightflyer.force.laws import maxwell_force
from lightflyer.force.section import ForceSection
from lightflyer.force.validity import Validity
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.quantity import StandardErrors
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured
from lightflyer.gas.base import knudsen_number

_DENSE = "the kinetic table ends there, and the force is extrapolated by a power law"
_HEATING = "the kinetic table ends there, and its ratios are held"
_TAC = "the kinetic table ends there, and its ratios are held"
_WALL = "the table of walls ends there, and their effect is held"
_APART = 0.3  # TACs further apart change the heat by 1 % at Kn 0.1, which the table leaves out
_DIFFERENCE = "the kinetic table is for small differences"


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

    Notes
    -----
    The table is that of the gas's kind, monatomic or diatomic; other gases are refused.

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

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Disk,)
    molecules: ClassVar[tuple[str, ...]] = ("monatomic", "diatomic")

    force_error: StandardErrors | None = None
    heat_error: StandardErrors | None = None

    @entry_point
    def heat_loss(
        self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """See :meth:`AbstractForceModel.heat_loss`."""
        (excess,) = unknowns
        fit, knudsen = _fit_and_knudsen_number(flyer, state)
        ratio = fit.heat_ratio(knudsen, 1.0 + excess, flyer.film.tac_mean)
        if state.wall_distance is not None:
            ratio *= fit.wall_factors(knudsen, state.wall_distance / flyer.radius)[1]
        if self.heat_error is not None:
            ratio *= 1.0 + self.heat_error * fit.relative_heat_error(knudsen)
        return (ratio * disk_conductance(flyer, state) * excess,)

    @entry_point
    def force(self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        (excess,) = unknowns
        fit, knudsen = _fit_and_knudsen_number(flyer, state)
        ratio = fit.force_ratio(knudsen, 1.0 + excess, flyer.film.tac_mean)
        if state.wall_distance is not None:
            ratio *= fit.wall_factors(knudsen, state.wall_distance / flyer.radius)[0]
        if self.force_error is not None:
            ratio *= 1.0 + self.force_error * fit.relative_force_error(knudsen, ratio)
        free = maxwell_force(flyer.area, flyer.film.tac_difference, state.pressure, excess)
        return ratio * free

    def caveats(
        self, flyer: Disk, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        """See :meth:`AbstractForceModel.caveats`."""
        fit, knudsen = _fit_and_knudsen_number(flyer, state)
        hottest = 1.0 / (1.0 - fit.heating_limit)
        film, pressure = flyer.film, state.pressure
        looks = [
            (Validity("the Knudsen number", fit.knudsen_range[0], math.inf, _DENSE), knudsen),
            (Validity("T_h/T_c", 1.0, hottest, _HEATING), temperature / state.temperature),
            (Validity("the mean TAC", *fit.tac_range, _TAC), film.tac_mean),
            (Validity("the difference of the TACs", -_APART, _APART, _DIFFERENCE),
             film.tac_difference),
        ]  # fmt: skip
        if state.wall_distance is not None:
            near = Validity(
                "the walls' distance over the radius", fit.nearest_wall, math.inf, _WALL
            )
            looks.append((near, state.wall_distance / flyer.radius))
        return tuple(text for range_, value in looks for text in range_.caveats(value, pressure))


def _fit_and_knudsen_number(disk: Disk, state: EnvironmentState) -> tuple[KineticFit, Any]:
    knudsen = knudsen_number(state.pressure, state.temperature, disk.radius, state.gas)
    return kinetic_fit(state.gas.molecules), jnp.asarray(knudsen)


class KineticSection(ForceSection):
    """``[force]``: the kinetic equation, solved; its own error counts unless told otherwise."""

    model_type: ClassVar[type[AbstractForceModel]] = Kinetic

    model: Literal["kinetic"]
    force_error: StandardErrors = Measured(0.0, 1.0)
    heat_error: StandardErrors = Measured(0.0, 1.0)

    def build(self) -> Kinetic:
        """The force model."""
        return Kinetic(self.force_error.value, self.heat_error.value)
