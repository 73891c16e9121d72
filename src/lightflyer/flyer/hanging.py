"""Plates that carry a payload on a circle, or at three points of one."""

import math
from functools import reduce
from typing import Literal, NamedTuple, TypeAlias

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.quantity import Contradictions
from lightflyer.structure.plates import (
    free_plate_profile,
    load_curvatures,
    shear_profile,
    three_point_profile,
    three_point_shear,
)
from lightflyer.structure.vibrations import (
    UMBRELLA_PLACES,
    free_plate_frequency,
    free_shear_frequency,
    umbrella_frequency,
)

HOLD = 0.01
"""Radius over the flyer's of what holds a payload: a drop of glue [1]."""

Hanging: TypeAlias = Literal["circle", "three points"]
THREE_POINTS: Hanging = "three points"


def hangs_wrongly(
    radius: Numeric, hanging_radius: Numeric | None, hanging: Hanging
) -> Contradictions:
    """What is wrong with the points from which a payload hangs."""
    if hanging_radius is None:
        needs = "three points are on a circle: give its hanging_radius"
        yield hanging == THREE_POINTS, needs
        return
    outside = hanging_radius >= radius
    yield outside, "hanging_radius must be smaller than the flyer's radius"
    if hanging == THREE_POINTS:
        least = f"three points need a hanging_radius above {HOLD:g} of the flyer's radius"
        yield hanging_radius <= HOLD * radius, least


class Held(NamedTuple):
    """Masses of a flyer, and how its payload hangs."""

    own_mass: Numeric  # [kg]
    payload: Numeric  # [kg]
    gravity: Numeric  # [m/s²]
    radius: Numeric | None = None  # Of the circle from which it hangs [m]; None is the middle
    at_three_points: bool = False

    @property
    def load(self) -> Numeric:
        """Weight of the payload [N]."""
        return self.payload * self.gravity


class HangingPlate(NamedTuple):
    """A round plate with a free edge, and where it holds what it carries."""

    radius: Numeric  # [m]
    ring: Numeric  # Radius of the circle, in the middle that of the hold [m]
    hold: Numeric  # Radius of each of three points [m]
    at_three_points: bool
    stiffness: Numeric  # In bending [N m]
    poisson: Numeric
    shear: Numeric | None = None  # Stiffness [N/m]; None for a film
    faces: "HangingPlate | None" = None  # Both films, as they bend if they slide on each other

    def rise(self, at: Numeric) -> Array:
        """Height over the middle per load on the circle, at distances [m] from it [m/N]."""
        return self._on_circle(at) * self._together

    def cut(self, at: Numeric) -> tuple[Array, Array]:
        """The same towards one of three points, and opposite; alike on a circle."""
        towards, opposite = self._cut(at)
        return towards * self._together, opposite * self._together

    @property
    def droop(self) -> Array:
        """Largest difference of its heights per load [m/N]."""
        return self._droop * self._together

    @property
    def load_curvature(self) -> Array:
        """Largest curvature per load, of either sign [1/(m N)]."""
        plate = 1.0, self.radius, self.ring, self.stiffness, self.poisson
        if self.at_three_points:  # each as in the middle of a plate that ends at the edge
            around = self.radius - self.ring
            plate = 1.0 / 3.0, around, self.hold, self.stiffness, self.poisson
        middle, on_ring = load_curvatures(*plate)
        return xp.maximum(xp.abs(middle), xp.abs(on_ring))

    @property
    def perimeter(self) -> Numeric:
        """Of what holds the load [m]."""
        around = 3.0 * self.hold if self.at_three_points else self.ring
        return 2.0 * math.pi * around

    def frequency(self, held: Held) -> Array:
        """Lowest frequency: of a saddle, or of plate and payload against each other [Hz]."""
        density = held.own_mass / (math.pi * xp.asarray(self.radius) ** 2)
        if self.shear is None or self.faces is None:
            saddle = self._bending_frequency(density)
        else:
            sheared = free_shear_frequency(self.radius, density, self.shear)
            bent = self._bending_frequency(density)
            faces = self.faces._bending_frequency(density)
            # Dunkerley's rule of compliances in series; stiffnesses side by side add up
            saddle = xp.sqrt(1.0 / (1.0 / bent**2 + 1.0 / sheared**2) + faces**2)
        wide = self._with_axis()
        profile = wide.rise(wide.radius * xp.asarray(UMBRELLA_PLACES))
        umbrella = umbrella_frequency(profile, self.rise(self.ring), held.own_mass, held.payload)
        return xp.minimum(saddle, umbrella)

    def _on_circle(self, at: Numeric) -> Array:
        bent = free_plate_profile(1.0, self.radius, self.ring, self.stiffness, self.poisson, at)
        if self.shear is None:
            return bent
        return bent + shear_profile(1.0, self.radius, self.ring, self.shear, at)

    def _cut(self, at: Numeric) -> tuple[Array, Array]:
        if not self.at_three_points:
            return (self._on_circle(at),) * 2
        plate = self.radius, self.ring
        bent = three_point_profile(1.0, *plate, self.stiffness, self.poisson, at)
        if self.shear is None:
            return bent
        sheared = three_point_shear(1.0, *plate, self.shear, self.hold, at)
        return bent[0] + sheared[0], bent[1] + sheared[1]

    @property
    def _droop(self) -> Array:
        heights = [*self._cut(self.ring), *self._cut(self.radius)]  # over the middle
        highest, lowest = reduce(xp.maximum, heights), reduce(xp.minimum, heights)
        return xp.maximum(highest, 0.0) - xp.minimum(lowest, 0.0)

    @property
    def _together(self) -> Numeric:
        """Share of the load that faces carry as one [1]."""
        if self.faces is None:
            return 1.0
        alone = self.faces._droop
        return alone / (alone + self._droop)

    def _bending_frequency(self, density: Numeric) -> Array:
        return free_plate_frequency(self.radius, density, self.stiffness, self.poisson)

    def _with_axis(self) -> "HangingPlate":
        """The same with an axis more in every number."""

        def longer(number: Numeric) -> Array:
            return xp.asarray(number)[..., None]

        return self._replace(
            radius=longer(self.radius),
            ring=longer(self.ring),
            hold=longer(self.hold),
            stiffness=longer(self.stiffness),
            poisson=longer(self.poisson),
            shear=None if self.shear is None else longer(self.shear),
            faces=None if self.faces is None else self.faces._with_axis(),
        )


def hung(
    held: Held,
    radius: Numeric,
    hold: Numeric,
    stiffness: Numeric,
    poisson: Numeric,
    shear: Numeric | None = None,
    faces: Numeric | None = None,
) -> HangingPlate:
    """A plate by its numbers; ``hold``: radius that it holds at least [m]; see HangingPlate."""
    ring = hold if held.radius is None else xp.maximum(held.radius, hold)
    shared = radius, ring, hold, held.at_three_points
    alone = None if faces is None else HangingPlate(*shared, faces, poisson)
    return HangingPlate(*shared, stiffness, poisson, shear, alone)
