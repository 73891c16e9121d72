r"""Drag of a thin disk in gas of any density, broadside and edgewise, and its torque as it turns.

Drag is written as that of thin gas, :math:`F = G\,p\,A\,s` with the speed ratio
:math:`s = U/\sqrt{2RT}`. The resistances of free molecules and of dense gas are added:

.. math::
    \frac1G = \frac{1}{(1-t)\,G_\mathrm{fm}(s)}
        + \frac{b(\delta)}{G_\mathrm{d}}, \qquad
    G_\mathrm{d} = \frac{16}{\pi\,\delta}\,\Phi(\mathrm{Re})

:math:`b` is what the kinetic equation says of a slow disk, one in dense gas. :math:`\Phi` is the
inertia of dense gas (:mod:`lightflyer.drag.similarity`), and :math:`t` the share of the arriving
molecules that pass holes of the disk. Both limits are exact.

The warmth of a disk makes the resistance of free molecules smaller and leaves that of dense gas as
it is: so says the kinetic equation (studies/drag/hot_disk.py). Edgewise, where it was not solved,
the resistance of dense gas grows too (:func:`~lightflyer.drag.similarity.viscosity_growth`).

What the kinetic equation says of the drag of a slow disk between thin and dense gas.

The table has the drag coefficient :math:`G` over rarefaction and TAC. What is interpolated is the
share :math:`b` of the resistance of dense gas that is left,

.. math:: \frac1G = \frac1{G_\mathrm{fm}} + b\,\frac{\pi\delta}{16},

as :math:`(1-b)(\delta+1.5)`, which hardly varies and is constant in both limits. So :math:`b` goes
to one in dense gas, and its term to zero in thin gas, beyond the table as well.

Torque on a thin disk that turns about a diameter.

The disk's parts move along the normal with :math:`\omega x`. In thin gas each meets the drag of
free molecules, which makes the torque that of the drag broadside with :math:`\langle x^2\rangle =
r^2/4`. In slow flow of dense gas it is :math:`\tfrac{32}{3}\mu r^3\omega` [HappelBrenner1983]_
ch. 5. Between them the resistances are added.
"""

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric, by_numpy, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Length, Pressure, Temperature, Velocity
from lightflyer.core.validity import Validity
from lightflyer.drag import free_molecular
from lightflyer.drag.similarity import (
    DISK_REYNOLDS,
    SLOW,
    THIN,
    WARMTH,
    disk_inertia,
    edgewise_inertia,
    molecular_speed,
    rarefaction_parameter,
    reynolds_number,
    viscosity_growth,
)
from lightflyer.files.table import shipped_table
from lightflyer.gas.base import AbstractGas, mean_free_path
from lightflyer.numerics.interpolation import Curves

_OFFSET = 1.5  # any of the size of the rarefaction at which both resistances are alike

TAC_RANGE = Validity(
    "the mean TAC of the faces",
    0.2,
    1.0,
    "its effect on the drag between thin and dense gas is held at the end",
)
"""Of the table."""


def dense_share(rarefaction: Numeric, tac: Numeric, molecules: str) -> Array:
    """Share of the resistance of dense gas that a slow disk meets, broadside [1]."""
    kind = "monatomic" if molecules == "monatomic" else "diatomic"
    nodes, curves = _curves(kind)
    tac = xp.clip(tac, nodes[0], nodes[-1])
    reduced: Array = xp.zeros(())
    for node, value in zip(nodes, curves(xp.log(rarefaction)), strict=True):
        others = [other for other in nodes if other != node]
        weight = math.prod((tac - other) / (node - other) for other in others)
        reduced = reduced + weight * value
    return 1.0 - reduced / (rarefaction + _OFFSET)


@lru_cache
def _curves(kind: str) -> tuple[tuple[float, ...], Curves]:
    """TACs of the table, and the reduced share over ln δ for each."""
    table = shipped_table("drag_disk.csv")
    of_kind = np.array(table.texts["gas"]) == kind
    columns = {name: values[of_kind] for name, values in table.numbers.items()}
    nodes = tuple(float(tac) for tac in np.unique(columns["tac"]))
    delta = np.unique(columns["rarefaction"])
    reduced = []
    for tac in nodes:
        with by_numpy():  # also while another function is traced
            free = float(free_molecular.broadside_disk(0.0, tac, 1.0))
        drag = columns["drag"][columns["tac"] == tac]
        share = (1.0 / drag - 1.0 / free) * 16.0 / (math.pi * delta)
        reduced.append((1.0 - share) * (delta + _OFFSET))
    return nodes, Curves.through(np.log(delta), np.stack(reduced, axis=1))


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


TURNING = 32.0 / 3.0  # Torque in slow flow over μ, the cube of the radius and the rate

MEAN_SQUARE = 0.25
"""Mean square distance of a disk's parts from a diameter, over the square of its radius."""

TURNING_DIAGNOSTIC = (
    "damping of turning adds the resistances of thin and of dense gas: within about 10 %"
)
"""As adding those broadside gives up to 9 % too little drag."""


@entry_point
def turning_disk_torque(
    rate: Numeric,
    radius: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    tac: tuple[Numeric, Numeric] = (1.0, 1.0),
    excess: tuple[Numeric, Numeric] = (0.0, 0.0),
    transmission: Numeric = 0.0,
) -> Array:
    """Torque on a thin disk that turns slowly about a diameter [N m]; ``rate`` [rad/s]."""
    # For :math:`\omega r` well below the speed of sound, and Reynolds numbers below 1. Both limits
    # are exact. The warmth of the disk counts in thin gas only. Differentiable.
    speed = molecular_speed(temperature, gas)
    mean_tac, root_ratio = face_means(tac, excess)
    thin = (1.0 - transmission) * free_molecular.broadside_disk(0.0, mean_tac, root_ratio)
    in_thin = thin * pressure / speed * math.pi * radius**2 * MEAN_SQUARE * radius**2
    in_dense = TURNING * gas.viscosity(temperature) * radius**3
    return rate / (1.0 / in_thin + 1.0 / in_dense)
