"""The kinetic model of a sandwich: what it makes of its table of a disk with holes."""

import math
from typing import ClassVar

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.fitted import GASES
from lightflyer.force.kinetic.collisions import Collisions, HeatedGas, with_collisions
from lightflyer.force.kinetic.disk import HELD, WALL, viscosity_exponent
from lightflyer.force.kinetic.sandwich_table import (
    HIGHEST_OPEN_FRACTION,
    Ratios,
    SandwichFit,
    force_factors,
    near_walls,
    sandwich_fit,
)
from lightflyer.force.kinetic.walls import AbstractWalled, scattering_ranges
from lightflyer.force.laws.faces import free_molecular_conductance
from lightflyer.force.laws.membrane_transmission import MembraneTransmission, Transmission, passage
from lightflyer.force.membranes.sandwich import (
    between_membranes,
    rarefaction_of,
    sandwich_ranges,
    sandwich_remarks,
)
from lightflyer.gas.base import AbstractGas, knudsen_number

_DENSE = "the table of kinetic ends there, and the force is extrapolated by a power law"
_APART = 0.3  # TACs further apart change the heat by 1 % at Kn 0.1, which the table leaves out
_DIFFERENCE = "the kinetic table is for small differences"
_OPEN = "the table of kinetic ends there, and its fit goes on"
_HELD = "it is held at what it does to the gas's resistance at the table's end"
_RATIOS = ("force", "tac_force", "heat", "heat_difference")
_FORCE, _HEAT = slice(0, 2), slice(2, 4)
_LITTLE = 0.02  # of the order of the model's own error


class KineticSandwich(AbstractWalled):
    """The kinetic model of a sandwich; its options are those of :class:`lightflyer.Kinetic`."""

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Sandwich,)
    molecules: ClassVar[tuple[str, ...]] = GASES

    force_error: StandardErrors | None
    heat_error: StandardErrors | None
    transmission: Transmission = field(static=True)
    collisions: Collisions = field(static=True)

    def require_gas(self, gas: AbstractGas) -> None:
        if gas.molecules not in self.molecules:
            raise ParameterError(
                f"force model Kinetic is not for a sandwich in {gas.name}, whose molecules are "
                f"{gas.molecules}: polyatomic gas is scaled for disks only; schafer2025 "
                "takes any gas"
            )

    def heat_loss(
        self, flyer: Sandwich, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        self.require_gas(state.gas)
        top, bottom = unknowns
        passed = passage_of(flyer, self.transmission)
        fit, (even, odd), _ = self._ratios(flyer, state, unknowns, passed, _HEAT)
        free = free_molecular_conductance(
            flyer.area,
            1.0,
            state.pressure,
            state.gas.mean_speed(state.temperature),
            state.gas.heat_capacity_ratio,
        )
        if self.heat_error is not None:
            free = free * (
                1.0 + self.heat_error * fit.relative_heat_error(rarefaction_of(flyer, state))
            )
        even = (1.0 - even) / passed.even
        odd = (1.0 - odd) / passed.thin_share
        from_top, from_bottom = passed.heat((top, bottom), even, odd)
        upward = between_membranes(flyer, state, passed) * (bottom - top)
        return free * from_top - upward, free * from_bottom + upward

    def force(self, flyer: Sandwich, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        passed = passage_of(flyer, self.transmission)
        fit, found, taken = self._ratios(flyer, state, unknowns, passed, _FORCE)
        by_temperature, by_tac = found
        place = rarefaction_of(flyer, state), passed.open_fraction, passed.tac
        if state.wall_distance is not None:
            distance = xp.maximum(state.wall_distance / flyer.radius, fit.nearest_wall)
            taken = taken * near_walls(place[0], distance)
        of_walls = force_factors(state.gas.molecules, place, unknowns, self.walls, taken)
        if self.force_error is not None:
            by_temperature, by_tac = (
                one * (1.0 + self.force_error * fit.relative_force_error(place[0], one))
                for one in (by_temperature, by_tac)
            )
        apart, unlike = passed.recoil(*unknowns)
        driven = by_temperature * of_walls[0] * apart + by_tac * of_walls[1] * unlike
        return 0.5 * state.pressure * flyer.area * driven

    def _ratios(
        self,
        flyer: Sandwich,
        state: EnvironmentState,
        unknowns: tuple[Array, ...],
        passed: MembraneTransmission,
        which: slice,
    ) -> tuple[SandwichFit, list[Array], Numeric]:
        """Two of the ratios to free molecules, in open space or a chamber."""
        # and by which factor heat and collisions take more from the force than in the table
        fit, delta = sandwich_fit(state.gas.molecules), rarefaction_of(flyer, state)
        mean = 1.0 + 0.5 * (unknowns[0] + unknowns[1])
        exponent = viscosity_exponent(state.gas, state.temperature, mean)
        at = Ratios(fit, delta, passed.open_fraction, passed.tac, passed.even, mean, exponent)
        found = [getattr(at, name) for name in _RATIOS[which]]
        taken: Numeric = at.force_growth if which is _FORCE else 1.0
        if self.collisions == "vhs":
            gas, cold = state.gas, state.temperature
            knudsen = _knudsen_number(flyer, state)
            # that holes change nothing in these is part of the sandwich's wider error
            molecules = HeatedGas(gas, gas.molecules, cold, mean, exponent)
            of = molecules.force_factor if which is _FORCE else molecules.heat_factor
            factor = of(knudsen, passed.tac)
            taken = taken * factor
            found = [with_collisions(one, factor) for one in found]
        if state.wall_distance is not None:
            distance = state.wall_distance / flyer.radius
            walls = fit.wall_factors(delta, passed.open_fraction, distance)[which]
            found = [one * wall for one, wall in zip(found, walls, strict=True)]
        return fit, found, taken

    def ranges(self, flyer: Sandwich, state: EnvironmentState, temperature: Numeric) -> Looks:
        fit, delta = sandwich_fit(state.gas.molecules), rarefaction_of(flyer, state)
        passed = passage_of(flyer, self.transmission)
        hottest = 1.0 / (1.0 - fit.heating_limit)
        looks = [
            (Validity("the rarefaction parameter", 0.0, fit.rarefaction_range[1], _DENSE), delta),
            (Validity("T_h/T_c", 1.0, hottest, HELD), temperature / state.temperature),
            (Validity("the mean TAC", *fit.tac_range, HELD), passed.tac),
            (Validity("the difference of the outer TACs", -_APART, _APART, _DIFFERENCE),
             flyer.bottom.tac_bottom - flyer.top.tac_top),
            (Validity("open_fraction", 0.0, HIGHEST_OPEN_FRACTION, _OPEN), flyer.open_fraction),
            (Validity("what heat does to force or heat loss outside its table, rarefactions "
                      "{:g} to {:g},".format(*fit.hot_range), 0.0, _LITTLE, _HELD),
             _effect_of_heating(flyer, state, xp.asarray(temperature), passed)),
        ]  # fmt: skip
        if state.wall_distance is not None:
            near = Validity("the walls' distance over the radius", fit.nearest_wall, math.inf, WALL)
            looks.append((near, state.wall_distance / flyer.radius))
            looks.append((Validity("the rarefaction parameter", *fit.wall_range, WALL), delta))
        if self.walls.is_stated:
            stated = self.walls.stated(state.gas.molecules)
            looks += scattering_ranges(stated, (flyer.top.tac_top, flyer.bottom.tac_bottom))
        return (*looks, *sandwich_ranges(flyer, state))

    def remarks(
        self, flyer: Sandwich, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        solid = state.floor_distance is not None or state.lid_distance is not None
        return (
            *sandwich_remarks(flyer, self.transmission),
            *(("floor and lid have no effect: their table is for a disk",) if solid else ()),
        )


@entry_point
def _effect_of_heating(
    flyer: Sandwich, state: EnvironmentState, temperature: Numeric, passed: MembraneTransmission
) -> Array:
    """Relative change of force or heat by heating at most, where its table does not reach [1]."""
    fit, delta = sandwich_fit(state.gas.molecules), rarefaction_of(flyer, state)
    hot, cold = (
        Ratios(fit, delta, passed.open_fraction, passed.tac, passed.even, ratio)
        for ratio in (temperature / state.temperature, 1.0)
    )
    changes = [
        xp.abs(one / other - 1.0) for one, other in ((hot.force, cold.force), (hot.heat, cold.heat))
    ]
    low, high = fit.hot_range
    return xp.where((delta < low) | (delta > high), xp.maximum(*changes), 0.0)


@kept
def _knudsen_number(flyer: Sandwich, state: EnvironmentState) -> Array:
    return knudsen_number(state.pressure, state.temperature, flyer.radius, state.gas)


@kept
def passage_of(flyer: Sandwich, transmission: Transmission) -> MembraneTransmission:
    """Passage of molecules through a sandwich with the TACs of its four faces."""
    return passage(
        transmission,
        flyer.open_fraction,
        (flyer.top.tac_top, flyer.bottom.tac_bottom),
        (flyer.top.tac_bottom, flyer.bottom.tac_top),
    )
