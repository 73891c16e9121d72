r"""Through-flow, heat and force of a plate with channels, from free molecules to dense gas.

The channels pump gas at the velocity u through the plate, the gas outside resists:

.. math::
    \Delta p_0 - \Delta p = R_w u, \qquad \Delta p = R_o u + \rho\,u|u|

:math:`\Delta p` is the force that flow exerts on the plate, per area. To it comes the recoil of
molecules that leave one face faster than the other.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, ClassVar, Literal, NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.plate import Plate
from lightflyer.force.base import AbstractForceModel, ModelResult
from lightflyer.force.channels import (
    SLOT,
    channel_conductance,
    direct_share,
    gas_at_faces,
    slot_transmission,
    thermomolecular_exponent,
    thermomolecular_pressure,
)
from lightflyer.force.disk_gas import disk_surroundings, recoil_ratio
from lightflyer.force.gap import accommodation_between, gap_conductance
from lightflyer.force.laws import free_molecular_conductance, in_series
from lightflyer.force.schafer2025_table import internal_factors
from lightflyer.force.section import ForceSection
from lightflyer.force.validity import Validity
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.base import AbstractGas

_PATH = 2.0 / np.sqrt(np.pi)  # length over the mean free path, per δ of the length
_DISK_DRAG = 16.0 / np.pi  # Stokes' drag of a disk 16μau, over its area, times a/(μu)
_RECOIL = np.sqrt(
    np.pi
)  # normal momentum of molecules that leave a wall, over their mass flux and v

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
    "channel-pump adds the momentum of a jet to Stokes' law there, and neglects that flow "
    "carries heat",
)


class Inside(NamedTuple):
    """Gas within a plate.

    Attributes
    ----------
    temperature : array, shape (...)
        Mean of both faces [K].
    rarefaction, length : array, shape (...)
        Of a channel [1].
    conductance : array, shape (...)
        Heat through the gas between the faces and in the channels, per difference of the relative
        temperature excesses [W].
    """

    temperature: Array
    rarefaction: Array
    length: Array
    conductance: Array


class Exchange(NamedTuple):
    """What becomes of molecules that come to a plate.

    Attributes
    ----------
    top, bottom : array, shape (...)
        Share that leaves as warm as that face [1].
    passing : array, shape (...)
        Share that passes the plate as warm as it came [1].
    """

    top: Array
    bottom: Array
    passing: Array

    def reflected(self, face: Array) -> Array:
        """Share that leaves a face as warm as it came [1]."""
        return 1.0 - face - self.passing


class ThroughFlow(NamedTuple):
    """Flow through a plate.

    Attributes
    ----------
    velocity : array, shape (...)
        Downward, in the gas outside and over the whole area [m/s].
    stopping, difference : array, shape (...)
        Pressure below over that above at which nothing flows, and that there is [Pa].
    """

    velocity: Array
    stopping: Array
    difference: Array


def through_flow(
    stopping: Numeric, wall_resistance: Numeric, outer_resistance: Numeric, density: Numeric
) -> ThroughFlow:
    r"""Velocity at which the pump of a wall and the gas outside are in balance.

    .. math:: \rho\,u|u| + (R_o + R_w)\,u = \Delta p_0

    Parameters
    ----------
    stopping : array, shape (...)
        :math:`\Delta p_0` [Pa].
    wall_resistance, outer_resistance : array, shape (...)
        :math:`R_w` and :math:`R_o` [Pa s/m].
    density : array, shape (...)
        Of the gas [kg/m³].

    Returns
    -------
    ThroughFlow

    Notes
    -----
    The jet's momentum :math:`\rho u^2` per area adds to Stokes' law. That is right in both limits,
    and between them up to 40 % too large, around a Reynolds number of 5.
    """
    resistance = outer_resistance + wall_resistance
    # of the quadratic equation, without cancellation
    root = jnp.sqrt(resistance**2 + 4.0 * density * jnp.abs(stopping))
    velocity = 2.0 * stopping / (resistance + root)
    return ThroughFlow(velocity, stopping, stopping - wall_resistance * velocity)


def outer_resistance(
    radius: Numeric, pressure: Numeric, viscosity: Numeric, most_probable_speed: Numeric
) -> Array:
    r"""Force on a disk that gas streams through evenly, per area and velocity.

    .. math:: \frac1{R_o} = \frac{\pi a}{16\,\mu} + \frac{v}{2\sqrt\pi\,p}

    Parameters
    ----------
    radius, pressure, viscosity : array, shape (...)
        [m], [Pa], [Pa s].
    most_probable_speed : array, shape (...)
        :math:`v = \sqrt{2RT}` [m/s].

    Returns
    -------
    array, broadcast shape
        [Pa s/m].

    Notes
    -----
    Stokes' law for a disk, and the recoil of the free molecules that one face emits more and the
    other less. A disk that moves and does not pump meets 14 % more of it.
    """
    viscous = _DISK_DRAG * viscosity / radius
    return in_series(viscous, 2.0 * _RECOIL * pressure / most_probable_speed)


class ChannelPump(AbstractForceModel):
    r"""Force and heat loss of a plate whose channels pump gas towards its warmer face.

    Notes
    -----
    A channel is a slot (:mod:`lightflyer.force.channels`); it pumps between the temperatures of the
    gas at both faces. The gas takes heat from the faces and gives it to the gas far away, and
    through the channels to the other face. To free molecules nothing is pumped, and the force is
    exactly the recoil of molecules from faces and channels. In dense gas it is the pump's alone.

    The gas in the channels and between the films has the properties at the plate's mean
    temperature; the gas outside conducts and flows as at the mean of plate and surroundings.

    :meth:`caveats` says where channels are not slots or too short, and where inertia counts.
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Plate,)
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

    @entry_point
    def heat_loss(
        self, flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """See :meth:`AbstractForceModel.heat_loss`."""
        top, bottom = unknowns
        inside = _inside(flyer, state, unknowns)
        exchange, (gas_top, gas_bottom) = _gas_at_plate(flyer, state, inside, unknowns)
        free = _free_conductance(flyer.area, state, state.temperature)
        upward = inside.conductance * (bottom - top)
        return (
            free * exchange.top * (top - gas_top) - upward,
            free * exchange.bottom * (bottom - gas_bottom) + upward,
        )

    @entry_point
    def force(self, flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        inside = _inside(flyer, state, unknowns)
        exchange, gas = _gas_at_plate(flyer, state, inside, unknowns)
        flow = _flow(flyer, state, inside, gas, unknowns)
        (top, bottom), (gas_top, gas_bottom) = (_growths(pair) for pair in (unknowns, gas))
        leaving_top, leaving_bottom = (
            face * own + exchange.reflected(face) * near + exchange.passing * far
            for face, own, near, far in (
                (exchange.top, top, gas_top, gas_bottom),
                (exchange.bottom, bottom, gas_bottom, gas_top),
            )
        )
        ratio = recoil_ratio(_outer_rarefaction(flyer, state, unknowns))
        recoil = 0.5 * state.pressure * ratio * (leaving_bottom - leaving_top)
        return flyer.area * (flow.difference + recoil)

    @entry_point
    def own_results(
        self, flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Any]:
        """See :meth:`AbstractForceModel.own_results`."""
        inside = _inside(flyer, state, unknowns)
        _, gas = _gas_at_plate(flyer, state, inside, unknowns)
        flow = _flow(flyer, state, inside, gas, unknowns)
        return {
            "flow_velocity": flow.velocity,
            "pressure_difference": flow.difference,
            "stopping_pressure": flow.stopping,
            "reynolds_number": _reynolds_number(flyer, state, flow.velocity),
        }

    def caveats(
        self,
        flyer: Plate,
        state: EnvironmentState,
        temperature: Numeric,
    ) -> tuple[str, ...]:
        """See :meth:`AbstractForceModel.caveats`."""
        return tuple(_caveats(flyer, state, temperature))


def _inside(flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Inside:
    temperature = state.temperature * (1.0 + 0.5 * (unknowns[0] + unknowns[1]))
    gas, pressure = state.gas, state.pressure
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
        heat_capacity_ratio=gas.heat_capacity_ratio,
        conductivity=gas.conductivity(temperature),
    )
    # molecules that fly straight through meet no wall
    held = slot_transmission(length).through - direct_share(SLOT, length)
    area = flyer.area * flyer.open_fraction
    within = in_series(
        held * _free_conductance(area, state, temperature),
        area * gas.conductivity(temperature) * temperature / flyer.height,
    )
    # of the gas that is as warm as the plate, to that of the gas far away
    warmer = temperature / state.temperature
    return Inside(temperature, rarefaction, length, (between + within) / warmer)


def _gas_at_plate(
    flyer: Plate, state: EnvironmentState, inside: Inside, unknowns: tuple[Array, ...]
) -> tuple[Exchange, tuple[Array, Array]]:
    """What becomes of molecules that come to a plate, and how warm they are at both faces."""
    straight = direct_share(SLOT, inside.length)
    straight /= 1.0 + _PATH * inside.rarefaction * inside.length
    opening, film = flyer.open_fraction, flyer.solid_fraction
    exchange = Exchange(
        film * flyer.top.tac_top + opening * (1.0 - straight),
        film * flyer.bottom.tac_bottom + opening * (1.0 - straight),
        opening * straight,
    )
    mean = _outer_temperature(state, unknowns)
    free, dense = internal_factors(
        state.gas.heat_capacity_ratio,
        state.gas.specific_gas_constant,
        state.gas.viscosity(mean),
        state.gas.conductivity(mean),
    )
    around = disk_surroundings(_outer_rarefaction(flyer, state, unknowns), dense / free)
    top, bottom = unknowns
    return exchange, gas_at_faces(
        top, bottom, exchange.top, exchange.bottom, exchange.passing, around
    )


def _flow(
    flyer: Plate,
    state: EnvironmentState,
    inside: Inside,
    gas: tuple[Array, Array],
    unknowns: tuple[Array, ...],
) -> ThroughFlow:
    top, bottom = gas
    exponent = thermomolecular_exponent(SLOT, inside.rarefaction, inside.length)
    conductance = channel_conductance(SLOT, inside.rarefaction, inside.length, flyer.open_fraction)
    density = state.gas.density(state.pressure, state.temperature)
    speed = _most_probable_speed(state.gas, inside.temperature)
    return through_flow(
        thermomolecular_pressure(exponent, state.pressure, bottom, top),
        density * speed / (flyer.open_fraction * conductance),
        outer_resistance(
            flyer.radius,
            state.pressure,
            state.gas.viscosity(_outer_temperature(state, unknowns)),
            _most_probable_speed(state.gas, state.temperature),
        ),
        density,
    )


def _growths(excesses: tuple[Array, ...]) -> tuple[Array, ...]:
    """√(1 + θ) − 1, without cancellation."""
    return tuple(excess / (jnp.sqrt(1.0 + excess) + 1.0) for excess in excesses)


def _most_probable_speed(gas: AbstractGas, temperature: Numeric) -> Array:
    return jnp.sqrt(2.0 * gas.specific_gas_constant * temperature)


def _free_conductance(area: Numeric, state: EnvironmentState, temperature: Numeric) -> Array:
    """Heat of free molecules to black faces, per relative temperature difference [W]."""
    gas = state.gas
    speed = gas.mean_speed(temperature)
    return free_molecular_conductance(area, 1.0, state.pressure, speed, gas.heat_capacity_ratio)


def _outer_temperature(state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
    """Mean of the plate and the gas far away [K]."""
    return state.temperature * (1.0 + 0.25 * (unknowns[0] + unknowns[1]))


def _outer_rarefaction(flyer: Plate, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
    viscosity = state.gas.viscosity(_outer_temperature(state, unknowns))
    speed = _most_probable_speed(state.gas, state.temperature)
    return state.pressure * flyer.radius / (viscosity * speed)


def _reynolds_number(flyer: Plate, state: EnvironmentState, velocity: Array) -> Array:
    density = state.gas.density(state.pressure, state.temperature)
    return density * flyer.radius * jnp.abs(velocity) / state.gas.viscosity(state.temperature)


def _caveats(flyer: Plate, state: EnvironmentState, temperature: Numeric) -> Iterator[str]:
    width = np.asarray(flyer.channel_width)
    yield from _SLOTS.caveats(flyer.channel_length / width, state.pressure)
    yield from _SHORT.caveats(flyer.height / width, state.pressure)
    hottest = jnp.asarray(temperature) / state.temperature - 1.0
    yield from _SLOW.caveats(_highest_reynolds_number(flyer, state, hottest), state.pressure)


@entry_point
def _highest_reynolds_number(flyer: Plate, state: EnvironmentState, hottest: Array) -> Array:
    """With the largest temperature difference that hottest face and absorbed power allow."""
    gained = zip(flyer.beam_areas(state), flyer.heat_gains(state), strict=True)
    power = [beam * state.radiation.irradiance + other for beam, other in gained]
    conductance = _inside(flyer, state, (hottest, hottest)).conductance
    difference = jnp.minimum(hottest, jnp.maximum(*map(jnp.abs, power)) / conductance)
    faces = (hottest - difference, hottest)
    inside = _inside(flyer, state, faces)
    _, gas = _gas_at_plate(flyer, state, inside, faces)
    return _reynolds_number(flyer, state, _flow(flyer, state, inside, gas, faces).velocity)


class ChannelPumpSection(ForceSection):
    """``[force]``: channels as a pump, for a plate."""

    model_type: ClassVar[type[AbstractForceModel]] = ChannelPump

    model: Literal["channel-pump"]

    def build(self) -> ChannelPump:
        """The force model."""
        return ChannelPump()
