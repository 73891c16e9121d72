"""Gases by the name they have in a flyer file."""

from lightflyer.gas.air import AIR, LU2023_AIR, US1976_AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE, FROZEN_CARBON_DIOXIDE
from lightflyer.gas.pure import PURE_GASES

AIRS: dict[str, AbstractGas] = {gas.name: gas for gas in (AIR, US1976_AIR, LU2023_AIR)}
"""Those of the Earth."""

CARBON_DIOXIDES: dict[str, AbstractGas] = {
    gas.name: gas for gas in (CARBON_DIOXIDE, FROZEN_CARBON_DIOXIDE)
}
"""Those of Mars."""

GASES: dict[str, AbstractGas] = {
    **AIRS,
    **{gas.name: gas for gas in PURE_GASES},
    **CARBON_DIOXIDES,
}
"""All, as a chamber may hold them; a plug-in adds its own."""
