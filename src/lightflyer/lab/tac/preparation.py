"""What is done with a heater's run before it is fitted: rows that serve, weights, first guess."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from scipy import stats
from scipy.optimize import least_squares

from lightflyer.core import constants
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.errors import ConfigurationError, LightflyerError, ParameterError
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.tac.data import TacAccuracy, TacRun
from lightflyer.lab.tac.heat_law import HEAT_LAWS, KINETIC_LAW, AbstractHeatLaw, nominal_area
from lightflyer.lab.tac.intervals import best_tac
from lightflyer.lab.tac.problem import (
    PARAMETERS,
    HeaterProblem,
    first_guess,
    minimise,
    require_distinct,
)

LU2023_HEATER_DIAMETER = 24e-3  # Diameter of the paper's heater [m]; [Lu2023]_ supplement

HEATER_TEMPERATURES = (80.0, 1500.0)
"""Possible temperatures of a heater [K], from where air is liquid to where heaters melt."""

GAS_TEMPERATURES = (80.0, 450.0)  # Possible temperatures of the gas in a vacuum chamber [K]

_LEAST_ROWS = 6
_WEIGHTINGS = 2
_LEAST_DEVIATION = 0.03  # relative; nearer to the curve no row is called off it
_SUSPECT = 5.0  # robust standard deviations
_SIGNIFICANCE = 1e-3  # of one row off the curve among all
_MOST_OFF = 0.2  # share of the rows
_ROBUST_ROWS = 4_000  # that the robust fit takes of a very long run
_NORMAL_MAD = float(stats.norm.ppf(0.75))  # median absolute deviation of a unit normal
_WINDOW = 5  # rows of the running median


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
    problem: HeaterProblem
    guess: tuple[float, float, float]
    others: dict[str, float | None]  # Coefficient by each of the other laws


def prepare(run: TacRun, bench: Bench) -> Prepared:
    """Choose the rows of a run, weigh them, and find a first fit; raises if they do not serve."""
    for name, values, (low, high) in (
        ("heater_temperature", run.heater_temperature, HEATER_TEMPERATURES),
        ("ambient_temperature", run.ambient_temperature, GAS_TEMPERATURES),
    ):
        for row in np.flatnonzero(~((values >= low) & (values <= high))):
            raise ConfigurationError(
                f"{run.source}:{run.table.lines[row]}: {name} = {values[row]:.4g} K is not between "
                f"{low:g} and {high:g} K; is the column's unit right (K or °C)?"
            )
    off = np.abs(run.heater_temperature - np.median(run.heater_temperature))
    kept = off <= bench.tolerance
    if kept.sum() < max(_LEAST_ROWS, 0.5 * len(kept)):
        _require_rows(run, len(kept))
        worst = int(np.argmax(off))
        raise ConfigurationError(
            f"{run.source}:{run.table.lines[worst]}: the heater's temperature is not constant: "
            f"only {kept.sum()} of {len(kept)} rows are within {bench.tolerance:g} K of its "
            "median; --tolerance sets the limit"
        )
    problem = make_problem(run, kept, bench)
    off_curve = np.zeros_like(kept)
    off_curve[kept] = rows_off_the_curve(problem, run.table.lines[kept])
    if off_curve.any():
        problem, kept = problem.rows(~off_curve[kept]), kept & ~off_curve
        _require_rows(run, int(kept.sum()))
    problem, guess = _weigh(problem)
    others = {
        name: _coefficient(make_problem(run, kept, bench, other))
        for name, other in HEAT_LAWS.items()
        if name != bench.law.name
    }
    return Prepared(run, kept, off_curve, problem, guess, others)


def make_problem(
    run: TacRun, kept: np.ndarray, bench: Bench, law: AbstractHeatLaw | None = None
) -> HeaterProblem:
    """Rows of a run that are kept, shape (n,); by the bench's law or another."""
    heater, ambient = run.heater_temperature[kept], run.ambient_temperature[kept]
    pressure, diameter = run.pressure[kept], bench.diameter
    radiation = np.zeros_like(heater)
    if bench.emissivity is not None:
        both_faces = 2.0 * constants.STEFAN_BOLTZMANN * bench.emissivity
        radiation = both_faces * (heater + ambient) * (heater**2 + ambient**2)
    conductance = run.power[kept] / (nominal_area(diameter) * (heater - ambient))
    limits = (law or bench.law).limits(pressure, ambient, heater, diameter, bench.gas)
    errors = bench.accuracy.errors(heater - ambient, diameter)
    return HeaterProblem(
        run.source, conductance, pressure, limits, radiation, 1.0 / conductance, errors
    )


def _weigh(problem: HeaterProblem) -> tuple[HeaterProblem, tuple[float, float, float]]:
    """The problem with its residuals over the conductance of a first fit, and that fit."""
    guess = first_guess(problem.group())
    for _ in range(_WEIGHTINGS):
        problem = replace(problem, weight=1.0 / problem.model(*guess))
        require_distinct(problem, guess)
        found = minimise(problem.without_common_errors().group(), guess).params
        guess = (float(found["tac"]), float(found["area_ratio"]), float(found["offset"]))
    return problem, guess


def _coefficient(problem: HeaterProblem) -> float | None:
    """Coefficient by another law; None where the fit fails."""
    try:
        return best_tac(*_weigh(problem.group()))
    except LightflyerError:
        return None


def _require_rows(run: TacRun, count: int) -> None:
    if count < _LEAST_ROWS:
        raise ConfigurationError(
            f"{run.source}:{run.table.lines[0]}: has {count} usable row{'s' * (count > 1)}; "
            f"a fit of three parameters needs {_LEAST_ROWS} or more"
        )


def rows_off_the_curve(problem: HeaterProblem, lines: np.ndarray) -> np.ndarray:
    """Rows that belong to no curve through the others, such as one with a repeated fragment."""
    # A robust fit (soft L1 of the logarithms, from a running median) finds suspects. A suspect is
    # off if its deviation from the least-squares fit of the others is significant at 0.001 for the
    # whole run (Student's, Bonferroni's correction), and more than 3 %.
    problem = problem.without_common_errors()
    order = np.argsort(problem.pressure, kind="stable")
    some = problem.rows(order[:: max(1, len(order) // _ROBUST_ROWS)])
    padded = np.pad(some.conductance, _WINDOW // 2, mode="edge")
    smooth = np.median(np.lib.stride_tricks.sliding_window_view(padded, _WINDOW), axis=1)
    tac, ratio, offset = first_guess(replace(some, conductance=smooth, weight=1.0 / smooth))
    start = np.array([tac, ratio, max(offset, 0.0)])
    scale = max(float(np.median(np.abs(_log_deviations(some, start)))), _LEAST_DEVIATION / _SUSPECT)
    robust = least_squares(
        lambda values: _log_deviations(some, values), start, loss="soft_l1", f_scale=scale,
        x_scale=np.maximum(np.abs(start), 0.1), bounds=([1e-6, 1e-9, 0.0], [20.0, np.inf, np.inf]),
    ).x  # fmt: skip
    away = np.abs(_log_deviations(problem, robust))
    count = len(away)
    scale = np.median(away) / _NORMAL_MAD * math.sqrt(count / max(count - len(PARAMETERS), 1))
    suspects = away > max(_SUSPECT * scale, _LEAST_DEVIATION)
    if suspects.sum() > _MOST_OFF * count:
        raise ConfigurationError(
            f"{problem.source}:{lines[int(np.argmax(away))]}: {suspects.sum()} of {count} rows, "
            "this one the most, are off any curve of power against pressure; check the columns "
            "and units"
        )
    freedom = int((~suspects).sum()) - len(PARAMETERS)
    if not suspects.any() or freedom < 1:
        return np.zeros_like(suspects)
    problem = replace(problem, weight=1.0 / problem.model(*robust))
    good = problem.rows(~suspects)
    fit = least_squares(
        lambda values: good.residuals(*values), robust, x_scale=np.maximum(np.abs(robust), 0.1),
        bounds=([1e-6, 1e-9, -np.inf], [20.0, np.inf, np.inf]),
    )  # fmt: skip
    design, gradient = good.jacobian(*fit.x).T, problem.jacobian(*fit.x).T
    leverage = np.sum(gradient @ np.linalg.pinv(design.T @ design) * gradient, axis=1)
    variance = 2.0 * fit.cost / freedom * (1.0 + leverage)
    limit = stats.t.isf(0.5 * _SIGNIFICANCE / count, freedom)
    limits = limit * np.sqrt(np.maximum(variance, np.finfo(float).tiny))
    deviations = np.abs(problem.residuals(*fit.x))
    return suspects & (deviations > limits) & (deviations > _LEAST_DEVIATION)


def _log_deviations(problem: HeaterProblem, values: np.ndarray) -> np.ndarray:
    model = np.maximum(problem.model(*values), np.finfo(float).tiny)
    return np.log(problem.conductance) - np.log(model)
