"""``[mission]`` of a mission file: release, duration, attitude, launches, ensemble."""

import datetime
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

import pydantic

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    RADIANS_PER_DEGREE,
    Altitude,
    Duration,
    Fraction,
    Latitude,
    Longitude,
    Tilt,
)
from lightflyer.files.section import Section, Spelling
from lightflyer.mission.fleet import MEMBERS, Ensemble
from lightflyer.mission.path.attitude import AbstractAttitudeRule, FollowSun, Level, Own
from lightflyer.mission.path.release import Release

MOST_MEMBERS = 100_000  # Largest ensemble of one command: its tracks are kept in memory

MOST_LAUNCHES = 10_000

_Members = Annotated[int, pydantic.Field(strict=True, ge=2, le=MOST_MEMBERS)]
_Seed = Annotated[int, pydantic.Field(strict=True, ge=0)]
_Launches = Annotated[int, pydantic.Field(strict=True, ge=1, le=MOST_LAUNCHES)]

_RULES = ("own", "level", "follow-sun")
_EXACT = ("latitude", "longitude", "duration")


class EnsembleSection(Section, of=Ensemble):
    """``[mission.ensemble]``: flights within every ±."""

    spelled: ClassVar[Mapping[str, Spelling]] = {
        "wind": Spelling("wind_uncertainty"),
        "vertical_wind": Spelling("vertical_wind_uncertainty"),
        "distance": Spelling("position_uncertainty"),
    }
    left_out: ClassVar[tuple[str, ...]] = ("altitude", "time")

    members: _Members = MEMBERS
    seed: _Seed = 0
    time_uncertainty: Duration | None = None


class LaunchesSection(Section):
    """``[mission.launches]``: the same flyer released again and again."""

    every: Duration
    count: _Launches

    @property
    def delays(self) -> list[float]:
        """Times of the further releases after the first [s]."""
        return [self.every.value * (1 + number) for number in range(self.count)]


class MissionSection(Section, of=Release):
    """``[mission]``: from where and when, for how long, and how the flyer lies."""

    date: datetime.datetime
    latitude: Latitude
    longitude: Longitude
    altitude: Altitude
    duration: Duration
    every: Duration | None = None
    attitude: Literal[_RULES] = "own"  # type: ignore[valid-type]
    tilt_share: Fraction | None = None
    largest_tilt: Tilt | None = None
    lowest_altitude: Altitude | None = None
    highest_altitude: Altitude | None = None
    launches: LaunchesSection | None = None
    ensemble: EnsembleSection | None = None

    def idle(self) -> dict[str, str]:
        """Only a flyer that follows the sun has a tilt."""
        why = f'beside attitude = "{self.attitude}"; it belongs to attitude = "follow-sun"'
        follows = self.attitude == "follow-sun"
        return {} if follows else dict.fromkeys(("tilt_share", "largest_tilt"), why)

    @pydantic.model_validator(mode="after")
    def _exact(self) -> "MissionSection":
        for key in _EXACT:
            if getattr(self, key).uncertainty is not None:
                raise ConfigurationError(
                    f"{key} takes no ±; the release's is position_uncertainty in [mission.ensemble]"
                )
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

    @property
    def release(self) -> Release:
        """Where and when."""
        found: Release = self.make(time=self.date)
        return found

    def rule(self) -> AbstractAttitudeRule:
        """How the flyer lies."""
        if self.attitude != "follow-sun":
            return Level() if self.attitude == "level" else Own()
        given: dict[str, Any] = {}
        if self.tilt_share is not None:
            given["share"] = self.tilt_share.value
        if self.largest_tilt is not None:
            given["largest"] = self.largest_tilt.value * RADIANS_PER_DEGREE
        return FollowSun(**given)

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
            "release": self.release,
            "duration": self.duration.value,
            "attitude": self.rule(),
            "every": None if self.every is None else self.every.value,
            "ensemble": self.build_ensemble(),
            "launches": [] if self.launches is None else self.launches.delays,
            "lowest": None if self.lowest_altitude is None else self.lowest_altitude.value,
            "highest": None if self.highest_altitude is None else self.highest_altitude.value,
        }
