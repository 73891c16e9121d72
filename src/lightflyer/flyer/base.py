"""Base class of flyers, what those of one kind of body share, and ``[flyer]`` of a flyer file."""

import abc
import dataclasses
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import AbstractClassVar, AbstractVar
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Azimuth, Checked, Mass, Tilt
from lightflyer.core.units import Measured, scale_and_offset
from lightflyer.drag.convex import Outline, convex_diagnostics, convex_drag, sphere_outline
from lightflyer.drag.disk import (
    Direction,
    disk_diagnostics,
    disk_drag,
    edgewise_disk_drag,
    wide_hole_diagnostics,
)
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import Alternative
from lightflyer.film.properties import FilmProperties, FilmSection, lowest_limit
from lightflyer.flyer.hanging import THREE_POINTS, Hanging, Held
from lightflyer.flyer.shape import Bent, Shape

HIGHEST_TEMPERATURE = 3000.0
"""Highest temperature of the search [K]: no film survives it, and the gas correlations end
below it."""


class AbstractFlyer(Checked):
    r"""A body with one or several temperatures. Subclasses are final.

    The temperatures, one for each of :attr:`nodes`, are unknowns of the heat balance. They are
    handed to flyers and force models as relative excesses over the gas,
    :math:`\theta_i = (T_i - T_c)/T_c`, in a tuple of arrays in the order of the nodes, which stays
    exact where flyer and gas differ by a microkelvin. Further unknowns of :attr:`flows` follow in
    the same tuple.

    Attributes
    ----------
    nodes : tuple of str
        Names of the temperatures, such as ``("top", "bottom")``.
    flows : tuple of str
        Names of further unknowns, for which the force model gives an equation each.
    drag_law : str
        What :meth:`drag` rests on, in a few words.
    payload : array
        Mass carried beside the flyer's own [kg].
    attitude : Attitude or None
        How the flyer lies; None stands for level.
    """

    nodes: AbstractClassVar[tuple[str, ...]]
    flows: ClassVar[tuple[str, ...]] = ()
    drag_law: ClassVar[str] = "of its own"
    lifted_by: ClassVar[str] = "the gas around it"
    held_pressure: ClassVar[str | None] = None  # The force model's result that its wall holds
    hangs: ClassVar[str | None] = None  # Why nothing can tilt it, where that is so
    steady: ClassVar[bool] = False  # Whether its steady speed is a result, as of particles
    floats: ClassVar[bool] = False  # Whether buoyancy holds it up, and missions let it settle

    if TYPE_CHECKING:
        # a checker takes annotations for the first arguments of every subclass

        @property
        def payload(self) -> Numeric: ...
        @property
        def attitude(self) -> Attitude | None: ...

    else:
        payload: AbstractVar[Mass]
        attitude: AbstractVar[Attitude | None]

    @property
    @abc.abstractmethod
    def area(self) -> Numeric:
        """Area seen from above when level [m²]."""

    @property
    @abc.abstractmethod
    def own_mass(self) -> Numeric:
        """Mass without payload [kg]."""

    @abc.abstractmethod
    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        """Light that each node absorbs, per irradiance of the beam [m²], each shape (...)."""

    @abc.abstractmethod
    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        """Power that each node absorbs beside the beam [W], each shape (...).

        Diffuse light, and heat radiation beyond that of black surroundings at the gas temperature.
        """

    @abc.abstractmethod
    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        """Power that each node gives away, but not to the gas [W]; zero where all excesses are.

        Radiation to black surroundings at the gas temperature, and radiation and conduction to the
        other nodes.
        """

    @abc.abstractmethod
    def describe(self) -> str:
        """Description in a few words, such as ``"disk of 2 cm"``."""

    @property
    def highest_temperature(self) -> Numeric | None:
        """Temperature that all its films withstand [K]; None where it is not known."""
        return lowest_limit([getattr(self, name) for name in self.film_names()])

    @classmethod
    def film_names(cls) -> tuple[str, ...]:
        """Names of the fields that are films."""
        fields = dataclasses.fields(cls)
        return tuple(field.name for field in fields if field.type is FilmProperties)

    @property
    def mass(self) -> Numeric:
        """Mass with payload [kg]."""
        return self.own_mass + self.payload

    @property
    def displaced_volume(self) -> Numeric:
        """Volume of gas that the flyer displaces [m³]; zero for films."""
        return 0.0

    def buoyancy(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Numeric:
        """Weight of the gas that the flyer displaces, less that of the gas it holds [N]; upwards.

        By default that of :attr:`displaced_volume`, the same at every temperature.
        """
        del unknowns
        volume = self.displaced_volume
        if isinstance(volume, float) and volume == 0.0:
            return 0.0
        return state.gas.density(state.pressure, state.temperature) * volume * state.gravity

    def drag(
        self,
        state: EnvironmentState,
        unknowns: tuple[Array, ...],
        speed: Numeric,
        direction: Direction = "broadside",
    ) -> Array:
        """Drag of the gas, on top of its force on the flyer at rest [N]; of the sign of the speed.

        ``speed`` [m/s] is relative to the gas, along the axis (broadside) or across it (edgewise).
        """
        del state, unknowns, speed, direction
        raise ConfigurationError(
            f"{type(self).__name__} has no law of drag: give its class a method drag()"
        )

    def drag_diagnostics(
        self,
        state: EnvironmentState,
        speed: Numeric,
        direction: Direction = "broadside",
        temperature: Numeric | None = None,
    ) -> tuple[str, ...]:
        """Warnings where :meth:`drag` is outside its range or an estimate; arguments are concrete.

        ``temperature`` is that of the hottest node [K]; by default that of the gas.
        """
        del state, speed, direction, temperature
        return ()

    def diagnostics(self, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Warnings where the flyer's own description does not hold, such as its optics.

        ``temperature`` is that of the hottest node [K]; arguments are concrete.
        """
        del state, temperature
        return ()

    @property
    def known_shape(self) -> tuple[str, ...]:
        """What :meth:`shape` knows, by the names of its fields; nothing by default."""
        return ()

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,
    ) -> Shape:
        """How it holds its shape at temperatures of its nodes [K] and a lift [N].

        ``pressure``: within over that outside [Pa], the force model's result :attr:`held_pressure`.
        """
        del state, temperatures, lift, pressure
        raise ConfigurationError(f"{self.describe()}: its layers are not known as a structure")

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        r"""Bound of :math:`|\theta|` [1] when all nodes together absorb a net power [W]."""
        return HIGHEST_TEMPERATURE / state.temperature + 0.0 * power

    def first_guess(self, state: EnvironmentState, excess: Array) -> tuple[Array, ...]:
        """Unknowns from which the search for several begins: nodes, then flows.

        ``excess`` is that of all nodes together, if they had one temperature [1].
        """
        del state
        return (excess,) * len(self.nodes) + (0.0 * excess,) * len(self.flows)


class AbstractThinFlyer(AbstractFlyer):
    """A thin round body of one film or several, with or without holes; its drag is a disk's."""

    shown_unit: ClassVar[str] = "cm"
    """Unit in which it is described."""

    if TYPE_CHECKING:

        @property
        def radius(self) -> Numeric: ...
        @property
        def hanging_radius(self) -> Numeric | None: ...
        @property
        def hanging(self) -> Hanging: ...

    @property
    @abc.abstractmethod
    def faces(self) -> tuple[FilmProperties, FilmProperties]:
        """Films whose top and whose bottom face the gas meets."""

    @property
    def passing_share(self) -> Numeric:
        """Share of the free molecules arriving at the flyer that pass it [1]."""
        return 0.0

    @property
    def widest_holes(self) -> tuple[Numeric, Numeric]:
        """Radius of the holes [m], and their share of the area [1]."""
        return 0.0, 0.0

    @property
    def area(self) -> Numeric:
        """Area of the outline, holes included [m²]."""
        return np.pi * self.radius**2

    def held(self, state: EnvironmentState) -> Held:
        """Its masses, and how its payload hangs."""
        three = self.hanging == THREE_POINTS
        return Held(self.own_mass, self.payload, state.gravity, self.hanging_radius, three)

    def bent(self, state: EnvironmentState, temperatures: tuple[Array, ...]) -> Bent:
        """How it curls and carries at temperatures of its nodes [K]."""
        del state, temperatures
        raise ConfigurationError(f"{self.describe()}: its layers are not known as a structure")

    @property
    def _tacs(self) -> tuple[Numeric, Numeric]:
        top, bottom = self.faces
        return top.tac_top, bottom.tac_bottom

    def drag(
        self,
        state: EnvironmentState,
        unknowns: tuple[Array, ...],
        speed: Numeric,
        direction: Direction = "broadside",
    ) -> Array:
        """Drag of a disk that lets a share of the gas pass [N]."""
        law = edgewise_disk_drag if direction == "edgewise" else disk_drag
        gas = (state.pressure, state.temperature, state.gas)
        excesses = (unknowns[0], unknowns[len(self.nodes) - 1])
        return law(speed, self.radius, *gas, self._tacs, excesses, self.passing_share)

    def drag_diagnostics(
        self,
        state: EnvironmentState,
        speed: Numeric,
        direction: Direction = "broadside",
        temperature: Numeric | None = None,
    ) -> tuple[str, ...]:
        gas = (state.pressure, state.temperature, state.gas)
        hole_radius, open_fraction = self.widest_holes
        return (
            *disk_diagnostics(speed, self.radius, *gas, self._tacs, direction, temperature),
            *wide_hole_diagnostics(hole_radius, self.radius, open_fraction, *gas),
        )

    def describe(self) -> str:
        diameter = 2.0 * float(np.asarray(self.radius)) * scale_and_offset("m", self.shown_unit)[0]
        return f"{type(self).__name__.lower()} of {diameter:g} {self.shown_unit}"


class AbstractClosedFlyer(AbstractFlyer):
    """A closed convex body, whose drag is that of its outline."""

    @abc.abstractmethod
    def outer_wall(self, unknowns: tuple[Array, ...]) -> tuple[Numeric, Numeric]:
        """TAC of what the gas around meets, and its excess [1]."""

    @abc.abstractmethod
    def outline(self, direction: Direction) -> Outline:
        """Outline along its motion."""

    def drag(
        self,
        state: EnvironmentState,
        unknowns: tuple[Array, ...],
        speed: Numeric,
        direction: Direction = "broadside",
    ) -> Array:
        """Drag of a closed body of this shape [N]."""
        gas = (state.pressure, state.temperature, state.gas)
        return convex_drag(speed, self.outline(direction), *gas, *self.outer_wall(unknowns))

    def drag_diagnostics(
        self,
        state: EnvironmentState,
        speed: Numeric,
        direction: Direction = "broadside",
        temperature: Numeric | None = None,
    ) -> tuple[str, ...]:
        gas = (state.pressure, state.temperature, state.gas)
        return tuple(convex_diagnostics(speed, self.outline(direction), *gas, temperature))


class AbstractRoundFlyer(AbstractClosedFlyer):
    """A sphere."""

    radius: AbstractVar[Numeric]

    @property
    def area(self) -> Numeric:
        return np.pi * self.radius**2

    @property
    def surface(self) -> Numeric:
        """Area of the whole sphere, openings included [m²]."""
        return 4.0 * np.pi * self.radius**2

    @property
    def volume(self) -> Numeric:
        """Volume of the whole sphere [m³]."""
        return self.surface * self.radius / 3.0

    def outline(self, direction: Direction) -> Outline:
        del direction
        return sphere_outline(self.radius)


_FILM = "film"


class FlyerSection(Alternative):
    """``[flyer]``: payload and attitude; subclasses add shape and size.

    A field ``film`` of the flyer is what ``[film]`` says; any other film has a section of its own,
    such as ``[flyer.top]``, after the numbers.
    """

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("shape", "disk"),)
    flyer_type: ClassVar[type[AbstractFlyer]]
    """Class of the flyer that the section builds."""

    needs_film: ClassVar[bool] = True
    """Whether the file needs a section ``[film]``; a flyer of several films holds its own."""

    needs_transmittance: ClassVar[bool] = True
    """Whether it matters what passes a film: where light or heat radiation then meets another."""

    default_model: ClassVar[str] = "kinetic"
    """Force model where the file has no ``[force]``."""

    payload: Mass = Measured(0.0)
    tilt: Tilt = Measured(0.0)
    azimuth: Azimuth = Measured(0.0)

    def __init_subclass__(cls, of: type[AbstractFlyer] | None = None, **options: Any) -> None:
        if of is not None:
            cls.flyer_type = of
            if "needs_film" not in vars(cls):
                cls.needs_film = _FILM in of.film_names() or not of.film_names()
        super().__init_subclass__(of=of, **options)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of any result must know beside what films say, one line each."""
        return ()

    def idle(self) -> dict[str, str]:
        level = self.tilt == Measured(0.0) and self.azimuth != self.tilt
        return {"azimuth": "without tilt"} if level else {}

    @classmethod
    def keys_of(cls, described: type) -> dict[str, tuple[Any, Any]]:
        films = {name: (FilmSection, ...) for name in cls.flyer_type.film_names() if name != _FILM}
        return super().keys_of(described) | films

    def build(self, film: FilmProperties | None, incidence: float) -> AbstractFlyer:
        """The flyer; ``film``: what ``[film]`` says, where :attr:`needs_film`."""
        films = {
            name: film if name == _FILM else getattr(self, name).build(incidence)
            for name in self.flyer_type.film_names()
        }
        return self.make(**films, attitude=self.attitude())

    def attitude(self) -> Attitude | None:
        """Attitude of the flyer, None for a level one."""
        level = isinstance(self.tilt.value, float) and self.tilt.value == 0.0
        if level:
            return None
        return Attitude(
            self.tilt.value * RADIANS_PER_DEGREE, self.azimuth.value * RADIANS_PER_DEGREE
        )
