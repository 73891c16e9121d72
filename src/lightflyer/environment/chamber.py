r"""A vacuum chamber with a lamp, and the gas above its floor.

Temperature of the gas above a floor that is warmer than the rest of a chamber.

At rest the gas between floor, lid and side wall conducts heat. A share :math:`s` of the floor's
excess is left at the flyer's height:

.. math:: T = T_c + s\,(T_f - T_c), \qquad s = (1-w)\,s_0 + w\,s_\infty

with :math:`s_0` of conduction on the axis of the chamber, whose walls stand back by the jump of the
temperature there, and :math:`s_\infty = F/2` of free molecules, half of those that meet the flyer
coming from the floor's view :math:`F`. Between them

.. math::
    w = \frac{\ell}{\ell + c\,d}, \qquad d = (d_f\,d_l\,d_w)^{1/3}

with half the mean free path :math:`\ell`. Two numbers, of join and jump, are fitted to solutions
of the linear kinetic equation around a cold disk above a warm floor (``studies/kinetic_chamber``):
138 of them, with Kn from 0.03 to 2 and surfaces from half a radius to 60 radii away, are met within
0.018 (r.m.s.). Without side wall or lid a share has no meaning: the gas far away would be as warm
as the floor.
"""

from dataclasses import replace
from typing import ClassVar, Literal

import numpy as np
import pydantic

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.entry_point import entry_point
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
from lightflyer.environment.base import AbstractEnvironment, Coordinate, EnvironmentState, Place
from lightflyer.environment.radiation import Radiation
from lightflyer.environment.section import EnvironmentSection
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas, mean_free_path
from lightflyer.gas.pure import GASES
from lightflyer.numerics.special import i0e

_RARE = 0.4257  # Of the join of both limits, :math:`c`
_JUMP = 1.699  # Distance by which walls stand back, in half mean free paths

_MODES = np.arange(1, 65)
_ENOUGH = 10.0  # times further away a surface no longer matters: its share falls as e^(-10 μ)


@entry_point
def over_warm_floor(state: EnvironmentState, floor_temperature: Numeric) -> EnvironmentState:
    """Surroundings in a chamber whose floor is warmer, or colder, than lid and side wall."""
    excess = floor_temperature / state.temperature - 1.0
    path = mean_free_path(state.pressure, state.temperature, state.gas)
    share = share_of_floor(*distances(state), 0.5 * path)
    temperature = state.temperature * (1.0 + share * excess)
    return replace(state, temperature=temperature, floor_excess=excess)


def distances(state: EnvironmentState) -> tuple[Numeric, Numeric, Numeric]:
    """Distances of floor, lid and side wall [m]; infinite where there is none."""
    given = state.floor_distance, state.lid_distance, state.wall_distance
    floor, lid, wall = (np.inf if each is None else each for each in given)
    return floor, lid, wall


def conducted_share(floor: Numeric, lid: Numeric, wall: Numeric) -> Array:
    """Share of the floor's excess in the middle of a cylinder that conducts heat [1]."""
    lid = xp.minimum(lid, _ENOUGH * wall)
    height = floor + lid
    wall = xp.minimum(wall, _ENOUGH * height)
    floor, height, wall = (xp.asarray(each)[..., None] for each in (floor, height, wall))
    place = np.pi * _MODES / height
    # I0 of large numbers overflows
    bent = xp.sin(place * floor) / _MODES * xp.exp(-place * wall) / i0e(place * wall)
    return (1.0 - floor / height)[..., 0] - 2.0 / np.pi * xp.sum(bent, axis=-1)


def view_of_floor(floor: Numeric, wall: Numeric) -> Array:
    """View factor from a face that looks down to the floor of a cylinder [1]."""
    return 1.0 / (1.0 + (floor / xp.asarray(wall)) ** 2)


def share_of_floor(
    floor: Numeric, lid: Numeric, wall: Numeric, half_mean_free_path: Numeric
) -> Array:
    """Share of the floor's excess that the gas has at the flyer [1]."""
    return joined_share(floor, lid, wall, half_mean_free_path, _RARE, _JUMP)


def joined_share(
    floor: Numeric,
    lid: Numeric,
    wall: Numeric,
    half_mean_free_path: Numeric,
    rare: float,
    jump: float,
) -> Array:
    """The share by other numbers for the join of both limits and the walls' jump."""
    back = jump * half_mean_free_path
    dense = conducted_share(floor + back, lid + back, wall + back)
    apart = rare * middle_distance(floor, lid, wall)
    weight = half_mean_free_path / (half_mean_free_path + apart)
    return (1.0 - weight) * dense + weight * 0.5 * view_of_floor(floor, wall)


def middle_distance(floor: Numeric, lid: Numeric, wall: Numeric) -> Array:
    """Geometric mean of the distances, of those that matter."""
    lid = xp.minimum(lid, _ENOUGH * wall)
    wall = xp.minimum(wall, _ENOUGH * (floor + lid))
    return xp.cbrt(floor * lid * wall)


PRESSURES = 1e-2, 1e3  # of interest, unless stated otherwise [Pa]
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
    floor_temperature : array or None
        Where it is not that of lid and side wall [K]. It needs the floor's distance, and that of
        lid or walls. The gas then has the temperature at the flyer's place, by the equations in
        the head of this module, and the floor radiates as a black one.

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

    temperature: ChamberTemperature = 293.0
    gas: AbstractGas = AIR
    gravity: Acceleration = constants.STANDARD_GRAVITY
    radiation: Radiation = Radiation()
    pressure_range: tuple[Numeric, Numeric] = PRESSURES
    radius: Length | None = None
    floor: Length | None = None
    lid: Length | None = None
    floor_temperature: ChamberTemperature | None = None

    @staticmethod
    def contradiction(
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
        above, below = self.radiation.infrared_above, self.radiation.infrared_below
        black = self.radiation.stefan_boltzmann  # of lid and side wall, and of the floor
        given = replace(
            self.radiation,
            infrared_above=black * self.temperature**4 if above is None else above,
            infrared_below=black * self.floor_temperature**4 if below is None else below,
        )
        return given.with_ground_view(view_of_floor(self.floor, wall))

    def state(self, coordinate: Numeric, place: Place | None = None) -> EnvironmentState:
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
