"""``lightflyer calibrate``: points made with the paper's equations in plain NumPy.

The true sample is the same in all cases. Either its numbers are given exactly, or they were
measured with errors drawn from their ±, as were the gauge and the meter calibrated, so that each
case has other inputs. Cases in which the inputs would have the sample pushed down are left out:
``calibrate`` refuses them.
"""

import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from trial import Trial

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import numpy_model

import lightflyer as lf

COMMAND = "calibrate"

TRUTH = {"c_fm": 0.4, "c_cont": 3.0}  # of the plain NumPy model
SAMPLE = {
    "areal_density": (1e-3, 3e-5),
    "absorptance": (0.75, 0.02),
    "emittance": (0.08, 0.01),
    "tac_top": (0.8, 0.03),
    "tac_bottom": (0.9, 0.03),
}  # truth and standard uncertainty
RADIUS, CHAMBER = 0.01, 293.0
GAUGE = METER = 0.05  # relative
SCATTER = {"pressure": 0.02, "irradiance": 0.03}  # relative, of each point
HOTTEST = 2000.0
FILE = """\
[flyer]
shape = "disk"
diameter = "2 cm"
[film]
areal_density = "1.0 g/m^2"
absorptance = 0.75
emittance = 0.08
tac_top = 0.8
tac_bottom = 0.9
[environment]
kind = "chamber"
temperature = "293 K"
irradiance = "1500 W/m^2"
gas = "lu2023-air"
gravity = "9.8 m/s^2"
[force]
model = "lu2023"
"""


@cache
def design():
    """Flyer file of the sample, read once."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "flyer.toml"
        path.write_text(FILE, encoding="utf-8")
        return lf.read_flyer_file(path).design()


def lift_off(pressure):
    """Irradiance at which the true sample levitates, by bisection of its temperature [W/m²]."""
    truth = {name: value for name, (value, _) in SAMPLE.items()}
    tacs = truth["tac_top"], truth["tac_bottom"]
    area = np.pi * RADIUS**2
    weight = truth["areal_density"] * area * numpy_model.GRAVITY
    low, high = np.full(pressure.shape, CHAMBER + 1e-9), np.full(pressure.shape, HOTTEST)
    for _ in range(60):
        hot = 0.5 * (low + high)
        lifted = numpy_model.force(hot, CHAMBER, pressure, RADIUS, *tacs) > weight
        low, high = np.where(lifted, low, hot), np.where(lifted, hot, high)
    tac_mean = 0.5 * sum(tacs)
    power = numpy_model.lost_power(high, CHAMBER, pressure, RADIUS, tac_mean, truth["emittance"])
    return power / (truth["absorptance"] * area)


def points_of(rng, count, span, *, exact_inputs, stated):
    """Points as they would be noted, with the numbers of the sample as they were measured."""
    pressure = np.geomspace(*span, count)
    light = lift_off(pressure)
    gauge, meter = (0.0, 0.0) if exact_inputs else (GAUGE, METER)
    noted = {
        "pressure": pressure * np.exp(SCATTER["pressure"] * rng.normal(size=count)),
        "irradiance": light * np.exp(SCATTER["irradiance"] * rng.normal(size=count)),
    }
    noted["pressure"] *= np.exp(gauge * rng.normal())
    noted["irradiance"] *= np.exp(meter * rng.normal())
    if stated:
        for name, spread in SCATTER.items():
            noted[f"{name}_uncertainty"] = spread * noted[name]
    if not exact_inputs:
        for name, (value, spread) in SAMPLE.items():
            noted[name] = np.full(count, value + spread * rng.normal())
            noted[f"{name}_uncertainty"] = np.full(count, spread)
    return lf.calibration.Points("study", ["disk"] * count, noted)


CONDITIONS = {
    "12 points with stated errors": (12, (1.5, 25.0), True),
    "8 points without errors": (8, (1.5, 25.0), False),
    "thin gas only": (10, (0.8, 4.0), True),
}


def trials(seed):
    """Intervals of both coefficients, at exact inputs and in total."""
    rng = np.random.default_rng(seed)
    found = []
    for words, (count, span, stated) in CONDITIONS.items():
        for kind in ("given inputs", "total"):
            exact = kind == "given inputs"
            points = points_of(rng, count, span, exact_inputs=exact, stated=stated)
            try:
                fit = lf.calibrate(design(), points=points)
            except lf.ParameterError as refused:
                if exact or "no irradiance levitates" not in str(refused):
                    raise
                continue
            intervals = fit.intervals if exact else fit.total_intervals
            found += [
                Trial(f"{name} ({kind}), {words}", TRUTH[name], *map(float, ends))
                for name, ends in zip(fit.names, intervals, strict=True)
            ]
    return found
