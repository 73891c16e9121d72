"""Shapes of hollow bodies with an outlet, as functions of plain numbers.

All take the size :math:`D` of the body and the radius :math:`r` of its outlet, which faces down:

- the cone is a frustum, closed at its upper end, of height :math:`D` and upper radius
  :math:`D/2`; the lower radius is that of the outlet;
- the sphere has the diameter :math:`D` and lacks the cap beyond its outlet;
- the rocket is a cylinder of length :math:`D` with a hemisphere on top; its radius is that of the
  outlet.

References
----------
[Celenza2023]_, whose code has the same surfaces.
"""

from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.drag.convex import Outline, sphere_outline
from lightflyer.drag.disk import Direction

Form = Literal["cone", "sphere", "rocket"]  # Names of the shapes


class HollowForm(NamedTuple):
    """Geometry of one shape."""

    # From size and outlet radius [m] to the area of the wall [m²]
    surface: Callable[[Numeric, Numeric], Array]
    volume: Callable[[Numeric, Numeric], Array]  # Likewise to the volume within [m³]
    # From size, outlet radius and the cosine of the angle to the axis [1] to the area seen from
    # that direction [m²]
    silhouette: Callable[[Numeric, Numeric, Numeric], Array]
    # From size and outlet radius to the height above the outlet [m]
    height: Callable[[Numeric, Numeric], Numeric]
    # Likewise to the length of a tube as wide as the outlet, over its radius [1], in which all the
    # gas loses the pressure that it loses on its way to the outlet, in the mean over the wall
    passage: Callable[[Numeric, Numeric], Numeric]


def _cone_surface(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    slant = ((radius - outlet) ** 2 + size**2) ** 0.5  # plain numbers stay in double precision
    return np.pi * (radius**2 + (radius + outlet) * slant)


def _cone_volume(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    return np.pi * size * (radius**2 + radius * outlet + outlet**2) / 3.0


def _cone_silhouette(size: Numeric, outlet: Numeric, cosine: Numeric) -> Array:
    """Convex hull of the ellipses that both ends appear as."""
    radius, flat = 0.5 * size, xp.abs(cosine)
    apart = size * _sine(cosine)
    hidden = (radius - outlet) * flat >= apart  # the outlet, behind the wide end
    inner = xp.where(hidden, 0.0, (radius - outlet) * flat / xp.where(hidden, 1.0, apart))
    angle = xp.where(hidden, 0.0, xp.arccos(inner))
    ends = radius**2 * (np.pi - angle) + outlet**2 * angle
    return flat * ends + (radius + outlet) * apart * xp.sin(angle)


def _cone_passage(size: Numeric, outlet: Numeric) -> Array:
    r"""Of Poiseuille's law with the gas that comes in above a place, and acts on the wall above."""
    # .. math:: \frac1r\int_0^D \left(1 - \frac{A(x)}{A_t}\right)^2\frac{r^4}{r(x)^4}\,dx
    #
    # with the wall's area below, :math:`A(x)`.
    node, weight = map(xp.asarray, _PASSAGE)
    wide, low = (0.5 * xp.asarray(size))[..., None], xp.asarray(outlet)[..., None]
    slant = xp.hypot(wide - low, 2.0 * wide)
    there = low + (wide - low) * node
    above = 1.0 - np.pi * (low + there) * slant * node / _cone_surface(2.0 * wide, low)
    return size / outlet * xp.sum(weight * above**2 * (low / there) ** 4, axis=-1)


def _sphere_height(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    return size - _cap(radius, outlet)


def _sphere_surface(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    return 4.0 * np.pi * radius**2 - 2.0 * np.pi * radius * _cap(radius, outlet)


def _sphere_volume(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    height = _cap(radius, outlet)
    return np.pi * (4.0 * radius**3 - height**2 * (3.0 * radius - height)) / 3.0


def _cap(radius: Numeric, outlet: Numeric) -> Array:
    """Height of the cap that a sphere lacks, without cancellation [m]."""
    return outlet**2 / (radius + (radius**2 - outlet**2) ** 0.5)


def _sphere_silhouette(size: Numeric, outlet: Numeric, cosine: Numeric) -> Array:
    """Disc of the sphere; where the outlet cuts its outline, with a part of the rim's ellipse."""
    radius, flat, sine = 0.5 * size, xp.abs(cosine), _sine(cosine)
    height = xp.sqrt(radius**2 - outlet**2)  # of the centre above the outlet
    cut = radius * sine > height
    # where they are not met, numbers that divide and take roots without harm
    across, along = xp.where(cut, sine, 1.0), xp.where(cut, flat, 0.5)
    off_disc = _segment(xp.where(cut, height / (radius * across), 0.5))
    off_rim = _segment(xp.where(cut, height * along / (outlet * across), 0.5))
    lacking = radius**2 * off_disc - outlet**2 * along * off_rim
    return np.pi * radius**2 - xp.where(cut, lacking, 0.0)


def _segment(distance: Numeric) -> Array:
    """Area of a circle of radius one beyond a chord, by the chord's distance from the centre."""
    return xp.arccos(distance) - distance * xp.sqrt(1.0 - distance**2)


def _rocket_surface(size: Numeric, outlet: Numeric) -> Array:
    return 2.0 * np.pi * outlet * (outlet + size)


def _rocket_volume(size: Numeric, outlet: Numeric) -> Array:
    return np.pi * outlet**2 * (size + 2.0 * outlet / 3.0)


def _rocket_silhouette(size: Numeric, outlet: Numeric, cosine: Numeric) -> Array:
    """Half the hemisphere's circle, the cylinder's side and half the outlet's ellipse."""
    ends = 0.5 * np.pi * outlet**2 * (1.0 + xp.abs(cosine))
    return ends + 2.0 * outlet * size * _sine(cosine)


def _rocket_passage(size: Numeric, outlet: Numeric) -> Numeric:
    """A third of its length, as gas comes in everywhere; the hemisphere counts as cylinder."""
    return (size + outlet) / (3.0 * outlet)


def _sine(cosine: Numeric) -> Array:
    """Sine of the angle of a cosine, of finite slope where it is zero."""
    square = 1.0 - xp.asarray(cosine, float) ** 2
    along = square <= 0.0
    return xp.where(along, 0.0, xp.sqrt(xp.where(along, 1.0, square)))


class _Ring(NamedTuple):
    """Directions of a quadrature over the ring between the horizon and the edge of the ground."""

    depth: Numeric  # sine of the angle below the horizon, over that of the edge
    azimuth: Numeric  # cosine of the angle to the direction of the tilt
    weight: Numeric


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights from 0 to 1."""
    node, weight = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1.0 + node), 0.5 * weight


def _ring(depths: int, azimuths: int) -> _Ring:
    node, weight = _gauss(depths)
    angle = np.pi * (np.arange(azimuths) + 0.5) / azimuths  # both sides are alike
    return _Ring(
        np.repeat(node, azimuths),
        np.tile(np.cos(angle), depths),
        np.repeat(weight, azimuths) / azimuths,
    )


_RING_OF_UPRIGHT, _RING_OF_TILTED = _ring(4, 1), _ring(2, 12)
_PASSAGE = _gauss(16)


def silhouette_below_horizon(
    form: HollowForm, size: Numeric, outlet: Numeric, tilt: Numeric | None, edge: Numeric
) -> Array:
    r"""Silhouette towards the directions between the horizon and the edge of the ground [m²]."""
    # .. math:: \int_0^{\cos\gamma} \bar S(x)\,dx
    #
    # with the half-angle :math:`\gamma` of the ground's disk, and the mean :math:`\bar S` over all
    # azimuths of the silhouette towards directions that are :math:`\arcsin x` below the horizon.
    ring = _Ring(*map(xp.asarray, _RING_OF_UPRIGHT if tilt is None else _RING_OF_TILTED))
    size, outlet, edge = (xp.asarray(number)[..., None] for number in (size, outlet, edge))
    below = edge * ring.depth
    cosine = -below
    if tilt is not None:
        upright = xp.asarray(tilt)[..., None]
        level = xp.sqrt(1.0 - below**2)
        cosine = level * ring.azimuth * xp.sin(upright) - below * xp.cos(upright)
    return xp.sum(edge * ring.weight * form.silhouette(size, outlet, cosine), axis=-1)


FORMS: dict[str, HollowForm] = {
    "cone": HollowForm(
        _cone_surface, _cone_volume, _cone_silhouette, lambda size, _: size, _cone_passage
    ),
    "sphere": HollowForm(
        _sphere_surface, _sphere_volume, _sphere_silhouette, _sphere_height, lambda *_: 0.0
    ),
    "rocket": HollowForm(
        _rocket_surface,
        _rocket_volume,
        _rocket_silhouette,
        lambda size, outlet: size + outlet,
        _rocket_passage,
    ),
}
"""Shapes by name."""


def tube_sizes(form: Form, size: Numeric, outlet: Numeric) -> tuple[Numeric, Numeric]:
    """Mean radius across the side of a rocket or cone, and the side's length [m]."""
    # a cone counts as the cylinder of its slant and of its mean radius of curvature [NASA-SP-8019]
    if form == "rocket":
        return outlet, size
    slant = xp.hypot(0.5 * size - outlet, size)
    return 0.5 * (0.5 * size + outlet) * slant / size, slant


def hollow_outline(
    form: str, size: Numeric, outlet_radius: Numeric, direction: Direction
) -> Outline:
    r"""Outline of a hollow body that moves along its axis or across it."""
    # A surface of the area :math:`S` whose normal has the cosine :math:`n` to the axis everywhere
    # has :math:`\oint\nu^2\,dA = n^2 S` along the axis and :math:`\tfrac12(1-n^2)S` across it.
    if form == "sphere":
        return sphere_outline(0.5 * size)
    lower = np.pi * outlet_radius**2
    if form == "cone":
        ends = lower + 0.25 * np.pi * size**2
        side = FORMS[form].surface(size, outlet_radius) - (ends - lower)
        slope = (0.5 * size - outlet_radius) ** 2
        facing_side = slope / (slope + size**2) * side
        along = ends + facing_side
    else:
        ends = lower
        side = 2.0 * np.pi * outlet_radius * size
        along = lower + 2.0 * lower / 3.0  # the hemisphere: 2πr²/3
    surface = FORMS[form].surface(size, outlet_radius) + lower
    across = 0.5 * (surface - along)
    broadside = direction == "broadside"
    silhouette = FORMS[form].silhouette(size, outlet_radius, 1.0 if broadside else 0.0)
    return Outline(silhouette, surface, along if broadside else across)
