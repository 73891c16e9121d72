r"""Drag of a thin disk in gas of any density, broadside and edgewise.

The drag coefficient of thin gas, :math:`G = F/(pAs)`, falls from that of free molecules to that of
dense gas. The two resistances are added, the latter with a share :math:`b` that is one in dense
gas:

.. math::
    \frac1G = \frac{1}{G_\mathrm{fm}(s)}
        + b(\delta)\,\frac{\pi\delta}{16\,\Phi(\mathrm{Re})}
"""

import math
from typing import Literal

import jax.numpy as jnp
from jax import Array

from lightflyer.drag import free_molecular
from lightflyer.drag.inertia import disk_inertia
from lightflyer.drag.similarity import molecular_speed, rarefaction, reynolds_number
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.base import AbstractGas

Direction = Literal["broadside", "edgewise"]
"""How a body moves: along its axis or across it."""

BROADSIDE = 16.0
"""Drag in slow flow over μ, radius and speed, broadside; [HappelBrenner1983] ch. 5."""

EDGEWISE = 32.0 / 3.0
"""The same edgewise."""


@entry_point
def disk_drag(
    speed: Numeric,
    radius: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    tac: tuple[Numeric, Numeric] = (1.0, 1.0),
    excess: tuple[Numeric, Numeric] = (0.0, 0.0),
    transmission: Numeric = 0.0,
) -> Array:
    """Drag of a thin disk that moves along its axis."""
    speed_ratio = speed / molecular_speed(temperature, gas)
    delta = rarefaction(pressure, temperature, radius, gas)
    thin = free_molecular.broadside_disk(speed_ratio, *face_means(tac, excess))
    dense = BROADSIDE / (math.pi * delta) * disk_inertia(reynolds_number(speed_ratio, delta))
    resistance = 1.0 / ((1.0 - transmission) * thin) + 1.0 / dense
    return pressure * math.pi * radius**2 * speed_ratio / resistance


@entry_point
def edgewise_disk_drag(
    speed: Numeric,
    radius: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    tac: tuple[Numeric, Numeric] = (1.0, 1.0),
    solid: Numeric = 1.0,
) -> Array:
    """Drag of a thin disk that moves in its own plane."""
    speed_ratio = speed / molecular_speed(temperature, gas)
    delta = rarefaction(pressure, temperature, radius, gas)
    thin = solid * free_molecular.edgewise_disk(0.5 * (tac[0] + tac[1]))
    dense = EDGEWISE / (math.pi * delta) * disk_inertia(reynolds_number(speed_ratio, delta))
    return pressure * math.pi * radius**2 * speed_ratio / (1.0 / thin + 1.0 / dense)


def face_means(
    tac: tuple[Numeric, Numeric], excess: tuple[Numeric, Numeric]
) -> tuple[Array, Array]:
    r"""Mean TAC of two faces, and mean of :math:`\alpha\sqrt{T_w/T}` over it [1]."""
    emitted = sum(
        jnp.asarray(one) * jnp.sqrt(1.0 + theta) for one, theta in zip(tac, excess, strict=True)
    )
    both = jnp.asarray(tac[0]) + tac[1]
    return 0.5 * both, emitted / both
