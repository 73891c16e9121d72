"""``dispersion`` of a layer: its n and k by a formula with parameters."""

from typing import Annotated, ClassVar

import numpy as np
import pydantic
from pydantic import Field

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import (
    Length,
    Permittivity,
)
from lightflyer.core.units import Measured
from lightflyer.files.section import Section
from lightflyer.film.media.dispersion import (
    Cauchy,
    CodyLorentz,
    Drude,
    Formula,
    Gaussian,
    Lorentz,
    TaucLorentz,
)
from lightflyer.film.media.medium import Extrapolation


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
