"""Runs of a heater in thin gas, their files, and the accuracies of its instruments."""

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.calibration.gauge import Gauge, end_text, rows_at_the_end
from lightflyer.calibration.inputs import assumed_accuracies
from lightflyer.calibration.points import copies
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import (
    Distance,
    Fraction,
    Pressure,
    Quantity,
    Temperature,
    TemperatureOffset,
)
from lightflyer.files.table import Table, read_table
from lightflyer.files.table_layout import Column

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
_LEAST_DIFFERENCE = 1e-3  # between heater and gas [K]
COLUMNS = (
    Column("pressure", Pressure, ("p", "chamber_pressure"), outside="reject"),
    Column("heater_power", Quantity("W", 0.0, open_below=True), ("power", "p")),
    Column("heater_voltage", Quantity("V", 0.0, open_below=True), ("voltage", "u", "v")),
    Column("heater_current", Quantity("A", 0.0, open_below=True), ("current", "i")),
    Column("heater_temperature", Temperature, ("t_heater", "temperature")),
    Column(
        "ambient_temperature", Temperature, ("t_ambient", "t_gas", "gas_temperature", "ambient")
    ),
)
"""Columns of a run; voltage and current may stand in place of power."""

_CALIBRATION_COLUMNS = (
    Column(
        "resistance", Quantity("ohm", 0.0, open_below=True), ("r", "heater_resistance"),
        required=True,
    ),
    Column("temperature", Temperature, ("t", "heater_temperature"), required=True),
)  # fmt: skip


@reads_units
@dataclass(frozen=True)
class TacAccuracy(ShortRepr):
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

    def errors(
        self, pressure: np.ndarray, difference: np.ndarray, diameter: float
    ) -> dict[str, np.ndarray]:
        """What one standard error of each does to the rows, as a heater's problem has it."""
        wider, same, none = self.diameter / diameter, np.ones_like(difference), 0.0 * difference
        late = np.linspace(-0.5, 0.5, difference.size)
        effects = {
            "gauge": (self.gauge * same, none, none, none),
            "gauge_zero": (none, self.gauge_zero / pressure, none, none),
            "power": (none, none, none, self.power * same),
            "temperature": (none, none, none, self.temperature / difference),
            # an area grows with the square; the plateau per area falls with the diameter
            "diameter": (none, none, -wider * same, 2.0 * wider * same),
            "plateau": (none, none, self.plateau * same, none),
            DRIFT: (none, none, self.plateau_drift * late, none),
        }
        return {name: np.array(one) for name, one in effects.items() if getattr(self, name)}


def unstated_accuracies(stated: Iterable[str], diameter: float | None = None) -> list[str]:
    """A line that says which accuracies are assumed, and the diameter where it is [m]."""
    known, usual = set(stated), TacAccuracy()
    missing = {
        said: f"± {scale * getattr(usual, name):g} {unit}"
        for name, (said, scale, unit) in IN_WORDS.items()
        if name not in known and getattr(usual, name)
    }
    if diameter is not None:
        missing["diameter"] = f"{1000.0 * diameter:g} {missing['diameter']}"
    return list(assumed_accuracies(missing))


EXACT = TacAccuracy(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""Instruments without error: intervals of the scatter alone."""


@dataclass(frozen=True)
class TacRun(ShortRepr):
    """Power of a heater at several pressures."""

    table: Table  #: Table it was read from, with its rejected rows
    pressure: np.ndarray  #: shape (n,); [Pa]
    power: np.ndarray  #: shape (n,); heating power [W]
    #: shape (n,); temperatures of the heater, and of the gas and walls [K]
    heater_temperature: np.ndarray
    ambient_temperature: np.ndarray  #: As ``heater_temperature``
    notes: tuple[str, ...] = ()  #: What was done to the rows, one line each

    def __post_init__(self) -> None:
        columns = self.pressure, self.power, self.heater_temperature, self.ambient_temperature
        if {np.shape(one) for one in columns} != {(len(self.table),)}:
            raise ParameterError(f"{self.source}: its columns are not as long as its table")
        require_positive(pressure=self.pressure, power=self.power)

    @property
    def source(self) -> str:
        """Name of the file."""
        return self.table.source


@dataclass(frozen=True)
class ResistanceThermometer(ShortRepr):
    """Temperature of the heater, linear in its resistance."""

    slope: float  #: [K/ohm]
    intercept: float  #: [K]

    def temperature(self, resistance: np.ndarray) -> np.ndarray:
        """Temperature [K] at a resistance [ohm], shape (n,)."""
        return self.intercept + self.slope * resistance


@reads_units
def read_tac(
    path: str | Path,
    *,
    columns: str | None = None,
    thermometer: ResistanceThermometer | None = None,
    ambient_temperature: Temperature | None = None,
    gauge: Gauge | None = None,
) -> TacRun:
    """Read a run of a heater.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and either ``heater_power`` or ``heater_voltage`` and
        ``heater_current``; ``heater_temperature``, unless a thermometer is given; and
        ``ambient_temperature``, unless it is given. Units stand in the header.
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.files.table.read_table`.
    thermometer : ResistanceThermometer, optional
        Temperature from voltage over current, where the file has no such column.
    ambient_temperature : float, optional
        Temperature of gas and walls, where the file has no such column [K].
    gauge : Gauge, optional
        What the gauge shows of a pressure; by default the pressure itself.

    Returns
    -------
    TacRun

    Raises
    ------
    ConfigurationError
        One line that names file and line or column.
    """
    table = read_table(path, COLUMNS, layout=columns)
    has = set(table.numbers)
    electrical = {"heater_voltage", "heater_current"} <= has
    missing = ""
    if "pressure" not in has:
        missing = "column pressure"
    elif "heater_power" not in has and not electrical:
        missing = "column heater_power, or heater_voltage and heater_current"
    elif "heater_temperature" not in has and not (thermometer and electrical):
        missing = "column heater_temperature, or a calibration of the heater's resistance"
    elif "ambient_temperature" not in has and ambient_temperature is None:
        missing = "column ambient_temperature, or --ambient"
    if missing:
        found = ", ".join([*table.numbers, *table.unused]) or "none"
        raise ConfigurationError(f"{table.source}: needs the {missing}; its columns: {found}")
    for option, given, column in (
        ("--ambient", ambient_temperature, "ambient_temperature"),
        ("--calibration", thermometer, "heater_temperature"),
    ):
        if given is not None and column in has:
            table.not_used(option, column)

    def read(table: Table) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        one = table.numbers
        power = one["heater_power"] if "heater_power" in has else (
            one["heater_voltage"] * one["heater_current"]
        )  # fmt: skip
        heater, gas = one.get("heater_temperature"), one.get("ambient_temperature")
        if heater is None and thermometer is not None:
            heater = thermometer.temperature(one["heater_voltage"] / one["heater_current"])
        return (
            power,
            np.asarray(heater),
            np.full(len(table), ambient_temperature) if gas is None else gas,
        )

    _, heater, gas = read(table)
    table = table.without({
        int(row): f"the heater at {heater[row]:.2f} K is not warmer than the gas at "
        f"{gas[row]:.2f} K"
        for row in np.flatnonzero(heater - gas < _LEAST_DIFFERENCE)
    })  # fmt: skip
    if not len(table):
        raise ConfigurationError(f"{table.rejected[0]}; all rows are rejected")
    power, heater, gas = read(table)
    shown = table.numbers["pressure"]
    ends = np.flatnonzero(rows_at_the_end(shown, power / (heater - gas)))
    table = table.without({int(row): end_text(shown[row]) for row in ends})
    pressure, said = (gauge or Gauge()).correct(table.numbers["pressure"])
    left_out = (
        f"{np.sum(shown[ends] == one)} rows are left out: {end_text(one)}"
        for one in np.unique(shown[ends])
    )
    again = copies(*table.numbers.values())
    return TacRun(table, pressure, *read(table), (*said, *left_out, *again))


@reads_units
def read_resistance_calibration(path: str | Path) -> ResistanceThermometer:
    """Read a calibration of the heater's resistance, and fit a straight line to it.

    Parameters
    ----------
    path : str or path
        Table with the columns ``resistance`` and ``temperature``, two rows or more.

    Returns
    -------
    ResistanceThermometer

    Raises
    ------
    ConfigurationError
        One line that names the file and the fault.
    """
    # strictly: nobody would see which rows of a calibration were left out
    table = read_table(path, _CALIBRATION_COLUMNS, strict=True, preamble=True)
    resistance, temperature = table.numbers["resistance"], table.numbers["temperature"]
    if np.unique(resistance).size < 2:
        raise ConfigurationError(f"{path}: has one resistance; two or more are needed")
    slope, intercept = np.polyfit(resistance, temperature, 1)
    return ResistanceThermometer(float(slope), float(intercept))
