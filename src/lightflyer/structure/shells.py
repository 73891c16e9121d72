"""Thin shells under pressure from outside."""

import math

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.structure.laminate import Stiffness

SPHERE_KNOCK_DOWN = (
    0.14  # share of the classical pressure that built spheres withstand [NASA-SP-8032]
)
CYLINDER_KNOCK_DOWN = 0.75  # and cylinders under lateral pressure [NASA-SP-8007]
_RING = 3.0  # of a ring, or the free end of a tube: p = 3 D/R³ [TimoshenkoGere1961]
_CYLINDER = math.pi * math.sqrt(6.0) / 9.0 * 12.0**0.75


@entry_point
def sphere_buckling_pressure(
    radius: Numeric, stiffness: Stiffness, knock_down: Numeric = SPHERE_KNOCK_DOWN
) -> Array:
    r"""Pressure at which a thin sphere buckles [Pa]."""
    # .. math:: p = \gamma\,\frac{4\sqrt{D\,Et}}{R^2}
    #
    # which is 2Et²/(R²√(3(1-ν²))) of one layer. Source: [NASA-SP-8032]_
    rigid = xp.sqrt(stiffness.plate * stiffness.membrane)
    return knock_down * 4.0 * rigid / xp.asarray(radius) ** 2


@entry_point
def cylinder_buckling_pressure(
    radius: Numeric,
    length: Numeric,
    stiffness: Stiffness,
    knock_down: Numeric = CYLINDER_KNOCK_DOWN,
) -> Array:
    r"""Lateral pressure at which a thin cylinder, held round at its ends, buckles [Pa]."""
    # .. math:: p = \gamma\,5.51\,\frac{D^{3/4}(Et)^{1/4}}{L\,R^{3/2}}
    #
    # of moderate length. Source: [NASA-SP-8007]_
    rigid = stiffness.plate**0.75 * stiffness.membrane**0.25
    return knock_down * _CYLINDER * rigid / (length * xp.asarray(radius) ** 1.5)


@entry_point
def rim_buckling_pressure(radius: Numeric, opening: Numeric, plate: Numeric) -> Array:
    """Pressure at which a shell buckles around an opening with a free rim [Pa]; an estimate.

    ``radius``: of the shell, ``opening``: of the opening [m]; ``plate``: bending stiffness [N m].
    """
    # That of the free end of a long tube, whose opening is as wide as the tube; a shell bends over
    # the opening's radius, and its tension by pressure goes with the shell's.
    return _RING * plate / (radius * xp.asarray(opening) ** 2)
