"""Mars: its air, gravity, dust and sunlight, and how a flyer file says it."""

import datetime
import math
from dataclasses import replace
from typing import ClassVar, Final, Literal

import pydantic

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Latitude,
    LocalTime,
    Longitude,
    OpticalDepth,
    Pressure,
    SolarLongitude,
    TemperatureOffset,
)
from lightflyer.core.units import Measured
from lightflyer.environment.atmosphere.mars import MOLAR_MASS, SURFACE_PRESSURE, MarsAtmosphere
from lightflyer.environment.base import AbstractAtmosphere, Place
from lightflyer.environment.light.ground import UniformGround
from lightflyer.environment.light.mars import (
    NOON,
    OPTICAL_DEPTH,
    Dust,
    MarsSun,
    distance_in_season,
    zenith_angle_in_season,
)
from lightflyer.environment.light.sky import AbstractSky, Daylight
from lightflyer.environment.planet import MARS_LIMB, MARS_PLANET, Planet
from lightflyer.environment.planetary import Planetary, PlanetSection
from lightflyer.environment.radiation import SKY_INFRARED, Radiation
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE
from lightflyer.gas.pure import CARBON_DIOXIDES

_GAS_CONSTANT = 1e3 * constants.BOLTZMANN * constants.AVOGADRO  # [J/(kmol K)]


def air_of_mars(gas: AbstractGas = CARBON_DIOXIDE) -> AbstractGas:
    """Carbon dioxide with the gas constant of the air of Mars.

    Parameters
    ----------
    gas : AbstractGas

    Returns
    -------
    AbstractGas
        Viscosity, conductivity and heat capacity per gas constant stay those of pure carbon
        dioxide; 5 % of nitrogen and argon change them by 1 %.
    """
    return tree.replace_at(lambda gas: gas.specific_gas_constant, gas, _GAS_CONSTANT / MOLAR_MASS)


@entry_point
def season_irradiance(solar_longitude: Numeric) -> Array:
    """Sunlight above the air of Mars by season [W/m²]; on a surface that faces the sun."""
    return constants.TOTAL_SOLAR_IRRADIANCE / distance_in_season(solar_longitude) ** 2


def mars_sunlight(
    solar_longitude: Numeric | None = None,
    latitude: Numeric | None = None,
    local_time: Numeric = NOON,
    *,
    albedo: Numeric = MARS_PLANET.albedo,
    infrared_above: Numeric | None = SKY_INFRARED,
    infrared_below: Numeric | None = MARS_PLANET.infrared,
) -> Radiation:
    """Sunlight above Mars by season, latitude and hour, with light and heat from below.

    Parameters
    ----------
    solar_longitude : array, optional
        Areocentric longitude of the sun [deg]; None for the mean over the year.
    latitude : array, optional
        [deg]; None for a sun overhead.
    local_time : array
        Local true solar time, of 24 hours in a sol; of effect with a latitude.
    albedo : array
        Share of sunlight that Mars reflects [1].
    infrared_above, infrared_below : array or None
        Heat radiation from the sky and from Mars [W/m²]; None for black surroundings at the gas
        temperature.

    Returns
    -------
    Radiation
        Before dust dims it.

    Raises
    ------
    ConfigurationError
        If a latitude is given without a season.

    Examples
    --------
    >>> light = mars_sunlight(solar_longitude=90.0, latitude=25.0, local_time=15.0)
    >>> print(f"{light.irradiance:.0f} W/m², {light.zenith_angle / RADIANS_PER_DEGREE:.1f}°")
    496 W/m², 40.6°
    """
    if solar_longitude is None and latitude is not None:
        raise ConfigurationError("the sun's height at a latitude needs a solar_longitude")
    irradiance: Numeric = MARS_PLANET.irradiance
    zenith_angle: Numeric = 0.0
    if solar_longitude is not None:
        season = solar_longitude * RADIANS_PER_DEGREE
        irradiance = season_irradiance(season)
        if latitude is not None:
            at = latitude * RADIANS_PER_DEGREE
            zenith_angle = zenith_angle_in_season(season, at, local_time)
    return Radiation(
        irradiance,
        zenith_angle,
        albedo=albedo,
        infrared_above=infrared_above,
        infrared_below=infrared_below,
    )


MARS_SKY: Final = Daylight(
    sun=MarsSun(),
    planet=MARS_PLANET,
    limb=MARS_LIMB,
    ground=UniformGround(MARS_PLANET.albedo, MARS_PLANET.infrared),
)
"""Sunlight above Mars by date and place, before dust dims it."""


class Mars(Planetary):
    """Above a place on Mars; the coordinate is the altitude above the areoid [m].

    Attributes
    ----------
    atmosphere : AbstractAtmosphere
        Default :class:`MarsAtmosphere`.
    gas : AbstractGas
        Default carbon dioxide with the gas constant of the air of Mars, :func:`air_of_mars`.
    gravity, radiation, wind, sky, place, floor
        See :class:`Planetary`; by default gravity that falls off with altitude and
        :func:`mars_sunlight`. A sky is such as :data:`MARS_SKY`.
    planet : Planet
        Default :data:`MARS_PLANET`.
    dust : Dust or None
        Dims the beam and scatters light down; None for clear air.

    Notes
    -----
    The albedo is that of Mars as seen from above, its dust included: dust below the flyer is not
    counted once more.

    Examples
    --------
    >>> state = Mars().state(60e3)
    >>> print(f"{state.pressure:.3f} Pa, {state.temperature:.1f} K, {state.gravity:.3f} m/s²")
    0.881 Pa, 144.2 K, 3.599 m/s²
    """

    atmosphere: AbstractAtmosphere = field(default_factory=MarsAtmosphere)
    gas: AbstractGas = air_of_mars()
    planet: Planet = field(static=True, kw_only=True, default=MARS_PLANET)  # type: ignore[misc]
    dust: Dust | None = field(default=Dust(), kw_only=True)


_PLACE = ("date", "latitude", "longitude")
_GIVEN_LIGHT = ("irradiance", "incidence", "solar_longitude", "local_time")
_EPHEMERIS = 'sun = "ephemeris"'


class MarsSection(PlanetSection):
    """``[environment]``: Mars with the reference atmosphere of COSPAR."""

    # The light is given by irradiance and incidence, by season, latitude and local solar time, or
    # by the sun's ephemeris.

    planet: ClassVar[Planet] = MARS_PLANET
    environment: ClassVar[type[Planetary]] = Mars

    kind: Literal["mars"]
    sun: Literal["ephemeris"] | None = None
    date: datetime.datetime | None = None
    gas: Literal[tuple(CARBON_DIOXIDES)] | None = None  # type: ignore[valid-type]
    surface_pressure: Pressure = Measured(SURFACE_PRESSURE)
    temperature_offset: TemperatureOffset = Measured(0.0)
    solar_longitude: SolarLongitude | None = None
    latitude: Latitude | None = None
    longitude: Longitude | None = None
    local_time: LocalTime = Measured(NOON)
    surroundings: Literal["mars", "gas"] = "mars"  # type: ignore[assignment]
    dust_optical_depth: OpticalDepth = Measured(OPTICAL_DEPTH)

    @pydantic.model_validator(mode="after")
    def _one_light(self) -> "MarsSection":
        pairs = [("irradiance", "solar_longitude"), ("incidence", "latitude")]
        if self.sun is not None:
            pairs = [(key, "sun") for key in _GIVEN_LIGHT]
            if missing := [key for key in _PLACE if getattr(self, key) is None]:
                raise ConfigurationError(f"{_EPHEMERIS} needs {', '.join(missing)} as well")
            if self.default_infrared[1] is None and self.infrared_bottom is None:
                raise ConfigurationError(
                    f"{_EPHEMERIS} needs a number for the heat radiation from below: "
                    "infrared_bottom"
                )
        else:
            for key in ("date", "longitude"):
                if getattr(self, key) is not None:
                    raise ConfigurationError(f"{key} has no effect without {_EPHEMERIS}")
            if self.latitude is not None and self.solar_longitude is None:
                raise ConfigurationError("latitude needs solar_longitude for the height of the sun")
            if self.latitude is None and "local_time" in self.model_fields_set:
                raise ConfigurationError("local_time has no effect without latitude")
        for key, beside in pairs:
            if getattr(self, beside) is not None and key in self.model_fields_set:
                raise ConfigurationError(
                    f"{key} has no effect beside {beside}, which decides it; remove one"
                )
        return self

    def reason_not_varied(self, name: str) -> str | None:
        """Season and hour decide the light where they are given."""
        if self.sun is not None and name in _GIVEN_LIGHT:
            return "follows from date and place"
        if name == "irradiance" and self.solar_longitude is not None:
            return "follows from solar_longitude"
        if name == "incidence" and self.latitude is not None:
            return "follows from latitude and local_time"
        if name in ("latitude", "longitude", "local_time") and self.latitude is None:
            return "has no effect without a season or a date"
        return super().reason_not_varied(name)

    @property
    def incidence_keys(self) -> tuple[str, ...]:
        if self.sun is not None:
            return ("latitude", "longitude")
        season = ("solar_longitude", "latitude", "local_time")
        return super().incidence_keys if self.latitude is None else season

    @property
    def light_incidence(self) -> Numeric:
        """Incidence of the light: the sun stands above or below."""
        angle = self._zenith_angle
        return abs(angle - math.pi * (angle > 0.5 * math.pi))

    @property
    def _zenith_angle(self) -> Numeric:
        place = self.build_place()
        if place is not None:
            return MarsSun().position_above(place).zenith_angle
        if self.latitude is None or self.solar_longitude is None:
            return self.incidence.value * RADIANS_PER_DEGREE
        season, latitude = (
            angle.value * RADIANS_PER_DEGREE for angle in (self.solar_longitude, self.latitude)
        )
        return zenith_angle_in_season(season, latitude, self.local_time.value)

    def build_place(self) -> Place | None:
        if self.sun is None or self.latitude is None or self.longitude is None:
            return None
        return Place.at(self.date, self.latitude.value, self.longitude.value)

    def build_atmosphere(self) -> MarsAtmosphere:
        return MarsAtmosphere(
            surface_pressure=self.surface_pressure.value,
            temperature_offset=self.temperature_offset.value,
        )

    def build_gas(self) -> AbstractGas:
        return air_of_mars(CARBON_DIOXIDES[self.gas or CARBON_DIOXIDE.name])

    def build_dust(self) -> Dust:
        return Dust(self.dust_optical_depth.value)

    def build_radiation(self) -> Radiation:
        """Light by season and hour where they are given."""
        radiation = super().build_radiation()
        if self.solar_longitude is None:
            return radiation
        season = self.solar_longitude.value * RADIANS_PER_DEGREE
        return replace(
            radiation, irradiance=season_irradiance(season), zenith_angle=self._zenith_angle
        )

    def build_sky(self) -> AbstractSky | None:
        if self.sun is None:
            return None
        radiation = self.build_radiation()
        ground = UniformGround(radiation.albedo, radiation.infrared_below)
        return replace(MARS_SKY, ground=ground, infrared_above=radiation.infrared_above)
