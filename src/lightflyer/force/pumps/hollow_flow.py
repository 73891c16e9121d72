r"""Flow through a hollow body and its force, as published or with each of its corrections.

The wall pumps gas in, and a jet leaves at the outlet. One quadratic equation has the velocity
:math:`v` of the jet:

.. math::
    \tfrac12\rho_j a\,v|v| + \left(R + \frac{\rho_j A_o v_m}{\varphi g A_t}\right)v
        = \Delta p_0 - \Delta p_r - \Delta p_b, \qquad a = 1 - (A_o/A_t)^2

with the pressure :math:`\Delta p_0` at which the wall pumps no more, and the conductance :math:`g`
of its channels (:mod:`lightflyer.force.laws.channels`). As published the others are zero: the
resistance :math:`R` of body and outlet to slow or thin gas, the pressure :math:`\Delta p_r` that
the outlet holds by itself, and the pressure :math:`\Delta p_b` by which warm gas pushes upward.
"""

import math
from typing import NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.hollow import HollowBody
from lightflyer.force.base import ModelResult
from lightflyer.force.laws.channels import (
    ROUND,
    SLOT,
    Coefficients,
    channel_coefficients,
    channel_conductance,
    direct_share,
    entrance_resistance,
    thermomolecular_exponent,
    thermomolecular_pressure,
)
from lightflyer.force.laws.faces import free_molecular_conductance
from lightflyer.force.pumps import celenza2023_laws as published
from lightflyer.gas.base import mean_free_path

_RAREFIED_DRAG = 1.264  # Stokes' drag of a broad disk over that of free molecules, 16/(4/√π + √π)
_NO_LENGTH = 1e-9  # of a hole in a thin wall, over its width or radius


class Corrections(NamedTuple):
    """Corrections to the published model, each on or off."""

    # (1) The entrances of the channels resist. Published: channels much longer than wide
    short_channels: bool = True
    # (2) Light falls on the area seen from its source, and is absorbed as the films do. Published:
    # everything on the whole wall at normal incidence
    projected_light: bool = True
    # (3) Both films radiate, the outer one is cooled by the gas, and gas that flows takes heat.
    # Published: the outer film is as warm as the gas, half of the absorbed light passes the wall
    energy_balance: bool = True
    # (4) Slow and thin gas is held back at the outlet. Published: Bernoulli
    viscous_outlet: bool = True
    # (5) The drag of thin gas, and the recoil of free molecules. Published: Stokes
    rarefied_force: bool = True
    # (6) The flow in channels by the kinetic equation. Published: two fits
    channel_coefficients: bool = True
    # (7) Conductivity and viscosity at the temperature of the gas, temperature jumps by the TACs.
    # Published: one conductivity, Sutherland's law, rounded constants
    gas_properties: bool = True
    # (8) The jet is as warm as the inner film. Published: as the gas outside
    jet_density: bool = True
    # (9) Warm gas leaves by the upper part of the wall, and other gas comes in below. Published:
    # gas of the same pressure everywhere within
    buoyant_flow: bool = True


class Errors(NamedTuple):
    """Factors by which the truth may be off: see :class:`~lightflyer.HollowPump`."""

    # Of the pressure that the wall pumps up beyond what the outlet holds, of the resistance of body
    # and outlet, of drag and jet, and of the heat that the gas takes [1]
    wall: Numeric = 1.0
    outlet: Numeric = 1.0
    force: Numeric = 1.0
    heat: Numeric = 1.0


EXACT = Errors()  # Without an error
AS_PUBLISHED = Corrections(*(False,) * len(Corrections._fields))  # No correction


class PumpFlow(NamedTuple):
    """Flow through a hollow body."""

    jet_velocity: Array  # Mean velocity at the outlet, outward positive [m/s]
    wall_velocity: Array  # Velocity of the gas that comes to the wall, inward positive [m/s]
    pressure_difference: Array  # Pressure within over that outside, the mean over the wall [Pa]
    jet_density: Array  # [kg/m³]
    # What leaves by the upper part of the wall as other gas comes in below, beside the flow through
    # the outlet [kg/s]
    exchange: Array


def _areas(flyer: HollowBody, corrections: Corrections) -> tuple[Numeric, Numeric]:
    """Of wall and outlet [m²]."""
    rounded = 1.0 if corrections.gas_properties else published.PI / np.pi
    return rounded * flyer.surface, rounded * flyer.outlet_area


def mean_temperature(state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
    """Of both films [K]."""
    inner, outer = unknowns
    return state.temperature * (1.0 + 0.5 * (inner + outer))


def _transport(
    state: EnvironmentState, temperature: Array, corrections: Corrections
) -> tuple[Numeric, Array, Numeric]:
    """Gas constant, viscosity, and the temperature that the rarefaction is taken at."""
    if corrections.gas_properties:
        gas = state.gas
        return gas.specific_gas_constant, gas.viscosity(temperature), temperature
    cold = state.temperature
    return published.SPEED_CONSTANT, published.viscosity(cold), cold


def share_at_wall(flyer: HollowBody, state: EnvironmentState) -> Array:
    """Share of the outer film's excess that the gas at it has: 0 to free molecules, 1 if dense."""
    dense = 4.0 * np.pi * radius(flyer) * state.gas.conductivity(state.temperature)
    free = free_molecular(state, flyer.surface)
    return free / (free + dense * state.temperature)


def radius(flyer: HollowBody) -> Array:
    """Of the sphere that has the wall's area [m]."""
    return xp.sqrt(flyer.surface / (4.0 * np.pi))


def free_molecular(state: EnvironmentState, area: Numeric) -> Array:
    """Heat that free molecules take from a face with a TAC of one, per relative excess [W]."""
    speed = state.gas.mean_speed(state.temperature)
    ratio = state.gas.heat_capacity_ratio_at(state.temperature)
    return free_molecular_conductance(area, 1.0, state.pressure, speed, ratio)


@kept
def pump_flow(
    flyer: HollowBody,
    state: EnvironmentState,
    unknowns: tuple[Array, ...],
    corrections: Corrections,
    errors: Errors = EXACT,
) -> PumpFlow:
    """Flow through a hollow body whose films have given temperatures; of broadcast shape."""
    inner, outer = unknowns
    wall, outlet = _areas(flyer, corrections)
    path = mean_free_path(state.pressure, state.temperature, state.gas)
    # what flows through an area of the wall: conductance × (stopping − pressure difference)
    mean = mean_temperature(state, unknowns)
    constant, viscosity, at = _transport(state, mean, corrections)
    speed = xp.sqrt(2.0 * constant * mean)
    rarefaction = state.pressure * flyer.channel_width / (viscosity * xp.sqrt(2.0 * constant * at))
    length = flyer.wall_thickness / flyer.channel_width
    ended = length if corrections.short_channels else None
    if corrections.channel_coefficients:
        coefficients = channel_coefficients(SLOT, rarefaction, ended)
    else:
        coefficients = Coefficients(
            published.poiseuille_coefficient(rarefaction), published.creep_coefficient(rarefaction)
        )
    exponent = coefficients.creep / coefficients.poiseuille
    if corrections.short_channels:
        conductance = channel_conductance(
            SLOT, rarefaction, length, flyer.open_fraction, coefficients
        )
        # those that meet no other molecule on the way
        passing = flyer.open_fraction * direct_share(SLOT, length)
        passing = passing / (1.0 + flyer.wall_thickness / path)
        outside = share_at_wall(flyer, state) * ((1.0 - passing) * outer + passing * inner)
        stopping = thermomolecular_pressure(exponent, state.pressure, inner, outside)
    else:
        conductance = coefficients.poiseuille / length
        relative = (inner - outer) / (1.0 + 0.5 * (inner + outer))
        stopping = exponent * state.pressure * relative
    conductance = flyer.open_fraction * conductance / speed
    density = (
        state.gas.density(state.pressure, state.temperature)
        if corrections.gas_properties
        else state.pressure / (published.DENSITY_CONSTANT * state.temperature)
    )
    jet_density = density / (1.0 + inner) if corrections.jet_density else density
    # resistance of body and outlet to slow gas [Pa s/m], and pressure without flow [Pa]
    resistance, held = 0.0, 0.0
    if corrections.viscous_outlet:
        constant, viscosity, at = _transport(state, state.temperature * (1.0 + inner), corrections)
        speed = xp.sqrt(2.0 * constant * at)
        rarefaction = state.pressure * flyer.outlet_radius / (viscosity * speed)
        exponent = _outlet_exponent(flyer, state, corrections)
        held = thermomolecular_pressure(exponent, state.pressure, inner, 0.0)
        way = flyer.geometry.passage(flyer.size, flyer.outlet_radius)
        way = way / channel_coefficients(ROUND, rarefaction, way).poiseuille
        resistance = jet_density * speed * (entrance_resistance(ROUND, rarefaction) + way)
    resistance = errors.outlet * resistance
    # how much the pressure within, over that outside, grows over half of the height: not where
    # molecules fly from wall to wall
    lifted: Numeric = 0.0
    if corrections.buoyant_flow:
        height = flyer.geometry.height(flyer.size, flyer.outlet_radius)
        height = height / (1.0 + path / height)
        if flyer.attitude is not None:
            height = height * xp.cos(flyer.attitude.tilt)
        lifted = 0.5 * density * state.gravity * height * inner / (1.0 + inner)
    ratio = outlet / wall
    slope = resistance + jet_density * ratio / conductance
    kinetic = 0.5 * jet_density * (1.0 - ratio**2)
    # the outlet is half of the height below the middle of the wall
    drive = errors.wall * (stopping - held) - lifted
    # of the quadratic equation with v|v|, without cancellation
    root = xp.sqrt(slope**2 + 4.0 * kinetic * xp.abs(drive))
    velocity = 2.0 * drive / (slope + root)
    pressure = kinetic * velocity * xp.abs(velocity) + resistance * velocity + held + lifted
    wall_velocity = jet_density / density * ratio * velocity
    # The flow through the wall falls evenly by J either way: (J − |j|)²/4J leaves where some of the
    # wall sends gas out and some lets it in. What leaves on the whole is not part of it.
    most, mean = xp.abs(conductance * lifted), xp.abs(density * wall_velocity)
    both = most > mean
    exchange = wall * xp.where(both, (most - mean) ** 2 / (4.0 * xp.where(both, most, 1.0)), 0.0)
    return PumpFlow(velocity, wall_velocity, pressure, jet_density, exchange)


def _outlet_exponent(flyer: HollowBody, state: EnvironmentState, corrections: Corrections) -> Array:
    """How far molecules pass the outlet without colliding: ½ to 0 [1]."""
    constant, viscosity, at = _transport(state, state.temperature, corrections)
    speed = xp.sqrt(2.0 * constant * at)
    rarefaction = state.pressure * flyer.outlet_radius / (viscosity * speed)
    return thermomolecular_exponent(ROUND, rarefaction, _NO_LENGTH)


def pump_force(
    flyer: HollowBody,
    state: EnvironmentState,
    unknowns: tuple[Array, ...],
    corrections: Corrections,
    errors: Errors = EXACT,
) -> Array:
    r"""Force on a hollow body [N]; towards the upper end positive."""
    # .. math::
    #     F = \frac{C_1\,8D\mu\,v_w}{1 + 1.264/\delta_D} + C_2\,\rho_j A_o v^2
    #         + \chi\,\frac{pA_o}2\,(1-\varphi)\left[\sqrt{T_i/T_c} - \sqrt{T_o/T_c}\right]
    #
    # with the velocity :math:`v_w` of the gas that comes to the wall, the rarefaction
    # :math:`\delta_D` of half the size, and the share :math:`\chi` of free molecules at the outlet.
    #
    # A body that pumps outward sucks gas in at its outlet from all sides, which leaves no jet.
    #
    # Free molecules enter wall and outlet alike, so that theirs is the momentum of what leaves:
    # from the outer film, through the channels and through the outlet. The three have one vector
    # area, that of the outlet.
    inner, outer = unknowns
    flow = pump_flow(flyer, state, unknowns, corrections, errors)
    _, outlet = _areas(flyer, corrections)
    coefficients = published.FORM_COEFFICIENTS[flyer.form]
    cold = state.temperature
    constant, viscosity, _ = _transport(state, cold, corrections)
    drag = coefficients.drag * 8.0 * flyer.size * viscosity * flow.wall_velocity
    jet = coefficients.jet * flow.jet_density * outlet
    jet = jet * flow.jet_velocity * xp.maximum(flow.jet_velocity, 0.0)
    if not corrections.rarefied_force:
        return errors.force * (drag + jet)
    per_length = state.pressure / (viscosity * xp.sqrt(2.0 * constant * cold))
    drag = drag / (1.0 + _RAREFIED_DRAG / (0.5 * flyer.size * per_length))
    exponent = _outlet_exponent(flyer, state, corrections)
    roots = xp.sqrt(1.0 + inner) + xp.sqrt(1.0 + outer)
    recoil = state.pressure * outlet * flyer.solid_fraction * (inner - outer) / roots
    # half of it times the exponent over its value to free molecules, which is one half
    return errors.force * (drag + jet) + exponent * recoil


FLOW_RESULTS: dict[str, ModelResult] = {
    "jet_velocity": ModelResult("m/s", "velocity of the gas at the outlet"),
    "wall_velocity": ModelResult("m/s", "velocity of the gas that comes to the wall", "mm/s"),
    "pressure_difference": ModelResult("Pa", "pressure within over that outside", "mPa"),
    "outlet_reynolds_number": ModelResult("", "Reynolds number of the outlet's diameter"),
}
"""Results of the models of hollow bodies."""


def pump_results(
    flyer: HollowBody,
    state: EnvironmentState,
    unknowns: tuple[Array, ...],
    corrections: Corrections,
    errors: Errors = EXACT,
) -> dict[str, Array]:
    """Values of :data:`FLOW_RESULTS`."""
    flow = pump_flow(flyer, state, unknowns, corrections, errors)
    hot = state.temperature * (1.0 + unknowns[0])
    _, viscosity, _ = _transport(state, hot, corrections)
    reynolds = 2.0 * flow.jet_density * flow.jet_velocity * flyer.outlet_radius / viscosity
    values = (flow.jet_velocity, flow.wall_velocity, flow.pressure_difference, reynolds)
    return dict(zip(FLOW_RESULTS, values, strict=True))


_THIN_OUTLET = Validity(
    "the mean free path over outlet_radius",
    0.0,
    0.1,
    "drag and jet coefficients were fitted to simulations of dense gas",
)
_LONG = Validity(
    "wall_thickness over channel_width",
    1.0,
    math.inf,
    "celenza2023 takes channels that are longer than wide",
)
_DEEP = Validity(
    "wall_thickness over channel_width",
    0.0,
    1.0,
    "light and heat radiation are taken to pass the channels without meeting their walls",
)


def pump_ranges(flyer: HollowBody, state: EnvironmentState, corrections: Corrections) -> Looks:
    """Of body and surroundings for a model."""
    path = mean_free_path(state.pressure, state.temperature, state.gas)
    length = flyer.wall_thickness / flyer.channel_width
    yield _THIN_OUTLET, path / flyer.outlet_radius
    if not corrections.short_channels:
        yield _LONG, length
    if corrections.energy_balance or corrections.projected_light:
        yield _DEEP, length
