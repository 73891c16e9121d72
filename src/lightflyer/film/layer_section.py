"""An entry of ``layers`` in ``[film]``: a material, a mixture, tables, or a formula."""

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pydantic
from pydantic import Field, ValidationInfo

from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    Density,
    Expansion,
    Fraction,
    Length,
    Modulus,
    Permittivity,
    PoissonRatio,
    Roughness,
    Stress,
    Temperature,
    Thickness,
)
from lightflyer.core.units import Measured
from lightflyer.files.section import Section
from lightflyer.files.toml_file import file_beside
from lightflyer.film.media.compound import Rule, Shape, TemperatureDependentMedium
from lightflyer.film.media.database import database_page, looks_like_page
from lightflyer.film.media.dispersion import (
    Cauchy,
    CodyLorentz,
    Drude,
    Formula,
    Gaussian,
    Lorentz,
    TaucLorentz,
)
from lightflyer.film.media.library import (
    MECHANICS,
    MEDIA,
    PAGES,
    VACUUM,
    Entry,
    canonical_name,
    material,
    mechanics_of,
)
from lightflyer.film.media.materials import names_file, vacuum
from lightflyer.film.media.medium import Extrapolation, Medium
from lightflyer.film.media.mixture import SHEETS, Graded, Mixture
from lightflyer.film.optics.stack import Layer
from lightflyer.structure.laminate import Lamina

Policy: Any = Literal[tuple(map(str, Extrapolation))]

_MOST_SHEETS = 200
_KINDS = ("material", "parts", "tables", "dispersion")
OF_NO_MEDIUM = ("thickness", "density", "tac", *MECHANICS)  # numbers of a layer
_OF_MIXTURES = ("rule", "shape", "grain", "sheets")


class CauchySection(Section, of=Cauchy):
    """``cauchy``: n = a + b/λ² + c/λ⁴."""


class TaucLorentzSection(Section, of=TaucLorentz):
    """An entry of ``tauc_lorentz``."""


class LorentzSection(Section, of=Lorentz):
    """An entry of ``lorentz``."""


class DrudeSection(Section, of=Drude):
    """An entry of ``drude``."""


class GaussianSection(Section, of=Gaussian):
    """An entry of ``gaussian``."""


class CodyLorentzSection(Section, of=CodyLorentz):
    """An entry of ``cody_lorentz``."""


class DispersionSection(Section):
    """``dispersion``: Cauchy's formula, or a permittivity of a constant and terms."""

    not_varied: ClassVar[dict[str, str]] = {
        "shortest": "is where the formula begins to hold",
        "longest": "is where the formula ends to hold",
    }

    cauchy: CauchySection | None = None
    permittivity: Permittivity = Measured(1.0)
    tauc_lorentz: Annotated[tuple[TaucLorentzSection, ...], Field(max_length=10)] = ()
    lorentz: Annotated[tuple[LorentzSection, ...], Field(max_length=50)] = ()
    drude: Annotated[tuple[DrudeSection, ...], Field(max_length=5)] = ()
    gaussian: Annotated[tuple[GaussianSection, ...], Field(max_length=50)] = ()
    cody_lorentz: Annotated[tuple[CodyLorentzSection, ...], Field(max_length=10)] = ()
    shortest: Length | None = None
    longest: Length | None = None

    @pydantic.model_validator(mode="after")
    def _one_kind(self) -> "DispersionSection":
        if bool(self._terms) is (self.cauchy is not None):
            raise ConfigurationError(
                "dispersion needs either cauchy, or terms: tauc_lorentz, cody_lorentz, lorentz, "
                "gaussian, drude"
            )
        self.medium("the layer", Extrapolation.ERROR)  # raises where the line is known
        return self

    @property
    def _terms(self) -> tuple[Section, ...]:
        return (
            *self.tauc_lorentz, *self.lorentz, *self.drude, *self.gaussian, *self.cody_lorentz
        )  # fmt: skip

    def medium(self, name: str, policy: Extrapolation) -> Formula:
        """The medium."""
        return Formula(
            name, tuple(term.make() for term in self._terms), self.permittivity.value,
            None if self.cauchy is None else self.cauchy.make(), extrapolation=policy,
            shortest=0.0 if self.shortest is None else float(self.shortest.value),
            longest=np.inf if self.longest is None else float(self.longest.value),
            origin="a formula with the file's parameters",
        )  # fmt: skip


class NamedSection(Section):
    """A material by its name, or a file."""

    @pydantic.field_validator("material", check_fields=False)
    @classmethod
    def _canonical_material(cls, name: str | None, info: ValidationInfo) -> str | None:
        """Its canonical name; raises here, where the line of the flyer file is known."""
        if name is None:
            return None
        if names_file(name) or looks_like_page(name):
            found = file_beside(name, info) if names_file(name) else database_page(name).name
            material(found)
            return found
        return canonical_name(name)


def named_medium(name: str, policy: Extrapolation, density: Measured | None = None) -> Medium:
    """A material by its name, or of a file."""
    found = material(name)
    if density is not None:
        found = found.with_density(density.value)
    return found.with_extrapolation(policy)


class PartSection(NamedSection):
    """An entry of ``parts``."""

    material: str
    fraction: Fraction | None = None
    fraction_bottom: Fraction | None = None
    density: Density | None = None


class TableSection(NamedSection):
    """An entry of ``tables``."""

    material: str
    at: Temperature | None = None

    def medium(self, policy: Extrapolation) -> tuple[float, Medium]:
        """Temperature, as the file or the material states it [K], and medium."""
        medium = named_medium(self.material, policy, None)
        stated = self.at.value if self.at else getattr(medium, "temperature", None)
        if stated is None:
            raise ConfigurationError(
                f'{self.material} states no temperature; give it, such as at = "300 K"'
            )
        return float(stated), medium


class LayerSection(NamedSection, of=Layer):
    """An entry of ``layers``."""

    material: str | None = None
    parts: Annotated[tuple[PartSection, ...], Field(min_length=2)] | None = None
    tables: Annotated[tuple[TableSection, ...], Field(min_length=2)] | None = None
    dispersion: DispersionSection | None = None
    name: str | None = None
    thickness: Thickness
    porosity: Fraction | None = None
    porosity_bottom: Fraction | None = None
    rule: Literal[tuple(map(str, Rule))] = str(Rule.BRUGGEMAN)  # type: ignore[valid-type]
    shape: Literal[tuple(map(str, Shape))] = str(Shape.SPHERES)  # type: ignore[valid-type]
    grain: Thickness | None = None
    sheets: Annotated[int, Field(ge=1, le=_MOST_SHEETS)] = SHEETS
    temperature: Temperature | None = None
    density: Density | None = None
    tac: AccommodationCoefficient | None = None
    extrapolation: Policy | None = None
    roughness: Roughness | None = None
    modulus: Modulus | None = None
    poisson: PoissonRatio | None = None
    expansion: Expansion | None = None
    stress: Stress | None = None
    strength: Modulus | None = None

    @pydantic.field_validator("thickness")
    @classmethod
    def _require_certain_thickness(cls, thickness: Measured) -> Measured:
        if not (thickness.uncertainty or 0.0) < thickness.value:
            raise ValueError("± is one standard deviation and must be below the thickness")
        return thickness

    @pydantic.model_validator(mode="after")
    def _one_kind(self) -> "LayerSection":
        kinds = [name for name in _KINDS if getattr(self, name)]
        if len(kinds) != 1:
            raise ConfigurationError(
                "give one of material, parts (of a mixture), tables (at several temperatures) and "
                f"dispersion (a formula), not {' and '.join(kinds) or 'none'}"
            )
        if self.material == VACUUM:
            raise ConfigurationError("vacuum is for parts of mixtures; a film has no empty layers")
        given = self.model_fields_set
        mixed = self.parts is not None or self.porosity is not None
        for name in _OF_MIXTURES:
            if name in given and not mixed:
                raise ConfigurationError(f"{name} is for layers with porosity or parts")
        if self.name is not None and self.dispersion is None:
            raise ConfigurationError("name is for layers with dispersion")
        if self.porosity is not None and self.material is None and self.dispersion is None:
            raise ConfigurationError(
                "porosity is for layers with material or dispersion; among parts, pores are a part "
                "of vacuum"
            )
        if self.porosity_bottom is not None and self.porosity is None:
            raise ConfigurationError("porosity_bottom needs porosity, that of the layer's top")
        if (self.temperature is None) is not (self.tables is None):
            raise ConfigurationError("temperature and tables need each other")
        return self

    @pydantic.model_validator(mode="after")
    def _possible(self) -> "LayerSection":
        rest = [part.material for part in self.parts or () if part.fraction is None]
        if self.parts is not None and len(rest) != 1:
            raise ConfigurationError(
                "every part but one has a fraction; the one without fills the rest "
                f"(without are {', '.join(rest) or 'none'})"
            )
        for part in self.parts or ():
            if part.fraction is None and part.fraction_bottom is not None:
                raise ConfigurationError(
                    f"fraction_bottom of {part.material} needs its fraction, at the layer's top"
                )
        if self.parts is None and self.porosity is None and self.tables is None:
            return self
        self.medium(Extrapolation.ERROR)  # raises here, where the line of the file is known
        for name, quantity, value in self.numbers():
            if value is None or not value.uncertainty or name in OF_NO_MEDIUM:
                continue
            for change in (value.uncertainty, -value.uncertainty):
                end = min(max(value.value + change, quantity.lowest), quantity.highest)
                other = self.with_values({name: end})
                assert isinstance(other, LayerSection)
                try:
                    other.medium(Extrapolation.ERROR)
                except ParameterError as error:
                    raise ConfigurationError(f"{name} ± one standard deviation: {error}") from error
        return self

    @property
    def label(self) -> str:
        """What the layer is made of, in words."""
        names = " + ".join(self._names)
        return names if self.porosity is None else f"porous {names}"

    @property
    def entries(self) -> Iterator[Entry]:
        """Entries of the library in the layer."""
        return (PAGES[name] for name in self._names if name in PAGES)

    @property
    def _names(self) -> list[str]:
        """Materials of the layer, its parts or its tables."""
        if self.dispersion is not None:
            return [self.name or "layer by a formula"]
        entries = self.parts or self.tables or ()
        return [self.material] if self.material else [entry.material for entry in entries]

    @property
    def library_tac(self) -> Measured | None:
        """TAC of the material, where the library has one [1]; of no mixture."""
        known = self.porosity is None and {**MEDIA, **PAGES}.get(str(self.material))
        return getattr(known, "tac", None)

    @property
    def surface_tac(self) -> Measured | None:
        """TAC of the material's surface, where somebody has measured it [1]."""
        return self.tac or self.library_tac

    @property
    def states_mechanics(self) -> bool:
        """Whether the file says anything of the layer as a structure."""
        return any(getattr(self, name) is not None for name in MECHANICS)

    @property
    def library_mechanics(self) -> dict[str, Measured]:
        """Mechanical numbers of the material that the file does not give; of no mixture."""
        known = mechanics_of(self.material) if self.material and self.porosity is None else {}
        return {name: value for name, value in known.items() if getattr(self, name) is None}

    def lamina(self) -> Lamina:
        """The layer as a structure."""
        stated = {name: getattr(self, name) for name in MECHANICS}
        found = {name: value for name, value in stated.items() if value is not None}
        found |= self.library_mechanics
        if lacking := [name for name in ("modulus", "poisson") if name not in found]:
            raise ConfigurationError(
                f"the layer of {self.label} needs its {' and '.join(lacking)}, as layers of the "
                "film state mechanical numbers"
            )
        numbers = {name: value.value for name, value in found.items()}
        return Lamina(self.thickness.value, **numbers)

    @property
    def lacks_density(self) -> str | None:
        """Name of what has no known density, None where the layer's mass can be computed."""
        medium = self.medium(Extrapolation.ERROR)
        if medium.density is not None:
            return None
        unknown = [one for one in getattr(medium, "parts", (medium,)) if one.density is None]
        return unknown[0].name

    def build(self, policy: str) -> Layer:
        """The layer; ``policy`` is the film's extrapolation policy."""
        chosen = Extrapolation(self.extrapolation or policy)
        layer: Layer = self.make(material=self.medium(chosen))
        return layer

    def medium(self, policy: Extrapolation) -> Medium:
        """What the layer is made of."""
        if self.material is not None and self.porosity is None:
            return named_medium(self.material, policy, self.density)
        found: Medium
        if self.tables is not None:
            known = dict(table.medium(policy) for table in self.tables)
            if len(known) != len(self.tables):
                raise ConfigurationError("two tables are for the same temperature")
            assert self.temperature is not None  # as checked
            temperatures = tuple(sorted(known))
            media = tuple(known[one] for one in temperatures)
            found = TemperatureDependentMedium(media, temperatures, self.temperature.value)
        elif self.dispersion is not None and self.porosity is None:
            found = self.dispersion.medium(self._names[0], policy)
        else:
            if self.parts is not None:
                parts = sorted(self.parts, key=lambda part: part.fraction is not None)
                media = tuple(named_medium(part.material, policy, part.density) for part in parts)
                fractions = [(part.fraction, part.fraction_bottom) for part in parts[1:]]
            else:
                solid = (
                    named_medium(str(self.material), policy, None)
                    if self.dispersion is None
                    else self.dispersion.medium(self._names[0], policy)
                )
                media, fractions = (solid, vacuum()), [(self.porosity, self.porosity_bottom)]
            law: dict[str, Any] = {
                "rule": Rule(self.rule),
                "shape": Shape(self.shape),
                "grain": None if self.grain is None else float(self.grain.value),
            }
            top = tuple(one.value for one, _ in fractions if one is not None)
            if any(end for _, end in fractions):
                bottom = tuple((end or one).value for one, end in fractions if one is not None)
                found = Graded(media, top, bottom, **law, count=self.sheets)
            else:
                found = Mixture(media, top, **law)
        return found if self.density is None else found.with_density(self.density.value)
