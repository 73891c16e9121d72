r"""Push of a floor that is warmer than the rest of a chamber on a disk as warm as the gas.

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

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.chamber import distances, middle_distance
from lightflyer.flyer.disk import Disk

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
