r"""Relaxation constants of the model equations, Shakhov's and one of Rykov's type.

Rates are in units of the collision frequency p/μ. A heat flux that relaxes at the rate
:math:`b` gives the Eucken factor 5/(3 b) for translation and 1/b for rotation, so that

.. math:: \frac{\kappa}{\mu R} = \frac32 f_\mathrm{tr} + f_\mathrm{rot}.
"""

from dataclasses import dataclass

from lightflyer.core.errors import ParameterError


@dataclass(frozen=True)
class GasModel:
    """Constants of a model gas."""

    name: str
    translational_rate: float  # Relaxation rate of the translational heat flux [p/μ]
    rotational_rate: float  # Relaxation rate of the rotational heat flux [p/μ]; 0 without rotation
    # Rate at which translational and rotational energy equilibrate, 1/Z [p/μ]; 0 without rotation
    exchange_rate: float
    viscosity_exponent: float  # ω of μ ∝ T^ω

    @property
    def has_rotation(self) -> bool:
        """Whether molecules carry rotational energy."""
        return self.rotational_rate > 0.0

    @property
    def of_kernel(self) -> tuple[float, float, float, float, bool]:
        """Argument of the non-linear kernel."""
        return (
            0.8 * (1.0 - self.translational_rate),
            2.0 * (1.0 - self.rotational_rate),
            self.exchange_rate,
            -self.viscosity_exponent,
            self.has_rotation,
        )


MONATOMIC = GasModel("monatomic", 2.0 / 3.0, 0.0, 0.0, 0.66)
"""Prandtl number 2/3 and helium's viscosity exponent [Bird1994]_."""

# they give κ/(μR) = 4.87; measured at 300 K: 4.89 [LemmonJacobsen2004]_
_EUCKEN_TRANSLATION, _EUCKEN_ROTATION = 2.37, 1.31
_COLLISION_NUMBER = 3.5  # 4.5 in units of the usual collision rate, 4 p/(π μ)

DIATOMIC = GasModel(
    "diatomic",
    5.0 / (3.0 * _EUCKEN_TRANSLATION),
    1.0 / _EUCKEN_ROTATION,
    1.0 / _COLLISION_NUMBER,
    0.74,
)
"""Nitrogen near 300 K, and air: Eucken factor of translation as in [Wu2015]_, exponent of
[Bird1994]_."""

_MODELS = {model.name: model for model in (MONATOMIC, DIATOMIC)}


def gas_model(name: str) -> GasModel:
    """Model gas by name."""
    try:
        return _MODELS[name]
    except KeyError:
        allowed = " or ".join(_MODELS)
        raise ParameterError(f'gas = "{name}" is not {allowed}') from None
