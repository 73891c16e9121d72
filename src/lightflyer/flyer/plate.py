"""The nanocardboard plate: two films joined by the walls of open channels."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import field
from lightflyer.core.quantity import (
    ArealDensity,
    Conductivity,
    Contradictions,
    Density,
    Distance,
    Length,
    Mass,
    Modulus,
    Radius,
)
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import DIAMETER, Spelling
from lightflyer.film.optics.waves import narrow_channels
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.base import AbstractThinFlyer, FlyerSection
from lightflyer.flyer.hanging import Hanging, hangs_wrongly
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.flyer.shape import OF_SANDWICHES, Bent, Core, Shape
from lightflyer.flyer.sheets import net_gains, sheet_in_light
from lightflyer.gas.molecules import slot_transmission

SHEAR_MODULUS = 5.6e10  # of alumina, by data/mechanics.toml [Pa]


class Plate(AbstractThinFlyer):
    r"""A plate of two films, whose open channels have walls that join the films.

    Seen from above the channels are rectangles in rows, with film between them. Light passes the
    upper film and warms the lower one. Gas creeps through the channels towards the warmer side,
    and its pressure there lifts the plate.

    Attributes
    ----------
    top, bottom : FilmProperties
        Films of the upper and the lower face where they are solid; their transmittances count.
        Each has a top and a bottom face.
    radius : array
        Of the plate, or of a disk of the same area [m].
    channel_width, channel_length : array
        Short and long side of a channel, along the faces [m].
    spacing : array
        Width of the film between two channels [m].
    height : array
        From face to face: length of the channels in the direction of the flow [m].
    wall_thickness : array
        Of the channels' walls [m].
    wall_conductivity : array
        Thermal conductivity of the walls [W/(m K)].
    payload : array
        Mass carried beside the plate's own [kg].
    attitude : Attitude or None
        How the plate lies; None stands for level.
    wall_density : array or None
        Density of the walls [kg/m³]; None neglects their mass.
    wall_shear_modulus : array or None
        Shear modulus of the walls [Pa]; None is that of alumina.
    hanging_radius : array or None
        Of the circle from which the payload hangs [m]; None is the middle.
    hanging : {"circle", "three points"}
        Whether it hangs all around the circle, or at three points of it.
    areal_density : array or None
        Of the whole plate, where it was weighed [kg/m²]; None takes films and walls together.

    Raises
    ------
    ParameterError
        If a concrete number is impossible, or does not fit the others.

    References
    ----------
    [Cortes2020]_

    Examples
    --------
    >>> film = FilmProperties(1.5e-4, 0.02, 0.1, 0.1, 0.8, 0.8, transmittance=0.9)
    >>> plate = Plate(film, film, 4e-3, 50e-6, 500e-6, 50e-6, 100e-6, 50e-9, 1.8, wall_density=3e3)
    >>> print(f"{plate.describe()}, {plate.open_fraction:.4f}, {plate.own_mass * 1e9:.2f} µg")
    plate of 8 mm, 0.4545, 23.30 µg
    """

    nodes: ClassVar[tuple[str, ...]] = ("top", "bottom")
    lifted_by: ClassVar[str] = "gas that creeps through its channels towards the warmer film"
    drag_law: ClassVar[str] = (
        "of a thin disk by the kinetic equation, less the molecules that pass, with inertia"
    )
    shown_unit: ClassVar[str] = "mm"

    top: FilmProperties
    bottom: FilmProperties
    radius: Radius
    channel_width: Length
    channel_length: Length
    spacing: Length
    height: Length
    wall_thickness: Length
    wall_conductivity: Conductivity
    payload: Mass = 0.0
    attitude: Attitude | None = None
    wall_density: Density | None = None
    areal_density: ArealDensity | None = None
    wall_shear_modulus: Modulus | None = None
    hanging_radius: Distance | None = None
    hanging: Hanging = field(static=True, default="circle")

    @staticmethod
    def contradiction(
        radius: Numeric,
        channel_width: Numeric,
        channel_length: Numeric,
        spacing: Numeric,
        wall_thickness: Numeric,
        hanging_radius: Numeric | None,
        hanging: Hanging,
    ) -> Contradictions:
        """How sizes contradict each other."""
        short = channel_length < channel_width
        yield short, "channel_length is the long side of a channel: at least its channel_width"
        wide = channel_length + spacing > 2.0 * radius
        yield wide, "channel_length and spacing together must not exceed the plate's diameter"
        meet = 2.0 * wall_thickness >= spacing
        yield (
            meet,
            "wall_thickness must be less than half of spacing: neighbouring walls would meet",
        )
        yield from hangs_wrongly(radius, hanging_radius, hanging)

    @property
    def faces(self) -> tuple[FilmProperties, FilmProperties]:
        return self.top, self.bottom

    @property
    def widest_holes(self) -> tuple[Numeric, Numeric]:
        return 0.5 * self.channel_width, self.open_fraction

    @property
    def cell_area(self) -> Numeric:
        """Area of one channel with the film around it [m²]."""
        return (self.channel_width + self.spacing) * (self.channel_length + self.spacing)

    @property
    def open_fraction(self) -> Numeric:
        """Share of the area that is channels [1]."""
        return self.channel_width * self.channel_length / self.cell_area

    @property
    def solid_fraction(self) -> Numeric:
        """Share of the area that is film [1]."""
        return 1.0 - self.open_fraction

    @property
    def wall_fraction(self) -> Numeric:
        """Share of the area that the walls' cross section takes [1]."""
        around = 2.0 * (self.channel_width + self.channel_length)
        return around * self.wall_thickness / self.cell_area

    @property
    def sheets(self) -> Sandwich:
        """The two films and what holds them apart, without what flows through."""
        return Sandwich(
            top=self.top,
            bottom=self.bottom,
            radius=self.radius,
            gap=self.height,
            open_fraction=self.open_fraction,
            hole_radius=0.5 * self.channel_width,
            support_fraction=self.wall_fraction,
            support_conductivity=self.wall_conductivity,
            payload=self.payload,
            attitude=self.attitude,
            support_density=self.wall_density,
            hanging_radius=self.hanging_radius,
            hanging=self.hanging,
        )

    @property
    def own_mass(self) -> Numeric:
        """Mass of films and walls, or what was weighed [kg]."""
        if self.areal_density is not None:
            return self.area * self.areal_density
        return self.sheets.own_mass

    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        # Light on the top face that enters a channel leaves it at the other end.
        light = state.radiation.on_faces(self.attitude)
        solid = self.solid_fraction * self.area
        top, bottom = (sheet_in_light(film, 0.0) for film in (self.top, self.bottom))
        above = net_gains(top, bottom, light.beam_top, 0.0)
        top, bottom = (sheet_in_light(film, self.open_fraction) for film in (self.top, self.bottom))
        below = net_gains(top, bottom, 0.0, light.beam_bottom)
        return (
            solid * above[0] + self.area * below[0],
            solid * above[1] + self.area * below[1],
        )

    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        return self.sheets.heat_gains(state)

    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        # Radiation, and conduction through the walls of the channels.
        return self.sheets.heat_losses(state, unknowns)

    @property
    def known_shape(self) -> tuple[str, ...]:
        return () if None in (self.top.laminate, self.bottom.laminate) else OF_SANDWICHES

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,  # noqa: ARG002
    ) -> Shape:
        return self.sheets.shape_on(self._walls, state, temperatures, lift)

    def bent(self, state: EnvironmentState, temperatures: tuple[Array, ...]) -> Bent:
        return self.sheets.bent_on(self._walls, state, temperatures)

    @property
    def _walls(self) -> Core | None:
        """The channels' walls, None where the films' layers are not known."""
        if not self.known_shape:
            return None
        # walls along the shear, half of all, stay plane
        given = self.wall_shear_modulus
        modulus = SHEAR_MODULUS if given is None else given
        shear = 0.5 * self.wall_fraction * modulus * self.height
        return Core(shear, 0.5 * self.spacing, self.channel_length + self.spacing)

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        """Excess in vacuum, by the outer faces alone [1]."""
        return self.sheets.highest_excess(state, power)

    def diagnostics(self, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Warns of channels that are too narrow for geometric optics."""
        coldest = np.minimum(np.min(state.temperature), np.min(temperature))
        return tuple(narrow_channels(self.channel_width, self.channel_length, coldest))

    @property
    def passing_share(self) -> Array:
        length = self.height / self.channel_width
        return self.open_fraction * slot_transmission(length).through


class PlateSection(FlyerSection, of=Plate):
    """``[flyer]``: a plate, with its films in ``[flyer.top]`` and ``[flyer.bottom]``."""

    default_model: ClassVar[str] = "channel-pump"
    spelled: ClassVar[Mapping[str, Spelling]] = {"radius": DIAMETER}

    shape: Literal["plate"]
