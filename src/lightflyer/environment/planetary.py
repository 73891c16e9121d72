"""Above a place on a planet: an atmosphere, its gas, gravity, sunlight, dust and wind."""

import abc
from dataclasses import replace
from typing import Any, ClassVar, Literal

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Acceleration, Fraction, Length
from lightflyer.core.units import Measured
from lightflyer.environment.base import (
    AbstractAtmosphere,
    AbstractEnvironment,
    Coordinate,
    EnvironmentState,
    Place,
)
from lightflyer.environment.light.mars import Dust, dusty_light
from lightflyer.environment.light.sky import VIEW_OF_PLANET, AbstractSky, describe_shadow
from lightflyer.environment.planet import Planet
from lightflyer.environment.radiation import SKY_INFRARED, Radiation
from lightflyer.environment.section import (
    AltitudeSection,
    altitude_coordinate,
    describe_floor,
    warn_of_kilometres,
)
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.pure import GASES

_SHADOW_STEPS = 1501  # of the altitudes searched, in which the shadow's edge is looked for


class Planetary(AbstractEnvironment):
    """Above a place on a planet; the coordinate is the geometric altitude [m].

    Attributes
    ----------
    atmosphere : AbstractAtmosphere
    gas : AbstractGas
        Its gas constant follows the atmosphere's molar mass.
    gravity : array or None
        Constant gravity [m/s²]; None for that of the planet, which falls off with altitude.
    radiation : Radiation
        Sunlight above the air, and thermal surroundings; by default the planet's own. What it
        leaves open of the view to the ground is that of a sphere.
    wind : AbstractWind or None
        Wind where a place is given; None for gas at rest.
    sky : AbstractSky or None
        Light and heat radiation by date and place; None leaves them to ``radiation``.
    place : Place or None
        Where and when, for states whose place is not given. With a sky, ``radiation`` becomes the
        light there in full, and of states what is left of it behind dust and horizon.
    floor : array or None
        Distance down to solid ground, or to a platform, at every altitude [m]; None for open air.
        It changes what the gas does to the flyer, not the light.
    planet : Planet
    dust : Dust or None
        Dims the beam and scatters light down; None for clear air.
    """

    atmosphere: AbstractAtmosphere  # type: ignore[misc]
    gas: AbstractGas  # type: ignore[misc]
    gravity: Acceleration | None = None
    radiation: Radiation = field(default=None)
    wind: AbstractWind | None = None
    sky: AbstractSky | None = None
    place: Place | None = None
    floor: Length | None = None
    planet: Planet = field(static=True, kw_only=True)  # type: ignore[misc]
    dust: Dust | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if self.radiation is None:
            self.radiation = self.planet.sunlight()
        if self.sky is not None and self.place is not None:
            full = self.sky.radiation(self.atmosphere.altitude_range[1], self.place)
            self.radiation = replace(full, visible=None, ground_view=None, lit_ground=None)

    @property
    def coordinate(self) -> Coordinate:
        """Geometric altitude, over the atmosphere's range."""
        return altitude_coordinate(self.atmosphere.altitude_range, self.planet.highest_searched)

    def assumptions(self) -> tuple[str, ...]:
        return self.assumptions_of_light() + self.assumptions_of_air()

    def assumptions_of_light(self) -> tuple[str, ...]:
        """What is assumed about light, heat radiation and solid ground, in short texts."""
        told = self.radiation.describe(VIEW_OF_PLANET)
        if self.sky is not None and self.place is not None:
            altitudes = np.linspace(*self.coordinate.searched, _SHADOW_STEPS)
            visible = self.sky.radiation(altitudes, self.place).visible
            told = (
                f"{told[0]}, {self.place.describe()}",
                *describe_shadow(altitudes, visible),
                *self.sky.assumptions(),
            )
        return told + describe_floor(self.floor)

    def assumptions_of_air(self) -> tuple[str, ...]:
        """Atmosphere, dust and gas that are assumed."""
        dust = "dust: none" if self.dust is None else self.dust.describe()
        return (self.atmosphere.describe(), dust, *self.gas.assumptions())

    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:
        """Surroundings at an altitude; ``coordinate``: geometric altitude."""
        warn_of_kilometres(coordinate)
        altitude = self.coordinate.quantity.number("altitude", coordinate, keep_index=True)
        require_range("altitude [m]", altitude, *self.atmosphere.altitude_range)
        wind = None if place is None else self.wind
        place = self.place if place is None else place
        radiation = self.radiation
        if self.sky is not None:
            if place is None:
                raise ConfigurationError(
                    "light by date and place needs a place: date, latitude, longitude"
                )
            radiation = self.sky.radiation(altitude, place)
        state = _state(self, radiation, altitude, place)
        if place is not None and wind is not None:
            state = replace(state, wind=wind.velocity(altitude, place))
            air = wind.air(altitude, place, self.atmosphere)
            if air is not None:
                state = replace(state, **air._asdict())
        return state


@entry_point
def _state(
    environment: Planetary, radiation: Radiation, altitude: Numeric, place: Place | None
) -> EnvironmentState:
    planet, atmosphere = environment.planet, environment.atmosphere
    gas = tree.replace_at(
        lambda gas: gas.specific_gas_constant,
        environment.gas,
        environment.gas.specific_gas_constant / atmosphere.molar_mass_ratio(altitude, place),
    )
    if environment.dust is not None:
        dust, distance = environment.dust, planet.radius + altitude
        cosine = xp.cos(radiation.zenith_angle)
        # where a ray from below the horizontal comes nearest to the ground
        lowest = xp.maximum(distance * xp.sin(radiation.zenith_angle) - planet.radius, 0.0)
        ground = atmosphere.pressure(0.0, place)
        depth, lowest_depth = (
            dust.depth_above(atmosphere.pressure(height, place) / ground)
            for height in (altitude, lowest)
        )
        light = dusty_light(dust, depth, lowest_depth, cosine, distance)
        beam, scattered = map(radiation.visible_part, (light.beam, light.scattered))
        radiation = replace(radiation, visible=beam, scattered=scattered)
    gravity = environment.gravity
    return EnvironmentState(
        pressure=atmosphere.pressure(altitude, place),
        temperature=atmosphere.temperature(altitude, place),
        gravity=planet.gravity_at(altitude) if gravity is None else gravity,
        gas=gas,
        radiation=radiation.with_ground_view(planet.view_from(altitude)),
        floor_distance=environment.floor,
    )


class PlanetSection(AltitudeSection, abc.ABC):
    """``[environment]`` of a planet; irradiance and albedo are the planet's own by default.

    A subclass states its ``planet``, a literal ``kind`` and :meth:`build_atmosphere`; what it
    leaves out otherwise is light as given, clear air at rest and open ground.
    """

    planet: ClassVar[Planet]
    environment: ClassVar[type[Planetary]] = Planetary
    default_gas: ClassVar[str]
    default_gravity: ClassVar[float | None] = None

    albedo: Fraction
    surroundings: Literal["planet", "gas"] = "planet"

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        if "planet" in vars(cls):
            for name in {"irradiance", "albedo"} - set(cls.__annotations__):
                number = getattr(cls.planet, name)
                if number is not None:
                    cls.model_fields[name].default = Measured(number)
            cls.model_rebuild(force=True)
        super().__pydantic_init_subclass__(**kwargs)

    def idle(self) -> dict[str, str]:
        both = self.infrared_top is not None and self.infrared_bottom is not None
        why = "beside infrared_top and infrared_bottom; remove it, or both of them"
        return super().idle() | ({"surroundings": why} if both else {})

    @property
    def default_infrared(self) -> tuple[float | None, float | None]:
        infrared = None if self.surroundings == "gas" else self.planet.infrared
        return (None if infrared is None else SKY_INFRARED, infrared)

    @abc.abstractmethod
    def build_atmosphere(self) -> AbstractAtmosphere:
        """The atmosphere of this alternative."""

    def build_gas(self) -> AbstractGas:
        """The gas."""
        return GASES[self.gas or self.default_gas]

    def build_dust(self) -> Dust | None:
        """What dims the light; None for clear air."""
        return None

    def build_wind(self, atmosphere: AbstractAtmosphere) -> AbstractWind | None:
        """The wind; None for gas at rest."""
        return None

    def build_place(self) -> Place | None:
        """Where and when the light is; None for light as given."""
        return None

    def build_sky(self) -> AbstractSky | None:
        """Light by date and place; None for light as given."""
        return None

    def build(self) -> Planetary:
        atmosphere = self.build_atmosphere()
        return self.environment(
            planet=self.planet,
            atmosphere=atmosphere,
            gas=self.build_gas(),
            gravity=self.default_gravity if self.gravity is None else self.gravity.value,
            radiation=self.build_radiation(),
            dust=self.build_dust(),
            wind=self.build_wind(atmosphere),
            sky=self.build_sky(),
            place=self.build_place(),
            floor=None if self.floor is None else self.floor.value,
        )
