"""``[environment]`` of a flyer file: what all its alternatives share."""

import abc
from collections.abc import Mapping
from typing import Annotated, ClassVar

from lightflyer.array.namespace import Numeric
from lightflyer.core import constants
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Acceleration,
    Fraction,
    Incidence,
    Infrared,
    Irradiance,
)
from lightflyer.core.units import Measured, scale_and_offset
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.environment.radiation import Radiation
from lightflyer.files.section import Alternative, OneOf
from lightflyer.gas.registry import GASES

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
