"""A planet as data: size, rotation, gravity, and the light and heat over it.

Another planet is one more :class:`Planet`; with an atmosphere it is a
:class:`~lightflyer.environment.planetary.Planetary`.
"""

import math
from typing import Any, Final

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point, reads_units
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    Acceleration,
    Altitude,
    Angle,
    Checked,
    Flattening,
    Fraction,
    Infrared,
    Irradiance,
    PlanetRadius,
    RotationRate,
)
from lightflyer.environment.horizon import EARTH_LIMB, Limb
from lightflyer.environment.radiation import EARTH_ALBEDO, EARTH_INFRARED, SKY_INFRARED, Radiation


class Planet(Checked):
    r"""An ellipsoid of revolution that turns about its polar axis, in its sun's light.

    Motion over a planet needs its size and rotation alone. Numbers that are None must come from
    elsewhere.

    Attributes
    ----------
    name : str
    radius : array
        Mean radius :math:`(2a+b)/3` of the equatorial radius a and the polar radius b [m].
    rotation_rate : array
        Angular velocity against the stars, positive towards the east [rad/s].
    flattening : array
        :math:`(a-b)/a` [1]; zero makes a sphere.
    gravity : array or None
        Acceleration of free fall at altitude zero [m/s²].
    irradiance : array or None
        Sunlight above the air, mean over the year [W/m²].
    albedo : array
        Share of sunlight that leaves the planet again [1].
    infrared : array or None
        Heat radiation that leaves the planet [W/m²]; None for black ground at the gas temperature.
    effective_radius : array or None
        Distance from the centre at altitude zero with which gravity and the view of the ground
        fall off [m]; None for ``radius``.
    limb : Limb or None
        Edge behind which the sun sets, for light by date and place.
    highest_searched : float
        Altitude above which no search looks by itself [m].

    Raises
    ------
    ParameterError
        If a concrete value is out of its range.

    Examples
    --------
    >>> print(f"{EARTH_PLANET.equatorial_radius / 1e3:.3f} km")
    6378.137 km
    """

    name: str = field(static=True)
    radius: PlanetRadius
    rotation_rate: RotationRate
    flattening: Flattening = 0.0
    gravity: Acceleration | None = None
    irradiance: Irradiance | None = None
    albedo: Fraction = 0.0
    infrared: Infrared | None = None
    effective_radius: PlanetRadius | None = None
    limb: Limb | None = None
    highest_searched: float = field(static=True, default=math.inf)

    @property
    def equatorial_radius(self) -> Any:
        """Radius of the equator [m]."""
        return self.radius / (1.0 - self.flattening / 3.0)

    @reads_units
    def view_from(self, altitude: Altitude) -> Any:
        """View factor to the planet of a face that looks straight down from an altitude [m]."""
        radius = self.radius if self.effective_radius is None else self.effective_radius
        return (radius / (radius + altitude)) ** 2

    @reads_units
    def gravity_at(self, altitude: Altitude) -> Any:
        """Acceleration of free fall at an altitude [m], without the planet's rotation [m/s²]."""
        return self._number("gravity") * self.view_from(altitude)  # the same inverse square

    def sunlight(self) -> Radiation:
        """Sunlight from overhead above the air, and what the planet reflects and radiates."""
        return Radiation(
            self._number("irradiance"),
            albedo=self.albedo,
            infrared_above=None if self.infrared is None else SKY_INFRARED,
            infrared_below=self.infrared,
        )

    def _number(self, name: str) -> Numeric:
        value = getattr(self, name)
        if value is None:
            raise ParameterError(f"the planet {self.name} has no {name}; give it one")
        return value

    @entry_point
    def curvature_radius(self, latitude: Angle, azimuth: Angle) -> Array:
        r"""Radius of curvature of the ellipsoid along a direction [m]; ``latitude``: geodetic."""
        # .. math:: \frac1{R} = \frac{\cos^2 A}{M} + \frac{\sin^2 A}{N}
        #
        # with the radii of curvature M of the meridian and N of the prime vertical.
        #
        # Euler's theorem on the curvature of surfaces. Differentiable.
        flattening = self.flattening
        eccentricity_squared = flattening * (2.0 - flattening)
        root = 1.0 - eccentricity_squared * xp.sin(latitude) ** 2
        across = self.equatorial_radius / xp.sqrt(root)
        along = across * (1.0 - eccentricity_squared) / root
        return 1.0 / (xp.cos(azimuth) ** 2 / along + xp.sin(azimuth) ** 2 / across)


EARTH_PLANET: Final = Planet(
    name="Earth",
    radius=6_371_008.7714,
    rotation_rate=7.292115e-5,
    flattening=1.0 / 298.257223563,
    gravity=constants.STANDARD_GRAVITY,
    irradiance=constants.TOTAL_SOLAR_IRRADIANCE,
    albedo=EARTH_ALBEDO,
    infrared=EARTH_INFRARED,
    effective_radius=constants.EARTH_EFFECTIVE_RADIUS,
    limb=EARTH_LIMB,
    highest_searched=150e3,  # above, the gas carries no film
)
"""Earth: size and rotation by the World Geodetic System 1984, [NIMA2000]_, gravity by
[USSA1976]_ Eq. (17)."""

MARS_SEMI_MAJOR_AXIS, MARS_ECCENTRICITY = 1.52367934, 0.0934
"""Of the orbit of Mars about the year 2000 [au], [1]; [AllisonMcEwen2000]_."""

# Rays are bent by less than 0.01° in the thin air of Mars; it is dust that dims them.
MARS_LIMB: Final = Limb(height=0.0, refractivity=3.5e-6, scale_height=9e3)
"""The edge of Mars: the ground at altitude 0."""

_MARS_RADIUS = 3_389_527.0  # [m]

MARS_PLANET: Final = Planet(
    name="Mars",
    radius=_MARS_RADIUS,
    rotation_rate=7.0882181e-5,
    flattening=0.005886,
    gravity=constants.MARS_GRAVITATIONAL_PARAMETER / _MARS_RADIUS**2,
    # mean over the year of the sunlight on an orbit
    irradiance=constants.TOTAL_SOLAR_IRRADIANCE
    / (MARS_SEMI_MAJOR_AXIS**2 * math.sqrt(1.0 - MARS_ECCENTRICITY**2)),
    # [JPLD8160]: within 30° of the equator 0.18 to 0.28 without dust storms
    albedo=0.25,
    # [Creecy2022]: global mean of day and night, 111.7 ± 2.4 W/m². Below the overhead sun it is
    # about 390, over the polar caps 30 [JPLD8160].
    infrared=112.0,
    limb=MARS_LIMB,
    highest_searched=130e3,  # top of the reference atmosphere
)
"""Mars; size and rotation by [Archinal2018]_. Gravity is without the planet's rotation, which
takes 0.5 % of it at the equator."""
