"""A balloon: a spherical envelope of film, open or closed, around warm gas."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.quantity import Contradictions, Distance, Length, Mass, MolarMass, Tension
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import DIAMETER, Spelling
from lightflyer.film.properties import FilmProperties, excess_of_growth
from lightflyer.flyer.base import AbstractRoundFlyer, FlyerSection
from lightflyer.flyer.shape import OF_SHELLS, Shape, Wall, shape_of_sphere

_MOLAR_GAS_CONSTANT = constants.BOLTZMANN * constants.AVOGADRO  # [J/(mol K)]

MOLAR_MASSES: Mapping[str, float] = {"helium": 4.002602e-3, "hydrogen": 2.016e-3}
"""Lift gases by the name they have in a flyer file [kg/mol]; [Prohaska2022]_."""


class Filling(NamedTuple):
    """The gas that an envelope holds."""

    volume: Numeric  # That it takes, at most that of the envelope [m³]
    mass: Numeric  # [kg]
    # Over the surroundings, at the height of the lower end [Pa]; zero while it is slack or open
    overpressure: Numeric


class Balloon(AbstractRoundFlyer):
    r"""A spherical envelope of film around warm gas.

    An **open** envelope has an opening at its lower end. Gas comes and goes through it, so that
    the envelope is always full, at the pressure of the surroundings. A **closed** one holds a
    given mass of gas: it is slack while the gas takes less than its volume, and under pressure
    beyond.

    The gas within is as warm as the envelope: without a source of heat of its own, no difference
    lasts. It neither absorbs light nor emits.

    Attributes
    ----------
    film : FilmProperties
        Of the envelope. The top face looks out, the bottom face into the balloon; the
        transmittances count.
    radius : array
        Of the full sphere [m].
    opening_radius : array
        Of the opening at the lower end, zero for none [m].
    gas_mass : array or None
        Of the gas in a closed envelope [kg]; None for an open one.
    molar_mass : array or None
        Of the gas within [kg/mol]; None for the gas that is around.
    payload : array
        Mass carried beside the film's [kg].
    attitude : Attitude or None
        How the opening lies; None stands for straight down.
    film_strength : array or None
        Force per length that the film withstands [N/m]; it changes no result but its warnings.

    Raises
    ------
    ParameterError
        If a concrete number is impossible, or does not fit the others.

    References
    ----------
    [Bowman2020]_ for balloons of air, [CarlsonHorn1983]_ for balloons of helium.

    Examples
    --------
    >>> film = FilmProperties(7.4e-3, 0.98, 0.95, 0.95, 0.9, 0.9)
    >>> print(f"{Balloon(film, radius=2.9).own_mass:.3f} kg")
    0.782 kg
    """

    nodes: ClassVar[tuple[str, ...]] = ("envelope",)
    held_pressure: ClassVar[str] = "overpressure"
    lifted_by: ClassVar[str] = "the gas inside, which is warmer or lighter than the air"
    hangs: ClassVar[str | None] = "a balloon hangs upright"
    floats: ClassVar[bool] = True
    drag_law: ClassVar[str] = "of a sphere by Cunningham's law, with inertia"

    film: FilmProperties
    radius: Length
    opening_radius: Distance = 0.0
    gas_mass: Mass | None = None
    molar_mass: MolarMass | None = None
    payload: Mass = 0.0
    attitude: Attitude | None = None
    film_strength: Tension | None = None

    @staticmethod
    def contradiction(
        radius: Numeric, opening_radius: Numeric, gas_mass: Numeric | None
    ) -> Contradictions:
        """How numbers contradict each other."""
        yield opening_radius >= radius, "the opening must be smaller than the balloon"
        if gas_mass is not None:
            closed = "a closed balloon, which has a gas_mass, has no opening"
            yield opening_radius > 0.0, closed

    @property
    def open_share(self) -> Numeric:
        """Share of the sphere that is opening [1]."""
        return self.opening_radius**2 / (4.0 * self.radius**2)

    @property
    def film_area(self) -> Numeric:
        """Area of the film, on one side [m²]."""
        return self.surface * (1.0 - self.open_share)

    @property
    def own_mass(self) -> Numeric:
        """Mass of the film [kg]; that of the gas within is part of the buoyancy."""
        return self.film_area * self.film.areal_density

    def outer_wall(self, unknowns: tuple[Array, ...]) -> tuple[Numeric, Numeric]:
        return self.film.tac_top, unknowns[0]

    def filling(self, state: EnvironmentState, excess: Numeric) -> Filling:
        r"""Volume, mass and pressure of the gas within."""
        specific = self._gas_constant(state) * state.temperature * (1.0 + excess)
        if self.gas_mass is None:
            return Filling(self.volume, state.pressure * self.volume / specific, 0.0 * excess)
        unbound = self.gas_mass * specific / state.pressure
        full = xp.maximum(unbound / self.volume - 1.0, 0.0)
        return Filling(xp.minimum(unbound, self.volume), self.gas_mass, full * state.pressure)

    def buoyancy(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Numeric:
        # .. math:: g\,(\rho_c V - m)
        #
        # which for an open balloon of the surrounding gas is
        # :math:`\rho_c\,g\,V\,\theta/(1+\theta)`, written so.
        (excess,) = unknowns
        density = state.gas.density(state.pressure, state.temperature)
        if self.gas_mass is None:
            heavier = state.gas.specific_gas_constant / self._gas_constant(state)
            share = (1.0 - heavier + excess) / (1.0 + excess)
            return density * self.volume * state.gravity * share
        within = self.filling(state, excess)
        return (density * within.volume - within.mass) * state.gravity

    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        into_opening = state.radiation.on_faces(self.attitude).beam_bottom
        return (self._absorbed_light(state.radiation.on_sphere().beam, into_opening),)

    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        radiation, temperature = state.radiation, state.temperature
        into_opening = radiation.on_faces(self.attitude).diffuse_bottom
        diffuse = self._absorbed_light(radiation.on_sphere().diffuse, into_opening)
        _, from_below = radiation.infrared_excess(temperature, self.attitude)
        infrared = self._absorbed_infrared(
            state, radiation.infrared_excess_on_sphere(temperature), from_below
        )
        return (diffuse + infrared,)

    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        # What the envelope emits beyond that at the gas temperature, less what comes back to it
        # within.
        (excess,) = unknowns
        out, within = self.film.emission_growths(state.temperature, excess)
        black = state.radiation.stefan_boltzmann * state.temperature**4
        return (-black * self._absorbed_infrared(state, 0.0, 0.0, out, within),)

    @property
    def known_shape(self) -> tuple[str, ...]:
        return () if self.film.laminate is None else (*OF_SHELLS, "lowest_frequency")

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,
    ) -> Shape:
        if self.film.laminate is None:
            return super().shape(state, temperatures, lift, pressure)
        wall = Wall((self.film.laminate,), temperatures)
        gas = state.gas.density(state.pressure, state.temperature)
        found = shape_of_sphere(wall, self.radius, None, self.own_mass, pressure, gas)
        taut = pressure > 0.0  # a slack film resists nothing
        return found._replace(lowest_frequency=xp.where(taut, found.lowest_frequency, 0.0))

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        """Excess in vacuum, by the outer face alone [1]."""
        outer = tree.replace_at(lambda film: film.emittance_bottom, self.film, 0.0)
        black = self.film_area * state.radiation.stefan_boltzmann * state.temperature**4
        return xp.abs(excess_of_growth(outer.emission_bound(state.temperature, power / black)))

    def describe(self) -> str:
        kind = "open" if self.gas_mass is None else "closed"
        return f"{kind} balloon of {2.0 * float(np.asarray(self.radius)):g} m"

    def _gas_constant(self, state: EnvironmentState) -> Numeric:
        """Specific gas constant of the gas within [J/(kg K)]."""
        if self.molar_mass is None:
            return state.gas.specific_gas_constant
        return _MOLAR_GAS_CONSTANT / self.molar_mass

    def _absorbed_light(self, onto_sphere: Numeric, into_opening: Numeric) -> Array:
        film = self.film
        return self._absorbed_power(
            (film.absorptance, film.absorptance_below),
            (film.transmittance, film.transmittance_below),
            onto_sphere,
            into_opening,
        )

    def _absorbed_infrared(
        self,
        state: EnvironmentState,
        onto_sphere: Numeric,
        into_opening: Numeric,
        *emitted: Numeric,
    ) -> Array:
        through = self.film.infrared_transmittance_at(state.temperature)
        emittances = self.film.emittances_at(state.temperature)
        return self._absorbed_power(
            emittances, (through, through), onto_sphere, into_opening, *emitted
        )

    def _absorbed_power(
        self,
        absorptances: tuple[Numeric, Numeric],
        transmittances: tuple[Numeric, Numeric],
        onto_sphere: Numeric,
        into_opening: Numeric,
        emitted_out: Numeric = 0.0,
        emitted_within: Numeric = 0.0,
    ) -> Array:
        """What the envelope absorbs, minus what it emits, of irradiances from outside [W]."""
        # Within, radiation is diffuse and everywhere the same, and what reaches the opening leaves.
        (outer, inner), (inward, outward) = absorptances, transmittances
        hole = self.open_share
        solid = 1.0 - hole
        # of the sphere's mean, what does not fall into the opening
        onto_film = (onto_sphere - hole * into_opening) / solid
        entering = hole * into_opening + solid * (inward * onto_film + emitted_within)
        reflected = solid * (1.0 - inner - outward)
        # within a perfect mirror without an opening there is nothing
        kept = xp.where(reflected == 1.0, 1.0, 1.0 - reflected)
        gain = outer * onto_film + inner * entering / kept - emitted_out - emitted_within
        return self.film_area * gain


class BalloonSection(FlyerSection, of=Balloon):
    """``[flyer]``: a balloon, whose film is in ``[film]``."""

    default_model: ClassVar[str] = "balloon"
    not_varied: ClassVar[Mapping[str, str]] = {
        "film_strength": "is a limit and changes no result",
    }
    spelled: ClassVar[Mapping[str, Spelling]] = {
        "radius": DIAMETER,
        "opening_radius": Spelling("opening_diameter", 0.5),
    }
    left_out: ClassVar[tuple[str, ...]] = ("molar_mass",)
    first_keys: ClassVar[tuple[str, ...]] = ("shape", "diameter", "opening_diameter")

    shape: Literal["balloon"]
    gas: Literal["ambient", "helium", "hydrogen"] = "ambient"

    def idle(self) -> dict[str, str]:
        """A sphere has no attitude."""
        opening = self.opening_diameter  # type: ignore[attr-defined] # a generated field
        round_ = opening.value == 0.0 and self.tilt.value != 0.0
        return super().idle() | ({"tilt": "without opening_diameter"} if round_ else {})

    def make(self, **given: Any) -> Balloon:
        """The balloon, with the gas of that name."""
        return super().make(molar_mass=MOLAR_MASSES.get(self.gas), **given)
