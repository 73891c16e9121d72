r"""What pressure gauges show beside the pressure: of another gas, held warm, and at their ends.

A capacitance gauge held at :math:`T_g` is joined to a chamber at :math:`T_0` by a tube. Gas creeps
in it towards the warmer end until the pressures are

.. math:: \frac{p_g}{p} = \left(\frac{T_g}{T_0}\right)^{\gamma(\delta)}, \qquad
    \delta = \frac{p\,a}{\mu\,v}

with the tube's radius :math:`a`; :math:`\gamma` is one half in thin gas and none in dense
(:func:`lightflyer.force.laws.channels.thermomolecular_exponent`).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lightflyer.calibration.gauge import Gauge, read_gauge
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.force.laws.channels import ROUND, thermomolecular_exponent
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas, mean_free_path

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
