"""Earth: an atmosphere, its gas, gravity and sunlight."""

import abc
import datetime
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar, Literal

import equinox as eqx
import numpy as np
import pydantic

from lightflyer.environment.altitude import altitude_coordinate, describe_floor
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.atmosphere.global_nrlmsis import GlobalNRLMSIS
from lightflyer.environment.atmosphere.lu2023 import Lu2023Atmosphere
from lightflyer.environment.atmosphere.nrlmsis import NRLMSIS, Indices
from lightflyer.environment.atmosphere.us1976 import US1976
from lightflyer.environment.base import (
    AbstractEnvironment,
    Coordinate,
    EnvironmentState,
    Place,
)
from lightflyer.environment.planet import EARTH_PLANET, Planet
from lightflyer.environment.radiation import (
    EARTH_ALBEDO,
    EARTH_INFRARED,
    SKY_INFRARED,
    Radiation,
    sunlight,
)
from lightflyer.environment.sky import VIEW_OF_PLANET, AbstractSky, describe_shadow
from lightflyer.environment.sky_section import SkySection
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.environment.wind.section import AnyWindSection
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.quantity import (
    Acceleration,
    Fraction,
    GeomagneticIndex,
    Irradiance,
    Latitude,
    Length,
    Longitude,
    SolarFlux,
)
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured
from lightflyer.gas.air import AIR, LU2023_AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.known import AIRS

HIGHEST_SEARCHED = 150e3
"""Top of the default search [m]: above, the gas carries no film."""

DEFAULT_ALTITUDES = tuple(1e3 * kilometres for kilometres in range(50, 101, 5))
"""Altitudes reported one by one where none are asked for [m]: the mesosphere."""

_SHADOW_STEPS = 1501  # of the altitudes searched, in which the shadow's edge is looked for
_TABLE = "decides the atmosphere's whole table; give each {} a study of its own"


def earth_view(altitude: Numeric) -> Any:
    """View factor to Earth of a face that looks straight down from an altitude [m]."""
    radius = constants.EARTH_EFFECTIVE_RADIUS
    return (radius / (radius + altitude)) ** 2


def earth_gravity(altitude: Numeric) -> Any:
    """Acceleration of free fall at a geometric altitude [m]; [USSA1976]_ Eq. (17)."""
    return constants.STANDARD_GRAVITY * earth_view(altitude)  # the same inverse square


class Earth(AbstractEnvironment):
    """Above a place on Earth; the coordinate is the geometric altitude [m].

    Attributes
    ----------
    atmosphere : AbstractAtmosphere
        Default :class:`US1976`.
    gas : AbstractGas
        Default :data:`lightflyer.gas.AIR`. Its gas constant follows the atmosphere's molar mass.
    gravity : array or None
        Constant gravity [m/s²]; None lets it fall off with altitude.
    radiation : Radiation
        Sunlight and thermal surroundings; default :func:`sunlight`. What it leaves open of the
        view to the ground is :func:`earth_view` of the altitude.
    wind : AbstractWind or None
        Wind where a place is given; None for gas at rest.
    sky : AbstractSky or None
        Light and heat radiation by date and place; None leaves them to ``radiation``.
    place : Place or None
        Where and when, for states whose place is not given. With a sky, ``radiation`` becomes the
        light there in full, and of states what is left of it behind the horizon.
    floor : array or None
        Distance down to solid ground, or to a platform, at every altitude [m]; None for open air.
        It changes what the gas does to the flyer, not the light.

    Examples
    --------
    >>> state = Earth().state(70e3)
    >>> print(f"{state.pressure:.4f} Pa, {state.temperature:.2f} K, {state.gravity:.4f} m/s²")
    5.2209 Pa, 219.58 K, 9.5942 m/s²
    """

    atmosphere: AbstractAtmosphere = US1976()
    gas: AbstractGas = AIR
    gravity: Acceleration | None = None
    radiation: Radiation = sunlight()
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
        return EARTH_PLANET

    @property
    def coordinate(self) -> Coordinate:
        """Geometric altitude, over the atmosphere's range."""
        return altitude_coordinate(
            self.atmosphere.altitude_range, HIGHEST_SEARCHED, DEFAULT_ALTITUDES
        )

    def assumptions(self) -> tuple[str, ...]:
        """See :meth:`AbstractEnvironment.assumptions`."""
        told = self.radiation.describe(VIEW_OF_PLANET) + describe_floor(self.floor)
        if self.sky is None or self.place is None:
            return told
        light = told[0]
        altitudes = np.linspace(*self.coordinate.searched, _SHADOW_STEPS)
        visible = self.sky.radiation(altitudes, self.place).visible
        return (
            f"{light}, {self.place.describe()}",
            *describe_shadow(altitudes, visible),
            *self.sky.assumptions(),
            *describe_floor(self.floor),
        )

    def assumptions_of_air(self) -> tuple[str, ...]:
        """See :meth:`AbstractEnvironment.assumptions_of_air`: which atmosphere."""
        return (self.atmosphere.describe(),)

    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:
        """Surroundings at an altitude.

        Parameters
        ----------
        coordinate : array, shape (...)
            Geometric altitude [m].
        place : Place, optional
            Where and when: for an atmosphere that depends on it and for the sky, by default
            Earth's own; and for the wind, which is there only if a place is given here.

        Returns
        -------
        EnvironmentState

        Raises
        ------
        ParameterError
            If a concrete altitude is outside the atmosphere's range; traced ones give NaN.
        ConfigurationError
            If a sky or an atmosphere needs a place and there is none.
        """
        altitude = self.coordinate.quantity.number("altitude", coordinate)
        require_range("altitude [m]", altitude, *self.atmosphere.altitude_range)
        wind = None if place is None else self.wind
        place = self.place if place is None else place
        if place is None and self.sky is not None:
            raise ConfigurationError(
                "light by date and place needs a place: date, latitude, longitude"
            )
        state = _state(self, altitude, place)
        if place is not None and self.sky is not None:
            state = replace(state, radiation=self.sky.radiation(altitude, place))
        if place is not None and wind is not None:
            state = replace(state, wind=wind.velocity(altitude, place))
        return state


@entry_point
def _state(earth: Earth, altitude: Numeric, place: Place | None) -> EnvironmentState:
    ratio = earth.atmosphere.molar_mass_ratio(altitude, place)
    gas = eqx.tree_at(
        lambda gas: gas.specific_gas_constant,
        earth.gas,
        earth.gas.specific_gas_constant / ratio,
    )
    return EnvironmentState(
        pressure=earth.atmosphere.pressure(altitude, place),
        temperature=earth.atmosphere.temperature(altitude, place),
        gravity=earth_gravity(altitude) if earth.gravity is None else earth.gravity,
        gas=gas,
        radiation=earth.radiation.seen_from(earth_view(altitude)),
        floor_distance=earth.floor,
    )


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

    default_gas: ClassVar[str] = AIR.name
    default_gravity: ClassVar[float | None] = None

    kind: Literal["earth"] = "earth"
    gas: Literal[tuple(AIRS)] | None = None  # type: ignore[valid-type]
    albedo: Fraction = Measured(EARTH_ALBEDO)
    surroundings: Literal["earth", "gas"] = "earth"
    wind: AnyWindSection | None = None

    @pydantic.model_validator(mode="after")
    def _surroundings_matter(self) -> "EarthSection":
        given = self.infrared_top is not None and self.infrared_bottom is not None
        if "surroundings" in self.model_fields_set and given:
            raise ConfigurationError(
                "surroundings has no effect beside infrared_top and infrared_bottom; remove it, or "
                "both of them"
            )
        return self

    @pydantic.model_validator(mode="after")
    def _wind_is_complete(self) -> "EarthSection":
        if self.wind is not None:
            self.wind.require(self.indices)
        return self

    @abc.abstractmethod
    def build_atmosphere(self) -> AbstractAtmosphere:
        """The atmosphere of this alternative."""

    @property
    def indices(self) -> Indices | None:
        """Activity of the sun and of the geomagnetic field, where the atmosphere has it."""
        return None

    @property
    def default_infrared(self) -> tuple[float | None, float | None]:
        """Heat radiation from above and below where the file gives none [W/m²]."""
        return (SKY_INFRARED, EARTH_INFRARED) if self.surroundings == "earth" else (None, None)

    def build(self) -> Earth:
        """Earth with this atmosphere."""
        gravity = self.default_gravity if self.gravity is None else self.gravity.value
        atmosphere = self.build_atmosphere()
        return Earth(
            atmosphere=atmosphere,
            gas=AIRS[self.gas or self.default_gas],
            gravity=gravity,
            radiation=self.build_radiation(),
            sky=self.build_sky(),
            place=self.build_place(),
            wind=None if self.wind is None else self.wind.build(atmosphere, self.indices),
            floor=None if self.floor is None else self.floor.value,
        )


class Us1976Section(EarthSection):
    """``[environment]``: Earth with the US Standard Atmosphere 1976."""

    atmosphere: Literal["us1976"] = "us1976"

    def build_atmosphere(self) -> AbstractAtmosphere:
        """US Standard Atmosphere 1976."""
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
        """The paper's polynomial."""
        return Lu2023Atmosphere()


class NrlmsisSection(EarthSection):
    """``[environment]``: Earth with NRLMSIS 2.1 for a day and place."""

    not_varied: ClassVar[Mapping[str, str]] = {
        **EarthSection.not_varied,
        **dict.fromkeys(("latitude", "longitude"), _TABLE.format("place")),
        **dict.fromkeys(("f107", "f107a", "ap"), _TABLE.format("activity")),
    }

    place_matters: ClassVar[bool] = True

    atmosphere: Literal["nrlmsis"]
    date: datetime.datetime
    latitude: Latitude
    longitude: Longitude
    f107: SolarFlux
    f107a: SolarFlux | None = None
    ap: GeomagneticIndex

    @property
    def indices(self) -> Indices:
        """See :attr:`EarthSection.indices`."""
        return _indices_of(self)

    def build_atmosphere(self) -> AbstractAtmosphere:
        """NRLMSIS at the given place, time and activity."""
        return NRLMSIS(
            date=self.date,
            latitude=self.latitude.value,
            longitude=self.longitude.value,
            **self.indices._asdict(),
        )


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
        """See :attr:`EarthSection.indices`."""
        return _indices_of(self)

    def build_atmosphere(self) -> AbstractAtmosphere:
        """NRLMSIS with the given activity."""
        return GlobalNRLMSIS(**self.indices._asdict())


def _indices_of(section: Any) -> Indices:
    mean = None if section.f107a is None else section.f107a.value
    return Indices.of(section.f107.value, mean, section.ap.value)
