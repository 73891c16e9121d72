"""What is done with a heater's run before it is fitted, and what may be wrong with the fit.

Before are the rows that serve, their weights and a first guess.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from scipy import ndimage, stats
from scipy.optimize import least_squares

from lightflyer.core import constants
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.errors import ConfigurationError, Doubt, LightflyerError, ParameterError
from lightflyer.core.quantity import AccommodationCoefficient, Quantity, quantity_of
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.result import AREA_RATIO, doubts_of
from lightflyer.lab.tac.data import IN_WORDS, TacAccuracy, TacRun
from lightflyer.lab.tac.intervals import best_tac
from lightflyer.lab.tac.problem import (
    HEAT_LAWS,
    KINETIC_LAW,
    PARAMETERS,
    AbstractHeatLaw,
    HeaterProblem,
    first_guess,
    minimise,
    nominal_area,
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

POSSIBLE_TAC = 1.0  # Largest accommodation coefficient of any surface

MOST_TAC = 2.0
"""Largest coefficient that a measurement may give by its systematic errors; [Lu2023]_ has 1.14."""

FAR = 2.0  # Standard uncertainties of an error, from which a fit is told to want it
_TOO_FAR = 3.0  # from which it is in doubt
_MOST_LINES = 8  # of a file, that a message lists
_TAC = quantity_of(AccommodationCoefficient) or Quantity()

MOST_RELATIVE_UNCERTAINTY = 0.25
"""Standard uncertainty over value, above which a run does not determine a coefficient."""

AREA_RATIOS = (0.1, 10.0)
"""Possible ratios of effective to nominal area: films cover a heater and not much else."""

BOUNDS = {"tac": (0.0, MOST_TAC), "area_ratio": AREA_RATIOS, "offset": (0.0, math.inf)}
"""What is possible for each parameter; intervals end there."""

_SPANS = (0.1, 10.0)  # over the pressure at which both limits are equal: these determine α
_PERCENT = 100.0
_SIGNIFICANT = 4.0  # standard errors
_LEAST = 2e-3  # relative; no bench holds a conductance better
_FEWEST = 8  # rows of a direction
_TIED = 0.9  # correlation of time and pressure, above which drift cannot be told from the law


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


class Prepared(NamedTuple):
    """A run with what its fit starts from."""

    run: TacRun
    kept: np.ndarray  # Rows that are fitted, shape (n,)
    off_curve: np.ndarray  # Rows that belong to no curve through the others, shape (n,)
    problem: HeaterProblem
    guess: list[float]
    others: dict[str, float | None]  # Coefficient by each of the other laws; none that fails


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
    others: dict[str, float | None] = {}
    for name, other in HEAT_LAWS.items():
        if name != bench.law.name:
            by_other = make_problem(run, kept, bench, other).group()
            try:
                others[name] = best_tac(*_weigh(by_other))
            except LightflyerError:
                others[name] = None
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
    errors = bench.accuracy.errors(pressure, heater - ambient, diameter)
    return HeaterProblem(
        run.source, conductance, pressure, limits, radiation, 1.0 / conductance, errors
    )


def _weigh(problem: HeaterProblem) -> tuple[HeaterProblem, list[float]]:
    """The problem with its residuals over the conductance of a first fit, and that fit."""
    bare = problem.held({})
    guess = first_guess(bare.group())
    for _ in range(_WEIGHTINGS):
        bare = replace(bare, weight=1.0 / bare.model(guess))
        require_distinct(bare, guess)
        guess, _ = minimise(bare.group(), guess)
    return replace(problem, weight=bare.weight), guess


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
    problem = problem.held({})
    order = np.argsort(problem.pressure, kind="stable")
    some = problem.rows(order[:: max(1, len(order) // _ROBUST_ROWS)])
    smooth = ndimage.median_filter(some.conductance, _WINDOW, mode="nearest")
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
    problem = replace(problem, weight=1.0 / problem.model(robust))
    good = problem.rows(~suspects)
    fit = least_squares(
        lambda values: good.residuals(values), robust, x_scale=np.maximum(np.abs(robust), 0.1),
        bounds=([1e-6, 1e-9, -np.inf], [20.0, np.inf, np.inf]),
    )  # fmt: skip
    design, gradient = good.jacobian(fit.x).T, problem.jacobian(fit.x).T
    leverage = np.sum(gradient @ np.linalg.pinv(design.T @ design) * gradient, axis=1)
    variance = 2.0 * fit.cost / freedom * (1.0 + leverage)
    limit = stats.t.isf(0.5 * _SIGNIFICANCE / count, freedom)
    limits = limit * np.sqrt(np.maximum(variance, np.finfo(float).tiny))
    deviations = np.abs(problem.residuals(fit.x))
    return suspects & (deviations > limits) & (deviations > _LEAST_DEVIATION)


def _log_deviations(problem: HeaterProblem, values: np.ndarray) -> np.ndarray:
    model = np.maximum(problem.model(values), np.finfo(float).tiny)
    return np.log(problem.conductance) - np.log(model)


def why_undetermined(estimate: Estimate, problem: HeaterProblem, scatter: float) -> str | None:
    """Why a run does not determine its coefficient, in one line; None if it does."""
    low, high = estimate.interval
    spread = estimate.uncertainty or 0.0
    loose = spread > MOST_RELATIVE_UNCERTAINTY * estimate.value
    if not loose and low > 0.0 and high < max(MOST_TAC, 2.0 * estimate.value):
        return None
    tac = min(max(estimate.value, 0.1), POSSIBLE_TAC)
    per_pressure = np.median(tac * problem.limits.free_molecular / problem.pressure)
    equal = float(np.median(problem.limits.continuum(tac)) / per_pressure)
    first, last = (span * equal for span in _SPANS)  # would determine all parameters
    least, most = float(problem.pressure.min()), float(problem.pressure.max())
    says = f"{problem.source}: these rows do not determine the accommodation coefficient; they "
    if least <= first and most >= last:
        return (
            f"{says}scatter by {scatter:.2g} of their value, which leaves it uncertain by "
            f"{_PERCENT * spread / estimate.value:.0f} %; more rows or better instruments would "
            "determine it"
        )
    return (
        f"{says}have {least:.2g} to {most:.2g} Pa, and rows from {first:.1g} to {last:.2g} Pa or "
        "beyond would determine it"
    )


def require_possible(source: str, estimates: dict[str, Estimate], reading: str) -> None:
    """Raise if a result is impossible beyond its uncertainty; ``source``: name of the file."""
    ratio, tac, offset = (estimates[name] for name in ("area_ratio", "tac", "offset"))
    check = "check the units of pressure and power, gas, temperatures and diameter"
    low, high = AREA_RATIOS
    if not low <= ratio.value <= high:
        raise ConfigurationError(
            f"{source}: area ratio {ratio.value:.4g} is impossible (between {low:g} and {high:g} "
            f"is allowed); {check}"
        )
    if tac.interval[0] > MOST_TAC:
        raise ConfigurationError(
            f"{source}: accommodation coefficient {tac.value:.4g} by the reading {reading} is "
            f"impossible (up to {MOST_TAC:g} is allowed for a measured one); {check}"
        )
    if offset.interval[1] < 0.0:
        raise ConfigurationError(
            f"{source}: offset {offset.value:.4g} W/(m² K) is impossible: a heater without gas "
            f"would gain heat; check the zero of the power, and --emissivity"
        )


def cut(estimates: dict[str, Estimate]) -> tuple[dict[str, Estimate], list[str]]:
    """Intervals cut at what is possible, and a line for each that was cut."""
    said = {"tac": "accommodation coefficient", "area_ratio": "area ratio", "offset": "offset"}
    changed, texts = {}, []
    for name, one in estimates.items():
        low, high = BOUNDS[name]
        ends = (
            max(one.interval[0], min(low, one.value)),
            min(one.interval[1], max(high, one.value)),
        )
        changed[name] = Estimate(one.value, ends, one.unit, one.uncertainty)
        if ends != one.interval:
            allowed = f"{low:g} to {high:g}" if math.isfinite(high) else f"{low:g} or more"
            texts.append(
                f"the interval of the {said[name]} is cut at {ends[0]:.3g} to {ends[1]:.3g}: the "
                f"rows alone do not bound it to what is possible, {allowed}"
            )
    return changed, texts


def result_warnings(estimates: dict[str, Estimate], reading: str) -> list[str]:
    """Lines about results that are unlikely, though possible within their uncertainty."""
    texts: list[str] = []
    tac, ratio = estimates["tac"], estimates["area_ratio"]
    if tac.value > POSSIBLE_TAC:
        beyond = tac.interval[0] > POSSIBLE_TAC
        texts.append(
            f"accommodation coefficient {tac.value:.3g} by the reading {reading} is above 1, "
            + ("beyond its uncertainty: no surface has it; check pressure, plateau and reading"
               if beyond else "which no surface has, but 1 is within its uncertainty")
        )  # fmt: skip
    texts += doubts_of("accommodation coefficient", _TAC, tac.value)
    texts += doubts_of(
        "area ratio", AREA_RATIO, ratio.value,
        "the coefficient is in doubt as much: check power, temperatures and diameter",
    )  # fmt: skip
    if estimates["offset"].value < 0.0:
        texts.append("the offset is negative, but zero is within its uncertainty")
    return texts


def misfit_warnings(alike: float, rows: int, values: Mapping[str, float]) -> list[str]:
    """Lines about rows that follow another curve; ``values``: of all unknowns."""
    texts = []
    if alike > 1.0:
        texts.append(
            "rows of neighbouring pressures deviate from the fit together, as if only "
            f"{rows / alike:.0f} of {rows} were independent: the law does not fit them; the "
            "intervals are wider for it"
        )
    pulls = {name: value for name, value in values.items() if name not in PARAMETERS}
    far = {name: value for name, value in pulls.items() if abs(value) > FAR}
    if far:
        wanted = ", ".join(f"{IN_WORDS[name][0]} {value:+.1f}" for name, value in far.items())
        text = (
            f"the fit wants errors of {wanted} stated standard uncertainties: an instrument, or "
            "the law, is off by more than is stated"
        )
        texts.append(Doubt(text) if max(map(abs, far.values())) > _TOO_FAR else text)
    return texts


def drift_warnings(residual: np.ndarray, pressure: np.ndarray, alike: float) -> list[str]:
    """Lines about hysteresis and drift; relative residuals of rows in their order, shape (m,)."""
    # The gauge lags behind a pressure that rises or falls; heater, leads and power meter drift.
    count = len(residual)
    level = np.log(pressure)
    time = np.linspace(-0.5, 0.5, count)
    rising = np.sign(np.gradient(level)) if count > 1 else np.zeros(count)
    causes = {
        "rise": 0.5 * rising,  # half above, half below
        "time": time - np.polynomial.Polynomial.fit(level, time, 2)(level),
    }
    if min(np.sum(rising > 0.0), np.sum(rising < 0.0)) < _FEWEST:
        del causes["rise"]
    if np.var(causes["time"]) < (1.0 - _TIED**2) * np.var(time):
        del causes["time"]
    if not causes:
        return []
    design = np.column_stack([np.ones(count), *causes.values()])
    found, *_ = np.linalg.lstsq(design, residual)
    scatter = np.var(residual - design @ found) * count / max(count - design.shape[1], 1)
    error = np.sqrt(alike * scatter * np.diag(np.linalg.pinv(design.T @ design)))
    words = {
        "rise": "rows taken while the pressure rose lie {} above those while it fell: the gauge "
        "lags, or the heater was not yet at rest",
        "time": "at the same pressure, rows at the end lie {} above those at the beginning: "
        "something drifts",
    }
    return [
        words[name].format(f"{_PERCENT * value:+.2g} ± {_PERCENT * one:.1g} %")
        for name, value, one in zip(causes, found[1:], error[1:], strict=True)
        if abs(value) > max(_SIGNIFICANT * one, _LEAST)
    ]
