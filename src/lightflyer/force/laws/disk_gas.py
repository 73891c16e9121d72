r"""Gas around a thin disk whose faces differ, or that gas streams through, as plain functions.

Whether the faces are equally warm or one is as warm as the other is cold, heat reaches the gas far
away by conduction around the disk. In thin gas there is a force besides, because molecules leave
one face faster than the other. All take arrays that broadcast, and are differentiable.

Force of dense gas on a thin disk that gas streams through.

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

import math

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.transformations import stop_gradient
from lightflyer.core.validity import Validity
from lightflyer.force.laws.channels import GasAround

_PATH = 2.0 / math.sqrt(math.pi)  # length over the mean free path, per δ of the length
_CONDUCTION = 15.0 / (2.0 * math.sqrt(math.pi))
r"""Conduction from one face of a disk in endless gas, :math:`4\kappa\theta/(\pi a)` per area, over
what free molecules take and :math:`1/\delta`; :math:`\kappa = \frac{15}4 R\mu` (monatomic gas)."""
_COMMON_EXCESS, _COMMON_ONSET = 0.34, 1.6
"""Fitted to the kinetic solution of an isothermal disk in open space, its heat loss within 1 %."""
_DIFFERENCE_CONDUCTION = 0.5 * _CONDUCTION
r"""Conduction around an edge, :math:`\kappa\theta/(\pi d)` per area at the distance d from it, over
the same."""
_DIFFERENCE_FREE, _DIFFERENCE_ONSET = 6.9, 7.0
"""Fitted to the simulated disk without holes of [Schafer2025]_, from δ = 0.1 to 200 within 8 %."""
_RECOIL_SLOPE, _RECOIL_POWER = 0.25, 0.42
"""Fitted to the kinetic solution in open space to δ = 15 within 4 %; and from there to 200 to the
simulated disk without holes of [Schafer2025]_ times 0.82, by which the two differ before, within
15 %."""


def disk_surroundings(rarefaction: Numeric, internal: Numeric = 1.0) -> GasAround:
    r"""How gas around a thin disk takes heat from the gas near its faces."""
    # .. math::
    #     c_+ = \frac{15}{2\sqrt\pi\,\delta}\left[1 + \frac{0.34}{1 + \delta/1.6}\right], \qquad
    #     c_- = \frac1\delta\left[6.9 + \frac{15}{4\sqrt\pi}\ln\left(1 + \frac\delta7\right)\right]
    #
    # In dense gas conduction around the disk and around its edge; fitted to the package's solution
    # of the kinetic equation (:math:`c_+`) and to simulations of [Schafer2025]_ (:math:`c_-`).
    common = 1.0 + _COMMON_EXCESS / (1.0 + rarefaction / _COMMON_ONSET)
    edge = _DIFFERENCE_CONDUCTION * xp.log1p(rarefaction / _DIFFERENCE_ONSET)
    return GasAround(
        internal * _CONDUCTION * common / rarefaction,
        internal * (_DIFFERENCE_FREE + edge) / rarefaction,
    )


def recoil_ratio(rarefaction: Numeric, thickness: Numeric = 0.0) -> Array:
    r"""Force on a disk whose faces molecules leave unequally warm, over that to free molecules."""
    # .. math::
    #     \hat F = \frac1{1 + \tfrac14\,\delta\,(1 + \delta^{0.42})}
    #         \left(1 + \frac h\lambda\right)^{-1/2}
    #
    # A fit to the package's solution of the kinetic equation for faces of unequal TAC, :math:`\hat
    # F/\hat Q`: what leaves them differs by :math:`\Delta\alpha\,(\theta-\vartheta) =
    # \Delta\alpha\,\hat Q\,\theta` with the excess :math:`\vartheta` of the gas that comes.
    #
    # In dense gas it is what creep around the edge leaves. Around a sharp edge the temperature
    # changes within a mean free path :math:`\lambda`, around one of the height :math:`h` within
    # that. Creep is :math:`h/\lambda` times slower then. The traction of a disk on gas near the
    # edge goes as the inverse root of the distance, so that :math:`\sqrt{h/\lambda}` times more of
    # the creep counts. The second factor is that estimate.
    sharp = 1.0 + _RECOIL_SLOPE * rarefaction * (1.0 + rarefaction**_RECOIL_POWER)
    return 1.0 / (sharp * xp.sqrt(1.0 + _PATH * rarefaction * thickness))


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
        steepness = 1.0 + outside * _growth_of_force(reynolds, creeping)
        reynolds = reynolds - excess / stop_gradient(steepness)
    return reynolds / scale


def _growth_of_force(reynolds: Array, creeping: Numeric) -> Array:
    """Derivative of Re C by Re."""
    distance = xp.abs(reynolds)
    factor = _growth(reynolds)
    growing = factor - 0.5 * _LAYER * distance / (_ONSET + distance) ** 1.5
    coefficient = through_flow_coefficient(reynolds, creeping)
    return coefficient + distance**2 * factor * growing / coefficient
