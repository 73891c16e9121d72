"""A vacuum chamber with a lamp."""

from collections.abc import Callable
from typing import ClassVar, Literal

import numpy as np
import pydantic

from lightflyer.array.namespace import Numeric
from lightflyer.core import constants
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    Acceleration,
    ChamberTemperature,
    Irradiance,
    LampIncidence,
    Length,
    Pressure,
    Quantity,
    quantity_of,
)
from lightflyer.core.text import span
from lightflyer.core.units import Measured
from lightflyer.environment.base import (
    AbstractEnvironment,
    Coordinate,
    EnvironmentState,
    Place,
)
from lightflyer.environment.radiation import Radiation
from lightflyer.environment.section import EnvironmentSection
from lightflyer.environment.warm_floor import (
    over_warm_floor,
    radiation_over_floor,
    view_of_floor,
)
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.registry import GASES

PRESSURES = 1e-2, 1e3  # of interest, unless stated otherwise [Pa]
_PRESSURE = quantity_of(Pressure) or Quantity()


def _contradiction(
    floor_temperature: Numeric | None,
    floor: Numeric | None,
    lid: Numeric | None,
    radius: Numeric | None,
) -> str | None:
    """Why it is not known where between a warm floor and cold walls the gas is, or None."""
    if floor_temperature is not None and floor is None:
        return "floor_temperature needs the distance of the floor; give floor"
    if floor_temperature is not None and lid is None and radius is None:
        return (
            "floor_temperature needs a wall of another temperature; give lid or radius, or the "
            "gas is as warm as the floor"
        )
    return None


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
    floor_temperature : array or None
        Where it is not that of lid and side wall [K]. It needs the floor's distance, and that of
        lid or walls. The gas then has the temperature at the flyer's place,
        :mod:`lightflyer.environment.warm_floor`, and the floor radiates as a black one.

    Notes
    -----
    Of force models only the kinetic one takes walls, floor and lid into account; others warn.

    Raises
    ------
    ParameterError
        If a concrete value is not positive, the range is empty, or a floor's temperature is given
        without the distances that it needs.
    """

    dimmable_light: ClassVar[bool] = True
    contradiction: ClassVar[Callable[..., str | None]] = staticmethod(_contradiction)

    temperature: ChamberTemperature = 293.0
    gas: AbstractGas = AIR
    gravity: Acceleration = constants.STANDARD_GRAVITY
    radiation: Radiation = Radiation()
    pressure_range: tuple[Numeric, Numeric] = PRESSURES
    radius: Length | None = None
    floor: Length | None = None
    lid: Length | None = None
    floor_temperature: ChamberTemperature | None = None

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
            easiest_keys=("optimum", "irradiance_w_m2"),
            open_ended=True,
        )

    def assumptions(self) -> tuple[str, ...]:
        told = self._seen_radiation.describe()
        if self.floor_temperature is not None:
            told += (
                f"floor at {span(self.floor_temperature)} K, all else at {span(self.temperature)} "
                "K; the gas as warm as between them at the flyer's place",
            )
        return (*told, *self.gas.assumptions())

    @property
    def _seen_radiation(self) -> Radiation:
        if self.floor_temperature is None:
            return self.radiation
        wall = np.inf if self.radius is None else self.radius
        return radiation_over_floor(
            self.radiation,
            self.temperature,
            self.floor_temperature,
            view_of_floor(self.floor, wall),
        )

    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:  # noqa: ARG002
        """Surroundings at a pressure, which may lie outside the range of interest."""
        pressure = self.coordinate.quantity.number("pressure", coordinate, keep_index=True)
        _PRESSURE.check("pressure", pressure)
        state = EnvironmentState(
            pressure=pressure,
            temperature=self.temperature,
            gravity=self.gravity,
            gas=self.gas,
            radiation=self._seen_radiation,
            wall_distance=self.radius,
            floor_distance=self.floor,
            lid_distance=self.lid,
        )
        if self.floor_temperature is None:
            return state
        return over_warm_floor(state, self.floor_temperature)


class ChamberSection(EnvironmentSection, of=Chamber):
    """``[environment]``: a vacuum chamber with a lamp."""

    search_keys: ClassVar[tuple[str, str]] = ("pressure_min", "pressure_max")

    kind: Literal["chamber"]
    irradiance: Irradiance = Measured(constants.TOTAL_SOLAR_IRRADIANCE)
    incidence: LampIncidence = Measured(0.0)
    temperature: ChamberTemperature
    pressure_min: Pressure = Measured(PRESSURES[0])
    pressure_max: Pressure = Measured(PRESSURES[1])

    @pydantic.model_validator(mode="after")
    def _require_order(self) -> "ChamberSection":
        if self.pressure_min.value >= self.pressure_max.value:
            raise ConfigurationError("pressure_min must be below pressure_max")
        return self

    def build(self) -> Chamber:
        gravity = constants.STANDARD_GRAVITY if self.gravity is None else self.gravity.value
        chamber: Chamber = self.make(
            gas=GASES[self.gas or AIR.name],
            gravity=gravity,
            radiation=self.build_radiation(),
            pressure_range=self.search_range,
        )
        return chamber
