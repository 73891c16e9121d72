r"""Drag of a thin disk in gas of any density, broadside and edgewise.

Drag is written as that of thin gas, :math:`F = G\,p\,A\,s` with the speed ratio
:math:`s = U/\sqrt{2RT}`. The resistances of free molecules and of dense gas are added:

.. math::
    \frac1G = \frac{1}{(1-t)\,G_\mathrm{fm}(s)}
        + \frac{b(\delta)}{G_\mathrm{d}}, \qquad
    G_\mathrm{d} = \frac{16}{\pi\,\delta}\,\Phi(\mathrm{Re})

:math:`b` is what the kinetic equation says of a slow disk (:mod:`lightflyer.drag.disk_table`), one
in dense gas. :math:`\Phi` is the inertia of dense gas (:mod:`lightflyer.drag.inertia`), and
:math:`t` the share of the arriving molecules that pass holes of the disk. Both limits are exact.

The warmth of a disk makes the resistance of free molecules smaller and leaves that of dense gas as
it is: so says the kinetic equation (studies/drag/hot_disk.py). Edgewise, where it was not solved,
the resistance of dense gas grows too (:func:`~lightflyer.drag.similarity.viscosity_growth`).
"""

import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Length, Pressure, Temperature, Velocity
from lightflyer.core.validity import Validity
from lightflyer.drag import free_molecular
from lightflyer.drag.disk_table import TAC_RANGE, dense_share
from lightflyer.drag.inertia import DISK_REYNOLDS, disk_inertia, edgewise_inertia
from lightflyer.drag.similarity import (
    SLOW,
    THIN,
    WARMTH,
    molecular_speed,
    rarefaction_parameter,
    reynolds_number,
    viscosity_growth,
)
from lightflyer.gas.base import AbstractGas, mean_free_path

Direction = Literal["broadside", "edgewise"]  # How a body moves: along its axis or across it
BROADSIDE = 16.0  # Drag in slow flow over μ, radius and speed, broadside; [HappelBrenner1983] ch. 5
EDGEWISE = 32.0 / 3.0  # The same edgewise

_HOLES = Validity(
    "the share of dense gas that passes the holes",
    0.0,
    0.01,
    "the drag leaves it out and is too large",
)
_WARM = 0.1  # Relative excess above which a disk counts as warm
_HOT_DENSE = Validity(
    "the rarefaction at a warm disk",
    0.0,
    4.5,
    "the drag takes the resistance of cold gas, which was compared with the kinetic equation up "
    "to there only",
)
_EDGEWISE_SHARE = 2.5, 19.6
"""Share of the resistance of dense gas that is met edgewise, 1 − 2.5/(δ + 19.6): at δ = 0 what the
first collisions take (studies/drag/first_collisions.py), in dense gas the order of what slip along
the faces takes, which grows with ln δ/δ."""

_EDGEWISE = "edgewise drag between thin and dense gas is an estimate, within about 5 %"


@entry_point
def disk_drag(
    speed: Velocity,
    radius: Length,
    pressure: Pressure,
    temperature: Temperature,
    gas: AbstractGas,
    tac: tuple[Numeric, Numeric] = (1.0, 1.0),
    excess: tuple[Numeric, Numeric] = (0.0, 0.0),
    transmission: Numeric = 0.0,
) -> Array:
    """Drag of a thin disk that moves along its axis.

    Parameters
    ----------
    speed : array, shape (...)
        Relative to the gas, of either sign [m/s].
    radius : array, shape (...)
        [m].
    pressure, temperature : array, shape (...)
        Of the gas far away [Pa], [K].
    gas : AbstractGas
    tac : tuple of array, shape (...)
        Accommodation coefficients of both faces [1].
    excess : tuple of array, shape (...)
        Relative temperature excesses of both faces [1].
    transmission : array, shape (...)
        Share of the arriving molecules that pass holes, which are narrower than the mean free
        path [1].

    Returns
    -------
    array, broadcast shape
        Force against the motion, of the sign of the speed [N].

    Notes
    -----
    Differentiable, and odd in the speed. Within 0.1 % of the kinetic equation for a slow disk as
    warm as the gas. Two model equations, BGK and Shakhov, differ by 0.4 % there.

    Examples
    --------
    >>> from lightflyer.gas import AIR
    >>> print(f"{disk_drag(1.0, 0.01, 5.2, 220.0, AIR) * 1e6:.3f} µN")
    2.168 µN
    """
    speed_ratio = speed / molecular_speed(temperature, gas)
    delta = rarefaction_parameter(pressure, temperature, radius, gas)
    mean_tac, root_ratio = face_means(tac, excess)
    thin = (1.0 - transmission) * free_molecular.broadside_disk(speed_ratio, mean_tac, root_ratio)
    inertia = disk_inertia(reynolds_number(speed_ratio, delta))
    dense = BROADSIDE * inertia
    share = dense_share(delta, mean_tac, gas.molecules)
    return pressure * speed_ratio * _join(thin, dense, share * delta, radius)


@entry_point
def edgewise_disk_drag(
    speed: Velocity,
    radius: Length,
    pressure: Pressure,
    temperature: Temperature,
    gas: AbstractGas,
    tac: tuple[Numeric, Numeric] = (1.0, 1.0),
    excess: tuple[Numeric, Numeric] = (0.0, 0.0),
    transmission: Numeric = 0.0,
) -> Array:
    """Drag of a thin disk that moves in its own plane [N]."""
    # Exact for free molecules, with their first collisions, and in slow flow of dense gas. Between,
    # :math:`b = 1 - 2.5/(\delta + 19.6)` is an estimate, within about 5 %.
    speed_ratio = speed / molecular_speed(temperature, gas)
    delta = rarefaction_parameter(pressure, temperature, radius, gas)
    mean_tac, _ = face_means(tac, excess)
    thin = (1.0 - transmission) * free_molecular.edgewise_disk(mean_tac)
    inertia = edgewise_inertia(reynolds_number(speed_ratio, delta))
    growth = viscosity_growth(0.5 * (excess[0] + excess[1]), delta, temperature, gas)
    dense = EDGEWISE * inertia * growth
    constant, offset = _EDGEWISE_SHARE
    share = 1.0 - constant / (delta + offset)
    return pressure * speed_ratio * _join(thin, dense, share * delta, radius)


def face_means(
    tac: tuple[Numeric, Numeric], excess: tuple[Numeric, Numeric]
) -> tuple[Array, Array]:
    r"""Means over two faces: of the TAC, and of :math:`\alpha\sqrt{T_w/T}` over that of the TAC."""
    (first, second), (first_excess, second_excess) = tac, excess
    emitted = first * xp.sqrt(1.0 + first_excess) + second * xp.sqrt(1.0 + second_excess)
    return xp.asarray(0.5 * (first + second)), emitted / (first + second)


def _join(thin: Array, dense: Array, met: Array, radius: Numeric) -> Array:
    """Force over pressure and speed ratio of both resistances together [m²]."""
    return math.pi * radius**2 / (1.0 / thin + math.pi * met / dense)


def disk_diagnostics(
    speed: Numeric,
    radius: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    tac: tuple[Numeric, Numeric] = (1.0, 1.0),
    direction: Direction = "broadside",
    body_temperature: Numeric | None = None,
) -> Iterator[str]:
    """Where the drag of a disk is outside its range or an estimate, in words."""
    mean_tac = 0.5 * (np.asarray(tac[0]) + tac[1])
    around = pressure, temperature, gas
    body = temperature if body_temperature is None else body_temperature
    speed_ratio, reynolds, delta, growth = _looked_at(speed, radius, *around, body)
    yield from SLOW.diagnostics(np.where(delta > THIN, speed_ratio, 0.0), pressure)
    if direction == "edgewise":
        yield _EDGEWISE
        yield from WARMTH.diagnostics(growth, pressure)
    else:
        yield from DISK_REYNOLDS.diagnostics(reynolds, pressure)
        warm = np.abs(np.asarray(body) / temperature - 1.0) > _WARM
        yield from _HOT_DENSE.diagnostics(np.where(warm, delta, 0.0), pressure)
    yield from TAC_RANGE.diagnostics(mean_tac, pressure)


@entry_point
def _looked_at(
    speed: Numeric,
    radius: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    body_temperature: Numeric,
) -> tuple[Array, ...]:
    """Speed ratio, Reynolds number, rarefaction, growth of drag edgewise by warmth."""
    delta = rarefaction_parameter(pressure, temperature, radius, gas)
    speed_ratio = xp.abs(xp.asarray(speed)) / molecular_speed(temperature, gas)
    excess = xp.asarray(body_temperature) / temperature - 1.0
    growth = viscosity_growth(excess, delta, temperature, gas)
    return speed_ratio, reynolds_number(speed_ratio, delta), delta, growth


def wide_hole_diagnostics(
    hole_radius: Numeric,
    radius: Numeric,
    open_fraction: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
) -> Iterator[str]:
    r"""Where dense gas that passes the holes of a disk lowers its drag, in words."""
    # By Sampson's flow through the holes of one thin wall, dense gas passes at :math:`16\,\beta
    # a/(3\pi^2 r)` of the speed. Holes narrower than the mean free path are part of the drag
    # itself.
    path = mean_free_path(pressure, temperature, gas)
    wide = np.asarray(hole_radius) > path
    passing = BROADSIDE / (3.0 * math.pi**2) * np.asarray(open_fraction) * hole_radius / radius
    yield from _HOLES.diagnostics(np.where(wide, passing, 0.0), pressure)
