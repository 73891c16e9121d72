"""``lightflyer lab levitation``: points made with the paper's equations in plain NumPy.

In each case two coatings of one areal density, which differs from case to case, are measured in one
chamber, whose gauge and light meter are off by errors drawn from their accuracies.
"""

import sys
from functools import cache
from pathlib import Path

import numpy as np
from trial import Trial

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import numpy_model

from lightflyer.lab.levitation.curve import compare, levitation_curve
from lightflyer.lab.levitation.data import LiftOffs

COMMAND = "lab levitation"

EMITTANCES = {"Ge": 0.08, "CNT": 0.48}
TACS = 0.8, 0.9
ABSORPTANCE, RADIUS, CHAMBER = 0.75, 0.01, 293.0
SPAN = np.log(1.2), np.log(40.0)  # of pressure [Pa]
GAUGE = METER = 0.05  # relative
SCATTER = 0.04  # of log-irradiance
UNEVEN = 0.15  # of the distance between pressures
HOTTEST = 2000.0
FINE = np.linspace(*SPAN, 2000)
GAP = 2.2, 8.0  # [Pa], around the optima
WHOLE = np.inf, np.inf
CONDITIONS = {
    "8 points, no steps": (8, 0.0, WHOLE),
    "8 points, steps of 100 W/m^2": (8, 100.0, WHOLE),
    "12 points, steps of 100 W/m^2": (12, 100.0, WHOLE),
    "12 points, steps of 200 W/m^2": (12, 200.0, WHOLE),
    "40 points, no steps": (40, 0.0, WHOLE),
    "40 points, steps of 100 W/m^2": (40, 100.0, WHOLE),
    "40 points, steps of 200 W/m^2": (40, 200.0, WHOLE),
    "24 points, none from 2.2 to 8 Pa": (24, 0.0, GAP),
    "60 points, none from 2.2 to 8 Pa": (60, 0.0, GAP),
}
DRAWS = 1000


@cache
def lift_off(emittance, areal_density):
    """Log-irradiance at which a sample levitates, at the fine pressures."""
    pressure, area = np.exp(FINE), np.pi * RADIUS**2
    weight = areal_density * area * numpy_model.GRAVITY
    low, high = np.full(pressure.shape, CHAMBER + 1e-9), np.full(pressure.shape, HOTTEST)
    for _ in range(50):
        hot = 0.5 * (low + high)
        lifted = numpy_model.force(hot, CHAMBER, pressure, RADIUS, *TACS) > weight
        low, high = np.where(lifted, low, hot), np.where(lifted, hot, high)
    power = numpy_model.lost_power(high, CHAMBER, pressure, RADIUS, 0.5 * sum(TACS), emittance)
    return np.log(power / (ABSORPTANCE * area))


def measured(rng, name, truth, count, step, gap, errors):
    """Points of one sample as they would be noted."""
    distance = (SPAN[1] - SPAN[0]) / (count - 1)
    place = np.linspace(*SPAN, count) + UNEVEN * distance * rng.normal(size=count)
    place = np.clip(place, *SPAN)
    place = place[(np.exp(place) < gap[0]) | (np.exp(place) > gap[1])]
    light = np.interp(place, FINE, truth) + SCATTER * rng.normal(size=place.size)
    read = np.exp(light + errors[1])
    if step:
        read = step * np.ceil(read / step)
    return LiftOffs(name, np.exp(place + errors[0]), read, "study:1")


def trials(seed):
    """Intervals of one sample's optimum, and of the reduction between two."""
    rng = np.random.default_rng(seed)
    density = 1e-3 * rng.uniform(0.9, 1.1)
    truths = {name: lift_off(emittance, density) for name, emittance in EMITTANCES.items()}
    found = []
    for words, (count, step, gap) in CONDITIONS.items():
        errors = np.array([GAUGE, METER]) * rng.normal(size=2)
        curves = [
            levitation_curve(
                measured(rng, name, truth, count, step, gap, errors),
                step=step, draws=DRAWS, seed=2 * seed + number,
                pressure_accuracy=GAUGE, irradiance_accuracy=METER,
            )
            for number, (name, truth) in enumerate(truths.items())
        ]  # fmt: skip
        truth = truths["Ge"]
        place, value = np.exp([FINE[truth.argmin()], truth.min()])
        pressure, light = curves[0].optimal_pressure, curves[0].minimum_irradiance
        found += [
            Trial(f"optimal pressure, {words}", place, *pressure.interval),
            Trial(f"minimum irradiance, {words}", value, *light.interval),
        ]
        (one,) = compare(curves)
        reduction = 1.0 - np.exp(truth.min() - truths["CNT"].min())
        found.append(Trial(f"reduction, {words}", reduction, *one.reduction.interval))
    return found
