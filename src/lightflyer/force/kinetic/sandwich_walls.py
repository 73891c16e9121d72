r"""Walls of a sandwich: what other ones than Maxwell's change in its force.

The table of a sandwich is for Maxwell walls. Where both of its outer faces scatter as Cercignani
and Lampis say, one hot and one cold, the force over that at Maxwell walls of the same TAC is

.. math:: \frac F{F_M} = \frac{1}{\bar\alpha}
    \left(\alpha_n + \frac{\delta}{\delta+\delta_0}\,g(\delta, \beta, \alpha_n, \alpha_t,
    \alpha_r)\right)

with a polynomial :math:`g` through a table of the solver's, for small differences. Without
collisions only the normal motion of the molecules that leave pushes.

A TAC leaves open how the kinds of energy share it. Where they do evenly, as at accommodated walls,
the force is that at Maxwell walls within 1 %, which is taken for the same. Unknown walls reach from
there to two ends. At one tangential motion and rotation accommodate wholly, and normal motion lacks
all that the TAC lacks. At the other molecules that a face does not trap lose half of their normal
energy, and nothing else (:mod:`lightflyer.force.kinetic.walls`).

A difference of two warm faces' TACs pushes as at a disk with these walls.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.force.fitted import fitted
from lightflyer.force.kinetic.sandwich_table import RAREFACTION_OF_KNUDSEN, place_of
from lightflyer.force.kinetic.scattering import Accommodations
from lightflyer.force.kinetic.walls import (
    BOUNCED,
    Walls,
    kinds_of,
    left_to_normal,
    scattering_fit,
    sharing_factor,
    uncertain,
    wall_fit,
)
from lightflyer.numerics.horner import polynomial

_DENSITY = 1.8  # δ at which thin gas gives way to dense, for what is fitted only
UNKNOWN_TACS = (0.6, 1.0)  # between which unknown walls change with the TAC


@dataclass(frozen=True)
class SandwichWallsFit:
    """Pushes of hot and cold faces that scatter alike, over Maxwell's of a TAC of 1, for a gas."""

    rarefaction_range: tuple[float, float]  # Of the table
    ranges: tuple[tuple[float, float], ...]  # Of open fraction and the coefficients in it
    coefficients: Any  # Place in the table, open fraction, accommodation coefficients

    def added(self, rarefaction: Numeric, open_fraction: Numeric, faces: Accommodations) -> Array:
        r"""What collisions add to the push of the normal motion, :math:`\alpha_n` [1]."""
        values = (open_fraction, *faces)[: len(self.ranges)]
        inside = [xp.clip(v, *range_) for v, range_ in zip(values, self.ranges, strict=True)]
        place, _ = place_of(rarefaction, self.rarefaction_range)
        found = polynomial(self.coefficients, place, *inside)
        return xp.asarray(denseness(rarefaction) * found)


def denseness(rarefaction: Any) -> Any:
    """Grows from 0 in thin gas to 1 in dense gas."""
    return rarefaction / (rarefaction + _DENSITY)


@lru_cache
def sandwich_walls_fit(gas: str) -> SandwichWallsFit:
    """Smooth function through the table for a gas."""
    return fitted(SandwichWallsFit, "sandwich walls", gas)


@lru_cache
def ends_fit(gas: str) -> tuple[Any, ...]:
    """Coefficients of what collisions add to the pushes at both :func:`ends`."""
    return fitted(tuple, "sandwich sharing", gas)


def ends(tac: Any, gas: str) -> tuple[Accommodations, Accommodations]:
    """How a face may share its TAC at most: in its normal motion, and in what it traps."""
    kinds = kinds_of(gas)
    bounced = BOUNCED / kinds  # of all energy of a molecule that is not trapped
    trapped = xp.maximum((tac - bounced) / (1.0 - bounced), 0.0)
    return (
        Accommodations(left_to_normal(tac, kinds), 1.0, 1.0),
        Accommodations(trapped + BOUNCED * (1.0 - trapped), trapped, trapped),
    )


def force_factors(
    gas: str,
    place: tuple[Numeric, Numeric, Numeric],
    excess: tuple[Array, ...],
    walls: Walls,
    kept: Numeric,
) -> tuple[Numeric, Numeric]:
    """Force by a difference of temperatures and of TACs over those at Maxwell walls [1].

    Parameters
    ----------
    gas : {"monatomic", "diatomic"}
    place : tuple of array
        Rarefaction, open fraction and TAC [1].
    excess : tuple of array
        :math:`T/T_c-1` of both faces [1].
    walls : Walls
    kept : array
        What is left of what collisions add, where they are not those of the table, in open space
        [1].
    """
    if walls.wall == "maxwell":
        return 1.0, 1.0
    rarefaction, open_fraction, tac = place
    knudsen, mean = RAREFACTION_OF_KNUDSEN / rarefaction, 0.5 * (excess[0] + excess[1])
    free = 0.5 * (xp.sqrt(1.0 + mean) + 1.0) / xp.sqrt(1.0 + tac * mean)
    of_tacs = free * wall_fit(gas).force_factor(knudsen, 1.0 + mean, tac)
    if walls.wall == "cercignani-lampis":
        stated = walls.stated(gas)
        faces = stated.held(tac)
        added = sandwich_walls_fit(gas).added(rarefaction, open_fraction, faces)
        # kinds that are not stated share a difference of TACs; normal motion has the rest
        shared = [k is None for k in (stated.tangential, stated.rotational)]
        weights = scattering_fit(gas).weights(knudsen, faces)
        differences = 3.0 - sum(shared), *(float(one) for one in shared)
        of_tacs = of_tacs * sum(w * d for w, d in zip(weights, differences, strict=True))
        return (_push_of_free(faces.normal, excess) + kept * added) / tac, of_tacs
    # from accommodated walls towards Maxwell's
    way = 0.0 if walls.wall == "accommodated" else 0.5
    of_tacs = uncertain(of_tacs + way * (1.0 - of_tacs), (1.0 - way) * (1.0 - of_tacs), walls.error)
    if walls.sharing is None:
        return 1.0, of_tacs
    share = xp.clip(xp.asarray(walls.sharing) / NORMAL_HALF_WIDTH_95, -1.0, 1.0)
    upper, lower = _factors_at_ends(gas, place, excess, kept)
    found = 1.0 + xp.maximum(share, 0.0) * (upper - 1.0) + xp.maximum(-share, 0.0) * (lower - 1.0)
    return found, of_tacs * sharing_factor(gas, knudsen, tac, mean, walls.sharing)


def near_walls(rarefaction: Numeric, distance: Numeric) -> Array:
    """Share that a reservoir leaves of what collisions add [1]; ``distance``: in disk radii."""
    # through solutions at rarefactions of 0.2, 1 and 5 and distances of 3 and 6, within 0.02
    return xp.asarray(1.0 - distance**-1.5 / (1.0 + rarefaction) ** 2)


def _push_of_free(normal: Numeric, excess: tuple[Array, ...]) -> Array:
    """Push of the normal motion, over that at Maxwell walls with a TAC of 1 [1]."""
    maxwell, found = (sum(xp.sqrt(1.0 + one * face) for face in excess) for one in (1.0, normal))
    return xp.asarray(normal * maxwell / found)


def _factors_at_ends(
    gas: str,
    place: tuple[Numeric, Numeric, Numeric],
    excess: tuple[Array, ...],
    kept: Numeric,
) -> list[Array]:
    """Force over that at Maxwell walls at both :func:`ends` [1]."""
    rarefaction, open_fraction, tac = place
    fit = sandwich_walls_fit(gas)
    held, hole = xp.clip(tac, *UNKNOWN_TACS), xp.clip(open_fraction, *fit.ranges[0])
    at = place_of(rarefaction, fit.rarefaction_range)[0], hole, held
    dense = kept * denseness(rarefaction)
    return [
        (_push_of_free(end.normal, excess) + dense * polynomial(coefficients, *at)) / held
        for end, coefficients in zip(ends(held, gas), ends_fit(gas), strict=True)
    ]
