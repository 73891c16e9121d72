r"""Numbers on which drag depends, and what the inertia of dense gas adds to that of slow flow.

What the inertia of dense gas adds to the drag of slow flow, as factors of the Reynolds number.

:math:`\mathrm{Re} = \rho\,U\,d/\mu` with the diameter :math:`d`. All factors are one at zero and
have a continuous slope.
"""

import math

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.validity import Validity
from lightflyer.gas.base import AbstractGas

SLOW = Validity(
    "the speed over that of molecules, in gas where these collide,",
    0.0,
    0.3,
    "compression of the gas, which the drag leaves out, matters there",
)
"""Range of the speed ratio where gas is not thin: a Mach number of 0.36 in air."""

THIN = 0.1  # Rarefaction up to which collisions take less than 6 % of the drag at any speed

WARMTH = Validity(
    "the growth of the drag of dense gas by the flyer's warmth",
    0.9,
    1.1,
    "that is an estimate, within a third of the growth",
)
"""Where the effect of a warm flyer counts."""

_FILM_SHARE = 0.5  # studies/drag/hot_sphere.py: 0.48 to 0.60 for T_w/T from 0.8 to 2.5
_HALF_GROWN = 80.0
"""Rarefaction at which the viscosity has half of its growth in dense gas: by a disk broadside
(studies/drag/hot_disk.py), 2 % at a rarefaction of 4.4 and 3 % at 8.9 for T_w/T = 1.6. In thinner
gas slip at the hot wall takes the rest away."""


def molecular_speed(temperature: Numeric, gas: AbstractGas) -> Array:
    r"""Most probable speed of molecules, :math:`\sqrt{2RT}` [m/s]."""
    return xp.sqrt(2.0 * gas.specific_gas_constant * xp.asarray(temperature))


def rarefaction_parameter(
    pressure: Numeric, temperature: Numeric, radius: Numeric, gas: AbstractGas
) -> Array:
    r"""Rarefaction parameter, :math:`\delta = p\,r/(\mu\sqrt{2RT}) = \sqrt\pi/(4\,\mathrm{Kn})`."""
    return pressure * radius / (gas.viscosity(temperature) * molecular_speed(temperature, gas))


def reynolds_number(speed_ratio: Numeric, rarefaction: Numeric) -> Array:
    r"""Reynolds number by the diameter, :math:`2\rho\,|U|\,r/\mu = 4\,|s|\,\delta` [1]."""
    return 4.0 * xp.abs(xp.asarray(speed_ratio)) * rarefaction


def viscosity_growth(
    excess: Numeric, rarefaction: Numeric, temperature: Numeric, gas: AbstractGas
) -> Array:
    r"""Growth of the drag of dense gas by the warmth of the body [1]."""
    # .. math:: \frac{\mu(T + 0.5\,w\,\theta\,T)}{\mu(T)}, \qquad w = \frac\delta{\delta + 80}
    #
    # Slow flow of gas of the density :math:`1/T` around a sphere of any temperature, with the
    # stress of uneven temperature, has the drag of gas of the mean temperature within 2 % for
    # :math:`T_w/T` from 0.8 to 2.5 (``studies/drag/hot_sphere.py``).
    grown = rarefaction / (rarefaction + _HALF_GROWN)
    film = temperature * (1.0 + _FILM_SHARE * grown * excess)
    return gas.viscosity(film) / gas.viscosity(temperature)


_LN_10 = math.log(10.0)

# [Clift1978] ch. 6: the drag of a thin disk, broadside, over that of slow flow
_DISK_LOW = (-0.883, 0.906, -0.025)  # of log10 of the increase, in log10 Re; 0.01 to 1.5
_DISK_MIDDLE = (0.138, 0.792)  # factor and exponent of the increase; 1.5 to 133
_DISK_HIGH = 1.17  # drag coefficient beyond
_DISK_JOINTS = (math.log(1.5), math.log(133.0))
_OSEEN_FROM = math.log(0.01)
_OSEEN_DISK = 1.0 / (2.0 * math.pi)  # increase over Re: F/(16 π µ r U) · Re/2, F = 16 µ r U
_OSEEN_EDGEWISE = _OSEEN_DISK * 2.0 / 3.0  # it goes with the drag of slow flow
# of both faces, 2 · 0.664 √(ρµU³) ∫√chord dy, over 32/3 µ r U √Re
_LAYERS = 2.0 * 0.664 * math.sqrt(math.pi) * math.gamma(1.25) / math.gamma(1.75) * 3.0 / 32.0
_DISK_SLOW = 64.0 / math.pi  # C_D Re of a disk in slow flow
_SMALLEST = 1e-100  # Reynolds number of a body at rest
_JOINT_WIDTH = 0.4  # of ln Re, to each side, over which two laws are joined

# [Clift1978] ch. 5, after Clift and Gauvin
_SPHERE_LOW = (0.15, 0.687)
_SPHERE_HIGH = (0.42, 42500.0, -1.16)
_SPHERE_SLOW = 24.0  # C_D Re of a sphere in slow flow

DISK_REYNOLDS = Validity(
    "the Reynolds number of the fall, by the diameter",
    0.0,
    1000.0,
    "a disk flutters or tumbles there; the drag coefficient of steady fall is held at 1.17",
)
SPHERE_REYNOLDS = Validity(
    "the Reynolds number, by the diameter",
    0.0,
    3e5,
    "the boundary layer becomes turbulent there and the drag is less",
)


@entry_point
def disk_inertia(reynolds: Numeric) -> Array:
    """Drag of a thin disk, broadside, over that of slow flow [1]."""
    # Oseen's :math:`1 + \mathrm{Re}/2\pi` up to Re = 0.01, then
    #
    # .. math::
    #     1 + 10^{-0.883 + 0.906\lg\mathrm{Re} - 0.025(\lg\mathrm{Re})^2}, \quad
    #     1 + 0.138\,\mathrm{Re}^{0.792} \ (\mathrm{Re} > 1.5), \quad
    #     C_D = 1.17 \ (\mathrm{Re} > 133)
    #
    # joined with a continuous slope.
    #
    # Source: [Clift1978]_ ch. 6; [HappelBrenner1983]_ ch. 7-6 for Oseen's term.
    given = xp.asarray(reynolds)
    reynolds, moving = _positive(given)
    position = xp.log(reynolds)
    decimal = position / _LN_10
    constant, first, second = _DISK_LOW
    low = _LN_10 * (constant + decimal * (first + decimal * second))
    scale, exponent = _DISK_MIDDLE
    middle = math.log(scale) + exponent * position
    factor = _DISK_HIGH / _DISK_SLOW * reynolds
    fast = factor > 2.0  # the drag coefficient alone says nothing of slow flow
    high = xp.log(xp.where(fast, factor, 2.0) - 1.0)
    increase = math.log(_OSEEN_DISK) + position
    for joint, law in zip((_OSEEN_FROM, *_DISK_JOINTS), (low, middle, high), strict=True):
        # from 0 to 1 about a joint, with a continuous slope
        along = xp.clip(0.5 + 0.5 * (position - joint) / _JOINT_WIDTH, 0.0, 1.0)
        increase = increase + along * along * (3.0 - 2.0 * along) * (law - increase)
    return 1.0 + xp.where(moving, xp.exp(increase), _OSEEN_DISK * given)


@entry_point
def edgewise_inertia(reynolds: Numeric) -> Array:
    """Drag of a thin disk that moves in its own plane over that of slow flow [1]."""
    # .. math:: 1 + \frac{a\,\mathrm{Re}}{1 + (a/c)\sqrt{\mathrm{Re}}}
    #
    # Oseen's :math:`a = 1/3\pi` at small Re, and the laminar boundary layers of both faces, strip
    # by strip, :math:`c\sqrt{\mathrm{Re}}` at large Re.
    #
    # Source: [HappelBrenner1983]_ ch. 7-6; [Schlichting2017]_ ch. 6 for the boundary layer.
    given = xp.asarray(reynolds)
    reynolds, moving = _positive(given)
    slow = 1.0 + _OSEEN_EDGEWISE / _LAYERS * xp.sqrt(reynolds)
    return 1.0 + _OSEEN_EDGEWISE * given / xp.where(moving, slow, 1.0)


@entry_point
def sphere_inertia(reynolds: Numeric) -> Array:
    """Drag of a sphere over that of slow flow [1]; within 6 % of measurements up to Re = 3e5."""
    # .. math::
    #     1 + 0.15\,\mathrm{Re}^{0.687}
    #     + \frac{0.0175\,\mathrm{Re}}{1 + 42500\,\mathrm{Re}^{-1.16}}
    #
    # Source: [Clift1978]_ ch. 5.
    reynolds, moving = _positive(reynolds)
    factor, exponent = _SPHERE_LOW
    high, scale, power = _SPHERE_HIGH
    low = factor * reynolds**exponent
    fast = high / _SPHERE_SLOW * reynolds / (1.0 + scale * reynolds**power)
    return 1.0 + xp.where(moving, low + fast, 0.0)


def _positive(reynolds: Numeric) -> tuple[Array, Array]:
    """The number where it is positive, one elsewhere, and where that is."""
    reynolds = xp.asarray(reynolds)
    moving = reynolds > _SMALLEST
    return xp.where(moving, reynolds, 1.0), moving
