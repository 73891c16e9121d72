"""Options of measurements: how their texts become numbers, and those that several have.

Nothing here takes long to import: the help of a command waits for it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from lightflyer.files.quantities import difference, exact, known, quantity, share

if TYPE_CHECKING:
    from lightflyer.calibration.gauge import Gauge
    from lightflyer.gas.base import AbstractGas

Face = Literal["top", "bottom", "both"]  # of a film, that a number is written for

# Texts of numbers with their units: the function gets the number in SI units
Metres: TypeAlias = Annotated[Any, partial(exact, unit="m")]
Kelvins: TypeAlias = Annotated[Any, partial(exact, unit="K")]
KelvinsApart: TypeAlias = Annotated[Any, partial(difference, unit="K")]
Pascals: TypeAlias = Annotated[Any, partial(exact, unit="Pa")]
WattsPerArea: TypeAlias = Annotated[Any, partial(exact, unit="W/m^2")]
Number: TypeAlias = Annotated[Any, partial(exact, unit="")]
Share: TypeAlias = Annotated[Any, share]
# The same with its ±, as :class:`~lightflyer.core.units.Measured`; known ones exceed it
MeasuredKelvins: TypeAlias = Annotated[Any, partial(quantity, unit="K")]
KnownMetres: TypeAlias = Annotated[Any, partial(known, unit="m")]
KnownNumber: TypeAlias = Annotated[Any, partial(known, unit="")]


def measurement(**needs: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Have a measurement's command refuse options that do nothing without another, by name."""

    def needing(function: Callable[..., Any]) -> Callable[..., Any]:
        function.needs = needs  # type: ignore[attr-defined]
        return function

    return needing


@dataclass(frozen=True)
class GaugeOptions:
    """The pressure gauge of a measurement.

    Parameters
    ----------
    gauge
        Calibration of the pressure gauge: a table with the columns shown and pressure.
    gauge_factor
        Pressure over what the gauge shows of it, because of the gas, such as 1.7 for a Pirani gauge
        in argon.
    gauge_temperature
        Temperature at which the gauge is held, such as "45 °C", where it is not that of the
        chamber; with --gauge-tube.
    gauge_tube
        Inner diameter of the tube to that gauge, such as "5 mm".
    """

    gauge: Path | None = None
    gauge_factor: float = 1.0
    gauge_temperature: str | None = None
    gauge_tube: str | None = None

    def build(self, gas: "AbstractGas", ambient: float | None) -> "Gauge":
        """The gauge in a gas at a temperature [K], by default that of a room."""
        from lightflyer.calibration.gauge import gauge_of

        warm, tube = self.gauge_temperature, self.gauge_tube
        return gauge_of(
            self.gauge, self.gauge_factor,
            None if warm is None else exact("--gauge-temperature", warm, "K"),
            None if tube is None else exact("--gauge-tube", tube, "m"),
            gas=gas, ambient=ambient,
        )  # fmt: skip


AS_SHOWN = GaugeOptions()  # A gauge that shows the pressure
