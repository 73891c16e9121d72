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
import operator
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache, partial, reduce
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, ClassVar, Literal, TypeAlias, get_args, get_origin

import numpy as np
import pydantic
from pydantic_core import CoreSchema, core_schema

from lightflyer.array.namespace import Numeric, call, is_tracer, within, xp
from lightflyer.array.records import AbstractClassVar, AbstractVar, Module, field
from lightflyer.core.checks import is_concrete, is_labelled, is_series, range_text, require_range
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.units import Measured, file_unit, parse, scale_and_offset


@dataclass(frozen=True)
class Quantity:
    """Unit and possible range of a number."""

    unit: str = ""  # SI unit as files spell it, empty for a pure number
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
    usual: str = ""  # Unit that messages propose
    difference: bool = False  # Whether it is one of two numbers, for which 1 °C is 1 K
    # Value that a file has where it gives none and an object has None
    in_files: Measured | None = None

    @property
    def allowed(self) -> str:
        """The range in words, such as ``"positive"``."""
        words = range_text(self.lowest, self.highest, self.open_below)
        if self.unit == "K" and words == "positive" and not self.difference:
            return "above absolute zero"  # files have °C too
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
        return f"{bad:g} must be {f'{limit} {self.unit}'.strip()}: {self.why}"

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

    def number(self, name: str, value: Any, *, keep_index: bool = False) -> Any:
        """Number or array in the unit, from whatever a script gives; labels of xarray stay.

        Columns of pandas become arrays, unless their index is to be kept.
        """
        if isinstance(value, Module):
            return value  # a number that depends on another, such as an emittance on temperature
        if is_tracer(value):
            return self.possible(value)
        value = self._in_unit(name, value)
        if isinstance(value, int | float) and not isinstance(value, bool):
            return value
        if hasattr(value, "columns"):
            raise ParameterError(f"{name} is a table of pandas; give one of its columns")
        if is_series(value) and keep_index and value.dtype.kind in "fiu":
            return value.astype(float)
        if hasattr(value, "index") or not hasattr(value, "dtype"):  # pandas has both
            try:
                value = np.asarray(value)
            except ValueError:  # rows of unequal length
                value = np.asarray(value, object)
        if hasattr(value, "filled"):  # a masked array, of whose class NumPy loads a library
            value = value.astype(float).filled(np.nan)
        if not any(np.issubdtype(value.dtype, kind) for kind in (np.floating, np.integer)):
            unit = f" [{self.unit}]" if self.unit else ""
            written = f', or a text such as "1 {self.unit}"' if self.unit else ""
            raise ParameterError(f"{name} must be a number or an array of numbers{unit}{written}")
        return value

    def possible(self, value: Any) -> Any:
        """A number, NaN where it is out of range: for where nothing can be raised."""
        if isinstance(value, Module):
            return value
        outside = []  # NaN stays as it is
        if self.lowest > -math.inf:
            outside.append(value <= self.lowest if self.open_below else value < self.lowest)
        if self.highest < math.inf:
            outside.append(value > self.highest)
        if not outside:
            return value
        number = xp.asarray(value, float)
        return xp.where(reduce(operator.or_, outside), np.nan, number)

    def _in_unit(self, name: str, value: Any) -> Any:
        """What has a unit of its own, without it; anything else as it is."""
        if isinstance(value, str):
            try:
                measured = parse(value, self.unit, self.usual, difference=self.difference)
            except ConfigurationError as error:
                raise ParameterError(f"{name} = {error}") from None
            value = measured.value if measured.uncertainty is None else measured
        if isinstance(value, Measured):
            raise ParameterError(f"{name} = {value.value:g}{_NO_UNCERTAINTY}")
        if is_labelled(value):
            unit = value.attrs.get("units")
            if hasattr(value.data, "magnitude"):
                value = value.copy(data=self._number_of_pint(name, value.data))
            elif unit is not None:
                try:
                    scale, offset = scale_and_offset(file_unit(str(unit)), self.unit)
                except ConfigurationError as error:
                    raise ParameterError(f"units of {name}: {error}") from None
                if (scale, offset) != (1.0, 0.0):
                    value = scale * value + (0.0 if self.difference else offset)
            return value.drop_attrs() if value.ndim else value.to_numpy()
        if hasattr(value, "magnitude"):
            return self._number_of_pint(name, value)
        if isinstance(value, list | tuple) and any(isinstance(one, str) for one in value):
            return [self._in_unit(name, one) for one in value]
        return value

    def _number_of_pint(self, name: str, value: Any) -> Any:
        unit = self.unit or "dimensionless"
        if not value.is_compatible_with(unit):
            raise ParameterError(f"{name} = {value:g~P} does not convert to {self.unit}")
        return value.to(unit).magnitude

    def read(self, value: Any) -> Measured:
        """Number in the unit from a text, a bare number or a :class:`Measured`."""
        if self.in_files is not None and "%" in str(value):
            raise ConfigurationError("is counted in standard errors of the model, not in per cent")
        measured = value
        if not isinstance(value, Measured):
            measured = parse(value, self.unit, self.usual, difference=self.difference)
        problem = self.implausible(measured.value)
        if problem:
            raise ConfigurationError(problem.partition(" ")[2])
        try:
            self.check("", measured.value)
        except ParameterError:
            share = not self.unit and self.lowest == 0.0 and 2.0 <= measured.value <= _PERCENT
            hint = f'; per cent are written "{measured.value:g} %"' if share else ""
            raise ConfigurationError(f"must be {self.allowed}{hint}") from None
        width = min(self.highest - self.lowest, self.sizes[1])
        if measured.uncertainty is None:
            return measured
        if not measured.uncertainty >= 0.0:
            raise ConfigurationError("the uncertainty must be zero or positive")
        if measured.uncertainty > width:
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


_PERCENT = 100.0
_NO_UNCERTAINTY = (
    ": an object takes no ±; give uncertainties to a flyer file, or by name to lightflyer.propagate"
)


def _read_kinds() -> dict[str, Quantity]:
    text = (Path(__file__).parents[1] / "data" / "kinds.toml").read_text(encoding="utf-8")
    found = {}
    for name, kind in tomllib.loads(text).items():
        known: dict[str, Any] = kind
        pairs = {key: tuple(ends) for key, ends in known.items() if isinstance(ends, list)}
        found[name] = Quantity(**known | pairs)
    # of a model: an object has None where it is not asked for
    own = replace(found["StandardErrors"], in_files=Measured(0.0, 1.0))
    return found | {"StandardErrors": own}


_KINDS = _read_kinds()

Length = Annotated[Numeric, _KINDS["Length"]]
Radius = Annotated[Numeric, _KINDS["Radius"]]
ParticleRadius = Annotated[Numeric, _KINDS["ParticleRadius"]]
Thickness = Annotated[Numeric, _KINDS["Thickness"]]
Roughness = Annotated[Numeric, _KINDS["Roughness"]]
Distance = Annotated[Numeric, _KINDS["Distance"]]
LinearDensity = Annotated[Numeric, _KINDS["LinearDensity"]]
GroundDistance = Annotated[Numeric, _KINDS["GroundDistance"]]
Altitude = Annotated[Numeric, _KINDS["Altitude"]]
Mass = Annotated[Numeric, _KINDS["Mass"]]
ArealDensity = Annotated[Numeric, _KINDS["ArealDensity"]]
Density = Annotated[Numeric, _KINDS["Density"]]
Pressure = Annotated[Numeric, _KINDS["Pressure"]]
Temperature = Annotated[Numeric, _KINDS["Temperature"]]
ChamberTemperature = Annotated[Numeric, _KINDS["ChamberTemperature"]]
TemperatureOffset = Annotated[Numeric, _KINDS["TemperatureOffset"]]
MolarMass = Annotated[Numeric, _KINDS["MolarMass"]]
Tension = Annotated[Numeric, _KINDS["Tension"]]
Modulus = Annotated[Numeric, _KINDS["Modulus"]]
PoissonRatio = Annotated[Numeric, _KINDS["PoissonRatio"]]
Expansion = Annotated[Numeric, _KINDS["Expansion"]]
Stress = Annotated[Numeric, _KINDS["Stress"]]
Irradiance = Annotated[Numeric, _KINDS["Irradiance"]]
Infrared = Annotated[Numeric, _KINDS["Infrared"]]
Acceleration = Annotated[Numeric, _KINDS["Acceleration"]]
Velocity = Annotated[Numeric, _KINDS["Velocity"]]
WindSpeed = Annotated[Numeric, _KINDS["WindSpeed"]]
Speed = Annotated[Numeric, _KINDS["Speed"]]
Duration = Annotated[Numeric, _KINDS["Duration"]]
SpecificHeat = Annotated[Numeric, _KINDS["SpecificHeat"]]
Conductivity = Annotated[Numeric, _KINDS["Conductivity"]]
Power = Annotated[Numeric, _KINDS["Power"]]
Frequency = Annotated[Numeric, _KINDS["Frequency"]]
LinkDistance = Annotated[Numeric, _KINDS["LinkDistance"]]
DataRate = Annotated[Numeric, _KINDS["DataRate"]]
Decibels = Annotated[Numeric, _KINDS["Decibels"]]
Efficiency = Annotated[Numeric, _KINDS["Efficiency"]]
PhotonEnergy = Annotated[Numeric, _KINDS["PhotonEnergy"]]
EnergyGap = Annotated[Numeric, _KINDS["EnergyGap"]]
OscillatorStrength = Annotated[Numeric, _KINDS["OscillatorStrength"]]
Permittivity = Annotated[Numeric, _KINDS["Permittivity"]]
Fraction = Annotated[Numeric, _KINDS["Fraction"]]
Multiple = Annotated[Numeric, _KINDS["Multiple"]]
Asymmetry = Annotated[Numeric, _KINDS["Asymmetry"]]
OpenFraction = Annotated[Numeric, _KINDS["OpenFraction"]]
Emittance = Annotated[Numeric, _KINDS["Emittance"]]
AccommodationCoefficient = Annotated[Numeric, _KINDS["AccommodationCoefficient"]]
Coefficient = Annotated[Numeric, _KINDS["Coefficient"]]
ForceCoefficient = Annotated[Numeric, _KINDS["ForceCoefficient"]]
Correlation = Annotated[Numeric, _KINDS["Correlation"]]
StandardErrors = Annotated[Numeric, _KINDS["StandardErrors"]]
Incidence = Annotated[Numeric, _KINDS["Incidence"]]
Tilt = Annotated[Numeric, _KINDS["Tilt"]]
LampIncidence = Annotated[Numeric, _KINDS["LampIncidence"]]
Steepness = Annotated[Numeric, _KINDS["Steepness"]]
Azimuth = Annotated[Numeric, _KINDS["Azimuth"]]
SolarLongitude = Annotated[Numeric, _KINDS["SolarLongitude"]]
Latitude = Annotated[Numeric, _KINDS["Latitude"]]
Longitude = Annotated[Numeric, _KINDS["Longitude"]]
PolarAngle = Annotated[Numeric, _KINDS["PolarAngle"]]
LargestTilt = Annotated[Numeric, _KINDS["LargestTilt"]]
Angle = Annotated[Numeric, _KINDS["Angle"]]
PlanetRadius = Annotated[Numeric, _KINDS["PlanetRadius"]]
RotationRate = Annotated[Numeric, _KINDS["RotationRate"]]
Flattening = Annotated[Numeric, _KINDS["Flattening"]]
AngularRadius = Annotated[Numeric, _KINDS["AngularRadius"]]
Refractivity = Annotated[Numeric, _KINDS["Refractivity"]]
LocalTime = Annotated[Numeric, _KINDS["LocalTime"]]
OpticalDepth = Annotated[Numeric, _KINDS["OpticalDepth"]]
SolarFlux = Annotated[Numeric, _KINDS["SolarFlux"]]
GeomagneticIndex = Annotated[Numeric, _KINDS["GeomagneticIndex"]]

HIGHEST_OPEN_FRACTION = _KINDS["OpenFraction"].highest
"""Largest share of holes accepted: without film there is no flyer."""

RADIANS_PER_DEGREE = math.pi / 180.0
"""A factor, not :func:`math.radians`, so that an angle may also be an array or traced by JAX."""


def quantity_of(annotation: Any) -> Quantity | None:
    """The :class:`Quantity` in a type annotation, also of an optional value."""
    if isinstance(annotation, Quantity):
        return annotation
    # an alias such as Length, ``Length | None``, or an AbstractVar of either
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


@cache
def _choices_of(owner: type) -> dict[str, tuple[Any, ...]]:
    """Values that each field of a record may have that is a choice; by the field's name."""
    kinds = {field.name: field.type for field in dataclasses.fields(owner)}
    return {name: get_args(kind) for name, kind in kinds.items() if get_origin(kind) is Literal}


_MISSING = object()


def _converter(name: str, annotation: Any) -> Callable[[Any], Any] | None:
    """What makes a field's value of what a script gives; None for a field that takes anything."""
    if get_origin(annotation) in (ClassVar, AbstractVar, AbstractClassVar):
        return None
    quantity = quantity_of(annotation)
    if quantity is not None:
        return partial(_as_number, name, quantity, NoneType in get_args(annotation))
    kinds = [kind for kind in (annotation, *get_args(annotation)) if isinstance(kind, type)]
    if kinds and all(issubclass(kind, Module | NoneType) for kind in kinds):
        return partial(require_record, name, tuple(kinds))
    return None


def _as_number(name: str, quantity: Quantity, is_optional: bool, value: Any) -> Any:
    if call.depth and not isinstance(value, str):  # made of checked numbers
        return quantity.possible(value) if call.blanks and value is not None else value
    return None if value is None and is_optional else quantity.number(name, value, keep_index=True)


def require_record(name: str, kinds: tuple[type, ...], value: Any) -> Any:
    """Raise :class:`ParameterError` unless a value is of one of the classes; the value."""
    if isinstance(value, kinds):
        return value
    wanted = " or ".join("None" if kind is NoneType else kind.__name__ for kind in kinds)
    given = type(value).__name__
    if isinstance(value, type):
        given = f"the class {value.__name__} itself; write {value.__name__}(...)"
    elif isinstance(value, str):
        given = f'the text "{value:.40}"'
    raise ParameterError(f"{name} must be of class {wanted}, not {given}")


@contextmanager
def impossible_as_nan() -> Iterator[None]:
    """Context in which records are made of numbers unchecked, NaN where they are out of range."""
    with within():
        before, call.blanks = call.blanks, True
        try:
            yield
        finally:
            call.blanks = before


Contradictions: TypeAlias = Iterator[tuple[Any, str]]
"""Where numbers contradict each other, and how."""

Shapes = Mapping[str, tuple[int, ...]]


def require_fit(shapes: Shapes) -> None:
    """Raise :class:`ParameterError` unless arrays broadcast, whose shapes are given by name."""
    # a trace for any length has symbols in place of it
    known = {name: shape for name, shape in shapes.items() if {int} == {*map(type, shape)}}
    try:
        np.broadcast_shapes(*known.values())
    except ValueError:
        (first, one), *others = known.items()
        name, other = next((name, shape) for name, shape in others if shape != one)
        raise ParameterError(
            f"{first} of shape {one} and {name} of shape {other} do not fit together; give arrays "
            "that broadcast, or of xarray with names of dimensions"
        ) from None


def shapes_in(part: Any, prefix: str = "", *, labelled: bool = False) -> dict[str, tuple[int, ...]]:
    """Shapes of the numbers of a record and of those in it, by name."""
    return {
        name: getattr(value, "shape", ())
        for name, _, value in numbers_in(part, prefix)
        if labelled or not is_labelled(value)
    }


def numbers_in(part: Any, prefix: str = "") -> Iterator[tuple[str, Quantity, Any]]:
    """Name, quantity and value of the numbers of a record and of those in it."""
    known = quantities_of(part.__class__)
    for name in part.__dataclass_fields__:
        value = getattr(part, name)
        if isinstance(value, Module):
            yield from numbers_in(value, f"{prefix}{name}.")
        elif name in known:
            yield f"{prefix}{name}", known[name], value


class Checked(Module):
    """An immutable record whose numbers are checked against their quantities, texts by choices."""

    # A field annotated with a quantity takes what :meth:`Quantity.number` reads.

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for name, annotation in vars(cls).get("__annotations__", {}).items():
            converter = _converter(name, annotation)
            default = vars(cls).get(name, _MISSING)
            if converter is None or isinstance(default, dataclasses.Field):
                continue
            given = {} if default is _MISSING else {"default": default}
            setattr(cls, name, field(converter=converter, **given))

    contradiction: ClassVar[Callable[..., Contradictions | str | None] | None] = None
    """How numbers that are possible each by itself contradict each other.

    A function whose parameters are names of fields, of objects and of sections of a file. It gives
    where they do, an array or one truth, and words, for one contradiction after the other; of what
    varies in no sweep, words alone or None.
    """

    def __check_init__(self) -> None:
        for name, quantity in quantities_of(type(self)).items():
            quantity.check(name, getattr(self, name))
        for name, choices in _choices_of(type(self)).items():
            if (value := getattr(self, name)) not in choices:
                known = ", ".join(choices)
                raise ParameterError(f'{name} = "{value}" is unknown; choose from {known}')
        require_fit(shapes_in(self))
        problem = contradiction_in(type(self), partial(getattr, self))
        if problem:
            raise ParameterError(problem)

    def __blank_init__(self) -> None:
        """Make numbers NaN where they contradict each other."""
        rule, known = type(self).contradiction, quantities_of(type(self))
        if rule is None or not inspect.isgeneratorfunction(rule):
            return
        values = {name: getattr(self, name) for name in _parameters(rule)}
        name = next(name for name, value in values.items() if name in known and value is not None)
        for wrong, _ in rule(**values):
            if wrong is not False:
                vars(self)[name] = xp.where(wrong, np.nan, vars(self)[name])


def contradiction_in(kind: type | None, value_of: Callable[[str], Any]) -> str | None:
    """How numbers contradict each other by the rule of a class, or None."""
    rule = getattr(kind, "contradiction", None)
    if kind is None or rule is None:
        return None
    values = {name: value_of(name) for name in _parameters(rule)}
    numbers = (values.get(name) for name in quantities_of(kind))
    concrete = is_concrete(*(number for number in numbers if number is not None))
    found = rule(**values) if concrete else None
    if isinstance(found, str | None):
        return found
    return next((words for wrong, words in found if np.any(wrong)), None)


@cache
def _parameters(rule: Callable[..., Any]) -> tuple[str, ...]:
    return tuple(inspect.signature(rule).parameters)


def require_possible(part: Any) -> None:
    """Check a new record and all records in it again, as where numbers of it were replaced."""
    for kind in type(part).__mro__:
        check = vars(kind).get("__blank_init__" if call.blanks else "__check_init__")
        if check is not None:
            check(part)
    for one in dataclasses.fields(part):
        if isinstance(value := getattr(part, one.name), Module):
            require_possible(value)
