"""``[mission]`` of a mission file: release, duration, attitude, launches, ensemble."""

import abc
import datetime
from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any, ClassVar, Literal

import pydantic

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Altitude,
    Duration,
    Fraction,
    GroundDistance,
    Latitude,
    Longitude,
    Steepness,
    Velocity,
)
from lightflyer.core.units import Measured
from lightflyer.files.section import Alternative, Section, Spelling
from lightflyer.mission.areas import Circle
from lightflyer.mission.fleet import MEMBERS, Ensemble
from lightflyer.mission.path.attitude import (
    AbstractAttitudeRule,
    FollowSun,
    Level,
    Own,
    TowardsStation,
)
from lightflyer.mission.path.release import Release
from lightflyer.mission.path.shading import AbstractShading, ChooseWind, HoldAltitude, Shaded
from lightflyer.mission.report.landing import FLIGHT_LEVELS, Landing
from lightflyer.mission.telemetry import Receiver

MOST_MEMBERS = 100_000  # Largest ensemble of one command: its tracks are kept in memory

MOST_LAUNCHES = 10_000

_Members = Annotated[int, pydantic.Field(strict=True, ge=2, le=MOST_MEMBERS)]
_Seed = Annotated[int, pydantic.Field(strict=True, ge=0)]
_Launches = Annotated[int, pydantic.Field(strict=True, ge=1, le=MOST_LAUNCHES)]

_Objects = Annotated[int, pydantic.Field(strict=True, ge=1)]
_Level = Annotated[int, pydantic.Field(strict=True, ge=1, le=1000)]

_RULES = ("own", "level", "follow-sun", "towards-station")
_TILTED = {"largest_tilt": ("follow-sun", "towards-station"), "tilt_share": ("follow-sun",)}
_STATION_RADIUS = Measured(100e3)  # m, unless the file says otherwise
_OF_PLACE = "; the release's is position_uncertainty in [mission.ensemble]"


class _Exact(Section):
    """A section whose numbers take no ±, but for those named."""

    uncertain: ClassVar[tuple[str, ...]] = ()
    instead: ClassVar[Mapping[str, str]] = {}  # What states the ± of some

    @pydantic.field_validator("*")
    @classmethod
    def _is_exact(cls, value: Any, info: pydantic.ValidationInfo) -> Any:
        key = str(info.field_name)
        spread = value.uncertainty if isinstance(value, Measured) else None
        if spread is not None and key not in cls.uncertain:
            raise ConfigurationError(f"takes no ±{cls.instead.get(key, '')}")
        return value


class EnsembleSection(_Exact, of=Ensemble):
    """``[mission.ensemble]``: flights within every ±."""

    spelled: ClassVar[Mapping[str, Spelling]] = {
        "wind": Spelling("wind_uncertainty"),
        "vertical_wind": Spelling("vertical_wind_uncertainty"),
        "distance": Spelling("position_uncertainty"),
        "drag": Spelling("drag_uncertainty"),
        "velocity": Spelling("velocity_uncertainty"),
    }
    left_out: ClassVar[tuple[str, ...]] = ("altitude", "time")

    members: _Members = MEMBERS
    seed: _Seed = 0
    together: bool = False
    time_uncertainty: Duration | None = None


class LaunchesSection(_Exact):
    """``[mission.launches]``: the same flyer released again and again."""

    every: Duration
    count: _Launches

    @property
    def delays(self) -> list[float]:
        """Times of the further releases after the first [s]."""
        return [self.every.value * (1 + number) for number in range(self.count)]


class ReleaseSection(_Exact):
    """``[mission.release]``: velocity over ground, such as that of a rocket or an aircraft."""

    instead: ClassVar[Mapping[str, str]] = dict.fromkeys(
        ("east", "north", "up"), "; that is velocity_uncertainty in [mission.ensemble]"
    )

    east: Velocity = Measured(0.0)
    north: Velocity = Measured(0.0)
    up: Velocity = Measured(0.0)


class LandingSection(_Exact, of=Landing):
    """``[mission.landing]``: what landings are counted in."""

    objects: _Objects = 1
    flight_levels: Annotated[tuple[_Level, ...], pydantic.Field(min_length=1)] = FLIGHT_LEVELS

    def build(self) -> Landing:
        """What they are counted in."""
        return Landing(self.objects, self.flight_levels)


class ReceiverSection(_Exact, of=Receiver):
    """An entry of ``[[mission.receivers]]``: a receiver on the ground."""

    name: str = pydantic.Field(min_length=1)


class StationSection(_Exact, of=Circle):
    """``[mission.station]``: a place near which the flyer is to stay."""

    latitude: Latitude | None = None  # by default that of the release
    longitude: Longitude | None = None
    radius: GroundDistance = _STATION_RADIUS


class ShadingSection(_Exact, Alternative, abc.ABC):
    """``[mission.shading]``: how the flyer lets in less light than there is."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("rule", "hold-altitude"),)

    def build(self, station: Circle) -> AbstractShading:
        """The rule, of a flyer that is to stay near a station."""
        del station
        shading: AbstractShading = self.make()
        return shading


class HoldAltitudeSection(ShadingSection, of=HoldAltitude):
    """All light below an altitude, none above."""

    rule: Literal["hold-altitude"] = "hold-altitude"


class ChooseWindSection(ShadingSection, of=ChooseWind):
    """The altitude whose wind leads to the station."""

    left_out: ClassVar[tuple[str, ...]] = ("station",)

    rule: Literal["choose-wind"]

    def build(self, station: Circle) -> AbstractShading:
        shading: AbstractShading = self.make(station=station)
        return shading


class MissionSection(_Exact, of=Release):
    """``[mission]``: from where and when, for how long, and how the flyer lies."""

    uncertain: ClassVar[tuple[str, ...]] = ("altitude",)
    instead: ClassVar[Mapping[str, str]] = dict.fromkeys(("latitude", "longitude"), _OF_PLACE)
    left_out: ClassVar[tuple[str, ...]] = ("velocity",)

    date: datetime.datetime
    latitude: Latitude
    longitude: Longitude
    altitude: Altitude
    duration: Duration
    every: Duration | None = None
    attitude: Literal[_RULES] = "own"  # type: ignore[valid-type]
    tilt_share: Fraction | None = None
    largest_tilt: Steepness | None = None
    shading: ShadingSection | None = None
    release: ReleaseSection | None = None
    station: StationSection | None = None
    landing: LandingSection | None = None
    receivers: tuple[ReceiverSection, ...] = ()
    lowest_altitude: Altitude | None = None
    highest_altitude: Altitude | None = None
    launches: LaunchesSection | None = None
    ensemble: EnsembleSection | None = None

    def idle(self) -> dict[str, str]:
        """Only some rules have a tilt."""
        return {
            key: f'beside attitude = "{self.attitude}"; it belongs to attitude = '
            + " or ".join(f'"{rule}"' for rule in rules)
            for key, rules in _TILTED.items()
            if self.attitude not in rules
        }

    @pydantic.model_validator(mode="after")
    def _agrees(self) -> "MissionSection":
        if self.every is not None and self.every.value > self.duration.value:
            raise ConfigurationError(
                f"every, {self.every.value:g} s, is longer than the duration, "
                f"{self.duration.value:g} s"
            )
        if self.altitude.uncertainty is not None and self.ensemble is None:
            raise ConfigurationError(
                "altitude has a ±, which needs an ensemble; add a section [mission.ensemble]"
            )
        return self

    def build_release(self) -> Release:
        """Where and when, and how fast."""
        given, moving = self.release, None
        if given is not None:
            moving = [part.value for part in (given.east, given.north, given.up)]
        found: Release = self.make(time=self.date, velocity=moving)
        return found

    def rule(self) -> AbstractAttitudeRule:
        """How the flyer lies, and what light it lets in."""
        largest = {} if self.largest_tilt is None else {"largest": _radians(self.largest_tilt)}
        share = {} if self.tilt_share is None else {"share": self.tilt_share.value}
        rules: dict[str, Callable[[], AbstractAttitudeRule]] = {
            "own": Own,
            "level": Level,
            "follow-sun": partial(FollowSun, **share, **largest),
            "towards-station": partial(TowardsStation, self.circle, **largest),
        }
        rule = rules[self.attitude]()
        return rule if self.shading is None else Shaded(self.shading.build(self.circle), rule)

    @property
    def circle(self) -> Circle:
        """The station, by default about the place of the release."""
        given = self.station or StationSection()
        latitude, longitude = (
            (getattr(given, key) or getattr(self, key)).value for key in ("latitude", "longitude")
        )
        return Circle(latitude, longitude, given.radius.value)

    @property
    def _has_station(self) -> bool:
        """Whether there is a place near which the flyer is to stay."""
        makes_for_it = self.attitude == "towards-station"
        return (
            makes_for_it or self.station is not None or isinstance(self.shading, ChooseWindSection)
        )

    def build_ensemble(self) -> Ensemble | None:
        """What is varied from flight to flight."""
        section = self.ensemble
        if section is None:
            return None
        time = 0.0 if section.time_uncertainty is None else section.time_uncertainty.value
        drawn: Ensemble = section.make(altitude=self.altitude.uncertainty or 0.0, time=time)
        return drawn

    def arguments(self) -> dict[str, Any]:
        """Arguments of :func:`lightflyer.fly` beside the design."""
        return {
            "release": self.build_release(),
            "duration": self.duration.value,
            "attitude": self.rule(),
            "every": None if self.every is None else self.every.value,
            "ensemble": self.build_ensemble(),
            "launches": [] if self.launches is None else self.launches.delays,
            "station": self.circle if self._has_station else None,
            "landing": None if self.landing is None else self.landing.build(),
            "receivers": [receiver.make() for receiver in self.receivers],
            "lowest": None if self.lowest_altitude is None else self.lowest_altitude.value,
            "highest": None if self.highest_altitude is None else self.highest_altitude.value,
        }


def _radians(angle: Measured) -> float:
    return angle.value * RADIANS_PER_DEGREE
