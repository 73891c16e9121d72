"""What environments have in common whose coordinate is an altitude."""

from typing import ClassVar

import pydantic

from lightflyer.environment.base import Coordinate
from lightflyer.environment.section import EnvironmentSection
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import Altitude

_SPACING = 1000.0  # metres, which resolves the layers of every atmosphere


def altitude_coordinate(
    altitude_range: tuple[float, float], highest_searched: float, points: tuple[float, ...]
) -> Coordinate:
    """Geometric altitude, over the range of an atmosphere.

    Parameters
    ----------
    altitude_range : tuple of float
        [m].
    highest_searched : float
        Top of the default search [m].
    points : tuple of float
        Altitudes reported where nobody asks for others [m].

    Returns
    -------
    Coordinate
    """
    low, high = altitude_range
    return Coordinate(
        name="altitude",
        unit="m",
        long_name="geometric altitude",
        lowest=low,
        highest=high,
        searched=(low, min(high, highest_searched)),
        logarithmic=False,
        shown_unit="km",
        points=points,
        easiest_keys=("minimum_irradiance", "value_w_m2"),
        step=_SPACING,
    )


class AltitudeSection(EnvironmentSection):
    """``[environment]`` of a planet: the altitudes to search."""

    search_keys: ClassVar[tuple[str, str]] = ("altitude_min", "altitude_max")

    altitude_min: Altitude | None = None
    altitude_max: Altitude | None = None

    @pydantic.model_validator(mode="after")
    def _ordered(self) -> "AltitudeSection":
        low, high = self.search_range
        if low is not None and high is not None and low >= high:
            raise ConfigurationError("altitude_min must be below altitude_max")
        return self
