"""``[film]`` given by its layers: what is not measured is computed. Of flyers, and of samples."""

import dataclasses
import re
from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, ClassVar

import numpy as np
import pydantic
from pydantic import Field, ValidationInfo

from lightflyer.core.checks import is_traced
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    ArealDensity,
    Correlation,
    Fraction,
    Length,
    OpenFraction,
    Roughness,
    Thickness,
)
from lightflyer.core.units import Measured, parse
from lightflyer.files.section import Section
from lightflyer.files.toml_file import file_beside
from lightflyer.film.computed import ComputedFilm, with_measurements
from lightflyer.film.layer_section import OF_NO_MEDIUM, LayerSection, Policy
from lightflyer.film.media.library import MECHANICS
from lightflyer.film.media.medium import Extrapolation, Medium
from lightflyer.film.optics.averages import COARSE_POINTS_PER_E_FOLD, POINTS_PER_E_FOLD
from lightflyer.film.optics.spectra import (
    Spectrum,
    am0,
    cold_white_led,
    spectral_line,
    spectrum_from_csv,
)
from lightflyer.film.optics.stack import Film, neighbouring_films
from lightflyer.film.properties import FACES, FilmProperties, FilmSection, WholeFilm
from lightflyer.numerics.correlation import correlation_matrix
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

_ROUNDING = 1e-9  # of an eigenvalue of a matrix of correlations


class CorrelationSection(Section):
    """An entry of ``correlated``: the correlation of the errors of two numbers with ±."""

    not_varied: ClassVar[Mapping[str, str]] = {"value": "is about uncertainties, not a design"}

    of: tuple[str, str]
    value: Correlation


class LitSection(Section):
    """What a spectrum of light belongs to."""

    spectrum: str = "AM0"

    @pydantic.field_validator("spectrum")
    @classmethod
    def _known_spectrum(cls, name: str, info: ValidationInfo) -> str:
        if name in _LAMPS:
            return name
        is_file = name.lower().endswith(".csv")
        if name[:1].isdigit() and not is_file:
            light_of(name)
            return name
        if not is_file:
            known = ", ".join(_LAMPS)
            raise ConfigurationError(
                f'spectrum "{name}" is unknown; choose from {known}, or a CSV file, or a '
                'wavelength such as "532 nm"'
            )
        path = file_beside(name, info)
        spectrum_from_csv(path)
        return path

    def light(self) -> Spectrum:
        return light_of(self.spectrum)


def light_of(spectrum: str) -> Spectrum:
    """A spectrum by its name, or of a file."""
    if spectrum in _LAMPS:
        return _LAMPS[spectrum]()
    if spectrum.lower().endswith(".csv"):
        return spectrum_from_csv(spectrum)
    return spectral_line(parse(spectrum, "m", "nm").value)


class LayeredFilmSection(FilmSection, LitSection):
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

    def film(self) -> Film:
        layers = tuple(layer.build(self.extrapolation) for layer in self.layers)
        bottom = None if self.roughness_bottom is None else self.roughness_bottom.value
        return Film(layers, roughness_below=bottom)

    @pydantic.model_validator(mode="after")
    def _possible_correlations(self) -> "LayeredFilmSection":
        spreads = {
            name: value.uncertainty for name, _, value in self.numbers() if value is not None
        }
        for entry in self.correlated:
            for name in entry.of:
                if not spreads.get(name):
                    raise ConfigurationError(f"correlated: {name} is not a number with ± in [film]")
            if entry.of[0] == entry.of[1]:
                raise ConfigurationError(f"correlated: {entry.of[0]} is named twice in one entry")
        names = self._correlated_names
        matrix = correlation_matrix(names, self._stated_correlations)
        if names and np.linalg.eigvalsh(matrix)[0] < -_ROUNDING:
            raise ConfigurationError(
                f"correlated: no errors have these correlations of {', '.join(names)}"
            )
        return self

    @property
    def _stated_correlations(self) -> dict[tuple[str, str], float]:
        return {entry.of: float(entry.value.value) for entry in self.correlated}

    @property
    def _correlated_names(self) -> list[str]:
        return list(dict.fromkeys(name for entry in self.correlated for name in entry.of))

    @property
    def independent_spreads(self) -> list[float | None]:
        """Standard uncertainty of each layer's thickness that is correlated with nothing [m]."""
        return [
            None
            if f"layers.{number}.thickness" in self._correlated_names
            else layer.thickness.uncertainty
            for number, layer in enumerate(self.layers)
        ]

    def neighbours(self) -> list[tuple[Film, Film]]:
        """Films one standard uncertainty above and below the file's, for each number with ±."""
        # Thicknesses, densities and accommodation coefficients of layers are left out: the first
        # two are treated by themselves, the last change no optics. Where errors are correlated,
        # thicknesses count too.

        def film_with(values: Mapping[str, float]) -> Film:
            changed = self.with_values(values)
            assert isinstance(changed, LayeredFilmSection)
            return changed.film()

        numbers = {
            name: (quantity, value)
            for name, quantity, value in self.numbers()
            if value is not None
            and value.uncertainty
            and (_OF_MEDIA.match(name) or name in self._correlated_names)
        }
        return neighbouring_films(film_with, numbers, self._stated_correlations)

    @property
    def _of_library(self) -> dict[str, tuple[str, Measured]]:
        """Material and value of each TAC and mechanical number that the file leaves to it."""
        found = {
            name: (layer.label, layer.library_tac)
            for name, layer in self._surfaces().items()
            if getattr(self, name) is None and layer.tac is None and layer.library_tac is not None
        }
        for number, layer in enumerate(self.layers if self.is_structure else ()):
            for name, value in layer.library_mechanics.items():
                found[f"layers.{number}.{name}"] = (f"{layer.label} {name}", value)
        return found

    @property
    def implied(self) -> dict[str, Measured]:
        return {name: value for name, (_, value) in self._of_library.items()}

    @property
    def implied_materials(self) -> dict[str, str]:
        return {name: material for name, (material, _) in self._of_library.items()}

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlations; errors of one material are one error."""
        stated = self._stated_correlations
        materials = {layer.label for layer in self._surfaces().values()}
        if {*FACES} <= self._of_library.keys() and len(materials) == 1:
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
        """Limit of the film by the file, else by the first material to melt [K]."""
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
        numbers = [value.value for _, _, value in self.numbers() if value is not None]
        compute = _compute.__wrapped__ if is_traced(incidence, numbers) else _compute
        return compute(self, incidence, passing, coarse)

    def bounds(
        self, incidence: float = 0.0, *, passing: bool = True
    ) -> dict[str, tuple[FilmProperties, FilmProperties]]:
        computed = self.compute_properties(incidence, passing=passing)
        laminate = self._laminate()
        return {
            name: (dataclasses.replace(lower, laminate=laminate),
                   dataclasses.replace(upper, laminate=laminate))
            for name, (lower, upper) in computed.bounds.items()
        }  # fmt: skip

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
        if not self.is_structure:
            return None
        return Laminate(tuple(layer.lamina() for layer in self.layers))

    def build(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> FilmProperties:
        if isinstance(self._optics, WholeFilm):
            return self._optics.properties
        if self._optics is None:
            computed = self.compute_properties(incidence, passing=passing, coarse=coarse)
            return dataclasses.replace(computed.properties, laminate=self._laminate())
        given = {name: value.value for name, value in self.measured_values().items()}
        beside = {_LIMIT: self.limit(), "laminate": self._laminate()}
        return FilmProperties(**with_measurements(self._optics, given) | beside)

    def changes_optics(self, name: str, *, passing: bool = True) -> bool:
        if name == "incidence":
            return self.absorptance is None or (passing and self.transmittance is None)
        of_layer = name.startswith("layers.") and name.rpartition(".")[2] not in MECHANICS
        return of_layer or name == "roughness_bottom"

    def report(self, incidence: float = 0.0, *, passing: bool = True) -> dict[str, Any]:
        return self.compute_properties(incidence, passing=passing).report()


class SubstrateSection(LayerSection):
    """``substrate``: what the layers lie on, endless or so thick that light does not interfere."""

    thickness: Thickness | None = None
    coherent: bool = False


class SampleSection(LayeredFilmSection):
    """``[film]`` for ``lightflyer film``: of a flyer, or of a sample on a substrate."""

    of_other_files: ClassVar[bool] = True

    substrate: SubstrateSection | None = None
    ambient: SubstrateSection | None = None
    open_fraction: OpenFraction | None = None
    hole_diameter: Length | None = None

    @pydantic.model_validator(mode="after")
    def _possible(self) -> "SampleSection":
        if self.ambient is not None and self.ambient.thickness is not None:
            raise ConfigurationError("ambient has no thickness: light comes from within it")
        if self.hole_diameter is not None and self.open_fraction is None:
            raise ConfigurationError("hole_diameter needs open_fraction, the holes' share of area")
        for name in ("substrate", "ambient"):
            if self.open_fraction is not None and getattr(self, name) is not None:
                raise ConfigurationError(f"open_fraction: a film with holes has no {name}")
        return self

    @property
    def written_layers(self) -> tuple[LayerSection, ...]:
        """The layers as the file gives them, with a substrate that has a thickness."""
        if self.substrate is None or self.substrate.thickness is None:
            return self.layers
        return (*self.layers, self.substrate)

    def film(self) -> Film:
        """The layers with their materials, between what is above and below."""
        endless = self.substrate is not None and self.substrate.thickness is None
        bottom = self.substrate.roughness if endless and self.substrate else self.roughness_bottom
        return Film(
            tuple(layer.build(self.extrapolation) for layer in self.written_layers),
            above=self._medium(self.ambient),
            below=self._medium(self.substrate) if endless else None,
            roughness_below=None if bottom is None else bottom.value,
            open_fraction=None if self.open_fraction is None else self.open_fraction.value,
            hole_diameter=None if self.hole_diameter is None else self.hole_diameter.value,
        )

    def _medium(self, section: SubstrateSection | None) -> Medium | None:
        if section is None:
            return None
        return section.medium(Extrapolation(section.extrapolation or self.extrapolation))


@cache
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
