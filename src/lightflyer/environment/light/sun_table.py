"""The sun over a span of time, from a table: for trajectories, which ask for it a million times."""

import math
from typing import Any

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.environment.light.sun import SECONDS_PER_DAY, AbstractSun, SunPosition

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

    def position(self, time: Numeric) -> SunPosition:
        """Position of the sun; NaN outside the table."""
        return _position(self, time)


@entry_point
def _position(table: TabulatedSun, time: Numeric) -> SunPosition:
    since = time - table.start
    pieces = table.coefficients.shape[0]
    within = (since >= 0.0) & (since <= pieces * table.spacing * (1.0 + 1e-12))
    piece = xp.clip(since // table.spacing, 0, pieces - 1).astype(int)
    along = (since - piece * table.spacing)[..., None]
    third, second, first, zeroth = xp.moveaxis(table.coefficients[piece], -2, 0)
    fixed = ((third * along + second) * along + first) * along + zeroth
    x, y, z, distance = xp.moveaxis(fixed, -1, 0)
    turned = table.rotation_rate * since
    cosine, sine = xp.cos(turned), xp.sin(turned)
    direction = xp.stack([x * cosine + y * sine, y * cosine - x * sine, z], axis=-1)
    return SunPosition(
        xp.where(within[..., None], direction, np.nan), xp.where(within, distance, np.nan)
    )
