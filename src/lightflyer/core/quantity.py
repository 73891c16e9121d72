"""Kinds of number: each one's unit and possible range stand here, and nowhere else.

The same alias annotates a field of a numeric class and of a section of the flyer file::

    class Disk(Checked):
        radius: Length

    class DiskSection(Section, of=Disk):
        spelled = {"radius": DIAMETER}

The class takes numbers, arrays, lists, texts such as ``"2 cm"`` and quantities of Pint, and checks
concrete values against the range when it is made. The section reads a text with a unit, such as
``"2.0 ± 0.1 cm"``, into a :class:`~lightflyer.core.units.Measured` in that unit.
"""

import dataclasses
import inspect
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from types import NoneType
from typing import Annotated, Any, ClassVar, get_args, get_origin

import equinox as eqx
import numpy as np
import pint
import pydantic
from pydantic_core import CoreSchema, core_schema

from lightflyer.core.checks import allowed, is_concrete, require_range
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.types import Numeric
from lightflyer.core.units import Measured, parse


@dataclass(frozen=True)
class Quantity:
    """Unit and possible range of a number."""

    unit: str = ""  # SI unit as Pint reads it, empty for a pure number
    lowest: float = -math.inf  # Possible range, both ends included
    highest: float = math.inf  # Possible range, both ends included
    open_below: bool = False  # Whether ``lowest`` itself is excluded
    # Smallest and largest size of a value other than zero that is plausible. A value beyond is a
    # slip of the unit or of the pen
    sizes: tuple[float, float] = (0.0, math.inf)
    why: str = ""  # What ends the sizes, in words
    # Range of what is measured. A value beyond is possible, but most likely one of a wrong unit
    likely: tuple[float, float] = (-math.inf, math.inf)
    known: str = ""  # What ends that range, in words
    # Value that a file has where it gives none and an object has None
    in_files: Measured | None = None

    @property
    def allowed(self) -> str:
        """The range in words, such as ``"positive"``."""
        words = allowed(self.lowest, self.highest, self.open_below)
        return f"{words} {self.unit}" if self.unit and "between" in words else words

    def check(self, name: str, value: Any) -> None:
        """Raise :class:`ParameterError` unless every concrete value is possible."""
        require_range(name, value, self.lowest, self.highest, open_below=self.open_below)
        problem = self.implausible(value)
        if problem:
            raise ParameterError(f"{name} = {problem}")

    def implausible(self, value: Any) -> str | None:
        """Say in words why a concrete value cannot be meant, None where it can."""
        if self.sizes == (0.0, math.inf) or value is None or not is_concrete(value):
            return None
        smallest, largest = self.sizes
        size = np.ravel(np.abs(value))
        beyond = (size > largest) | ((size < smallest) & (size > 0.0))
        if not np.any(beyond):
            return None
        bad, most = size[beyond][0], size[beyond][0] > largest
        limit = f"at most {largest:g}" if most else f"at least {smallest:g}"
        return f"{bad:g} must be {limit} {self.unit}: {self.why}"

    def unlikely(self, value: Any) -> str | None:
        """Say in words why a measured value is in doubt, None where it is not."""
        low, high = self.likely
        beyond = np.ravel(value)[~((np.ravel(value) >= low) & (np.ravel(value) <= high))]
        if not beyond.size:
            return None
        unit = f" {self.unit}" if self.unit else ""
        return (
            f"{beyond[0]:.4g}{unit} is unlikely, {low:g} to {high:g} is usual: {self.known}; check "
            "the units"
        )

    def number(self, name: str, value: Any) -> Any:
        """Number or array in the unit, from whatever a script gives."""
        if isinstance(value, eqx.Module):
            return value  # a number that depends on another, such as an emittance on temperature
        if isinstance(value, str):
            value = self._number_of_text(name, value)
        if isinstance(value, Measured):
            raise ParameterError(f"{name} = {value.value:g}{_NO_UNCERTAINTY}")
        if hasattr(value, "magnitude"):
            value = self._number_of_pint(name, value)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return value
        if isinstance(value, list | tuple) or not hasattr(value, "dtype"):
            value = _array_of(value)
        elif hasattr(value, "dims"):
            value = value.to_numpy()  # of xarray, whose names of dimensions JAX does not know
        if not any(np.issubdtype(value.dtype, kind) for kind in (np.floating, np.integer)):
            raise ParameterError(f"{name} must be {_a_number(self.unit)}")
        return value

    def _number_of_text(self, name: str, text: str) -> Any:
        try:
            measured = parse(text, self.unit)
        except ConfigurationError as error:
            raise ParameterError(f"{name} = {error}") from None
        return measured.value if measured.uncertainty is None else measured

    def _number_of_pint(self, name: str, value: Any) -> Any:
        try:
            return value.to(self.unit or "dimensionless").magnitude
        except pint.PintError:
            raise ParameterError(f"{name} = {value:g~P} does not convert to {self.unit}") from None

    def read(self, value: Any) -> Measured:
        """Number in the unit from a text, a bare number or a :class:`Measured`."""
        measured = value if isinstance(value, Measured) else parse(value, self.unit)
        problem = self.implausible(measured.value)
        if problem:
            raise ConfigurationError(problem.partition(" ")[2])
        try:
            self.check("", measured.value)
        except ParameterError:
            raise ConfigurationError(f"must be {self.allowed}") from None
        width = min(self.highest - self.lowest, self.sizes[1])
        if measured.uncertainty is not None and measured.uncertainty > width:
            raise ConfigurationError(
                f"the uncertainty must be at most {width:g}{f' {self.unit}' if self.unit else ''}, "
                "all that is possible"
            )
        return measured

    def __get_pydantic_core_schema__(
        self, source: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        """Tell Pydantic to read before it checks the type."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))


_NO_UNCERTAINTY = (
    ": an object takes no ±; give uncertainties to a flyer file, or by name to lightflyer.propagate"
)


def _a_number(unit: str) -> str:
    written = f', or a text such as "1 {unit}"' if unit else ""
    return f"a number or an array of numbers{f' [{unit}]' if unit else ''}{written}"


def _array_of(value: Any) -> np.ndarray:
    try:
        return np.asarray(value)
    except ValueError:  # rows of unequal length
        return np.asarray(value, object)


HIGHEST_TAC = 1.3
"""Largest TAC accepted. None can exceed one, but measured values do by their systematic error."""

HIGHEST_OPEN_FRACTION = 0.999  # Largest share of holes accepted: without film there is no flyer

_BETWEEN = "atoms are larger, flyers smaller"

Length = Annotated[
    Numeric,
    Quantity("m", 0.0, open_below=True, sizes=(1e-10, 1e4), why=_BETWEEN),
]
Thickness = Annotated[
    Numeric,
    Quantity("m", 0.0, open_below=True, sizes=(1e-10, 1e-2),
             why="atoms are larger, films are thinner", likely=(3e-10, 2e-4),
             known="graphene is the thinnest film, and no light lifts one as thick as paper"),
]  # fmt: skip
Roughness = Annotated[
    Numeric,
    Quantity("m", 0.0, sizes=(1e-11, 1e-4), why="atoms are larger, films are smoother"),
]
Distance = Annotated[Numeric, Quantity("m", 0.0, sizes=(1e-10, 1e4), why=_BETWEEN)]
LinearDensity = Annotated[
    Numeric,
    Quantity("kg/m", 0.0, sizes=(1e-15, 1e2), why="nanotubes and ropes are between"),
]
GroundDistance = Annotated[
    Numeric,
    Quantity("m", 0.0, open_below=True, sizes=(1.0, 1e8), why="no planet under a flyer is wider"),
]
Altitude = Annotated[
    Numeric, Quantity("m", 0.0, sizes=(0.0, 1e9), why="the moon is nearer than that")
]
Mass = Annotated[
    Numeric,
    Quantity("kg", 0.0, sizes=(0.0, 1e4), why="no flyer carries more"),
]
ArealDensity = Annotated[
    Numeric,
    Quantity(
        "kg/m^2",
        0.0,
        open_below=True,
        sizes=(1e-7, 1e2),
        why="graphene weighs more, 1 cm of steel less",
    ),
]
Density = Annotated[
    Numeric,
    Quantity(
        "kg/m^3",
        0.0,
        open_below=True,
        sizes=(0.1, 2.3e4),
        why="aerogels and osmium are between",
    ),
]
Pressure = Annotated[
    Numeric,
    Quantity(
        "Pa",
        0.0,
        open_below=True,
        sizes=(1e-15, 1e7),
        why="beyond there is no gas, or none that is ideal",
    ),
]
Temperature = Annotated[
    Numeric,
    Quantity(
        "K",
        0.0,
        open_below=True,
        sizes=(1.0, 5e3),
        why="no gas is colder, and its molecules fall apart above",
    ),
]
TemperatureOffset = Annotated[Numeric, Quantity("K", -100.0, 100.0)]
MolarMass = Annotated[
    Numeric,
    Quantity("kg/mol", 0.0, open_below=True, sizes=(1e-3, 0.4), why="hydrogen and UF6 are between"),
]
Tension = Annotated[
    Numeric,
    Quantity("N/m", 0.0, open_below=True, sizes=(1e-9, 1e8), why="no film bears more"),
]
Irradiance = Annotated[
    Numeric,
    Quantity("W/m^2", 0.0, sizes=(1e-30, 1e8), why="the surface of the sun gives 6.3e7 W/m²"),
]
Acceleration = Annotated[
    Numeric,
    Quantity(
        "m/s^2", 0.0, open_below=True, sizes=(1e-6, 1e3), why="asteroids and the sun are between"
    ),
]
Velocity = Annotated[
    Numeric, Quantity("m/s", sizes=(0.0, 1e4), why="a flyer that fast leaves the Earth")
]
Speed = Annotated[
    Numeric, Quantity("m/s", 0.0, sizes=(0.0, 1e4), why="a flyer that fast leaves the Earth")
]
Duration = Annotated[
    Numeric,
    Quantity("s", 0.0, open_below=True, sizes=(1.0, 1e10), why="no mission lasts three centuries"),
]
SpecificHeat = Annotated[
    Numeric,
    Quantity(
        "J/(kg*K)", 0.0, open_below=True, sizes=(10.0, 2e4), why="gold and hydrogen are between"
    ),
]
Conductivity = Annotated[
    Numeric, Quantity("W/(m*K)", 0.0, sizes=(1e-6, 1e4), why="aerogels and graphene are between")
]
Power = Annotated[
    Numeric, Quantity("W", 0.0, sizes=(1e-18, 1e6), why="no flyer has more, and no radio less")
]
Frequency = Annotated[
    Numeric,
    Quantity("Hz", 0.0, open_below=True, sizes=(1e3, 1e13), why="radio is between"),
]
LinkDistance = Annotated[
    Numeric,
    Quantity("m", 0.0, open_below=True, sizes=(1e-2, 1e12), why="Mars and Earth are between"),
]
DataRate = Annotated[
    Numeric,
    Quantity("bit/s", 0.0, open_below=True, sizes=(1e-4, 1e12), why="no radio is faster"),
]
Decibels = Annotated[Numeric, Quantity("", -100.0, 100.0)]
Efficiency = Annotated[Numeric, Quantity("", 0.0, 1.0, open_below=True)]
PhotonEnergy = Annotated[
    Numeric,
    Quantity(
        "J", 0.0, open_below=True, sizes=(1e-24, 1e-15), why="radio waves and x-rays are between"
    ),
]
EnergyGap = Annotated[
    Numeric, Quantity("J", 0.0, sizes=(0.0, 1e-17), why="no solid has a wider gap")
]
OscillatorStrength = Annotated[Numeric, Quantity("", 0.0)]
Permittivity = Annotated[Numeric, Quantity("", 0.0, sizes=(0.0, 1e4), why="no medium has more")]
Fraction = Annotated[Numeric, Quantity("", 0.0, 1.0)]
OpenFraction = Annotated[Numeric, Quantity("", 0.0, HIGHEST_OPEN_FRACTION)]
Emittance = Annotated[
    Numeric,
    Quantity("", 0.0, 1.0, open_below=True, likely=(5e-3, 1.0), known="polished gold has 0.02"),
]
AccommodationCoefficient = Annotated[
    Numeric,
    Quantity("", 0.0, HIGHEST_TAC, open_below=True, likely=(0.2, HIGHEST_TAC),
             known="technical surfaces in air have 0.6 to 1"),
]  # fmt: skip
Coefficient = Annotated[Numeric, Quantity("", 0.0, open_below=True)]
ForceCoefficient = Annotated[
    Numeric,
    Quantity("", 0.0, open_below=True, likely=(0.04, 30.0), known="the paper has 0.4 and 3"),
]
Correlation = Annotated[Numeric, Quantity("", -1.0, 1.0)]
StandardErrors = Annotated[Numeric, Quantity("", -10.0, 10.0, in_files=Measured(0.0, 1.0))]
Incidence = Annotated[Numeric, Quantity("deg", 0.0, 90.0)]
Tilt = Annotated[Numeric, Quantity("deg", 0.0, 180.0)]
Azimuth = Annotated[Numeric, Quantity("deg", -360.0, 360.0)]
SolarLongitude = Annotated[Numeric, Quantity("deg", 0.0, 360.0)]
Latitude = Annotated[Numeric, Quantity("deg", -90.0, 90.0)]
Longitude = Annotated[Numeric, Quantity("deg", -180.0, 360.0)]
PolarAngle = Annotated[Numeric, Quantity("rad", 0.0, math.pi)]
Angle = Annotated[Numeric, Quantity("rad", -2.0 * math.pi, 2.0 * math.pi)]
PlanetRadius = Annotated[
    Numeric,
    Quantity("m", 0.0, open_below=True, sizes=(1e5, 1e8), why="Ceres and Jupiter are between"),
]
RotationRate = Annotated[
    Numeric, Quantity("rad/s", sizes=(1e-9, 1e-2), why="Venus and Jupiter are between")
]
Flattening = Annotated[Numeric, Quantity("", 0.0, 0.5)]
AngularRadius = Annotated[Numeric, Quantity("rad", 0.0, 0.1, open_below=True)]
Refractivity = Annotated[Numeric, Quantity("", 0.0, 1e-2)]
LocalTime = Annotated[Numeric, Quantity("hour", 0.0, 24.0)]
OpticalDepth = Annotated[Numeric, Quantity("", 0.0, 20.0)]
SolarFlux = Annotated[Numeric, Quantity("", 40.0, 500.0)]
GeomagneticIndex = Annotated[Numeric, Quantity("", 0.0, 400.0)]

RADIANS_PER_DEGREE = math.pi / 180.0
"""A factor, not :func:`math.radians`, so that an angle may also be an array or traced by JAX."""


def quantity_of(annotation: Any) -> Quantity | None:
    """The :class:`Quantity` in a type annotation, also of an optional value."""
    if isinstance(annotation, Quantity):
        return annotation
    # an alias such as Length, ``Length | None``, or Equinox's AbstractVar of either
    if get_origin(annotation) is not None or get_args(annotation):
        for part in (*getattr(annotation, "__metadata__", ()), *get_args(annotation)):
            found = quantity_of(part)
            if found is not None:
                return found
    return None


@cache
def quantities_of(owner: type) -> dict[str, Quantity]:
    """Quantities of a class's annotated fields, those of its bases first; by the field's name."""
    found: dict[str, Quantity] = {}
    for base in reversed(owner.__mro__):
        for name, annotation in vars(base).get("__annotations__", {}).items():
            quantity = quantity_of(annotation)
            if quantity is not None:
                found[name] = quantity
    return found


_MISSING = object()


def _converter(name: str, annotation: Any) -> Callable[[Any], Any] | None:
    """What makes a field's value of what a script gives; None for a field that takes anything."""
    if get_origin(annotation) in (ClassVar, eqx.AbstractVar, eqx.AbstractClassVar):
        return None
    quantity = quantity_of(annotation)
    if quantity is not None:
        return partial(_as_number, name, quantity, NoneType in get_args(annotation))
    kinds = [kind for kind in (annotation, *get_args(annotation)) if isinstance(kind, type)]
    if kinds and all(issubclass(kind, eqx.Module | NoneType) for kind in kinds):
        return partial(require_record, name, tuple(kinds))
    return None


def _as_number(name: str, quantity: Quantity, is_optional: bool, value: Any) -> Any:
    return None if value is None and is_optional else quantity.number(name, value)


def require_record(name: str, kinds: tuple[type, ...], value: Any) -> Any:
    """Raise :class:`ParameterError` unless a value is of one of the classes; the value."""
    if isinstance(value, kinds):
        return value
    wanted = " or ".join("None" if kind is NoneType else kind.__name__ for kind in kinds)
    raise ParameterError(f"{name} must be of class {wanted}, not {type(value).__name__}")


class Checked(eqx.Module):
    """An immutable record whose concrete numbers are checked against their quantities."""

    # A field annotated with a quantity takes what :meth:`Quantity.number` reads.

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for name, annotation in vars(cls).get("__annotations__", {}).items():
            converter = _converter(name, annotation)
            default = vars(cls).get(name, _MISSING)
            if converter is None or isinstance(default, dataclasses.Field):
                continue
            given = {} if default is _MISSING else {"default": default}
            setattr(cls, name, eqx.field(converter=converter, **given))

    contradiction: ClassVar[Callable[..., str | None] | None] = None
    """How numbers that are possible each by itself contradict each other, in words, or None.

    A function whose parameters are names of fields. It is asked about concrete numbers only, of
    objects and of sections of a file.
    """

    def __check_init__(self) -> None:
        for name, quantity in quantities_of(type(self)).items():
            quantity.check(name, getattr(self, name))
        problem = contradiction_in(type(self), partial(getattr, self))
        if problem:
            raise ParameterError(problem)


def contradiction_in(kind: type | None, value_of: Callable[[str], Any]) -> str | None:
    """How numbers contradict each other by the rule of a class, or None."""
    rule = getattr(kind, "contradiction", None)
    if kind is None or rule is None:
        return None
    values = {name: value_of(name) for name in _parameters(rule)}
    numbers = (values.get(name) for name in quantities_of(kind))
    concrete = is_concrete(*(number for number in numbers if number is not None))
    return rule(**values) if concrete else None


@cache
def _parameters(rule: Callable[..., Any]) -> tuple[str, ...]:
    return tuple(inspect.signature(rule).parameters)


def require_possible(part: Any) -> None:
    """Check a record and all records in it again, as where numbers of it were replaced."""
    for kind in type(part).__mro__:
        check = vars(kind).get("__check_init__")
        if check is not None:
            check(part)
    for field in dataclasses.fields(part):
        if isinstance(value := getattr(part, field.name), eqx.Module):
            require_possible(value)
