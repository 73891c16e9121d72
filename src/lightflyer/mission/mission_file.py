"""The mission file: a flyer file with a section ``[mission]``."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from lightflyer.config.flyer_file import FileDesign, FlyerFile, section_at, section_within
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import read_text
from lightflyer.files.section import Section
from lightflyer.files.toml_file import FileKind, check, parse_toml, place_of
from lightflyer.mission.section import MissionSection

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
    mission: MissionSection

    def arguments(self) -> dict[str, Any]:
        """Arguments of :func:`lightflyer.fly` beside the design."""
        return self.mission.arguments()

    def swarm_arguments(self, members: int | None = None) -> dict[str, Any]:
        """Those of :func:`disperse_ensemble`, near the station; ``members``: in place of its."""
        given = self.arguments()
        ensemble = given["ensemble"]
        if ensemble is None:
            raise ConfigurationError(
                "a swarm differs by its [mission.ensemble]; add that section, such as with "
                'wind_uncertainty = "10 m/s"'
            )
        if given.pop("launches"):
            raise ConfigurationError("a swarm is released at once; take out [mission.launches]")
        if members is not None:
            given["ensemble"] = replace(ensemble, members=members)
        given.pop("landing")
        given.pop("receivers")
        given["areas"] = [given.pop("station") or self.mission.circle]
        return {name: value for name, value in given.items() if value is not None}


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
