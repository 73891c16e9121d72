"""``[environment.wind]`` of a flyer file; each kind of wind is an alternative."""

import abc
from collections.abc import Mapping
from functools import cache
from typing import ClassVar, Literal

import pydantic
from pydantic import ValidationInfo

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import GeomagneticIndex, SolarFlux, Velocity
from lightflyer.core.units import Measured
from lightflyer.environment.atmosphere.nrlmsis import GlobalNRLMSIS, SolarActivity
from lightflyer.environment.base import AbstractAtmosphere
from lightflyer.environment.wind.base import AbstractWind, SumOfWinds, UniformWind
from lightflyer.environment.wind.dataset import WindGrid
from lightflyer.environment.wind.gradient import GradientWind
from lightflyer.environment.wind.gridded import GriddedWind, WindBeyondData
from lightflyer.environment.wind.hwm14 import HWM14
from lightflyer.environment.wind.store import WindStore, changes_of, open_wind
from lightflyer.files.section import Alternative
from lightflyer.files.toml_file import file_beside

_NO_ACTIVITY = (
    "the gradient wind is that of NRLMSIS: give wind.f107 and wind.ap, or an atmosphere with them"
)
_TABLE = "decides the wind's whole table; give each activity a study of its own"


class WindSection(Alternative, abc.ABC):
    """``[environment.wind]``: a kind of wind, and a wind upwards on top of it."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("kind", "uniform"),)

    up: Velocity = Measured(0.0)

    @abc.abstractmethod
    def build_horizontal(
        self, atmosphere: AbstractAtmosphere, indices: SolarActivity | None
    ) -> AbstractWind:
        """The wind of this kind, in an atmosphere and for its activity where it states one."""

    def require(self, indices: SolarActivity | None) -> None:
        """Raise :class:`ConfigurationError` where the wind lacks an activity of the sun."""

    def build(self, atmosphere: AbstractAtmosphere, indices: SolarActivity | None) -> AbstractWind:
        """The wind; ``atmosphere``: that the wind blows in."""
        horizontal = self.build_horizontal(atmosphere, indices)
        upwards = UniformWind(up=self.up.value)
        return SumOfWinds(horizontal, upwards) if "up" in self.model_fields_set else horizontal


class UniformWindSection(WindSection, of=UniformWind):
    """The same wind everywhere."""

    kind: Literal["uniform"] = "uniform"

    def build_horizontal(
        self, atmosphere: AbstractAtmosphere, indices: SolarActivity | None
    ) -> AbstractWind:
        wind: UniformWind = self.make(up=0.0)
        return wind


class GradientWindSection(WindSection):
    """The gradient wind of NRLMSIS, with the activity of the atmosphere if that has one."""

    not_varied: ClassVar[Mapping[str, str]] = dict.fromkeys(("f107", "f107a", "ap"), _TABLE)

    kind: Literal["gradient"]
    f107: SolarFlux | None = None
    f107a: SolarFlux | None = None
    ap: GeomagneticIndex | None = None

    def build_horizontal(
        self, atmosphere: AbstractAtmosphere, indices: SolarActivity | None
    ) -> AbstractWind:
        given = self.indices or indices
        if given is None:
            raise ConfigurationError(_NO_ACTIVITY)
        return GradientWind(GlobalNRLMSIS(**given._asdict()))

    def require(self, indices: SolarActivity | None) -> None:
        if self.indices is None and indices is None:
            raise ConfigurationError(_NO_ACTIVITY)

    @property
    def indices(self) -> SolarActivity | None:
        """The section's own activity."""
        if self.f107 is None or self.ap is None:
            return None
        mean = None if self.f107a is None else self.f107a.value
        return SolarActivity.of(self.f107.value, mean, self.ap.value)

    @pydantic.model_validator(mode="after")
    def _together(self) -> "GradientWindSection":
        if (self.f107 is None) != (self.ap is None) or (self.f107a and not self.f107):
            raise ConfigurationError("the activity of the sun needs both f107 and ap")
        return self


class DataWindSection(WindSection):
    """Wind from a NetCDF or GRIB file, or from several."""

    kind: Literal["data"]
    file: str
    beyond: Literal["gradient"] | None = None
    air: Literal["data", "atmosphere"] | None = None

    @pydantic.field_validator("file")
    @classmethod
    def _usable(cls, name: str, info: ValidationInfo) -> str:
        path = file_beside(name, info)
        _grid(path)  # raises here, where the line of the flyer file is known
        return path

    def build_horizontal(
        self, atmosphere: AbstractAtmosphere, indices: SolarActivity | None
    ) -> AbstractWind:
        data = GriddedWind(_grid(self.file), atmosphere, air=self.air != "atmosphere")
        if self.air == "data" and not data.has_air:
            raise ConfigurationError(
                f"{self.file}: has no temperature on pressure levels; leave out wind.air"
            )
        if self.beyond is None:
            return data
        self.require(indices)
        assert indices is not None
        return WindBeyondData(data, GradientWind(GlobalNRLMSIS(**indices._asdict())))

    def require(self, indices: SolarActivity | None) -> None:
        if self.beyond is not None and indices is None:
            raise ConfigurationError(
                'wind.beyond = "gradient" is the wind of NRLMSIS: it needs an atmosphere with f107 '
                "and ap"
            )


class Hwm14WindSection(WindSection):
    """HWM14, from the model's data file."""

    kind: Literal["hwm14"]
    file: str

    @pydantic.field_validator("file")
    @classmethod
    def _usable(cls, name: str, info: ValidationInfo) -> str:
        path = file_beside(name, info)
        HWM14(path)  # raises here, where the line of the flyer file is known
        return path

    def build_horizontal(
        self, atmosphere: AbstractAtmosphere, indices: SolarActivity | None
    ) -> AbstractWind:
        return HWM14(self.file)


def _grid(path: str) -> WindGrid | WindStore:
    try:
        changed = changes_of(path)
    except OSError as error:
        raise ConfigurationError(f"cannot be read: {error.strerror}") from None
    return _grid_of(path, changed)


@cache
def _grid_of(path: str, changed: tuple[int, ...]) -> WindGrid | WindStore:  # noqa: ARG001
    return open_wind(path)
