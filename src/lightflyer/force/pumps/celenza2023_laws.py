r"""Laws of hollow bodies as published, constants and all, as functions of plain numbers.

The constants are those of the published code, which gives the published masses to all their digits.

References
----------
[Celenza2023]_
"""

from typing import NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.errors import ParameterError
from lightflyer.gas.air import AbstractAir
from lightflyer.gas.base import AbstractGas

PI = 3.14  # As in the published code, 0.05 % too small
DENSITY_CONSTANT = 287.0  # Specific gas constant of air in the density [J/(kg K)]

SPEED_CONSTANT = 1.38e-23 / 4.8089e-26
"""Specific gas constant of air in the speed of the molecules [J/(kg K)]."""

CONDUCTIVITY = 0.024  # Of air [W/(m K)], at every temperature
THROUGH_WALL = 0.5  # Share of the absorbed light that passes the wall as heat [1]
FACE_DENSITY = 1e-3  # Areal density of both films together, whatever their thickness [kg/m²]
SHEET_DENSITY = 3950.0  # Of the alumina that lines the channels [kg/m³]
SHEET_CONDUCTIVITY = 1.8  # Of the alumina that lines the channels [W/(m K)]

_JUMP = 3.116  # temperature jump of both ends of a channel, in mean free paths
_VISCOSITY, _REFERENCE, _SUTHERLAND = 1.8205e-5, 293.0, 110.4  # [Pa s], [K], [K]


class FormCoefficients(NamedTuple):
    """Fits of the published force to simulations of the flow, by the shape."""

    drag: float  # :math:`C_1` and :math:`C_2` [1]
    jet: float  # :math:`C_1` and :math:`C_2` [1]


FORM_COEFFICIENTS = {
    "cone": FormCoefficients(1.16, 0.86),
    "sphere": FormCoefficients(1.30, 0.89),
    "rocket": FormCoefficients(1.44, 0.93),
}
"""By the name of the shape."""


def require_air(model: str, gas: AbstractGas) -> None:
    """Raise unless the gas is air, whose published constants a model takes."""
    if not isinstance(gas, AbstractAir):
        raise ParameterError(
            f"force model {model} is not for {gas.name}: its constants are those of air"
        )


def viscosity(temperature: Numeric) -> Array:
    """Viscosity of air by Sutherland's law [Pa s]."""
    ratio = temperature / _REFERENCE
    return (
        _VISCOSITY
        * ratio
        * xp.sqrt(ratio)
        * (_REFERENCE + _SUTHERLAND)
        / (temperature + _SUTHERLAND)
    )


def conductivity(thickness: Numeric, pressure: Numeric, temperature: Numeric) -> Array:
    r"""Conductivity of the air in a wall [W/(m K)]; ``thickness``: of the wall, :math:`L`."""
    # .. math:: k = \frac{0.024}{1 + 3.116\,\lambda/L}
    thermal = xp.sqrt(0.5 * PI * SPEED_CONSTANT * temperature)
    path = viscosity(temperature) / pressure * thermal
    return CONDUCTIVITY / (1.0 + _JUMP * path / thickness)


def poiseuille_coefficient(rarefaction: Numeric) -> Array:
    r"""Coefficient of the flow that a pressure drives through a slot [1]."""
    # .. math:: G_P = (\delta/6 + 1)(1 + 0.25/\sqrt\delta)
    return (rarefaction / 6.0 + 1.0) * (1.0 + 0.25 / xp.sqrt(rarefaction))


def creep_coefficient(rarefaction: Numeric) -> Array:
    r"""Coefficient of the flow that a temperature difference drives through a slot [1]."""
    # .. math:: G_T = \frac{1.1}{1.5 + \delta}
    return 1.1 / (1.5 + rarefaction)
