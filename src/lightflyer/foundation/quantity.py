"""Kinds of number: each one's unit and possible range stand here, and nowhere else.

The same alias annotates a field of a numeric class and of a section of the flyer file::

    class Disk(Checked):
        radius: Length

    class DiskSection(Section):
        diameter: Length

The class checks its concrete values against the range when it is made. The section reads a text
with a unit, such as ``"2.0 ± 0.1 cm"``, into a :class:`~lightflyer.foundation.units.Measured` in
that unit.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, get_args, get_origin

import equinox as eqx
import pydantic
from pydantic_core import CoreSchema, core_schema

from lightflyer.foundation.checks import allowed, require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterError
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured, parse


@dataclass(frozen=True)
class Quantity:
    """Unit and possible range of a number.

    Attributes
    ----------
    unit : str
        SI unit as Pint reads it, empty for a pure number.
    lowest, highest : float
        Possible range, both ends included.
    open_below : bool
        Whether ``lowest`` itself is excluded.
    """

    unit: str = ""
    lowest: float = -math.inf
    highest: float = math.inf
    open_below: bool = False

    @property
    def allowed(self) -> str:
        """The range in words, such as ``"positive"``."""
        words = allowed(self.lowest, self.highest, self.open_below)
        return f"{words} {self.unit}" if self.unit and "between" in words else words

    def check(self, name: str, value: Any) -> None:
        """Raise :class:`ParameterError` unless every concrete value is possible.

        Parameters
        ----------
        name : str
            What the message calls the value.
        value : array or None
            In the unit; None and traced values pass.
        """
        require_range(name, value, self.lowest, self.highest, open_below=self.open_below)

    def read(self, value: Any) -> Measured:
        """Number in the unit from a text, a bare number or a :class:`Measured`.

        Parameters
        ----------
        value : str, float or Measured

        Returns
        -------
        Measured

        Raises
        ------
        ConfigurationError
            If it is no number of this kind or out of range.
        """
        measured = value if isinstance(value, Measured) else parse(value, self.unit)
        try:
            self.check("", measured.value)
        except ParameterError:
            raise ConfigurationError(f"must be {self.allowed}") from None
        return measured

    def __get_pydantic_core_schema__(
        self, source: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        """Tell Pydantic to read before it checks the type."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))


HIGHEST_TAC = 1.3
"""Largest TAC accepted. None can exceed one, but measured values do by their systematic error."""

Length = Annotated[Numeric, Quantity("m", 0.0, open_below=True)]
Altitude = Annotated[Numeric, Quantity("m", 0.0)]
Mass = Annotated[Numeric, Quantity("kg", 0.0)]
ArealDensity = Annotated[Numeric, Quantity("kg/m^2", 0.0, open_below=True)]
Density = Annotated[Numeric, Quantity("kg/m^3", 0.0, open_below=True)]
Pressure = Annotated[Numeric, Quantity("Pa", 0.0, open_below=True)]
Temperature = Annotated[Numeric, Quantity("K", 0.0, open_below=True)]
Irradiance = Annotated[Numeric, Quantity("W/m^2", 0.0)]
Acceleration = Annotated[Numeric, Quantity("m/s^2", 0.0, open_below=True)]
Velocity = Annotated[Numeric, Quantity("m/s")]
Conductivity = Annotated[Numeric, Quantity("W/(m*K)", 0.0)]
Fraction = Annotated[Numeric, Quantity("", 0.0, 1.0)]
OpenFraction = Annotated[Numeric, Quantity("", 0.0, 0.999)]
Emittance = Annotated[Numeric, Quantity("", 0.0, 1.0, open_below=True)]
AccommodationCoefficient = Annotated[Numeric, Quantity("", 0.0, HIGHEST_TAC, open_below=True)]
Coefficient = Annotated[Numeric, Quantity("", 0.0, open_below=True)]
Correlation = Annotated[Numeric, Quantity("", -1.0, 1.0)]
StandardErrors = Annotated[Numeric, Quantity("", -10.0, 10.0)]
Incidence = Annotated[Numeric, Quantity("deg", 0.0, 90.0)]
Tilt = Annotated[Numeric, Quantity("deg", 0.0, 180.0)]
Azimuth = Annotated[Numeric, Quantity("deg", -360.0, 360.0)]
Latitude = Annotated[Numeric, Quantity("deg", -90.0, 90.0)]
Longitude = Annotated[Numeric, Quantity("deg", -180.0, 360.0)]
PolarAngle = Annotated[Numeric, Quantity("rad", 0.0, math.pi)]
Angle = Annotated[Numeric, Quantity("rad", -2.0 * math.pi, 2.0 * math.pi)]
SolarFlux = Annotated[Numeric, Quantity("", 40.0, 500.0)]
GeomagneticIndex = Annotated[Numeric, Quantity("", 0.0, 400.0)]

RADIANS_PER_DEGREE = math.pi / 180.0
"""A factor, not :func:`math.radians`, so that an angle may also be an array or traced by JAX."""


def quantity_of(annotation: Any) -> Quantity | None:
    """The :class:`Quantity` in a type annotation, also of an optional value.

    Parameters
    ----------
    annotation : object
        Such as :data:`Length` or ``Length | None``.

    Returns
    -------
    Quantity or None
        None for an annotation of anything else.
    """
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
    """Quantities of a class's annotated fields, those of its bases first.

    Parameters
    ----------
    owner : type

    Returns
    -------
    dict of str to Quantity
        By the field's name.
    """
    found: dict[str, Quantity] = {}
    for base in reversed(owner.__mro__):
        for name, annotation in vars(base).get("__annotations__", {}).items():
            quantity = quantity_of(annotation)
            if quantity is not None:
                found[name] = quantity
    return found


class Checked(eqx.Module):
    """An immutable record whose concrete numbers are checked against their quantities.

    Raises
    ------
    ParameterError
        If a field annotated with a quantity is out of its range.
    """

    def __check_init__(self) -> None:
        for name, quantity in quantities_of(type(self)).items():
            quantity.check(name, getattr(self, name))
