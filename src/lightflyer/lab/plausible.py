"""What numbers of a laboratory are likely: one beyond is most likely of a wrong unit or column."""

import numpy as np

from lightflyer.core.quantity import Quantity
from lightflyer.lab.record import Doubt

LABORATORY = Quantity(
    "K", likely=(280.0, 315.0), known="chambers stand in laboratories, unless they are cooled"
)
"""Temperature of the surroundings."""

EMISSIVITY = Quantity(
    likely=(5e-3, 0.98), known="polished gold has 0.02, black paint and skin have 0.95 to 0.98"
)
"""Emissivity of a film in the infrared."""

ABSORPTANCE = Quantity(
    likely=(1e-3, 0.99), known="black paint absorbs 0.97, all but forests of nanotubes less"
)
"""Absorptance of a film for visible light."""

AREA_RATIO = Quantity(likely=(0.5, 2.0), known="films cover a heater and not much else")
"""Effective over nominal area of a heater; [Lu2023]_ has 1.22."""

_NOT_LOGGED = 273.15  # [K]: what loggers write of an input that nothing is connected to


def doubts_of(name: str, quantity: Quantity, value: float, hint: str = "") -> list[Doubt]:
    """A line where a value is not likely; ``hint``: what may be the reason."""
    why = quantity.unlikely(value)
    return [Doubt(f"{name} {why}{'; ' * bool(hint)}{hint}")] if why else []


def ambient_doubts(temperature: np.ndarray) -> list[Doubt]:
    """A line about surroundings colder or warmer than a laboratory; ``temperature`` (n,) [K]."""
    middle = float(np.median(temperature))
    unlogged = abs(middle - _NOT_LOGGED) < 1e-6
    hint = "0 °C is what loggers write where no sensor is connected" if unlogged else ""
    return doubts_of("ambient_temperature", LABORATORY, middle, hint)
