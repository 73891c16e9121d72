"""What a film withstands where it is held, and what a payload hangs from."""

import math

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point

_ROD = math.pi**2  # Euler's load of a rod between hinges: π² EI/L²


@entry_point
def fold_curvature(tension: Numeric, stiffness: Numeric) -> Array:
    r"""Curvature of a strip beside a hold, pulled at a right angle [1/m].

    ``tension`` [N/m], bending ``stiffness`` [N m].
    """
    # .. math:: \kappa = \sqrt{2N/D}
    #
    # Euler's elastica: ½Dκ² = N(1 - cos φ) between the hold and far away.
    return xp.sqrt(2.0 * xp.asarray(tension) / stiffness)


@entry_point
def fold_tension(
    margin: Numeric, per_tension: Numeric, per_curvature: Numeric, stiffness: Numeric
) -> Array:
    """Tension at which such a strip has a stress, by what one tension and curvature add [N/m].

    ``margin``: that stress [Pa]; ``per_tension`` [1/m], ``per_curvature`` [Pa m].
    """
    bent = per_curvature * xp.sqrt(2.0 / xp.asarray(stiffness))
    # of the quadratic equation of the tension's root, without cancellation
    return (2.0 * margin / (bent + xp.sqrt(bent**2 + 4.0 * per_tension * margin))) ** 2


@entry_point
def tether_mass(
    weight: Numeric, length: Numeric, density: Numeric, strength: Numeric, safety: Numeric = 2.0
) -> Array:
    """Mass of a tether that carries a weight [kg].

    ``weight`` [N], ``length`` [m], ``density`` [kg/m³], ``strength`` [Pa], ``safety`` [1].
    """
    return safety * weight * length * density / xp.asarray(strength)


@entry_point
def rod_mass(
    load: Numeric, length: Numeric, density: Numeric, modulus: Numeric, safety: Numeric = 2.0
) -> Array:
    r"""Mass of a round rod that does not buckle under a load at its ends [kg].

    ``load`` [N], ``length`` [m], ``density`` [kg/m³], ``modulus`` [Pa], ``safety`` [1].
    """
    # .. math:: m = \rho A L, \qquad nP = \frac{\pi^2 E}{L^2}\,\frac{A^2}{4\pi}
    area = 2.0 * length * xp.sqrt(math.pi * safety * load / (_ROD * xp.asarray(modulus)))
    return density * area * length
