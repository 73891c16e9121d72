"""Synthetic measurements in thin gas: forces on a vane, levitation points, a heater's runs.

Force and heat loss are those of the kinetic force model. The heater's gauge and power meter are off
by what such instruments are.
"""

from typing import NamedTuple

import numpy as np

from lightflyer.core.constants import ZERO_CELSIUS
from lightflyer.core.units import Measured
from lightflyer.environment.chamber import Chamber
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.disk import Disk
from lightflyer.force.kinetic.model import Kinetic
from lightflyer.force.lu2023 import Lu2023
from lightflyer.lab.force import Vane
from lightflyer.lab.synthetic import TORR, cells, faulty_table, label
from lightflyer.lab.tac.preparation import LU2023_HEATER_DIAMETER
from lightflyer.statics.levitation import levitate

TRUE_VANE = Vane(
    Measured(0.12),
    Measured(419.0),
    Measured(394.0),
    tac_hot=Measured(0.85),
    tac_cold=Measured(0.85),
)
_VANE_PRESSURES, _VANE_POINTS, _VANE_NOISE = (0.01, 5.0), 14, 0.03  # [Pa]; relative

_EMITTANCES = {"Ge 2 cm": 0.08, "CNT 2 cm": 0.48}  # of the paper's samples
_PRESSURES = (1.2, 40.0)  # [Pa]
_POINTS = 28  # of each sample
_NOISE = 0.05  # relative

_AMBIENT, _HEATER = 295.0, 323.0  # [K]
_RUN_PRESSURES = (1e-4, 200.0)  # [Pa]
_RESISTANCE, _PER_KELVIN, _AT = 10.0, 3.85e-3, 295.0  # of the heater [ohm], [1/K], [K]
_RELATIVE_NOISE = 0.01  # of the power
_GAUGE_ERROR, _POWER_ERROR = 0.03, -0.005  # relative, of all rows
_TEMPERATURE_NOISE = 0.05  # [K]
_WARM_UP = (-9.0, -4.0, -1.6)  # offsets of the first rows, while the heater warms up [K]


def force_files(seed: int = 0) -> dict[str, str]:
    """Forces over pressure; text by file name."""
    rng = np.random.default_rng(seed)
    pressure = np.geomspace(*_VANE_PRESSURES, _VANE_POINTS)
    force = TRUE_VANE.force(pressure) * (1.0 + _VANE_NOISE * rng.normal(size=_VANE_POINTS))
    rows = cells(".4g .4g .2g", pressure, 1e6 * force, 1e6 * _VANE_NOISE * force)
    lines = label("force", "truth: vane of 12 cm at 419 K and 394 K in argon at 295 K, TAC 0.85")
    header = ["pressure [Pa]", "force [uN]", "force_uncertainty [uN]"]
    return {"vane.csv": faulty_table(lines, header, rows, rng)}


def lift_off_irradiance(pressure: np.ndarray, sample: str) -> np.ndarray:
    """True irradiance at which a synthetic sample lifts off [W/m²], shape (n,)."""
    emittance = _EMITTANCES[sample]
    film = FilmProperties(1e-3, 0.75, emittance, emittance, tac_top=0.8, tac_bottom=0.9)
    return levitate(Disk(film=film, radius=0.01), Chamber().state(pressure), Lu2023()).irradiance


def levitation_files(seed: int = 0) -> dict[str, str]:
    """Points of two samples, and points of one sample on two launchpads; text by file name."""
    rng = np.random.default_rng(seed)
    fine = np.geomspace(*_PRESSURES, 2000)
    least = {name: lift_off_irradiance(fine, name) for name in _EMITTANCES}
    truth = "truth: " + "; ".join(
        f"{name} {light.min():.1f} W/m^2 at {fine[light.argmin()]:.3f} Pa"
        for name, light in least.items()
    )
    lines = label("levitation", truth)
    rows = [
        [name, str(_EMITTANCES[name]), f"{p / TORR * 1e3:.4g}", f"{light / 1e3:.5g}"]
        for name in _EMITTANCES
        for p, light in _points(rng, name)
    ]
    header = ["sample", "emittance", "pressure [mTorr]", "irradiance [kW/m^2]"]
    pads = [
        ["Ge 2 cm", pad, "20", str(gap), f"{p:.4g}", f"{share * light:.5g}"]
        for pad, gap, share in (("mesh", 60, 1.0), ("plate", 5, 0.9))
        for p, light in _points(rng, "Ge 2 cm")
    ]
    pad_header = ["Sample", "Launchpad", "Diameter (mm)", "Floor gap (mm)", "Pressure (Pa)",
                  "Irradiance (W/m2)"]  # fmt: skip
    return {
        "levitation.csv": faulty_table(lines, header, rows, rng, shuffled=True),
        "launchpads.csv": faulty_table(
            [*lines, "# the floor is close to the plate: 10 % less light"], pad_header, pads, rng,
            delimiter=";", decimal_comma=True,
        ),
    }  # fmt: skip


def _points(rng: np.random.Generator, name: str) -> list[tuple[float, float]]:
    low, high = np.log(_PRESSURES)
    pressure = np.exp(np.sort(rng.uniform(low, high, _POINTS)))
    light = lift_off_irradiance(pressure, name) * np.exp(_NOISE * rng.normal(size=_POINTS))
    return list(zip(pressure.tolist(), light.tolist(), strict=True))


class TacTruth(NamedTuple):
    """Parameters of a synthetic run."""

    tac: float = 0.75
    area_ratio: float = 1.22
    offset: float = 4.09


PLATINUM = TacTruth()  # Fit of the paper to platinum
OTHER_FACE = TacTruth(tac=0.88, area_ratio=1.18, offset=4.6)  # of a sample with platinum on top


def tac_files(seed: int = 0, truth: TacTruth = PLATINUM) -> dict[str, str]:
    """A raw and a reduced run, the calibration of the heater's resistance, and another face."""
    rng = np.random.default_rng(seed)
    lines, of_other = (
        label("tac", f"truth: tac {one.tac}, area_ratio {one.area_ratio}, offset {one.offset} "
              f"W/(m^2 K), heater 24 mm; gauge reads {_GAUGE_ERROR:+.1%}, power meter "
              f"{_POWER_ERROR:+.1%}")
        for one in (truth, OTHER_FACE)
    )  # fmt: skip
    pressure, power, heater, ambient = _run(rng, truth, 80)
    resistance = _RESISTANCE * (1.0 + _PER_KELVIN * (heater - _AT))
    current = np.sqrt(power / resistance)
    rows = cells(
        ".1f .5g .6f .5f .3f", 10.0 * np.arange(80), pressure / TORR * 1e3, current * resistance,
        current * 1e3, ambient - ZERO_CELSIUS,
    )  # fmt: skip
    header = ["time [s]", "pressure [mTorr]", "heater_voltage [V]", "heater_current [mA]",
              "ambient_temperature [°C]"]  # fmt: skip
    celsius = np.array([20.0, 30.0, 40.0, 50.0, 60.0])
    ohms = _RESISTANCE * (1.0 + _PER_KELVIN * (celsius + ZERO_CELSIUS - _AT))
    calibration = [",".join(row) for row in cells(".1f .5f", celsius, ohms)]
    head = [*lines, "temperature [°C],resistance [ohm]"]
    return {
        "tac-raw.csv": faulty_table(lines, header, rows, rng),
        "tac-reduced.txt": _reduce(rng, truth, lines),
        "tac-resistance.csv": "\n".join([*head, *calibration]) + "\n",
        "tac-top.txt": _reduce(rng, truth, lines),
        "tac-bottom.txt": _reduce(rng, OTHER_FACE, of_other),
    }


def _run(
    rng: np.random.Generator, truth: TacTruth, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Pressure, power, heater and ambient temperature, as read in a run with rising pressure."""
    pressure = np.geomspace(*_RUN_PRESSURES, count)
    heater = np.full(count, _HEATER)
    heater[: len(_WARM_UP)] += _WARM_UP
    ambient = _AMBIENT + 0.3 * np.linspace(0.0, 1.0, count)  # the laboratory warms up
    power = _power(pressure, heater, ambient, truth)
    power = power * (1.0 + _POWER_ERROR) * (1.0 + _RELATIVE_NOISE * rng.normal(size=count))
    heater = heater + _TEMPERATURE_NOISE * rng.normal(size=count)
    return pressure * (1.0 + _GAUGE_ERROR), power, heater, ambient


def _power(
    pressure: np.ndarray, heater: np.ndarray, ambient: np.ndarray, truth: TacTruth
) -> np.ndarray:
    """Power that the gas and the leads take from the heater [W]."""
    # what the kinetic model does not use of a film is set to anything possible
    film = FilmProperties(1.0, 0.5, 0.5, 0.5, truth.tac, truth.tac)
    disk = Disk(film, 0.5 * LU2023_HEATER_DIAMETER)
    difference = heater - ambient
    state = Chamber(temperature=ambient).state(pressure)
    (lost,) = Kinetic(wall="maxwell").heat_loss(disk, state, (difference / ambient,))
    area = 0.25 * np.pi * LU2023_HEATER_DIAMETER**2
    return np.asarray(truth.area_ratio * (np.asarray(lost) + truth.offset * area * difference))


def _reduce(rng: np.random.Generator, truth: TacTruth, lines: list[str]) -> str:
    pressure, power, heater, ambient = _run(rng, truth, 60)
    rows = cells(
        ".5g .5f .3f .3f", pressure, power * 1e3, heater - ZERO_CELSIUS, ambient - ZERO_CELSIUS
    )
    header = ["Pressure (Pa)", "Heater Power (mW)", "Heater Temperature (°C)",
              "Ambient Temperature (°C)"]  # fmt: skip
    return faulty_table(lines, header, rows, rng, delimiter=";", decimal_comma=True, shuffled=True)
