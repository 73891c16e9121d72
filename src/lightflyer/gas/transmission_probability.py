"""Free molecules that pass channels and holes."""

from typing import NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point


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
