"""Mars: its air, gravity, dust and sunlight."""

from typing import Final

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
)
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.atmosphere.mars import (
    MOLAR_MASS,
    MarsAtmosphere,
)
from lightflyer.environment.light.dust import Dust
from lightflyer.environment.light.ground import UniformGround
from lightflyer.environment.light.mars_sun import (
    NOON,
    MarsSun,
    distance_in_season,
    zenith_angle_in_season,
)
from lightflyer.environment.light.sky import Daylight
from lightflyer.environment.planet import MARS_LIMB, MARS_PLANET, Planet
from lightflyer.environment.planetary import Planetary
from lightflyer.environment.radiation import SKY_INFRARED, Radiation
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE

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
