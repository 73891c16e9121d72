"""What the models of hollow bodies as pumps share."""

import abc
from collections.abc import Mapping
from typing import ClassVar

from lightflyer.array.namespace import Array, Numeric
from lightflyer.core.entry_point import entry_point
from lightflyer.core.validity import Looks
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.hollow import HollowBody
from lightflyer.force.base import AbstractForceModel, ModelResult
from lightflyer.force.pumps.hollow_flow import (
    EXACT,
    FLOW_RESULTS,
    Corrections,
    Errors,
    pump_force,
    pump_ranges,
    pump_results,
)
from lightflyer.force.pumps.hollow_heat import pump_heat


class AbstractHollowModel(AbstractForceModel):
    """The published model with some corrections, or none."""

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (HollowBody,)
    results: ClassVar[Mapping[str, ModelResult]] = FLOW_RESULTS

    @property
    @abc.abstractmethod
    def corrections(self) -> Corrections:
        """What is on."""

    @property
    def errors(self) -> Errors:
        """Factors of what the model may be off by."""
        return EXACT

    @entry_point
    def heat_loss(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        return pump_heat(flyer, state, unknowns, self.corrections, self.errors)

    @entry_point
    def force(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> Array:
        return pump_force(flyer, state, unknowns, self.corrections, self.errors)

    @entry_point
    def own_results(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        return pump_results(flyer, state, unknowns, self.corrections, self.errors)

    def ranges(
        self,
        flyer: HollowBody,
        state: EnvironmentState,
        temperature: Numeric,  # noqa: ARG002
    ) -> Looks:
        return pump_ranges(flyer, state, self.corrections)
