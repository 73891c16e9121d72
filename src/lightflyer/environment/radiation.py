"""Light and heat radiation that reach a flyer."""

from typing import NamedTuple

import jax.numpy as jnp
from jax import Array

from lightflyer.environment.view_factor import ground_view_factor
from lightflyer.foundation import constants
from lightflyer.foundation.quantity import Angle, Checked, Fraction, Irradiance, PolarAngle
from lightflyer.foundation.types import Numeric


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
    """Light that falls on the two faces of a flat flyer, in two parts.

    Attributes
    ----------
    beam_top, beam_bottom : array, shape (...)
        Irradiance of the beam and its reflection from below, per irradiance of the beam [1].
    diffuse_top, diffuse_bottom : array, shape (...)
        Irradiance of the sky's light, which does not depend on the beam [W/m²].
    """

    beam_top: Array
    beam_bottom: Array
    diffuse_top: Numeric
    diffuse_bottom: Numeric


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
    ground_view : array
        View factor from a level face to the ground, :math:`(R/(R+h))^2` [1]; what is left of the
        lower half belongs to the sky above.
    stefan_boltzmann : array
        Stefan-Boltzmann constant [W/(m² K⁴)]; a field only because the paper's computed
        values rest on a rounded one.

    Raises
    ------
    ParameterError
        If a concrete value is out of its range.
    """

    irradiance: Irradiance = constants.SOLAR_CONSTANT
    zenith_angle: PolarAngle = 0.0
    azimuth: Angle = 0.0
    albedo: Fraction = 0.0
    diffuse_above: Irradiance = 0.0
    infrared_above: Irradiance | None = None
    infrared_below: Irradiance | None = None
    ground_view: Fraction = 1.0
    stefan_boltzmann: Numeric = constants.STEFAN_BOLTZMANN

    def views_of_ground(self, attitude: Attitude | None) -> tuple[Numeric, Numeric]:
        """View factors from the top and the bottom face to the ground [1].

        Parameters
        ----------
        attitude : Attitude or None
            None stands for a level flyer.

        Returns
        -------
        top, bottom : array, shape (...)
        """
        if attitude is None:
            return 0.0, self.ground_view
        return (
            ground_view_factor(jnp.pi - attitude.tilt, self.ground_view),
            ground_view_factor(attitude.tilt, self.ground_view),
        )

    def on_faces(self, attitude: Attitude | None = None) -> FaceLight:
        """Light on the two faces of a flat flyer.

        Parameters
        ----------
        attitude : Attitude, optional
            By default level.

        Returns
        -------
        FaceLight
        """
        height = jnp.cos(self.zenith_angle)
        facing = height
        if attitude is not None:
            sideways = jnp.sin(self.zenith_angle) * jnp.sin(attitude.tilt)
            facing = height * jnp.cos(attitude.tilt) + sideways * jnp.cos(
                self.azimuth - attitude.azimuth
            )
        top, bottom = self.views_of_ground(attitude)
        reflected = self.albedo * jnp.maximum(height, 0.0)
        return FaceLight(
            beam_top=jnp.maximum(facing, 0.0) + reflected * top,
            beam_bottom=jnp.maximum(-facing, 0.0) + reflected * bottom,
            diffuse_top=self.diffuse_above * (1.0 - top),
            diffuse_bottom=self.diffuse_above * (1.0 - bottom),
        )

    def infrared_excess(
        self, gas_temperature: Numeric, attitude: Attitude | None = None
    ) -> tuple[Array, Array]:
        """Thermal irradiance on each face beyond that of black surroundings at gas temperature.

        Parameters
        ----------
        gas_temperature : array, shape (...)
            [K].
        attitude : Attitude, optional
            By default level.

        Returns
        -------
        top, bottom : array, shape (...)
            [W/m²]; zero where both surroundings are None.
        """
        black = self.stefan_boltzmann * gas_temperature**4
        above, below = (
            jnp.zeros_like(black) if infrared is None else infrared - black
            for infrared in (self.infrared_above, self.infrared_below)
        )
        top, bottom = self.views_of_ground(attitude)
        return above + top * (below - above), above + bottom * (below - above)
