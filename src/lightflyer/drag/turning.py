r"""Torque on a thin disk that turns about a diameter.

The disk's parts move along the normal with :math:`\omega x`. In thin gas each meets the drag of
free molecules, which makes the torque that of the drag broadside with :math:`\langle x^2\rangle =
r^2/4`. In slow flow of dense gas it is :math:`\tfrac{32}{3}\mu r^3\omega` [HappelBrenner1983]_
ch. 5. Between them the resistances are added.
"""

import math

from lightflyer.array.namespace import Array, Numeric
from lightflyer.core.entry_point import entry_point
from lightflyer.drag import free_molecular
from lightflyer.drag.disk import face_means
from lightflyer.drag.similarity import molecular_speed
from lightflyer.gas.base import AbstractGas

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
