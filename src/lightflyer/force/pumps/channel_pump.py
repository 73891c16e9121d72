r"""Through-flow, heat and force of a plate with channels, from free molecules to dense gas.

The channels pump gas at the velocity u through the plate, the gas outside resists:

.. math::
    \Delta p_0 - \Delta p = R_w u, \qquad \Delta p = \frac{F(u)}{\pi a^2}

:math:`F` is the force of the flow around the plate, from creeping to a jet. To it comes the recoil
of molecules that leave one face faster than the other.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.plate import Plate
from lightflyer.force.base import AbstractForceModel, ForceSection, ModelResult
from lightflyer.force.laws.channels import (
    SLOT,
    channel_coefficients,
    channel_conductance,
    direct_share,
    gas_at_faces,
    thermomolecular_pressure,
)
from lightflyer.force.laws.disk_gas import disk_surroundings, recoil_ratio
from lightflyer.force.laws.faces import free_molecular_conductance, in_series
from lightflyer.force.laws.gap import accommodation_between, gap_conductance
from lightflyer.force.laws.outer_flow import FLOW_RANGE, pumped_velocity, through_flow_force
from lightflyer.force.membranes.sandwich import internal_factors
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.molecules import slot_transmission

_PATH = 2.0 / np.sqrt(np.pi)  # length over the mean free path, per δ of the length
_DISK_DRAG = 16.0 / np.pi  # Stokes' drag of a disk 16μau, over its area, times a/(μu)
_RECOIL = np.sqrt(
    np.pi
)  # normal momentum of molecules that leave a wall, over their mass flux and v

_FORCE_ERROR = 0.10  # relative: creep by the Shakhov equation, entrances, porous disk at δ of 2
_HEAT_ERROR = 0.05  # relative: series of gas near and far, beside solved kinetic equations

_SLOTS = Validity(
    "channel_length over channel_width",
    10.0,
    np.inf,
    "channel-pump takes channels for slots without ends, which conduct better (6 % at 10)",
)
_SHORT = Validity(
    "height over channel_width",
    0.5,
    np.inf,
    "channel-pump takes creep along the whole wall of a channel, without its edges",
)
_SLOW = Validity(
    "the Reynolds number of the flow (radius)",
    0.0,
    1.0,
    "channel-pump neglects that the flow carries heat",
)


class ThroughFlow(NamedTuple):
    """Flow through a plate."""

    velocity: Array  # Downward, in the gas outside and over the whole area [m/s]
    stopping: Array  # Pressure below over that above at which nothing flows, and that there is [Pa]
    difference: Array


def through_flow(
    stopping: Numeric,
    wall_resistance: Numeric,
    outer_resistance: Numeric,
    *,
    radius: Numeric,
    density: Numeric,
    viscosity: Numeric,
) -> ThroughFlow:
    r"""Velocity at which the pump of a wall and the gas outside are in balance."""
    # .. math:: R_w u + \frac{F(u)}{\pi a^2} = \Delta p_0
    #
    # with the force :math:`F` of the flow around a disk (:mod:`lightflyer.force.laws.outer_flow`),
    # whose creeping limit is that of the resistance outside.
    outside = {
        "radius": radius,
        "density": density,
        "viscosity": viscosity,
        "creeping": np.pi * radius * outer_resistance / viscosity,
    }
    velocity = pumped_velocity(1.0 / wall_resistance, stopping, **outside)
    force = through_flow_force(velocity=velocity, **outside)
    return ThroughFlow(velocity, stopping, force / (np.pi * radius**2))


def outer_resistance(
    radius: Numeric, pressure: Numeric, viscosity: Numeric, most_probable_speed: Numeric
) -> Array:
    r"""Force on a disk that gas streams through evenly, per area and velocity [Pa s/m]."""
    # .. math:: \frac1{R_o} = \frac{\pi a}{16\,\mu} + \frac{v}{2\sqrt\pi\,p}
    #
    # Stokes' law for a disk, and the recoil of the free molecules that one face emits more and the
    # other less. A disk that moves and does not pump meets 14 % more of it.
    viscous = _DISK_DRAG * viscosity / radius
    return in_series(viscous, 2.0 * _RECOIL * pressure / most_probable_speed)


class ChannelPump(AbstractForceModel):
    r"""Force and heat loss of a plate whose channels pump gas towards its warmer face.

    Attributes
    ----------
    force_error, heat_error : array or None
        Deviation of the truth from the model, in the model's own standard errors: 10 % of the force
        and 5 % of the heat that the gas takes [1]. A flyer file gives both as 0 ± 1, so that they
        are part of a prediction's uncertainty. None stands for zero.

    Notes
    -----
    A channel is a slot (:mod:`lightflyer.force.laws.channels`); it pumps between the temperatures
    of the gas at both faces. The gas takes heat from the faces and gives it to the gas far away,
    and through the channels to the other face. Free molecules are not pumped, and the force is
    exactly the recoil of molecules from faces and channels. In dense gas it is the pump's alone.

    The gas in the channels and between the films has the properties at the plate's mean
    temperature; the gas outside conducts and flows as at the mean of plate and surroundings.

    :meth:`ranges` says where channels are not slots or too short, and where the flow is fast.
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Plate,)
    feels_walls: ClassVar[bool] = False
    results: ClassVar[Mapping[str, ModelResult]] = MappingProxyType(
        {
            "flow_velocity": ModelResult(
                "m/s", "downward velocity of the gas through the plate, over its area", "cm/s"
            ),
            "pressure_difference": ModelResult(
                "Pa", "pressure below the plate over that above", "mPa"
            ),
            "stopping_pressure": ModelResult(
                "Pa", "pressure difference at which nothing would flow", "mPa"
            ),
            "reynolds_number": ModelResult("", "Reynolds number of the flow, by the radius"),
        }
    )

    force_error: StandardErrors | None = None
    heat_error: StandardErrors | None = None

    @entry_point
    def heat_loss(
        self, flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        top, bottom = unknowns
        plate = _plate_in_gas(flyer, state, unknowns)
        free = _free_conductance(flyer.area, state, state.temperature)
        free = free * _off(self.heat_error, _HEAT_ERROR)
        upward = plate.conductance * (bottom - top)
        return (
            free * plate.top * (top - plate.gas_top) - upward,
            free * plate.bottom * (bottom - plate.gas_bottom) + upward,
        )

    @entry_point
    def force(self, flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        plate = _plate_in_gas(flyer, state, unknowns)
        top, bottom, gas_top, gas_bottom = map(
            _growth, (*unknowns, plate.gas_top, plate.gas_bottom)
        )
        leaving_top, leaving_bottom = (
            face * own + (1.0 - face - plate.passing) * near + plate.passing * far
            for face, own, near, far in (
                (plate.top, top, gas_top, gas_bottom),
                (plate.bottom, bottom, gas_bottom, gas_top),
            )
        )
        ratio = recoil_ratio(plate.rarefaction_outside, flyer.height / flyer.radius)
        recoil = 0.5 * state.pressure * ratio * (leaving_bottom - leaving_top)
        pressure = _flow(flyer, state, plate).difference + recoil
        return flyer.area * pressure * _off(self.force_error, _FORCE_ERROR)

    @entry_point
    def own_results(
        self, flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Any]:
        plate = _plate_in_gas(flyer, state, unknowns)
        flow = _flow(flyer, state, plate)
        return {
            "flow_velocity": flow.velocity,
            "pressure_difference": flow.difference,
            "stopping_pressure": flow.stopping,
            "reynolds_number": _reynolds_number(flyer, state, plate, flow),
        }

    def ranges(self, flyer: Plate, state: EnvironmentState, temperature: Numeric) -> Looks:
        reynolds = _highest_reynolds_number(flyer, state, temperature / state.temperature - 1.0)
        return (
            (_SLOTS, flyer.channel_length / flyer.channel_width),
            (_SHORT, flyer.height / flyer.channel_width),
            (_SLOW, reynolds),
            (FLOW_RANGE, reynolds),
        )


class PlateInGas(NamedTuple):
    """All about the gas that temperatures decide, before anything flows."""

    temperature: Array  # Mean of both faces [K]
    rarefaction: Array  # Of a channel [1]
    length: Array  # Of a channel [1]
    # Heat through the gas between the faces and in the channels, per difference of the relative
    # temperature excesses [W]
    conductance: Array
    viscosity: Array  # Outside, at the mean temperature of plate and gas far away [Pa s]
    rarefaction_outside: Array  # Of the plate's radius, with it [1]
    # Share of the molecules that come to a face which leaves as warm as it, and that passes the
    # plate as warm as it came [1]
    top: Array
    bottom: Array
    passing: Array
    gas_top: Array  # Relative temperature excess of the gas that comes to the faces [1]
    gas_bottom: Array


@kept
def _plate_in_gas(flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]) -> PlateInGas:
    (top, bottom), gas, pressure = unknowns, state.gas, state.pressure
    temperature = state.temperature * (1.0 + 0.5 * (top + bottom))
    speed = _most_probable_speed(gas, temperature)
    rarefaction = pressure * flyer.channel_width / (gas.viscosity(temperature) * speed)
    length = flyer.height / flyer.channel_width
    between = gap_conductance(
        flyer.area * flyer.solid_fraction,
        flyer.height,
        accommodation_between(flyer.top.tac_bottom, flyer.bottom.tac_top),
        pressure=pressure,
        temperature=temperature,
        mean_speed=gas.mean_speed(temperature),
        heat_capacity_ratio=gas.heat_capacity_ratio_at(temperature),
        conductivity=gas.conductivity(temperature),
    )
    # molecules that fly straight through meet no wall
    straight = direct_share(SLOT, length)
    held = slot_transmission(length).through - straight
    area = flyer.area * flyer.open_fraction
    within = in_series(
        held * _free_conductance(area, state, temperature),
        area * gas.conductivity(temperature) * temperature / flyer.height,
    )
    # of the gas that is as warm as the plate, to that of the gas far away
    conductance = (between + within) / (temperature / state.temperature)
    mean = state.temperature * (1.0 + 0.25 * (top + bottom))
    viscosity = gas.viscosity(mean)
    # what internal motion adds to conduction, over what it adds to free molecules' heat
    free, dense = internal_factors(
        gas.heat_capacity_ratio_at(mean),
        gas.specific_gas_constant,
        viscosity,
        gas.conductivity(mean),
    )
    speed = _most_probable_speed(gas, state.temperature)
    outside = pressure * flyer.radius / (viscosity * speed)
    straight = straight / (1.0 + _PATH * rarefaction * length)
    opening, film = flyer.open_fraction, flyer.solid_fraction
    from_top = film * flyer.top.tac_top + opening * (1.0 - straight)
    from_bottom = film * flyer.bottom.tac_bottom + opening * (1.0 - straight)
    passing = opening * straight
    around = disk_surroundings(outside, dense / free)
    near = gas_at_faces(top, bottom, from_top, from_bottom, passing, around)
    return PlateInGas(
        temperature, rarefaction, length, conductance, viscosity, outside, from_top, from_bottom,
        passing, *near,
    )  # fmt: skip


def _flow(flyer: Plate, state: EnvironmentState, plate: PlateInGas) -> ThroughFlow:
    coefficients = channel_coefficients(SLOT, plate.rarefaction, plate.length)
    conductance = channel_conductance(
        SLOT, plate.rarefaction, plate.length, flyer.open_fraction, coefficients
    )
    density = state.gas.density(state.pressure, state.temperature)
    viscosity = plate.viscosity
    speed = _most_probable_speed(state.gas, plate.temperature)
    return through_flow(
        thermomolecular_pressure(
            coefficients.exponent, state.pressure, plate.gas_bottom, plate.gas_top
        ),
        density * speed / (flyer.open_fraction * conductance),
        outer_resistance(
            flyer.radius,
            state.pressure,
            viscosity,
            _most_probable_speed(state.gas, state.temperature),
        ),
        radius=flyer.radius,
        density=density,
        viscosity=viscosity,
    )


def _off(errors: Numeric | None, relative: float) -> Numeric:
    """Factor of a result that is off by some of its standard errors."""
    return 1.0 if errors is None else 1.0 + relative * errors


def _growth(excess: Array) -> Array:
    """√(1 + θ) − 1, without cancellation."""
    return excess / (xp.sqrt(1.0 + excess) + 1.0)


def _most_probable_speed(gas: AbstractGas, temperature: Numeric) -> Array:
    return xp.sqrt(2.0 * gas.specific_gas_constant * temperature)


def _free_conductance(area: Numeric, state: EnvironmentState, temperature: Numeric) -> Array:
    """Heat of free molecules to black faces, per relative temperature difference [W]."""
    gas = state.gas
    speed, ratio = gas.mean_speed(temperature), gas.heat_capacity_ratio_at(temperature)
    return free_molecular_conductance(area, 1.0, state.pressure, speed, ratio)


def _reynolds_number(
    flyer: Plate, state: EnvironmentState, plate: PlateInGas, flow: ThroughFlow
) -> Array:
    density = state.gas.density(state.pressure, state.temperature)
    return density * flyer.radius * xp.abs(flow.velocity) / plate.viscosity


@entry_point
def _highest_reynolds_number(flyer: Plate, state: EnvironmentState, hottest: Array) -> Array:
    """With the largest temperature difference that hottest face and absorbed power allow."""
    gained = zip(flyer.beam_areas(state), flyer.heat_gains(state), strict=True)
    power = [beam * state.radiation.irradiance + other for beam, other in gained]
    conductance = _plate_in_gas(flyer, state, (hottest, hottest)).conductance
    difference = xp.minimum(hottest, xp.maximum(*map(xp.abs, power)) / conductance)
    faces = (hottest - difference, hottest)
    plate = _plate_in_gas(flyer, state, faces)
    return _reynolds_number(flyer, state, plate, _flow(flyer, state, plate))


class ChannelPumpSection(ForceSection, of=ChannelPump):
    """``[force]``: channels as a pump, for a plate; its own error counts unless told otherwise."""

    model: Literal["channel-pump"]
