"""Outlines of hollow bodies, closed at their outlet, for their drag."""

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.drag.convex import Outline, sphere_outline
from lightflyer.drag.disk import Direction
from lightflyer.flyer.hollow_geometry import FORMS


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
