r"""Horizontal Wind Model 2014, its quiet part, from the model's own data file.

The wind is a sum of vector spherical harmonics: of the zonal mean, of waves that stand over the
ground, :math:`m\lambda`, and of tides that follow the sun, :math:`l t`. Each amplitude is a sum of
harmonics of the year, and a cubic B-spline over altitude.
"""

from itertools import islice
from math import factorial
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Altitude
from lightflyer.environment.atmosphere.nrlmsis import TROPICAL_YEAR
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind

HIGHEST = 110e3
"""Altitude above which storms of the magnetic field, left out here, change the wind [m]."""

_TWO_KILOMETRES = 2e3
_ABOVE = "altitude above 110 km, where the quiet part of HWM14 is not all of the wind"
_TURN = 2.0 * np.pi
_DAY = 86400.0
_NOON = 0.5  # of a day: the time of day at which time is zero
_YEAR_OF_MODEL = 365.25  # days; day 1 is the first of January
_CUBIC = 3
_METRES_PER_KILOMETRE = 1e3
_DEGREE, _STATIONARY, _MIGRATING, _HARMONICS = 8, 2, 3, 2  # that HWM14 goes to
_FAMILIES = 1 + _STATIONARY + _MIGRATING
_SEASONS = 2 * _HARMONICS + 1
_REGULAR = 26  # intervals of the spline below the thermosphere's own shape, to 155 km


# The file: eight integers, knots [km], for each level ten integers and the amplitudes, and the
# shape of the thermosphere. The integers say how far the sums go; there is one such file.
_HEAD = (800, _HARMONICS, 4, _MIGRATING, _DEGREE, 9, 33, _CUBIC)
_LEVELS, _KNOTS, _TERMS = 30, 37, 800
_ORDER = (
    *(_HARMONICS, _DEGREE),
    *(_STATIONARY, _HARMONICS, _DEGREE),
    *(_MIGRATING, _HARMONICS, _DEGREE),
)
_FILE = np.dtype(
    [
        ("head", "<i4", len(_HEAD)),
        ("knots", "<f8", _KNOTS),
        ("levels", [("order", "<i4", 10), ("amplitudes", "<f8", _TERMS)], _LEVELS),
        ("thermosphere", "<f8", 10),
    ]
)


class HWM14(AbstractWind):
    """Quiet-time winds of the Horizontal Wind Model 2014, 0 to 110 km.

    It is a climatology from observations, with tides and the largest waves, for every latitude.
    It has no wind upwards and no weather. The winds that magnetic storms add are left out: up to
    100 km they stay below 0.1 m/s, at 110 km a few m/s.

    Parameters
    ----------
    path : str or path
        The model's file ``hwm123114.bin``. It comes with the paper, as its supplement.

    Raises
    ------
    ConfigurationError
        If the file cannot be read or is another one.

    Notes
    -----
    The season follows the sun through every day and year; the published program changes it at
    midnight.

    References
    ----------
    [Drob2015]_, for the form of the model [Drob2008]_.
    """

    pieces: Any
    heights: Any

    def __init__(self, path: str | Path):
        from scipy.interpolate import BSpline

        try:
            content = Path(path).read_bytes()
        except OSError as error:
            raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from None
        is_model = len(content) == _FILE.itemsize
        if is_model:
            (file,) = np.frombuffer(content, _FILE)
            orders = file["levels"]["order"][:, : len(_ORDER)]
            is_model = np.array_equal(file["head"], _HEAD) and bool(np.all(orders == _ORDER))
        if not is_model:
            raise ConfigurationError(f"{path}: is not the file hwm123114.bin of HWM14")
        knots = file["knots"]  # [km]
        levels = np.array([_amplitudes(row) for row in file["levels"]["amplitudes"]])  # [m/s]
        metres = _METRES_PER_KILOMETRE * knots[: len(levels) + _CUBIC + 1]
        spline = BSpline(metres, levels, _CUBIC)
        heights = metres[_CUBIC : _CUBIC + _REGULAR + 1]
        # a cubic by its Taylor series at its lower end, highest power first
        powers = [
            spline(heights[:-1], nu=order) / factorial(order) for order in range(_CUBIC, -1, -1)
        ]
        self.pieces, self.heights = np.stack(powers, axis=1), heights

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return self._require_margins(altitude, place, _velocity(self, altitude, place))

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        return {_ABOVE: (HIGHEST - altitude) / _TWO_KILOMETRES}

    @property
    def has_tides(self) -> bool:
        return True

    def describe(self) -> tuple[str, ...]:
        return ("wind: HWM14, quiet, without weather, nothing upwards",)


@entry_point
def _velocity(wind: HWM14, altitude: Altitude, place: Place) -> Wind:
    heights = xp.asarray(wind.heights)
    altitude, latitude, longitude, time = xp.broadcast_arrays(altitude, *place)
    piece = xp.clip(xp.searchsorted(heights, altitude, side="right") - 1, 0, heights.size - 2)
    above = altitude - heights[piece]
    powers = xp.stack([above**3, above**2, above, xp.ones_like(above)], axis=-1)
    angle = _TURN * (time / TROPICAL_YEAR + 1.0 / _YEAR_OF_MODEL)
    terms = [xp.ones_like(angle)]
    for harmonic in range(1, _HARMONICS + 1):
        terms += [xp.cos(harmonic * angle), xp.sin(harmonic * angle)]
    season = xp.stack(terms, axis=-1)
    local_time = _TURN * (time / _DAY + _NOON) + longitude
    # Vector spherical harmonics (..., families, degrees, 4): the last axis is V cos, V sin, W sin,
    # W cos of the family's phase; of the zonal mean it is the sine of the degree times the
    # colatitude, and nothing.
    sine = xp.sin(xp.arange(1, _DEGREE + 1) * (0.5 * np.pi - latitude[..., None]))
    nothing = xp.zeros_like(sine)
    families = [xp.stack([sine, nothing, nothing, nothing], axis=-1)]
    phases = [(order, longitude) for order in range(1, _STATIONARY + 1)]
    phases += [(order, local_time) for order in range(1, _MIGRATING + 1)]
    for order, phase in phases:
        slope, over_sine = _harmonics(xp.sin(latitude), xp.cos(latitude), order)
        cosine, sine = (f(order * phase)[..., None] for f in (xp.cos, xp.sin))
        parts = [slope * cosine, slope * sine, over_sine * sine, over_sine * cosine]
        families.append(xp.stack(parts, axis=-1))
    shapes = xp.stack(families, axis=-3)
    # products and sums: JAX's derivative of a contraction needs its switch for double precision
    amplitudes = xp.asarray(wind.pieces)[piece]
    amplitudes = xp.sum(amplitudes * powers[..., None, None, None, None, None], axis=-6)
    amplitudes = xp.sum(amplitudes * season[..., None, :, None, None, None], axis=-4)
    winds = xp.sum(amplitudes * shapes[..., None], axis=(-4, -3, -2))
    east, north = winds[..., 0], winds[..., 1]
    return Wind(east, north, xp.zeros_like(east))


def _harmonics(x: Array, y: Array, order: int) -> tuple[Array, Array]:
    r"""Vector spherical harmonics of an order m, degrees 1 to 8."""
    # .. math::
    #
    #     V_n = \frac{1}{\sqrt{n(n+1)}} \frac{dP_n^m}{d\theta}, \qquad
    #     W_n = \frac{1}{\sqrt{n(n+1)}} \frac{m P_n^m}{\sin\theta}
    #
    # with Legendre functions of unit norm in :math:`x = \cos\theta`; :math:`y = \sin\theta`. Their
    # quotients by y are computed, so that nothing is singular at the poles.
    start = np.sqrt(0.5 * np.prod([(2 * k + 1) / (2 * k) for k in range(1, order + 1)]))
    before, now = xp.zeros_like(x), start * y ** (order - 1)
    slopes, quotients = [xp.zeros_like(x)] * (order - 1), [xp.zeros_like(x)] * (order - 1)
    for n in range(order, _DEGREE + 1):
        scale = 1.0 / np.sqrt(n * (n + 1))
        back = np.sqrt((n**2 - order**2) * (2 * n + 1) / (2 * n - 1))
        slopes.append(scale * (n * x * now - back * before))
        quotients.append(scale * order * now)
        gap = (n + 1) ** 2 - order**2
        forward = np.sqrt((2 * n + 1) * (2 * n + 3) / gap)
        lag = np.sqrt((2 * n + 3) * (n**2 - order**2) / ((2 * n - 1) * gap))
        before, now = now, forward * x * now - lag * before
    return xp.stack(slopes, axis=-1), xp.stack(quotients, axis=-1)


def _amplitudes(values: np.ndarray) -> np.ndarray:
    """Amplitudes of one level, shape (families, seasons, degrees, 4, 2)."""
    found = np.zeros((_FAMILIES, _SEASONS, _DEGREE, 4, 2))
    left = iter(values.tolist())

    def take(number: int) -> list[float]:
        return list(islice(left, number))

    for harmonic in range(_HARMONICS + 1):
        for degree in range(_DEGREE):  # of the zonal mean
            if harmonic == 0:
                a, b = take(2)
                found[0, 0, degree, 0] = -a, -b
            else:
                a, b, c, d = take(4)
                found[0, 2 * harmonic - 1, degree, 0] = -a, -c
                found[0, 2 * harmonic, degree, 0] = b, d
    orders = [*range(1, _STATIONARY + 1), *range(1, _MIGRATING + 1)]
    for family, m in enumerate(orders, start=1):
        for harmonic in range(_HARMONICS + 1):
            seasons = (2 * harmonic - 1, 2 * harmonic) if harmonic else (0,)
            for degree in range(m - 1, _DEGREE):
                for season in seasons:
                    a, b, c, d = take(4)
                    found[family, season, degree, :, 0] = -a, b, -c, -d
                    found[family, season, degree, :, 1] = -c, d, a, b
    return found
