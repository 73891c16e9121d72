r"""What instruments show: the pressure by a gauge, and light raised in steps until lift-off.

A capacitance gauge held at :math:`T_g` is joined to a chamber at :math:`T_0` by a tube. Gas creeps
in it towards the warmer end until the pressures are

.. math:: \frac{p_g}{p} = \left(\frac{T_g}{T_0}\right)^{\gamma(\delta)}, \qquad
    \delta = \frac{p\,a}{\mu\,v}

with the tube's radius :math:`a`; :math:`\gamma` is one half in thin gas and none in dense
(:func:`lightflyer.force.laws.channels.thermomolecular_exponent`).

The irradiance noted is the first one with levitation. The one that suffices lies anywhere between
it and the step before, so on average half a step lower.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, Doubt, ParameterError
from lightflyer.core.quantity import Pressure, Quantity
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.force.laws.channels import ROUND, thermomolecular_exponent
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas, mean_free_path

_POSSIBLE = Quantity("", 0.0, open_below=True, sizes=(0.02, 50.0), why="no gauge is farther off")
_FACTOR = replace(
    _POSSIBLE, likely=(0.1, 10.0), known="gauges in other gases show 0.1 to 6 of the pressure"
)
_RATIO = replace(_POSSIBLE, likely=(0.3, 3.0), known="calibrations move a gauge by less")
_COLUMNS = (
    Column("shown", Pressure, ("reading", "indicated", "gauge", "display"), required=True),
    Column("pressure", Pressure, ("p", "true", "reference"), required=True),
)

CENTRE = 0.5  # Distance of the middle of a step from its upper end, in steps

UNIFORM_SPREAD = 1.0 / math.sqrt(12.0)
"""Standard deviation of a number that may lie anywhere within a step, in steps."""

NOTICED = 0.01  # Step, over the least irradiance, from which :func:`found_step` looks for one

_OFF = 0.02  # distance from the nearest step up to which a value lies on it, in steps
_LEAST_VALUES = 3  # different values that show steps
_MOST_PARTS = 5  # of the least difference of two values that are tried as a step
_MOST_CHANCE = 1e-3  # probability that values without steps would lie so

ROOM = 295.0  # Temperature of a chamber that states none [K]; our assumption

PIRANI_FACTORS = {"argon": 1.7, "helium": 0.8}
"""Pressure over what a Pirani gauge set to air shows, below 100 Pa; [InficonBCG450]_. Nitrogen and
oxygen have 1."""

GAUGE_TEMPERATURES = (230.0, 600.0)  # Possible temperatures of a gauge [K]
GAUGE_TUBES = (1e-4, 0.2)  # Possible diameters of its tube [m]

_LEAST_ROWS = 3  # at one pressure, that may be the gauge's end
_NEAREST = 8  # other rows, by which those are judged
_FAR = 5.0  # times the scatter of these, that rows at one pressure differ
_CLOSE = 0.3  # of log-pressure: other rows whose curve may be drawn on to the end
_LEAST_SCATTER = 0.002  # relative


@dataclass(frozen=True)
class Gauge(ShortRepr):
    """A gauge's factor for the gas, and its calibration."""

    #: Pressure over what the gauge shows of it, as of thermal gauges in another gas than the one
    #: they are set to [1]
    factor: float = 1.0
    shown: np.ndarray | None = None  #: shape (n,); increasing [Pa]; None for no calibration
    pressure: np.ndarray | None = None  #: shape (n,); what it was then [Pa]
    source: str = ""  #: File of the calibration

    def __post_init__(self) -> None:
        one = np.asarray(self.factor)
        whole = (self.shown is None) is (self.pressure is None)
        if one.ndim or one.dtype.kind not in "iuf" or not whole:
            raise ParameterError("a gauge has one factor, and both shown and pressure or neither")
        _FACTOR.check("gauge_factor", self.factor)
        if self.shown is not None and self.pressure is not None:
            _RATIO.check(f"{self.source}: pressure over shown", self.pressure / self.shown)

    def correct(self, shown: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """Pressures for what is shown, shape (m,) [Pa], and what must be known of them."""
        doubts = [_FACTOR.unlikely(self.factor)]
        if self.shown is None or self.pressure is None:
            return self.factor * shown, [
                Doubt(f"pressure over shown = {one}") for one in doubts if one
            ]
        # straight in logarithms; beyond the ends the ratio is that of the end
        ratio = np.interp(np.log(shown), np.log(self.shown), np.log(self.pressure / self.shown))
        beyond = int(np.sum((shown < self.shown[0]) | (shown > self.shown[-1])))
        if beyond == shown.size:
            raise ConfigurationError(
                f"{self.source}: no pressure that the gauge showed, {shown.min():.3g} to "
                f"{shown.max():.3g} Pa, is within its calibration; check the units"
            )
        doubts.append(_RATIO.unlikely(self.pressure / self.shown))
        said: list[str] = [
            Doubt(f"{self.source}: pressure over shown = {one}") for one in doubts if one
        ]
        said += [
            f"{beyond} pressure{'s are' if beyond > 1 else ' is'} beyond the gauge's calibration, "
            f"{self.source}, {self.shown[0]:.3g} to {self.shown[-1]:.3g} Pa; its end holds there"
        ] * bool(beyond)
        return self.factor * shown * np.exp(ratio), said


@reads_units
def read_gauge(path: str | Path | None, factor: float = 1.0) -> Gauge:
    """Read the calibration of a gauge: a table of what it showed and what the pressure was.

    Parameters
    ----------
    path : str or path, optional
        Table with the columns ``shown`` and ``pressure``, two rows or more.
    factor : float
        Pressure over what the gauge shows of it, because of the gas [1].

    Returns
    -------
    Gauge

    Raises
    ------
    ConfigurationError
        One line that names the file and the fault.
    """
    if path is None:
        return Gauge(factor)
    table = read_table(path, _COLUMNS, strict=True, preamble=True)
    order = np.argsort(table.numbers["shown"])
    shown, pressure = (table.numbers[name][order] for name in ("shown", "pressure"))
    if len(shown) < 2 or np.any(np.diff(shown) <= 0.0) or np.any(np.diff(pressure) <= 0.0):
        raise ConfigurationError(
            f"{path}: pressure must rise with what the gauge shows, over two rows or more"
        )
    return Gauge(factor, shown, pressure, str(path))


def require_step(step: float, irradiance: np.ndarray, place: str = "") -> None:
    """Raise :class:`ParameterError` unless a step of the light is possible; ``irradiance`` (n,)."""
    start = f"{place}: " if place else ""
    if not 0.0 <= step < math.inf:
        raise ParameterError(f"{start}step = {step:g} W/m^2 is not zero or positive")
    if step >= np.min(irradiance):
        raise ParameterError(
            f"{start}step = {step:g} W/m^2 is not smaller than the least irradiance, "
            f"{np.min(irradiance):g} W/m^2"
        )


def found_step(irradiance: np.ndarray) -> float | None:
    """Step of the light that measured irradiances show, if any.

    Parameters
    ----------
    irradiance : array, shape (n,)
        [W/m²].

    Returns
    -------
    float or None
        The largest step on whose multiples all values lie [W/m²]; None where there is none of at
        least :data:`NOTICED` times the least irradiance, or where it may be chance.

    Examples
    --------
    >>> found_step(np.array([1000.0, 1200.0, 1800.0, 2600.0, 1000.0]))
    200.0
    """
    values = np.unique(irradiance)
    if values.size < _LEAST_VALUES:
        return None
    differences = np.diff(values)
    # the step is chosen by one difference; each other point could lie anywhere
    chance = _MOST_PARTS * (2.0 * _OFF) ** (np.size(irradiance) - 2)
    if chance > _MOST_CHANCE:
        return None
    for parts in range(1, _MOST_PARTS + 1):
        step = float(differences.min()) / parts
        if step < NOTICED * values[0]:
            return None
        counts = np.round(differences / step)
        off = np.abs(differences - counts * step)
        if np.all(off <= _OFF * step):
            return float(f"{differences.sum() / counts.sum():.6g}")
    return None


@dataclass(frozen=True)
class HeatedGauge(Gauge):
    """A gauge held at a temperature of its own, at the end of a tube."""

    temperature: float = ROOM  #: Of the gauge [K]
    tube: float = 1.0  #: Diameter of the tube [m]
    gas: AbstractGas = AIR
    ambient: float = ROOM  #: Temperature of the chamber [K]

    def correct(self, shown: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """Pressures in the chamber for what is shown, shape (m,) [Pa], and what must be known."""
        inside, said = super().correct(shown)
        middle = 0.5 * (self.temperature + self.ambient)
        path = np.asarray(mean_free_path(np.asarray(inside, float), middle, self.gas))
        rarefaction = 0.25 * np.sqrt(np.pi) * self.tube / path
        exponent = np.asarray(thermomolecular_exponent(ROUND, rarefaction))
        ratio = (self.temperature / self.ambient) ** exponent  # of inside to chamber
        ends = sorted({f"{100.0 * (one - 1.0):.2g} %" for one in (ratio.min(), ratio.max())})
        return inside / ratio, [
            *said,
            f"the gauge at {self.temperature:.4g} K showed {' to '.join(ends)} more than the "
            f"pressure in the chamber at {self.ambient:.4g} K, which is corrected",
        ]


def gauge_of(
    calibration: str | Path | None,
    factor: float,
    temperature: float | None,
    tube: float | None,
    *,
    gas: AbstractGas = AIR,
    ambient: float | None = None,
) -> Gauge:
    """The gauge that a command's options describe; temperatures [K], ``tube``: diameter [m]."""
    plain = read_gauge(calibration, factor)
    if temperature is None and tube is None:
        return plain
    if temperature is None or tube is None:
        raise ConfigurationError(
            "--gauge-temperature and --gauge-tube go together: how warm the gauge is, such as "
            '"45 °C", and how wide the tube to it, such as "5 mm"'
        )
    require_range("--gauge-temperature [K]", temperature, *GAUGE_TEMPERATURES)
    require_range("--gauge-tube [m]", tube, *GAUGE_TUBES)
    return HeatedGauge(
        plain.factor, plain.shown, plain.pressure, plain.source, temperature, tube, gas,
        ROOM if ambient is None else ambient,
    )  # fmt: skip


def pirani_doubts(gas: str, gauge: Gauge, *, accuracy_stated: bool) -> list[Doubt]:
    """A line where a gauge that is taken for a Pirani gauge is in a gas it is not set to."""
    factor = PIRANI_FACTORS.get(gas)
    stated = gauge.factor != 1.0 or gauge.shown is not None or accuracy_stated
    if factor is None or stated:
        return []
    return [
        Doubt(
            f"the gauge is taken for a Pirani gauge, which is set to air: in {gas} the pressure "
            f"is {factor:g} times what it shows; state --gauge-factor {factor:g}, or "
            "--gauge-accuracy of a gauge that shows all gases alike"
        )
    ]


def rows_at_the_end(pressure: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Rows whose gauge was at an end of its range: bool array, shape (n,); as shown [Pa]."""
    # There the gauge shows one pressure, and what is measured goes on to change: the rows differ
    # from each other or, where it levels off again, from what rows close by lead to. Repeats at a
    # pressure that was held do neither.
    found = np.zeros(len(pressure), bool)
    for end in (pressure.min(), pressure.max()):
        here = pressure == end
        near = np.flatnonzero(~here)
        near = near[np.argsort(np.abs(np.log(pressure[near] / end)), kind="stable")][:_NEAREST]
        if here.sum() < _LEAST_ROWS or len(near) < _NEAREST:
            continue
        x, y = np.log(pressure[near]), np.log(value[near])
        degree = min(2, np.unique(x).size - 1)
        curve = np.polynomial.Polynomial.fit(x, y, degree)
        scatter = np.sqrt(np.sum((y - curve(x)) ** 2) / (_NEAREST - degree - 1))
        limit = _FAR * max(scatter, _LEAST_SCATTER)
        beyond = np.log(value[here]) - curve(np.log(end))
        off = abs(beyond.mean()) > limit and np.abs(x - np.log(end)).min() < _CLOSE
        found |= here & bool(off or beyond.std(ddof=1) > limit)
    return found


def end_text(pressure: float) -> str:
    """Why a row at the end of its gauge is left out; ``pressure``: as shown [Pa]."""
    return f"the gauge is at the end of its range, {pressure:.4g} Pa: the pressure is beyond it"
