"""Heat that the gas takes from a hollow body, as published or with its corrections."""

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.hollow import HollowBody
from lightflyer.force.convection import sphere_conductance
from lightflyer.force.laws.faces import in_series
from lightflyer.force.laws.gap import accommodation_between, gap_conductance
from lightflyer.force.pumps import celenza2023_laws as published
from lightflyer.force.pumps.hollow_flow import (
    EXACT,
    Corrections,
    Errors,
    free_molecular,
    mean_temperature,
    pump_flow,
    radius,
    share_at_wall,
)
from lightflyer.gas.molecules import slot_transmission

_DISK_CONDUCTION = 4.0  # conductance of a disk's one face to a half-space, over κ and its radius
_HELD = 1e9  # conductance that holds the outer film at the gas temperature, over the wall's


def _wall_heat(
    flyer: HollowBody,
    state: EnvironmentState,
    unknowns: tuple[Array, ...],
    corrections: Corrections,
) -> tuple[Array, Array]:
    """Conductances of the gas in the wall: between the films, and in the channels [W]."""
    closed = flyer.solid_fraction - flyer.sheet_fraction
    thickness, temperature = flyer.wall_thickness, state.temperature
    if not corrections.gas_properties:
        conductivity = published.conductivity(thickness, state.pressure, temperature)
        power = flyer.surface * conductivity * temperature
        hollow = thickness - 2.0 * flyer.sheet_thickness
        return power * closed / hollow, power * flyer.open_fraction / thickness
    gas = state.gas
    conductivity = gas.conductivity(mean_temperature(state, unknowns))

    def conductance(share: Numeric, tac: Numeric) -> Array:
        return gap_conductance(
            share * flyer.surface,
            thickness,
            tac,
            pressure=state.pressure,
            temperature=temperature,
            mean_speed=gas.mean_speed(temperature),
            heat_capacity_ratio=gas.heat_capacity_ratio_at(temperature),
            conductivity=conductivity,
        )

    facing = accommodation_between(flyer.outer.tac_bottom, flyer.inner.tac_top)
    # the cells between the channels are as far apart as the channels take less than the wall
    cell = flyer.channel_width * flyer.solid_fraction / flyer.open_fraction
    return (
        conductance(
            closed, accommodation_between(facing, slot_transmission(thickness / cell).through)
        ),
        # molecules come to the mouths of the channels from the gas
        conductance(
            flyer.open_fraction, slot_transmission(thickness / flyer.channel_width).through
        ),
    )


def pump_heat(
    flyer: HollowBody,
    state: EnvironmentState,
    unknowns: tuple[Array, ...],
    corrections: Corrections,
    errors: Errors = EXACT,
) -> tuple[Array, Array]:
    """Heat that the gas takes from the inner and the outer film [W]."""
    # The published model has neither radiation nor a direction of light. What is added here in its
    # stead makes up for the flyer's own: the sum of the losses is that of the published balance,
    # for the light that the flyer absorbs.
    inner, outer = unknowns
    in_cells, in_channels = _wall_heat(flyer, state, unknowns, corrections)
    if not corrections.energy_balance:
        sheets = flyer.sheet_fraction * flyer.sheet_conductivity / flyer.wall_thickness
        conductance = in_cells + in_channels + flyer.surface * sheets * state.temperature
        passed = conductance * (inner - outer) / published.THROUGH_WALL
        if not corrections.projected_light:
            passed = passed / _light_on_wall(flyer, state)
        own, gains = flyer.heat_losses(state, unknowns), flyer.heat_gains(state)
        return passed - own[0] + gains[0], _HELD * conductance * outer - own[1] + gains[1]
    flow = pump_flow(flyer, state, unknowns, corrections, errors)
    share = share_at_wall(flyer, state)
    between = errors.heat * in_cells * (inner - outer)
    through = errors.heat * in_channels * (inner - share * outer)
    gas, temperature = state.gas, state.temperature
    capacity = gas.heat_capacity(temperature) * temperature
    carried = capacity * flow.exchange
    taken_inner = between + through + carried * (inner - outer)
    # Gas takes heat along at the outlet, by flow and by diffusion against it:
    # .. math:: Q = \dot m c_p T_c\,\theta_i\,\left(1 - e^{-x}\right)^{-1},
    #     \qquad x = \dot m c_p T_c/G
    still = errors.heat * in_series(
        free_molecular(state, flyer.outlet_area),
        _DISK_CONDUCTION * flyer.outlet_radius * gas.conductivity(temperature) * temperature,
    )
    mass_flow = flow.jet_density * xp.abs(flow.jet_velocity) * flyer.outlet_area
    ratio = mass_flow * capacity / still
    small = ratio < 1e-6  # below it the first term of the series has all digits that matter
    safe = xp.where(small, 1.0, ratio)
    growth = xp.where(small, 1.0 + 0.5 * ratio, safe / -xp.expm1(-safe))
    taken_inner = taken_inner + still * inner * growth
    around = sphere_conductance(
        outer,
        radius=radius(flyer),
        tac=flyer.outer.tac_top * flyer.solid_fraction,
        pressure=state.pressure,
        temperature=state.temperature,
        gravity=state.gravity,
        gas=state.gas,
        wall_distance=state.wall_distance,
    )
    taken_outer = errors.heat * around * outer - between - share * through
    # what leaves is as warm as the outer film, and what comes in as the inner one
    taken_outer = taken_outer + (carried * (2.0 * outer - inner))
    if not corrections.projected_light:
        gained = flyer.heat_losses(state, unknowns)[0] - flyer.heat_gains(state)[0]
        taken_inner = (taken_inner + gained) / _light_on_wall(flyer, state) - gained
    return taken_inner, taken_outer


def _light_on_wall(flyer: HollowBody, state: EnvironmentState) -> Array:
    """Light that falls on the wall at normal incidence over what the inner film absorbs [1]."""
    absorbed, _ = flyer.beam_areas(state)
    dark = absorbed == 0.0
    return xp.where(dark, 1.0, flyer.surface * flyer.solid_fraction / xp.where(dark, 1.0, absorbed))
