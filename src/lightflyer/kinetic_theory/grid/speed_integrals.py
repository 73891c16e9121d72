r"""Speed integrals of the kinetic equation along a ray.

.. math:: J_p(z) = \int_0^\infty c^p \exp(-c^2 - z/c)\,dc

They are the Abramowitz functions for p from 1 to 8, tabulated as cubic splines in :math:`\sqrt z`.
In this variable the logarithmic terms at zero have three continuous derivatives, and the decay at
large z is slow.
"""

from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

LOWEST_POWER = 1
HIGHEST_POWER = 8
NUMBER = HIGHEST_POWER - LOWEST_POWER + 1

LARGEST_DEPTH = 60.0  # Optical depth beyond which rays end: J₁(60) is 2e-12 of J₁(0)

_INTERVALS = 2400
_LOGARITHM_OF_SPEED = np.linspace(-14.0, 2.2, 900)


def speed_integral(power: int, depth: np.ndarray) -> np.ndarray:
    r"""Speed integral by the trapezoidal rule in ln c, which converges exponentially."""
    speed = np.exp(_LOGARITHM_OF_SPEED)
    weight = speed ** (power + 1) * np.exp(-(speed**2))
    step = _LOGARITHM_OF_SPEED[1] - _LOGARITHM_OF_SPEED[0]
    return np.exp(-np.asarray(depth)[..., None] / speed) @ weight * step


@lru_cache
def spline_table(highest_power: int = HIGHEST_POWER) -> tuple[np.ndarray, float]:
    """Spline coefficients for the compiled kernels."""
    root = np.linspace(0.0, np.sqrt(LARGEST_DEPTH) * 1.001, _INTERVALS + 1)
    depth = root**2
    columns = [
        CubicSpline(root, speed_integral(p, depth)).c
        for p in range(LOWEST_POWER, highest_power + 1)
    ]
    table = np.ascontiguousarray(np.transpose(np.stack(columns), (2, 1, 0)))
    return table, float(_INTERVALS / root[-1])
