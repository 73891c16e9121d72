"""Earth: an atmosphere, its gas, gravity and sunlight, and how a flyer file says it."""

import abc
import datetime
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np
import pydantic

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    Altitude,
    Fraction,
    GeomagneticIndex,
    Irradiance,
    Latitude,
    Longitude,
    SolarFlux,
)
from lightflyer.core.units import Measured
from lightflyer.environment.atmosphere.earth import US1976, Lu2023Atmosphere
from lightflyer.environment.atmosphere.nrlmsis import NRLMSIS, GlobalNRLMSIS, SolarActivity
from lightflyer.environment.base import AbstractAtmosphere, Place
from lightflyer.environment.horizon import EARTH_LIMB
from lightflyer.environment.light.ground import AbstractGround, Knocke1988Ground, UniformGround
from lightflyer.environment.light.sky import Daylight
from lightflyer.environment.light.sun import EarthSun
from lightflyer.environment.planet import EARTH_PLANET, Planet
from lightflyer.environment.planetary import Planetary, PlanetSection
from lightflyer.environment.radiation import Radiation
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.environment.wind.section import WindSection
from lightflyer.gas.air import AIR, LU2023_AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.pure import AIRS

_PLACE = ("date", "latitude", "longitude")
_GIVEN_LIGHT = ("irradiance", "incidence")
_EPHEMERIS = 'sun = "ephemeris"'


class SkySection(PlanetSection, abc.ABC):
    """``[environment]`` over Earth: light as given, or by the sun's ephemeris."""

    # Without date and place, the ephemeris is for a mission, which has its own.

    sun: Literal["ephemeris"] | None = None
    date: datetime.datetime | None = None
    latitude: Latitude | None = None
    longitude: Longitude | None = None
    limb_height: Altitude | None = None
    ground: Literal["knocke1988"] | None = None

    place_matters: ClassVar[bool] = False
    """Whether date and place have an effect also without the ephemeris."""

    without_ephemeris: ClassVar[str] = ""
    """Why there is none, where there is none."""

    @pydantic.model_validator(mode="after")
    def _sun_is_complete(self) -> "SkySection":
        if self.sun is None:
            return self
        if self.without_ephemeris:
            raise ConfigurationError(f"{_EPHEMERIS} does not go here: {self.without_ephemeris}")
        missing = [key for key in _PLACE if getattr(self, key) is None]
        if 0 < len(missing) < len(_PLACE):
            raise ConfigurationError(
                f"{_EPHEMERIS} of one day and place needs {' and '.join(missing)}; without date, "
                "latitude and longitude it is that of a mission"
            )
        if self.default_infrared[1] is None and self.infrared_bottom is None and not self.ground:
            raise ConfigurationError(
                f"{_EPHEMERIS} needs a number for the heat radiation from below: infrared_bottom"
            )
        return self

    def idle(self) -> dict[str, str]:
        """Keys of light as given, or those of the ephemeris."""
        if self.sun is None:
            place = () if self.place_matters else _PLACE
            unread = dict.fromkeys((*place, "limb_height", "ground"), f"without {_EPHEMERIS}")
        else:
            unread = dict.fromkeys(_GIVEN_LIGHT, f"beside {_EPHEMERIS}; remove one of them")
            if self.ground:
                beside = f'beside ground = "{self.ground}"; remove one of them'
                unread |= dict.fromkeys(("albedo", "infrared_bottom"), beside)
        return super().idle() | unread

    def reason_not_varied(self, name: str) -> str | None:
        """The ephemeris decides some keys and does not read others."""
        by_sun = self.sun is not None
        if name in _GIVEN_LIGHT and by_sun:
            return "follows from date and place"
        if name == "limb_height" and not by_sun:
            return f"has no effect without {_EPHEMERIS}"
        if name in ("latitude", "longitude") and self.build_place() is None:
            return super().reason_not_varied(name) or "needs date and place"
        if name in ("albedo", "infrared_bottom") and self.ground is not None:
            return f'follows from ground = "{self.ground}"'
        return super().reason_not_varied(name)

    @property
    def incidence_keys(self) -> tuple[str, ...]:
        return super().incidence_keys if self.sun is None else ("latitude", "longitude")

    @property
    def light_incidence(self) -> Numeric:
        """Incidence of the light: the sun stands above or below."""
        place = self.build_place()
        if place is None:
            return super().light_incidence
        zenith_angle = EarthSun().position_above(place).zenith_angle
        return abs(zenith_angle - np.pi * (zenith_angle > 0.5 * np.pi))

    def build_place(self) -> Place | None:
        if self.sun is None or self.latitude is None or self.longitude is None:
            return None
        return Place.at(self.date, self.latitude.value, self.longitude.value)

    def build_sky(self) -> Daylight | None:
        """The sky of the ephemeris; None for light as given."""
        if self.sun is None:
            return None
        radiation = self.build_radiation()
        ground: AbstractGround = Knocke1988Ground()
        if self.ground is None:
            ground = UniformGround(radiation.albedo, radiation.infrared_below)
        limb = EARTH_LIMB
        if self.limb_height is not None:
            limb = limb.at(self.limb_height.value)
        return Daylight(limb=limb, ground=ground, infrared_above=radiation.infrared_above)


_TABLE = "decides the atmosphere's whole table; give each {} a study of its own"


class Earth(Planetary):
    """Above a place on Earth; the coordinate is the geometric altitude [m].

    Attributes
    ----------
    atmosphere : AbstractAtmosphere
        Default :class:`US1976`.
    gas : AbstractGas
        Default :data:`lightflyer.gas.AIR`. Its gas constant follows the atmosphere's molar mass.
    gravity, radiation, wind, sky, place, floor, dust
        See :class:`Planetary`; by default gravity that falls off with altitude and
        :func:`sunlight`.
    planet : Planet
        Default :data:`EARTH_PLANET`.

    Examples
    --------
    >>> state = Earth().state(70e3)
    >>> print(f"{state.pressure:.4f} Pa, {state.temperature:.2f} K, {state.gravity:.4f} m/s²")
    5.2209 Pa, 219.58 K, 9.5942 m/s²
    """

    atmosphere: AbstractAtmosphere = US1976()
    gas: AbstractGas = AIR
    planet: Planet = field(static=True, kw_only=True, default=EARTH_PLANET)  # type: ignore[misc]

    def assumptions(self) -> tuple[str, ...]:
        """Assumptions but those on the air."""
        return self.assumptions_of_light()

    def assumptions_of_air(self) -> tuple[str, ...]:
        """Which atmosphere is assumed."""
        return (self.atmosphere.describe(),)


def lu2023_earth(
    irradiance: Numeric = constants.SOLAR_CONSTANT_LU2023, incidence: Numeric = 0.0
) -> Earth:
    """Earth as in the paper: its polynomial atmosphere, gas, gravity and rounded constant.

    Nothing is reflected from below, and the thermal surroundings are black at the gas temperature.

    Parameters
    ----------
    irradiance : array
        Sunlight [W/m²].
    incidence : array
        Zenith angle of the light, for a level disk its angle of incidence [rad].

    Returns
    -------
    Earth
    """
    return Earth(
        atmosphere=Lu2023Atmosphere(),
        gas=LU2023_AIR,
        gravity=constants.GRAVITY_LU2023,
        radiation=Radiation(
            irradiance, incidence, stefan_boltzmann=constants.STEFAN_BOLTZMANN_LU2023
        ),
    )


class EarthSection(SkySection):
    """``[environment]``: Earth; each atmosphere is an alternative of its own."""

    planet: ClassVar[Planet] = EARTH_PLANET
    environment: ClassVar[type[Planetary]] = Earth
    default_gas: ClassVar[str] = AIR.name

    kind: Literal["earth"] = "earth"
    gas: Literal[tuple(AIRS)] | None = None  # type: ignore[valid-type]
    surroundings: Literal["earth", "gas"] = "earth"  # type: ignore[assignment]
    wind: WindSection | None = None

    @pydantic.model_validator(mode="after")
    def _wind_is_complete(self) -> "EarthSection":
        if self.wind is not None:
            self.wind.require(self.indices)
        return self

    @property
    def indices(self) -> SolarActivity | None:
        """Activity of the sun and of the geomagnetic field, where the atmosphere has it."""
        return None

    def build_wind(self, atmosphere: AbstractAtmosphere) -> AbstractWind | None:
        return None if self.wind is None else self.wind.build(atmosphere, self.indices)


class Us1976Section(EarthSection):
    """``[environment]``: Earth with the US Standard Atmosphere 1976."""

    atmosphere: Literal["us1976"] = "us1976"

    def build_atmosphere(self) -> AbstractAtmosphere:
        return US1976()


class Lu2023Section(EarthSection):
    """``[environment]``: Earth as in the paper, whose gas, gravity and light it implies."""

    default_gas: ClassVar[str] = LU2023_AIR.name
    default_gravity: ClassVar[float | None] = constants.GRAVITY_LU2023
    stefan_boltzmann: ClassVar[float] = constants.STEFAN_BOLTZMANN_LU2023
    without_ephemeris: ClassVar[str] = '"lu2023" has the light of the paper'

    atmosphere: Literal["lu2023"]
    irradiance: Irradiance = Measured(constants.SOLAR_CONSTANT_LU2023)
    albedo: Fraction = Measured(0.0)
    surroundings: Literal["earth", "gas"] = "gas"

    def build_atmosphere(self) -> AbstractAtmosphere:
        return Lu2023Atmosphere()


class GlobalNrlmsisSection(EarthSection):
    """``[environment]``: Earth with NRLMSIS 2.1 of every place and time, for missions."""

    not_varied: ClassVar[Mapping[str, str]] = {
        **EarthSection.not_varied,
        **dict.fromkeys(("f107", "f107a", "ap"), _TABLE.format("activity")),
    }

    atmosphere: Literal["nrlmsis-global"]
    f107: SolarFlux
    f107a: SolarFlux | None = None
    ap: GeomagneticIndex

    @property
    def indices(self) -> SolarActivity:
        mean = None if self.f107a is None else self.f107a.value
        return SolarActivity.of(self.f107.value, mean, self.ap.value)

    def build_atmosphere(self) -> AbstractAtmosphere:
        return GlobalNRLMSIS(**self.indices._asdict())


class NrlmsisSection(GlobalNrlmsisSection):
    """``[environment]``: Earth with NRLMSIS 2.1 for a day and place."""

    not_varied: ClassVar[Mapping[str, str]] = {
        **GlobalNrlmsisSection.not_varied,
        **dict.fromkeys(("latitude", "longitude"), _TABLE.format("place")),
    }

    place_matters: ClassVar[bool] = True

    atmosphere: Literal["nrlmsis"]  # type: ignore[assignment]
    date: datetime.datetime
    latitude: Latitude
    longitude: Longitude

    def build_atmosphere(self) -> AbstractAtmosphere:
        place = self.latitude.value, self.longitude.value
        return NRLMSIS(self.date, *place, **self.indices._asdict())
