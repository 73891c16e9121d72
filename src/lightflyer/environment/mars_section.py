"""``[environment]`` of a flyer file: Mars."""

import datetime
import math
from dataclasses import replace
from typing import ClassVar, Literal

import pydantic

from lightflyer.array.namespace import Numeric
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
from lightflyer.environment.atmosphere.mars import SURFACE_PRESSURE, MarsAtmosphere
from lightflyer.environment.base import Place
from lightflyer.environment.light.dust import OPTICAL_DEPTH, Dust
from lightflyer.environment.light.ground import UniformGround
from lightflyer.environment.light.mars_sun import NOON, MarsSun, zenith_angle_in_season
from lightflyer.environment.light.sky import AbstractSky
from lightflyer.environment.mars import (
    MARS_SKY,
    Mars,
    air_of_mars,
    season_irradiance,
)
from lightflyer.environment.planet import MARS_PLANET, Planet
from lightflyer.environment.planetary import Planetary, PlanetSection
from lightflyer.environment.radiation import Radiation
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE
from lightflyer.gas.registry import CARBON_DIOXIDES

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
        self._check_sun()
        pairs = [("irradiance", "solar_longitude"), ("incidence", "latitude")]
        if self.sun is not None:
            pairs = [(key, "sun") for key in _GIVEN_LIGHT]
        for key, beside in pairs:
            if getattr(self, beside) is not None and key in self.model_fields_set:
                raise ConfigurationError(
                    f"{key} has no effect beside {beside}, which decides it; remove one"
                )
        return self

    def _check_sun(self) -> None:
        missing = [key for key in _PLACE if getattr(self, key) is None]
        if self.sun is not None:
            if missing:
                raise ConfigurationError(f"{_EPHEMERIS} needs {', '.join(missing)} as well")
            if self.default_infrared[1] is None and self.infrared_bottom is None:
                raise ConfigurationError(
                    f"{_EPHEMERIS} needs a number for the heat radiation from below: "
                    "infrared_bottom"
                )
            return
        for key in ("date", "longitude"):
            if getattr(self, key) is not None:
                raise ConfigurationError(f"{key} has no effect without {_EPHEMERIS}")
        if self.latitude is not None and self.solar_longitude is None:
            raise ConfigurationError("latitude needs solar_longitude for the height of the sun")
        if self.latitude is None and "local_time" in self.model_fields_set:
            raise ConfigurationError("local_time has no effect without latitude")

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
