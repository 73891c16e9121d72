"""Films of a flyer file that a search changes: their thicknesses, or their stack of materials."""

import itertools
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pydantic

from lightflyer.array.namespace import Numeric
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.design.design import AbstractDesign, AbstractStacks
from lightflyer.design.setup import Setup
from lightflyer.files.toml_file import FOLDER, format_error
from lightflyer.film.computed import surrogate_properties
from lightflyer.film.layer_section import OF_NO_MEDIUM, LayerSection
from lightflyer.film.optics.stack import Film
from lightflyer.film.optics.thickness_surrogate import ThicknessSurrogate
from lightflyer.film.properties import FACES, PROPERTIES, FilmProperties, WholeFilm

if TYPE_CHECKING:
    from lightflyer.config.flyer_file import FileDesign

_BOUNDS = ("from", "to", "scale", "uncertainty")
_CARRIER = "carrier"
_STATED_ONCE = (*FACES, "highest_temperature")  # what a flyer file may say of any film
_MOST = 20_000  # stacks in a search
_NO_LIMIT = 1e5  # [K], of a stack of which it is not known: no film gets so hot
_NO_OPTICS = ("areal_density", *FACES)


class SurrogateFilms:
    """Properties of a flyer file's films of layers, for other thicknesses or another incidence."""

    # Implements :class:`~lightflyer.design.design.Surrogate`.

    def __init__(
        self,
        films: Mapping[str, Any],
        incidence_keys: Sequence[str],
        parts_with: Callable[[Mapping[str, Numeric]], Mapping[str, Any]],
        names: Sequence[str] = (),
        *,
        passing: bool,
    ):
        self._directions = [f"environment.{key}" for key in incidence_keys]
        self._passing = passing
        self._parts_with = parts_with
        for name in names:
            if not self.knows(name):
                raise ConfigurationError(
                    f"{name} changes the index of a layer; a search frees thicknesses only: fix "
                    "it or sweep it"
                )
        self.tables = {
            name: surrogate_of(name, film, film.film()) for name, film in films.items()
            if film.layered
        }  # fmt: skip

    def knows(self, name: str) -> bool:
        """Whether a number leaves the indices of all layers alone."""
        return name in self._directions or name.rpartition(".")[2] in OF_NO_MEDIUM

    def __call__(
        self, values: Mapping[str, Numeric], tables: Mapping[str, ThicknessSurrogate]
    ) -> dict[str, FilmProperties]:
        """Properties of the films by name."""
        parts = self._parts_with(values)
        incidence, found = parts["environment"].light_incidence, {}
        for name, surrogate in tables.items():
            section = part_at(parts, name)
            beside = {key: value.value for key, value in section.measured_values().items()
                      if key in _NO_OPTICS}  # fmt: skip
            found[name] = section.with_optics(
                surrogate_properties(
                    section.film(), surrogate, beside, incidence, passing=self._passing
                )
            ).build()
        return found


def surrogate_of(name: str, section: Any, film: Film) -> ThicknessSurrogate:
    """Surrogate of the film of a section, whose name is in what is raised."""
    try:
        return ThicknessSurrogate.of(film, section.light())
    except ParameterError as error:
        raise ConfigurationError(f"[{name}]: {error}") from None


def part_at(parts: Mapping[str, Any], name: str) -> Any:
    """Section at a dotted name, such as ``"flyer.top"``."""
    first, *inner = name.split(".")
    part: Any = parts.get(first)
    for key in inner:
        part = part[int(key)] if key.isdigit() else getattr(part, key)
    return part


class Candidate:
    """A material of a search over stacks."""

    def __init__(self, entry: Mapping[str, Any], folder: Path | None):
        self.carrier = entry.get(_CARRIER, False)
        if not isinstance(self.carrier, bool):
            raise ConfigurationError(f"{_CARRIER} = {self.carrier} must be true or false")
        if missing := [key for key in ("material", "from", "to") if key not in entry]:
            raise ConfigurationError(
                f"needs {', '.join(missing)}, such as "
                '{ material = "PET", from = "500 nm", to = "2 um", carrier = true }'
            )
        self.bounds = {key: entry[key] for key in _BOUNDS if key in entry}
        self.bounds.setdefault("scale", "log")
        self.keys = {k: v for k, v in entry.items() if k not in (*_BOUNDS, _CARRIER)}
        self.layer = self._layer("from", folder)
        self.low, self.high = (
            float(layer.thickness.value) for layer in (self.layer, self._layer("to", folder))
        )
        if not self.low < self.high:
            raise ConfigurationError(
                f"{self.layer.label} has an empty range: from = {entry['from']}, to = {entry['to']}"
            )
        if lacking := self.layer.lacks_density:
            raise ConfigurationError(f"{lacking} needs its density, by which a film is weighed")

    def _layer(self, end: str, folder: Path | None) -> LayerSection:
        try:
            return LayerSection.model_validate(
                {**self.keys, "thickness": self.bounds[end]},
                context={FOLDER: folder} if folder else None,
            )
        except pydantic.ValidationError as error:
            lines = []
            for mistake in error.errors():
                name = ".".join(map(str, mistake["loc"])).replace("thickness", end)
                if mistake["type"] == "extra_forbidden":
                    taken = [key for key in LayerSection.model_fields if key != "thickness"]
                    known = ", ".join((*taken, *_BOUNDS, _CARRIER))
                    lines.append(f"{name} is unknown; choose from {known}")
                else:
                    lines.append(format_error(mistake, name))
            raise ConfigurationError("; ".join(lines)) from None


class StackTables(NamedTuple):
    """What the properties of one stack follow from, beside its thicknesses."""

    sequence: Sequence[int]
    film: Film  # With any thicknesses
    surrogate: ThicknessSurrogate
    beside: dict[str, Any]  # TACs [1] and the temperature that the film withstands [K]


class Stacks(AbstractStacks):
    """Stacks of a list of materials, each with one carrier and coatings on it."""

    def __init__(self, base: "FileDesign", asked: Any, folder: Path | None):
        self.base, self.film, self.most = base, asked.film, asked.most_layers
        self.section: Any = base.file.films().get(self.film)
        if self.section is None or not self.section.layered:
            known = [name for name, film in base.file.films().items() if film.layered]
            choice = " or ".join(known)
            choice = choice or "the flyer file has none; lightflyer init --kind layers writes one"
            raise ConfigurationError(f'film = "{self.film}" is no film of layers: {choice}')
        once = [name for name in self.section.stated_values() if name not in _STATED_ONCE]
        if once:
            raise ConfigurationError(
                f"{self.film}.{once[0]} in the flyer file is of one film; a search over stacks "
                "computes it: leave it out there"
            )
        self.candidates = []
        for number, entry in enumerate(asked.materials):
            try:
                self.candidates.append(Candidate(entry, folder))
            except (ConfigurationError, ParameterError) as error:
                name = entry.get("material", f"entry {number + 1}")
                raise ConfigurationError(f"materials: {name}: {error}") from None
        if not any(one.carrier for one in self.candidates):
            raise ConfigurationError(
                "needs a material with carrier = true: the film that can be handled, no thinner "
                "than its from, on which the others are coatings"
            )
        names = [one.layer.label for one in self.candidates]
        if repeated := [name for name in names if names.count(name) > 1]:
            raise ConfigurationError(f"has {repeated[0]} twice")
        numbers = range(len(self.candidates))
        total = sum(len(numbers) ** count for count in range(1, self.most + 1))
        if total > _MOST * len(numbers):
            raise ConfigurationError(
                f"{len(numbers)} materials in up to {self.most} layers are too many stacks; take "
                "fewer of either"
            )
        self.sequences = tuple(
            sequence
            for count in range(1, self.most + 1)
            for sequence in itertools.product(numbers, repeat=count)
            if sum(self.candidates[number].carrier for number in sequence) == 1
            and not any(one == other for one, other in itertools.pairwise(sequence))
            and None not in self._tacs(sequence)
        )
        if not self.sequences:
            raise ConfigurationError(
                f"allows no stack of at most {self.most} layers whose both faces have a known TAC; "
                "give tac to materials, or tac_top and tac_bottom to the flyer file's film"
            )
        self.shares = tuple(f"{self.film}.share.{number}" for number in range(self.most))
        self.design = AnyStack(self)
        stated = {face: getattr(self.section, face) for face in FACES}
        notes = [
            f"{face} = {known.value:g} of the flyer file is taken for every stack, whatever its "
            "surface is"
            for face, known in stated.items()
            if known is not None
        ]
        inside = [one.layer.label for one in self.candidates if one.layer.surface_tac is None]
        if inside and None in stated.values():
            notes.append(f"no TAC is known of {', '.join(inside)}: inside of stacks only")
        self.notes = tuple(notes)

    def _tacs(self, sequence: Sequence[int]) -> list[float | None]:
        """TAC of the top and the bottom face, None where it is not known."""
        found: list[float | None] = []
        for face, number in zip(FACES, (sequence[0], sequence[-1]), strict=True):
            known = getattr(self.section, face) or self.candidates[number].layer.surface_tac
            found.append(None if known is None else float(known.value))
        return found

    def labels(self, sequence: Sequence[int]) -> tuple[str, ...]:
        return tuple(self.candidates[number].layer.label for number in sequence)

    def limit(self, sequence: Sequence[int]) -> float:
        found = self._section(sequence).limit()
        return _NO_LIMIT if found is None else float(found)

    def tables(self, sequence: Sequence[int]) -> StackTables:
        section = self._section(sequence)
        film = section.film()
        surrogate = surrogate_of(self.film, section, film)
        if len(film.homogeneous().layers) > len(sequence):
            raise ConfigurationError("a search over stacks knows no graded layers")
        beside = {**dict(zip(FACES, self._tacs(sequence), strict=True)),
                  "highest_temperature": self.limit(sequence)}  # fmt: skip
        return StackTables(sequence, film, surrogate, beside)

    def thicknesses(self, sequence: Sequence[int], shares: np.ndarray) -> np.ndarray:
        low, high = np.array(
            [(self.candidates[n].low, self.candidates[n].high) for n in sequence]
        ).T
        return np.asarray(low * (high / low) ** np.asarray(shares)[: len(sequence)])

    def exact(self, sequence: Sequence[int], values: Mapping[str, float]) -> dict[str, WholeFilm]:
        shares = np.array([values[name] for name in self.shares])
        section = self._section(sequence, self.thicknesses(sequence, shares))
        found = section.build(self.incidence, passing=self.passing)
        fields = {name: getattr(found, name) for name in PROPERTIES}
        fields["highest_temperature"] = self.limit(sequence)
        return {self.film: WholeFilm(FilmProperties(**fields))}

    @property
    def incidence(self) -> float:
        """Of the light [rad]."""
        return float(self.base.file.environment.light_incidence)

    @property
    def passing(self) -> bool:
        """Whether transmittances matter."""
        return bool(self.base.file.flyer.needs_transmittance)

    def _section(self, sequence: Sequence[int], thickness: np.ndarray | None = None) -> Any:
        layers = tuple(self.candidates[number].layer for number in sequence)
        if thickness is not None:
            layers = tuple(
                layer.with_values({"thickness": float(one)})  # type: ignore[misc]
                for layer, one in zip(layers, thickness, strict=True)
            )
        return self.section.model_copy(update={"layers": layers})

    def choose(self, sequence: Sequence[int]) -> tuple[AbstractDesign, dict[str, Any]]:
        first, _, inner = self.film.partition(".")
        film = self._section(sequence)
        if inner:
            film = getattr(self.base.file, first).model_copy(update={inner: film})
        file = self.base.file.model_copy(update={first: film})
        over = {
            f"{self.film}.layers.{place}.thickness": self.candidates[number].bounds
            for place, number in enumerate(sequence)
        }
        return type(self.base)(file, self._text(sequence)), over

    def _text(self, sequence: Sequence[int]) -> str:
        """The flyer file's text with other layers; empty where there is none."""
        import tomlkit

        if not self.base.text:
            return ""
        document = tomlkit.parse(self.base.text)
        array = tomlkit.array()
        for number in sequence:
            candidate = self.candidates[number]
            table = tomlkit.inline_table()
            table.update({**candidate.keys, "thickness": candidate.bounds["from"]})
            array.append(table)
        part_at(document, self.film)["layers"] = array.multiline(True)
        return str(tomlkit.dumps(document))


class AnyStack(AbstractDesign):
    """A design whose film is any of some stacks."""

    def __init__(self, stacks: Stacks):
        self._stacks, self._base = stacks, stacks.base
        self.text = stacks.base.text
        self.tables: Any = stacks.tables(stacks.sequences[0])

    @cached_property
    def quantities(self) -> dict[str, Quantity]:
        """Fields that leave the film alone, and shares."""
        costly = self._base.needs_recompute(list(self._base.quantities))
        others = {
            name: quantity
            for name, quantity in self._base.quantities.items()
            if not name.startswith(f"{self._stacks.film}.") and name not in costly
        }
        return others | dict.fromkeys(self._stacks.shares, Quantity("", 0.0, 1.0))

    def number(self, name: str) -> float | None:
        return None if name in self._stacks.shares else self._base.number(name)

    @property
    def uncertainties(self) -> dict[str, float]:
        """None: stacks are ranked without."""
        return {}

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        return {}

    def description(self) -> dict[str, str]:
        return self._base.description()

    def needs_recompute(self, names: list[str]) -> list[str]:
        return [name for name in names if name in self._stacks.shares]

    def surrogate(self, names: Sequence[str]) -> "AnyStack":
        del names
        return self

    def knows(self, name: str) -> bool:
        """Whether a number is one of a thickness."""
        return name in self._stacks.shares

    def __call__(self, values: Mapping[str, Numeric], tables: StackTables) -> dict[str, WholeFilm]:
        """The film of a stack."""
        stacks, shares = self._stacks, np.array([values[name] for name in self._stacks.shares])
        film = surrogate_properties(
            tables.film.with_thicknesses(stacks.thicknesses(tables.sequence, shares)),
            tables.surrogate, tables.beside, stacks.incidence, passing=stacks.passing,
        )  # fmt: skip
        return {stacks.film: WholeFilm(film)}

    @property
    def setup(self) -> Setup:
        """That of the flyer file."""
        return self._base.setup

    def build(self, values: Mapping[str, Numeric] | None = None, prepared: Any = None) -> Setup:
        others = {
            name: value for name, value in (values or {}).items() if name not in self._stacks.shares
        }
        return self._base.build(others, {**self._base._own_films, **(prepared or {})})
