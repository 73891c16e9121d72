"""The limit of gas so thin that molecules meet the flyer and not each other."""

import math
from typing import ClassVar, Literal

from lightflyer.array.namespace import Array, Numeric
from lightflyer.core.entry_point import entry_point
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel, ForceSection
from lightflyer.force.laws.faces import accommodated_force, free_molecular_conductance, linear_force
from lightflyer.gas.base import knudsen_number

# by the kinetic force, collisions take 1 % at Kn 10
_THIN = Validity(
    "the Knudsen number", 10.0, math.inf, "collisions, which this model leaves out, matter there"
)
# where the force of small differences is 20 % too large
_SMALL_DIFFERENCES = Validity(
    "T_h/T_c", 0.0, 1.57, "free-molecular-linear is for small differences; take free-molecular"
)


def disk_conductance(disk: Disk, state: EnvironmentState, excess: Numeric) -> Array:
    """Free-molecular heat loss of both faces per relative temperature excess [W]."""
    return free_molecular_conductance(
        2.0 * disk.area,
        disk.film.tac_mean,
        state.pressure,
        state.gas.mean_speed(state.temperature),
        state.gas.heat_capacity_ratio_at(state.temperature * (1.0 + 0.5 * excess)),
    )


class AbstractFreeMolecular(AbstractForceModel):
    """Heat that free molecules take from a disk, which both models share."""

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Disk,)
    feels_walls: ClassVar[bool] = False

    @entry_point
    def heat_loss(
        self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        (excess,) = unknowns
        return (disk_conductance(flyer, state, excess) * excess,)

    def ranges(self, flyer: Disk, state: EnvironmentState, temperature: Numeric) -> Looks:
        yield _THIN, knudsen_number(state.pressure, state.temperature, flyer.radius, state.gas)


class FreeMolecular(AbstractFreeMolecular):
    r"""Free-molecular heat loss and force of a disk, exact for any temperature difference.

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
    def force(self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        (excess,) = unknowns
        film = flyer.film
        faces = (film.tac_top, film.tac_bottom)
        return accommodated_force(flyer.area, *faces, state.pressure, excess)


class LinearFreeMolecular(AbstractFreeMolecular):
    r"""Free-molecular force of a disk to first order in the temperature difference.

    .. math:: F = A\,p\,\Delta\alpha\,\frac{\Delta T}{4T_c}

    The heat loss is that of :class:`FreeMolecular`, which is linear already. The force is 20 %
    too large at θ = 0.57 and 40 % at θ = 1.2.

    References
    ----------
    [Lu2023]_ Eqs. (4) and (19).
    """

    @entry_point
    def force(self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        (excess,) = unknowns
        return linear_force(flyer.area, flyer.film.tac_difference, state.pressure, excess)

    def ranges(self, flyer: Disk, state: EnvironmentState, temperature: Numeric) -> Looks:
        yield from super().ranges(flyer, state, temperature)
        yield _SMALL_DIFFERENCES, temperature / state.temperature


class FreeMolecularSection(ForceSection, of=FreeMolecular):
    """``[force]``: the exact free-molecular limit."""

    model: Literal["free-molecular"]


class LinearFreeMolecularSection(ForceSection, of=LinearFreeMolecular):
    """``[force]``: the free-molecular limit for small temperature differences."""

    model: Literal["free-molecular-linear"]
