"""Intervals of ``lightflyer lab tac``.

The heat loss is interpolated from the kinetic solver's own results and, in dense gas, conducted by
a disk in a gas of the US Standard Atmosphere: NumPy and SciPy, none of the package's formulas.
Gauge, power meter, thermometers, diameter and plateau are off by what the command's accuracies
say; a plateau that drifts does so by as much as it is uncertain, stated or not. Sherman's law, the
limits in series, is up to 2.8 % off the solver's.
"""

from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator
from trial import Trial

import lightflyer as lf
from lightflyer.calibration.gauge import rows_at_the_end
from lightflyer.files.table import Table

COMMAND = "lab tac"

DIAMETER = 24e-3  # nominal, of the heater [m]
AMBIENT, HEATER = 295.0, 323.0  # [K]
R, GAMMA = 287.05, 1.4
RATIOS, TACS = (1.0, 1.6, 2.5), (0.6, 0.8, 1.0)  # of the table, as far as it is a grid
DATA = Path(lf.__file__).parent / "data" / "kinetic.csv"


class Condition(NamedTuple):
    """Rows of a run, and the gauge."""

    lowest: float  # [Pa]
    highest: float  # [Pa]
    rows: int
    gauge: float  # relative accuracy
    zero: float  # [Pa]
    law: str = "kinetic"
    drift: float = 0.0  # of the plateau over the run, relative
    stated: bool = True  # whether the command knows of the drift
    noise: float = 0.01  # of the power of one row, relative
    end: float = np.inf  # of the gauge's range [Pa]; beyond it shows its end

    def accuracy(self) -> lf.lab.TacAccuracy:
        """What the command is told."""
        drift = self.drift * self.stated
        return lf.lab.TacAccuracy(gauge=self.gauge, gauge_zero=self.zero, plateau_drift=drift)


USUAL = (1e-3, 200.0, 60, 0.05, 0.01)
MANY = (1e-3, 200.0, 2000, 0.05, 0.01)
CONDITIONS = {
    "full range": Condition(*USUAL),
    "narrow range": Condition(1.0, 6.0, 40, 0.05, 0.01),
    "10 rows": Condition(1e-3, 200.0, 10, 0.05, 0.01),
    "capacitance manometer": Condition(1e-3, 200.0, 60, 0.0025, 0.002),
    "2000 rows": Condition(*MANY),
    "Sherman's law": Condition(*USUAL, "Sherman"),
    "Sherman's law, 2000 rows": Condition(*MANY, "Sherman"),
    "plateau drifts": Condition(*USUAL, drift=0.05),
    "plateau drifts, 2000 rows": Condition(*MANY, drift=0.05),
    "drift not stated": Condition(*USUAL, drift=0.05, stated=False),
    "drift not stated, 2000 rows": Condition(*MANY, drift=0.05, stated=False),
    "gauge ends at 10 Pa": Condition(*USUAL, end=10.0),
}


def viscosity(temperature):
    """Of air [Pa s]: US Standard Atmosphere 1976, Eq. (51)."""
    return 1.458e-6 * temperature**1.5 / (temperature + 110.4)


def conducted(hot, cold):
    """Integral of air's conductivity [W/m]: US Standard Atmosphere 1976, Eq. (53)."""
    t = np.linspace(cold, hot, 101)
    conductivity = 2.64638e-3 * t**1.5 / (t + 245.4 * 10.0 ** (-12.0 / t))
    return np.trapezoid(conductivity, t)


def rows_of(path):
    """Rows of a table of the package, as dictionaries of texts, for a diatomic gas."""
    with path.open(encoding="utf-8") as file:
        lines = [line.strip() for line in file if not line.startswith("#")]
    names = lines[0].split(",")
    rows = (dict(zip(names, line.split(","), strict=True)) for line in lines[1:])
    return [row for row in rows if row["gas"] == "diatomic"]


@cache
def solved():
    """Logarithm of (1/Q − 1) Kn/α of the solver, over Knudsen number, temperature ratio and TAC."""
    found = {}
    for row in rows_of(DATA):
        if (row["tac_difference"], row["viscosity_exponent"]) != ("0.1", "0.74"):
            continue
        place = tuple(float(row[name]) for name in ("knudsen", "temperature_ratio", "tac"))
        found[place] = np.log((1.0 / float(row["heat_ratio"]) - 1.0) * place[0] / place[2])
    others = [(ratio, tac) for ratio in RATIOS for tac in TACS]
    knudsens = [
        k
        for k in sorted({place[0] for place in found})
        if all((k, *other) in found for other in others)
    ]
    values = [[[found[k, ratio, tac] for tac in TACS] for ratio in RATIOS] for k in knudsens]
    return (np.array(knudsens), np.array(RATIOS), np.array(TACS)), np.array(values)


@cache
def collisions():
    """Logarithm of what molecules' collisions take more from the heat, over ln Kn, by exponent."""
    found = {}
    for exponent in ("0.74", "0.93"):
        rows = [
            (float(row["knudsen"]), float(row["heat_factor"]))
            for row in rows_of(DATA.with_name("kinetic_collisions.csv"))
            if (row["viscosity_exponent"], row["tac"]) == (exponent, "0.9")
        ]
        knudsens, factors = np.array(sorted(rows)).T
        found[exponent] = PchipInterpolator(np.log(knudsens), np.log(factors))
    return found["0.74"], found["0.93"]


def factor_of_collisions(knudsen, cold):
    """In air, whose viscosity and conduction are not those of the molecules of the table."""
    slope = np.log(viscosity(1.01 * cold) / viscosity(cold)) / np.log(1.01)
    share = (slope - 0.74) / (0.93 - 0.74)
    low, high = (curve(np.log(np.clip(knudsen, 0.03, 30.0))) for curve in collisions())
    conduction = conducted(1.001 * cold, cold) / (0.001 * cold * viscosity(cold) * R)
    simulated = 4.717 + share * (4.595 - 4.717)  # docs/kinetic-collisions.md
    return np.exp((1.0 - share) * low + share * high) * simulated / conduction


def gas_conductance(pressure, hot, cold, tac, diameter, plateau, law="kinetic"):
    """Conductance of the gas around a disk, both faces, per area of one [W/(m² K)]."""
    (knudsens, ratios, tacs), values = solved()
    # through the three temperatures and the three coefficients of the table
    heating, wanted = 1.0 - 1.0 / ratios, 1.0 - cold / hot
    across = np.moveaxis(values, 1, 0).reshape(3, -1)
    at_ratio = lagrange(heating, across, wanted).reshape(len(knudsens), 3)
    curve = lagrange(tacs, at_ratio.T, tac)
    speed = np.sqrt(8.0 * R * cold / np.pi)
    path = viscosity(cold) / pressure * np.sqrt(0.5 * np.pi * R * cold)
    knudsen = path / diameter
    thin = tac * (GAMMA + 1.0) / (GAMMA - 1.0) / 8.0 * speed / cold * 2.0 * pressure
    dense = 4.0 * diameter * conducted(hot, cold) / (0.25 * np.pi * diameter**2 * (hot - cold))
    if law == "Sherman":
        return thin / (1.0 + thin / (dense * (1.0 + plateau)))
    limit = np.log(np.mean(thin / dense * knudsen / tac))
    position = np.concatenate([[0.0], knudsens])  # straight in Kn between the limit and the table
    within = PchipInterpolator(np.log(knudsens), curve)(np.log(np.clip(knudsen, 0.03, 30.0)))
    below = np.interp(knudsen, position[:2], [limit, curve[0]])
    resistance = np.exp(np.where(knudsen < knudsens[0], below, within)) * tac / knudsen
    resistance *= factor_of_collisions(knudsen, cold) ** np.minimum(knudsen / knudsens[0], 1.0)
    return thin / (1.0 + resistance / (1.0 + plateau))


def lagrange(nodes, values, wanted):
    """Parabola through three nodes; values of shape (3, ...)."""
    return np.tensordot(
        np.linalg.solve(np.vander(nodes, increasing=True).T, wanted ** np.arange(3)), values, 1
    )


def errors_of(rng, condition):
    """What the instruments of a bench are off by."""
    accuracy = condition.accuracy()
    names = "gauge", "gauge_zero", "power", "temperature", "diameter", "plateau"
    return rng.normal(size=len(names)) * [getattr(accuracy, name) for name in names]


def run_of(rng, condition, off, tac=None):
    """A run as it is read, and its truth; ``off`` of :func:`errors_of`."""
    truth = {
        "tac": rng.uniform(0.6, 0.98) if tac is None else tac,
        "area_ratio": rng.uniform(0.9, 1.4),
        "offset": rng.uniform(2.0, 6.0),
    }
    gauge, zero, power, temperature, wider, plateau = off
    diameter, hot = DIAMETER + wider, HEATER - temperature
    pressure = np.geomspace(condition.lowest, condition.highest, condition.rows)
    late = condition.drift * rng.normal() * np.linspace(-0.5, 0.5, condition.rows)
    gas = gas_conductance(
        pressure, hot, AMBIENT, truth["tac"], diameter, plateau + late, condition.law
    )
    area = 0.25 * np.pi * diameter**2
    watts = truth["area_ratio"] * (gas + truth["offset"]) * area * (hot - AMBIENT)
    watts *= (1.0 + power) * (1.0 + condition.noise * rng.normal(size=pressure.size))
    read = np.minimum(pressure * (1.0 + gauge) + zero, condition.end)
    seen = read > 0.0  # a table's reader rejects what is below the gauge's zero
    seen[seen] = ~rows_at_the_end(read[seen], watts[seen])
    count = int(seen.sum())
    table = Table("synthetic", np.arange(count) + 2, {})
    heater, ambient = np.full(count, HEATER), np.full(count, AMBIENT)
    return lf.lab.TacRun(table, read[seen], watts[seen], heater, ambient), truth


def trials(seed):
    """Every interval of one run under each condition."""
    found = []
    for number, (name, condition) in enumerate(CONDITIONS.items()):
        rng = np.random.default_rng([seed, number])
        run, truth = run_of(rng, condition, errors_of(rng, condition))
        fit = lf.lab.fit_tac(run, accuracy=condition.accuracy())
        for parameter, one in fit.estimates().items():
            true = truth[parameter]
            found.append(Trial(f"{parameter}, {name}", true, *one.interval))
            ends = fit.covariance_intervals[parameter]
            found.append(Trial(f"{parameter} by covariance, {name}", true, *ends))
        product = truth["tac"] * truth["area_ratio"]
        found.append(Trial(f"slope, {name}", product, *fit.slope.interval))
    return found
