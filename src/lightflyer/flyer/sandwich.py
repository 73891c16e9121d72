"""The sandwich of two perforated membranes, the lower one warmer in sunlight."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np
import pydantic

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    Conductivity,
    Contradictions,
    Density,
    Distance,
    Fraction,
    Length,
    Mass,
    OpenFraction,
    Radius,
)
from lightflyer.core.units import Measured
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import DIAMETER, Section, Spelling
from lightflyer.film.optics.waves import narrow_holes
from lightflyer.film.properties import FilmProperties, excess_of_growth
from lightflyer.flyer.base import AbstractThinFlyer, FlyerSection
from lightflyer.flyer.hanging import Hanging, hangs_wrongly
from lightflyer.flyer.shape import (
    OF_SANDWICHES,
    Bent,
    BentSheets,
    Core,
    Shape,
    bent_sandwich,
    core_of_posts,
    shape_of_sandwich,
)
from lightflyer.flyer.sheets import (
    DARK,
    Exitance,
    Sheet,
    net_gains,
    sheet_in_infrared,
    sheet_in_light,
)
from lightflyer.gas.molecules import coaxial_share
from lightflyer.structure.laminate import Laminate
from lightflyer.structure.sandwich import Ligaments


class Sandwich(AbstractThinFlyer):
    """Two parallel membranes with holes, held apart by supports.

    Light passes the upper membrane, through its holes or its film, and warms the lower one. Gas
    creeps through the holes towards the warmer side and pushes the sandwich up.

    Attributes
    ----------
    top, bottom : FilmProperties
        Films of the upper and the lower membrane where they are solid; their transmittances
        count. Each has a top and a bottom face.
    radius : array
        Of the membranes [m].
    gap : array
        Distance between the membranes [m].
    open_fraction : array
        Share of each membrane's area that is holes [1].
    hole_radius : array
        Radius of the holes [m]. It says where models, and geometric optics, hold.
    support_fraction : array
        Share of the area that the supports' cross section takes, beside ligaments [1].
    support_conductivity : array
        Thermal conductivity of the supports [W/(m K)].
    payload : array
        Mass carried beside the sandwich's own [kg].
    attitude : Attitude or None
        How the sandwich lies; None stands for level.
    support_density : array or None
        Density of the supports [kg/m³]; None neglects their mass.
    ligaments : Ligaments or None
        Posts of the supports' material that hold the membranes apart; None where only their
        share of the area is known.
    hanging_radius : array or None
        Of the circle from which the payload hangs [m]; None is the middle.
    hanging : {"circle", "three points"}
        Whether it hangs all around the circle, or at three points of it.

    Raises
    ------
    ParameterError
        If a concrete number is impossible, or does not fit the others.

    References
    ----------
    [Schafer2022]_, [Schafer2025]_

    Examples
    --------
    >>> film = FilmProperties(4e-4, 0.05, 0.05, 0.05, 0.8, 0.8, transmittance=0.9)
    >>> sandwich = Sandwich(film, film, 0.01, 1e-4, 0.5, 1e-5, 3e-4, 1.8)
    >>> print(f"{sandwich.describe()}, {sandwich.own_mass * 1e6:.4f} mg")
    sandwich of 2 cm, 0.1257 mg
    """

    nodes: ClassVar[tuple[str, ...]] = ("top", "bottom")
    lifted_by: ClassVar[str] = "gas that creeps through its holes towards the warmer membrane"
    drag_law: ClassVar[str] = (
        "of a thin disk by the kinetic equation, less the molecules that pass, with inertia"
    )

    top: FilmProperties
    bottom: FilmProperties
    radius: Radius
    gap: Length
    open_fraction: OpenFraction
    hole_radius: Length
    support_fraction: Fraction
    support_conductivity: Conductivity
    payload: Mass = 0.0
    attitude: Attitude | None = None
    support_density: Density | None = None
    ligaments: Ligaments | None = None
    hanging_radius: Distance | None = None
    hanging: Hanging = field(static=True, default="circle")

    @staticmethod
    def contradiction(
        radius: Numeric,
        hole_radius: Numeric,
        open_fraction: Numeric,
        support_fraction: Numeric,
        ligaments: Ligaments | None,
        hanging_radius: Numeric | None,
        hanging: Hanging,
    ) -> Contradictions:
        """How sizes contradict each other."""
        if ligaments is not None:
            support_fraction = support_fraction + ligaments.covered
        yield hole_radius >= radius, "hole_radius must be smaller than the radius of the sandwich"
        both = "open_fraction and support_fraction exceed 1 together; supports stand on film"
        yield open_fraction + support_fraction > 1.0, both
        yield from hangs_wrongly(radius, hanging_radius, hanging)

    @property
    def faces(self) -> tuple[FilmProperties, FilmProperties]:
        return self.top, self.bottom

    @property
    def widest_holes(self) -> tuple[Numeric, Numeric]:
        return self.hole_radius, self.open_fraction

    @property
    def solid_fraction(self) -> Numeric:
        """Share of each membrane's area that is film [1]."""
        return 1.0 - self.open_fraction

    @property
    def solid_support(self) -> Numeric:
        """Share of the area that the section of supports and ligaments takes [1]."""
        posts = 0.0 if self.ligaments is None else self.ligaments.fraction
        return self.support_fraction + posts

    @property
    def own_mass(self) -> Numeric:
        """Mass of both membranes, and of the supports where their density is given [kg]."""
        films = self.solid_fraction * (self.top.areal_density + self.bottom.areal_density)
        if self.support_density is not None:
            films = films + self.support_density * self.solid_support * self.gap
        return self.area * films

    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        light = state.radiation.on_faces(self.attitude)
        return self._absorbed_power(self._sheets_in_light(), light.beam_top, light.beam_bottom)

    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        light = state.radiation.on_faces(self.attitude)
        diffuse = self._absorbed_power(
            self._sheets_in_light(), light.diffuse_top, light.diffuse_bottom
        )
        infrared = self._absorbed_power(
            self._sheets_in_infrared(state),
            *state.radiation.infrared_excess(state.temperature, self.attitude),
        )
        return tuple(visible + heat for visible, heat in zip(diffuse, infrared, strict=True))

    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        # Emission beyond that at the gas temperature, with what the other membrane sends back, and
        # conduction :math:`A f_l k_l (T_b - T_t)/h` through the supports. Radiation between the
        # membranes is absorbed with the emittance at the gas temperature.
        top_excess, bottom_excess = unknowns
        black = state.radiation.stefan_boltzmann * state.temperature**4
        top, bottom = net_gains(
            *self._sheets_in_infrared(state),
            0.0,
            0.0,
            self._emission(self.top, state, top_excess),
            self._emission(self.bottom, state, bottom_excess),
        )
        difference = state.temperature * (bottom_excess - top_excess)
        upward = self.solid_support * self.support_conductivity / self.gap * difference
        return self.area * (-black * top - upward), self.area * (-black * bottom + upward)

    @property
    def known_shape(self) -> tuple[str, ...]:
        unknown = None in (self.top.laminate, self.bottom.laminate, self.ligaments)
        return () if unknown else OF_SANDWICHES

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,  # noqa: ARG002
    ) -> Shape:
        return self.shape_on(self._posts, state, temperatures, lift)

    def bent(self, state: EnvironmentState, temperatures: tuple[Array, ...]) -> Bent:
        return self.bent_on(self._posts, state, temperatures)

    @property
    def _posts(self) -> Core | None:
        """Its ligaments, None where they or the layers are not known."""
        if not self.known_shape:
            return None
        films = self._laminates
        return core_of_posts(self.ligaments, films, self.gap, self.open_fraction)  # type: ignore[arg-type]

    @property
    def _laminates(self) -> tuple[Laminate, Laminate]:
        return self.top.laminate, self.bottom.laminate  # type: ignore[return-value]

    def shape_on(
        self,
        core: Core | None,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
    ) -> Shape:
        """Shape with a core that holds the membranes, where that and their layers are known."""
        if core is None:
            return super().shape(state, temperatures, lift)
        pressure = xp.abs(lift) / self.area
        return shape_of_sandwich(self._sheets(core, temperatures), self.held(state), pressure)

    def bent_on(
        self, core: Core | None, state: EnvironmentState, temperatures: tuple[Array, ...]
    ) -> Bent:
        """The same, as it curls and carries."""
        if core is None:
            return super().bent(state, temperatures)
        return bent_sandwich(self._sheets(core, temperatures), self.held(state))

    def _sheets(self, core: Core, temperatures: tuple[Array, ...]) -> BentSheets:
        films = self._laminates
        return BentSheets(films, temperatures, core, self.gap, self.open_fraction, self.radius)

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        """Excess in vacuum, by the outer faces alone [1]."""
        outer = tree.replace_at(
            lambda film: film.emittance_bottom, self.top, self.bottom.emittance_bottom
        )
        black = state.radiation.stefan_boltzmann * state.temperature**4
        emitted = power / (self.area * self.solid_fraction * black)
        return xp.abs(excess_of_growth(outer.emission_bound(state.temperature, emitted)))

    def diagnostics(self, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Warns of holes that are too narrow for geometric optics."""
        coldest = np.minimum(np.min(state.temperature), np.min(temperature))
        return tuple(narrow_holes(self.hole_radius, coldest))

    @property
    def passing_share(self) -> Array:
        # .. math:: \beta\left[d + \frac{1-d}{2-\beta}\right]
        #
        # with the share :math:`d` of those leaving a hole that meet the one opposite. The others
        # forget where they came from.
        direct = coaxial_share(self.gap / self.hole_radius)
        return self.open_fraction * (direct + (1.0 - direct) / (2.0 - self.open_fraction))

    def _sheets_in_light(self) -> tuple[Sheet, Sheet]:
        top, bottom = (sheet_in_light(film, self.open_fraction) for film in (self.top, self.bottom))
        return top, bottom

    def _sheets_in_infrared(self, state: EnvironmentState) -> tuple[Sheet, Sheet]:
        top, bottom = (
            sheet_in_infrared(film, self.open_fraction, state.temperature)
            for film in (self.top, self.bottom)
        )
        return top, bottom

    def _absorbed_power(
        self, sheets: tuple[Sheet, Sheet], above: Numeric, below: Numeric
    ) -> tuple[Array, ...]:
        """What the membranes absorb of irradiances from above and below, over their area."""
        top, bottom = net_gains(*sheets, above, below, DARK, DARK)
        return self.area * top, self.area * bottom

    def _emission(self, film: FilmProperties, state: EnvironmentState, excess: Array) -> Exitance:
        """Growth of a membrane's emission, over that of a black face at the gas temperature."""
        top, bottom = film.emission_growths(state.temperature, excess)
        return Exitance(self.solid_fraction * top, self.solid_fraction * bottom)


class LigamentsSection(Section, of=Ligaments):
    """``[flyer.ligaments]``: posts between the membranes."""

    spelled: ClassVar[Mapping[str, Spelling]] = {"radius": DIAMETER}


class SandwichSection(FlyerSection, of=Sandwich):
    """``[flyer]``: a sandwich, with its films in ``[flyer.top]`` and ``[flyer.bottom]``."""

    default_model: ClassVar[str] = "schafer2025"
    spelled: ClassVar[Mapping[str, Spelling]] = {"radius": DIAMETER}

    shape: Literal["sandwich"]
    support_fraction: Fraction = Measured(0.0)
    ligaments: LigamentsSection | None = None

    @pydantic.model_validator(mode="after")
    def _something_holds_the_gap(self) -> "SandwichSection":
        if self.ligaments is None and "support_fraction" not in self.model_fields_set:
            raise ConfigurationError("needs support_fraction, or a section [flyer.ligaments]")
        return self
