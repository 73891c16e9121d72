r"""Shapes of hollow bodies with an outlet, as functions of plain numbers.

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

import jax.numpy as jnp
from jax import Array

from lightflyer.foundation.types import Numeric

Form = Literal["cone", "sphere", "rocket"]
"""Names of the shapes."""


class HollowForm(NamedTuple):
    """Geometry of one shape.

    Attributes
    ----------
    surface : callable
        From size and outlet radius [m] to the area of the wall [m²].
    volume : callable
        Likewise to the volume within [m³].
    silhouette : callable
        From size, outlet radius and the cosine of the angle to the axis [1] to the area seen from
        that direction [m²].
    """

    surface: Callable[[Numeric, Numeric], Array]
    volume: Callable[[Numeric, Numeric], Array]
    silhouette: Callable[[Numeric, Numeric, Numeric], Array]


def _cone_surface(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    slant = jnp.hypot(radius - outlet, size)
    return jnp.pi * (radius**2 + (radius + outlet) * slant)


def _cone_volume(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    return jnp.pi * size * (radius**2 + radius * outlet + outlet**2) / 3.0


def _cone_silhouette(size: Numeric, outlet: Numeric, cosine: Numeric) -> Array:
    """Convex hull of the ellipses that both ends appear as."""
    radius, flat = 0.5 * size, jnp.abs(cosine)
    apart = size * _sine(cosine)
    hidden = (radius - outlet) * flat >= apart  # the outlet, behind the wide end
    inner = jnp.where(hidden, 0.0, (radius - outlet) * flat / jnp.where(hidden, 1.0, apart))
    angle = jnp.where(hidden, 0.0, jnp.arccos(inner))
    ends = radius**2 * (jnp.pi - angle) + outlet**2 * angle
    return flat * ends + (radius + outlet) * apart * jnp.sin(angle)


def _sphere_surface(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    return 4.0 * jnp.pi * radius**2 - 2.0 * jnp.pi * radius * _cap(radius, outlet)


def _sphere_volume(size: Numeric, outlet: Numeric) -> Array:
    radius = 0.5 * size
    height = _cap(radius, outlet)
    return jnp.pi * (4.0 * radius**3 - height**2 * (3.0 * radius - height)) / 3.0


def _cap(radius: Numeric, outlet: Numeric) -> Array:
    """Height of the cap that a sphere lacks, without cancellation [m]."""
    return outlet**2 / (radius + jnp.sqrt(radius**2 - outlet**2))


def _sphere_silhouette(size: Numeric, outlet: Numeric, cosine: Numeric) -> Array:
    del outlet  # from the side 3 % lack for an outlet of half the diameter
    return 0.25 * jnp.pi * size**2 + 0.0 * cosine


def _rocket_surface(size: Numeric, outlet: Numeric) -> Array:
    return 2.0 * jnp.pi * outlet * (outlet + size)


def _rocket_volume(size: Numeric, outlet: Numeric) -> Array:
    return jnp.pi * outlet**2 * (size + 2.0 * outlet / 3.0)


def _rocket_silhouette(size: Numeric, outlet: Numeric, cosine: Numeric) -> Array:
    """Half the hemisphere's circle, the cylinder's side and half the outlet's ellipse."""
    ends = 0.5 * jnp.pi * outlet**2 * (1.0 + jnp.abs(cosine))
    return ends + 2.0 * outlet * size * _sine(cosine)


def _sine(cosine: Numeric) -> Array:
    """Sine of the angle of a cosine, of finite slope where it is zero."""
    square = 1.0 - jnp.asarray(cosine, float) ** 2
    along = square <= 0.0
    return jnp.where(along, 0.0, jnp.sqrt(jnp.where(along, 1.0, square)))


FORMS: dict[str, HollowForm] = {
    "cone": HollowForm(_cone_surface, _cone_volume, _cone_silhouette),
    "sphere": HollowForm(_sphere_surface, _sphere_volume, _sphere_silhouette),
    "rocket": HollowForm(_rocket_surface, _rocket_volume, _rocket_silhouette),
}
"""Shapes by name."""
