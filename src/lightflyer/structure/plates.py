"""Round plates and membranes under loads: how far they bend, and how they ring."""

import math

import jax.numpy as jnp
from jax import Array
from jax.scipy.special import xlogy

from lightflyer.core.types import Numeric
from lightflyer.program.entry_point import entry_point
from lightflyer.structure.laminate import Stiffness

_PLATE = 64.0  # of a clamped round plate: p = 64 D w/b⁴ [TimoshenkoWoinowskyKrieger1959]
_TENSION = 4.0  # of a round membrane: p = 4 N w/b²
_MEMBRANE = (8.0 / 3.0 * 1.015, 8.0 / 3.0 * 0.247)  # of one that stretches [SmallNix1992]
_SMALLEST = 1e-77  # [m²], in place of nothing
_LOWEST_MEMBRANE = 2.404825557695773  # the first zero of the Bessel function J₀


def _bent(inner: Numeric, poisson: Numeric) -> Array:
    """What the free edge leaves of the bending within a ring [1]; ``inner``: ring over radius."""
    within = (1.0 - poisson) * (0.1875 - 0.125 * jnp.asarray(inner) ** 2) - 0.25
    return within / (1.0 + poisson)


@entry_point
def free_plate_heights(
    load: Numeric, radius: Numeric, ring: Numeric, stiffness: Numeric, poisson: Numeric
) -> tuple[Array, Array]:
    r"""How far ring and edge of a round plate rise over its middle, under a load on the ring.

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

    Returns
    -------
    ring, edge : array, broadcast shape
        [m]

    Notes
    -----
    Exact for small deflections. A load in the middle lifts the edge by
    :math:`\frac{7+3\nu}{1+\nu}\frac{PR^2}{64\pi D}`. A film much thinner than it bends folds
    instead, and resists about as much. Three points in place of the ring bend it more: see
    ``studies/structure``.

    References
    ----------
    [TimoshenkoWoinowskyKrieger1959]_ ch. 3
    """
    inner = ring / jnp.asarray(radius)
    square, log = inner**2, -xlogy(inner**2, inner)  # of the ring
    size, bent = load * radius**2 / (math.pi * stiffness), _bent(inner, poisson)
    outside = 0.125 * (1.0 - square - log)
    return (
        size * (square**2 / 64.0 + 0.5 * bent * square + 0.125 * log),
        size * (1.0 / 64.0 + 0.5 * bent + outside),
    )


@entry_point
def load_curvature(
    load: Numeric, radius: Numeric, ring: Numeric, stiffness: Numeric, poisson: Numeric
) -> Array:
    """Curvature in the middle of such a plate [1/m]; the ring must be wider than a point."""
    inner = ring / jnp.asarray(radius)
    return load / (math.pi * stiffness) * (_bent(inner, poisson) - 0.25 * jnp.log(inner))


@entry_point
def shear_heights(
    load: Numeric, radius: Numeric, ring: Numeric, shear_stiffness: Numeric
) -> tuple[Array, Array]:
    """What shear adds to the rise of such a plate's ring and edge [m]; stiffness [N/m]."""
    inner, size = ring / jnp.asarray(radius), load / (2.0 * math.pi * shear_stiffness)
    return -0.5 * size * inner**2, size * (-jnp.log(inner) - 0.5)


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
    return _largest_root(linear, stretched / radius**4, pressure)


def _largest_root(linear: Numeric, cubic: Numeric, load: Numeric) -> Array:
    """Largest x of cubic·x³ + linear·x = load; the cubic term is positive, the load not below 0."""
    ratio = linear / cubic
    size = jnp.maximum(jnp.abs(ratio), _SMALLEST)
    width = 2.0 * jnp.sqrt(size / 3.0)
    steep = 4.0 * (load / cubic) / width**3
    three = steep < 1.0  # roots; a stand-in keeps the other branch's derivative finite
    folded = jnp.cos(jnp.arccos(jnp.where(three, steep, 0.5)) / 3.0)
    lone = jnp.cosh(jnp.arccosh(jnp.where(three, 2.0, steep)) / 3.0)
    buckled = jnp.where(three, folded, lone)
    return width * jnp.where(ratio >= 0.0, jnp.sinh(jnp.arcsinh(steep) / 3.0), buckled)


@entry_point
def free_plate_frequency(
    radius: Numeric, areal_density: Numeric, stiffness: Numeric, poisson: Numeric
) -> Array:
    """Lowest frequency of a free round plate [Hz], whose edge then bends as a saddle."""
    # Ritz's method with (1, r²) r² cos 2φ: 0.4 % above the exact frequency [Leissa1969].
    across = (19.0 + poisson) / 5.0
    square = 480.0 * (across - jnp.sqrt(across**2 - 0.2 * (3.0 + poisson) * (1.0 - poisson)))
    return jnp.sqrt(square * stiffness / areal_density) / (2.0 * math.pi * radius**2)


@entry_point
def membrane_frequency(radius: Numeric, areal_density: Numeric, tension: Numeric) -> Array:
    """Lowest frequency of a round membrane that is held at its edge [Hz]; ``tension`` [N/m]."""
    return _LOWEST_MEMBRANE / (2.0 * math.pi * radius) * jnp.sqrt(tension / areal_density)
