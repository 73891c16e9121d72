"""The kinetic model of a thin disk: what it makes of its table."""

import math
from typing import Any, ClassVar, Literal

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.fitted import GASES
from lightflyer.force.free_molecular import disk_conductance
from lightflyer.force.kinetic import walls as kinetic_walls
from lightflyer.force.kinetic.chamber import (
    OF_DIATOMIC,
    PUSH_ERROR,
    ChamberEffect,
    chamber_fit,
    chamber_of,
    push_of_floor,
    reservoir,
)
from lightflyer.force.kinetic.collisions import (
    FORCE_HEATED,
    MODEL_CONDUCTION,
    Collisions,
    HeatedGas,
    force_error,
    heat_error,
    with_collisions,
)
from lightflyer.force.kinetic.ratios import (
    FILM_OF_DIATOMIC,
    FilmBalance,
    KineticFit,
    heating_of,
    kinetic_fit,
    local_balance_fit,
    tacs_of,
)
from lightflyer.force.kinetic.walls import AbstractWalled
from lightflyer.force.membranes.sandwich import internal_factors
from lightflyer.gas.base import AbstractGas, knudsen_number
from lightflyer.numerics.special import root_sum_square

Polyatomic = Literal["refused", "scaled"]
"""What becomes of a gas of neither kind that the tables are for."""

_DENSE = (
    "the kinetic table ends there; heat loss goes on to conduction, the force as the square of the "
    "Knudsen number"
)
_HOT_DENSE = (
    "the kinetic table of large temperature differences ends there, and what they do is held"
)
_WARM = 2.0  # T/T_c at which the gas's viscosity is looked at, besides 1
_SMALL = 0.1  # relative temperature difference below which the linear table is good to its error
HELD = "the kinetic table ends there, and its ratios are held"
WALL = "the table of walls ends there, and their effect is held"
_SCALED = (
    "is taken for a diatomic gas with its heat capacity and conduction: the kinetic heat loss is "
    "right to about 3 %, the force to 2 % near the gas temperature and 9 % far above"
)
_STAND_IN = "diatomic"
_SCALED_HEAT_ERROR, _SCALED_FORCE_ERROR = 0.015, 0.045
"""Relative standard errors: half of what is left from one table to the other at worst."""
_DIATOMIC_FREE, _DIATOMIC_DENSE = internal_factors(1.4, 1.0, 1.0, MODEL_CONDUCTION)
_DIATOMIC_RESISTANCE = _DIATOMIC_FREE / _DIATOMIC_DENSE


class KineticDisk(AbstractWalled):
    """The kinetic model of a disk; its options are those of :class:`lightflyer.Kinetic`."""

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Disk,)
    molecules: ClassVar[tuple[str, ...]] = GASES
    feels_floor: ClassVar[bool] = True

    force_error: StandardErrors | None
    heat_error: StandardErrors | None
    polyatomic: Polyatomic = field(static=True)
    collisions: Collisions = field(static=True)
    film_balance: FilmBalance = field(static=True)

    def require_gas(self, gas: AbstractGas) -> None:
        if self.polyatomic == "refused" and gas.molecules not in self.molecules:
            raise ParameterError(
                f"force model Kinetic is not for {gas.name}, whose molecules are {gas.molecules}; "
                'polyatomic = "scaled" takes it for a diatomic gas around a disk'
            )

    def pushes_unheated(self, flyer: Disk, state: EnvironmentState) -> bool:
        """A disk over a warm floor is pushed."""
        return state.floor_excess is not None

    def heat_loss(
        self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        (excess,) = unknowns
        fit, knudsen = _fit_and_knudsen_number(flyer, state)
        place = _place(flyer, state, excess)
        around = _around(fit, knudsen, flyer, state, excess)
        ratio = self._heat_ratio(fit, knudsen, place, state, around)
        if state.gas.molecules not in GASES:
            ratio = scaled_heat_ratio(ratio, _resistance(state, excess))
        resisting = (_kind(state.gas), knudsen, ratio)
        ratio = kinetic_walls.heat_ratio(flyer, excess, resisting, self.walls)
        if self.film_balance == "local":
            _, share = local_balance_fit().kept_shares(flyer, state, excess, knudsen, ratio)
            ratio = ratio * share
        if self.heat_error is not None:
            own = heat_error(fit.table_errors(knudsen)[1], ratio, self.collisions)
            if around.heat_error:
                own = root_sum_square(own, around.heat_error)
            ratio = ratio * (
                1.0 + self.heat_error * _with_scaling(own, _SCALED_HEAT_ERROR, state.gas)
            )
        return (ratio * disk_conductance(flyer, state, excess) * excess,)

    def _heat_ratio(
        self,
        fit: KineticFit,
        knudsen: Numeric,
        place: tuple[Any, ...],
        state: EnvironmentState,
        around: ChamberEffect,
    ) -> Numeric:
        """Heat loss over that of free molecules, at Maxwell walls in a gas of the table [1]."""
        ratio = around.heat_ratio(fit.heat_ratio(knudsen, *place))
        if self.collisions == "shakhov":
            return ratio
        return with_collisions(ratio, _heated_gas(state, place).heat_factor(knudsen, place[1]))

    def force(self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        (excess,) = unknowns
        fit, knudsen = _fit_and_knudsen_number(flyer, state)
        place = _place(flyer, state, excess)
        around = _around(fit, knudsen, flyer, state, excess)
        ratio = around.force_ratio(fit.force_ratio(knudsen, *place))
        if self.collisions == "vhs":
            factor = _heated_gas(state, place).force_factor(knudsen, place[1])
            ratio = with_collisions(ratio, factor)
        scaled, local = state.gas.molecules not in GASES, self.film_balance == "local"
        if scaled or local:
            heat = self._heat_ratio(fit, knudsen, place, state, around)
        if scaled:
            ratio = ratio * (scaled_heat_ratio(heat, _resistance(state, excess)) / heat)
        resisting = (_kind(state.gas), knudsen, ratio)
        found = kinetic_walls.force(flyer, state, excess, resisting, self.walls)
        if local:
            share, _ = local_balance_fit().kept_shares(flyer, state, excess, knudsen, heat)
            found = found * share
        push = around.push(flyer, state, excess)
        if self.force_error is not None:
            heated = FORCE_HEATED.logarithm(_kind(state.gas), place[0], place[-1])
            own = force_error(fit.table_errors(knudsen)[0], ratio, self.collisions, heated)
            if around.force_error:
                own = root_sum_square(own, around.force_error)
            found = found * (
                1.0 + self.force_error * _with_scaling(own, _SCALED_FORCE_ERROR, state.gas)
            )
            push = push * (1.0 + self.force_error * PUSH_ERROR)
        if state.floor_excess is not None:
            push = push + push_of_floor(flyer, state, knudsen, self.force_error)
        if flyer.attitude is not None:  # floor and lid do not turn with the disk
            push = push * xp.cos(flyer.attitude.tilt)
        return found + push

    def ranges(self, flyer: Disk, state: EnvironmentState, temperature: Numeric) -> Looks:
        fit, knudsen = _fit_and_knudsen_number(flyer, state)
        ratio = temperature / state.temperature
        lowest, lowest_hot = fit.knudsen_range[0], fit.hot_knudsen_range[0]
        hot = _where_heating_matters(ratio, knudsen, lowest_hot)
        yield Validity("the Knudsen number", lowest, math.inf, _DENSE), knudsen
        yield Validity("the Knudsen number", lowest_hot, math.inf, _HOT_DENSE), hot
        yield Validity("T_h/T_c", *fit.ratio_range, HELD), ratio
        yield Validity("the mean TAC", *fit.tac_range, HELD), flyer.film.tac_mean
        chamber = chamber_of(state, flyer.radius)
        if chamber is not None:
            yield from chamber_fit().ranges(chamber, knudsen)
        elif state.wall_distance is not None:
            near = Validity("the walls' distance over the radius", fit.nearest_wall, math.inf, WALL)
            yield near, state.wall_distance / flyer.radius
        if self.film_balance == "local":
            yield from local_balance_fit().ranges(knudsen)
        yield from kinetic_walls.ranges(flyer, self.walls, _kind(state.gas), knudsen, lowest)

    def remarks(
        self, flyer: Disk, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        gas, walled = state.gas, chamber_of(state, flyer.radius) is not None
        atoms = gas.molecules == "monatomic"
        said = {
            OF_DIATOMIC: atoms and walled,
            FILM_OF_DIATOMIC: atoms and self.film_balance == "local",
            f"{gas.name} {_SCALED}": gas.molecules not in GASES,
        }
        return tuple(text for text, applies in said.items() if applies)


@entry_point
def _where_heating_matters(ratio: Numeric, knudsen: Numeric, otherwise: float) -> Array:
    return xp.where(xp.abs(ratio - 1.0) > _SMALL, knudsen, otherwise)


def scaled_heat_ratio(ratio: Numeric, resistance: Numeric) -> Array:
    r"""Heat loss over the free-molecular one in a gas that conducts otherwise than the table's."""
    # .. math:: \frac1{\hat Q'} = 1 + s\left(\frac1{\hat Q} - 1\right)
    #
    # Exact for free molecules and for conduction. From the monatomic to the diatomic table, where s
    # is 1.155, it is right to 1 % for small differences and to 3 % up to :math:`T_h/T_c = 2.4`. A
    # force that keeps its ratio to the heat is right to 2 % and 9 %. In carbon dioxide s is 1.10
    # times that of the diatomic table.
    return xp.asarray(1.0 / (1.0 + resistance * (1.0 / ratio - 1.0)))


def _place(disk: Disk, state: EnvironmentState, excess: Numeric) -> tuple[Any, ...]:
    """Temperature ratio, TACs and viscosity exponent, the arguments of the fit."""
    ratio = 1.0 + excess
    exponent = viscosity_exponent(state.gas, state.temperature, ratio)
    return ratio, *tacs_of(disk.film), exponent


def _heated_gas(state: EnvironmentState, place: tuple[Any, ...]) -> HeatedGas:
    ratio, _, _, exponent = place
    return HeatedGas(state.gas, _kind(state.gas), state.temperature, ratio, exponent)


def viscosity_exponent(gas: AbstractGas, temperature: Numeric, ratio: Numeric) -> Array:
    """Exponent of the viscosity between two temperatures [1]; ``temperature``: of the gas."""
    # On the line in the temperature's logarithm through two that do not depend on the ratio, so
    # that a heat balance does not look up the viscosity again and again. From 150 K to 500 K and
    # ratios of 0.7 to 2.4 it is within 0.03 of the slope between both temperatures for carbon
    # dioxide, 0.007 for other gases.
    cold, warm = _viscosity_exponents(gas, temperature)
    share = 0.5 * heating_of(ratio) / math.log(_WARM)
    return xp.asarray(cold + share * (warm - cold))


@kept
def _viscosity_exponents(gas: AbstractGas, temperature: Numeric) -> tuple[Array, Array]:
    cold, warm = (gas.viscosity_exponent(factor * temperature) for factor in (1.0, _WARM))
    return cold, warm


def _around(
    fit: KineticFit, knudsen: Any, disk: Disk, state: EnvironmentState, excess: Numeric
) -> ChamberEffect:
    """What a chamber does to force and heat."""
    chamber = chamber_of(state, disk.radius)
    if chamber is None and state.wall_distance is None:
        return ChamberEffect()
    faces = tacs_of(disk.film)
    opened = fit.force_ratio(knudsen, 1.0, *faces), fit.heat_ratio(knudsen, 1.0, *faces)
    if chamber is not None:
        return chamber_fit().walls(knudsen, chamber, opened, faces[0], 1.0 + excess)
    factors = fit.wall_factors(knudsen, state.wall_distance / disk.radius, *faces)
    return reservoir(factors, opened, knudsen, 1.0 + excess)


def _with_scaling(error: Array, of_scaling: float, gas: AbstractGas) -> Array:
    """Relative standard error, with that of taking the gas for a diatomic one [1]."""
    return error if gas.molecules in GASES else root_sum_square(error, of_scaling)


def _resistance(state: EnvironmentState, excess: Numeric) -> Numeric:
    """What a gas's collisions resist over what those of the table's diatomic gas do [1]."""
    gas = state.gas
    mean = state.temperature * (1.0 + 0.5 * excess)
    free, dense = internal_factors(
        gas.heat_capacity_ratio_at(mean),
        gas.specific_gas_constant,
        gas.viscosity(mean),
        gas.conductivity(mean),
    )
    return free / dense / _DIATOMIC_RESISTANCE


@kept
def _fit_and_knudsen_number(disk: Disk, state: EnvironmentState) -> tuple[KineticFit, Any]:
    knudsen = knudsen_number(state.pressure, state.temperature, disk.radius, state.gas)
    return kinetic_fit(_kind(state.gas)), knudsen


def _kind(gas: AbstractGas) -> str:
    """Gas of the table that stands for a gas."""
    return gas.molecules if gas.molecules in GASES else _STAND_IN
