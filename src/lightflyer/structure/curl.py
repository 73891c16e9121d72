"""Curl of a free round film: a shallow dish while it is small, a roll where it is wide."""

from typing import NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import short_repr
from lightflyer.core.entry_point import entry_point
from lightflyer.structure.laminate import Stiffness

_EDGE_FREE = 192.0  # of a round film with a free edge: its energy of stretching is E t K² πR⁶/384


class Curl(NamedTuple):
    """Principal curvatures of a free film [1/m]; positive where its edge rises."""

    largest: Numeric  #: Of the direction in which it curls most
    smallest: Numeric

    def __repr__(self) -> str:
        return short_repr(self)

    @property
    def rolls(self) -> Array:
        """Whether it rolls up in one direction."""
        return xp.asarray(self.largest != self.smallest)


@entry_point
def critical_curvature(stiffness: Stiffness, radius: Numeric) -> Array:
    r"""Curvature of the dish beyond which a free round film rolls up in one direction [1/m]."""
    # .. math:: \kappa_c = \sqrt{\frac{192\,D(1-\nu)}{E t R^4}}
    #
    # which is 4t/(R²√(1+ν)) of one layer. Source: [Freund2000]_.
    return xp.sqrt(_EDGE_FREE * stiffness.twisting / stiffness.membrane) / radius**2


@entry_point
def curl_of_film(curvature: Numeric, stiffness: Stiffness, radius: Numeric) -> Curl:
    r"""Curl of a round film whose small pieces have a curvature.

    Parameters
    ----------
    curvature : array, shape (...)
        That of linear theory, of a piece too small to stretch [1/m].
    stiffness : Stiffness
    radius : array, shape (...)
        Of the film [m].

    Returns
    -------
    Curl

    Notes
    -----
    A dish has to stretch. Up to the critical curvature :math:`\kappa_c` it grows as

    .. math:: \kappa\left(1 + \frac{D_t}{D_b}\,\frac{\kappa^2}{\kappa_c^2}\right) = \kappa_0

    with the stiffness against alike and opposite curvatures; beyond, the product of both
    stays :math:`\kappa_c^2` and their sum is :math:`2D_b\kappa_0/(D_b + D_t)`: a roll. Curvature is
    the same everywhere in the film, which is Ritz's method with one term: within about 10 % of
    finite elements [Freund2000]_. Not differentiable where the film begins to roll.

    References
    ----------
    [Freund2000]_, [FreundSuresh2003]_ ch. 2.6
    """
    critical = critical_curvature(stiffness, radius)
    wanted = xp.abs(curvature) / critical
    ratio = stiffness.twisting / stiffness.bending
    # the one real root of ratio·x³ + x = wanted
    slope = 1.5 * xp.sqrt(3.0 * ratio)
    dish = 2.0 / xp.sqrt(3.0 * ratio) * xp.sinh(xp.arcsinh(slope * wanted) / 3.0)
    mean = wanted / (1.0 + ratio)
    rolled = mean > 1.0
    spread = xp.sqrt(xp.where(rolled, mean**2 - 1.0, 1.0))
    largest = xp.where(rolled, mean + spread, dish)
    smallest = xp.where(rolled, 1.0 / (mean + spread), dish)
    sign = xp.sign(curvature) * critical
    return Curl(sign * largest, sign * smallest)


@entry_point
def projected_share(curl: Curl, radius: Numeric) -> Array:
    r"""Area of a curled film seen from above over that of the flat one, at least [1]."""
    # .. math:: \langle\cos\vartheta\rangle \ge 1 - \tfrac12\langle\vartheta^2\rangle,
    #     \qquad \langle\vartheta^2\rangle = \tfrac14(\kappa_1^2+\kappa_2^2)R^2
    #
    # by the angle ϑ to the horizontal; the first term of its series is a bound.
    square = 0.25 * (curl.largest**2 + curl.smallest**2) * xp.asarray(radius) ** 2
    return xp.maximum(1.0 - 0.5 * square, 0.0)


@entry_point
def tac_within(tac: Numeric, projected: Numeric) -> Array:
    r"""Thermal accommodation coefficient of a hollow face, over its opening [1].

    ``tac``: of the flat face; ``projected``: area of the opening over that of the face.
    """
    # .. math:: \alpha' = \frac{\alpha}{1-(1-\alpha)(1-\varphi)}
    #
    # Free molecules meet the face again unless they leave by the opening; exact for a spherical cap
    # with diffuse reflection, of which every part sees the opening under φ.
    return tac / (1.0 - (1.0 - xp.asarray(tac)) * (1.0 - projected))
