"""Earth: an atmosphere, its gas, gravity and sunlight."""

import datetime
from collections.abc import Mapping
from typing import ClassVar, Literal

import pydantic

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.quantity import (
    Fraction,
    GeomagneticIndex,
    Irradiance,
    Latitude,
    Longitude,
    SolarFlux,
)
from lightflyer.core.units import Measured
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.atmosphere.global_nrlmsis import GlobalNRLMSIS
from lightflyer.environment.atmosphere.lu2023 import Lu2023Atmosphere
from lightflyer.environment.atmosphere.nrlmsis import NRLMSIS, Indices
from lightflyer.environment.atmosphere.us1976 import US1976
from lightflyer.environment.planet import EARTH_PLANET, Planet
from lightflyer.environment.planetary import Planetary
from lightflyer.environment.radiation import (
    Radiation,
)
from lightflyer.environment.sky_section import SkySection
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.environment.wind.section import WindSection
from lightflyer.gas.air import AIR, LU2023_AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.registry import AIRS

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
    def indices(self) -> Indices | None:
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
    def indices(self) -> Indices:
        mean = None if self.f107a is None else self.f107a.value
        return Indices.of(self.f107.value, mean, self.ap.value)

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
