"""Mars: its air, gravity, dust and sunlight."""

import math
from dataclasses import replace
from typing import Final

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.environment.altitude import altitude_coordinate, describe_floor
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.atmosphere.mars import (
    MOLAR_MASS,
    MarsAtmosphere,
    mars_gravity,
)
from lightflyer.environment.base import (
    AbstractEnvironment,
    Coordinate,
    EnvironmentState,
    Place,
)
from lightflyer.environment.dust import Dust, dusty_light
from lightflyer.environment.ground import UniformGround
from lightflyer.environment.horizon import Limb
from lightflyer.environment.mars_sun import (
    ECCENTRICITY,
    NOON,
    SEMI_MAJOR_AXIS,
    MarsSun,
    distance_in_season,
    zenith_angle_in_season,
)
from lightflyer.environment.planet import MARS_PLANET, Planet
from lightflyer.environment.radiation import SKY_INFRARED, Radiation
from lightflyer.environment.sky import VIEW_OF_PLANET, AbstractSky, Daylight
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.quantity import (
    RADIANS_PER_DEGREE,
    Acceleration,
    Length,
)
from lightflyer.foundation.types import Numeric
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE

MARS_ALBEDO: Final = 0.25
"""Share of sunlight that Mars reflects [1]: within 30° of the equator 0.18 to 0.28 without dust
storms; [JPLD8160]_."""

MARS_INFRARED: Final = 112.0
"""Heat radiation that leaves Mars: global mean of day and night, 111.7 ± 2.4 W/m² [W/m²];
[Creecy2022]_. Below the overhead sun it is about 390, over the polar caps 30; [JPLD8160]_."""

MEAN_IRRADIANCE: Final = constants.TOTAL_SOLAR_IRRADIANCE / (
    SEMI_MAJOR_AXIS**2 * math.sqrt(1.0 - ECCENTRICITY**2)
)
"""Sunlight above the air of Mars, mean over its year [W/m²]."""

DEFAULT_ALTITUDES = tuple(1e3 * kilometres for kilometres in range(30, 81, 5))
"""Altitudes reported one by one where none are asked for [m]."""

_HIGHEST_SEARCHED = 130e3  # top of the reference atmosphere [m]
_GAS_CONSTANT = 1e3 * constants.BOLTZMANN * constants.AVOGADRO  # [J/(kmol K)]

# Rays are bent by less than 0.01° in the thin air of Mars; it is dust that dims them.
MARS_LIMB: Final = Limb(height=0.0, refractivity=3.5e-6, scale_height=9e3)
"""The edge of Mars: the ground at altitude 0."""


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
    return eqx.tree_at(lambda gas: gas.specific_gas_constant, gas, _GAS_CONSTANT / MOLAR_MASS)


@entry_point
def season_irradiance(solar_longitude: Numeric) -> Array:
    """Sunlight above the air of Mars by season.

    Parameters
    ----------
    solar_longitude : array, shape (...)
        Areocentric longitude of the sun [rad].

    Returns
    -------
    array, shape (...)
        On a surface that faces the sun [W/m²].

    Examples
    --------
    >>> print(f"{season_irradiance(251.0 * 3.14159 / 180.0):.0f} W/m² at perihelion")
    713 W/m² at perihelion
    """
    return constants.TOTAL_SOLAR_IRRADIANCE / distance_in_season(solar_longitude) ** 2


def mars_sunlight(
    solar_longitude: Numeric | None = None,
    latitude: Numeric | None = None,
    local_time: Numeric = NOON,
    *,
    albedo: Numeric = MARS_ALBEDO,
    infrared_above: Numeric | None = SKY_INFRARED,
    infrared_below: Numeric | None = MARS_INFRARED,
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
    irradiance: Numeric = MEAN_IRRADIANCE
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
    ground=UniformGround(MARS_ALBEDO, MARS_INFRARED),
)
"""Sunlight above Mars by date and place, before dust dims it."""


class Mars(AbstractEnvironment):
    """Above a place on Mars; the coordinate is the altitude above the areoid [m].

    Attributes
    ----------
    atmosphere : AbstractAtmosphere
        Default :class:`MarsAtmosphere`.
    gas : AbstractGas
        Default carbon dioxide with the gas constant of the air of Mars, :func:`air_of_mars`.
    gravity : array or None
        Constant gravity [m/s²]; None lets it fall off with altitude.
    radiation : Radiation
        Sunlight above the air, and thermal surroundings; default :func:`mars_sunlight`.
    dust : Dust or None
        Dims the beam and scatters light down; None for clear air.
    wind : AbstractWind or None
        Wind where a place is given; None for gas at rest.
    sky : AbstractSky or None
        Light and heat radiation where a place is given, such as :data:`MARS_SKY`; None leaves
        them to ``radiation``.
    place : Place or None
        Where and when, in place of none: with a sky, ``radiation`` becomes that of the place, as
        a flyer above dust and horizon has it.
    floor : array or None
        Distance down to solid ground, or to a platform, at every altitude [m]; None for open air.
        It changes what the gas does to the flyer, not the light.

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

    atmosphere: AbstractAtmosphere = eqx.field(default_factory=MarsAtmosphere)
    gas: AbstractGas = air_of_mars()
    gravity: Acceleration | None = None
    radiation: Radiation = mars_sunlight()
    dust: Dust | None = Dust()
    wind: AbstractWind | None = None
    sky: AbstractSky | None = None
    place: Place | None = None
    floor: Length | None = None

    def __post_init__(self) -> None:
        if self.sky is None or self.place is None:
            return
        full = self.sky.radiation(self.atmosphere.altitude_range[1], self.place)
        self.radiation = replace(full, visible=None, ground_view=None, lit_ground=None)

    @property
    def planet(self) -> Planet:
        """See :attr:`AbstractEnvironment.planet`."""
        return MARS_PLANET

    @property
    def coordinate(self) -> Coordinate:
        """Altitude above the areoid, over the atmosphere's range."""
        return altitude_coordinate(
            self.atmosphere.altitude_range, _HIGHEST_SEARCHED, DEFAULT_ALTITUDES
        )

    def assumptions(self) -> tuple[str, ...]:
        """See :meth:`AbstractEnvironment.assumptions`."""
        told = self.radiation.describe(VIEW_OF_PLANET)
        if self.sky is not None and self.place is not None:
            told = f"{told[0]}, {self.place.describe()}", *self.sky.assumptions()
        return (*told, *describe_floor(self.floor), *self.assumptions_of_air())

    def assumptions_of_air(self) -> tuple[str, ...]:
        """See :meth:`AbstractEnvironment.assumptions_of_air`: atmosphere, dust, gas."""
        dust = "dust: none" if self.dust is None else self.dust.describe()
        return (self.atmosphere.describe(), dust, *self.gas.assumptions())

    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:
        """Surroundings at an altitude.

        Parameters
        ----------
        coordinate : array, shape (...)
            Altitude above the areoid [m].
        place : Place, optional
            Where and when, for the wind and the sky; by default its own.

        Returns
        -------
        EnvironmentState

        Raises
        ------
        ParameterError
            If a concrete altitude is outside the atmosphere's range; traced ones give NaN.
        """
        altitude = self.coordinate.quantity.number("altitude", coordinate)
        require_range("altitude [m]", altitude, *self.atmosphere.altitude_range)
        place = self.place if place is None else place
        state = _state(self, altitude, place)
        if self.wind is None or place is None:
            return state
        return replace(state, wind=self.wind.velocity(altitude, place))


@entry_point
def _state(mars: Mars, altitude: Numeric, place: Place | None) -> EnvironmentState:
    radiation = mars.radiation
    if mars.sky is not None and place is not None:
        radiation = mars.sky.radiation(altitude, place)
    pressure = mars.atmosphere.pressure(altitude, place)
    if mars.dust is not None:
        radiation = _dimmed(mars.dust, mars.atmosphere, radiation, altitude, place)
    view = (MARS_PLANET.radius / (MARS_PLANET.radius + altitude)) ** 2
    return EnvironmentState(
        pressure=pressure,
        temperature=mars.atmosphere.temperature(altitude, place),
        gravity=mars_gravity(altitude) if mars.gravity is None else mars.gravity,
        gas=mars.gas,
        radiation=radiation.seen_from(view),
        floor_distance=mars.floor,
    )


def _dimmed(
    dust: Dust,
    atmosphere: AbstractAtmosphere,
    radiation: Radiation,
    altitude: Numeric,
    place: Place | None,
) -> Radiation:
    """Light below the dust above a place."""
    distance = MARS_PLANET.radius + altitude
    cosine = jnp.cos(radiation.zenith_angle)
    # where a ray from below the horizontal comes nearest to the ground
    lowest = jnp.maximum(distance * jnp.sin(radiation.zenith_angle) - MARS_PLANET.radius, 0.0)
    ground = atmosphere.pressure(0.0, place)
    depth, lowest_depth = (
        dust.depth_above(atmosphere.pressure(height, place) / ground)
        for height in (altitude, lowest)
    )
    light = dusty_light(dust, depth, lowest_depth, cosine, distance)
    seen = 1.0 if radiation.visible is None else radiation.visible
    return replace(radiation, visible=seen * light.beam, scattered=seen * light.scattered)
