"""What the ground and the air above it send up: reflected light and heat radiation."""

import abc
from typing import Final

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Checked, Fraction, Infrared
from lightflyer.core.text import span
from lightflyer.environment.base import Place
from lightflyer.environment.radiation import EARTH_ALBEDO, EARTH_INFRARED


class AbstractGround(Checked):
    """Albedo and heat radiation of a planet, clouds included, by place and time.

    Subclasses are final. Methods work under JAX's transformations.
    """

    @abc.abstractmethod
    def albedo_at(self, place: Place) -> Array:
        """Share of sunlight that leaves again, evenly in all directions [1], shape (...)."""

    @abc.abstractmethod
    def infrared_at(self, place: Place) -> Array:
        """Heat radiation that leaves the planet [W/m²], shape (...)."""

    def margins(self, place: Place) -> dict[str, Numeric]:  # noqa: ARG002
        """How far the data still reach, for what integrates along a path.

        By what is beyond the end, in words, the distance to it: negative where there are no data.
        """
        return {}

    @abc.abstractmethod
    def describe(self) -> tuple[str, ...]:
        """Where albedo and heat radiation come from, in short texts with units."""


class UniformGround(AbstractGround):
    """The same everywhere and always.

    Attributes
    ----------
    albedo : array
        Share of sunlight that leaves again [1]; default :data:`EARTH_ALBEDO`.
    infrared : array
        Heat radiation [W/m²]; default :data:`EARTH_INFRARED`.
    """

    albedo: Fraction = EARTH_ALBEDO
    infrared: Infrared = EARTH_INFRARED

    def albedo_at(self, place: Place) -> Array:
        return _everywhere(self.albedo, place)

    def infrared_at(self, place: Place) -> Array:
        return _everywhere(self.infrared, place)

    def describe(self) -> tuple[str, ...]:
        return (
            f"albedo: {span(self.albedo)} everywhere",
            f"infrared from below: {span(self.infrared)} W/m² everywhere",
        )


@entry_point
def _everywhere(value: Numeric, place: Place) -> Array:
    return value + 0.0 * (place.latitude + place.longitude + place.time)


SECONDS_PER_YEAR: Final = 365.25 * 86_400.0  # Period of the seasons in [Knocke1988]_ [s]

_MIDWINTER = -6584.5 * 86_400.0  # 22 December 1981, 0 h [s since 2000-01-01 12:00 UTC]
# Mean, amplitude of the season's first and mean second Legendre polynomial of the sine of latitude
_ALBEDO = (0.34, 0.10, 0.29)
_EMISSIVITY = (0.68, -0.07, -0.18)
_OF_SUN = 0.25  # of sunlight is what a sphere receives on average over its surface


class Knocke1988Ground(AbstractGround):
    r"""Zonal means with seasons, fitted to satellites' measurements.

    .. math:: x_0 + x_1\cos\left(2\pi\frac{t-t_0}{\text{year}}\right)P_1(\sin\varphi)
        + x_2 P_2(\sin\varphi)

    for the albedo and for the heat radiation over a quarter of the sunlight at one astronomical
    unit, with Legendre polynomials P and midwinter :math:`t_0`.

    Notes
    -----
    Albedo 0.20 at the equator and 0.53 to 0.73 at the poles. The mean of the sunlight reflected
    is 0.30 of what falls on Earth; heat radiation is 231 W/m² on average, where newer
    measurements have 240 W/m² [Loeb2018]_. Of a single place and day, clouds make the albedo
    differ by 0.1 or more.

    References
    ----------
    [Knocke1988]_.
    """

    def albedo_at(self, place: Place) -> Array:
        return _zonal(_ALBEDO, place)

    def infrared_at(self, place: Place) -> Array:
        return _OF_SUN * constants.TOTAL_SOLAR_IRRADIANCE * _zonal(_EMISSIVITY, place)

    def describe(self) -> tuple[str, ...]:
        return (
            "albedo: zonal means with seasons of Knocke and others (1988)",
            "infrared from below: zonal means with seasons of Knocke and others (1988)",
        )


@entry_point
def _zonal(coefficients: tuple[float, float, float], place: Place) -> Array:
    mean, seasonal, curved = coefficients
    sine = xp.sin(place.latitude) + 0.0 * place.longitude
    season = xp.cos(2.0 * np.pi * (place.time - _MIDWINTER) / SECONDS_PER_YEAR)
    return mean + seasonal * season * sine + curved * 0.5 * (3.0 * sine**2 - 1.0)
