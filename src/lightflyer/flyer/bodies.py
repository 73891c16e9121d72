"""What flyers of the same kind of body share: thin round ones and closed convex ones."""

import abc
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import scale_and_offset
from lightflyer.drag.convex import Outline, convex_diagnostics, convex_drag
from lightflyer.drag.disk import (
    Direction,
    disk_diagnostics,
    disk_drag,
    edgewise_disk_drag,
    wide_hole_diagnostics,
)
from lightflyer.environment.base import EnvironmentState
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.hanging import THREE_POINTS, Hanging, Held
from lightflyer.flyer.shape import Bent


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
