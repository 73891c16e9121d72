"""``dispersion`` of a layer: its n and k by a formula with parameters."""

from typing import Annotated, ClassVar

import numpy as np
import pydantic
from pydantic import Field

from lightflyer.film.dispersion import Cauchy, Drude, Formula, Lorentz, TaucLorentz
from lightflyer.film.medium import Extrapolation
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.quantity import (
    EnergyGap,
    Length,
    OscillatorStrength,
    Permittivity,
    PhotonEnergy,
    Quantity,
)
from lightflyer.foundation.section import Section
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured

_CAUCHY = Quantity("", 0.0, open_below=True)
_CAUCHY_B, _CAUCHY_C = Quantity("m^2"), Quantity("m^4")


class CauchySection(Section):
    """``cauchy``: n = a + b/λ² + c/λ⁴."""

    a: Annotated[Numeric, _CAUCHY]
    b: Annotated[Numeric, _CAUCHY_B] = Measured(0.0)
    c: Annotated[Numeric, _CAUCHY_C] = Measured(0.0)


class TaucLorentzSection(Section):
    """An entry of ``tauc_lorentz``."""

    amplitude: PhotonEnergy
    energy: PhotonEnergy
    broadening: PhotonEnergy
    gap: EnergyGap


class LorentzSection(Section):
    """An entry of ``lorentz``."""

    strength: OscillatorStrength
    energy: PhotonEnergy
    broadening: PhotonEnergy


class DrudeSection(Section):
    """An entry of ``drude``."""

    plasma: PhotonEnergy
    broadening: PhotonEnergy


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
    shortest: Length | None = None
    longest: Length | None = None

    @pydantic.model_validator(mode="after")
    def _one_kind(self) -> "DispersionSection":
        terms = bool(self.tauc_lorentz or self.lorentz or self.drude)
        if terms is (self.cauchy is not None):
            raise ConfigurationError(
                "dispersion needs either cauchy, or terms: tauc_lorentz, lorentz, drude"
            )
        self.medium("the layer", Extrapolation.ERROR)  # raises where the line is known
        return self

    def medium(self, name: str, policy: Extrapolation) -> Formula:
        """The medium."""
        cauchy = None
        if self.cauchy is not None:
            cauchy = Cauchy(self.cauchy.a.value, self.cauchy.b.value, self.cauchy.c.value)
        terms = (
            *(TaucLorentz(one.amplitude.value, one.energy.value, one.broadening.value,
                          one.gap.value) for one in self.tauc_lorentz),
            *(Lorentz(one.strength.value, one.energy.value, one.broadening.value)
              for one in self.lorentz),
            *(Drude(one.plasma.value, one.broadening.value) for one in self.drude),
        )  # fmt: skip
        return Formula(
            name, terms, self.permittivity.value, cauchy, extrapolation=policy,
            shortest=0.0 if self.shortest is None else float(self.shortest.value),
            longest=np.inf if self.longest is None else float(self.longest.value),
            origin="a formula with the file's parameters",
        )  # fmt: skip
