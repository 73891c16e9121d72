"""Budget of a payload: what its parts weigh and take, and the solar cells that feed them."""

from collections.abc import Callable
from typing import ClassVar, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field, short_repr
from lightflyer.budget.link import RadioLink
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import ArealDensity, Checked, Efficiency, Fraction, Mass, Power
from lightflyer.environment.radiation import Attitude, Radiation


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


def _contradiction(items: tuple[Item, ...], link: RadioLink | None) -> str | None:
    """What a payload lacks, or has twice, or None."""
    names = [item.name for item in items]
    if not names and link is None:
        return "a payload needs items or a link"
    twice = next((name for name in names if names.count(name) > 1), None)
    return None if twice is None else f'two items have the name "{twice}"'


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

    contradiction: ClassVar[Callable[..., str | None]] = staticmethod(_contradiction)

    items: tuple[Item, ...] = field(default=())
    cells: SolarCells | None = None
    link: RadioLink | None = None
    reserve: Fraction = 0.0

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
