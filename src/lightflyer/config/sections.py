"""The sections of a flyer file, checked and turned into the package's objects.

Each section of the file is a small class here; where a section has alternatives (a kind of
environment, an atmosphere, a force model) each alternative is a class of its own that knows how
to build its object. Adding an alternative is adding a class to the union of its section.
"""

import abc
import datetime
import math
import re
from collections.abc import Callable
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, get_args

import pydantic
from pydantic import Discriminator, Tag

from lightflyer.environment.atmosphere.lu2023 import Lu2023Atmosphere
from lightflyer.environment.atmosphere.nrlmsis import NRLMSIS
from lightflyer.environment.atmosphere.us1976 import US1976
from lightflyer.environment.base import AbstractAtmosphere, AbstractEnvironment
from lightflyer.environment.chamber import Chamber
from lightflyer.environment.earth import Earth
from lightflyer.environment.radiation import Radiation
from lightflyer.film.layered_section import LayeredFilmSection, LayerSection
from lightflyer.film.properties import HIGHEST_TAC, FilmProperties
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.free_molecular import FreeMolecular, LinearFreeMolecular
from lightflyer.force.kinetic import Kinetic
from lightflyer.force.lu2023 import READINGS, Lu2023
from lightflyer.foundation import constants
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import Quantity
from lightflyer.foundation.quantity import Section as _Section
from lightflyer.foundation.units import Measured
from lightflyer.gas.gas import AIR, LU2023_AIR, AbstractGas

GASES: dict[str, AbstractGas] = {"air": AIR, "lu2023-air": LU2023_AIR}
"""Gases by the name they have in a flyer file."""

RADIANS_PER_DEGREE = math.pi / 180.0
"""A factor, not :func:`math.radians`, so that an angle may also be an array or traced by JAX."""

_Length = Annotated[Measured, Quantity("m", 0.0, open_below=True)]
_Altitude = Annotated[Measured, Quantity("m", 0.0)]
_Mass = Annotated[Measured, Quantity("kg", 0.0)]
_ArealDensity = Annotated[Measured, Quantity("kg/m^2", 0.0, open_below=True)]
_Fraction = Annotated[Measured, Quantity("", 0.0, 1.0)]
_Emittance = Annotated[Measured, Quantity("", 0.0, 1.0, open_below=True)]
_Tac = Annotated[Measured, Quantity("", 0.0, HIGHEST_TAC, open_below=True)]
_Irradiance = Annotated[Measured, Quantity("W/m^2", 0.0)]
_Incidence = Annotated[Measured, Quantity("deg", 0.0, 90.0)]
_Acceleration = Annotated[Measured, Quantity("m/s^2", 0.0, open_below=True)]
_Temperature = Annotated[Measured, Quantity("K", 0.0, open_below=True)]
_Pressure = Annotated[Measured, Quantity("Pa", 0.0, open_below=True)]
_Coefficient = Annotated[Measured, Quantity("", 0.0, open_below=True)]
_Latitude = Annotated[Measured, Quantity("deg", -90.0, 90.0)]
_Longitude = Annotated[Measured, Quantity("deg", -180.0, 360.0)]
_SolarFlux = Annotated[Measured, Quantity("", 40.0, 500.0)]
_GeomagneticIndex = Annotated[Measured, Quantity("", 0.0, 400.0)]
_StandardErrors = Annotated[Measured, Quantity("", -10.0, 10.0)]
_Correlation = Annotated[Measured, Quantity("", -1.0, 1.0)]
_GasName = Literal["air", "lu2023-air"]


class DiskSection(_Section):
    """``[flyer]``: a disk."""

    shape: Literal["disk"] = "disk"
    diameter: _Length
    payload: _Mass = Measured(0.0)

    def build(self, film: FilmProperties) -> AbstractFlyer:
        """The disk, of the given film."""
        return Disk(film, radius=0.5 * self.diameter.value, payload=self.payload.value)


class FilmSection(_Section):
    """``[film]``: properties, measured or assumed."""

    areal_density: _ArealDensity
    absorptance: _Fraction
    absorptance_bottom: _Fraction | None = None
    emittance: _Emittance | None = None
    emittance_top: _Emittance | None = None
    emittance_bottom: _Emittance | None = None
    tac_top: _Tac
    tac_bottom: _Tac
    tac_correlation: _Correlation = Measured(0.0)

    @pydantic.model_validator(mode="after")
    def _one_emittance_a_face(self) -> "FilmSection":
        faces = (self.emittance_top, self.emittance_bottom)
        if self.emittance is not None and faces != (None, None):
            raise ConfigurationError(
                "give either emittance, or emittance_top and emittance_bottom, not both"
            )
        if self.emittance is None and None in faces:
            raise ConfigurationError("give emittance, or both emittance_top and emittance_bottom")
        return self

    def build(self, incidence: float = 0.0) -> FilmProperties:  # noqa: ARG002
        """The film's properties, without their uncertainties; measured at any incidence."""
        top = self.emittance_top or self.emittance
        bottom = self.emittance_bottom or self.emittance
        assert top is not None  # _one_emittance_a_face saw to both
        assert bottom is not None
        return FilmProperties(
            areal_density=self.areal_density.value,
            absorptance=self.absorptance.value,
            emittance_top=top.value,
            emittance_bottom=bottom.value,
            tac_top=self.tac_top.value,
            tac_bottom=self.tac_bottom.value,
            absorptance_bottom=_value(self.absorptance_bottom),
        )


def _value(measured: Measured | None) -> float | None:
    return None if measured is None else measured.value


class _EnvironmentSection(_Section):
    gas: _GasName | None = None
    gravity: _Acceleration | None = None
    incidence: _Incidence = Measured(0.0)
    infrared_top: _Irradiance | None = None
    infrared_bottom: _Irradiance | None = None
    albedo: _Fraction = Measured(0.0)

    stefan_boltzmann: ClassVar[float] = constants.STEFAN_BOLTZMANN

    def _radiation(self, irradiance: float) -> Radiation:
        return Radiation(
            irradiance=irradiance,
            incidence=self.incidence.value * RADIANS_PER_DEGREE,
            infrared_top=_value(self.infrared_top),
            infrared_bottom=_value(self.infrared_bottom),
            albedo=self.albedo.value,
            stefan_boltzmann=self.stefan_boltzmann,
        )


class _EarthSection(_EnvironmentSection):
    kind: Literal["earth"] = "earth"
    irradiance: _Irradiance = Measured(constants.SOLAR_CONSTANT)
    altitude_min: _Altitude | None = None
    altitude_max: _Altitude | None = None

    default_gas: ClassVar[str] = "air"
    default_gravity: ClassVar[float | None] = None

    @pydantic.model_validator(mode="after")
    def _ordered(self) -> "_EarthSection":
        low, high = self.altitude_min, self.altitude_max
        if low is not None and high is not None and low.value >= high.value:
            raise ConfigurationError("altitude_min must be below altitude_max")
        return self

    @abc.abstractmethod
    def _atmosphere(self) -> AbstractAtmosphere:
        """The atmosphere that this alternative is about."""

    def build(self) -> Earth:
        """The environment."""
        gravity = self.default_gravity if self.gravity is None else self.gravity.value
        return Earth(
            atmosphere=self._atmosphere(),
            gas=GASES[self.gas or self.default_gas],
            gravity=gravity,
            radiation=self._radiation(self.irradiance.value),
        )


class Us1976Section(_EarthSection):
    """``[environment]``: Earth with the US Standard Atmosphere 1976."""

    atmosphere: Literal["us1976"] = "us1976"

    def _atmosphere(self) -> AbstractAtmosphere:
        return US1976()


class Lu2023Section(_EarthSection):
    """``[environment]``: Earth as in the paper, whose gas and gravity it implies."""

    atmosphere: Literal["lu2023"]

    default_gas: ClassVar[str] = "lu2023-air"
    default_gravity: ClassVar[float | None] = constants.GRAVITY_LU2023
    stefan_boltzmann: ClassVar[float] = constants.STEFAN_BOLTZMANN_LU2023

    def _atmosphere(self) -> AbstractAtmosphere:
        return Lu2023Atmosphere()


class NrlmsisSection(_EarthSection):
    """``[environment]``: Earth with NRLMSIS 2.1 for a day and place."""

    atmosphere: Literal["nrlmsis"]
    date: datetime.datetime
    latitude: _Latitude
    longitude: _Longitude
    f107: _SolarFlux
    f107a: _SolarFlux | None = None
    ap: _GeomagneticIndex

    def _atmosphere(self) -> AbstractAtmosphere:
        return NRLMSIS(
            date=self.date,
            latitude=self.latitude.value,
            longitude=self.longitude.value,
            f107=self.f107.value,
            f107a=_value(self.f107a),
            ap=self.ap.value,
        )


class ChamberSection(_EnvironmentSection):
    """``[environment]``: a vacuum chamber with a lamp."""

    kind: Literal["chamber"]
    temperature: _Temperature
    pressure_min: _Pressure = Measured(1e-2)
    pressure_max: _Pressure = Measured(1e3)
    irradiance: _Irradiance = Measured(constants.SOLAR_CONSTANT)
    radius: _Length | None = None

    @pydantic.model_validator(mode="after")
    def _ordered(self) -> "ChamberSection":
        if self.pressure_min.value >= self.pressure_max.value:
            raise ConfigurationError("pressure_min must be below pressure_max")
        return self

    def build(self) -> Chamber:
        """The environment."""
        gravity = constants.STANDARD_GRAVITY if self.gravity is None else self.gravity.value
        return Chamber(
            temperature=self.temperature.value,
            gas=GASES[self.gas or "air"],
            gravity=gravity,
            radiation=self._radiation(self.irradiance.value),
            pressure_range=(self.pressure_min.value, self.pressure_max.value),
            radius=_value(self.radius),
        )


class Lu2023ForceSection(_Section):
    """``[force]``: the paper's interpolation between limits."""

    model: Literal["lu2023"] = "lu2023"
    reading: Literal["reported", "printed"] = "reported"
    c_fm: _Coefficient = Measured(0.4)
    c_cont: _Coefficient = Measured(3.0)

    def build(self) -> AbstractForceModel:
        """The force model."""
        return Lu2023(self.c_fm.value, self.c_cont.value, READINGS[self.reading])


class FreeMolecularSection(_Section):
    """``[force]``: the exact free-molecular limit."""

    model: Literal["free-molecular"]

    def build(self) -> AbstractForceModel:
        """The force model."""
        return FreeMolecular()


class LinearFreeMolecularSection(_Section):
    """``[force]``: the free-molecular limit for small temperature differences."""

    model: Literal["free-molecular-linear"]

    def build(self) -> AbstractForceModel:
        """The force model."""
        return LinearFreeMolecular()


class KineticSection(_Section):
    """``[force]``: the kinetic equation, solved; its own error counts unless told otherwise."""

    model: Literal["kinetic"]
    force_error: _StandardErrors = Measured(0.0, 1.0)
    heat_error: _StandardErrors = Measured(0.0, 1.0)

    def build(self) -> AbstractForceModel:
        """The force model."""
        return Kinetic(self.force_error.value, self.heat_error.value)


def _field(value: Any, name: str, default: str) -> str:
    found = value.get(name, default) if isinstance(value, dict) else getattr(value, name, default)
    return str(found)


def _environment_tag(value: Any) -> str:
    kind = _field(value, "kind", "earth")
    return f"earth {_field(value, 'atmosphere', 'us1976')}" if kind == "earth" else kind


def _force_tag(value: Any) -> str:
    return _field(value, "model", "lu2023")


def _film_tag(value: Any) -> str:
    layered = "layers" in value if isinstance(value, dict) else hasattr(value, "layers")
    return "layered" if layered else "measured"


FilmSections = Annotated[
    Annotated[FilmSection, Tag("measured")] | Annotated[LayeredFilmSection, Tag("layered")],
    Discriminator(_film_tag),
]
EnvironmentSection = Annotated[
    Annotated[Us1976Section, Tag("earth us1976")]
    | Annotated[Lu2023Section, Tag("earth lu2023")]
    | Annotated[NrlmsisSection, Tag("earth nrlmsis")]
    | Annotated[ChamberSection, Tag("chamber")],
    Discriminator(_environment_tag),
]
ForceSection = Annotated[
    Annotated[Lu2023ForceSection, Tag("lu2023")]
    | Annotated[FreeMolecularSection, Tag("free-molecular")]
    | Annotated[LinearFreeMolecularSection, Tag("free-molecular-linear")]
    | Annotated[KineticSection, Tag("kinetic")],
    Discriminator(_force_tag),
]


class Setup(NamedTuple):
    """What a flyer file describes, as the package's objects.

    Attributes
    ----------
    flyer : AbstractFlyer
    environment : AbstractEnvironment
    model : AbstractForceModel
    coordinate_range : tuple of (float or None)
        Lowest and highest altitude [m] or pressure [Pa] of interest; None where not given.
    """

    flyer: AbstractFlyer
    environment: AbstractEnvironment
    model: AbstractForceModel
    coordinate_range: tuple[float | None, float | None]


class FlyerFile(_Section):
    """A flyer file: what the flyer is, where it flies and how its force is computed.

    Also buildable in Python, with the same names and texts as in the file::

        FlyerFile(
            flyer={"diameter": "2 cm"},
            film={"areal_density": "1.0 g/m^2", "absorptance": 0.75, "emittance": 0.08,
                  "tac_top": 0.8, "tac_bottom": "0.90 ± 0.03"},
        )

    Numbers are :class:`~lightflyer.foundation.units.Measured`: value and uncertainty, in SI units
    (angles in degrees).
    """

    flyer: DiskSection
    film: FilmSections
    environment: EnvironmentSection = Us1976Section()
    force: ForceSection = Lu2023ForceSection()

    def build(self) -> Setup:
        """The flyer, environment and force model described.

        Returns
        -------
        Setup

        Raises
        ------
        MissingExtraError
            If the atmosphere needs a package that is not installed.
        """
        section = self.environment
        low = getattr(section, "altitude_min", None) or getattr(section, "pressure_min", None)
        high = getattr(section, "altitude_max", None) or getattr(section, "pressure_max", None)
        return Setup(
            flyer=self.flyer.build(self.film.build(section.incidence.value * RADIANS_PER_DEGREE)),
            environment=section.build(),
            model=self.force.build(),
            coordinate_range=(_value(low), _value(high)),
        )

    def uncertainties(self) -> dict[str, float]:
        """The stated standard uncertainties by dotted name, in the units of the values.

        Returns
        -------
        dict of str to float
            Such as ``{"film.tac_bottom": 0.03}``.
        """
        layered = self.film if isinstance(self.film, LayeredFilmSection) else None
        inner = layered.layer_uncertainties() if layered else {}
        return inner | {
            f"{section}.{name}": value.uncertainty
            for section in type(self).model_fields
            for name, value in getattr(self, section)
            if isinstance(value, Measured) and value.uncertainty is not None
        }


def quantity_of(section: type[pydantic.BaseModel], name: str) -> Quantity:
    """Unit and range of a section's number.

    Parameters
    ----------
    section : type
        Class of the section.
    name : str
        Of the field.

    Returns
    -------
    Quantity
    """
    field = section.model_fields[name]
    # the annotation of an optional field stands one level deeper
    parts = [
        *field.metadata,
        *(part for arg in get_args(field.annotation) for part in get_args(arg)),
    ]
    return next(part for part in parts if isinstance(part, Quantity))


def known_keys(section: str, content: Any) -> list[str]:
    """Names that a section of the file takes.

    Parameters
    ----------
    section : str
        Name of the section, empty for the file itself.
    content : object
        What the file has in that section, which may decide between alternatives.

    Returns
    -------
    list of str
    """
    classes: dict[str, Callable[[], type[pydantic.BaseModel]]] = {
        "": lambda: FlyerFile,
        "flyer": lambda: DiskSection,
        "film": lambda: _alternatives(FilmSections)[_film_tag(content)],
        "film.layers": lambda: LayerSection,
        "environment": lambda: _alternatives(EnvironmentSection)[_environment_tag(content)],
        "force": lambda: _alternatives(ForceSection)[_force_tag(content)],
    }
    known = re.sub(r"\.\d+$", "", section)  # entries of a list are all alike
    return list(classes[known]().model_fields)


def alternative_tags() -> set[str]:
    """Names by which Pydantic tells a section's alternatives apart.

    Returns
    -------
    set of str
    """
    return {
        tag
        for union in (FilmSections, EnvironmentSection, ForceSection)
        for tag in _alternatives(union)
    }


def _alternatives(union: Any) -> dict[str, type[pydantic.BaseModel]]:
    members = (get_args(member) for member in get_args(get_args(union)[0]))
    return {tag.tag: section for section, tag in members}
