"""``[environment]`` of a flyer file: what all alternatives share, and those with an altitude."""

import abc
import re
import warnings
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

import numpy as np
import pydantic

from lightflyer.array.namespace import Numeric, call
from lightflyer.core import constants
from lightflyer.core.checks import is_concrete
from lightflyer.core.errors import ConfigurationError, ParameterError, ParameterWarning
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Acceleration,
    Altitude,
    Fraction,
    Incidence,
    Infrared,
    Irradiance,
    Length,
)
from lightflyer.core.text import span
from lightflyer.core.units import Measured, scale_and_offset
from lightflyer.environment.base import AbstractEnvironment, Coordinate
from lightflyer.environment.radiation import Radiation
from lightflyer.files.section import Alternative, OneOf
from lightflyer.gas.pure import GASES

_SEARCH = "says where bands are searched"

GasName = Annotated[str, OneOf(GASES)]  # Names of gases in a flyer file


class EnvironmentSection(Alternative, abc.ABC):
    """``[environment]``: light, heat radiation, gas and gravity; subclasses add the place."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (
        ("kind", "earth"),
        ("atmosphere", "us1976"),
    )
    not_varied: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("altitude_min", "altitude_max", "pressure_min", "pressure_max"), _SEARCH
    )
    search_keys: ClassVar[tuple[str, str]]
    stefan_boltzmann: ClassVar[float] = constants.STEFAN_BOLTZMANN

    gas: GasName | None = None
    gravity: Acceleration | None = None
    irradiance: Irradiance
    incidence: Incidence = Measured(0.0)
    infrared_top: Infrared | None = None
    infrared_bottom: Infrared | None = None
    albedo: Fraction = Measured(0.0)

    @property
    def default_infrared(self) -> tuple[float | None, float | None]:
        """Heat radiation from above and below where the file gives none [W/m²]."""
        # None stands for black surroundings at the gas temperature.
        return None, None

    @property
    def incidence_keys(self) -> tuple[str, ...]:
        """Keys that decide :attr:`light_incidence`."""
        return ("incidence",)

    @property
    def light_incidence(self) -> Numeric:
        """Angle between the light and the vertical, 0 to π/2 [rad]."""
        return self.incidence.value * RADIANS_PER_DEGREE

    def build_radiation(self) -> Radiation:
        """Light and heat radiation."""
        given = (self.infrared_top, self.infrared_bottom)
        above, below = (
            default if infrared is None else infrared.value
            for infrared, default in zip(given, self.default_infrared, strict=True)
        )
        return Radiation(
            irradiance=self.irradiance.value,
            zenith_angle=self.incidence.value * RADIANS_PER_DEGREE,
            albedo=self.albedo.value,
            infrared_above=above,
            infrared_below=below,
            stefan_boltzmann=self.stefan_boltzmann,
        )

    @property
    def search_range(self) -> tuple[float | None, float | None]:
        """Ends of the coordinates to search, None where the file leaves one out."""
        low, high = (getattr(self, key) for key in self.search_keys)
        return (None if low is None else low.value, None if high is None else high.value)

    def require_search_range(self, environment: AbstractEnvironment) -> None:
        """Raise where the range to search is outside that of the environment."""
        where = environment.coordinate
        for key, end in zip(self.search_keys, self.search_range, strict=True):
            if end is not None and not where.lowest <= end <= where.highest:
                factor, unit = scale_and_offset(where.unit, where.shown_unit)[0], where.shown_unit
                low, high = (f"{edge * factor:.4g}" for edge in (where.lowest, where.highest))
                raise ParameterError(
                    f"environment.{key} = {end * factor:.6g} {unit}: must be between {low} and "
                    f"{high} {unit}"
                )

    @abc.abstractmethod
    def build(self) -> AbstractEnvironment:
        """The environment."""


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
