"""Budget of a payload: what its parts weigh and take, its radio link, the cells that feed it."""

from collections.abc import Mapping
from typing import ClassVar, NamedTuple

import numpy as np
import pydantic

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field, short_repr
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import (
    ArealDensity,
    Checked,
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
from lightflyer.environment.radiation import Attitude, Radiation
from lightflyer.files.section import Section, Spelling

REQUIRED_SIGNAL_DB = 9.6
"""Energy per bit over noise density [dB] at which one bit in 1e5 is wrong: coherent detection of
two phases without coding, :math:`\\tfrac12\\operatorname{erfc}\\sqrt{E_b/N_0}`."""


@entry_point
def free_space_loss(distance: LinkDistance, frequency: Frequency) -> Array:
    r"""Power sent over power received between antennas without gain in free space.

    .. math:: L = \left(\frac{4\pi d f}{c}\right)^2

    Parameters
    ----------
    distance, frequency : array, shape (...)
        [m], [Hz].

    Returns
    -------
    array, broadcast shape
        [1].

    Notes
    -----
    H. T. Friis, Proc. IRE 34, 254 (1946).

    Examples
    --------
    >>> import math
    >>> print(f"{10.0 * math.log10(free_space_loss(30e3, 434e6)):.2f} dB")
    114.74 dB
    """
    return (4.0 * np.pi * distance * frequency / constants.SPEED_OF_LIGHT) ** 2


class RadioLink(Checked):
    r"""A transmitter on the flyer and a receiver elsewhere.

    .. math:: P = k_B T R\,\frac{E_b}{N_0}\,\frac{L\,L_0\,m}{G_t G_r}


    Raises
    ------
    ParameterError
        If a concrete number is out of range.

    Notes
    -----
    Free space without obstacle, reflection from the ground and horizon. What electronics take
    that does not send belongs to an item of the budget.
    """

    distance: LinkDistance  #: Between the antennas, d [m]
    frequency: Frequency  #: [Hz]
    data_rate: DataRate  #: R while it sends [bit/s]
    noise_temperature: Temperature  #: Of receiver and sky together, T [K]
    #: Of the antennas [dB over one that sends evenly in all directions]
    transmit_gain_dbi: Decibels = 0.0
    receive_gain_dbi: Decibels = 0.0  #: As ``transmit_gain_dbi``
    #: Energy per bit over noise density at the receiver, :math:`E_b/N_0` [dB]
    required_signal_db: Decibels = REQUIRED_SIGNAL_DB
    losses_db: Decibels = 0.0  #: Of cables, air, pointing and polarisation, :math:`L_0` [dB]
    margin_db: Decibels = 3.0  #: m [dB]
    efficiency: Efficiency = 0.3  #: Power sent over power that the transmitter takes [1]
    duty: Fraction = 1.0  #: Share of the time in which it sends [1]

    def transmit_power(self) -> Array:
        """Power that the antenna sends while it sends [W]."""
        return _transmit_power(self)

    def consumed_power(self) -> Array:
        """Mean power that the transmitter takes [W]."""
        return self.transmit_power() * self.duty / self.efficiency

    def describe(self) -> str:
        """The link in words, with its numbers."""
        return (
            f"radio link: {float(self.data_rate):g} bit/s over {float(self.distance) / 1e3:g} km "
            f"at {float(self.frequency) / 1e6:g} MHz, {float(self.noise_temperature):g} K, gains "
            f"{float(self.transmit_gain_dbi):g} and {float(self.receive_gain_dbi):g} dB, losses "
            f"{float(self.losses_db):g} dB, margin {float(self.margin_db):g} dB, "
            f"{100.0 * float(self.duty):g} % of the time"
        )


@entry_point
def _transmit_power(link: RadioLink) -> Array:
    noise = constants.BOLTZMANN * link.noise_temperature * link.data_rate
    decibels = (
        link.required_signal_db
        + link.losses_db
        + link.margin_db
        - link.transmit_gain_dbi
        - link.receive_gain_dbi
    )
    return (
        noise
        * xp.power(10.0, 0.1 * xp.asarray(decibels))
        * free_space_loss(link.distance, link.frequency)
    )


class Item(Checked):
    """A part of the payload.

    Attributes
    ----------
    name : str
    mass : array
        [kg].
    power : array
        That it takes while it runs [W].
    duty : array
        Share of the time in which it runs [1].
    """

    name: str = field(static=True)
    mass: Mass = 0.0
    power: Power = 0.0
    duty: Fraction = 1.0

    @property
    def mean_power(self) -> Numeric:
        """Power, mean over time [W]."""
        return self.power * self.duty


class SolarCells(Checked):
    """Solar cells that lie level on the flyer, facing up as its top face does.

    Attributes
    ----------
    efficiency : array
        Electric power over light on them [1].
    areal_density : array
        Mass per area, with substrate and wires [kg/m²].
    conversion : array
        Power that reaches the parts over power of the cells [1].
    """

    efficiency: Efficiency
    areal_density: ArealDensity
    conversion: Efficiency = 1.0


class Needs(NamedTuple):
    """What a payload needs in some light."""

    mass: Array  #: With cells and reserve [kg]; infinite without light, where cells must feed it
    power: Array  #: Mean over time, with reserve [W]
    cell_area: Array  #: [m²]; zero without cells
    transmit_power: Array  #: [W]; zero without a link

    def __repr__(self) -> str:
        return short_repr(self)


class Budget(Checked):
    """What a payload consists of.

    Attributes
    ----------
    items : tuple of Item
    cells : SolarCells or None
        That feed it; None for a payload whose power comes from its items, such as a battery.
    link : RadioLink or None
    reserve : array
        Added share of all masses and powers [1].

    Raises
    ------
    ParameterError
        If there is nothing in it, or two items have one name.

    Notes
    -----
    Plain sums: nothing is stored, so that power is that of the light at hand. Cells lie in full
    light; they neither shade the flyer's film nor are shaded by it, and their heat is left out.

    Examples
    --------
    >>> budget = Budget(
    ...     (Item("sensor", mass=2e-8, power=1e-4, duty=0.1),), SolarCells(0.2, 0.5)
    ... )
    >>> needs = budget.needs(light=589.0)
    >>> print(f"{needs.mass * 1e9:.1f} µg, {needs.power * 1e6:.0f} µW")
    62.4 µg, 10 µW
    """

    items: tuple[Item, ...] = field(default=())
    cells: SolarCells | None = None
    link: RadioLink | None = None
    reserve: Fraction = 0.0

    @staticmethod
    def contradiction(items: tuple[Item, ...], link: RadioLink | None) -> str | None:
        """What a payload lacks, or has twice, or None."""
        names = [item.name for item in items]
        if not names and link is None:
            return "a payload needs items or a link"
        twice = next((name for name in names if names.count(name) > 1), None)
        return None if twice is None else f'two items have the name "{twice}"'

    def needs(self, light: Numeric) -> Needs:
        """What the payload needs; of the broadcast shape."""
        return _needs(self, light)

    def describe(self) -> tuple[str, ...]:
        """What is in it, in short texts with units."""
        told = [
            f"{item.name} {float(item.mass) * 1e6:.4g} mg"
            + (f" {float(item.mean_power) * 1e6:.4g} µW" if float(item.power) else "")
            for item in self.items
        ]
        if self.cells is not None:
            told.append(
                f"solar cells of {100.0 * float(self.cells.efficiency):.4g} % and "
                f"{float(self.cells.areal_density) * 1e3:.4g} g/m², level, in full light, of no "
                "effect on the flyer"
            )
        reserve = f", reserve {100.0 * float(self.reserve):.4g} %" if float(self.reserve) else ""
        texts = [f"payload needs: {', '.join(told)}{reserve}"] if told else []
        if self.link is not None:
            texts.append(self.link.describe())
        return tuple(texts)


@entry_point
def _needs(budget: Budget, light: Numeric) -> Needs:
    link, cells, more = budget.link, budget.cells, 1.0 + budget.reserve
    zero = 0.0 * xp.asarray(light)
    sent = zero if link is None else link.transmit_power() + zero
    power = sum((item.mean_power for item in budget.items), zero)
    power = more * (power if link is None else power + link.consumed_power())
    mass = more * sum((item.mass for item in budget.items), zero)
    if cells is None:
        return Needs(mass, power, zero, sent)
    dark = light <= 0.0
    per_area = cells.efficiency * cells.conversion * xp.where(dark, 1.0, light)
    area = xp.where(dark & (power > 0.0), np.inf, power / per_area)
    return Needs(mass + cells.areal_density * area, power, area, sent)


@entry_point
def light_on_cells(radiation: Radiation, attitude: Attitude | None) -> Array:
    """Irradiance of cells that face as a flyer's top face does [W/m²]."""
    faces = radiation.on_faces(attitude)
    return xp.asarray(radiation.irradiance * faces.beam_top + faces.diffuse_top)


class ItemSection(Section, of=Item):
    """An entry of ``items``."""

    name: str = pydantic.Field(min_length=1)


class CellsSection(Section, of=SolarCells):
    """``[payload.cells]``: solar cells that feed the payload."""


class LinkSection(Section, of=RadioLink):
    """``[payload.link]``: a radio link."""

    spelled: ClassVar[Mapping[str, Spelling]] = {"distance": Spelling("range")}


class PayloadSection(Section, of=Budget):
    """``[payload]``: what a payload needs, set beside what the flyer carries."""

    first_keys: ClassVar[tuple[str, ...]] = ("items", "reserve")

    items: tuple[ItemSection, ...] = ()
    cells: CellsSection | None = None
    link: LinkSection | None = None

    def build(self) -> Budget:
        """The budget."""
        return self.make()
