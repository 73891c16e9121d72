r"""Gas around a thin disk in open space whose two faces differ, as functions of plain numbers.

Whether the faces are equally warm or one is as warm as the other is cold, heat reaches the gas far
away by conduction around the disk. In thin gas there is a force besides, because molecules leave
one face faster than the other. All take arrays that broadcast, and are differentiable.
"""

import math

import jax.numpy as jnp
from jax import Array

from lightflyer.force.channels import Surroundings
from lightflyer.force.kinetic_table import KineticFit, kinetic_fit
from lightflyer.foundation.types import Numeric

_HALF_DIAMETER = 0.25 * math.sqrt(math.pi)  # Knudsen number of the diameter, times δ of the radius

_DIFFERENCE_CONDUCTION = 15.0 / (4.0 * math.sqrt(math.pi))
r"""Conduction around an edge, :math:`\kappa\theta/(\pi d)` per area at the distance d from it, over
what free molecules take; :math:`\kappa = \frac{15}4 R\mu` of a monatomic gas."""
_DIFFERENCE_FREE, _DIFFERENCE_ONSET = 6.9, 7.0
"""Fitted to the simulated disk without holes of [Schafer2025]_, from δ = 0.1 to 200 within 6 %."""
_RECOIL_SLOPE, _RECOIL_POWER = 0.25, 0.43
"""Fitted to the kinetic solution in open space to δ = 15 within 3 %; and from there to 200 to the
simulated disk without holes of [Schafer2025]_ times 0.82, by which the two differ before, within
15 %."""


def disk_surroundings(rarefaction: Numeric, internal: Numeric = 1.0) -> Surroundings:
    r"""How gas around a thin disk takes heat from the gas near its faces.

    .. math::
        c_+ = \frac{\hat Q}{1 - \hat Q}, \qquad
        c_- = \frac1\delta\left[6.9 + \frac{15}{4\sqrt\pi}\ln\left(1 + \frac\delta7\right)\right]

    Parameters
    ----------
    rarefaction : array, shape (...)
        :math:`\delta = pa/(\mu v)` of the radius; positive [1].
    internal : array, shape (...)
        What the molecules' internal motion adds to conduction, over what it adds to the heat of
        free molecules [1]; 1 for a monatomic gas.

    Returns
    -------
    Surroundings

    Notes
    -----
    :math:`\hat Q` is the heat loss of an isothermal disk over that of free molecules, from the
    package's solution of the kinetic equation in open space.
    """
    heat = _fit().heat_ratio(_HALF_DIAMETER / rarefaction, 1.0, 1.0)
    edge = _DIFFERENCE_CONDUCTION * jnp.log1p(rarefaction / _DIFFERENCE_ONSET)
    return Surroundings(
        internal * heat / (1.0 - heat), internal * (_DIFFERENCE_FREE + edge) / rarefaction
    )


def recoil_ratio(rarefaction: Numeric) -> Array:
    r"""Force on a disk whose faces molecules leave unequally warm, over that to free molecules.

    .. math:: \hat F = \left[1 + \tfrac14\,\delta\,(1 + \delta^{0.43})\right]^{-1}

    Parameters
    ----------
    rarefaction : array, shape (...)
        :math:`\delta` of the radius; positive [1].

    Returns
    -------
    array, shape (...)
        [1].

    Notes
    -----
    A fit to the package's solution of the kinetic equation for faces of unequal TAC,
    :math:`\hat F/\hat Q`: what leaves them differs by
    :math:`\Delta\alpha\,(\theta-\vartheta) = \Delta\alpha\,\hat Q\,\theta` with the excess
    :math:`\vartheta` of the gas that comes. In dense gas, where it is what creep around the edge
    leaves, it is little known.
    """
    return 1.0 / (1.0 + _RECOIL_SLOPE * rarefaction * (1.0 + rarefaction**_RECOIL_POWER))


def _fit() -> KineticFit:
    # the rarefaction carries it over to other gases
    return kinetic_fit("monatomic")
