"""Light and heat radiation that reach a flyer."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Angle,
    AngularRadius,
    Checked,
    Fraction,
    Infrared,
    Irradiance,
    PolarAngle,
)
from lightflyer.core.text import span
from lightflyer.environment.horizon import facing_share, ground_view_factor, sphere_view_factor

EARTH_ALBEDO = 0.29
"""Share of sunlight that Earth reflects, clouds included: global mean, 99.1 of 340.0 W/m² [1];
[Loeb2018]_."""

EARTH_INFRARED = 240.0
"""Heat radiation that leaves Earth, clouds included: global mean [W/m²]; [Loeb2018]_."""

SKY_INFRARED = 0.0
"""Heat radiation from above [W/m²]: that of space.

What the air above a flyer sends is left out. In the stratosphere it is of the order of the 22 W/m²
that a black body of 250 K emits within the 15-µm band of carbon dioxide (14 µm to 16 µm); higher up
it is less.
"""

_OF_BEAM = 0.25  # of a sphere's surface is the cross section that it has in a beam
_BLACK = "black surroundings at the gas temperature"


class Attitude(Checked):
    """Attitude of a flyer: the direction of the normal of its top face.

    Attributes
    ----------
    tilt : array
        Angle between the normal and the vertical [rad]; 0 is level, π upside down.
    azimuth : array
        Direction towards which the top face is tilted, from the same axis as the light's [rad].
    """

    tilt: PolarAngle = 0.0
    azimuth: Angle = 0.0


class FaceLight(NamedTuple):
    """Light that falls on the two faces of a flat flyer, in two parts."""

    # Irradiance of the beam and its reflection from below, per irradiance of the beam [1]
    beam_top: Array
    beam_bottom: Array
    diffuse_top: Numeric  # Irradiance of the sky's light, which does not depend on the beam [W/m²]
    diffuse_bottom: Numeric


class SphereLight(NamedTuple):
    """Light that falls on a sphere, the mean over its surface, in two parts."""

    # Irradiance of the beam and its reflection from below, per irradiance of the beam [1]
    beam: Array
    diffuse: Array  # Irradiance of the sky's light, which does not depend on the beam [W/m²]


class Exitances(NamedTuple):
    """What the sky and the ground send towards a flyer, evenly from all their directions."""

    sky: Numeric  # Irradiance of a face that sees nothing else
    ground: Numeric

    def mean_over_view(self, view_of_ground: Numeric) -> Array:
        """Irradiance of what sees so much of the ground, and of the sky the rest."""
        return self.sky + view_of_ground * (self.ground - self.sky)


class Radiation(Checked):
    r"""The beam of light, diffuse light, and heat radiation from above and below.

    Attributes
    ----------
    irradiance : array
        Irradiance of the beam on a surface that faces it [W/m²].
    zenith_angle : array
        Angle between the direction of the light's source and the vertical [rad].
    azimuth : array
        Horizontal direction of the source [rad].
    albedo : array
        Share of the beam's horizontal irradiance that the ground reflects, diffusely [1].
    diffuse_above : array
        Irradiance of diffuse light from above on a level face [W/m²].
    infrared_above, infrared_below : array or None
        Thermal irradiance from above and from below [W/m²]. None stands for black surroundings
        at the gas temperature, :math:`\sigma T_c^4`, as in the paper.
    ground_view : array or None
        View factor from a level face to the ground [1]; what is left of the lower half belongs to
        the sky above. None leaves it to the environment: over Earth :math:`(R/(R+h))^2` at the
        altitude h, elsewhere 1.
    stefan_boltzmann : array
        Stefan-Boltzmann constant [W/(m² K⁴)]; a field only because the paper's computed
        values rest on a rounded one.
    visible : array or None
        Share of the source that the flyer sees past a horizon [1]; None stands for all of it. The
        ground is lit by all of it.
    angular_radius : array or None
        Of the source's disk [rad]; None stands for a point. A disk that passes through the plane
        of a face lights both faces of a flyer, so that light is smooth in the direction.
    scattered : array or None
        Irradiance of a level face by light of the beam that the air scatters down, per irradiance
        of the beam [1]; None stands for none.
    lit_ground : array or None
        Mean cosine of the light's incidence on the ground that is seen [1]; None stands for the
        cosine at the flyer's nadir, zero where the source is below the horizontal.

    Raises
    ------
    ParameterError
        If a concrete value is out of its range.

    See Also
    --------
    sunlight : The same with the light and heat radiation that come from Earth.
    """

    irradiance: Irradiance = constants.TOTAL_SOLAR_IRRADIANCE
    zenith_angle: PolarAngle = 0.0
    azimuth: Angle = 0.0
    albedo: Fraction = 0.0
    diffuse_above: Irradiance = 0.0
    infrared_above: Infrared | None = None
    infrared_below: Infrared | None = None
    ground_view: Fraction | None = None
    stefan_boltzmann: Numeric = constants.STEFAN_BOLTZMANN
    visible: Fraction | None = None
    scattered: Fraction | None = None
    angular_radius: AngularRadius | None = None
    lit_ground: Fraction | None = None

    def with_ground_view(self, ground_view: Numeric) -> "Radiation":
        """The same, with this view factor to the ground where none is given."""
        if self.ground_view is not None:
            return self
        return tree.replace_at(lambda radiation: radiation.ground_view, self, ground_view)

    def describe(self, view: str = "1") -> tuple[str, ...]:
        """What reaches a flyer, in short texts with units.

        Examples
        --------
        >>> for text in Radiation(1000.0, albedo=0.3).describe():
        ...     print(text)
        light: 1000 W/m², 0° from the vertical
        reflected light: 0.3 of it (albedo), from below
        infrared: black surroundings at the gas temperature
        view factor of the ground: 1
        """
        angle = np.asarray(self.zenith_angle) / RADIANS_PER_DEGREE
        light = f"light: {span(self.irradiance)} W/m², {span(angle)}° from the vertical"
        if self.visible is not None and np.any(np.asarray(self.visible) < 1.0):
            light += f", of which a share of {span(self.visible)} is visible"
        if self.scattered is not None and np.any(self.scattered):
            light += f", and a share of {span(self.scattered)} scattered down"
        if np.any(self.diffuse_above):
            light += f", and diffuse {span(self.diffuse_above)} W/m² from above"
        reflects = bool(np.any(self.albedo))
        reflected = f"{span(self.albedo)} of it (albedo), from below" if reflects else "none"
        given = {"above": self.infrared_above, "below": self.infrared_below}
        black = all(infrared is None for infrared in given.values())
        infrared = ", ".join(
            f"from {side} {_BLACK if one is None else f'{span(one)} W/m²'}"
            for side, one in given.items()
        )
        told = [
            light,
            f"reflected light: {reflected}",
            f"infrared: {_BLACK if black else infrared}",
        ]
        if reflects or not black:
            seen = view if self.ground_view is None else span(self.ground_view)
            told.append(f"view factor of the ground: {seen}")
        return tuple(told)

    def views_of_ground(self, attitude: Attitude | None) -> tuple[Numeric, Numeric]:
        """View factors from the top and the bottom face to the ground [1]."""
        view = 1.0 if self.ground_view is None else self.ground_view
        if attitude is None:
            return 0.0, view
        return (
            ground_view_factor(np.pi - attitude.tilt, view),
            ground_view_factor(attitude.tilt, view),
        )

    def on_faces(self, attitude: Attitude | None = None) -> FaceLight:
        """Light on the two faces of a flat flyer; ``attitude``: by default level."""
        height = xp.cos(self.zenith_angle)
        facing = height
        if attitude is not None:
            sideways = xp.sin(self.zenith_angle) * xp.sin(attitude.tilt)
            facing = height * xp.cos(attitude.tilt) + sideways * xp.cos(
                self.azimuth - attitude.azimuth
            )
        top, bottom = self.views_of_ground(attitude)
        of_beam = self.diffuse_light()[0]
        return FaceLight(
            beam_top=self._beam(facing) + of_beam.mean_over_view(top),
            beam_bottom=self._beam(-facing) + of_beam.mean_over_view(bottom),
            diffuse_top=self.diffuse_above * (1.0 - top),
            diffuse_bottom=self.diffuse_above * (1.0 - bottom),
        )

    def _beam(self, cosine: Array) -> Array:
        """Irradiance of a face at this cosine of incidence, per irradiance of the beam [1]."""
        if self.angular_radius is None:
            return self.visible_part(xp.maximum(cosine, 0.0))
        return self.visible_part(facing_share(cosine, self.angular_radius))

    def visible_part(self, light: Numeric) -> Numeric:
        """What is left of the light of all the source where only part of it is visible."""
        return light if self.visible is None else self.visible * light

    def dimmed(self, share: Numeric) -> "Radiation":
        """The same with a share of all light, and all of the heat radiation."""
        return tree.replace_at(
            lambda radiation: (radiation.irradiance, radiation.diffuse_above),
            self,
            (share * self.irradiance, share * self.diffuse_above),
        )

    def beam_alone(self) -> "Radiation":
        """The same with all of the source visible, and without its reflection from the ground."""
        return replace(self, albedo=0.0, visible=None, scattered=None)

    def diffuse_light(self) -> tuple[Exitances, Exitances]:
        """Light from sky and ground; returns ``of_beam`` [1], ``diffuse`` [W/m²]."""
        lit = self.lit_ground
        lit = xp.maximum(xp.cos(self.zenith_angle), 0.0) if lit is None else lit
        scattered = 0.0 if self.scattered is None else self.scattered
        return Exitances(scattered, self.albedo * lit), Exitances(self.diffuse_above, 0.0)

    def infrared_exitances(self, gas_temperature: Numeric) -> Exitances:
        """Exitances of sky and ground beyond that of a black body at the gas temperature [W/m²]."""
        black = self.stefan_boltzmann * gas_temperature**4
        return Exitances(
            *(
                xp.zeros_like(black) if infrared is None else infrared - black
                for infrared in (self.infrared_above, self.infrared_below)
            )
        )

    @property
    def sphere_view_of_ground(self) -> Array:
        """View factor from a sphere to the ground [1]."""
        return sphere_view_factor(1.0 if self.ground_view is None else self.ground_view)

    @property
    def edge_of_ground(self) -> Array:
        r"""Cosine of the half-angle :math:`\gamma` of the ground's disk [1]."""
        # Also the sine of the angle between the horizontal and the ground's edge.
        return 1.0 - 2.0 * self.sphere_view_of_ground

    def on_sphere(self) -> SphereLight:
        """Light on a sphere, which intercepts a quarter of its surface of the beam."""
        ground = self.sphere_view_of_ground
        reflected, diffuse = self.diffuse_light()
        beam = self.visible_part(_OF_BEAM) + reflected.mean_over_view(ground)
        return SphereLight(beam, diffuse.mean_over_view(ground))

    def infrared_excess_on_sphere(self, gas_temperature: Numeric) -> Array:
        """Thermal irradiance of a sphere beyond that of black surroundings at gas temperature."""
        return self.infrared_exitances(gas_temperature).mean_over_view(self.sphere_view_of_ground)

    def infrared_excess(
        self, gas_temperature: Numeric, attitude: Attitude | None = None
    ) -> tuple[Array, Array]:
        """Thermal irradiance on each face beyond that of black surroundings at gas temperature."""
        exitances = self.infrared_exitances(gas_temperature)
        top, bottom = self.views_of_ground(attitude)
        return exitances.mean_over_view(top), exitances.mean_over_view(bottom)


def sunlight(
    irradiance: Numeric = constants.TOTAL_SOLAR_IRRADIANCE,
    zenith_angle: Numeric = 0.0,
    *,
    albedo: Numeric = EARTH_ALBEDO,
    infrared_above: Numeric | None = SKY_INFRARED,
    infrared_below: Numeric | None = EARTH_INFRARED,
) -> Radiation:
    """Sunlight above Earth, with the light and the heat radiation that come from below.

    Parameters
    ----------
    irradiance : array
        Of the sun on a surface that faces it [W/m²].
    zenith_angle : array
        Between sun and vertical [rad].
    albedo : array
        Share of sunlight that Earth reflects [1]. Of one place it differs from the global mean:
        about 0.1 over cloudless sea, 0.7 over ice and thick cloud.
    infrared_above, infrared_below : array or None
        Heat radiation from the sky and from Earth [W/m²]; None for black surroundings at the gas
        temperature.

    Returns
    -------
    Radiation
        Whose view factor to the ground is left to the environment.

    References
    ----------
    [Gueymard2018]_ for the sun, [Loeb2018]_ for Earth.
    """
    return Radiation(
        irradiance,
        zenith_angle,
        albedo=albedo,
        infrared_above=infrared_above,
        infrared_below=infrared_below,
    )
