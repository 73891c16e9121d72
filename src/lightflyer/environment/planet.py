"""A planet: its size, shape and rotation."""

from typing import Any, Final

import equinox as eqx
import jax.numpy as jnp
from jax import Array

from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.quantity import Checked, Flattening, PlanetRadius, RotationRate
from lightflyer.foundation.types import Numeric


class Planet(Checked):
    r"""An ellipsoid of revolution that turns about its polar axis.

    Attributes
    ----------
    name : str
    radius : array
        Mean radius :math:`(2a+b)/3` of the equatorial radius a and the polar radius b [m].
    rotation_rate : array
        Angular velocity against the stars, positive towards the east [rad/s].
    flattening : array
        :math:`(a-b)/a` [1]; zero makes a sphere.

    Raises
    ------
    ParameterError
        If a concrete value is out of its range.

    Examples
    --------
    >>> print(f"{EARTH_PLANET.equatorial_radius / 1e3:.3f} km")
    6378.137 km
    """

    name: str = eqx.field(static=True)
    radius: PlanetRadius
    rotation_rate: RotationRate
    flattening: Flattening = 0.0

    @property
    def equatorial_radius(self) -> Any:
        """Radius of the equator [m]."""
        return self.radius / (1.0 - self.flattening / 3.0)

    def curvature_radius(self, latitude: Numeric, azimuth: Numeric) -> Array:
        r"""Radius of curvature of the ellipsoid along a direction.

        .. math:: \frac1{R} = \frac{\cos^2 A}{M} + \frac{\sin^2 A}{N}

        with the radii of curvature M of the meridian and N of the prime vertical.

        Parameters
        ----------
        latitude : array, shape (...)
            Geodetic [rad].
        azimuth : array, shape (...)
            A, from north by way of east [rad].

        Returns
        -------
        array, broadcast shape
            [m].

        Notes
        -----
        Euler's theorem on the curvature of surfaces. Differentiable.
        """
        return _curvature_radius(self, latitude, azimuth)


@entry_point
def _curvature_radius(planet: Planet, latitude: Numeric, azimuth: Numeric) -> Array:
    flattening = planet.flattening
    eccentricity_squared = flattening * (2.0 - flattening)
    root = 1.0 - eccentricity_squared * jnp.sin(latitude) ** 2
    across = planet.equatorial_radius / jnp.sqrt(root)
    along = across * (1.0 - eccentricity_squared) / root
    return 1.0 / (jnp.cos(azimuth) ** 2 / along + jnp.sin(azimuth) ** 2 / across)


EARTH_PLANET: Final = Planet(
    name="Earth",
    radius=6_371_008.7714,
    rotation_rate=7.292115e-5,
    flattening=1.0 / 298.257223563,
)
"""Earth as the World Geodetic System 1984 has it; [NIMA2000]_."""

MARS_PLANET: Final = Planet(
    name="Mars",
    radius=3_389_527.0,
    rotation_rate=7.0882181e-5,
    flattening=0.005886,
)
"""Mars; size and rotation by [Archinal2018]_."""
