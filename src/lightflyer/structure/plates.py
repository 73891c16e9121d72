"""Round plates, membranes and thin shells under loads, and what holds and hangs from them."""

import math

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.numerics.special import xlogy
from lightflyer.structure.laminate import Stiffness

_PLATE = 64.0  # of a clamped round plate: p = 64 D w/b⁴ [TimoshenkoWoinowskyKrieger1959]
_TENSION = 4.0  # of a round membrane: p = 4 N w/b²
_MEMBRANE = (8.0 / 3.0 * 1.015, 8.0 / 3.0 * 0.247)  # of one that stretches [SmallNix1992]
_SMALLEST = 1e-77  # [m²], in place of nothing
_WAVES = np.arange(3.0, 39.0, 3.0)  # around a plate that hangs at three points
_SIGNS = np.resize([-1.0, 1.0], _WAVES.size)  # halfway between them


def _bent(inner: Numeric, poisson: Numeric) -> Array:
    """What the free edge leaves of the bending within a ring [1]; ``inner``: ring over radius."""
    within = (1.0 - poisson) * (0.1875 - 0.125 * xp.asarray(inner) ** 2) - 0.25
    return within / (1.0 + poisson)


@entry_point
def free_plate_profile(
    load: Numeric, radius: Numeric, ring: Numeric, stiffness: Numeric, poisson: Numeric, at: Numeric
) -> Array:
    r"""How far a round plate rises over its middle at distances from it, under a load on a ring.

    Parameters
    ----------
    load : array, shape (...)
        Weight on the ring, which pressure from below, alike everywhere, carries [N].
    radius : array, shape (...)
        Of the plate [m].
    ring : array, shape (...)
        Radius of the ring; zero for a point in the middle [m].
    stiffness : array, shape (...)
        Bending stiffness of the plate [N m].
    poisson : array, shape (...)
        Its Poisson's ratio [1].
    at : array, shape (...)
        Distances from the middle [m].

    Returns
    -------
    array, broadcast shape
        [m]

    Notes
    -----
    Exact for small deflections. A load in the middle lifts the edge by
    :math:`\frac{7+3\nu}{1+\nu}\frac{PR^2}{64\pi D}`. A film much thinner than it bends folds
    instead, and resists about as much.

    References
    ----------
    [TimoshenkoWoinowskyKrieger1959]_ ch. 3
    """
    inner, way = ring / xp.asarray(radius), at / xp.asarray(radius)
    further, square = xp.maximum(way, inner), way**2
    within = square**2 / 64.0 + 0.5 * _bent(inner, poisson) * square
    beyond = further**2 - inner**2 - xlogy(inner**2, further) + xlogy(inner**2, inner)
    size = load * radius**2 / (math.pi * stiffness)
    return size * (within + 0.125 * (beyond - xlogy(square, further)))


@entry_point
def free_plate_heights(
    load: Numeric, radius: Numeric, ring: Numeric, stiffness: Numeric, poisson: Numeric
) -> tuple[Array, Array]:
    """How far ring and edge of such a plate rise over its middle [m]."""
    plate = load, radius, ring, stiffness, poisson
    return free_plate_profile(*plate, ring), free_plate_profile(*plate, radius)


@entry_point
def three_point_profile(
    load: Numeric, radius: Numeric, ring: Numeric, stiffness: Numeric, poisson: Numeric, at: Numeric
) -> tuple[Array, Array]:
    """The same with the load at three points of the ring: towards one, and between two [m]."""
    # The ring's solution, and a sum over waves cos mφ, m = 3, 6, … Each is that of a point load in
    # an endless plate, R² ln R, with A rᵐ + B rᵐ⁺², which frees the edge of moment and shear.
    inner, way = xp.broadcast_arrays(ring / xp.asarray(radius), at / xp.asarray(radius))
    a, x, m = inner[..., None], way[..., None], xp.asarray(_WAVES)
    nu = xp.asarray(poisson)[..., None]
    power = a**m
    second = -(1.0 - nu) / (3.0 + nu) * power * (1.0 / m - a**2 / (m + 1.0))
    moment = (
        power / (m * (m - 1.0)) * ((m - 2.0) * (m - 1.0) + nu * (2.0 - m - m**2))
        - power * a**2 * (1.0 - nu)
        + second * ((m + 2.0) * (m + 1.0) + nu * (m + 2.0 - m**2))
    )
    first = -moment / ((1.0 - nu) * m * (m - 1.0))
    far = xp.maximum(x, a)
    near = xp.minimum(x, a) / far
    endless = x * a * near ** (m - 1.0) * (1.0 / (m - 1.0) + near**2 / (m + 1.0))
    endless = endless - (x**2 + a**2) * near**m / m
    waves = endless + x**m * (first + second * x**2)
    size = -load * radius**2 / (8.0 * math.pi * stiffness)
    even = free_plate_profile(load, radius, ring, stiffness, poisson, at)
    return (
        even + size * xp.sum(waves, axis=-1),
        even + size * xp.sum(xp.asarray(_SIGNS) * waves, axis=-1),
    )


@entry_point
def load_curvatures(
    load: Numeric, radius: Numeric, ring: Numeric, stiffness: Numeric, poisson: Numeric
) -> tuple[Array, Array]:
    """Curvature of such a plate in its middle, and on its ring across that [1/m].

    The ring must be wider than a point. Curvature is nowhere larger than the larger of the two.
    """
    inner = ring / xp.asarray(radius)
    middle = _bent(inner, poisson) - 0.25 * xp.log(inner)
    size = load / (math.pi * stiffness)
    return size * middle, size * (middle + 0.1875 * inner**2)


@entry_point
def shear_profile(
    load: Numeric, radius: Numeric, ring: Numeric, shear_stiffness: Numeric, at: Numeric
) -> Array:
    """What shear adds to the rise of such a plate [m]; stiffness [N/m], ring wider than a point."""
    way, inner = at / xp.asarray(radius), ring / xp.asarray(radius)
    size = load / (2.0 * math.pi * shear_stiffness)
    return size * (xp.log(xp.maximum(way, inner) / inner) - 0.5 * way**2)


@entry_point
def three_point_shear(
    load: Numeric,
    radius: Numeric,
    ring: Numeric,
    shear_stiffness: Numeric,
    hold: Numeric,
    at: Numeric,
) -> tuple[Array, Array]:
    """The same with the load at three points: towards one, and between two [m].

    ``hold``: radius of each point [m].
    """
    # the sum of waves of a point load and its image beyond the free edge, cos mφ, m = 3, 6, …
    inner, way = ring / xp.asarray(radius), at / xp.asarray(radius)
    near = xp.minimum(way, inner) / xp.maximum(way, inner)
    at_hold, image = xp.minimum(near, 1.0 - hold / xp.asarray(ring)), (way * inner) ** 3
    towards = xp.log1p(-(at_hold**3)) + xp.log1p(-image)
    between = xp.log1p(near**3) + xp.log1p(image)
    size = load / (6.0 * math.pi * shear_stiffness)
    even = shear_profile(load, radius, ring, shear_stiffness, at)
    return even + size * towards, even + size * between


@entry_point
def clamped_deflection(
    pressure: Numeric, radius: Numeric, stiffness: Stiffness, tension: Numeric = 0.0
) -> Array:
    r"""Deflection in the middle of a round film that is held at its edge, under pressure.

    Parameters
    ----------
    pressure : array, shape (...)
        [Pa]
    radius : array, shape (...)
        Of what is free between the holds [m].
    stiffness : Stiffness
    tension : array, shape (...)
        Of the flat film [N/m]; below zero it is pressed together, as where it is warmer than what
        holds it, and may buckle.

    Returns
    -------
    array, broadcast shape
        [m]

    Notes
    -----
    .. math::
        p = \left(\frac{64D}{b^4} + \frac{4N}{b^2}\right)w
            + \frac83\,\frac{1.015-0.247\nu}{1-\nu}\,\frac{Et}{b^4}\,w^3

    Exact as a plate, under tension, and as a membrane that stretches; a few per cent off between
    them. It buckles at 16 D/b², exact is 14.7.

    References
    ----------
    [TimoshenkoWoinowskyKrieger1959]_, [SmallNix1992]_
    """
    poisson = stiffness.poisson
    linear = _PLATE * stiffness.plate / radius**4 + _TENSION * tension / radius**2
    stretched = (_MEMBRANE[0] - _MEMBRANE[1] * poisson) / (1.0 - poisson) * stiffness.membrane
    cubic = stretched / radius**4  # positive: the largest root is the one that is wanted
    ratio = linear / cubic
    size = xp.maximum(xp.abs(ratio), _SMALLEST)
    width = 2.0 * xp.sqrt(size / 3.0)
    steep = 4.0 * (pressure / cubic) / width**3
    three = steep < 1.0  # roots; a stand-in keeps the other branch's derivative finite
    folded = xp.cos(xp.arccos(xp.where(three, steep, 0.5)) / 3.0)
    lone = xp.cosh(xp.arccosh(xp.where(three, 2.0, steep)) / 3.0)
    buckled = xp.where(three, folded, lone)
    return width * xp.where(ratio >= 0.0, xp.sinh(xp.arcsinh(steep) / 3.0), buckled)


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
