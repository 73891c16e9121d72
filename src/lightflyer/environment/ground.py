"""What the ground and the air above it send up: reflected light and heat radiation."""

import abc

import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import Place
from lightflyer.environment.radiation import EARTH_ALBEDO, EARTH_INFRARED
from lightflyer.foundation.quantity import Checked, Fraction, Irradiance
from lightflyer.foundation.text import span


class AbstractGround(Checked):
    """Albedo and heat radiation of a planet, clouds included, by place and time.

    Subclasses are final. Methods work under JAX's transformations.
    """

    @abc.abstractmethod
    def albedo(self, place: Place) -> Array:
        """Share of sunlight that leaves again, evenly in all directions [1]."""

    @abc.abstractmethod
    def infrared(self, place: Place) -> Array:
        """Heat radiation that leaves the planet [W/m²]."""

    @abc.abstractmethod
    def describe(self) -> tuple[str, ...]:
        """Where albedo and heat radiation come from, in short texts with units."""


class UniformGround(AbstractGround):
    """The same everywhere and always.

    Attributes
    ----------
    share : array
        Albedo [1]; default :data:`EARTH_ALBEDO`.
    exitance : array
        Heat radiation [W/m²]; default :data:`EARTH_INFRARED`.
    """

    share: Fraction = EARTH_ALBEDO
    exitance: Irradiance = EARTH_INFRARED

    def albedo(self, place: Place) -> Array:
        """See :meth:`AbstractGround.albedo`."""
        return self.share + jnp.zeros_like(place.latitude + place.time)

    def infrared(self, place: Place) -> Array:
        """See :meth:`AbstractGround.infrared`."""
        return self.exitance + jnp.zeros_like(place.latitude + place.time)

    def describe(self) -> tuple[str, ...]:
        """See :meth:`AbstractGround.describe`."""
        return (
            f"albedo: {span(self.share)} everywhere",
            f"infrared from below: {span(self.exitance)} W/m² everywhere",
        )
