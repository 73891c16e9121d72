"""What molecules do one by one: how soon they turn as they fly, and how many pass channels."""

import math
from typing import NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Temperature

_FIRST, _SECOND = 0.5 * math.pi**1.5, math.pi + 0.25 * math.pi**2  # [Parker1959]


class Parker(NamedTuple):
    r"""Rotational collision number of a diatomic gas by Parker's formula.

    .. math::
        Z_P = \frac{Z_\infty}{1 + \frac{\pi^{3/2}}2\sqrt{\frac{T^*}T}
            + \left(\pi + \frac{\pi^2}4\right)\frac{T^*}T}

    It counts collisions at the rate :math:`\frac4\pi\frac p\mu`, so that the relaxation time is
    :math:`\tau = \frac\pi4 Z_P\,\frac\mu p`.

    References
    ----------
    [Parker1959]_
    """

    limit: float  #: :math:`Z_\infty`, in hot gas [1]
    temperature: float  #: :math:`T^*`, depth of the molecules' attraction [K]

    @entry_point
    def __call__(self, temperature: Temperature) -> Array:
        """Collision number [1] at temperatures [K]."""
        ratio = self.temperature / xp.asarray(temperature)
        return self.limit / (1.0 + _FIRST * xp.sqrt(ratio) + _SECOND * ratio)


NITROGEN_ROTATION = Parker(18.1, 91.5)
"""Nitrogen; [LordiMates1970]_, as in the data files of SPARTA [Plimpton2019]_."""

OXYGEN_ROTATION = Parker(16.5, 113.5)
"""Oxygen, likewise."""

COLLISION_RATE = 4.0 / math.pi
"""Rate at which Parker's number counts collisions [p/μ]; [LordiMates1970]_."""


@entry_point
def vhs_collision_rate(viscosity_exponent: Numeric) -> Array:
    r"""Collisions of one variable hard sphere per time, in units of :math:`p/\mu`.

    .. math:: \nu\frac\mu p = \frac{30}{(7-2\omega)(5-2\omega)}

    Parameters
    ----------
    viscosity_exponent : array, shape (...)
        :math:`\omega` of :math:`\mu\propto T^\omega` [1].

    Returns
    -------
    array, shape (...)
        [1]; 1.25 for hard spheres.

    References
    ----------
    [Bird1994]_ Eq. (4.65).
    """
    doubled = 2.0 * xp.asarray(viscosity_exponent)
    return 30.0 / ((7.0 - doubled) * (5.0 - doubled))


class Transmission(NamedTuple):
    """Shares of the molecules that enter a channel."""

    through: Array  # That leave by the other end, and by the same; together one
    back: Array


@entry_point
def slot_transmission(length: Numeric) -> Transmission:
    r"""Share of free molecules that pass a slot with diffuse walls."""
    # .. math::
    #     W = \frac{1 + s - l}{2} - \frac{\tfrac32\,(l - \operatorname{arsinh} l)^2}
    #         {l^3 + 3l^2 + 4 - (l^2 + 4)\,s}, \qquad s = \sqrt{1 + l^2}
    #
    # Source: [Berman1965]_; within 0.4 % of Clausing's integral equation for lengths up to 50.
    root = xp.sqrt(1.0 + length**2)
    excess = length**2 / (root + 1.0)  # root − 1
    # shorter than this the second term is below the last digit of the first
    short = xp.asarray(length) < 1e-4
    safe = xp.where(short, 1.0, length)
    root_safe = xp.sqrt(1.0 + safe**2)
    collided = 1.5 * (safe - xp.arcsinh(safe)) ** 2
    collided = collided / (safe**3 + 3.0 * safe**2 + 4.0 - (safe**2 + 4.0) * root_safe)
    collided = xp.where(short, 0.0, collided)
    return Transmission(
        0.5 * (1.0 + 1.0 / (root + length)) - collided, 0.5 * (length - excess) + collided
    )


@entry_point
def coaxial_share(length: Numeric) -> Array:
    r"""Share of diffuse straight paths out of a disc that meet an equal one opposite [1]."""
    # .. math:: 1 + l^2/2 - l\sqrt{1 + l^2/4}
    #
    # Source: [HowellMenguc2020]_: coaxial discs.
    half = 0.5 * length
    return 1.0 / (xp.sqrt(1.0 + half**2) + half) ** 2  # without cancellation
