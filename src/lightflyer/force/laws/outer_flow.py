r"""Force of dense gas on a thin disk that gas streams through.

A sandwich or a plate pumps gas from its top to its bottom at a velocity :math:`u`, the same
everywhere on the disk. Gas comes to the top from all sides, leaves the bottom as a jet, and pushes
the disk up with

.. math::
    F = C\,\mu\,a\,u, \qquad
    C = \sqrt{C_0^2 + (g\,\mathrm{Re})^2}, \qquad
    g = g_\infty + \frac{g_1}{\sqrt{g_2 + \mathrm{Re}}}, \qquad
    \mathrm{Re} = \frac{\rho\,a\,u}{\mu}

:math:`C_0 = 16` is exact: in creeping flow the gas moves as if the disk, without holes, moved
through it face on. The rest is fitted to solutions of the Navier–Stokes equations
(``studies/outer_flow``).
"""

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.transformations import stop_gradient
from lightflyer.core.validity import Validity

CREEPING = 16.0
"""Force on a disk in creeping flow, face on, over μ, radius and velocity; [HappelBrenner1983]."""

_JET, _LAYER, _ONSET = 2.21, 6.57, 5.12  # g∞, g1, g2, fitted in studies/outer_flow
_LINEAR = 2.6  # growth of the coefficient with the Reynolds number, to start from
_STEPS = 5

FLOW_RANGE = Validity(
    "the Reynolds number of the flow through the disk",
    0.0,
    1000.0,
    "the force of the flow is extrapolated",
)
"""Where the force is fitted."""


def through_flow_coefficient(reynolds: Numeric, creeping: Numeric = CREEPING) -> Array:
    r"""Force on a thin disk that gas streams through, over :math:`\mu a u` [1]."""
    return xp.sqrt(creeping**2 + (_growth(reynolds) * reynolds) ** 2)


def _growth(reynolds: Numeric) -> Array:
    return _JET + _LAYER / xp.sqrt(_ONSET + xp.abs(reynolds))


def through_flow_force(
    radius: Numeric,
    velocity: Numeric,
    density: Numeric,
    viscosity: Numeric,
    creeping: Numeric = CREEPING,
) -> Array:
    """Force of dense gas on a thin disk that it streams through [N]; upward positive."""
    reynolds = density * radius * velocity / viscosity
    return through_flow_coefficient(reynolds, creeping) * viscosity * radius * velocity


def pumped_velocity(
    conductance: Numeric,
    stopping_pressure: Numeric,
    *,
    radius: Numeric,
    density: Numeric,
    viscosity: Numeric,
    creeping: Numeric = CREEPING,
) -> Array:
    r"""Velocity at which a disk pumps gas that flows back around it to the other side [m/s]."""
    # .. math:: u = G\left(\Delta p_0 - \frac{F(u)}{\pi a^2}\right)
    #
    # Exact to rounding for any resistance of wall and gas. First derivatives are exact.
    scale = density * radius / viscosity
    free = scale * conductance * stopping_pressure  # Reynolds number without resistance outside
    outside = conductance * viscosity / (np.pi * radius)

    # between creeping flow and a jet, the root of a quadratic equation
    slope = 1.0 + outside * creeping
    root = xp.sqrt(slope**2 + 4.0 * outside * _LINEAR * xp.abs(free))
    reynolds = 2.0 * free / (slope + root)
    for _ in range(_STEPS):
        # Newton; the last step alone carries the derivatives
        reynolds = stop_gradient(reynolds)
        coefficient = through_flow_coefficient(reynolds, creeping)
        excess = reynolds * (1.0 + outside * coefficient) - free
        # derivative of Re C by Re
        distance, factor = xp.abs(reynolds), _growth(reynolds)
        growing = factor - 0.5 * _LAYER * distance / (_ONSET + distance) ** 1.5
        steepness = 1.0 + outside * (coefficient + distance**2 * factor * growing / coefficient)
        reynolds = reynolds - excess / stop_gradient(steepness)
    return reynolds / scale
