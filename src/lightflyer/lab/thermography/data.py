"""Readings of a thermal camera or a light meter: their files, ranges and accuracy."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.arguments import reads_units
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.files.table import Table, read_table
from lightflyer.files.table_layout import Column
from lightflyer.lab.thermography.camera import UNCOOLED, CameraBand

EVENLY = 3.0**-0.5
"""Standard deviation of an error evenly distributed between ± one limit, over that limit [1]."""

CAMERA_LIMITS = (2.0, 0.02)
"""Limits of a thermal camera's error as usually specified: 2 K, or 2 % of the reading in °C,
whichever is larger; [ThermalVision]_."""

METER_LIMIT = 0.02
"""Largest error of linearity of a light meter of class B, over the reading [1]; [DIN5032]_."""

BLACK = Measured(1.0, 0.0)  # Emissivity of a black body [1]
ZERO_CELSIUS = 273.15  # [K]

_PERCENT = 100.0
_CLEAR = 5.0  # standard uncertainties by which the source must exceed the background
_BEYOND = 0.1  # of that excess, by which noise may take a reading beyond either
_LARGEST = 0.1  # standard uncertainty over the temperature

_SCENE = Quantity("K", 200.0, 2300.0)  # colder or hotter is a wrong unit
_ROOM = Quantity("K", 200.0, 400.0)
_LIGHT, _NEAR_DARK = Quantity("", 0.0), Quantity()  # meters have a zero of their own
_ALIASES = {
    "hotplate_temperature": ("t_hotplate", "hotplate"),
    "lower_temperature": ("t_lower", "lower"),
    "upper_temperature": ("t_upper", "upper"),
    "ambient_temperature": ("t_ambient", "t_inf", "ambient"),
}
_OF_LIGHT = ("", "W/m^2", "W", "V", "A")  # units of what light meters show


class Method(NamedTuple):
    """Kind of reading."""

    # Names of the readings of source, reflection, transmission and background
    readings: tuple[str, str, str, str]
    quantities: tuple[Quantity, Quantity, Quantity, Quantity]  # Unit and possible range of each
    remainder: str  # Name of the part that is neither reflected nor transmitted

    @property
    def unit(self) -> str:
        """Unit of the readings."""
        return self.quantities[0].unit


THERMAL = Method(
    ("hotplate_temperature", "lower_temperature", "upper_temperature", "ambient_temperature"),
    (_SCENE, _SCENE, _SCENE, _ROOM), "emissivity",
)  # fmt: skip
"""Apparent temperatures of a thermal camera."""

LIGHT = Method(
    ("incident", "reflected", "transmitted", "dark"),
    (_LIGHT, _NEAR_DARK, _NEAR_DARK, _NEAR_DARK),
    "absorptivity",
)
"""Readings of a light meter, all in the same unit."""


@dataclass(frozen=True)
class Scene(ShortRepr):
    """What relates a thermal camera's readings to the film."""

    camera: CameraBand | None = UNCOOLED  #: None takes radiation as T⁴, as the paper does
    #: Within the camera's band. One where the hotplate's temperature is apparent; else the
    #: temperature is the hotplate's own, by a thermometer
    hotplate_emissivity: Measured = BLACK
    #: The film's own [K]; None for that of the surroundings
    film_temperature: Measured | None = None

    def __post_init__(self) -> None:
        require_range("hotplate_emissivity", self.hotplate_emissivity.value, 0.0, 1.0,
                      open_below=True)  # fmt: skip
        if self.film_temperature is not None:
            _SCENE.check("film_temperature [K]", self.film_temperature.value)


@dataclass(frozen=True)
class Readings(ShortRepr):
    """Repeated readings of source, reflection, transmission and background."""

    method: Method
    #: shape (4, n); in the order of the method's readings [K], or in the light meter's unit
    values: np.ndarray
    #: shape (4,); standard uncertainties common to all n rows, such as a calibration's, in the same
    #: unit. Errors of different readings are independent
    uncertainties: np.ndarray
    scene: Scene = Scene()  #: For a thermal camera
    places: tuple[str, ...] = ()  #: File and line of each row, if they come from a file
    #: What a reader of the result must know of the readings, one line each
    warnings: tuple[str, ...] = ()


def columns_of(method: Method, unit: str | None = None) -> tuple[Column, ...]:
    """Columns of a table of readings, each with its standard uncertainty; ``unit``: of all."""
    readings = [
        Column(
            name,
            quantity if unit is None else dataclasses.replace(quantity, unit=unit),
            _ALIASES.get(name, ()),
        )
        for name, quantity in zip(method.readings, method.quantities, strict=True)
    ]
    return tuple(column for one in readings for column in (one, one.uncertainty()))


@reads_units
def read_readings(
    path: str | Path,
    method: Method,
    *,
    columns: str | None = None,
    given: Mapping[str, Measured] | None = None,
    accuracy: float | None = None,
    scene: Scene | None = None,
) -> tuple[Readings, Table]:
    """Read a table of readings, one measurement per row.

    Parameters
    ----------
    path : str or path
    method : Method
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.files.table.read_table`.
    given : mapping of str to Measured, optional
        Readings for which the file has no column.
    accuracy : float, optional
        Standard uncertainty of readings that state none [K], or that of a light meter over its
        reading [1]; see :func:`standard_uncertainties`.
    scene : Scene, optional

    Returns
    -------
    readings : Readings
    table : Table

    Raises
    ------
    ConfigurationError
        One line that names file and line or column.
    """
    # a light meter's readings may have any unit, but one of the same kind
    units: tuple[str | None, ...] = _OF_LIGHT if method == LIGHT else (None,)
    table = None
    for unit in units:
        try:
            table = read_table(path, columns_of(method, unit), layout=columns)
            break
        except ConfigurationError as error:
            if method != LIGHT or "of the wrong kind" not in str(error):
                raise
    if table is None:
        kinds = ", ".join(unit for unit in _OF_LIGHT if unit)
        raise ConfigurationError(
            f"{path}: a light meter's columns need units of one kind, {kinds}, or none"
        )
    given = _check(given or {}, method)
    if method == LIGHT and "dark" not in table.numbers:
        given.setdefault("dark", Measured(0.0, 0.0))
    values, stated = [], []
    for name in method.readings:
        if name not in table.numbers and name not in given:
            raise ConfigurationError(f"{path}: the column {name} is missing")
        if name in table.numbers and name in given:
            table.not_used(f"--{name.removesuffix('_temperature')}", name)
        one = given.get(name, Measured(0.0))
        values.append(table.numbers.get(name, np.full(len(table), one.value)))
        stated_column = table.numbers.get(f"{name}_uncertainty")
        stated.append(one.uncertainty if stated_column is None else float(stated_column.max()))
    places = tuple(f"{path}:{line}" for line in table.lines)
    return _complete(method, np.stack(values), stated, accuracy, scene, places), table


def given_readings(
    given: Mapping[str, Measured],
    method: Method,
    *,
    accuracy: float | None = None,
    scene: Scene | None = None,
) -> Readings:
    """Readings from single values.

    Parameters
    ----------
    given : mapping of str to Measured
        By the names of the method's readings.
    method : Method
    accuracy, scene
        As for :func:`read_readings`.

    Returns
    -------
    Readings

    Raises
    ------
    ConfigurationError
        If one is missing or impossible, or the source is not above the background.
    """
    missing = [name for name in method.readings if name not in given]
    if missing:
        options = ", ".join(f"--{name.removesuffix('_temperature')}" for name in missing)
        raise ConfigurationError(f"give a file, or also {options}")
    checked = _check(given, method)
    picked = [checked[name] for name in method.readings]
    values = np.array([[one.value] for one in picked])
    stated = [one.uncertainty for one in picked]
    return _complete(method, values, stated, accuracy, scene, ("",))


def standard_uncertainties(
    method: Method, values: np.ndarray, accuracy: float | None = None
) -> np.ndarray:
    """Standard uncertainty of readings that state none, shape (4, ...); ``values`` (4, ...)."""
    # Source: [ThermalVision]_ for a camera, [DIN5032]_ for a light meter.
    if accuracy is not None:
        require_range("accuracy", accuracy, 0.0, 1.0 if method == LIGHT else np.inf)
    if method == LIGHT:
        return np.abs(values) * (METER_LIMIT * EVENLY if accuracy is None else accuracy)
    if accuracy is not None:
        return np.full(np.shape(values), accuracy)
    least, share = CAMERA_LIMITS
    return np.asarray(EVENLY * np.maximum(least, share * (values - ZERO_CELSIUS)))


def accuracy_warnings(method: Method, accuracy: float | None) -> tuple[str, ...]:
    """What a reader must know of the accuracy of readings that state none."""
    if accuracy is not None:
        return ()
    if method == LIGHT:
        limits = f"limits of {_PERCENT * METER_LIMIT:g} % of the reading"
        return (f"no accuracy of the light meter is stated; {limits} are assumed",)
    least, share = CAMERA_LIMITS
    return (
        f"no accuracy of the camera is stated; limits of {least:g} K or {_PERCENT * share:g} % of "
        "the reading in °C are assumed",
    )


def with_accuracy(
    found: Mapping[str, Measured], accuracy: float | None = None
) -> dict[str, Measured]:
    """Temperatures of an image's regions with the camera's accuracy; with both."""
    return {
        name: Measured(one.value, float(np.hypot(
            one.uncertainty or 0.0,
            float(standard_uncertainties(THERMAL, np.array(one.value), accuracy)),
        )))
        for name, one in found.items()
    }  # fmt: skip


def _check(given: Mapping[str, Measured], method: Method) -> dict[str, Measured]:
    for name, quantity in zip(method.readings, method.quantities, strict=True):
        if name in given:
            try:
                quantity.read(given[name])
            except ConfigurationError as error:
                raise ConfigurationError(f"{name} = {given[name].value:g} {error}") from None
    return dict(given)


def _complete(
    method: Method, values: np.ndarray, stated: list[float | None], accuracy: float | None,
    scene: Scene | None, places: tuple[str, ...],
) -> Readings:  # fmt: skip
    """Readings with the uncertainties that are not stated; refuses those that are impossible."""
    assumed = standard_uncertainties(method, values.mean(axis=1), accuracy)
    known = [one if one is not None else other for one, other in zip(stated, assumed, strict=True)]
    said = accuracy_warnings(method, accuracy) if None in stated else ()
    spread, source, background = np.array(known, float), values[0], values[3]
    for name, mean, one in zip(method.readings, values.mean(axis=1), spread, strict=True):
        if method == THERMAL and one > _LARGEST * mean:
            raise ConfigurationError(
                f"{name}: a standard uncertainty of {one:g} K leaves {mean:.4g} K without meaning"
            )

    def require_order(right: np.ndarray, high: str, low: str) -> None:
        for row in np.flatnonzero(~right):
            place = f"{places[row]}: " if places[row] else ""
            raise ConfigurationError(f"{place}{high} is not above {low}; are columns exchanged?")

    first, _, _, last = method.readings
    require_order(source > background, first, last)
    least = _CLEAR * float(np.hypot(spread[0], spread[3]))
    if source.mean() - background.mean() < least:
        raise ConfigurationError(
            f"{places[0].rpartition(':')[0]}{': ' * bool(places[0])}{first} exceeds {last} by less "
            f"than {_CLEAR:g} standard uncertainties, {least:.3g} {method.unit}".rstrip()
        )
    if method == LIGHT and np.any(background < -_BEYOND * source):
        row = int(np.argmin(background / source))
        raise ConfigurationError(
            f"{places[row]}: {last} = {background[row]:g} is far below zero beside {first} = "
            f"{source[row]:g}; is its sign right?"
        )
    noise = _BEYOND * (source - background)
    for name, one in zip(method.readings[1:3], values[1:3], strict=True):
        require_order(source > one - noise, first, name)
        require_order(one > background - noise, name, last)
    shown = () if places == ("",) else places
    return Readings(method, values, spread, scene or Scene(), shown, warnings=said)
