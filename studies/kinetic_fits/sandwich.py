"""Fits of a disk with holes: of itself, around chambers, hot, and with walls that scatter."""

from types import SimpleNamespace
from typing import Any

import numpy as np
from kinetic_fits.common import (
    Coefficients,
    ends_of,
    error_fit,
    least_squares,
    place_in,
)
from kinetic_fits.surfaces import mean_tac

from lightflyer.force.kinetic import sandwich_table
from lightflyer.force.kinetic.ratios import KineticFit
from lightflyer.force.kinetic.sandwich_table import (
    SandwichFit,
    SandwichResistance,
    SandwichWallsFit,
    flow,
)
from lightflyer.force.kinetic.walls import Accommodations, kinds_of
from lightflyer.numerics.polynomials import as_tuples

_MOST = 8  # power of the rarefaction
_POWERS = [
    (hole, tac, place)
    for hole in range(5)
    for tac in range(3)
    for place in range(_MOST + 1)
    if hole == 0 or hole + tac + place <= _MOST + 1
]
_HEAT_POWERS = [(share, place) for share in range(4) for place in range(_MOST + 1)]
_WALL_POWERS = [(near, hole, place) for near in range(4) for hole in range(5) for place in range(5)]
_HOT_POWERS = [  # through every point of the table
    (heat, hole, place) for heat in range(2) for hole in range(3) for place in range(3)
]
_LEAST_WEIGHT = 1e-4  # of a row in thin gas, where the resistance hardly matters
_DEGREE, _PLACE_DEGREE = 3, 4  # of walls that scatter
_SHARED_POWERS = [(place, hole, tac) for place in range(5) for hole in range(3) for tac in range(4)]


def fit(
    disk: KineticFit, table: SimpleNamespace, hot: SimpleNamespace, walls: SimpleNamespace
) -> SandwichFit:
    """Smooth functions through the tables of a disk with holes, hot ones and walls around."""
    ends = ends_of(table.rarefaction)
    place = place_in(ends, table.rarefaction)
    low, high = np.log(ends)
    delta, solid = table.rarefaction, 1.0 - table.open_fraction
    both, share = (table.open_fraction, table.tac), solid * table.tac

    def resistance(
        ratio: np.ndarray, scale: np.ndarray, variables: Any, powers: Any
    ) -> SandwichResistance:
        values = np.log((1.0 / ratio - 1.0) / (scale * delta))
        errors = 1.0 / (1.0 - ratio + _LEAST_WEIGHT)
        inside = least_squares(values, (*variables, place), powers, errors)
        slope = np.asarray(inside) @ np.arange(_MOST + 1) * 2.0 / (high - low)  # at +1
        return SandwichResistance(inside, as_tuples(slope))

    def returned(ratio: np.ndarray) -> Coefficients:
        scale = share * delta / (1.0 + delta)
        errors = ratio / (scale + _LEAST_WEIGHT)
        return least_squares((1.0 - ratio) / scale, (*both, place), _POWERS, errors)

    wall_ends = ends_of(walls.rarefaction)
    wall_place = place_in(wall_ends, walls.rarefaction)
    by_distance = (1.0 / walls.boundary, walls.open_fraction, wall_place)
    factors = (
        walls.force_factor,
        walls.tac_force_factor,
        walls.heat_factor,
        walls.heat_difference_factor,
    )
    hot_ends = ends_of(hot.rarefaction)
    hot_place = place_in(hot_ends, hot.rarefaction)
    heating = 1.0 - 1.0 / hot.temperature_ratio
    growths = (
        hot.force_growth,
        hot.tac_force_growth,
        hot.heat_growth,
        hot.heat_difference_growth,
    )
    return SandwichFit(
        rarefaction_range=ends,
        tac_range=ends_of(table.tac),
        force=resistance(table.force_ratio, solid, (flow(table.open_fraction), table.tac), _POWERS),
        tac_force=resistance(table.tac_force_ratio, solid, both, _POWERS),
        heat=resistance(table.heat_ratio, share, (share,), _HEAT_POWERS),
        heat_difference=returned(table.heat_difference_ratio),
        disk=disk,
        hot=tuple(
            least_squares(
                np.log(growth) / heating, (heating, hot.open_fraction, hot_place), _HOT_POWERS
            )
            for growth in growths
        ),
        heating_limit=float(heating.max()),
        hot_range=hot_ends,
        walls=tuple(
            least_squares(np.log(factor) * walls.boundary, by_distance, _WALL_POWERS)
            for factor in factors
        ),
        wall_range=wall_ends,
        nearest_wall=float(walls.boundary.min()),
        force_error=error_fit(table.force_ratio_error / table.force_ratio, place),
        heat_error=error_fit(table.heat_ratio_error / table.heat_ratio, place),
    )


def fit_walls(table: dict[str, np.ndarray], gas: str, maxwell: SandwichFit) -> SandwichWallsFit:
    """Pushes of faces that scatter; ``table`` has columns (n,)."""
    names = ("open_fraction", *Accommodations._fields[: kinds_of(gas)])
    rarefaction, variables = table["rarefaction"], tuple(table[name] for name in names)
    ends, tac = ends_of(rarefaction), mean_tac(table, gas)
    share = (1.0 - table["open_fraction"]) * tac
    ratios = sandwich_table.Ratios(maxwell, rarefaction, table["open_fraction"], tac, share, 1.0)
    ratio = ratios.force
    dense = sandwich_table.denseness(rarefaction)
    powers = [
        (place, *others)
        for place in range(_PLACE_DEGREE + 1)
        for others in np.ndindex(*(_DEGREE + 1,) * len(names))
        if sum(others) <= _DEGREE
    ]
    excess = (table["force"] / ratio - table["normal"]) / dense
    places = place_in(ends, rarefaction)
    coefficients = least_squares(excess, (places, *variables), powers, 1.0 / dense)
    return SandwichWallsFit(ends, tuple(map(ends_of, variables)), coefficients)


def fit_sharing(gas: str, scattered: SandwichWallsFit) -> tuple[Coefficients, ...]:
    """What collisions add to the pushes at both ends of how a face may share its TAC."""
    # over place, open fraction and TAC: more than three numbers would slow each prediction
    ranges = (-1.0, 1.0), scattered.ranges[0], sandwich_table.UNKNOWN_TACS
    axes = np.meshgrid(*(np.linspace(*range_, 13) for range_ in ranges))
    place, hole, tac = variables = tuple(axis.ravel() for axis in axes)
    low, high = np.log(scattered.rarefaction_range)
    rarefaction = np.exp(0.5 * (low + high + place * (high - low)))
    dense = sandwich_table.denseness(rarefaction)
    return tuple(
        least_squares(
            scattered.added(rarefaction, hole, end) / dense, variables, _SHARED_POWERS, 1.0 / dense
        )
        for end in sandwich_table.ends(tac, gas)
    )
