"""Gases by the name they have in a flyer file."""

from lightflyer.gas.air import AIR, LU2023_AIR, US1976_AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.gas.carbon_dioxide import CARBON_DIOXIDE, FROZEN_CARBON_DIOXIDE

GASES: dict[str, AbstractGas] = {
    gas.name: gas for gas in (AIR, US1976_AIR, LU2023_AIR, CARBON_DIOXIDE, FROZEN_CARBON_DIOXIDE)
}
"""Gases by the name they have in a flyer file."""
