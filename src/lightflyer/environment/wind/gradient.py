"""Gradient wind: the zonal wind that balances the pressure of a model atmosphere."""

from typing import Any

import numpy as np
from numpy.polynomial import legendre

from lightflyer.array.namespace import Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Altitude, require_record
from lightflyer.environment.atmosphere.nrlmsis import TROPICAL_YEAR, GlobalNRLMSIS
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.environment.wind.base import AbstractWind
from lightflyer.numerics.interpolation import Axis, interpolate

HIGHEST = 100e3
"""Altitude above which tides, waves and ions drive more of the wind than the balance holds [m]."""

NEAREST_EQUATOR = 15.0 * RADIANS_PER_DEGREE
"""Latitude below which the Coriolis force is too weak for the balance [rad]."""

CLOSE_TO_EQUATOR = 20.0 * RADIANS_PER_DEGREE  # Latitude below which the balance is doubtful [rad]

_LATITUDES = np.arange(12.5, 92.6, 2.5) * RADIANS_PER_DEGREE
_SPACING = 2e3
_ALTITUDES = np.arange(0.0, HIGHEST + 1.0, _SPACING)
_SEASONS = np.arange(24) / 24 * TROPICAL_YEAR
_DEGREE = 12  # of the Legendre series in latitude: beyond, the model has nothing

_EQUATOR = "latitude within 15° of the equator, where there is no gradient wind"
_ABOVE = "altitude above 100 km, where the gradient wind ends"

# Gravity on the ellipsoid at equator and pole [m/s²], and the ratio of the centrifugal force to
# gravity at the equator; [NIMA2000]_ ch. 3.
_GRAVITY_EQUATOR, _GRAVITY_POLE = 9.7803253359, 9.8321849378
CENTRIFUGAL = 0.00344978650684


@entry_point
def balanced_rotation(forcing: Numeric, sine_latitude: Numeric, rotation_rate: Numeric) -> Any:
    """Angular velocity of a zonal wind in gradient balance [rad/s]; ``forcing`` [1/s²]."""
    # .. math::
    #
    #     \omega = -\frac{\Omega A}{1 + \sqrt{1 - A}}, \qquad
    #     A = \frac{F}{\Omega^2 \sin\varphi}, \qquad
    #     F = \frac{1}{d \cos\varphi} \left(\frac{1}{\rho} \frac{\partial p}{\partial y} +
    #         \frac{\partial \Phi}{\partial y}\right)
    #
    # is the regular one of the two solutions of :math:`u^2 \tan\varphi/d + 2 \Omega u \sin\varphi +
    # \rho^{-1} \partial p/\partial y + \partial \Phi/\partial y = 0` for the wind :math:`u = \omega
    # d \cos\varphi`, at the distance d of the ellipsoid's normal from the place to the polar axis.
    # For small A it is the geostrophic wind.
    #
    # Source: [Andrews1987]_ ch. 3, [Lieberman1999]_.
    ratio = forcing / (rotation_rate**2 * sine_latitude)
    return -rotation_rate * ratio / (1.0 + xp.sqrt(1.0 - ratio))


def normal_gravity(sine: Any) -> Any:
    """Gravity on the ellipsoid [m/s²], from the sine of the latitude; Somigliana's formula."""
    flattening = EARTH_PLANET.flattening
    excess = (1.0 - flattening) * _GRAVITY_POLE / _GRAVITY_EQUATOR - 1.0
    root = 1.0 - flattening * (2.0 - flattening) * sine**2
    return _GRAVITY_EQUATOR * (1.0 + excess * sine**2) / np.sqrt(root)


def _geopotential_slope(sine: np.ndarray, altitude: np.ndarray) -> np.ndarray:
    """Derivative of the geopotential at an altitude in the sine of the latitude [m²/s²]."""
    # Gravity on the ellipsoid by Somigliana's formula, above by its Taylor series; [NIMA2000]_ ch.
    # 4.
    flattening, equator = EARTH_PLANET.flattening, EARTH_PLANET.equatorial_radius
    squeezed = flattening * (2.0 - flattening)
    excess = (1.0 - flattening) * _GRAVITY_POLE / _GRAVITY_EQUATOR - 1.0
    root = 1.0 - squeezed * sine**2
    gravity = normal_gravity(sine)
    slope = gravity * sine * (2.0 * excess / (1.0 + excess * sine**2) + squeezed / root)
    linear = 1.0 + flattening + CENTRIFUGAL - 2.0 * flattening * sine**2
    height = altitude - linear * altitude**2 / equator + altitude**3 / equator**2
    return slope * height + gravity * 4.0 * flattening * sine * altitude**2 / equator


class GradientWind(AbstractWind):
    r"""Zonal wind in balance with the pressure of NRLMSIS 2.1, without any wind data.

    The pressure is the mean over longitude and time of day. In the north-south direction its
    gradient is balanced by the Coriolis force and, the cyclostrophic term, the centrifugal force
    of the wind around the planet's axis: :func:`balanced_rotation`. There is no wind towards the
    north or up.

    Parameters
    ----------
    atmosphere : GlobalNRLMSIS

    Raises
    ------
    ParameterError
        If it is another atmosphere.

    Notes
    -----
    Valid from 15° of latitude to the poles, 0 to 100 km. It is a climatology of the mean over
    longitude: tides, planetary waves, gravity waves and the weather are left out; they change the
    wind by 10 m/s to 50 m/s, the more the higher. Closer than 20° to the equator, and above 85 km,
    it tells little more than the sign.

    Examples
    --------
    The middle of July at 45° N, 60 km:

    >>> wind = GradientWind(GlobalNRLMSIS(f107=150.0, ap=4.0))
    >>> july = 774_360_000.0
    >>> print(f"{wind.velocity(60e3, Place(0.785, 0.0, july)).east:.0f} m/s")
    -64 m/s
    """

    rotations: Any
    seasons: Axis
    latitudes: Axis
    altitudes: Axis

    def __init__(self, atmosphere: GlobalNRLMSIS):
        require_record("atmosphere", (GlobalNRLMSIS,), atmosphere)
        latitude, altitude, temperature, log_pressure, ratio = atmosphere.zonal_means(_SEASONS)
        chosen = np.searchsorted(altitude, _ALTITUDES)
        temperature, log_pressure, ratio = (
            field[:, :, chosen] for field in (temperature, log_pressure, ratio)
        )
        nodes = np.concatenate([-_LATITUDES[::-1], _LATITUDES])
        sine = np.sin(nodes)[:, None]
        fit = np.linalg.pinv(legendre.legvander(np.sin(latitude), _DEGREE))
        of_node = legendre.legvander(sine[:, 0], _DEGREE) @ fit
        slopes = [legendre.legval(sine[:, 0], legendre.legder(row)) for row in fit.T]
        slope_of = np.stack(slopes, -1)
        molar_mass = constants.MOLAR_MASS_AIR * (of_node @ ratio)
        gas_constant = constants.GAS_CONSTANT_US1976 / molar_mass
        push = gas_constant * (of_node @ temperature) * (slope_of @ log_pressure)
        push = push + _geopotential_slope(sine, _ALTITUDES)
        along, across = (EARTH_PLANET.curvature_radius(nodes, angle) for angle in (0.0, np.pi / 2))
        distances = (along[:, None] + _ALTITUDES) * (across[:, None] + _ALTITUDES)
        self.rotations = balanced_rotation(push / distances, sine, EARTH_PLANET.rotation_rate)
        self.seasons = Axis(_SEASONS, TROPICAL_YEAR)
        self.latitudes = Axis(nodes)
        self.altitudes = Axis(_ALTITUDES)

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return self._require_margins(altitude, place, _velocity(self, altitude, place))

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        from_equator = abs(place.latitude) - NEAREST_EQUATOR
        return {
            _EQUATOR: from_equator / RADIANS_PER_DEGREE,
            _ABOVE: (HIGHEST - altitude) / _SPACING,
        }

    def describe(self) -> tuple[str, ...]:
        return (
            "wind: gradient wind of NRLMSIS 2.1, mean over longitude and day, without tides, waves "
            "and weather, nothing towards the north or up",
        )


@entry_point
def _velocity(wind: GradientWind, altitude: Altitude, place: Place) -> Wind:
    rotation = interpolate(
        wind.rotations,
        (wind.seasons, wind.latitudes, wind.altitudes),
        (place.time, place.latitude, altitude),
    )
    distance = EARTH_PLANET.curvature_radius(place.latitude, np.pi / 2) + altitude
    east = rotation * distance * xp.cos(place.latitude)
    return Wind(east, xp.zeros_like(east), xp.zeros_like(east))
