"""What a heater's run holds, and how its files are read."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.table import Table, read_table
from lightflyer.lab.layout import Column

_MILLIKELVIN = 1e-3


def _temperature(name: str, *aliases: str) -> Column:
    return Column(name, "K", aliases, lowest=0.0, open_below=True)


COLUMNS = (
    # a gauge may read below its own zero, which is no reason to doubt the file
    Column("pressure", "Pa", ("p", "chamber_pressure"), 0.0, open_below=True, outside="reject"),
    Column("heater_power", "W", ("power",), 0.0, open_below=True),
    Column("heater_voltage", "V", ("voltage", "u", "v"), 0.0, open_below=True),
    Column("heater_current", "A", ("current", "i"), 0.0, open_below=True),
    _temperature("heater_temperature", "t_heater", "temperature"),
    _temperature("ambient_temperature", "t_ambient", "t_gas", "gas_temperature", "ambient"),
    Column("time", "s", ("t", "elapsed_time"), unit_of_bare="s"),
)  # fmt: skip
"""Columns of a run: reduced, or raw with voltage and current in place of power."""

_CALIBRATION_COLUMNS = (
    Column("resistance", "ohm", ("r", "heater_resistance"), 0.0, open_below=True),
    _temperature("temperature", "t", "heater_temperature"),
)


@dataclass(frozen=True)
class TacRun:
    """A heater's power against pressure, reduced to what the fit needs.

    Attributes
    ----------
    table : Table
        What was read: the lines, and the rows left out.
    pressure : array, shape (n,)
        [Pa].
    power : array, shape (n,)
        Heating power [W].
    heater_temperature, ambient_temperature : array, shape (n,)
        Of the heater and of the gas and walls [K].
    """

    table: Table
    pressure: np.ndarray
    power: np.ndarray
    heater_temperature: np.ndarray
    ambient_temperature: np.ndarray

    @property
    def source(self) -> str:
        """Name of the file."""
        return self.table.source


@dataclass(frozen=True)
class ResistanceThermometer:
    """Temperature of the heater from its resistance, linear in it.

    Attributes
    ----------
    slope : float
        [K/ohm].
    intercept : float
        [K].
    resistance_range : tuple of float
        Range of the calibration [ohm].
    """

    slope: float
    intercept: float
    resistance_range: tuple[float, float]

    def temperature(self, resistance: np.ndarray) -> np.ndarray:
        """Temperature [K] of resistances [ohm], shape (n,)."""
        return self.intercept + self.slope * resistance


def read_tac(
    path: str | Path,
    *,
    columns: str | None = None,
    thermometer: ResistanceThermometer | None = None,
    ambient_temperature: float | None = None,
) -> TacRun:
    """Read a run of a heater.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and either ``heater_power`` or ``heater_voltage`` and
        ``heater_current``; ``heater_temperature``, unless a thermometer is given; and
        ``ambient_temperature``, unless it is given. Units stand in the header.
    columns : str, optional
        The columns in place of a header; see :func:`lightflyer.foundation.table.read_table`.
    thermometer : ResistanceThermometer, optional
        Temperature from voltage over current, where the file has no such column.
    ambient_temperature : float, optional
        Of gas and walls, where the file has no such column [K].

    Returns
    -------
    TacRun

    Raises
    ------
    ConfigurationError
        One line that names file and line or column.
    """
    table = read_table(path, COLUMNS, layout=columns)
    _require_columns(table, thermometer, ambient_temperature)
    table = table.without(_not_heated(table, thermometer, ambient_temperature))
    if not len(table):
        raise ConfigurationError(f"{table.rejected[0]}; no row is left")
    power, heater = _power(table), _heater_temperature(table, thermometer)
    return TacRun(
        table=table,
        pressure=table.numbers["pressure"],
        power=power,
        heater_temperature=heater,
        ambient_temperature=_ambient(table, ambient_temperature),
    )


def _require_columns(
    table: Table, thermometer: ResistanceThermometer | None, ambient: float | None
) -> None:
    has = set(table.numbers)
    electrical = {"heater_voltage", "heater_current"} <= has
    missing = None
    if "pressure" not in has:
        missing = "the column pressure"
    elif "heater_power" not in has and not electrical:
        missing = "the column heater_power, or heater_voltage and heater_current"
    elif "heater_temperature" not in has and not (thermometer and electrical):
        missing = "the column heater_temperature, or a calibration of the heater's resistance"
    elif "ambient_temperature" not in has and ambient is None:
        missing = "the column ambient_temperature, or --ambient"
    if missing:
        found = ", ".join([*table.numbers, *table.unused]) or "none"
        raise ConfigurationError(f"{table.source}: needs {missing}; its columns: {found}")


def _power(table: Table) -> np.ndarray:
    if "heater_power" in table.numbers:
        return table.numbers["heater_power"]
    return table.numbers["heater_voltage"] * table.numbers["heater_current"]


def _heater_temperature(table: Table, thermometer: ResistanceThermometer | None) -> np.ndarray:
    if "heater_temperature" in table.numbers:
        return table.numbers["heater_temperature"]
    assert thermometer is not None  # _require_columns saw to it
    return thermometer.temperature(
        table.numbers["heater_voltage"] / table.numbers["heater_current"]
    )


def _ambient(table: Table, given: float | None) -> np.ndarray:
    if "ambient_temperature" in table.numbers:
        return table.numbers["ambient_temperature"]
    assert given is not None  # _require_columns saw to it
    return np.full(len(table), given)


def _not_heated(
    table: Table, thermometer: ResistanceThermometer | None, ambient: float | None
) -> dict[int, str]:
    heater, gas = _heater_temperature(table, thermometer), _ambient(table, ambient)
    rows = np.flatnonzero(heater - gas < _MILLIKELVIN)
    return {
        int(row): f"the heater at {heater[row]:.2f} K is not warmer than the gas at "
        f"{gas[row]:.2f} K"
        for row in rows
    }


def read_resistance_calibration(path: str | Path) -> ResistanceThermometer:
    """Straight line through measured resistances and temperatures.

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
        One line that names the file and what is wrong.
    """
    table = read_table(path, _CALIBRATION_COLUMNS)
    for name in ("resistance", "temperature"):
        if name not in table.numbers:
            raise ConfigurationError(f"{path}: the column {name} is missing")
    resistance, temperature = table.numbers["resistance"], table.numbers["temperature"]
    if np.unique(resistance).size < 2:
        raise ConfigurationError(f"{path}: needs two or more different resistances")
    slope, intercept = np.polyfit(resistance, temperature, 1)
    return ResistanceThermometer(
        float(slope), float(intercept), (float(resistance.min()), float(resistance.max()))
    )
