"""The sky of a place: sun, reflected light and heat radiation by altitude, place and time."""

import abc
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, short_repr
from lightflyer.core import constants
from lightflyer.core.checks import require_data
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude, Checked, Irradiance
from lightflyer.core.text import span
from lightflyer.environment.base import Place
from lightflyer.environment.horizon import (
    EARTH_LIMB,
    Limb,
    horizon_depression,
    lit_ground,
    visible_share,
)
from lightflyer.environment.light.ground import AbstractGround, UniformGround
from lightflyer.environment.light.sun import (
    AbstractSun,
    EarthSun,
    SunInSky,
    TabulatedSun,
    sun_in_sky,
)
from lightflyer.environment.planet import EARTH_PLANET, Planet
from lightflyer.environment.radiation import SKY_INFRARED, Radiation

VIEW_OF_PLANET = "(R/(R+h))² at altitude h"  # View factor of the ground, in words

_KILOMETRE = 1e3
_TURN = 2.0 * np.pi
_PASSES = 6  # towards a sunrise; each takes off all but a few percent of what is left


class AbstractSky(Module):
    """Light and heat radiation by altitude, place and time. Subclasses are final."""

    @abc.abstractmethod
    def radiation(self, altitude: Altitude, place: Place) -> Radiation:
        """Light and heat radiation at a geometric altitude [m], with the view factor to the ground.

        Beyond the data a concrete place raises :class:`ParameterError`; a traced one gives NaN.
        """

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        """How far the data still reach at an altitude [m]; see :meth:`AbstractGround.margins`."""
        return {}

    @abc.abstractmethod
    def assumptions(self) -> tuple[str, ...]:
        """What is assumed about light and heat radiation, in short texts with units."""


class LightHours(NamedTuple):
    """When the sun is above a flyer's horizon, on the day around a time."""

    #: The sun's centre rises past the horizon, stands highest, and sets [s since 2000-01-01 12:00
    #: UTC]. The first and the last are NaN where the sun does not rise or set
    first: Array
    noon: Array  #: As ``first``
    last: Array  #: As ``first``
    #: Of a day with the sun as at noon, with light [1]; one without night, zero without day
    share: Array

    def __repr__(self) -> str:
        return short_repr(self)


class Daylight(AbstractSky, Checked):
    """Sunlight by the ephemeris, and what a planet reflects and radiates.

    The sun is an evenly bright disk that the limb hides smoothly. After sunset on the ground it
    lights a flyer from below. The ground is lit by the sun's height over each part of it in sight
    and reflects diffusely; a tilted face sees it evenly bright. Between limb and space, air
    neither dims nor scatters light, and the direction of light is that without refraction.


    Examples
    --------
    At the equator, 75 km up, at an equinox:

    >>> from lightflyer.environment import Place
    >>> hours = Daylight().light_hours(75e3, Place.at("2026-03-20T12:00Z", 0.0, 0.0))
    >>> print(f"{(hours.last - hours.first) / 3600.0:.2f} h of light")
    13.01 h of light
    """

    sun: AbstractSun = EarthSun()
    planet: Planet = EARTH_PLANET  #: Its size and shape decide the horizon
    limb: Limb = EARTH_LIMB  #: The edge that hides the sun
    ground: AbstractGround = UniformGround()  #: Albedo and heat radiation from below
    #: Sunlight at one astronomical unit [W/m²]
    irradiance: Irradiance = constants.TOTAL_SOLAR_IRRADIANCE
    #: Heat radiation from above [W/m²]; None for black surroundings at the gas temperature
    infrared_above: Irradiance | None = SKY_INFRARED

    def radiation(self, altitude: Altitude, place: Place) -> Radiation:
        require_data(self.ground.margins(place))
        return _daylight(self, altitude, place)

    def over(self, start: float, stop: float) -> "Daylight":
        """The same sky with the sun from a table, for many evaluations between two times."""
        return replace(self, sun=TabulatedSun(self.sun, self.planet.rotation_rate, start, stop))

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        return self.ground.margins(place)

    def depression(self, altitude: Altitude, place: Place, sun: SunInSky) -> Array:
        """Angle below the horizontal at which the limb hides the sun's centre [rad]."""
        radius = self.planet.curvature_radius(place.latitude, sun.azimuth)
        return horizon_depression(self.limb, altitude, radius)

    @entry_point
    def light_hours(self, altitude: Altitude, place: Place) -> LightHours:
        """First and last light of the day around a time; ``altitude``: geometric altitude."""
        # The sun's centre is on the horizon at first and last light; the edges of its disk are
        # about a minute before and after it at the equator. Differentiable where the sun rises.
        moving = self.planet.rotation_rate

        def turn(time: Array) -> tuple[Array, Array]:
            """Angle that the planet has turned since noon, and cosine of that at sunset."""
            # a cosine beyond ±1 is that of a sun which stays above or below the horizon
            sun = self.sun.position(time)
            x, y, z = (sun.direction[..., axis] for axis in range(3))
            angle = xp.mod(place.longitude - xp.arctan2(y, x) + np.pi, _TURN) - np.pi
            seen = sun_in_sky(sun, place.latitude, place.longitude)
            depression = self.depression(altitude, place._replace(time=time), seen)
            above = xp.sin(depression) + xp.sin(place.latitude) * z
            return angle, -above / (xp.cos(place.latitude) * xp.hypot(x, y))

        def search(side: float, start: Array) -> Array:
            """Noon at side 0, first light at -1, last at 1."""
            time = start
            for _ in range(_PASSES):
                angle, sunset = turn(time)
                time = time + (side * xp.arccos(xp.clip(sunset, -1.0, 1.0)) - angle) / moving
            return time

        shape = xp.broadcast_shapes(*(xp.shape(part) for part in (altitude, *place)))
        noon = search(0.0, place.time + xp.zeros(shape))
        _, sunset = turn(noon)
        half_day = xp.arccos(xp.clip(sunset, -1.0, 1.0))
        first, last = (
            xp.where(xp.abs(sunset) < 1.0, search(side, noon + side * half_day / moving), np.nan)
            for side in (-1.0, 1.0)
        )
        return LightHours(first, noon, last, half_day / np.pi)

    def assumptions(self) -> tuple[str, ...]:
        heat = (
            "black surroundings at the gas temperature"
            if self.infrared_above is None
            else f"{span(self.infrared_above)} W/m²"
        )
        height = np.asarray(self.limb.height) / _KILOMETRE
        return (
            f"sun: by date and place, {span(self.irradiance)} W/m² at 1 au",
            f"horizon: limb of {self.planet.name} at {span(height)} km, with refraction; "
            "no dimming by the air above it",
            *self.ground.describe(),
            f"infrared from above: {heat}",
            f"view factor of the ground: {VIEW_OF_PLANET}",
        )


@entry_point
def _daylight(sky: Daylight, altitude: Altitude, place: Place) -> Radiation:
    sun = sky.sun.position_above(place)
    angular_radius = xp.arcsin(constants.SOLAR_RADIUS / sun.distance)
    ground_view = (sky.planet.radius / (sky.planet.radius + altitude)) ** 2
    elevation = 0.5 * np.pi - sun.zenith_angle + sky.depression(altitude, place, sun)
    astronomical_units = sun.distance / constants.ASTRONOMICAL_UNIT
    return Radiation(
        irradiance=sky.irradiance / astronomical_units**2,
        zenith_angle=sun.zenith_angle,
        azimuth=sun.azimuth,
        albedo=sky.ground.albedo_at(place),
        infrared_above=sky.infrared_above,
        infrared_below=sky.ground.infrared_at(place),
        ground_view=ground_view,
        visible=visible_share(elevation, angular_radius),
        angular_radius=angular_radius,
        lit_ground=lit_ground(sun.zenith_angle, ground_view),
    )


def describe_shadow(altitudes: np.ndarray, visible: np.ndarray | None) -> tuple[str, ...]:
    """Which altitudes the planet's shadow covers, in words; ``altitudes`` (n,)."""
    if visible is None or np.all(visible >= 1.0):
        return ()
    dark, full = altitudes[visible <= 0.0], altitudes[visible >= 1.0]
    if dark.size == altitudes.size:
        return ("shadow: no sun at any altitude",)
    parts = [f"no sun up to {dark[-1] / _KILOMETRE:.1f} km"] if dark.size else []
    parts += (
        [f"all of it from {full[0] / _KILOMETRE:.1f} km"] if full.size else ["nowhere all of it"]
    )
    return ("shadow: " + ", ".join(parts),)
