"""What is done with a heater's run before it is fitted: rows that serve, weights, first guess."""

from dataclasses import dataclass, field, replace

import numpy as np

from lightflyer.core import constants
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.errors import ConfigurationError, LightflyerError, ParameterError
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.tac.data import TacAccuracy, TacRun
from lightflyer.lab.tac.diagnostics import require_possible_temperatures, rows_off_the_curve
from lightflyer.lab.tac.heat_law import HEAT_LAWS, KINETIC_LAW, AbstractHeatLaw, nominal_area
from lightflyer.lab.tac.intervals import best_tac
from lightflyer.lab.tac.problem import Problem, first_guess, minimise, require_distinct

LU2023_HEATER_DIAMETER = 24e-3  # Diameter of the paper's heater [m]; [Lu2023]_ supplement

_LEAST_ROWS = 6
_WEIGHTINGS = 2


@dataclass(frozen=True)
class Bench:
    """Heater, law, gas and instruments; arguments as of :func:`~lightflyer.lab.fit_tac`."""

    diameter: float = LU2023_HEATER_DIAMETER
    tolerance: float = 1.0
    emissivity: float | None = None
    law: AbstractHeatLaw = KINETIC_LAW
    gas: AbstractGas = AIR
    accuracy: TacAccuracy = field(default_factory=TacAccuracy)

    def __post_init__(self) -> None:
        if np.ndim(self.diameter):
            raise ParameterError("diameter must be one number: that of the heater")
        require_positive(diameter=self.diameter, tolerance=self.tolerance)
        require_range("emissivity", self.emissivity, 0.0, 1.0)


@dataclass(frozen=True)
class Prepared:
    """A run with what its fit starts from."""

    run: TacRun
    kept: np.ndarray  # Rows that are fitted, shape (n,)
    off_curve: np.ndarray  # Rows that belong to no curve through the others, shape (n,)
    problem: Problem
    guess: tuple[float, float, float]
    others: dict[str, float | None]  # Coefficient by each of the other laws


def prepare(run: TacRun, bench: Bench) -> Prepared:
    """Choose the rows of a run, weigh them, and find a first fit.

    Raises
    ------
    ConfigurationError
        If the rows are too few, impossible, or do not tell the parameters apart.
    """
    require_possible_temperatures(run)
    kept = _at_constant_temperature(run, bench.tolerance)
    problem = make_problem(run, kept, bench)
    off = rows_off_the_curve(problem, run.table.lines[kept])
    off_curve = np.zeros_like(kept)
    off_curve[kept] = off
    if off.any():
        problem, kept = problem.rows(~off), kept & ~off_curve
        _require_rows(run, kept)
    problem, guess = _weigh(problem)
    others = {
        name: _coefficient(make_problem(run, kept, bench, other))
        for name, other in HEAT_LAWS.items()
        if name != bench.law.name
    }
    return Prepared(run, kept, off_curve, problem, guess, others)


def make_problem(
    run: TacRun, kept: np.ndarray, bench: Bench, law: AbstractHeatLaw | None = None
) -> Problem:
    """Rows of a run that are kept, shape (n,); by the bench's law or another."""
    diameter, emissivity = bench.diameter, bench.emissivity
    law = law or bench.law
    heater, ambient = run.heater_temperature[kept], run.ambient_temperature[kept]
    pressure = run.pressure[kept]
    radiation = np.zeros_like(heater)
    if emissivity is not None:
        both_faces = 2.0 * constants.STEFAN_BOLTZMANN * emissivity
        radiation = both_faces * (heater + ambient) * (heater**2 + ambient**2)
    conductance = run.power[kept] / (nominal_area(diameter) * (heater - ambient))
    limits = law.limits(pressure, ambient, heater, diameter, bench.gas)
    errors = bench.accuracy.errors(heater - ambient, diameter)
    return Problem(run.source, conductance, pressure, limits, radiation, 1.0 / conductance, errors)


def _weigh(problem: Problem) -> tuple[Problem, tuple[float, float, float]]:
    """The problem with its residuals over the conductance of a first fit, and that fit."""
    guess = first_guess(problem.group())
    for _ in range(_WEIGHTINGS):
        problem = replace(problem, weight=1.0 / problem.model(*guess))
        require_distinct(problem, guess)
        plain = problem.with_common_errors([0.0] * len(problem.errors.names)).group()
        found = minimise(plain, guess).params
        guess = (float(found["tac"]), float(found["area_ratio"]), float(found["offset"]))
    return problem, guess


def _coefficient(problem: Problem) -> float | None:
    """Coefficient by another law; None where the fit fails."""
    try:
        return best_tac(*_weigh(problem.group()))
    except LightflyerError:
        return None


def _at_constant_temperature(run: TacRun, tolerance: float) -> np.ndarray:
    """Rows near the median heater temperature; shape (n,)."""
    off = np.abs(run.heater_temperature - np.median(run.heater_temperature))
    kept = off <= tolerance
    if kept.sum() < max(_LEAST_ROWS, 0.5 * len(kept)):
        _require_rows(run, np.ones_like(kept))
        worst = int(np.argmax(off))
        raise ConfigurationError(
            f"{run.source}:{run.table.lines[worst]}: the heater's temperature is not constant: "
            f"only {kept.sum()} of {len(kept)} rows are within {tolerance:g} K of its median; "
            "--tolerance sets the limit"
        )
    return kept


def _require_rows(run: TacRun, kept: np.ndarray) -> None:
    count = int(kept.sum())
    if count < _LEAST_ROWS:
        raise ConfigurationError(
            f"{run.source}:{run.table.lines[0]}: has {count} usable row{'s' * (count > 1)}; "
            f"a fit of three parameters needs {_LEAST_ROWS} or more"
        )
