"""``[film]`` of a flyer file: what its alternatives share, and a film of measured properties."""

import abc
from collections.abc import Mapping
from typing import Any, ClassVar

import pydantic

from lightflyer.array.records import Module
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    ArealDensity,
    Correlation,
    Emittance,
    Fraction,
    Temperature,
)
from lightflyer.core.units import Measured
from lightflyer.files.section import Alternative
from lightflyer.film.properties import PROPERTIES, FilmProperties, require_conservation

_PASSING = ("transmittance", "transmittance_bottom", "infrared_transmittance")
FACES = ("tac_top", "tac_bottom")  # Numbers whose errors ``tac_correlation`` is about


class WholeFilm(Module):
    """All properties of a film, in which a section replaces nothing."""

    properties: FilmProperties


class FilmSection(Alternative, abc.ABC):
    """``[film]``: a film whose properties are measured, or computed from its layers."""

    kind: ClassVar[str]
    """``"measured"`` or ``"layered"``."""

    layered: ClassVar[bool] = False
    """Whether properties are computed from layers, which takes more than arithmetic."""

    not_varied: ClassVar[Mapping[str, str]] = {
        "tac_correlation": "is about uncertainties and changes no design",
        "highest_temperature": "is a limit and not a property",
    }

    absorptance_bottom: Fraction | None = None
    emittance: Emittance | None = None
    emittance_top: Emittance | None = None
    emittance_bottom: Emittance | None = None
    tac_correlation: Correlation = Measured(0.0)
    transmittance: Fraction | None = None
    transmittance_bottom: Fraction | None = None
    infrared_transmittance: Fraction | None = None
    highest_temperature: Temperature | None = None

    def idle(self) -> dict[str, str]:
        """A correlation without two errors has no effect."""
        faces = [getattr(self, name, None) or self.implied.get(name) for name in FACES]
        exact = [name for name, face in zip(FACES, faces, strict=True) if not (face and face[1])]
        shared = exact and self.tac_correlation.value
        return {"tac_correlation": f"without a ± of {' and '.join(exact)}"} if shared else {}

    @pydantic.model_validator(mode="after")
    def _one_emittance_a_face(self) -> "FilmSection":
        if self.emittance is not None and (self.emittance_top or self.emittance_bottom):
            raise ConfigurationError(
                "give either emittance, or emittance_top and emittance_bottom, not both"
            )
        return self

    @classmethod
    def tag(cls) -> str:
        return cls.kind

    @classmethod
    def tag_of(cls, content: Any) -> str:
        """``"layered"`` for a film with layers, else ``"measured"``."""
        layered = (
            "layers" in content if isinstance(content, Mapping) else hasattr(content, "layers")
        )
        return "layered" if layered else "measured"

    def with_values(self, values: Mapping[str, Any]) -> "FilmSection":
        """The same section with other numbers; one emittance stands for both faces."""
        cleared: dict[str, Measured | None] = {}
        if "emittance" in values:
            cleared = {"emittance_top": None, "emittance_bottom": None}
        elif self.emittance is not None and {"emittance_top", "emittance_bottom"} & values.keys():
            both = self.emittance
            cleared = {"emittance": None, "emittance_top": both, "emittance_bottom": both}
        section = self.model_copy(update=cleared) if cleared else self
        return super(FilmSection, section).with_values(values)  # type: ignore[return-value]

    def stated_values(self) -> dict[str, Measured]:
        """The values that the file gives, by the name of the film's property."""
        given = {
            name: getattr(self, name) for name in PROPERTIES if getattr(self, name) is not None
        }
        if self.emittance is not None:
            given |= {"emittance_top": self.emittance, "emittance_bottom": self.emittance}
        return given

    @property
    def implied(self) -> dict[str, Measured]:
        """Numbers that the file leaves to the film's materials, by the name of the key."""
        return {}

    @property
    def implied_materials(self) -> dict[str, str]:
        """Material of each number of :attr:`implied`, by the name of the key."""
        return {}

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of the errors of two numbers, by their names."""
        shared = self.tac_correlation.value
        both = all(getattr(self, name) or name in self.implied for name in FACES)
        return {(FACES[0], FACES[1]): shared} if both and shared else {}

    def bounds(
        self, incidence: float = 0.0, *, passing: bool = True
    ) -> dict[str, tuple[FilmProperties, FilmProperties]]:
        """The film at the bounds of what missing data leave open."""
        del incidence, passing
        return {}

    def warnings(self, incidence: float = 0.0, *, passing: bool = True) -> tuple[str, ...]:
        """What a reader of the film's properties must know, one line each."""
        del incidence
        unseen = [] if passing else [name for name in _PASSING if getattr(self, name) is not None]
        return tuple(f"{name} has no effect: nothing lies behind the film" for name in unseen)

    def report(self, incidence: float = 0.0, *, passing: bool = True) -> dict[str, Any]:
        """Value and origin of each property of a film of layers, as a JSON object in SI units."""
        del incidence, passing
        return {}

    @abc.abstractmethod
    def build(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> FilmProperties:
        """The film's properties, without their uncertainties."""
        # ``coarse`` is for their changes

    def lacking(self) -> str | None:
        """What the section must give beside its layers, in words; None where nothing lacks."""
        return None

    def with_optics(self, properties: FilmProperties | WholeFilm) -> "FilmSection":
        """A copy that does not compute the optics of layers anew."""
        del properties
        return self

    def changes_optics(self, name: str, *, passing: bool = True) -> bool:
        """Whether a number's change means computing the optics of layers anew."""
        del name, passing
        return False


class MeasuredFilmSection(FilmSection):
    """``[film]``: properties, measured or assumed."""

    kind: ClassVar[str] = "measured"

    areal_density: ArealDensity
    absorptance: Fraction
    tac_top: AccommodationCoefficient
    tac_bottom: AccommodationCoefficient

    @pydantic.model_validator(mode="after")
    def _both_emittances(self) -> "MeasuredFilmSection":
        if self.emittance is None and None in (self.emittance_top, self.emittance_bottom):
            raise ConfigurationError("give emittance, or both emittance_top and emittance_bottom")
        try:
            require_conservation(
                {name: value.value for name, value in self.stated_values().items()}
            )
        except ParameterError as error:
            raise ConfigurationError(str(error)) from error
        return self

    def build(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> FilmProperties:
        """The film's properties, without their uncertainties; the same at any incidence."""
        del incidence, passing, coarse
        stated: dict[str, Any] = self.stated_values()
        return FilmProperties(**{name: value.value for name, value in stated.items()})
