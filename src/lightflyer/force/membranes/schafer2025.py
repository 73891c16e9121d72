"""The sandwich's model of Schafer et al.: a perforated disk in a reservoir, two temperatures."""

from typing import ClassVar, Literal

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.base import AbstractForceModel, ForceSection
from lightflyer.force.laws.faces import free_molecular_conductance
from lightflyer.force.laws.membrane_transmission import MembraneTransmission, Transmission, passage
from lightflyer.force.membranes.sandwich import (
    HIGHEST_OPEN_FRACTION,
    HIGHEST_RAREFACTION,
    HeatRatios,
    between_membranes,
    internal_factors,
    perforated_disk_fit,
    rarefaction_of,
    sandwich_ranges,
    sandwich_remarks,
)
from lightflyer.gas.base import AbstractGas

_DENSE = Validity(
    "the rarefaction parameter",
    0.0,
    HIGHEST_RAREFACTION,
    "the table of schafer2025 ends there, and force and heat loss are extrapolated",
)
_OPEN = Validity("open_fraction", 0.0, HIGHEST_OPEN_FRACTION, "the table of schafer2025 ends there")

# Share by which the force in open space is below that of the table, whose gas ends near the disk,
# at most for open fractions from 0.2 to 0.9; and the largest deviation of the fit from rows of the
# table that it has not seen; both from studies/schafer2025_table.
_RAREFACTIONS = np.array([0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0])
_NEAR_END = np.array([0.01, 0.05, 0.11, 0.17, 0.24, 0.30, 0.37, 0.39, 0.57])
_UNSEEN = np.array([0.0, 0.0, 0.1, 0.3, 0.7, 1.5, 2.6, 3.9, 4.2]) / 100.0
_STANDARD_ERROR = np.hypot(_NEAR_END, _UNSEEN) / NORMAL_HALF_WIDTH_95


def perforated_disk_conductances(
    area: Numeric,
    open_fraction: Numeric,
    rarefaction: Numeric,
    *,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    mean_temperature: Numeric | None = None,
) -> HeatRatios:
    r"""Heat that the gas takes from the faces of a thin disk with holes [W]; [Schafer2025]_."""
    # .. math:: Q_i = G_\mathrm{own}\,\theta_i + G_\mathrm{cross}\,\theta_j
    # the ratio of heat capacities is the same object at any temperature but in few gases
    ratio = gas.heat_capacity_ratio_at(
        temperature if mean_temperature is None else mean_temperature
    )
    return _conductances(area, open_fraction, rarefaction, pressure, temperature, gas, ratio)


def _conductances(
    area: Numeric,
    open_fraction: Numeric,
    rarefaction: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    heat_capacity_ratio: Numeric,
) -> HeatRatios:
    factors = internal_factors(
        heat_capacity_ratio,
        gas.specific_gas_constant,
        gas.viscosity(temperature),
        gas.conductivity(temperature),
    )
    ratios = perforated_disk_fit().heat_ratios(open_fraction, rarefaction, *factors)
    # p √(2RT) A/√π, of which free molecules without internal motion take θ
    scale = 0.5 * pressure * gas.mean_speed(temperature) * area
    return HeatRatios(scale * ratios.own, scale * ratios.cross)


@kept
def _returns(
    flyer: Sandwich,
    state: EnvironmentState,
    passed: MembraneTransmission,
    heat_capacity_ratio: Numeric,
) -> tuple[Array, Array, Array]:
    """Conductance of free molecules [W], and what the gas returns of emitted heat, even and odd."""
    speed = state.gas.mean_speed(state.temperature)
    free = free_molecular_conductance(flyer.area, 1.0, state.pressure, speed, heat_capacity_ratio)

    def returned(open_fraction: Numeric, sign: float) -> Array:
        found = _conductances(
            flyer.area,
            open_fraction,
            rarefaction_of(flyer, state),
            state.pressure,
            state.temperature,
            state.gas,
            heat_capacity_ratio,
        )
        solid = 1.0 - open_fraction
        return (1.0 - (found.own + sign * found.cross) / (free * solid)) / solid

    # what passes is the share of molecules that a plane does not emit itself
    return free, returned(1.0 - passed.even, 1.0), returned(passed.open_fraction, -1.0)


class Schafer2025(AbstractForceModel):
    r"""Force and heat loss of a sandwich as of a perforated disk within a reservoir.

    Outside, the sandwich is taken for one thin disk with holes whose top face has the upper
    membrane's temperature and whose bottom face the lower one's. Between the membranes heat flows
    through gas.

    Notes
    -----
    The table has the cases that [Schafer2025]_ simulated, by our own kinetic solver. They are for
    complete accommodation: the TACs of the two outer faces have no effect.
    Those of the two inner faces enter the conduction in the gap.

    They are for a disk of no thickness whose holes let a molecule through or not, at random: holes
    and gap much narrower than the mean free path, the holes of both membranes above each other.
    :meth:`ranges` says where that does not hold. For a gap much wider than the holes,
    ``transmission="wide"`` takes the disk through which as many molecules pass as through both
    membranes, with the temperatures at which they leave:
    :func:`~lightflyer.force.laws.membrane_transmission.passage`.

    Attributes
    ----------
    transmission : {"aligned", "wide"}
        How holes and gap let molecules pass.
    force_error : array or None
        Deviation of the force from the model, in standard errors [1]: what the near end of the gas
        does to it, by the kinetic equation in open space, and what the fit misses. 0.5 % for free
        molecules, 6 % at a rarefaction of 1, 15 % at 10. A flyer file gives it as 0 ± 1.

    The table ends at rarefactions 0.1 and 100, and at an open fraction of 0.95. In thinner gas the
    fit goes over into the exact limit of free molecules, in denser gas force and heat loss go on
    as the inverse of the rarefaction.

    It was computed in a monatomic gas. The force is taken for that in any gas of the same
    rarefaction; the heat loss is corrected for what the molecules' internal motion carries.

    References
    ----------
    [Schafer2025]_
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Sandwich,)
    feels_walls: ClassVar[bool] = False

    transmission: Transmission = field(static=True, default="aligned")
    force_error: StandardErrors | None = None

    @entry_point
    def heat_loss(
        self, flyer: Sandwich, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        top, bottom = unknowns
        passed = self._passage(flyer)
        mean = state.temperature * (1.0 + 0.25 * (top + bottom))
        free, even, odd = _returns(flyer, state, passed, state.gas.heat_capacity_ratio_at(mean))
        from_top, from_bottom = passed.heat((top, bottom), even, odd)
        upward = between_membranes(flyer, state, passed) * (bottom - top)
        return free * from_top - upward, free * from_bottom + upward

    @entry_point
    def force(self, flyer: Sandwich, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        passed = self._passage(flyer)
        ratio = perforated_disk_fit().force_ratio(
            passed.open_fraction, rarefaction_of(flyer, state)
        )
        if self.force_error is not None:
            dense = xp.log(rarefaction_of(flyer, state))
            own = xp.interp(dense, np.log(_RAREFACTIONS), _STANDARD_ERROR)
            ratio = ratio * (1.0 + self.force_error * own)
        return 0.5 * state.pressure * flyer.area * ratio * sum(passed.recoil(*unknowns))

    def ranges(self, flyer: Sandwich, state: EnvironmentState, temperature: Numeric) -> Looks:
        yield _DENSE, rarefaction_of(flyer, state)
        yield _OPEN, flyer.open_fraction
        yield from sandwich_ranges(flyer, state)

    def remarks(
        self, flyer: Sandwich, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        return tuple(sandwich_remarks(flyer, self.transmission))

    @kept
    def _passage(self, flyer: Sandwich) -> MembraneTransmission:
        inner = (flyer.top.tac_bottom, flyer.bottom.tac_top)
        return passage(self.transmission, flyer.open_fraction, (1.0, 1.0), inner)


class Schafer2025Section(ForceSection, of=Schafer2025):
    """``[force]``: a perforated disk within a reservoir, for a sandwich."""

    model: Literal["schafer2025"]
