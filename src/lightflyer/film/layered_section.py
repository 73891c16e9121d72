"""``[film]`` given by its layers: what is not measured is computed."""

import dataclasses
import re
from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np
import pydantic
from pydantic import Discriminator, Field, Tag, ValidationInfo

from lightflyer.core.checks import is_traced
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    ArealDensity,
    Correlation,
    Fraction,
    Roughness,
)
from lightflyer.core.units import Measured
from lightflyer.files.section import Section
from lightflyer.files.toml_file import file_beside
from lightflyer.film.computed import ComputedFilm, with_measurements
from lightflyer.film.layer_section import OF_NO_MEDIUM, LayerSection, Policy, is_varied
from lightflyer.film.media.mechanics import NUMBERS as MECHANICS
from lightflyer.film.optics.integration import COARSE_POINTS_PER_E_FOLD, POINTS_PER_E_FOLD
from lightflyer.film.optics.spectra import Spectrum, am0, cold_white_led, spectrum_from_csv
from lightflyer.film.optics.stack import Film
from lightflyer.film.properties import FilmProperties
from lightflyer.film.section import FACES, FilmSection, MeasuredFilmSection, WholeFilm
from lightflyer.structure.laminate import Laminate

_LAMPS = {"AM0": am0, "cold-white-led": cold_white_led}

_LIMIT = "highest_temperature"

_OF_MEDIA = re.compile(
    rf"(layers\.\d+|substrate|ambient)\.(?!({'|'.join(OF_NO_MEDIUM)})$)"
    r"|roughness_bottom|open_fraction"
)
"""Numbers that change a film's optics, but for thicknesses."""

_FREE = 'is for samples, which "lightflyer film" reads: a flyer\'s film stands free'
_HOLES = (
    'is for samples, which "lightflyer film" reads: gas flows through a flyer\'s holes, which '
    "[flyer] gives"
)
_OF_SAMPLES = {
    "substrate": _FREE,
    "ambient": _FREE,
    "open_fraction": _HOLES,
    "hole_diameter": _HOLES,
}
"""Keys of a film that is no flyer's, and why they are refused in a flyer file."""


_ROUNDING = 1e-9  # variance along a principal axis of correlations that is none
_NO_COVARIANCE = -1e-9  # eigenvalue of a matrix of correlations, below which there is none


class CorrelationSection(Section):
    """An entry of ``correlated``: the correlation of the errors of two numbers with ±."""

    not_varied: ClassVar[Mapping[str, str]] = {"value": "is about uncertainties, not a design"}

    of: tuple[str, str]
    value: Correlation


class LayeredFilmSection(FilmSection):
    """``[film]``: layers, top to bottom, and measured values that replace computed ones."""

    kind: ClassVar[str] = "layered"
    layered: ClassVar[bool] = True

    not_varied: ClassVar[Mapping[str, str]] = {
        **FilmSection.not_varied,
        "at": "is that of a table",
        "grain": "changes no result, only what is said of it",
    }

    layers: Annotated[tuple[LayerSection, ...], Field(min_length=1)]
    extrapolation: Policy = "error"
    spectrum: str = "AM0"
    areal_density: ArealDensity | None = None
    absorptance: Fraction | None = None
    tac_top: AccommodationCoefficient | None = None
    tac_bottom: AccommodationCoefficient | None = None
    roughness_bottom: Roughness | None = None
    correlated: tuple[CorrelationSection, ...] = ()

    _optics: FilmProperties | WholeFilm | None = pydantic.PrivateAttr(None)

    @pydantic.model_validator(mode="before")
    @classmethod
    def _stands_free(cls, content: Any) -> Any:
        found = [name for name in _OF_SAMPLES if isinstance(content, Mapping) and name in content]
        if found and found[0] not in cls.model_fields:
            raise ConfigurationError(f"{found[0]} {_OF_SAMPLES[found[0]]}")
        return content

    @pydantic.field_validator("spectrum")
    @classmethod
    def _known_spectrum(cls, name: str, info: ValidationInfo) -> str:
        if name in _LAMPS:
            return name
        if not name.lower().endswith(".csv"):
            known = ", ".join(_LAMPS)
            raise ConfigurationError(
                f'spectrum "{name}" is unknown; choose from {known}, or a CSV file'
            )
        path = file_beside(name, info)
        spectrum_from_csv(path)
        return path

    def film(self) -> Film:
        layers = tuple(layer.build(self.extrapolation) for layer in self.layers)
        bottom = None if self.roughness_bottom is None else self.roughness_bottom.value
        return Film(layers, roughness_below=bottom)

    @pydantic.model_validator(mode="after")
    def _possible_correlations(self) -> "LayeredFilmSection":
        if not self.correlated:
            return self
        spreads = {
            name: value.uncertainty for name, _, value in self.numbers() if value is not None
        }
        for entry in self.correlated:
            for name in entry.of:
                if not spreads.get(name):
                    raise ConfigurationError(f"correlated: {name} is no number with ± in [film]")
            if entry.of[0] == entry.of[1]:
                raise ConfigurationError(f"correlated: {entry.of[0]} is named twice in one entry")
        names, matrix = self._correlation()
        if np.linalg.eigvalsh(matrix)[0] < _NO_COVARIANCE:
            raise ConfigurationError(
                f"correlated: no errors have these correlations of {', '.join(names)}"
            )
        return self

    def _correlation(self) -> tuple[list[str], np.ndarray]:
        """Names and correlations of the numbers that are correlated with others."""
        names = list(dict.fromkeys(name for entry in self.correlated for name in entry.of))
        matrix = np.eye(len(names))
        for entry in self.correlated:
            row, column = (names.index(name) for name in entry.of)
            matrix[row, column] = matrix[column, row] = entry.value.value
        return names, matrix

    @property
    def independent_spreads(self) -> list[float | None]:
        """Standard uncertainty of each layer's thickness that is correlated with nothing [m]."""
        tied = set(self._correlation()[0])
        return [
            None if f"layers.{number}.thickness" in tied else layer.thickness.uncertainty
            for number, layer in enumerate(self.layers)
        ]

    def neighbours(self) -> list[tuple[Film, Film]]:
        """Films one standard uncertainty above and below the file's, for each number with ±."""
        # Thicknesses, densities and accommodation coefficients of layers are left out: the first
        # two are treated by themselves, the last change no optics. A value stays in its range.
        # Numbers whose errors are correlated, thicknesses too, move together: along each principal
        # axis of their covariance.
        found = self._joint_neighbours()
        tied = set(self._correlation()[0])
        for name, quantity, value in self.numbers():
            if value is None or not value.uncertainty or not _OF_MEDIA.match(name):
                continue
            if name in tied:
                continue
            above, below = (
                min(max(value.value + change, quantity.lowest), quantity.highest)
                for change in (value.uncertainty, -value.uncertainty)
            )
            found.append((self._film_with(name, above), self._film_with(name, below)))
        return found

    def _joint_neighbours(self) -> list[tuple[Film, Film]]:
        names, matrix = self._correlation()
        known = {name: (kind, value) for name, kind, value in self.numbers() if name in names}
        middle = np.array([known[name][1].value for name in names])  # type: ignore[union-attr]
        spread = np.array([known[name][1].uncertainty for name in names])  # type: ignore[union-attr]
        lowest, highest = (
            np.array([getattr(known[name][0], end) for name in names])
            for end in ("lowest", "highest")
        )
        variances, axes = np.linalg.eigh(matrix)
        found = []
        for variance, axis in zip(variances, axes.T, strict=True):
            if variance <= _ROUNDING:
                continue
            change = np.sqrt(variance) * axis * spread
            ends = (np.clip(middle + sign * change, lowest, highest) for sign in (1.0, -1.0))
            above, below = (self._film_of(dict(zip(names, end, strict=True))) for end in ends)
            found.append((above, below))
        return found

    def _film_with(self, name: str, value: float) -> Film:
        return self._film_of({name: value})

    def _film_of(self, values: Mapping[str, float]) -> Film:
        changed = self.with_values(values)
        assert isinstance(changed, LayeredFilmSection)
        return changed.film()

    def light(self) -> Spectrum:
        known = _LAMPS.get(self.spectrum)
        return known() if known else spectrum_from_csv(self.spectrum)

    @property
    def implied(self) -> dict[str, Measured]:
        """Numbers of the materials that the section does not give itself: TACs, mechanics."""
        mechanics = {
            f"layers.{number}.{name}": value
            for number, layer in enumerate(self.layers if self.is_structure else ())
            for name, value in layer.library_mechanics.items()
        }
        return self._implied_tacs | mechanics

    @property
    def _implied_tacs(self) -> dict[str, Measured]:
        surfaces = self._surfaces()
        return {
            name: layer.library_tac
            for name, layer in surfaces.items()
            if getattr(self, name) is None and layer.tac is None and layer.library_tac is not None
        }

    @property
    def implied_materials(self) -> dict[str, str]:
        surfaces = self._surfaces()
        tacs = {name: surfaces[name].label for name in self._implied_tacs}
        mechanics = {
            name: f"{self.layers[int(name.split('.')[1])].label} {name.rpartition('.')[2]}"
            for name in self.implied
            if name not in tacs
        }
        return tacs | mechanics

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlations; errors of one material are one error."""
        stated = {entry.of: float(entry.value.value) for entry in self.correlated}
        materials = {layer.label for layer in self._surfaces().values()}
        if len(self._implied_tacs) == len(FACES) and len(materials) == 1:
            return {**stated, (FACES[0], FACES[1]): 1.0}
        return {**stated, **super().correlations}

    def _surfaces(self) -> dict[str, LayerSection]:
        """The layer at each face, by the name of its TAC."""
        return dict(zip(FACES, (self.layers[0], self.layers[-1]), strict=True))

    def measured_values(self) -> dict[str, Measured]:
        """The values that replace computed ones, by the name of the property."""
        surfaces = {name: layer.surface_tac for name, layer in self._surfaces().items()}
        known = {name: value for name, value in surfaces.items() if value is not None}
        known |= self.stated_values()
        known.pop(_LIMIT, None)  # nobody measures it, and it changes no result
        return known

    def limit(self) -> float | None:
        """Temperature that the film bears by the file, else by the first material to melt [K]."""
        if self.highest_temperature is not None:
            return float(self.highest_temperature.value)
        known = (entry for layer in self.layers for entry in layer.entries)
        limits = [entry.highest_temperature for entry in known if entry.highest_temperature]
        return min(limits, default=None)

    def compute_properties(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> ComputedFilm:
        """The film's properties with the origin of each, for light at an incidence [rad]."""
        # ``passing`` says whether transmittances matter, ``coarse`` that a change is asked
        lacking = self.lacking()
        if lacking:
            raise ConfigurationError(f"the film needs {lacking}")
        compute = _compute if is_traced(incidence) or is_varied(self) else _computed
        return compute(self, incidence, passing, coarse)

    def bounds(
        self, incidence: float = 0.0, *, passing: bool = True
    ) -> dict[str, tuple[FilmProperties, FilmProperties]]:
        found = self.compute_properties(incidence, passing=passing).bounds
        laminate = self._laminate()
        return {
            name: (
                dataclasses.replace(lower, laminate=laminate),
                dataclasses.replace(upper, laminate=laminate),
            )
            for name, (lower, upper) in found.items()
        }

    def warnings(self, incidence: float = 0.0, *, passing: bool = True) -> tuple[str, ...]:
        computed = self.compute_properties(incidence, passing=passing).warnings
        return super().warnings(passing=passing) + computed

    def lacking(self) -> str | None:
        """TACs and densities that neither file nor materials give."""
        for name, layer in self._surfaces().items():
            if getattr(self, name) is None and layer.surface_tac is None:
                return f"{name}: no measured accommodation coefficient of {layer.label} is known"
        for layer in self.layers:
            if self.areal_density is None and (unknown := layer.lacks_density):
                why = "" if unknown == layer.label else f", as that of {unknown} is unknown"
                return f"areal_density, or the layer of {layer.label} its density{why}"
        return None

    def with_optics(self, properties: FilmProperties | WholeFilm) -> "LayeredFilmSection":
        film = self.model_copy()
        film._optics = properties
        return film

    @property
    def is_structure(self) -> bool:
        """Whether the file says anything of the film as a structure."""
        return any(layer.states_mechanics for layer in self.layers)

    def _laminate(self) -> Laminate | None:
        return (
            Laminate(tuple(layer.lamina() for layer in self.layers)) if self.is_structure else None
        )

    def build(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> FilmProperties:
        if isinstance(self._optics, WholeFilm):
            return self._optics.properties
        if self._optics is None:
            computed = self.compute_properties(incidence, passing=passing, coarse=coarse)
            return dataclasses.replace(computed.properties, laminate=self._laminate())
        given = {name: value.value for name, value in self.measured_values().items()}
        own = {_LIMIT: self.limit(), "laminate": self._laminate()}
        return FilmProperties(**with_measurements(self._optics, given) | own)

    def changes_optics(self, name: str, *, passing: bool = True) -> bool:
        through = passing and self.transmittance is None
        computed = self.absorptance is None or through
        own = name.startswith("layers.") and name.rpartition(".")[2] not in MECHANICS
        own |= name == "roughness_bottom"
        return own or (name == "incidence" and computed)

    def report(self, incidence: float = 0.0, *, passing: bool = True) -> dict[str, Any]:
        return self.compute_properties(incidence, passing=passing).report()


def _compute(
    section: LayeredFilmSection, incidence: float, passing: bool, coarse: bool
) -> ComputedFilm:
    return ComputedFilm.of(
        section.film(),
        section.measured_values(),
        spectrum=section.light(),
        incidence=incidence,
        highest_temperature=section.limit(),
        passing=passing,
        points_per_e_fold=COARSE_POINTS_PER_E_FOLD if coarse else POINTS_PER_E_FOLD,
    )


_computed = cache(_compute)

AnyFilmSection: TypeAlias = Annotated[
    Annotated[MeasuredFilmSection, Tag(MeasuredFilmSection.kind)]
    | Annotated[LayeredFilmSection, Tag(LayeredFilmSection.kind)],
    Discriminator(FilmSection.tag_of),
]
"""Type of a field that is a film: measured, or of layers.

The section of a flyer of several films has it for each of them.
"""
