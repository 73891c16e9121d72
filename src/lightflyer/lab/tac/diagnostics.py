"""What may be wrong with a heater's run, and with what is found from it."""

import math
from collections.abc import Mapping

import numpy as np

from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.core.quantity import AccommodationCoefficient, Quantity, quantity_of
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.result import AREA_RATIO, doubts_of
from lightflyer.lab.tac.data import IN_WORDS
from lightflyer.lab.tac.problem import PARAMETERS, HeaterProblem

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
