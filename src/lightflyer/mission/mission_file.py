"""The mission file: a flyer file with a section ``[mission]``."""

import abc
import datetime
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import pydantic

from lightflyer.config.flyer_file import FileDesign, FlyerFile, section_at, section_within
from lightflyer.config.reader import is_study
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
from lightflyer.core.text import read_text
from lightflyer.core.units import Measured
from lightflyer.files.section import Alternative, Section, Spelling
from lightflyer.files.toml_file import FileKind, check, parse_toml, place_of
from lightflyer.mission.areas import Circle
from lightflyer.mission.fleet import MEMBERS, Ensemble
from lightflyer.mission.mission import Mission
from lightflyer.mission.path.attitude import (
    AbstractAttitudeRule,
    AbstractShading,
    ChooseWind,
    FollowSun,
    HoldAltitude,
    Level,
    Own,
    Shaded,
    TowardsStation,
)
from lightflyer.mission.path.release import Release
from lightflyer.mission.report.ground import Receiver
from lightflyer.mission.report.landing import FLIGHT_LEVELS, Landing

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


class MissionSection(_Exact, of=Mission):
    """``[mission]``: from where and when, for how long, and how the flyer lies."""

    uncertain: ClassVar[tuple[str, ...]] = ("altitude",)
    instead: ClassVar[Mapping[str, str]] = dict.fromkeys(("latitude", "longitude"), _OF_PLACE)
    left_out: ClassVar[tuple[str, ...]] = ("tolerance",)
    spelled: ClassVar[Mapping[str, Spelling]] = {
        "lowest": Spelling("lowest_altitude"),
        "highest": Spelling("highest_altitude"),
    }

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

    @property
    def circle(self) -> Circle:
        """The station, by default about the place of the release."""
        given = self.station or StationSection()
        latitude, longitude = (
            (getattr(given, key) or getattr(self, key)).value for key in ("latitude", "longitude")
        )
        return Circle(latitude, longitude, given.radius.value)

    def build(self) -> Mission:
        """The mission that it describes."""
        moving = None
        if self.release is not None:
            given = self.release
            moving = [part.value for part in (given.east, given.north, given.up)]
        place = self.altitude.value, self.latitude.value, self.longitude.value
        largest = {}
        if self.largest_tilt is not None:
            largest["largest"] = self.largest_tilt.value * RADIANS_PER_DEGREE
        share = {} if self.tilt_share is None else {"share": self.tilt_share.value}
        rules: dict[str, Callable[[], AbstractAttitudeRule]] = {
            "own": Own,
            "level": Level,
            "follow-sun": partial(FollowSun, **share, **largest),
            "towards-station": partial(TowardsStation, self.circle, **largest),
        }
        rule = rules[self.attitude]()
        if self.shading is not None:
            rule = Shaded(self.shading.build(self.circle), rule)
        stays = self.attitude == "towards-station" or self.station is not None
        stays = stays or isinstance(self.shading, ChooseWindSection)
        ensemble = None
        if self.ensemble is not None:
            late = self.ensemble.time_uncertainty
            ensemble = self.ensemble.make(
                altitude=self.altitude.uncertainty or 0.0, time=0.0 if late is None else late.value
            )
        launches = self.launches
        mission: Mission = self.make(
            release=Release(*place, self.date, moving),
            attitude=rule,
            ensemble=ensemble,
            launches=[] if launches is None else launches.delays,
            station=self.circle if stays else None,
            landing=None if self.landing is None else self.landing.build(),
        )
        return mission


_MISSION = "mission"
_SHARED = ("date", "latitude", "longitude")
"""Keys that ``[environment]`` takes from ``[mission]`` where it leaves them out."""

_LYING = {"tilt", "azimuth"}
"""Keys of ``[flyer]`` that say how it lies."""

_OF_GIVEN_LIGHT = {"sun", "irradiance", "incidence"}
"""Keys of ``[environment]`` that say what the light is, so that the sun need not move."""


def _keys_of(section: str, document: Any) -> list[str]:
    first, _, rest = section.partition(".")
    if first == _MISSION:
        kind = section_within(MissionSection, rest, document.get(_MISSION))
    else:
        kind = section_at(section, document)
    own = [] if kind is None else list(kind.model_fields)
    return own if section else [*own, _MISSION]


MISSION_FILE = FileKind(
    "a mission file", _keys_of, "'lightflyer init --kind mission' writes an example"
)
"""How messages speak of a mission file."""


class _MissionPart(Section):
    mission: MissionSection


@dataclass(frozen=True)
class MissionFile:
    """A mission file."""

    design: FileDesign  # Flyer, environment and force model
    section: MissionSection

    @cached_property
    def mission(self) -> Mission:
        """What is to be flown."""
        return self.section.build()

    def arguments(self) -> dict[str, Any]:
        """Arguments of :func:`lightflyer.fly` beside the design."""
        return {one.name: getattr(self.mission, one.name) for one in fields(Mission)}

    def swarm_arguments(self, members: int | None = None) -> dict[str, Any]:
        """Those of :func:`disperse_ensemble`, near the station; ``members``: in place of its."""
        mission = self.mission
        if mission.ensemble is None:
            raise ConfigurationError(
                "a swarm differs by its [mission.ensemble]; add that section, such as with "
                'wind_uncertainty = "10 m/s"'
            )
        if mission.launches:
            raise ConfigurationError("a swarm is released at once; take out [mission.launches]")
        if members is not None:
            mission = replace(mission, ensemble=replace(mission.ensemble, members=members))
        return {"mission": mission, "areas": [mission.station or self.section.circle]}


def read_mission_file(path: str | Path) -> MissionFile:
    """Read and check a mission file.

    Parameters
    ----------
    path : str or path
        A TOML file; ``lightflyer init --kind mission`` writes a commented one.

    Returns
    -------
    MissionFile

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    path = Path(path)
    return mission_of_text(read_text(path), path)


def mission_of_text(text: str, path: Path) -> MissionFile:
    """What the text of a mission file describes."""
    document = parse_toml(text, path, MISSION_FILE)
    if other := is_study(document):
        raise ConfigurationError(f"{path}: is {other}")
    rest = {name: content for name, content in document.items() if name != _MISSION}
    part = {name: content for name, content in document.items() if name == _MISSION}
    mission, missions_mistakes = check(_MissionPart, part, text, path, MISSION_FILE)
    given = rest.get("environment")
    for key in _SHARED:
        own = given.get(key) if isinstance(given, dict) else None
        if own is not None and own != part.get(_MISSION, {}).get(key, own):
            place = place_of(["environment", key], text, path)
            missions_mistakes.append(f"{place}: {key} is not that of [mission]; leave it out here")
    attitude = "own" if mission is None else mission.mission.attitude
    if attitude != "own" and isinstance(rest.get("flyer"), dict):
        missions_mistakes += [
            f"{place_of(['flyer', key], text, path)}: {key} has no effect beside attitude = "
            f'"{attitude}" of [mission]; "own" has it'
            for key in sorted(_LYING & rest["flyer"].keys())
        ]
    # the place of a mission that is mistaken would be found mistaken again
    placed = _place(rest, {} if mission is None else part[_MISSION])
    file, mistakes = check(FlyerFile, placed, text, path, MISSION_FILE)
    if mission is None or file is None or missions_mistakes:
        raise ConfigurationError("\n".join([*mistakes, *missions_mistakes]))
    return MissionFile(file.design(text), mission.mission)


def _place(document: dict[str, Any], mission: dict[str, Any]) -> dict[str, Any]:
    """A flyer file whose sun moves and whose place is the release's, where it says nothing else."""
    given = document.get("environment", {})
    kind = section_at("environment", document)
    if kind is None or not isinstance(given, dict):
        return document  # its mistakes are found later
    known: dict[str, Any] = {}
    if "sun" in kind.model_fields and not _OF_GIVEN_LIGHT & given.keys():
        known["sun"] = "ephemeris"
    if known or getattr(kind, "place_matters", False):
        shared = (key for key in _SHARED if key in kind.model_fields and key in mission)
        known |= {key: mission[key] for key in shared}
    return document | {"environment": known | given}
