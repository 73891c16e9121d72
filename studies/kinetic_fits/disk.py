"""Fits of the force and heat loss of a disk, to the tables of studies/kinetic_table."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from kinetic_fits.common import (
    ERROR_POWERS,
    ends_of,
    least_squares,
    place_in,
)

from lightflyer.force.kinetic.ratios import (
    BOUNDARY_TAC,
    TAC_OFFSET,
    KineticFit,
    Resistance,
    Unlikeness,
    denseness,
    width,
)
from lightflyer.kinetic_theory.model_gases import GasModel, gas_model
from lightflyer.numerics.polynomials import as_tuples, polynomial, trim_zeros

SMALL = 0.1  # Differences of TACs up to this stand for the limit of small ones

# powers of heating, viscosity exponent, TAC, and Knudsen number in the linear and the non-linear
# problem: many for the limit of small differences, few for what changes with them
_LIMIT_POWERS = [(0, 0, tac, knudsen, 0) for tac in range(4) for knudsen in range(11)]
_HEATING = {  # powers of heating and TAC: number of powers of the Knudsen number
    (1, 0): 7, (1, 1): 6, (1, 2): 5, (1, 3): 3,
    (2, 0): 5, (2, 1): 4, (2, 2): 3,
    (3, 0): 3, (3, 1): 2,
}  # fmt: skip
_HEATING_POWERS = [
    (heating, 0, tac, 0, knudsen)
    for (heating, tac), count in _HEATING.items()
    for knudsen in range(count)
]
_EXPONENT_POWERS = [
    (heating, 1, 0, 0, knudsen) for heating, count in ((1, 4), (2, 2)) for knudsen in range(count)
]
_POWERS = _LIMIT_POWERS + _HEATING_POWERS + _EXPONENT_POWERS
_UNLIKE_POWERS = [(place, tac) for tac in range(3) for place in range(6 if tac < 2 else 3)]
_HOT_UNLIKE_POWERS = ([(0, 0), (1, 0), (2, 0), (0, 1)], [(0, 0), (1, 0)])
_WALL_POWERS = [(nearness, knudsen) for nearness in range(4) for knudsen in range(6)]
_LEAST_WEIGHT = 2e-3  # of rows in thin gas, where the resistance hardly matters
_ITERATIONS = 100  # of a contraction by a half at least


def fit(gas: str, table: SimpleNamespace, walls: SimpleNamespace) -> KineticFit:
    """Smooth functions through the tables of a disk, and of a reservoir around it."""
    model, ends = gas_model(gas), ends_of(table.knudsen)
    hot_ends = ends_of(table.knudsen[table.temperature_ratio != 1.0])
    where = place_in(ends, table.knudsen)
    unlikeness = _fit_unlikeness(table, where, ends)
    force, heat = _like_faces_ratios(table, unlikeness, where)
    variables = (
        np.log(table.temperature_ratio),
        table.viscosity_exponent - model.viscosity_exponent,
        np.log(table.tac + TAC_OFFSET),
        where,
        place_in(hot_ends, table.knudsen),
    )

    of_force = _fit_resistance(table, force, 1.0, variables)
    of_heat = _fit_resistance(table, heat, table.tac, variables)
    resistances = (
        _resistance_at(of_force, variables) / table.knudsen,
        _resistance_at(of_heat, variables) * table.tac / table.knudsen,
    )
    unlikeness = _fit_hot_unlikeness(table, unlikeness, where, resistances)
    return KineticFit(
        knudsen_range=ends,
        hot_knudsen_range=hot_ends,
        ratio_range=ends_of(table.temperature_ratio),
        tac_range=ends_of(table.tac),
        viscosity_exponent=model.viscosity_exponent,
        conduction=_conduction(model),
        force=of_force,
        heat=of_heat,
        unlikeness=unlikeness,
        force_error=_fit_error(table, table.force_ratio_error / table.force_ratio, ends),
        heat_error=_fit_error(table, table.heat_ratio_error / table.heat_ratio, ends),
        **_fit_walls(walls, of_heat, ends),
    )


def _fit_resistance(
    table: SimpleNamespace,
    ratio: np.ndarray,
    scale: np.ndarray | float,
    variables: tuple[np.ndarray, ...],
) -> Resistance:
    """From the ratios of like faces."""
    like = table.tac_difference <= SMALL
    values = np.log((1.0 / ratio - 1.0) * table.knudsen / scale)
    errors = 1.0 / (1.0 - ratio + _LEAST_WEIGHT)
    shown = tuple(column[like] for column in variables)
    found = np.asarray(least_squares(values[like], shown, _POWERS, errors[like]))
    parts = found[0, 0, :, :, 0], found[1:, 0, :, 0, :], found[1:, 1, 0, 0, :]
    return Resistance(*(trim_zeros(as_tuples(part)) for part in parts))


def _resistance_at(fitted: Resistance, variables: tuple[np.ndarray, ...]) -> np.ndarray:
    """Times the Knudsen number, over its scale."""
    heating, exponent, tac, where, hot = variables
    heated = polynomial(fitted.heating, heating, tac, hot)
    heated = heated + exponent * polynomial(fitted.exponent, heating, hot)
    return np.asarray(np.exp(polynomial(fitted.limit, tac, where) + heating * heated))


def _conduction(gas: GasModel) -> float:
    r"""Logarithm of the resistance to heat by conduction, times the Knudsen number over the TAC."""
    # That of :math:`8r\kappa\,\Delta T`, the heat of an isothermal disk, is
    # :math:`\pi(4+j)/(32\,\kappa/\mu R)` with j degrees of freedom of rotation.
    conductivity = 2.5 / gas.translational_rate
    modes = 4.0
    if gas.has_rotation:
        conductivity = conductivity + (1.0 / gas.rotational_rate)
        modes = modes + 2.0
    return float(np.log(np.pi * modes / (32.0 * conductivity)))


def _fit_unlikeness(
    table: SimpleNamespace, where: np.ndarray, ends: tuple[float, float]
) -> Unlikeness:
    """From pairs of linear rows that differ in the difference of the faces' TACs alone."""
    linear = table.temperature_ratio == 1.0
    like = {
        (table.knudsen[row], table.tac[row]): row
        for row in np.flatnonzero(linear & (table.tac_difference <= SMALL))
    }
    pairs = [
        (row, like[place])
        for row in np.flatnonzero(linear & (table.tac_difference > SMALL))
        if (place := (table.knudsen[row], table.tac[row])) in like
    ]
    one, other = np.transpose(pairs)
    wide, narrow = (width(table.tac_difference[rows], table.tac[rows]) for rows in (one, other))
    change = 1.0 / table.heat_ratio[one] - 1.0 / table.heat_ratio[other]
    share = change / (wide - narrow)
    for _ in range(_ITERATIONS):
        share = change / (wide / (1.0 - share * wide) - narrow / (1.0 - share * narrow))
    resisted, before = (1.0 / table.force_ratio[rows] - 1.0 for rows in (one, other))
    kept = resisted / before
    of_force = (1.0 - kept) / (share * (wide - kept * narrow))
    tac, knudsen, place = table.tac[one], table.knudsen[one], where[one]

    def fitted(values: np.ndarray, effect: np.ndarray) -> Any:
        errors = 1.0 / (effect + _LEAST_WEIGHT)
        return least_squares(
            np.log(values), (place, np.log(tac + TAC_OFFSET)), _UNLIKE_POWERS, errors
        )

    resistance = share / (1.0 - share) * knudsen / tac
    return Unlikeness(
        fitted(resistance, share * wide),
        fitted(of_force, of_force * share * wide * (1.0 - table.force_ratio[one])),
        ((0.0,),),
        ((0.0,),),
        ends,
    )


def _fit_hot_unlikeness(
    table: SimpleNamespace,
    linear: Unlikeness,
    where: np.ndarray,
    resistances: tuple[np.ndarray, np.ndarray],
) -> Unlikeness:
    """With what heating adds, from hot rows of unlike faces beside the fit of like ones."""
    rows = (table.temperature_ratio != 1.0) & (table.tac_difference > SMALL)
    if not np.any(rows):
        return linear
    force, heat = (resistance[rows] for resistance in resistances)
    knudsen, tac, heating = (
        table.knudsen[rows],
        table.tac[rows],
        np.log(table.temperature_ratio)[rows],
    )
    variable, wide = np.log(tac + TAC_OFFSET), width(table.tac_difference[rows], tac)
    added = 1.0 / table.heat_ratio[rows] - 1.0 - heat
    share = added / (1.0 + added)  # gw
    of_force = (1.0 - (1.0 / table.force_ratio[rows] - 1.0) / force) / share
    logarithms = (
        np.log(share / (wide - share) * knudsen / tac)
        - polynomial(linear.resistance, where[rows], variable),
        np.log(of_force) - polynomial(linear.force, where[rows], variable),
    )
    ends = ends_of(knudsen)
    place = place_in(ends, knudsen)
    effects = share, of_force * share * (1.0 - table.force_ratio[rows])
    of_resistance, of_k = (
        least_squares(values / heating, (place, variable), powers, 1.0 / (heating * effect))
        for values, effect, powers in zip(logarithms, effects, _HOT_UNLIKE_POWERS, strict=True)
    )
    return Unlikeness(linear.resistance, linear.force, of_resistance, of_k, ends)


def _like_faces_ratios(
    table: SimpleNamespace, unlikeness: Unlikeness, where: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Force and heat ratios without what the difference of the TACs adds."""
    resistance = polynomial(unlikeness.resistance, where, np.log(table.tac + TAC_OFFSET))
    of_force = polynomial(unlikeness.force, where, np.log(table.tac + TAC_OFFSET))
    share = 1.0 / (1.0 + table.knudsen / (table.tac * np.exp(resistance)))
    share = share * width(table.tac_difference, table.tac)
    resisted = (1.0 / table.force_ratio - 1.0) / (1.0 - np.exp(of_force) * share)
    heat = 1.0 / table.heat_ratio - share / (1.0 - share)
    return 1.0 / (1.0 + resisted), 1.0 / heat


def _fit_error(table: SimpleNamespace, errors: np.ndarray, ends: tuple[float, float]) -> Any:
    """Logarithm of the relative standard error: rows' root mean square at each Knudsen number."""
    # Where there are hot rows it is theirs: their errors are larger.
    hot = table.temperature_ratio != 1.0
    counted = hot | (table.knudsen < table.knudsen[hot].min())
    knudsen = np.unique(table.knudsen[counted])
    squares = [np.mean(errors[counted & (table.knudsen == place)] ** 2) for place in knudsen]
    return least_squares(0.5 * np.log(squares), (place_in(ends, knudsen),), ERROR_POWERS)


def _fit_walls(
    walls: SimpleNamespace, heat: Resistance, ends: tuple[float, float]
) -> dict[str, Any]:
    """What walls leave of the resistance to heat, and what they add to the force over the heat."""
    place = place_in(ends, walls.knudsen)
    opened = (
        BOUNDARY_TAC
        * np.exp(polynomial(heat.limit, np.log(BOUNDARY_TAC + TAC_OFFSET), place))
        / walls.knudsen
    )
    kept = ((1.0 + opened) / walls.heat_factor - 1.0) / opened
    beside = np.log(walls.force_factor / walls.heat_factor) / denseness(walls.knudsen)
    wall_ends = ends_of(walls.knudsen)
    variables = (1.0 / walls.boundary, place_in(wall_ends, walls.knudsen))

    def fitted(values: np.ndarray, errors: np.ndarray) -> Any:
        return least_squares(values * walls.boundary, variables, _WALL_POWERS, errors)

    return {
        "heat_wall": fitted(np.log(kept), 1.0 / (opened + _LEAST_WEIGHT)),
        "force_wall": fitted(beside, 1.0 / denseness(walls.knudsen)),
        "wall_knudsen_range": wall_ends,
        "nearest_wall": float(walls.boundary.min()),
    }
