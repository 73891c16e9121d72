r"""What floor, lid and side wall of a chamber do to the kinetic force and heat loss of a disk.

Solid surfaces at distances of their own change force and heat loss by factors, as they change how
much the gas resists. Where floor and lid are not alike they also push a disk whose faces are the
same: the gas between disk and floor is warmer than that above. For small temperature differences

.. math::
    \frac{F}{pA} = f\,\frac{F_o}{pA} + g\,\theta, \qquad Q = h\,Q_o

with :math:`F_o, Q_o` in open space and :math:`\theta = T_h/T_c - 1`. The solver's table of the
factors is made by ``studies/kinetic_chamber``; ``studies/kinetic_fits`` fits polynomials in the
inverse distances to it. For a hot disk :class:`ChamberEffect` keeps what the factors say of the
gas's resistance.

Push of a floor that is warmer than the rest of a chamber on a disk as warm as the gas.

Heat flows through the gas from the floor to lid and side wall, and molecules from below bring more
momentum than those from above: thermophoresis. For a disk of like faces

.. math::
    \frac{F}{pA} = 2\left(\sqrt{T_f/T_c}-1\right)\frac{2-\alpha_b}{4}\,
    \frac{1 - \cos^3\vartheta}{\left[1 + a/k + (b/k)^2\right]^c}, \qquad k = \frac{\lambda}{2d}

Without the denominator it is what free molecules bring: :math:`\vartheta` is the half-angle at
which the disk sees the floor, and d the geometric mean of the distances. In dense gas the force
falls somewhat faster than the square of the mean free path. Three numbers are fitted to the
solutions behind :mod:`lightflyer.environment.chamber`, for TACs of 0.85; they follow them within
0.003 and 5 % (r.m.s.).
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.chamber import distances, middle_distance
from lightflyer.flyer.disk import Disk
from lightflyer.force.fitted import fitted
from lightflyer.force.kinetic.collisions import HEATED_RANGE
from lightflyer.force.kinetic.ratios import denseness, heating_of, thinness
from lightflyer.numerics.polynomials import hold_within, polynomial

# powers of floor, lid and side wall: floor and lid may be exchanged, with the same or the
# opposite result
EVEN = (
    (1, 0, 0), (2, 0, 0), (3, 0, 0), (1, 1, 0), (2, 1, 0), (0, 0, 1), (0, 0, 2), (0, 0, 3),
    (1, 0, 1), (2, 0, 1), (1, 0, 2), (1, 1, 1),
)  # fmt: skip
ODD = ((1, 0, 0), (2, 0, 0), (3, 0, 0), (2, 1, 0), (1, 0, 1), (2, 0, 1), (1, 0, 2), (1, 0, 3))

_HELD = "the table of chambers ends there, and their effect is held"
_DENSE = (
    "the table of chambers ends there, and their factors are held; the push on like faces falls as "
    "the square of the Knudsen number"
)
OF_DIATOMIC = "what floor and lid do is taken from a diatomic gas"
REFERENCE_TAC = 0.85  # Mean TAC in the table of chambers


class SurfaceDistances(NamedTuple):
    """Distances of solid surfaces in radii of the disk [1]; infinite where there is none."""

    floor: Numeric
    lid: Numeric
    wall: Numeric


def chamber_of(state: EnvironmentState, radius: Numeric) -> SurfaceDistances | None:
    """The chamber around a disk, or None without floor and lid; ``radius``: of the disk."""
    ends = state.floor_distance, state.lid_distance
    if ends == (None, None):
        return None
    distances = (*ends, state.wall_distance)
    return SurfaceDistances(*(np.inf if given is None else given / radius for given in distances))


FORCE_ERROR, HEAT_ERROR, PUSH_ERROR = 0.03, 0.015, 0.15
"""Relative standard errors among solid walls: of the force by the difference of the TACs, of heat,
and of the push on a disk of like faces. They are what solutions of the non-linear equation at 1.6
to 2.34 times the gas's temperature show; of heat what direct simulations over a floor do, whose
TACs are 0.01 and 1."""

_HEATED_KNUDSEN, _HEATED_FORCE_POWER, _HEATED_HEAT_POWER = 0.29, 0.27, 0.6
"""How the logarithm of the share of resistance that is left changes with temperature: in thin gas
to these powers of :math:`T_h/T_c`, and not in dense gas, whose conduction leaves the same share.
Fitted to 30 non-linear solutions in reservoirs, at Kn 0.1 to 3, 2 to 8 radii and 1.5 to 3.3; seven
in chambers have the same power of heat, and none of force."""

RESERVOIR_ERRORS = 0.015, 0.007
"""Relative standard errors of force and heat in a reservoir, sized so that all direct simulations
in reservoirs of 2 and 4 radii are within the 95 % bounds. Most of it is that collisions of
molecules take another share there than in open space."""

_LEAST_RESISTANCE = 1e-12  # of free molecules; a share of nothing is any number


class ChamberEffect(NamedTuple):
    r"""What a chamber does to a disk, by default nothing."""

    # The gas takes :math:`1/\hat F - 1` of the force that is left: what resists. Surroundings leave
    # a share of that, which a hot disk nearly has in common with one that is hardly warmer than
    # the gas; the factors on force and heat themselves it has not.

    # Share of the gas's resistance to force, by the difference of the TACs, and heat that the
    # surroundings leave [1]
    force_kept: Numeric = 1.0
    heat_kept: Numeric = 1.0
    lift: Numeric = 0.0  # Push on a disk of like faces [p A per unit of the disk's T/T_c − 1]
    # Relative standard errors of force and heat, besides those in open space [1]
    force_error: Numeric = 0.0
    heat_error: Numeric = 0.0

    def force_ratio(self, opened: Numeric) -> Numeric:
        """Force over that of free molecules [1]; ``opened``: in open space."""
        return resistance_ratio(opened, self.force_kept)

    def heat_ratio(self, opened: Numeric) -> Numeric:
        """Heat over that of free molecules [1]; ``opened``: in open space."""
        return resistance_ratio(opened, self.heat_kept)

    def push(self, disk: Disk, state: EnvironmentState, excess: Numeric) -> Numeric:
        """Push on a disk of like faces [N]; ``excess``: T_h/T_c − 1."""
        # From small to large temperature differences it grows as the recoil of molecules does, with
        # the root of the temperature; solved at 1.8 and 2.34 times the gas's, within 7 %.
        growth = 2.0 * (xp.sqrt(1.0 + excess) - 1.0)
        return state.pressure * disk.area * self.lift * growth


def reservoir(
    factors: tuple[Numeric, Numeric],
    opened: tuple[Numeric, Numeric],
    knudsen: Numeric,
    ratio: Numeric,
) -> ChamberEffect:
    """What open surroundings do, from the factors on force and heat of small differences."""
    # ``opened``: both over those of free molecules in open space, of small differences
    force, heat = (
        _keep_hot(_keep(factor, value), power, knudsen, ratio)
        for factor, value, power in zip(
            factors, opened, (_HEATED_FORCE_POWER, _HEATED_HEAT_POWER), strict=True
        )
    )
    return ChamberEffect(force, heat, 0.0, *RESERVOIR_ERRORS)


def resistance_ratio(opened: Numeric, kept: Numeric) -> Array:
    """Force or heat over that of free molecules where a share of the resistance is left [1]."""
    return xp.asarray(opened / (opened + kept * (1.0 - opened)))


def _keep(factor: Numeric, opened: Numeric) -> Array:
    """Share of the resistance that is left where a factor is on force or heat [1]."""
    return (1.0 / factor - opened) / xp.maximum(1.0 - opened, _LEAST_RESISTANCE)


def _keep_hot(kept: Numeric, power: float, knudsen: Numeric, ratio: Numeric) -> Array:
    """Share of the resistance that is left around a hot disk; ``kept``: at small differences."""
    heating = hold_within(heating_of(ratio), *np.log(HEATED_RANGE))
    thin = 1.0 / (1.0 + (_HEATED_KNUDSEN / knudsen) ** 3)
    logarithm = xp.log(xp.maximum(kept, _LEAST_RESISTANCE))
    return xp.exp(logarithm * xp.exp(power * thin * heating))


@dataclass(frozen=True)
class ChamberFit:
    """Effects of a chamber as smooth functions."""

    # Of the table; beyond it the factors stay what they are there, and in denser gas the push falls
    # as the square of the Knudsen number
    knudsen_range: tuple[float, float]
    nearest: SurfaceDistances  # Least distances in the table
    force: Any  # Coefficients of each term of inverse distances: powers of the Knudsen number
    kept: Any
    lift: Any

    def walls(
        self,
        knudsen: Numeric,
        chamber: SurfaceDistances,
        opened: tuple[Numeric, Numeric],
        tac: Numeric,
        ratio: Numeric = 1.0,
    ) -> ChamberEffect:
        """Effect on a disk; ``ratio``: T_h/T_c."""
        place, dense = thinness(knudsen, self.knudsen_range), denseness(knudsen)
        # thermal stress, which pushes like faces in dense gas, is of second order
        beyond = xp.minimum(knudsen / self.knudsen_range[0], 1.0) ** 2
        near = nearness(chamber, self.nearest)

        def value(coefficients: Any, terms: Any) -> Array:
            parts = zip(coefficients, terms, strict=True)
            return sum((polynomial(own, place) * term for own, term in parts), xp.zeros(()))

        heat_kept = xp.exp(value(self.kept, terms(near, EVEN, 1.0)))
        beside = xp.exp(value(self.force, terms(near, EVEN, 1.0)) * dense)
        force, heat = opened
        factor = beside * resistance_ratio(heat, heat_kept) / heat
        lift = value(self.lift, terms(near, ODD, -1.0))
        lift = lift * (beyond * dense * tac / REFERENCE_TAC)
        heat_kept = _keep_hot(heat_kept, _HEATED_HEAT_POWER, knudsen, ratio)
        return ChamberEffect(_keep(factor, force), heat_kept, lift, FORCE_ERROR, HEAT_ERROR)

    def ranges(self, chamber: SurfaceDistances, knudsen: Numeric) -> Looks:
        """Of the table: how near surfaces are, and how dense the gas."""
        yield Validity("the Knudsen number", self.knudsen_range[0], np.inf, _DENSE), knudsen
        names = ("the floor's", "the lid's", "the side wall's")
        for name, least, distance in zip(names, self.nearest, chamber, strict=True):
            far = Validity(f"{name} distance over the radius", float(least), np.inf, _HELD)
            yield far, distance


def nearness(chamber: SurfaceDistances, nearest: SurfaceDistances | None = None) -> tuple[Any, ...]:
    """1/(1 + distance) of floor, lid and side wall [1], no nearer than the nearest."""
    if nearest is None:
        return tuple(1.0 / (1.0 + np.asarray(distance)) for distance in chamber)
    held = zip(chamber, nearest, strict=True)
    return tuple(1.0 / (1.0 + xp.maximum(distance, least)) for distance, least in held)


def terms(near: tuple[Any, ...], powers: Any, exchanged: float) -> list[Any]:
    """Products of powers, with those where floor and lid are exchanged."""
    floor, lid, wall = near
    found = []
    for a, b, c in powers:
        term = floor**a * lid**b
        if a != b:
            term = term + exchanged * floor**b * lid**a
        found.append(term * wall**c)
    return found


@lru_cache
def chamber_fit() -> ChamberFit:
    """Effects of a chamber on a disk; the table is for a diatomic gas."""
    return fitted(ChamberFit, "chamber", "diatomic")


_FIRST, _SECOND, _STEEPNESS = 0.1679, 0.0516, 1.1198  # a, b, c

_ERROR, _RELATIVE_ERROR = 0.003, 0.05
"""Standard error of the push, of p A per unit of the floor's excess and relative."""

_DENSEST = 0.03
"""Knudsen number where the table ends; in denser gas the former error falls as its square."""


def push_of_floor(
    disk: Disk, state: EnvironmentState, knudsen: Numeric, error: Numeric | None
) -> Array:
    """Force on a disk as warm as the gas, upwards positive [N]; ``error``: in standard errors."""
    floor, lid, wall = (each / disk.radius for each in distances(state))
    numbers = _FIRST, _SECOND, _STEEPNESS
    push = joined_push(floor, lid, wall, knudsen, disk.film.tac_bottom, *numbers)
    if error is not None:
        known = xp.minimum(knudsen / _DENSEST, 1.0) ** 2
        push = push + (error * (_ERROR * known + _RELATIVE_ERROR * push))
    growth = 2.0 * (xp.sqrt(1.0 + state.floor_excess) - 1.0)
    return state.pressure * disk.area * push * growth


def joined_push(
    floor: Numeric,
    lid: Numeric,
    wall: Numeric,
    knudsen: Numeric,
    tac: Numeric,
    first: float,
    second: float,
    steepness: float,
) -> Array:
    """Push for small excesses, distances in radii [p A per unit of the floor's excess]."""
    # a wall that is infinitely far would have no derivative
    cosine = floor / xp.hypot(floor, xp.minimum(wall, 1e9 * floor))
    free = 0.25 * (2.0 - tac) * (1.0 - cosine**3)
    thin = knudsen / middle_distance(floor, lid, wall)
    return xp.asarray(free / (1.0 + first / thin + (second / thin) ** 2) ** steepness)
