r"""Temperature of the gas above a floor that is warmer than the rest of a chamber.

At rest the gas between floor, lid and side wall conducts heat. A share :math:`s` of the floor's
excess is left at the flyer's height:

.. math:: T = T_c + s\,(T_f - T_c), \qquad s = (1-w)\,s_0 + w\,s_\infty

with :math:`s_0` of conduction on the axis of the chamber, whose walls stand back by the jump of the
temperature there, and :math:`s_\infty = F/2` of free molecules, half of those that meet the flyer
coming from the floor's view :math:`F`. Between them

.. math::
    w = \frac{\ell}{\ell + c\,d}, \qquad d = (d_f\,d_l\,d_w)^{1/3}

with half the mean free path :math:`\ell`. Two numbers, of join and jump, are fitted to solutions
of the linear kinetic equation around a cold disk above a warm floor (``studies/kinetic_chamber``):
138 of them, with Kn from 0.03 to 2 and surfaces from half a radius to 60 radii away, are met within
0.018 (r.m.s.). Without side wall or lid a share has no meaning: the gas far away would be as warm
as the floor.
"""

from dataclasses import replace

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Radiation
from lightflyer.gas.base import mean_free_path
from lightflyer.numerics.special import i0e

_RARE = 0.4257  # Of the join of both limits, :math:`c`
_JUMP = 1.699  # Distance by which walls stand back, in half mean free paths

_MODES = np.arange(1, 65)
_ENOUGH = 10.0  # times further away a surface no longer matters: its share falls as e^(-10 μ)


@entry_point
def over_warm_floor(state: EnvironmentState, floor_temperature: Numeric) -> EnvironmentState:
    """Surroundings in a chamber whose floor is warmer, or colder, than lid and side wall."""
    excess = floor_temperature / state.temperature - 1.0
    path = mean_free_path(state.pressure, state.temperature, state.gas)
    share = share_of_floor(*distances(state), 0.5 * path)
    temperature = state.temperature * (1.0 + share * excess)
    return replace(state, temperature=temperature, floor_excess=excess)


def radiation_over_floor(
    radiation: Radiation, temperature: Numeric, floor_temperature: Numeric, view: Numeric
) -> Radiation:
    """Light and heat radiation between a black lid and side wall and a floor of another warmth."""
    above, below = radiation.infrared_above, radiation.infrared_below
    black = radiation.stefan_boltzmann
    given = replace(
        radiation,
        infrared_above=black * temperature**4 if above is None else above,
        infrared_below=black * floor_temperature**4 if below is None else below,
    )
    return given.with_ground_view(view)


def distances(state: EnvironmentState) -> tuple[Numeric, Numeric, Numeric]:
    """Distances of floor, lid and side wall [m]; infinite where there is none."""
    given = state.floor_distance, state.lid_distance, state.wall_distance
    floor, lid, wall = (np.inf if each is None else each for each in given)
    return floor, lid, wall


def conducted_share(floor: Numeric, lid: Numeric, wall: Numeric) -> Array:
    """Share of the floor's excess in the middle of a cylinder that conducts heat [1]."""
    lid = xp.minimum(lid, _ENOUGH * wall)
    height = floor + lid
    wall = xp.minimum(wall, _ENOUGH * height)
    floor, height, wall = (xp.asarray(each)[..., None] for each in (floor, height, wall))
    place = np.pi * _MODES / height
    # I0 of large numbers overflows
    bent = xp.sin(place * floor) / _MODES * xp.exp(-place * wall) / i0e(place * wall)
    return (1.0 - floor / height)[..., 0] - 2.0 / np.pi * xp.sum(bent, axis=-1)


def view_of_floor(floor: Numeric, wall: Numeric) -> Array:
    """View factor from a face that looks down to the floor of a cylinder [1]."""
    return 1.0 / (1.0 + (floor / xp.asarray(wall)) ** 2)


def share_of_floor(
    floor: Numeric, lid: Numeric, wall: Numeric, half_mean_free_path: Numeric
) -> Array:
    """Share of the floor's excess that the gas has at the flyer [1]."""
    return joined_share(floor, lid, wall, half_mean_free_path, _RARE, _JUMP)


def joined_share(
    floor: Numeric,
    lid: Numeric,
    wall: Numeric,
    half_mean_free_path: Numeric,
    rare: float,
    jump: float,
) -> Array:
    """The share by other numbers for the join of both limits and the walls' jump."""
    back = jump * half_mean_free_path
    dense = conducted_share(floor + back, lid + back, wall + back)
    apart = rare * middle_distance(floor, lid, wall)
    weight = half_mean_free_path / (half_mean_free_path + apart)
    return (1.0 - weight) * dense + weight * 0.5 * view_of_floor(floor, wall)


def middle_distance(floor: Numeric, lid: Numeric, wall: Numeric) -> Array:
    """Geometric mean of the distances, of those that matter."""
    lid = xp.minimum(lid, _ENOUGH * wall)
    wall = xp.minimum(wall, _ENOUGH * (floor + lid))
    return xp.cbrt(floor * lid * wall)
