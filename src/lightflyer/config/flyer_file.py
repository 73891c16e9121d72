"""The flyer file: its sections, and the design that it describes.

Alternatives of its sections are found by importing the modules that declare them: a new flyer,
environment or force model is one new module in its room, or one of a plug-in.
"""

import importlib
import json
import pkgutil
from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, cast

import pydantic

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, by_numpy
from lightflyer.budget.payload import PayloadSection
from lightflyer.config.searched_films import SurrogateFilms, part_at
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.extras import load_plugins
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.design.design import AbstractDesign, AbstractStacks, digest
from lightflyer.design.setup import Setup
from lightflyer.environment.section import EnvironmentSection
from lightflyer.files.section import Alternative, Section
from lightflyer.film.properties import FilmSection
from lightflyer.flyer.base import FlyerSection
from lightflyer.force.base import ForceSection

_FIGURES = "figures"  # how names of modules end that draw on demand, and import matplotlib


def _discover() -> None:
    """Import every module that may declare an alternative of a section."""
    for room in ("film", "environment", "flyer", "force"):
        package = importlib.import_module(f"lightflyer.{room}")
        for module in pkgutil.walk_packages(package.__path__, f"lightflyer.{room}."):
            if not module.name.endswith(_FIGURES):
                importlib.import_module(module.name)
    load_plugins()


_discover()

PARTS = ("flyer", "film", "environment", "force", "payload")
"""Sections whose numbers describe a design."""

BASES: dict[str, type[Alternative]] = {
    "flyer": FlyerSection,
    "film": FilmSection,
    "environment": EnvironmentSection,
    "force": ForceSection,
}
"""Those of them that have alternatives."""

_LEVEL = 90.0  # degrees from the vertical
_ANY_MODEL = "kinetic"  # where the flyer is unknown: the error about that comes first


class FlyerFile(Section):
    """A flyer file: what the flyer is, where it flies and how its force is computed.

    Also buildable in Python, with the same names and texts as in the file::

        FlyerFile(
            flyer={"diameter": "2 cm"},
            film={"areal_density": "1.0 g/m^2", "absorptance": 0.75, "emittance": 0.08,
                  "tac_top": 0.8, "tac_bottom": "0.90 ± 0.03"},
        )

    Numbers are :class:`~lightflyer.core.units.Measured`: value and uncertainty, in SI units
    (angles in degrees).
    """

    flyer: FlyerSection
    film: FilmSection | None = None
    environment: EnvironmentSection
    force: ForceSection
    payload: PayloadSection | None = None

    @pydantic.model_validator(mode="before")
    @classmethod
    def _with_defaults(cls, content: Any) -> Any:
        """The environment where none is given, and the flyer's own force model."""
        if not isinstance(content, Mapping):
            return content
        kind = FlyerSection.alternatives.get(FlyerSection.tag_of(content.get("flyer")))
        model = _ANY_MODEL if kind is None else kind.default_model  # type: ignore[attr-defined]
        given = {key: entry for key, entry in content.items() if entry is not None}
        force = given.get("force")
        if isinstance(force, Mapping) and "model" not in force:
            given["force"] = {"model": model, **force}
        return {"environment": {}, "force": {"model": model}} | given

    @pydantic.model_validator(mode="after")
    def _belong_together(self) -> "FlyerFile":
        if self.flyer.needs_film and self.film is None:
            raise ConfigurationError("the section [film] is missing")
        if not self.flyer.needs_film and self.film is not None:
            own = "holds its films in sections of its own"
            if not self.flyer.flyer_type.film_names():
                own = "has none"
            raise ConfigurationError(
                f'[film] does not belong to shape = "{self.flyer.tag()}", which {own}'
            )
        try:
            self.force.model_type.require_flyer(self.flyer.flyer_type)
        except ParameterError:
            suitable = ", ".join(f'"{name}"' for name in models_for(type(self.flyer)))
            raise ConfigurationError(
                f'force.model = "{self.force.tag()}" is not for shape = "{self.flyer.tag()}"; '
                f"choose from {suitable}"
            ) from None
        if self.films() and self.environment.incidence.value > _LEVEL:
            raise ConfigurationError(
                f"environment.incidence above {_LEVEL:g} deg is light from below, which is for "
                "spheres: films know no beam on their bottom face"
            )
        for name, film in self.films().items():
            lacking = film.lacking()
            if lacking:
                raise ConfigurationError(f"[{name}] needs {lacking}")
        return self

    def parts(self) -> dict[str, Section]:
        """The sections that are there, by name."""
        found = {name: getattr(self, name) for name in PARTS}
        return {name: section for name, section in found.items() if section is not None}

    def films(self) -> dict[str, FilmSection]:
        """Sections of all films, by dotted name: ``"film"``, or such as ``"flyer.top"``."""
        inside = {
            f"flyer.{name}": getattr(self.flyer, name) for name in type(self.flyer).model_fields
        }
        candidates = {"film": self.film} | inside
        return {name: film for name, film in candidates.items() if isinstance(film, FilmSection)}

    def build(self) -> Setup:
        """The flyer, environment and force model described."""
        return build(self.parts())

    def design(self, text: str = "") -> "FileDesign":
        """The design described, whose numbers have the names that they have in the file."""
        return FileDesign(self, text)

    def uncertainties(self) -> dict[str, float]:
        """The standard uncertainties by dotted name, in the units of the values."""
        stated = {
            f"{part}.{name}": value
            for part, section in self.parts().items()
            for name, _, value in section.numbers()
            if value is not None
        }
        return {
            name: value.uncertainty
            for name, value in (stated | self.implied_numbers()).items()
            if value.uncertainty is not None
        }

    def implied_numbers(self) -> dict[str, Measured]:
        """Numbers that the file leaves to the materials of its films, by dotted name."""
        return {
            f"{name}.{key}": value
            for name, film in self.films().items()
            for key, value in film.implied.items()
        }


def models_for(kind: type[FlyerSection]) -> list[str]:
    """Names of the force models that are for a flyer; ``kind``: section of the flyer."""
    return [
        tag
        for tag, section in ForceSection.alternatives.items()
        if issubclass(kind.flyer_type, section.model_type.flyers)  # type: ignore[attr-defined]
    ]


def build(parts: Mapping[str, Any]) -> Setup:
    """Objects from sections; ``parts``: by the section's name."""
    environment = parts["environment"]
    incidence = environment.light_incidence
    film, flyer = parts.get("film"), parts["flyer"]
    passing = flyer.needs_transmittance
    properties = None if film is None else film.build(incidence, passing=passing)
    return Setup(
        flyer=flyer.build(properties, incidence),
        environment=environment.build(),
        model=parts["force"].build(),
        search_range=environment.search_range,
        budget=parts["payload"].build() if "payload" in parts else None,
    )


class FileDesign(AbstractDesign):
    """The design that a flyer file describes."""

    # Equal to any other of the same file. Can be pickled.

    def __init__(self, file: FlyerFile, text: str = ""):
        self.file, self.text = file, text

    def __eq__(self, other: object) -> bool:
        return isinstance(other, FileDesign) and other.file == self.file

    def __hash__(self) -> int:
        return hash(self.file)

    @cached_property
    def _all(self) -> dict[str, tuple[Section, str, Quantity, Any]]:
        """Section, name within it, quantity and value of every number of the file."""
        return {
            f"{part}.{name}": (section, name, quantity, value)
            for part, section in self.file.parts().items()
            for name, quantity, value in section.numbers()
        }

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        return {
            name: quantity
            for name, (section, inner, quantity, _) in self._all.items()
            if section.reason_not_varied(inner) is None
        }

    def number(self, name: str) -> float | None:
        """Number of a field; that of the materials where the file gives none."""
        value = self._all[name][3] if name in self._all else None
        value = self.file.implied_numbers().get(name) if value is None else value
        return None if value is None else float(value.value)

    @property
    def uncertainties(self) -> dict[str, float]:
        return self.file.uncertainties()

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        found: dict[tuple[str, str], float] = {}
        materials: dict[str, str] = {}
        for name, film in self.file.films().items():
            for (first, second), value in film.correlations.items():
                found[(f"{name}.{first}", f"{name}.{second}")] = value
            materials |= {f"{name}.{key}": made for key, made in film.implied_materials.items()}
        for one, other in combinations(materials, 2):  # the same material has the same error
            if materials[one] == materials[other] and (one, other) not in found:
                found[(one, other)] = 1.0
        return found

    def why_not_varied(self, name: str) -> str | None:
        if name not in self._all:
            return None
        section, inner, _, _ = self._all[name]
        return section.reason_not_varied(inner)

    def label(self, name: str) -> str:
        """Material of a layer, for its thickness."""
        section = part_at(self.file.parts(), name.rpartition(".")[0])
        return str(getattr(section, "label", ""))

    def conflict(self, names: list[str]) -> tuple[str, str] | None:
        """An emittance for both faces beside one for a face."""
        for name in names:
            part, _, last = name.rpartition(".")
            if last == "emittance":
                for face in (f"{part}.emittance_top", f"{part}.emittance_bottom"):
                    if face in names:
                        return face, name
        return None

    def data_bounds(self) -> dict[str, tuple[Any, Any]]:
        """Bounds of films whose optical data are incomplete."""
        found, incidence = {}, float(self.file.environment.light_incidence)
        for name, film in self.file.films().items():
            for what, (lower, upper) in film.bounds(incidence, passing=self._passing).items():
                ends = {**self._own_films, name: lower}, {**self._own_films, name: upper}
                found[f"{name}.{what}"] = ends
        return found

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings; those of a film within the flyer name it."""
        return self.warnings_for({})

    def warnings_for(self, values: Mapping[str, float]) -> tuple[str, ...]:
        costly = self.needs_recompute(
            list(values)
        )  # others leave the optics, and their warnings, alone
        parts = self._parts_with({name: values[name] for name in costly})
        incidence = float(parts["environment"].light_incidence)
        return tuple(
            text if name == "film" else f"{name}: {text}"
            for name in self.file.films()
            for text in part_at(parts, name).warnings(incidence, passing=self._passing)
        ) + tuple(parts["flyer"].warnings)

    @property
    def _passing(self) -> bool:
        return self.file.flyer.needs_transmittance

    def needs_recompute(self, names: list[str]) -> list[str]:
        """Whether a field changes the optics of layers."""
        films = self.file.films()
        directions = [f"environment.{key}" for key in self.file.environment.incidence_keys]
        return [
            name
            for name in names
            if any(
                film.changes_optics(
                    "incidence" if name in directions else name.removeprefix(f"{own}."),
                    passing=self._passing,
                )
                for own, film in films.items()
                if name in directions or name.startswith(f"{own}.")
            )
        ]

    def precompute(self, values: Mapping[str, float], *, coarse: bool = False) -> Any:
        """Properties of the films of layers, by name."""
        parts = self._parts_with(values)
        incidence = parts["environment"].light_incidence
        return {
            name: part_at(parts, name).build(incidence, passing=self._passing, coarse=coarse)
            for name, film in self.file.films().items()
            if film.layered
        }

    def surrogate(self, names: Sequence[str]) -> SurrogateFilms:
        """Interpolation for films whose thicknesses change."""
        keys, passing = self.file.environment.incidence_keys, self.file.flyer.needs_transmittance
        return SurrogateFilms(self.file.films(), keys, self._parts_with, names, passing=passing)

    def stacks(self, asked: Any, folder: Path | None = None) -> AbstractStacks:
        from lightflyer.config.searched_films import Stacks

        return Stacks(self, asked, folder)

    def build(self, values: Mapping[str, Numeric] | None = None, prepared: Any = None) -> Setup:
        values = values or {}
        if prepared is None and not self.needs_recompute(list(values)):
            prepared = self._own_films  # measured numbers may be traced, layers stay as they are
        parts = self._parts_with(values)
        for name, properties in (prepared or {}).items():
            film = part_at(parts, name).with_optics(properties)
            first, _, inner = name.partition(".")
            parts[first] = parts[first].model_copy(update={inner: film}) if inner else film
        return build(parts)

    @property
    def _own_films(self) -> dict[str, Any]:
        kept = vars(self)  # see setup
        if "_films" not in kept:
            with by_numpy():  # it stays, so it must not belong to a trace
                kept["_films"] = dict(self.precompute({}))
        return cast(dict[str, Any], kept["_films"])

    def _parts_with(self, values: Mapping[str, Numeric]) -> dict[str, Any]:
        parts: dict[str, Section] = self.file.parts()
        for name in parts:
            mine = {
                key.removeprefix(f"{name}."): value
                for key, value in values.items()
                if key.startswith(f"{name}.")
            }
            if mine:
                parts[name] = parts[name].with_values(mine)
        return parts

    def description(self) -> dict[str, str]:
        described = {}
        for part, content in self.file.model_dump(mode="json").items():
            for key, entry in _flatten(content or {}):
                if entry is not None:
                    described[f"flyer file: {part}.{key}"] = json.dumps(entry)
        # what the sections read from elsewhere: materials, spectra, atmospheres
        leaves = tree.leaves(self.setup)
        described["numbers of the flyer file and of its data"] = digest(*leaves)
        return described


def _flatten(content: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Entries of nested sections by dotted name; a list of sections stays one entry each."""
    found: list[tuple[str, Any]] = []
    for key, entry in content.items():
        if isinstance(entry, Mapping):
            found += [(f"{key}.{inner}", value) for inner, value in _flatten(entry)]
        elif isinstance(entry, list) and entry and isinstance(entry[0], Mapping):
            found += [(f"{key}.{number}", value) for number, value in enumerate(entry)]
        else:
            found.append((key, entry))
    return found


def section_at(name: str, content: Any) -> type[Section] | None:
    """Class of the section at a dotted name of the file, for messages about its keys."""
    first, _, rest = name.partition(".")
    if not first:
        return FlyerFile
    given = content.get(first) if isinstance(content, Mapping) else None
    kind: type[Section] | None = PayloadSection if first == "payload" else None
    if first in BASES:
        kind = BASES[first].alternatives.get(BASES[first].tag_of(given))
    return section_within(kind, rest, given)


def section_within(kind: type[Section] | None, rest: str, given: Any) -> type[Section] | None:
    """Class of the section at a dotted name within a section of some content."""
    for key in rest.split(".") if rest else []:
        if kind is None or key.isdigit():
            continue  # entries of a list are all alike
        given = given.get(key) if isinstance(given, Mapping) else None
        known = kind.model_fields.get(key)
        found = [] if known is None else sections_in(known.annotation)
        kind = found[0] if found else None
        if kind is not None and issubclass(kind, Alternative):
            kind = kind.alternatives.get(kind.tag_of(given))
    return kind


def sections_in(annotation: Any) -> list[type[Section]]:
    """Classes of sections within a type annotation, such as that of ``Section | None``."""
    if isinstance(annotation, type) and issubclass(annotation, Alternative):
        return list(annotation.alternatives.values())
    if isinstance(annotation, type) and issubclass(annotation, Section):
        return [annotation]
    return [
        section for part in getattr(annotation, "__args__", ()) for section in sections_in(part)
    ]
