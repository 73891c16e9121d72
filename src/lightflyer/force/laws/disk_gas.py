r"""Gas around a thin disk in open space whose two faces differ, as functions of plain numbers.

Whether the faces are equally warm or one is as warm as the other is cold, heat reaches the gas far
away by conduction around the disk. In thin gas there is a force besides, because molecules leave
one face faster than the other. All take arrays that broadcast, and are differentiable.
"""

import math

from lightflyer.array.namespace import Array, Numeric, xp
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
