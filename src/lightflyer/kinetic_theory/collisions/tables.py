r"""Speed integrals along a ray of molecules whose collision frequency depends on their speed.

.. math::
    J_p(s) = \int_0^\infty c^p\,\nu^2\,e^{-c^2-\nu s/c}\,dc, \qquad
    I_p(s) = \int_0^\infty c^p\,\nu\,e^{-c^2-\nu s/c}\,dc, \qquad
    \frac{dI_{p+1}}{ds} = -J_p

with ν(c) in units of p/μ and s in those of its mean free path. They are tabulated as cubic splines
in :math:`\sqrt s`, as the integrals of the model equation are.
"""

import numpy as np
from scipy.interpolate import CubicSpline

from lightflyer.kinetic_theory.collisions.operator import CollisionOperator
from lightflyer.kinetic_theory.grid.speed_integrals import LARGEST_DEPTH

_INTERVALS = 1200
_LOGARITHM_OF_SPEED = np.linspace(-14.0, 2.0, 700)


def ray_table(operator: CollisionOperator, highest: int) -> tuple[np.ndarray, float]:
    """Spline coefficients of both integrals; returns ``coefficients``, ``intervals_per_unit``."""
    root = np.linspace(0.0, np.sqrt(LARGEST_DEPTH) * 1.001, _INTERVALS + 1)
    speed = np.exp(_LOGARITHM_OF_SPEED)
    frequency = operator.frequency(speed)
    step = _LOGARITHM_OF_SPEED[1] - _LOGARITHM_OF_SPEED[0]
    left = np.exp(-np.square(root)[:, None] * frequency / speed)
    weight = step * frequency * np.exp(-np.square(speed))
    powers = speed[:, None] ** (np.arange(highest + 1) + 1)
    squared = left @ (powers * (weight * frequency)[:, None])
    simple = left @ (powers * weight[:, None])
    splines = CubicSpline(root, np.concatenate([squared, simple], axis=1))
    # SciPy's order is power, interval, integral
    table = np.ascontiguousarray(np.transpose(splines.c, (1, 0, 2)))
    return table, float(_INTERVALS / root[-1])
