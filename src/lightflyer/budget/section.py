"""``[payload]`` of a flyer file: what the payload consists of."""

import pydantic

from lightflyer.budget.link import REQUIRED_SIGNAL_DB, RadioLink
from lightflyer.budget.payload import Budget, Item, SolarCells
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import (
    ArealDensity,
    DataRate,
    Decibels,
    Efficiency,
    Fraction,
    Frequency,
    LinkDistance,
    Mass,
    Power,
    Temperature,
)
from lightflyer.foundation.section import Section
from lightflyer.foundation.units import Measured


class ItemSection(Section):
    """An entry of ``items``."""

    name: str = pydantic.Field(min_length=1)
    mass: Mass = Measured(0.0)
    power: Power = Measured(0.0)
    duty: Fraction = Measured(1.0)

    def build(self) -> Item:
        """The item."""
        return Item(self.name, self.mass.value, self.power.value, self.duty.value)


class CellsSection(Section):
    """``[payload.cells]``: solar cells that feed the payload."""

    efficiency: Efficiency
    areal_density: ArealDensity
    conversion: Efficiency = Measured(1.0)

    def build(self) -> SolarCells:
        """The cells."""
        return SolarCells(self.efficiency.value, self.areal_density.value, self.conversion.value)


class LinkSection(Section):
    """``[payload.link]``: a radio link."""

    range: LinkDistance
    frequency: Frequency
    data_rate: DataRate
    noise_temperature: Temperature
    transmit_gain_dbi: Decibels = Measured(0.0)
    receive_gain_dbi: Decibels = Measured(0.0)
    required_signal_db: Decibels = Measured(REQUIRED_SIGNAL_DB)
    losses_db: Decibels = Measured(0.0)
    margin_db: Decibels = Measured(3.0)
    efficiency: Efficiency = Measured(0.3)
    duty: Fraction = Measured(1.0)

    def build(self) -> RadioLink:
        """The link."""
        names = [name for name in type(self).model_fields if name != "range"]
        return RadioLink(self.range.value, **{name: getattr(self, name).value for name in names})


class PayloadSection(Section):
    """``[payload]``: what a payload needs, set beside what the flyer carries."""

    items: tuple[ItemSection, ...] = ()
    reserve: Fraction = Measured(0.0)
    cells: CellsSection | None = None
    link: LinkSection | None = None

    @pydantic.model_validator(mode="after")
    def _is_something(self) -> "PayloadSection":
        if not self.items and self.link is None:
            raise ConfigurationError("a payload needs items or a link")
        names = [item.name for item in self.items]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise ConfigurationError(f'two items have the name "{twice}"')
        return self

    def build(self) -> Budget:
        """The budget."""
        return Budget(
            tuple(item.build() for item in self.items),
            None if self.cells is None else self.cells.build(),
            None if self.link is None else self.link.build(),
            self.reserve.value,
        )
