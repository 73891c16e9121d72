"""Hollow bodies as pumps: the published model, corrected."""

from collections.abc import Mapping
from typing import ClassVar, Literal

import equinox as eqx
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.hollow import HollowBody
from lightflyer.force.base import AbstractForceModel, ModelResult
from lightflyer.force.hollow_flow import (
    FLOW_RESULTS,
    Corrections,
    caveats_of_pump,
    pump_force,
    pump_results,
)
from lightflyer.force.hollow_heat import pump_heat
from lightflyer.force.section import ForceSection
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric


class HollowPump(AbstractForceModel):
    """Force and heat of a hollow body from thin gas to the continuum.

    Each of its eight corrections to :class:`~lightflyer.Celenza2023` is on, unless it is switched
    off. With all of them off it is that model.

    Attributes
    ----------
    short_channels : bool
        (1) The entrances of the channels resist, and what drives the flow is the temperature of the
        gas that comes to them.
    projected_light : bool
        (2) Light falls on the area seen from its source, and is absorbed as the films do.
    energy_balance : bool
        (3) Both films radiate, the outer one is cooled by the gas, and gas that flows takes heat.
    viscous_outlet : bool
        (4) Slow and thin gas is held back at the outlet.
    rarefied_force : bool
        (5) The drag of thin gas, and the recoil of free molecules.
    channel_coefficients : bool
        (6) The flow in channels follows from the kinetic equation.
    gas_properties : bool
        (7) Conductivity and viscosity are those of the gas at its temperature.
    jet_density : bool
        (8) The jet is as warm as the inner film.

    Notes
    -----
    The gas within has the temperature of the inner film. The drag and jet coefficients were fitted
    to simulations of dense gas; :meth:`caveats` says where it is not.

    References
    ----------
    [Celenza2023]_ for the equations that are corrected.
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (HollowBody,)
    results: ClassVar[Mapping[str, ModelResult]] = FLOW_RESULTS

    short_channels: bool = eqx.field(static=True, default=True)
    projected_light: bool = eqx.field(static=True, default=True)
    energy_balance: bool = eqx.field(static=True, default=True)
    viscous_outlet: bool = eqx.field(static=True, default=True)
    rarefied_force: bool = eqx.field(static=True, default=True)
    channel_coefficients: bool = eqx.field(static=True, default=True)
    gas_properties: bool = eqx.field(static=True, default=True)
    jet_density: bool = eqx.field(static=True, default=True)

    @property
    def corrections(self) -> Corrections:
        """What is on."""
        return Corrections(*(getattr(self, name) for name in Corrections._fields))

    @entry_point
    def heat_loss(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """See :meth:`AbstractForceModel.heat_loss`."""
        return pump_heat(flyer, state, unknowns, self.corrections)

    @entry_point
    def force(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        return pump_force(flyer, state, unknowns, self.corrections)

    @entry_point
    def own_results(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        """See :meth:`AbstractForceModel.own_results`."""
        return pump_results(flyer, state, unknowns, self.corrections)

    def caveats(
        self,
        flyer: HollowBody,
        state: EnvironmentState,
        temperature: Numeric,  # noqa: ARG002
    ) -> tuple[str, ...]:
        """See :meth:`AbstractForceModel.caveats`."""
        return caveats_of_pump(flyer, state, self.corrections)


class HollowPumpSection(ForceSection):
    """``[force]``: hollow bodies as pumps, each correction on unless told otherwise."""

    model_type: ClassVar[type[AbstractForceModel]] = HollowPump

    model: Literal["hollow-pump"]
    short_channels: bool = True
    projected_light: bool = True
    energy_balance: bool = True
    viscous_outlet: bool = True
    rarefied_force: bool = True
    channel_coefficients: bool = True
    gas_properties: bool = True
    jet_density: bool = True

    def build(self) -> HollowPump:
        """The force model."""
        return HollowPump(*(getattr(self, name) for name in Corrections._fields))
