"""The sun by date: its direction, its distance, its place in the sky, and a table of it.

Earth's heliocentric longitude and distance are the largest terms of the series that
[RedaAndreas2004]_ uses, with nutation, aberration and sidereal time as [Meeus1998]_ has them.
"""

import abc
import math
from typing import Any, Final, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, short_repr
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import RADIANS_PER_DEGREE
from lightflyer.environment.base import Place

SECONDS_PER_DAY: Final = 86_400.0
DAYS_PER_CENTURY: Final = 36_525.0
DAYS_PER_MILLENNIUM: Final = 365_250.0

TERRESTRIAL_MINUS_UNIVERSAL: Final = 69.184
"""Terrestrial time beyond UTC since 2017 [s]; [IERS2017]_.

Between 1950 and 2050 it differs by less than 60 s, in which the sun moves by 0.0007°.
"""

_TERMS = 1e-8  # amplitudes of the tables below are in 1e-8 rad and 1e-8 au

# Amplitude, phase [rad] and angular velocity [rad/millennium] of cosines: [RedaAndreas2004]_
# table A4.2; the terms left out are smaller.
_LONGITUDE_0 = np.array([
    (175347046.0, 0.0, 0.0),
    (3341656.0, 4.6692568, 6283.07585),
    (34894.0, 4.6261, 12566.1517),
    (3497.0, 2.7441, 5753.3849),
    (3418.0, 2.8289, 3.5231),
    (3136.0, 3.6277, 77713.7715),
    (2676.0, 4.4181, 7860.4194),
    (2343.0, 6.1352, 3930.2097),
    (1324.0, 0.7425, 11506.7698),
    (1273.0, 2.0371, 529.691),
    (1199.0, 1.1096, 1577.3435),
    (990.0, 5.233, 5884.927),
    (902.0, 2.045, 26.298),
    (857.0, 3.508, 398.149),
    (780.0, 1.179, 5223.694),
    (753.0, 2.533, 5507.553),
    (505.0, 4.583, 18849.228),
    (492.0, 4.205, 775.523),
])  # fmt: skip
_LONGITUDE_1 = np.array([
    (628331966747.0, 0.0, 0.0),
    (206059.0, 2.678235, 6283.07585),
    (4303.0, 2.6351, 12566.1517),
])  # fmt: skip
_LONGITUDE_2 = np.array([(52919.0, 0.0, 0.0)])
_DISTANCE_0 = np.array([
    (100013989.0, 0.0, 0.0),
    (1670700.0, 3.0984635, 6283.07585),
    (13956.0, 3.05525, 12566.1517),
    (3084.0, 5.1985, 77713.7715),
    (1628.0, 1.1739, 5753.3849),
    (1576.0, 2.8469, 7860.4194),
])  # fmt: skip
_DISTANCE_1 = np.array([(103019.0, 1.10749, 6283.07585)])

# Polynomials of Julian centuries, lowest power first [deg]; [Meeus1998]_ Eqs. (22.2) and (12.4)
_OBLIQUITY = (23.4392911, -0.0130042)
_NODE = (125.04452, -1934.136261)  # of the moon's orbit, [Meeus1998]_ ch. 22
_MEAN_LONGITUDE = (280.4665, 36000.7698)
_SIDEREAL_ANGLE, _SIDEREAL_RATE, _SIDEREAL_GROWTH = 280.46061837, 360.98564736629, 0.000387933
_ARC_SECOND = RADIANS_PER_DEGREE / 3600.0
_NUTATION_LONGITUDE = (-17.20, -1.32)  # sines of the node, of twice the sun's mean longitude ["]
_NUTATION_OBLIQUITY = (9.20, 0.57)  # cosines of the same ["]
_ABERRATION = -20.4898  # at one astronomical unit ["]; [Meeus1998]_ Eq. (25.10)


class SunPosition(NamedTuple):
    """Where the sun is, seen from a planet's centre."""

    #: shape (..., 3); unit vector in the frame that turns with the planet: its third axis is the
    #: rotation's, its first points to where equator and prime meridian meet
    direction: Array
    distance: Array  #: shape (...) [m]

    def __repr__(self) -> str:
        return short_repr(self)


class SunInSky(NamedTuple):
    """Where the sun stands in the sky of a place, without refraction."""

    zenith_angle: Array  #: Between the sun's centre and the vertical [rad]
    azimuth: Array  #: From north by way of east [rad], -π to π
    distance: Array  #: [m]

    def __repr__(self) -> str:
        return short_repr(self)


class AbstractSun(Module):
    """The sun of a planet. Subclasses are final and give :meth:`position`."""

    @abc.abstractmethod
    def position(self, time: Numeric) -> SunPosition:
        """Direction and distance of the sun; ``time``: since 2000-01-01 12:00 UTC [s]."""

    def position_above(self, place: Place) -> SunInSky:
        """Where the sun stands in the sky of a place."""
        found = self.position(place.time)
        return sun_in_sky(found, place.latitude, place.longitude)


class EarthSun(AbstractSun):
    """The sun of Earth; see :func:`sun_from_earth`.

    Examples
    --------
    Noon in Greenwich at the June solstice of 2024:

    >>> from lightflyer.environment import Place
    >>> solstice = Place(latitude=0.8985, longitude=0.0, time=772_243_200.0)
    >>> sun = EarthSun().position_above(solstice)
    >>> print(f"{np.degrees(sun.zenith_angle):.2f}°")
    28.05°
    """

    def position(self, time: Numeric) -> SunPosition:
        return sun_from_earth(time)


@entry_point
def sun_from_earth(time: Numeric) -> SunPosition:
    """Apparent direction and distance of the sun from the centre of Earth."""
    # Between 1950 and 2050 within 0.002° and 3e-5 of the distance of the full theory of the
    # International Astronomical Union. Earth's rotation is taken from UTC, which since 1972 differs
    # from it by at most 0.9 s, or 0.004°. Differentiable.
    #
    # Source: [RedaAndreas2004]_, [Meeus1998]_ ch. 12, 22 and 25.
    days = time / SECONDS_PER_DAY
    terrestrial = days + TERRESTRIAL_MINUS_UNIVERSAL / SECONDS_PER_DAY
    millennia = terrestrial / DAYS_PER_MILLENNIUM
    # of Earth from the sun [rad], [au]; its latitude stays below 1.2″
    longitude = _TERMS * (
        _cosines(_LONGITUDE_0, millennia)
        + _cosines(_LONGITUDE_1, millennia) * millennia
        + _cosines(_LONGITUDE_2, millennia) * millennia**2
    )
    distance = _cosines(_DISTANCE_0, millennia) + _cosines(_DISTANCE_1, millennia) * millennia
    distance = distance * _TERMS
    centuries = terrestrial / DAYS_PER_CENTURY
    node, mean_longitude = (
        (first + rate * centuries) * RADIANS_PER_DEGREE for first, rate in (_NODE, _MEAN_LONGITUDE)
    )
    by_node, by_sun = _NUTATION_LONGITUDE
    nutation = by_node * xp.sin(node) + by_sun * xp.sin(2.0 * mean_longitude)
    nutation = nutation * _ARC_SECOND
    by_node, by_sun = _NUTATION_OBLIQUITY
    tilt = by_node * xp.cos(node) + by_sun * xp.cos(2.0 * mean_longitude)
    mean = (_OBLIQUITY[0] + _OBLIQUITY[1] * centuries) * RADIANS_PER_DEGREE
    obliquity = mean + tilt * _ARC_SECOND
    apparent = longitude + np.pi + nutation + _ABERRATION * _ARC_SECOND / distance
    # right ascension is where the ecliptic's vector points in the equator's frame
    along, ahead = xp.cos(apparent), xp.sin(apparent)
    equatorial = along, xp.cos(obliquity) * ahead, xp.sin(obliquity) * ahead
    # mean sidereal time of Greenwich
    sidereal = _SIDEREAL_ANGLE + _SIDEREAL_RATE * days
    sidereal = sidereal + _SIDEREAL_GROWTH * (days / DAYS_PER_CENTURY) ** 2
    turned = sidereal * RADIANS_PER_DEGREE + nutation * xp.cos(obliquity)
    direction = xp.stack(
        [
            xp.cos(turned) * equatorial[0] + xp.sin(turned) * equatorial[1],
            xp.cos(turned) * equatorial[1] - xp.sin(turned) * equatorial[0],
            equatorial[2],
        ],
        axis=-1,
    )
    return SunPosition(direction, distance * constants.ASTRONOMICAL_UNIT)


def _cosines(terms: np.ndarray, millennia: Array) -> Array:
    amplitude, phase, rate = terms.T
    return xp.sum(amplitude * xp.cos(phase + rate * xp.asarray(millennia)[..., None]), axis=-1)


@entry_point
def sun_in_sky(sun: SunPosition, latitude: Numeric, longitude: Numeric) -> SunInSky:
    """Where the sun stands above a place; of the broadcast shape; ``sun``: of shape (...)."""
    # Seen from the planet's centre: from its surface the sun stands up to 0.0024° lower over Earth.
    # Differentiable; where the sun stands in the zenith or the nadir, the derivatives of the angles
    # are those of a sun that stays there.
    x, y, z = (sun.direction[..., axis] for axis in range(3))
    outward = xp.cos(longitude) * x + xp.sin(longitude) * y
    east = xp.cos(longitude) * y - xp.sin(longitude) * x
    north = xp.cos(latitude) * z - xp.sin(latitude) * outward
    up = xp.cos(latitude) * outward + xp.sin(latitude) * z
    level = east**2 + north**2
    overhead = level == 0.0
    sideways = xp.where(overhead, 0.0, xp.sqrt(xp.where(overhead, 1.0, level)))
    return SunInSky(
        zenith_angle=xp.arctan2(sideways, up),
        azimuth=xp.arctan2(xp.where(overhead, 0.0, east), xp.where(overhead, 1.0, north)),
        distance=sun.distance,
    )


_SPACING = 2.0 * SECONDS_PER_DAY  # in which cubics follow the sun to 1e-7
_FEWEST = 4  # points of a cubic spline


class TabulatedSun(AbstractSun):
    """Another sun between two times, several times as fast.

    Direction, in a frame that does not turn with the planet, and distance are cubic splines of
    time with two days between nodes, within 1e-7 of the other sun's.

    Parameters
    ----------
    sun : AbstractSun
    rotation_rate : float
        Of the planet [rad/s].
    start, stop : float
        [s since 2000-01-01 12:00 UTC].

    Raises
    ------
    ParameterError
        If the span is empty.

    Examples
    --------
    >>> from lightflyer.environment import EARTH_PLANET, EarthSun
    >>> table = TabulatedSun(EarthSun(), EARTH_PLANET.rotation_rate, 8.2e8, 8.3e8)
    >>> apart = table.position(8.21e8).direction - EarthSun().position(8.21e8).direction
    >>> bool(abs(apart).max() < 1e-7)
    True
    """

    start: float
    spacing: float
    rotation_rate: float
    coefficients: Any

    def __init__(self, sun: AbstractSun, rotation_rate: float, start: float, stop: float):
        from scipy.interpolate import CubicSpline  # half a second that most uses can spare

        if not start < stop:
            raise ParameterError(f"a table of the sun from {start:g} s to {stop:g} s is empty")
        count = max(_FEWEST, math.ceil((stop - start) / _SPACING) + 1)
        nodes = np.linspace(start, stop, count)
        found = sun.position(nodes)
        x, y, z = found.direction.T
        turned = rotation_rate * (nodes - start)
        cosine, sine = np.cos(turned), np.sin(turned)
        fixed = [x * cosine - y * sine, x * sine + y * cosine, z, found.distance]
        spline = CubicSpline(nodes, np.stack(fixed, axis=-1))
        self.start, self.spacing, self.rotation_rate = start, nodes[1] - nodes[0], rotation_rate
        self.coefficients = np.moveaxis(spline.c, 0, 1)  # of each piece, highest power first

    @entry_point
    def position(self, time: Numeric) -> SunPosition:
        """Position of the sun; NaN outside the table."""
        since = time - self.start
        pieces = self.coefficients.shape[0]
        within = (since >= 0.0) & (since <= pieces * self.spacing * (1.0 + 1e-12))
        piece = xp.clip(since // self.spacing, 0, pieces - 1).astype(int)
        along = (since - piece * self.spacing)[..., None]
        third, second, first, zeroth = xp.moveaxis(self.coefficients[piece], -2, 0)
        fixed = ((third * along + second) * along + first) * along + zeroth
        x, y, z, distance = xp.moveaxis(fixed, -1, 0)
        turned = self.rotation_rate * since
        cosine, sine = xp.cos(turned), xp.sin(turned)
        direction = xp.stack([x * cosine + y * sine, y * cosine - x * sine, z], axis=-1)
        return SunPosition(
            xp.where(within[..., None], direction, np.nan), xp.where(within, distance, np.nan)
        )
