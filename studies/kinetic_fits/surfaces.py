"""Fits of what walls, molecules, chambers and films do to force and heat loss of a disk."""

from typing import Any, TypeAlias

import numpy as np
from kinetic_fits.common import Coefficients, ends_of, least_squares, place_in

from lightflyer.force.kinetic import chamber, collisions, walls
from lightflyer.force.kinetic.chamber import ChamberFit
from lightflyer.force.kinetic.collisions import CollisionFit
from lightflyer.force.kinetic.ratios import KineticFit, LocalBalanceFit, denseness
from lightflyer.force.kinetic.walls import Accommodations, ScatteringFit, WallFit

Columns: TypeAlias = dict[str, np.ndarray]
"""Columns of a table, shape (n,) each."""

# powers of heating, TAC and Knudsen number
_HEATED_POWERS = [(1, tac, knudsen) for tac in range(3) for knudsen in range(4)]
_FORCE_POWERS = [
    *((0, tac, knudsen) for tac in range(4) for knudsen in range(6)),
    *_HEATED_POWERS,
    *((2, 0, knudsen) for knudsen in range(3)),
    (3, 0, 0),
]
_HEAT_POWERS = [
    *((0, tac, knudsen) for tac in range(3) for knudsen in range(6)),
    *_HEATED_POWERS,
    *((2, 0, knudsen) for knudsen in range(2)),
]
_SHARED_POWERS = [(knudsen, tac) for tac in range(4) for knudsen in range(5)]
_DEGREE, _KNUDSEN_DEGREE = 3, 4  # of weights of scattering
_TACS = (0.3, 1.0)  # little beyond those of the table of collisions, 0.4 and 0.9
_FEW, _MANY = 4, 5  # powers of the Knudsen number in a chamber
_LOST_POWERS = [(0,), (1,), (2,), (3,)]
_LEAST_SHARE = 1e-5  # that meshes resolve [1]
# powers of viscosity exponent, TAC and Knudsen number
_COLLISION_POWERS = {
    "monatomic": [
        *((0, 0, knudsen) for knudsen in range(6)),
        *((1, 0, knudsen) for knudsen in range(5)),
        *((2, 0, knudsen) for knudsen in range(3)),
        *((exponent, 1, knudsen) for exponent in range(2) for knudsen in range(3)),
    ],
    "diatomic": [
        *((0, 0, knudsen) for knudsen in range(6)),
        *((1, 0, knudsen) for knudsen in range(5)),
        *((exponent, 1, knudsen) for exponent in range(2) for knudsen in range(3)),
    ],
}


def fit_walls(table: Columns) -> WallFit:
    """Ratios at accommodated walls over those at Maxwell's."""
    knudsen, tac = table["knudsen"], table["tac"]
    heating = np.log(table["temperature_ratio"])
    ends = ends_of(knudsen)
    position = place_in(ends, knudsen)

    def factor(name: str, share: np.ndarray, powers: list[tuple[int, int, int]]) -> Any:
        kept = share > 0.0
        other, maxwell = (
            table[f"{name}_ratio_{wall}"][kept] for wall in ("accommodated", "maxwell")
        )
        variables = tuple(column[kept] for column in (heating, tac, position))
        # weighted so that what is fitted is the logarithm of the factor itself
        return least_squares(
            np.log(other / maxwell) / share[kept], variables, powers, 1.0 / share[kept]
        )

    dense, heated = walls.denseness(knudsen), knudsen[heating != 0.0]
    return WallFit(
        knudsen_range=ends,
        heated_range=ends_of(heated),
        tac_range=ends_of(tac),
        heating_range=ends_of(heating),
        force=factor("force", dense, _FORCE_POWERS),
        heat=factor("heat", dense * (1.0 - tac), _HEAT_POWERS),
    )


def force_at_walls_of_one_temperature(
    table: Columns, gas: str, disk: KineticFit, accommodated: WallFit
) -> np.ndarray:
    """Linear force of accommodated walls with the TACs of a table, over free molecules', (n,)."""
    where = table["knudsen"], 1.0, mean_tac(table, gas)
    return np.asarray(disk.force_ratio(*where) * accommodated.force_factor(*where))


def mean_tac(accommodations: Columns, gas: str) -> np.ndarray:
    """TAC of coefficients in a table, of which each carries as much energy."""
    kinds = Accommodations._fields[: walls.kinds_of(gas)]
    return np.mean([accommodations[kind] for kind in kinds], axis=0)


def fit_scattering(table: Columns, accommodated: np.ndarray) -> ScatteringFit:
    """Weights of kinds of accommodation; ``accommodated`` (n,): force of accommodated walls."""
    knudsen = table["knudsen"]
    ends = ends_of(knudsen)
    variables = place_in(ends, knudsen), *(table[kind] for kind in Accommodations._fields)
    highest = [int(np.ptp(column) > 0.0) * _DEGREE for column in variables[1:]]
    powers = [
        (first, *others)
        for first in range(_KNUDSEN_DEGREE + 1)
        for others in np.ndindex(*(degree + 1 for degree in highest))
        if sum(others) <= _DEGREE
    ]
    dense = walls.denseness(knudsen)
    coefficients = tuple(
        least_squares(
            (table[f"force_{kind}"] / accommodated - (kind == "normal")) / dense,
            variables,
            powers,
            1.0 / dense,
        )
        for kind in Accommodations._fields
    )
    ranges = tuple(ends_of(table[kind]) for kind in Accommodations._fields)
    return ScatteringFit(ends, ranges, coefficients)


def fit_sharing(gas: str, scattering: ScatteringFit) -> tuple[Coefficients, Coefficients]:
    """What :func:`lightflyer.force.kinetic.walls.sharing_factor` takes of weights of scattering."""
    # of the force where normal motion alone differs, and of what a share moves it at the mean TAC
    kinds = walls.kinds_of(gas)
    positions, places = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-1.0, 1.0, 25)] * 2))
    low, high = np.log(scattering.knudsen_range)
    knudsen = np.exp(0.5 * (low + high + positions * (high - low)))
    lowest, highest = walls.shared_tacs(kinds)
    tac = 0.5 * (lowest + highest + places * (highest - lowest))

    def weights(normal: np.ndarray, other: np.ndarray) -> np.ndarray:
        return np.stack(scattering.weights(knudsen, Accommodations(normal, other, other))[:kinds])

    even, alone = weights(tac, tac), weights(walls.left_to_normal(tac, kinds), np.ones_like(tac))
    upper = kinds * alone[0] / even.sum(axis=0)
    gain = (kinds * even[0] - even.sum(axis=0)) / even.sum(axis=0)
    dense, variables = walls.denseness(knudsen), (positions, places)
    upper, gain = (
        least_squares((found - thin) / dense, variables, _SHARED_POWERS)
        for found, thin in ((upper, kinds), (gain, kinds - 1))
    )
    return upper, gain


def fit_collisions(table: Columns, gas: str) -> CollisionFit:
    """Factors on what the model equation's collisions take."""
    knudsen, exponent = table["knudsen"], table["viscosity_exponent"]
    ends = ends_of(knudsen)
    variables = (
        exponent - collisions.REFERENCE_EXPONENT,
        table["tac"] - collisions.REFERENCE_TAC,
        place_in(ends, knudsen),
    )
    force, heat = (
        least_squares(np.log(table[f"{name}_factor"]), variables, _COLLISION_POWERS[gas])
        for name in ("force", "heat")
    )
    return CollisionFit(ends, ends_of(exponent), _TACS, force, heat)


def fit_chamber(table: Columns) -> ChamberFit:
    """Effects of floor, lid and side wall."""
    knudsen, opened = table["knudsen"], table["open_heat_ratio"]
    ends = ends_of(knudsen)
    place, dense = place_in(ends, knudsen), denseness(knudsen)
    near = chamber.nearness(chamber.SurfaceDistances(table["floor"], table["lid"], table["wall"]))
    heat = table["heat_factor"]
    kept = (1.0 / heat - opened) / (1.0 - opened)

    def fit(values: Any, terms: Any, weights: Any, number: int) -> Coefficients:
        powers = place[:, None] ** np.arange(number)
        basis = np.concatenate([np.asarray(term)[:, None] * powers for term in terms], axis=1)
        found = np.linalg.lstsq(basis * weights[:, None], values * weights, rcond=None)[0]
        return tuple(map(tuple, found.reshape(len(terms), number).tolist()))

    even, odd = chamber.terms(near, chamber.EVEN, 1.0), chamber.terms(near, chamber.ODD, -1.0)
    force = np.log(table["force_factor"] / heat) / dense
    nearest = float(min(table["floor"].min(), table["lid"].min()))
    return ChamberFit(
        ends,
        chamber.SurfaceDistances(nearest, nearest, float(table["wall"].min())),
        fit(force, even, dense, _MANY),
        fit(np.log(kept), even, 1.0 - opened, _MANY),
        fit(table["lift"] / dense, odd, dense / table["force"], _FEW),
    )


def fit_local_balance(table: Columns) -> LocalBalanceFit:
    """Shares that a film loses."""
    kept = 1.0 - table["heat_factor"] > _LEAST_SHARE
    knudsen = table["knudsen"][kept]
    ends = ends_of(knudsen)
    place = place_in(ends, knudsen)
    lost = [1.0 - table[f"{name}_factor"][kept] for name in ("force", "heat")]
    force, heat = (
        least_squares(
            np.log(share), (place,), _LOST_POWERS, share**-0.5
        )  # small shares hardly matter
        for share in lost
    )
    return LocalBalanceFit(ends, force, heat)
