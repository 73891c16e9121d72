"""Keys of ``[environment]`` that take the light from the sun's place by date and place."""

import abc
import datetime
from typing import ClassVar, Literal

import numpy as np
import pydantic

from lightflyer.array.namespace import Numeric
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Altitude, Latitude, Longitude
from lightflyer.environment.base import Place
from lightflyer.environment.horizon import EARTH_LIMB
from lightflyer.environment.light.ground import AbstractGround, Knocke1988Ground, UniformGround
from lightflyer.environment.light.sky import Daylight
from lightflyer.environment.light.sun import EarthSun
from lightflyer.environment.planetary import PlanetSection

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
