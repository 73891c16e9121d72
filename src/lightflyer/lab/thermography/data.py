r"""Readings of a thermal camera or a light meter: their files, ranges and accuracy.

A camera shows the apparent temperature: that of a black body with the same radiance

.. math:: B(T) = \int R(\lambda)\,L_\lambda(T)\,d\lambda

in the camera's band, where R is its relative spectral response and :math:`L_\lambda` Planck's
spectral radiance. Radiances add; their fourth roots, and apparent temperatures, do not. :math:`T^4`
in place of B would be right for a camera that sees all wavelengths alike.
"""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Chebyshev

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.constants import STEFAN_BOLTZMANN, ZERO_CELSIUS
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Length, Quantity
from lightflyer.core.units import Measured
from lightflyer.files.quantities import ends
from lightflyer.files.table import Table, read_table
from lightflyer.files.table_layout import Column
from lightflyer.film.optics.spectra import SECOND_RADIATION_CONSTANT, planck

MICROMETRE = 1e-6  # [m]

WAVELENGTHS = (0.7 * MICROMETRE, 1000.0 * MICROMETRE)
"""Wavelengths that the band of a thermal camera may have: infrared [m]."""

_NODES = 12  # Gauss-Legendre, per piece
_WIDEST = 1.15  # longest over shortest wavelength of a piece
_MANY = 2000  # temperatures above which radiances are interpolated
_DEGREE = 64  # of the interpolating polynomial
_TABLES = (".csv", ".txt", ".tsv", ".dat")
_COLUMNS = (
    Column("wavelength", Length, ("lambda", "wl"), required=True, suggested_unit="um"),
    Column("response", Quantity("", 0.0), ("responsivity", "transmission"), required=True,
           any_unit=True),
)  # fmt: skip

EVENLY = 3.0**-0.5
"""Standard deviation of an error evenly distributed between ± one limit, over that limit [1]."""

CAMERA_LIMITS = (2.0, 0.02)
"""Limits of a thermal camera's error as usually specified: 2 K, or 2 % of the reading in °C,
whichever is larger; [ThermalVision]_."""

METER_LIMIT = 0.02
"""Largest error of linearity of a light meter of class B, over the reading [1]; [DIN5032]_."""

BLACK = Measured(1.0, 0.0)  # Emissivity of a black body [1]

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


@dataclass(frozen=True, eq=False)
class CameraBand:
    """Relative spectral response of a thermal camera, linear between the points of a table."""

    wavelength: np.ndarray  # shape (m,); increasing [m]
    response: np.ndarray  # shape (m,); relative response [1]; zero outside the table
    assumed: bool = False  # Whether the band is this package's assumption and not the camera's own
    _nodes: np.ndarray = field(init=False, repr=False)
    _weights: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        wavelength, response = np.asarray(self.wavelength, float), np.asarray(self.response, float)
        if wavelength.ndim != 1 or wavelength.shape != response.shape or wavelength.size < 2:
            raise ParameterError("a camera's band needs two or more wavelengths with a response")
        require_range("wavelength [m] of the camera's band", wavelength, *WAVELENGTHS)
        require_range("response of the camera", response, 0.0)
        if not np.all(np.diff(wavelength) > 0.0):
            raise ParameterError("the wavelengths of a camera's band must increase")
        if not response.any():
            raise ParameterError("the response of the camera is zero everywhere")
        position, weight = np.polynomial.legendre.leggauss(_NODES)
        counts = np.ceil(np.log(wavelength[1:] / wavelength[:-1]) / np.log(_WIDEST)).astype(int)
        pieces = [
            np.geomspace(start, end, count, endpoint=False)
            for start, end, count in zip(wavelength[:-1], wavelength[1:], counts, strict=True)
        ]
        edges = np.concatenate([*pieces, wavelength[-1:]])
        half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
        nodes = (middle[:, None] + half[:, None] * position).ravel()
        weights = (half[:, None] * weight).ravel() * np.interp(nodes, wavelength, response)
        object.__setattr__(self, "_nodes", nodes)
        object.__setattr__(self, "_weights", weights)

    @property
    def name(self) -> str:
        """The band in words, such as ``"7.5 to 14 µm"``."""
        seen = self.wavelength[[0, -1]] / MICROMETRE
        return f"{seen[0]:.4g} to {seen[1]:.4g} µm"

    def radiance(self, temperature: Any) -> np.ndarray:
        """Radiance of a black body within the band, weighted by the response [W/(m² sr)]."""
        kelvin = np.asarray(temperature, float)
        require_positive(temperature=kelvin)
        if kelvin.size <= _MANY or not np.ptp(kelvin):
            return self._integral(kelvin, np.ones_like)
        logarithm = Chebyshev.interpolate(
            lambda inverse: np.log(self._integral(1.0 / inverse, np.ones_like)), _DEGREE,
            (1.0 / kelvin.max(), 1.0 / kelvin.min()),
        )  # fmt: skip
        return np.asarray(np.exp(logarithm(1.0 / kelvin)))

    def slope(self, temperature: Any) -> np.ndarray:
        """Derivative of the radiance by the temperature [W/(m² sr K)]."""
        kelvin = np.asarray(temperature, float)
        require_positive(temperature=kelvin)
        return self._integral(kelvin, lambda x: x / -np.expm1(-x)) / kelvin

    def _integral(self, kelvin: np.ndarray, factor: Any) -> np.ndarray:
        """Integral of response, spectral radiance and a factor of hc/λkT over the wavelength."""
        nodes = self._nodes.reshape(-1, *(1,) * kelvin.ndim)
        each: Any = kelvin
        spectral = planck(nodes, each) * factor(SECOND_RADIATION_CONSTANT / (nodes * kelvin))
        exitance = STEFAN_BOLTZMANN * kelvin**4
        return np.asarray(np.tensordot(self._weights, spectral, 1) * exitance / np.pi)


def flat_band(shortest: float, longest: float, *, assumed: bool = False) -> CameraBand:
    """Band with the same response to all of its wavelengths.

    Parameters
    ----------
    shortest, longest : float
        [m].
    assumed : bool
        Whether the band is an assumption and not the camera's own.

    Returns
    -------
    CameraBand

    Examples
    --------
    >>> print(f"{float(flat_band(7.5e-6, 14e-6).radiance(295.15)):.2f} W/(m² sr)")
    54.91 W/(m² sr)
    """
    return CameraBand(np.array([shortest, longest]), np.ones(2), assumed)


def parse_band(text: str) -> CameraBand | None:
    """Camera's band from the text of an option, perhaps a file; none for ``"total"``."""
    if text.strip().lower() == "total":
        return None
    if Path(text).is_file() or Path(text).suffix in _TABLES:
        numbers = read_table(text, _COLUMNS, strict=True).numbers
        order = np.argsort(numbers["wavelength"])
        try:
            return CameraBand(numbers["wavelength"][order], numbers["response"][order])
        except ParameterError as error:
            raise ConfigurationError(f"{text}: {error}") from None
    found = ends("--band", text, "m")
    if found is None:
        raise ConfigurationError(
            f'--band: "{text}" is not a band; write "7.5-14 um", the file of a spectral response, '
            'or "total"'
        )
    try:
        return flat_band(*found)
    except ParameterError as error:
        raise ConfigurationError(f'--band: "{text}": {error}') from None


UNCOOLED = flat_band(7.5 * MICROMETRE, 14.0 * MICROMETRE, assumed=True)
"""Band assumed where none is stated: 7.5 to 14 µm, as many uncooled cameras have it."""


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
    for unit in _OF_LIGHT if method == LIGHT else (None,):
        try:
            table = read_table(path, columns_of(method, unit), layout=columns)
            break
        except ConfigurationError as error:
            if method != LIGHT or "of the wrong kind" not in str(error):
                raise
    else:
        kinds = ", ".join(unit for unit in _OF_LIGHT if unit)
        raise ConfigurationError(
            f"{path}: a light meter's columns need units of one kind, {kinds}, or none"
        )
    known = dict(given or {})
    if method == LIGHT and "dark" not in table.numbers:
        known.setdefault("dark", Measured(0.0, 0.0))
    for name in method.readings:
        if name not in table.numbers and name not in known:
            raise ConfigurationError(f"{path}: the column {name} is missing")
        if name in table.numbers and name in known:
            table.not_used(f"--{name.removesuffix('_temperature')}", name)
    places = tuple(f"{path}:{line}" for line in table.lines)
    return _complete(method, table.numbers, known, places, accuracy, scene), table


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
    return _complete(method, {}, given, ("",), accuracy, scene)


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


def _complete(
    method: Method, columns: Mapping[str, np.ndarray], given: Mapping[str, Measured],
    places: tuple[str, ...], accuracy: float | None, scene: Scene | None,
) -> Readings:  # fmt: skip
    """Readings of columns, or else as given, with the uncertainties that are not stated.

    Refuses those that are impossible.
    """
    rows, stated = [], []
    for name, quantity in zip(method.readings, method.quantities, strict=True):
        one = given.get(name, Measured(0.0))
        if name in given:
            try:
                quantity.read(one)
            except ConfigurationError as error:
                raise ConfigurationError(f"{name} = {one.value:g} {error}") from None
        rows.append(columns.get(name, np.full(len(places), one.value)))
        column = columns.get(f"{name}_uncertainty")
        stated.append(one.uncertainty if column is None else float(column.max()))
    values = np.stack(rows)
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
