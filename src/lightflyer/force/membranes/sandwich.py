"""What force models of a sandwich share: rarefaction, heat through the gap, and where they hold."""

from collections.abc import Iterator

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.laws.gap import gap_conductance
from lightflyer.force.laws.membrane_transmission import MembraneTransmission, Transmission
from lightflyer.gas.base import AbstractGas, mean_free_path

WIDE_GAP = 2.0
"""Gap over hole radius up to which holes count as being above each other: one hole diameter."""

_HOLES = Validity(
    "hole_radius over the mean free path", 0.0, 1.0, "the model takes free molecules in the holes"
)
_GAP = Validity(
    "gap over the mean free path", 0.0, 1.0, "the model takes free molecules in the gap"
)


def rarefaction(
    radius: Numeric, pressure: Numeric, temperature: Numeric, gas: AbstractGas
) -> Array:
    r"""Rarefaction parameter of a disk [1]."""
    # .. math:: \delta = \frac{p\,a}{\mu\sqrt{2RT}} = \frac{\sqrt\pi}{2}\,\frac{a}{\lambda}
    return 0.5 * np.sqrt(np.pi) * radius / mean_free_path(pressure, temperature, gas)


@kept
@kept
def rarefaction_of(flyer: Sandwich, state: EnvironmentState) -> Array:
    """Rarefaction parameter of a sandwich [1]."""
    return rarefaction(flyer.radius, state.pressure, state.temperature, state.gas)


@kept
def between_membranes(
    flyer: Sandwich, state: EnvironmentState, passed: MembraneTransmission
) -> Array:
    """Heat through the gas in the gap per difference of relative excesses [W]."""
    return gap_conductance(
        flyer.area * passed.facing,
        flyer.gap,
        passed.facing_tac,
        pressure=state.pressure,
        temperature=state.temperature,
        mean_speed=state.gas.mean_speed(state.temperature),
        heat_capacity_ratio=state.gas.heat_capacity_ratio_at(state.temperature),
        conductivity=state.gas.conductivity(state.temperature),
    )


def sandwich_ranges(flyer: Sandwich, state: EnvironmentState) -> Looks:
    """Holes and gap as models of a sandwich take them."""
    path = mean_free_path(state.pressure, state.temperature, state.gas)
    yield _HOLES, flyer.hole_radius / path
    yield _GAP, flyer.gap / path


def sandwich_remarks(flyer: Sandwich, transmission: Transmission) -> Iterator[str]:
    """Where a gap is not as wide as a model of its transmission takes it."""
    ratio = np.asarray(flyer.gap) / flyer.hole_radius
    if transmission == "aligned" and np.max(ratio) > WIDE_GAP:
        yield (
            f"the gap is wide beside the holes, {np.max(ratio):.3g} times hole_radius: fewer "
            "molecules pass both membranes than transmission = aligned takes; use "
            "transmission = wide"
        )
    if transmission == "wide" and np.min(ratio) < WIDE_GAP:
        yield (
            f"the gap is {np.min(ratio):.3g} times hole_radius: transmission = wide is for a gap "
            "much wider than the holes"
        )
