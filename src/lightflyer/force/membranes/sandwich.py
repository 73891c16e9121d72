r"""A perforated disk in a reservoir, whose force and heat loss the models of sandwiches share.

The table has, over open fraction :math:`\beta` and rarefaction
:math:`\delta = pa/(\mu\sqrt{2RT})`, the force on a disk with one hot face and the heat that both
faces lose. With :math:`s = 1-\beta`, :math:`v = \sqrt{2RT}` and the hot face's relative
temperature excess :math:`\theta`

.. math::
    F = \frac{pA}{2}\,s\,\hat F\left[\sqrt{1+\theta}-1\right], \qquad
    Q_\mathrm{own} = p v A\,\frac{s}{\sqrt\pi}\,\frac{f_c+f_d}{2}\,\theta, \qquad
    Q_\mathrm{cross} = p v A\,\frac{s}{\sqrt\pi}\,\frac{f_c-f_d}{2}\,\theta

All three ratios are one for free molecules. What is fitted is how the gas resists:

.. math::
    \frac1{\hat F} = 1 + \frac{s\,\delta}{a + b\,\beta/(1+\beta)}, \qquad
    f_i = 1 - s\,h_i, \qquad
    \frac1{h_c} = s + \frac{g_c}{\delta}, \qquad
    \frac1{h_d} = \frac{1 + g_d/\delta}{1 + r_1\beta + r_2\beta^2}

:math:`a` stands for the disk's edge, :math:`b` for the flow through its holes, :math:`h` for how
much of a face's heat the gas brings back to it: :math:`f_c` if both faces are equally hot,
:math:`f_d` if one is as cold as the other is hot. :math:`g_c` is a quadratic in
:math:`\beta`; all coefficients are splines in :math:`\ln\delta`.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.fitted import fitted
from lightflyer.force.laws.gap import gap_conductance
from lightflyer.force.laws.membrane_transmission import MembraneTransmission, Transmission
from lightflyer.gas.base import AbstractGas, mean_free_path
from lightflyer.numerics.interpolation import Curves

TEMPERATURE_EXCESS = 1.0 / 3.0
"""Relative temperature excess of the hot face in the table: 400 K in gas at 300 K."""

FREE_FORCE = 0.5 * ((1.0 + TEMPERATURE_EXCESS) ** 0.5 - 1.0) / TEMPERATURE_EXCESS
"""Force of free molecules on a face without holes, over :math:`p A \\theta`, at that excess [1]."""

HIGHEST_RAREFACTION = 100.0  # Where the table ends [1]
HIGHEST_OPEN_FRACTION = 0.95  # Where the table ends [1]

_MONATOMIC_EUCKEN = 15.0 / 4.0  # κ/(μR) of a gas without internal motion, [VincentiKruger1965]


class HeatRatios(NamedTuple):
    """Heat loss over that of a face without holes to free molecules without internal motion."""

    own: Array  # Of a face by its own excess, and by that of the other face [1]
    cross: Array


@dataclass(frozen=True)
class PerforatedDiskFit:
    r"""Force and heat ratios as smooth functions, fitted to a table."""

    force: Curves  # Of :math:`\ln a` and :math:`b`
    # Of the three coefficients of :math:`g_c`, then :math:`g_d`, :math:`r_1` and :math:`r_2`
    heat: Curves

    @kept
    def force_ratio(self, open_fraction: Numeric, rarefaction: Numeric) -> Array:
        r"""Force over that of free molecules, :math:`\hat F` [1]."""
        log_edge, flow = self.force(_logarithm(rarefaction))
        yielding = xp.exp(log_edge) + flow * open_fraction / (1.0 + open_fraction)
        return yielding / (yielding + (1.0 - open_fraction) * rarefaction)

    def heat_ratios(
        self,
        open_fraction: Numeric,
        rarefaction: Numeric,
        free_factor: Numeric = 1.0,
        dense_factor: Numeric = 1.0,
    ) -> HeatRatios:
        r"""Heat loss of a face over :math:`p v A\theta/\sqrt\pi`."""
        zero, one, two, difference, r1, r2 = self.heat(_logarithm(rarefaction))
        solid = 1.0 - open_fraction
        # resistances in series: that of the face changes by one factor, that of the gas by the
        # other; through the holes molecules fly freely
        relative = dense_factor / free_factor
        common = (zero + open_fraction * (one + open_fraction * two)) / rarefaction
        common_return = 1.0 / (solid + relative * common)
        shape = 1.0 + open_fraction * (r1 + open_fraction * r2)
        conduction = difference / rarefaction
        difference_return = shape / (1.0 + conduction + (relative - 1.0) * conduction * shape)
        scale = free_factor * solid
        mean = 0.5 * (common_return + difference_return)
        return HeatRatios(
            own=scale * (1.0 - solid * mean),
            cross=-0.5 * scale * solid * (common_return - difference_return),
        )


@kept
def _logarithm(rarefaction: Numeric) -> Array:
    return xp.log(rarefaction)


def internal_factors(
    heat_capacity_ratio: Numeric,
    specific_gas_constant: Numeric,
    viscosity: Numeric,
    conductivity: Numeric,
) -> tuple[Array, Array]:
    r"""What internal motion of the molecules does to the heat that a gas takes [1]."""
    # .. math::
    #     \Gamma_\mathrm{free} = \frac14\,\frac{\gamma+1}{\gamma-1}, \qquad
    #     \Gamma_\mathrm{dense} = \frac4{15}\,\frac\kappa{\mu R}
    free = 0.25 * (heat_capacity_ratio + 1.0) / (heat_capacity_ratio - 1.0)
    return free, conductivity / (_MONATOMIC_EUCKEN * viscosity * specific_gas_constant)


@lru_cache
def perforated_disk_fit() -> PerforatedDiskFit:
    """Smooth functions through the table."""
    return fitted(PerforatedDiskFit, "perforated disk", "monatomic")


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
