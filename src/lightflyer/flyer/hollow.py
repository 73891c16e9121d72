"""Hollow bodies with a wall full of channels, which pumps gas in, and an outlet for the jet."""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import field
from lightflyer.core.quantity import (
    Coefficient,
    Conductivity,
    Contradictions,
    Density,
    Length,
    Mass,
    OpenFraction,
)
from lightflyer.drag.convex import Outline
from lightflyer.drag.disk import Direction
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude, Exitances, Radiation
from lightflyer.files.section import Spelling
from lightflyer.film.optics.waves import narrow_channels
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.base import AbstractClosedFlyer, FlyerSection
from lightflyer.flyer.hollow_geometry import (
    FORMS,
    Form,
    HollowForm,
    hollow_outline,
    silhouette_below_horizon,
    tube_sizes,
)
from lightflyer.flyer.shape import OF_SHELLS, Shape, Wall, shape_of_sphere, shape_of_tube
from lightflyer.flyer.sheets import (
    DARK,
    Exitance,
    Sheet,
    leaving_downward,
    net_gains,
    sheet_in_infrared,
    sheet_in_light,
)

_CENTIMETRE = 1e-2


class HollowBody(AbstractClosedFlyer):
    """A hollow body whose wall is two films held apart by the walls of open channels.

    The inner film is to be warmer than the outer one. Gas creeps through the channels towards the
    warmer side, and leaves as a jet through the outlet at the lower end.

    Attributes
    ----------
    outer, inner : FilmProperties
        Films of the wall where it is solid; their transmittances count. The top face of each looks
        out of the body, the bottom face into it.
    size : array
        Diameter of the sphere, height and upper diameter of the cone, length of the rocket [m].
    outlet_radius : array
        Of the opening at the lower end; a rocket is as wide as its outlet [m].
    open_fraction : array
        Share of the wall's area that is channels [1].
    channel_width : array
        The shorter side of a channel's rectangular section [m].
    wall_thickness : array
        Distance from face to face of the wall, which is the length of the channels [m].
    sheet_thickness : array
        Thickness of the sheet that lines each channel [m].
    sheet_conductivity : array
        Its thermal conductivity [W/(m K)].
    form : str
        ``"cone"``, ``"sphere"`` or ``"rocket"``: see :mod:`lightflyer.flyer.hollow_geometry`.
    channel_aspect : array
        The longer side of a channel's section over the shorter [1].
    sheet_density : array or None
        Density of the sheet [kg/m³]; None neglects its mass.
    payload : array
        Mass carried beside the body's own [kg].
    attitude : Attitude or None
        How the body lies; None stands for its outlet straight down.

    Raises
    ------
    ParameterError
        If a concrete number is impossible, or does not fit the others.

    References
    ----------
    [Celenza2023]_

    Examples
    --------
    >>> film = FilmProperties(5e-4, 0.9, 0.8, 0.1, 0.9, 0.9)
    >>> body = HollowBody(film, film, 0.1, 0.02, 0.5, 1e-4, 1e-4, 5e-8, 1.8, "sphere")
    >>> print(f"{body.describe()}, {body.own_mass * 1e6:.2f} mg")
    hollow sphere of 10 cm, 15.05 mg
    """

    nodes: ClassVar[tuple[str, ...]] = ("inner", "outer")
    held_pressure: ClassVar[str] = "pressure_difference"
    lifted_by: ClassVar[str] = (
        "a jet of the gas that its wall draws in, and by the warmer gas inside"
    )
    drag_law: ClassVar[str] = "of a closed body by its surface and Cunningham's law, with inertia"

    outer: FilmProperties
    inner: FilmProperties
    size: Length
    outlet_radius: Length
    open_fraction: OpenFraction
    channel_width: Length
    wall_thickness: Length
    sheet_thickness: Length
    sheet_conductivity: Conductivity
    form: Form = field(static=True, default="sphere")
    channel_aspect: Coefficient = 10.0
    sheet_density: Density | None = None
    payload: Mass = 0.0
    attitude: Attitude | None = None

    @staticmethod
    def contradiction(
        form: str,
        size: Numeric,
        outlet_radius: Numeric,
        open_fraction: Numeric,
        channel_width: Numeric,
        wall_thickness: Numeric,
        sheet_thickness: Numeric,
        channel_aspect: Numeric,
    ) -> Contradictions:
        """How sizes contradict each other."""
        body = outlet_radius if form == "rocket" else 0.5 * size
        sides = channel_width, channel_aspect * channel_width
        lined = math.prod(1.0 + 2.0 * sheet_thickness / side for side in sides)
        if form != "rocket":
            yield outlet_radius >= body, f"the outlet must be smaller than the {form}"
        yield from (
            (open_fraction <= 0.0,
             "open_fraction must be positive: gas flows through the wall's channels"),
            (channel_aspect < 1.0,
             "channel_aspect must be 1 at least: it is the longer side over the shorter"),
            (wall_thickness <= 2.0 * sheet_thickness,
             "wall_thickness must exceed twice sheet_thickness: the wall has two faces"),
            (wall_thickness >= body,
             f"wall_thickness must be smaller than the radius of the {form}"),
            (channel_width * channel_aspect >= 2.0 * body,
             f"the channels must be narrower than the {form}"),
            (open_fraction * lined > 1.0,
             "channels of this open_fraction and their sheets take more than the whole wall"),
        )  # fmt: skip

    @property
    def geometry(self) -> HollowForm:
        """Functions of the body's shape."""
        return FORMS[self.form]

    @property
    def area(self) -> Numeric:
        return self.geometry.silhouette(self.size, self.outlet_radius, 1.0)

    @property
    def surface(self) -> Numeric:
        """Area of the wall, channels included, on one side [m²]."""
        return self.geometry.surface(self.size, self.outlet_radius)

    @property
    def outlet_area(self) -> Numeric:
        """Area of the outlet [m²]."""
        return np.pi * self.outlet_radius**2

    @property
    def volume(self) -> Numeric:
        """Volume within the wall [m³]."""
        return self.geometry.volume(self.size, self.outlet_radius)

    @property
    def solid_fraction(self) -> Numeric:
        """Share of the wall's area that is film [1]."""
        return 1.0 - self.open_fraction

    @property
    def sheet_fraction(self) -> Numeric:
        """Share of the wall's area that the section of the channels' sheets takes [1]."""
        lining = 2.0 * self.sheet_thickness / self.channel_width
        # (1 + 2t/A)(1 + 2t/B) − 1
        grown = lining * (1.0 + (1.0 + lining) / self.channel_aspect)
        return self.open_fraction * grown

    @property
    def own_mass(self) -> Numeric:
        """Mass of both films, and of the channels' sheets where their density is given [kg]."""
        wall = self.solid_fraction * (self.outer.areal_density + self.inner.areal_density)
        if self.sheet_density is not None:
            between = self.wall_thickness - 2.0 * self.sheet_thickness
            wall = wall + self.sheet_density * self.sheet_fraction * between
        return self.surface * wall

    def buoyancy(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Numeric:
        """Buoyancy of the warm gas within [N]."""
        # .. math:: \rho_c\,g\,V\left(1 - T_c/T_i\right)
        inner = unknowns[0]
        density = state.gas.density(state.pressure, state.temperature)
        return density * state.gravity * self.volume * inner / (1.0 + inner)

    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        radiation = state.radiation
        # without the reflection from the ground, which comes from all its directions
        direct = radiation.beam_alone().on_faces(self.attitude)
        seen = self.geometry.silhouette(
            self.size, self.outlet_radius, direct.beam_top - direct.beam_bottom
        )
        into_outlet = self.outlet_area * direct.beam_bottom
        reflected, _ = radiation.diffuse_light()
        wall, outlet = self._incident_powers(reflected, *self._views_of_ground(radiation))
        return self._absorbed_power(
            self._sheets_in_light(),
            wall + radiation.visible_part(seen - into_outlet),
            outlet + radiation.visible_part(into_outlet),
        )

    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        radiation = state.radiation
        _, light = radiation.diffuse_light()
        infrared = radiation.infrared_exitances(state.temperature)
        views = self._views_of_ground(radiation)
        gains = (
            self._absorbed_power(sheets, *self._incident_powers(exitances, *views))
            for sheets, exitances in (
                (self._sheets_in_light(), light),
                (self._sheets_in_infrared(state), infrared),
            )
        )
        return tuple(visible + heat for visible, heat in zip(*gains, strict=True))

    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        # Emission beyond that at the gas temperature, less what comes back within wall and body,
        # and conduction :math:`A_t f k (T_i - T_o)/L` through the channels' sheets.
        inner_excess, outer_excess = unknowns[:2]
        black = state.radiation.stefan_boltzmann * state.temperature**4
        inner, outer = self._absorbed_power(
            self._sheets_in_infrared(state),
            0.0,
            0.0,
            Exitance(*self.outer.emission_growths(state.temperature, outer_excess)),
            Exitance(*self.inner.emission_growths(state.temperature, inner_excess)),
        )
        per_kelvin = self.sheet_fraction * self.sheet_conductivity / self.wall_thickness
        difference = state.temperature * (inner_excess - outer_excess)
        outward = self.surface * per_kelvin * difference
        return -black * inner + outward, -black * outer - outward

    @property
    def known_shape(self) -> tuple[str, ...]:
        if None in (self.outer.laminate, self.inner.laminate):
            return ()
        return (*OF_SHELLS, "lowest_frequency") if self.form == "sphere" else OF_SHELLS

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,
    ) -> Shape:
        if not self.known_shape:
            return super().shape(state, temperatures, lift, pressure)
        wall = Wall(
            (self.outer.laminate, self.inner.laminate),  # type: ignore[arg-type]
            temperatures[::-1],
            self.open_fraction,
            self.wall_thickness,
        )
        if self.form == "sphere":
            gas = state.gas.density(state.pressure, state.temperature)
            rim = self.outlet_radius
            # as if the wall went on across the outlet
            whole = self.own_mass * np.pi * self.size**2 / self.surface
            return shape_of_sphere(wall, 0.5 * self.size, rim, whole, pressure, gas)
        radius, length = tube_sizes(self.form, self.size, self.outlet_radius)
        return shape_of_tube(wall, radius, length, self.outlet_radius, pressure)

    def diagnostics(self, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Warns of channels that are too narrow for geometric optics."""
        coldest = np.minimum(np.min(state.temperature), np.min(temperature))
        length = self.channel_aspect * self.channel_width
        return tuple(narrow_channels(self.channel_width, length, coldest))

    def drag_diagnostics(
        self,
        state: EnvironmentState,
        speed: Numeric,
        direction: Direction = "broadside",
        temperature: Numeric | None = None,
    ) -> tuple[str, ...]:
        return (
            *super().drag_diagnostics(state, speed, direction, temperature),
            "drag is that of a closed body: what flows through its wall and outlet is left out",
            *(() if self.form == "sphere" else (f"drag of a {self.form} is an estimate",)),
        )

    def outer_wall(self, unknowns: tuple[Array, ...]) -> tuple[Numeric, Numeric]:
        return self.outer.tac_top, unknowns[1]

    def outline(self, direction: Direction) -> Outline:
        return hollow_outline(self.form, self.size, self.outlet_radius, direction)

    def describe(self) -> str:
        return f"hollow {self.form} of {float(np.asarray(self.size)) / _CENTIMETRE:g} cm"

    def _views_of_ground(self, radiation: Radiation) -> tuple[Array, Numeric]:
        r"""View factors to the ground, of wall and outlet together and of the outlet [1]."""
        # A closed convex surface of the area A sees half of a half-space, and less of the ground by
        # what its silhouette shows to the directions between horizon and ground:
        #
        # .. math:: F = \tfrac12 - \frac2A\int_0^{\cos\gamma}\bar S\,dx
        tilt = None if self.attitude is None else self.attitude.tilt
        beside = silhouette_below_horizon(
            self.geometry, self.size, self.outlet_radius, tilt, radiation.edge_of_ground
        )
        _, outlet = radiation.views_of_ground(self.attitude)
        return 0.5 - 2.0 * beside / (self.surface + self.outlet_area), outlet

    def _incident_powers(
        self, exitances: Exitances, closed: Numeric, outlet: Numeric
    ) -> tuple[Array, Array]:
        """Power that falls on the wall and into the outlet, by their views of the ground [W]."""
        into_outlet = self.outlet_area * exitances.mean_over_view(outlet)
        onto_both = (self.surface + self.outlet_area) * exitances.mean_over_view(closed)
        return onto_both - into_outlet, into_outlet

    def _absorbed_power(
        self,
        sheets: tuple[Sheet, Sheet],
        onto_wall: Numeric,
        into_outlet: Numeric,
        emitted_outer: Exitance = DARK,
        emitted_inner: Exitance = DARK,
    ) -> tuple[Array, Array]:
        """What the inner and the outer film absorb, minus what they emit [W]."""
        # Channels pass what falls on them. Within the body radiation is diffuse and everywhere the
        # same; what reaches the outlet leaves.
        above = onto_wall / self.surface
        solid, emitted = self.solid_fraction, (emitted_outer, emitted_inner)
        inward = self.open_fraction * above + solid * leaving_downward(
            *sheets, above, 0.0, *emitted
        )
        kept = solid * leaving_downward(*sheets, 0.0, 1.0)
        lost = self.outlet_area + self.surface * (1.0 - kept)
        within = (into_outlet + self.surface * inward) / lost
        outer, inner = net_gains(*sheets, above, within, *emitted)
        return self.surface * solid * inner, self.surface * solid * outer

    @property
    def _films(self) -> tuple[FilmProperties, FilmProperties]:
        return self.outer, self.inner

    def _sheets_in_light(self) -> tuple[Sheet, Sheet]:
        outer, inner = (sheet_in_light(film, 0.0) for film in self._films)
        return outer, inner

    def _sheets_in_infrared(self, state: EnvironmentState) -> tuple[Sheet, Sheet]:
        outer, inner = (sheet_in_infrared(film, 0.0, state.temperature) for film in self._films)
        return outer, inner


class HollowSection(FlyerSection, of=HollowBody):
    """``[flyer]``: a hollow body, with its films in ``[flyer.outer]`` and ``[flyer.inner]``."""

    default_model: ClassVar[str] = "hollow-pump"
    spelled: ClassVar[Mapping[str, Spelling]] = {
        "outlet_radius": Spelling("outlet_diameter", 0.5),
    }
    first_keys: ClassVar[tuple[str, ...]] = (
        *("shape", "form", "size", "outlet_diameter", "open_fraction"),
        *("channel_width", "channel_aspect"),
    )

    shape: Literal["hollow"]
    form: Form
