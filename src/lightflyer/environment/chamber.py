"""A vacuum chamber with a lamp."""

from typing import ClassVar, Literal

import pydantic

from lightflyer.environment.base import (
    AbstractEnvironment,
    Coordinate,
    EnvironmentState,
    Place,
)
from lightflyer.environment.radiation import Radiation
from lightflyer.environment.section import EnvironmentSection
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import (
    Acceleration,
    Length,
    Pressure,
    Quantity,
    Temperature,
    quantity_of,
)
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.known import GASES

DEFAULT_PRESSURES = tuple(digit * 10.0**decade for decade in range(-4, 6) for digit in (1.0, 3.0))
"""Pressures reported one by one where none are asked for, if in the chamber's range [Pa]."""

_PRESSURE = quantity_of(Pressure) or Quantity()


class Chamber(AbstractEnvironment):
    """Inside a vacuum chamber; the coordinate is the pressure [Pa].

    Attributes
    ----------
    temperature : array
        Temperature of gas and walls [K]; default that of the paper's laboratory.
    gas : AbstractGas
        Default :data:`lightflyer.gas.AIR`.
    gravity : array
        Acceleration of free fall [m/s²].
    radiation : Radiation
        The lamp. Thermal surroundings are walls at the gas temperature unless it says more.
    pressure_range : tuple of float
        Lowest and highest pressure of interest [Pa].
    radius : array or None
        Distance from the flyer to the walls [m]; None for walls too far away to matter.
    floor, lid : array or None
        Height of the flyer above a solid floor, and of a solid lid above the flyer [m]; None for
        one too far away to matter. With neither, the walls' cylinder is as high as wide, and cold
        gas enters through all of it.

    Notes
    -----
    Of force models only the kinetic one takes walls, floor and lid into account; others warn.

    Raises
    ------
    ParameterError
        If a concrete value is not positive or the range is empty.
    """

    dimmable_light: ClassVar[bool] = True

    temperature: Temperature = 293.0
    gas: AbstractGas = AIR
    gravity: Acceleration = constants.STANDARD_GRAVITY
    radiation: Radiation = Radiation()
    pressure_range: tuple[Numeric, Numeric] = (1e-2, 1e3)
    radius: Length | None = None
    floor: Length | None = None
    lid: Length | None = None

    def __check_init__(self) -> None:
        lowest, highest = self.pressure_range
        require_positive(pressure_range=lowest)
        require_range("upper end of pressure_range", highest, lowest, open_below=True)

    @property
    def coordinate(self) -> Coordinate:
        """Pressure, over the range of interest; states exist at any positive one."""
        low, high = self.pressure_range
        return Coordinate(
            name="pressure",
            unit="Pa",
            long_name="gas pressure",
            lowest=low,
            highest=high,
            searched=(low, high),
            logarithmic=True,
            shown_unit="Pa",
            points=DEFAULT_PRESSURES,
            easiest_keys=("optimum", "irradiance_w_m2"),
            open_ended=True,
        )

    def assumptions(self) -> tuple[str, ...]:
        """See :meth:`AbstractEnvironment.assumptions`."""
        return (*super().assumptions(), *self.gas.assumptions())

    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:  # noqa: ARG002
        """Surroundings at a pressure, which may lie outside the range of interest.

        Parameters
        ----------
        coordinate : array, shape (...)
            Pressure [Pa].
        place : Place, optional
            Has no effect: a chamber is the same everywhere.

        Returns
        -------
        EnvironmentState

        Raises
        ------
        ParameterError
            If a concrete pressure is not positive.
        """
        pressure = self.coordinate.quantity.number("pressure", coordinate)
        _PRESSURE.check("pressure", pressure)
        return EnvironmentState(
            pressure=pressure,
            temperature=self.temperature,
            gravity=self.gravity,
            gas=self.gas,
            radiation=self.radiation,
            wall_distance=self.radius,
            floor_distance=self.floor,
            lid_distance=self.lid,
        )


class ChamberSection(EnvironmentSection):
    """``[environment]``: a vacuum chamber with a lamp."""

    search_keys: ClassVar[tuple[str, str]] = ("pressure_min", "pressure_max")

    kind: Literal["chamber"]
    temperature: Temperature
    pressure_min: Pressure = Measured(1e-2)
    pressure_max: Pressure = Measured(1e3)
    radius: Length | None = None
    floor: Length | None = None
    lid: Length | None = None

    @pydantic.model_validator(mode="after")
    def _ordered(self) -> "ChamberSection":
        if self.pressure_min.value >= self.pressure_max.value:
            raise ConfigurationError("pressure_min must be below pressure_max")
        return self

    def build(self) -> Chamber:
        """The chamber."""
        gravity = constants.STANDARD_GRAVITY if self.gravity is None else self.gravity.value
        return Chamber(
            temperature=self.temperature.value,
            gas=GASES[self.gas or AIR.name],
            gravity=gravity,
            radiation=self.build_radiation(),
            pressure_range=(self.pressure_min.value, self.pressure_max.value),
            radius=_value(self.radius),
            floor=_value(self.floor),
            lid=_value(self.lid),
        )


def _value(given: Measured | None) -> Numeric | None:
    return None if given is None else given.value
