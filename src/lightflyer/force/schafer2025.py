r"""The sandwich's model of Schafer et al.: simulations of a perforated disk, two temperatures."""

from collections.abc import Iterator
from typing import ClassVar, Literal

import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.gap import accommodation_between, gap_conductance
from lightflyer.force.schafer2025_table import (
    HIGHEST_OPEN_FRACTION,
    HIGHEST_RAREFACTION,
    HeatRatios,
    internal_factors,
    perforated_disk_fit,
)
from lightflyer.force.section import ForceSection
from lightflyer.force.validity import Validity
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.base import AbstractGas, mean_free_path

_WIDE_GAP = 2.0
"""Gap over hole radius up to which holes count as being above each other: one hole diameter."""

_DENSE = Validity(
    "the rarefaction parameter",
    0.0,
    HIGHEST_RAREFACTION,
    "the simulations of schafer2025 end there, and force and heat loss are extrapolated",
)
_HOLES = Validity(
    "hole_radius over the mean free path",
    0.0,
    1.0,
    "schafer2025 takes free molecules in the holes",
)
_GAP = Validity(
    "gap over the mean free path", 0.0, 1.0, "schafer2025 takes free molecules in the gap"
)


def rarefaction(
    radius: Numeric, pressure: Numeric, temperature: Numeric, gas: AbstractGas
) -> Array:
    r"""Rarefaction parameter of a disk.

    .. math:: \delta = \frac{p\,a}{\mu\sqrt{2RT}} = \frac{\sqrt\pi}{2}\,\frac{a}{\lambda}

    Parameters
    ----------
    radius, pressure, temperature : array, shape (...)
        Of the disk [m]; of the gas [Pa], [K].
    gas : AbstractGas

    Returns
    -------
    array, broadcast shape
        [1].
    """
    speed = jnp.sqrt(2.0 * gas.specific_gas_constant * temperature)
    return pressure * radius / (gas.viscosity(temperature) * speed)


def perforated_disk_force(
    area: Numeric,
    open_fraction: Numeric,
    rarefaction: Numeric,
    pressure: Numeric,
    excess_top: Numeric,
    excess_bottom: Numeric,
) -> Array:
    r"""Force on a thin disk with holes whose faces have temperatures of their own.

    .. math::
        F = \frac{pA}{2}\,s\,\hat F(\beta,\delta)
            \left[\sqrt{1+\theta_b}-\sqrt{1+\theta_t}\right]

    Parameters
    ----------
    area : array, shape (...)
        Of the outline, holes included [m²].
    open_fraction, rarefaction : array, shape (...)
        :math:`\beta = 1 - s` and :math:`\delta` [1].
    pressure : array, shape (...)
        [Pa].
    excess_top, excess_bottom : array, shape (...)
        Relative temperature excess of each face [1].

    Returns
    -------
    array, broadcast shape
        Towards the top positive [N]; exact for free molecules.

    References
    ----------
    [Schafer2025]_
    """
    ratio = perforated_disk_fit().force_ratio(open_fraction, rarefaction)
    roots = jnp.sqrt(1.0 + excess_bottom) + jnp.sqrt(1.0 + excess_top)
    # the difference of the roots, written without cancellation
    difference = (excess_bottom - excess_top) / roots
    return 0.5 * pressure * area * (1.0 - open_fraction) * ratio * difference


def perforated_disk_conductances(
    area: Numeric,
    open_fraction: Numeric,
    rarefaction: Numeric,
    *,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
) -> HeatRatios:
    r"""Heat that the gas takes from the faces of a thin disk with holes.

    .. math:: Q_i = G_\mathrm{own}\,\theta_i + G_\mathrm{cross}\,\theta_j

    Parameters
    ----------
    area : array, shape (...)
        Of the outline, holes included [m²].
    open_fraction, rarefaction : array, shape (...)
        [1].
    pressure, temperature : array, shape (...)
        Of the gas [Pa], [K].
    gas : AbstractGas
        Of any kind: the table is for gas without internal motion, to which
        :func:`~lightflyer.force.schafer2025_table.internal_factors` adds it.

    Returns
    -------
    HeatRatios
        Own and cross conductance per relative temperature excess [W].

    References
    ----------
    [Schafer2025]_
    """
    factors = internal_factors(
        gas.heat_capacity_ratio,
        gas.specific_gas_constant,
        gas.viscosity(temperature),
        gas.conductivity(temperature),
    )
    ratios = perforated_disk_fit().heat_ratios(open_fraction, rarefaction, *factors)
    # p √(2RT) A/√π, of which free molecules without internal motion take θ
    scale = 0.5 * pressure * gas.mean_speed(temperature) * area
    return HeatRatios(scale * ratios.own, scale * ratios.cross)


class Schafer2025(AbstractForceModel):
    r"""Force and heat loss of a sandwich by simulations of a perforated disk.

    Outside, the sandwich is taken for one thin disk with holes whose top face has the upper
    membrane's temperature and whose bottom face the lower one's. Between the membranes heat flows
    through gas.

    Notes
    -----
    The simulations are for complete accommodation: the TACs of the two outer faces have no effect.
    Those of the two inner faces enter the conduction in the gap.

    They are for a disk of no thickness whose holes let a molecule through or not, at random: holes
    and gap much narrower than the mean free path, the holes of both membranes above each other.
    :meth:`caveats` says where that does not hold.

    The table ends at rarefactions 0.1 and 200, and at an open fraction of 0.95. In thinner gas the
    fit goes over into the exact limit of free molecules, in denser gas force and heat loss go on
    as the inverse of the rarefaction.

    It was computed in helium. The force is taken for that in any gas of the same rarefaction; the
    heat loss is corrected for what the molecules' internal motion carries.

    References
    ----------
    [Schafer2025]_
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Sandwich,)

    @entry_point
    def heat_loss(
        self, flyer: Sandwich, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """See :meth:`AbstractForceModel.heat_loss`."""
        top, bottom = unknowns
        outside = perforated_disk_conductances(
            flyer.area,
            flyer.open_fraction,
            _rarefaction(flyer, state),
            pressure=state.pressure,
            temperature=state.temperature,
            gas=state.gas,
        )
        between = gap_conductance(
            flyer.area * flyer.solid_fraction,
            flyer.gap,
            accommodation_between(flyer.top.tac_bottom, flyer.bottom.tac_top),
            pressure=state.pressure,
            temperature=state.temperature,
            mean_speed=state.gas.mean_speed(state.temperature),
            heat_capacity_ratio=state.gas.heat_capacity_ratio,
            conductivity=state.gas.conductivity(state.temperature),
        )
        upward = between * (bottom - top)
        return (
            outside.own * top + outside.cross * bottom - upward,
            outside.own * bottom + outside.cross * top + upward,
        )

    @entry_point
    def force(self, flyer: Sandwich, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        return perforated_disk_force(
            flyer.area, flyer.open_fraction, _rarefaction(flyer, state), state.pressure, *unknowns
        )

    def caveats(
        self,
        flyer: Sandwich,
        state: EnvironmentState,
        temperature: Numeric,  # noqa: ARG002
    ) -> tuple[str, ...]:
        """See :meth:`AbstractForceModel.caveats`."""
        return (*_caveats_of_pressure(flyer, state), *_caveats_of_shape(flyer))


def _rarefaction(flyer: Sandwich, state: EnvironmentState) -> Array:
    return rarefaction(flyer.radius, state.pressure, state.temperature, state.gas)


def _caveats_of_pressure(flyer: Sandwich, state: EnvironmentState) -> Iterator[str]:
    path = mean_free_path(state.pressure, state.temperature, state.gas)
    yield from _DENSE.caveats(_rarefaction(flyer, state), state.pressure)
    yield from _HOLES.caveats(np.asarray(flyer.hole_radius) / path, state.pressure)
    yield from _GAP.caveats(np.asarray(flyer.gap) / path, state.pressure)


def _caveats_of_shape(flyer: Sandwich) -> Iterator[str]:
    width = np.max(np.asarray(flyer.gap) / flyer.hole_radius)
    if width > _WIDE_GAP:
        yield (
            f"gap is {width:.3g} times hole_radius: fewer molecules pass both membranes than "
            "schafer2025 takes, in a wide gap open_fraction/(2 − open_fraction) of them"
        )
    most = np.max(flyer.open_fraction)
    if most > HIGHEST_OPEN_FRACTION:
        yield (
            f"open_fraction = {most:.3g} exceeds {HIGHEST_OPEN_FRACTION:g}, where the simulations "
            "of schafer2025 end"
        )


class Schafer2025Section(ForceSection):
    """``[force]``: simulations of a perforated disk, for a sandwich."""

    model_type: ClassVar[type[AbstractForceModel]] = Schafer2025

    model: Literal["schafer2025"]

    def build(self) -> Schafer2025:
        """The force model."""
        return Schafer2025()
