r"""Accuracies of a heater's instruments: errors that all rows of a run have in common."""

from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, fields

import numpy as np

from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.core.arguments import reads_units
from lightflyer.core.checks import require_range
from lightflyer.core.quantity import Distance, Fraction, Pressure, TemperatureOffset

PIRANI_ACCURACY = 0.05
"""Standard uncertainty of a Pirani gauge, of the reading [1]: its maker's limits, 10 % at
0.05 to 0.1 Pa and 5 % up to 10 kPa, divided by √3 are 5.8 and 2.9 % [LeyboldTTR91]_."""

DRIFT = "plateau_drift"  # Name of the error that runs of one bench do not share

IN_WORDS = {  # name, factor to the unit, unit
    "gauge": ("pressure gauge", 100.0, "%"),
    "gauge_zero": ("gauge's zero", 1.0, "Pa"),
    "power": ("power", 100.0, "%"),
    "temperature": ("temperature difference", 1.0, "K"),
    "diameter": ("diameter", 1000.0, "mm"),
    "plateau": ("plateau", 100.0, "%"),
    DRIFT: ("plateau's drift", 100.0, "%"),
}


@reads_units
@dataclass(frozen=True)
class TacAccuracy:
    r"""Standard uncertainties of what is common to all rows.

    Raises
    ------
    ParameterError
        If one is negative or not finite, or a relative one above 1.
    """

    #: Of the pressure, relative [1]. Default: :data:`PIRANI_ACCURACY`. A capacitance manometer has
    #: 0.0025 to 0.005 [Bioprocess]_
    gauge: Fraction = PIRANI_ACCURACY
    gauge_zero: Pressure = 0.01  #: Of the gauge's zero [Pa]. Default: an assumption
    #: Of the power, relative [1]. Default: an assumption, twice the usual accuracy of a hand-held
    #: multimeter's voltage because the current has an error as well
    power: Fraction = 0.01
    #: Of the difference between the temperatures of heater and gas [K]. Default: an assumption
    temperature: TemperatureOffset = 1.0
    diameter: Distance = 1e-4  #: Of the heater's diameter [m]. Default: an assumption
    #: Of the law's continuum conductance for this set-up, relative [1]: walls, the heater's
    #: thickness, natural convection, the gas's conductivity. Default: an assumption, what walls at
    #: ten radii do
    plateau: Fraction = 0.05
    #: Of the plateau's change from the first row to the last, relative [1]; each run has its own
    plateau_drift: Fraction = 0.0

    def __post_init__(self) -> None:
        for name in ("gauge", "power", "plateau", DRIFT):
            require_range(name, getattr(self, name), 0.0, 1.0)
        require_range("temperature", self.temperature, 0.0, 100.0)
        for name in ("gauge_zero", "diameter"):
            require_range(name, getattr(self, name), 0.0, np.finfo(float).max)

    def to_json(self) -> dict[str, float]:
        """The accuracies with their units in the names."""
        units = {"gauge_zero": "_pa", "temperature": "_k", "diameter": "_m"}
        return {f"{name}{units.get(name, '')}": value for name, value in asdict(self).items()}

    def errors(self, difference: np.ndarray, diameter: float) -> "CommonErrors":
        r"""What one standard error of each does to the rows; ``difference`` (m,)."""
        wider = self.diameter / diameter
        same = np.ones_like(difference)
        late = np.linspace(-0.5, 0.5, difference.size)
        effects = {
            "gauge": (self.gauge, 0.0, 0.0 * same, 0.0 * same),
            "gauge_zero": (0.0, self.gauge_zero, 0.0 * same, 0.0 * same),
            "power": (0.0, 0.0, 0.0 * same, self.power * same),
            "temperature": (0.0, 0.0, 0.0 * same, self.temperature / difference),
            # an area grows with the square; the plateau per area falls with the diameter
            "diameter": (0.0, 0.0, -wider * same, 2.0 * wider * same),
            "plateau": (0.0, 0.0, self.plateau * same, 0.0 * same),
            DRIFT: (0.0, 0.0, self.plateau_drift * late, 0.0 * same),
        }
        kept = {
            field.name: effects[field.name] for field in fields(self) if getattr(self, field.name)
        }
        if not kept:
            return CommonErrors.none(difference.size)
        columns = zip(*kept.values(), strict=True)
        pressure, zero, continuum, amplitude = (np.array(column, float) for column in columns)
        return CommonErrors(tuple(kept), pressure, zero, continuum, amplitude)


def unstated_accuracies(stated: Iterable[str]) -> list[str]:
    """A line that says which accuracies are assumed; none where all are stated."""
    known, usual = set(stated), TacAccuracy()
    missing = {
        said: f"± {scale * getattr(usual, name):g} {unit}"
        for name, (said, scale, unit) in IN_WORDS.items()
        if name not in known and getattr(usual, name)
    }
    return list(assumed_accuracies(missing))


EXACT = TacAccuracy(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Instruments without error: intervals of the scatter alone."""


@dataclass(frozen=True)
class CommonErrors:
    """Effects of errors that all rows have in common, a row per error of one standard error."""

    names: tuple[str, ...]
    log_pressure: np.ndarray  # shape (k,); change of the logarithm of the pressure [1]
    zero: np.ndarray  # shape (k,); change of the pressure [Pa]
    # shape (k, m); change of the logarithm of the continuum conductance [1]
    log_continuum: np.ndarray
    # shape (k, m); change of the logarithm of the measured conductance [1]
    log_conductance: np.ndarray

    @classmethod
    def none(cls, rows: int) -> "CommonErrors":
        """No error in common, of a number of rows."""
        nothing = np.zeros(0)
        return cls((), nothing, nothing, *np.zeros((2, 0, rows)))

    def of_rows(self, change: Callable[[np.ndarray], np.ndarray]) -> "CommonErrors":
        """The same errors of other rows; ``change`` maps effects of shape (k, m)."""
        effects = change(self.log_continuum), change(self.log_conductance)
        return CommonErrors(self.names, self.log_pressure, self.zero, *effects)
