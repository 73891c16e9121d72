"""The kinetic model of a thin disk: what it makes of its table."""

import math
from typing import Any

import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.disk import Disk
from lightflyer.force.free_molecular import disk_conductance
from lightflyer.force.kinetic_table import KineticFit, kinetic_fit
from lightflyer.force.laws import maxwell_force
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.validity import Validity
from lightflyer.gas.base import knudsen_number

_DENSE = "the kinetic table ends there, and the force is extrapolated by a power law"
HEATING = "the kinetic table ends there, and its ratios are held"
TAC = "the kinetic table ends there, and its ratios are held"
WALL = "the table of walls ends there, and their effect is held"
APART = 0.3  # TACs further apart change the heat by 1 % at Kn 0.1, which the table leaves out
DIFFERENCE = "the kinetic table is for small differences"


def heat_loss(
    disk: Disk, state: EnvironmentState, unknowns: tuple[Array, ...], error: Numeric | None
) -> tuple[Array, ...]:
    """See :meth:`AbstractForceModel.heat_loss`; ``error`` in standard errors."""
    (excess,) = unknowns
    fit, knudsen = _fit_and_knudsen_number(disk, state)
    ratio = fit.heat_ratio(knudsen, 1.0 + excess, disk.film.tac_mean)
    if state.wall_distance is not None:
        ratio *= fit.wall_factors(knudsen, state.wall_distance / disk.radius)[1]
    if error is not None:
        ratio *= 1.0 + error * fit.relative_heat_error(knudsen)
    return (ratio * disk_conductance(disk, state, excess) * excess,)


def force(
    disk: Disk, state: EnvironmentState, unknowns: tuple[Array, ...], error: Numeric | None
) -> Array:
    """See :meth:`AbstractForceModel.force`; ``error`` in standard errors."""
    (excess,) = unknowns
    fit, knudsen = _fit_and_knudsen_number(disk, state)
    ratio = fit.force_ratio(knudsen, 1.0 + excess, disk.film.tac_mean)
    if state.wall_distance is not None:
        ratio *= fit.wall_factors(knudsen, state.wall_distance / disk.radius)[0]
    if error is not None:
        ratio *= 1.0 + error * fit.relative_force_error(knudsen, ratio)
    free = maxwell_force(disk.area, disk.film.tac_difference, state.pressure, excess)
    return ratio * free


def caveats(disk: Disk, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
    """See :meth:`AbstractForceModel.caveats`."""
    fit, knudsen = _fit_and_knudsen_number(disk, state)
    hottest = 1.0 / (1.0 - fit.heating_limit)
    film, pressure = disk.film, state.pressure
    looks = [
        (Validity("the Knudsen number", fit.knudsen_range[0], math.inf, _DENSE), knudsen),
        (Validity("T_h/T_c", 1.0, hottest, HEATING), temperature / state.temperature),
        (Validity("the mean TAC", *fit.tac_range, TAC), film.tac_mean),
        (Validity("the difference of the TACs", -APART, APART, DIFFERENCE),
         film.tac_difference),
    ]  # fmt: skip
    if state.wall_distance is not None:
        near = Validity("the walls' distance over the radius", fit.nearest_wall, math.inf, WALL)
        looks.append((near, state.wall_distance / disk.radius))
    return tuple(text for range_, value in looks for text in range_.caveats(value, pressure))


def _fit_and_knudsen_number(disk: Disk, state: EnvironmentState) -> tuple[KineticFit, Any]:
    knudsen = knudsen_number(state.pressure, state.temperature, disk.radius, state.gas)
    return kinetic_fit(state.gas.molecules), jnp.asarray(knudsen)
