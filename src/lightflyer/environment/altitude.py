"""What environments have in common whose coordinate is an altitude."""

import re
import warnings
from typing import Any, ClassVar

import numpy as np
import pydantic

from lightflyer.array.namespace import Numeric, call
from lightflyer.core.checks import is_concrete
from lightflyer.core.errors import ConfigurationError, ParameterWarning
from lightflyer.core.quantity import Altitude, Length
from lightflyer.core.text import span
from lightflyer.environment.base import Coordinate
from lightflyer.environment.section import EnvironmentSection

_IN_SUNS = re.compile(r"\bsuns?\b", re.IGNORECASE)
_SPACING = 1000.0  # metres, which resolves the layers of every atmosphere
_LIKE_KILOMETRES = 150.0  # metres, to which no flyer comes but in a fall; so many km have air


def altitude_coordinate(altitude_range: tuple[float, float], highest_searched: float) -> Coordinate:
    """Geometric altitude, over the range of an atmosphere.

    Parameters
    ----------
    altitude_range : tuple of float
        Lowest and highest altitude with a state [m].
    highest_searched : float
        Altitude above which no search looks by itself [m].

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
        easiest_keys=("minimum_irradiance", "value_w_m2"),
        step=_SPACING,
    )


def warn_of_kilometres(given: Any) -> None:
    """Warn of altitudes that look like kilometres: bare numbers, which are metres."""
    # numbers and lists, as scripts have them; a flight's course may well be near the ground
    bare = isinstance(given, int | float | list | tuple) or getattr(given, "size", 0) > 1
    has_unit = hasattr(given, "magnitude") or hasattr(given, "attrs")
    if call.depth or has_unit or not bare or not is_concrete(given) or not np.size(given):
        return
    low, high = np.min(given), np.max(given)
    if low > 0.0 and high <= _LIKE_KILOMETRES:
        said = f"{low:g} m" if low == high else f"{low:g} to {high:g} m"
        warnings.warn(
            f"altitude of {said}, near the ground; for kilometres write "
            f'"{high:g} km", or {1e3 * high:g}, as bare numbers are metres',
            ParameterWarning,
            stacklevel=3,
        )


def describe_floor(floor: Numeric | None) -> tuple[str, ...]:
    """What is assumed of solid ground below a flyer; empty without any."""
    if floor is None:
        return ()
    return (f"solid floor {span(100.0 * np.asarray(floor))} cm below, as warm as the gas",)


class AltitudeSection(EnvironmentSection):
    """``[environment]`` of a planet: the altitudes to search."""

    search_keys: ClassVar[tuple[str, str]] = ("altitude_min", "altitude_max")

    altitude_min: Altitude | None = None
    altitude_max: Altitude | None = None
    floor: Length | None = None

    @pydantic.field_validator("irradiance", mode="before", check_fields=False)
    @classmethod
    def _warn_of_suns(cls, given: Any) -> Any:
        if isinstance(given, str) and _IN_SUNS.search(given):
            said = (
                f'environment.irradiance = "{given}": a sun is 1000 W/m², as solar cells are rated '
                "on the ground; above the air of Earth the sun gives 1361 W/m²"
            )
            warnings.warn(said, ParameterWarning, stacklevel=2)
        return given

    @pydantic.model_validator(mode="after")
    def _require_order(self) -> "AltitudeSection":
        low, high = self.search_range
        if low is not None and high is not None and low >= high:
            raise ConfigurationError("altitude_min must be below altitude_max")
        return self
